#include "postproc/importers/cgns/cgns_surfaces.h"

#include <algorithm>

namespace underbody::postproc {

namespace {

class Finder {
public:
    Finder(const std::vector<CgnsSection>& sections, const std::vector<CgnsCondition>& conditions,
           const CellsOfPolygons& cells_of_polygons, int dimension)
        : sections_(sections), conditions_(conditions), cells_of_polygons_(cells_of_polygons), dimension_(dimension) {
        for (const auto& section : sections) {
            used_.emplace_back(section.elements.size(), false);
        }
    }

    CgnsSurfaces find() {
        for (const auto& condition : conditions_) {
            if (condition.where == CgnsCondition::Where::faces) {
                result_.parts.push_back(by_numbers(condition));
            }
        }
        for (const auto& condition : conditions_) {
            if (condition.where == CgnsCondition::Where::vertices && !section_called(condition.name)) {
                result_.parts.push_back(by_vertices(condition));
            } else if (condition.where == CgnsCondition::Where::nowhere && !section_called(condition.name)) {
                result_.told.emplace_back(&condition, "has no faces: it names neither faces nor vertices");
            }
        }
        for (std::size_t s = 0; s < sections_.size(); ++s) {
            add_rest_of(s);
        }
        return std::move(result_);
    }

private:
    [[nodiscard]] bool is_face(std::size_t section, std::size_t element) const {
        const auto& one = sections_[section].elements[element];
        return !sections_[section].polyhedra && one.dimension() == dimension_ - 1 &&
               one.count >= static_cast<std::size_t>(dimension_);
    }
    /// A polygon that two cells share is no boundary unless a condition names it.
    [[nodiscard]] bool between_cells(std::size_t section, std::size_t element) const {
        return section < cells_of_polygons_.size() && element < cells_of_polygons_[section].size() &&
               cells_of_polygons_[section][element] > 1;
    }
    [[nodiscard]] bool section_called(const std::string& name) const {
        for (std::size_t s = 0; s < sections_.size(); ++s) {
            for (std::size_t e = 0; sections_[s].name == name && e < sections_[s].elements.size(); ++e) {
                if (is_face(s, e) && !between_cells(s, e)) {
                    return true;
                }
            }
        }
        return false;
    }
    void add(ElementPart& part, std::size_t section, std::size_t element) {
        const auto& one = sections_[section].elements[element];
        part.add(one.type, sections_[section].nodes.data() + one.first, one.count);
        used_[section][element] = true;
    }
    static CgnsSurface surface_of(const CgnsCondition& condition) {
        CgnsSurface surface;
        surface.condition = &condition;
        surface.part.name = condition.name;
        surface.part.kind = condition.kind;
        surface.part.original_kind = condition.type;
        return surface;
    }

    CgnsSurface by_numbers(const CgnsCondition& condition) {
        CgnsSurface surface = surface_of(condition);
        const ElementPart& part = surface.part;
        const auto add_number = [&](std::int64_t number, std::int64_t entry) {
            const auto after = std::upper_bound(sections_.begin(), sections_.end(), number,
                                                [](std::int64_t n, const CgnsSection& s) { return n < s.first; });
            if (after != sections_.begin() && number <= std::prev(after)->last) {
                const auto section = static_cast<std::size_t>(after - sections_.begin()) - 1;
                const auto element = static_cast<std::size_t>(number - sections_[section].first);
                if (is_face(section, element)) {
                    add(surface.part, section, element);
                    surface.entries.push_back(entry);
                }
            }
        };
        if (condition.range && condition.numbers.size() == 2) {
            const auto [low, high] = std::minmax(condition.numbers[0], condition.numbers[1]);
            for (const auto& section : sections_) {  // no number that no section has
                for (std::int64_t number = std::max(low, section.first); number <= std::min(high, section.last);
                     ++number) {
                    add_number(number, number - low);
                }
            }
        } else {
            for (std::size_t i = 0; i < condition.numbers.size(); ++i) {
                add_number(condition.numbers[i], static_cast<std::int64_t>(i));
            }
        }
        if (part.elements() == 0) {
            result_.told.emplace_back(&condition,
                                      "has no faces: none of the elements that it names is one in the file");
        } else if (static_cast<double>(part.elements()) < condition.named()) {
            result_.told.emplace_back(&condition, "is not whole: of " +
                                                      std::to_string(static_cast<std::int64_t>(condition.named())) +
                                                      " elements that it names " + std::to_string(part.elements()) +
                                                      " are faces in the file");
        }
        return surface;
    }

    CgnsSurface by_vertices(const CgnsCondition& condition) {
        CgnsSurface surface = surface_of(condition);
        ElementPart& part = surface.part;
        const bool range = condition.range && condition.numbers.size() == 2;
        std::vector<std::int64_t> nodes;
        for (const std::int64_t number : condition.numbers) {
            nodes.push_back(number - 1);
        }
        std::sort(nodes.begin(), nodes.end());
        const auto named = [&](std::int64_t node) {
            return range ? node >= nodes[0] && node <= nodes[1] : std::binary_search(nodes.begin(), nodes.end(), node);
        };
        for (std::size_t s = 0; s < sections_.size(); ++s) {
            if (is_named_by_vertices(sections_[s].name)) {
                continue;
            }
            for (std::size_t e = 0; e < sections_[s].elements.size(); ++e) {
                const auto& element = sections_[s].elements[e];
                const auto first = sections_[s].nodes.begin() + static_cast<std::ptrdiff_t>(element.first);
                if (!used_[s][e] && is_face(s, e) && !between_cells(s, e) &&
                    std::all_of(first, first + static_cast<std::ptrdiff_t>(element.count), named)) {
                    add(part, s, e);
                }
            }
        }
        if (part.elements() == 0) {
            result_.told.emplace_back(
                &condition, "has no faces: none in the file has all its nodes among the vertices that it names");
        }
        return surface;
    }
    /// The faces of a section that has the name of a condition are that one's.
    [[nodiscard]] bool is_named_by_vertices(const std::string& section) const {
        return std::any_of(conditions_.begin(), conditions_.end(), [&](const CgnsCondition& condition) {
            return condition.where == CgnsCondition::Where::vertices && condition.name == section;
        });
    }

    void add_rest_of(std::size_t s) {
        CgnsSurface surface;
        ElementPart& part = surface.part;
        part.name = sections_[s].name;
        bool whole = true;
        for (std::size_t e = 0; e < sections_[s].elements.size(); ++e) {
            if (used_[s][e]) {
                whole = false;
            } else if (is_face(s, e) && !between_cells(s, e)) {
                add(part, s, e);
            }
        }
        for (const auto& condition : conditions_) {
            if (whole && condition.name == part.name) {
                part.kind = condition.kind;
                part.original_kind = condition.type;
                surface.condition = &condition;
            }
        }
        part.name += whole ? "" : " (rest)";
        result_.parts.push_back(std::move(surface));
    }

    const std::vector<CgnsSection>& sections_;
    const std::vector<CgnsCondition>& conditions_;
    const CellsOfPolygons& cells_of_polygons_;
    int dimension_;
    std::vector<std::vector<bool>> used_;
    CgnsSurfaces result_;
};

}  // namespace

CgnsSurfaces surfaces_of(const std::vector<CgnsSection>& sections, const std::vector<CgnsCondition>& conditions,
                         const CellsOfPolygons& cells_of_polygons, int dimension) {
    return Finder(sections, conditions, cells_of_polygons, dimension).find();
}

}  // namespace underbody::postproc
