#include "postproc/importers/cgns/cgns_block.h"

#include <vtkCellType.h>

#include <algorithm>

namespace underbody::postproc {

namespace {

using Place = std::array<std::int64_t, 3>;

/// Nodes along each index, numbered as the file does, from 0.
class Block {
public:
    Block(const CgnsZone& zone, int dimension) : nodes_(zone.nodes), dimension_(dimension) {}

    [[nodiscard]] int dimension() const { return dimension_; }
    [[nodiscard]] std::int64_t nodes(int index) const { return nodes_[static_cast<std::size_t>(index)]; }
    [[nodiscard]] std::int64_t node(const Place& at) const { return (at[2] * nodes_[1] + at[1]) * nodes_[0] + at[0]; }

    /// Corners of the face across index `normal` whose lowest node is `at`.
    [[nodiscard]] std::vector<std::int64_t> face(const Place& at, int normal) const {
        if (dimension_ == 2) {
            Place end = at;
            ++end[static_cast<std::size_t>(1 - normal)];
            return {node(at), node(end)};
        }
        const auto a = static_cast<std::size_t>((normal + 1) % 3);
        const auto b = static_cast<std::size_t>((normal + 2) % 3);
        std::vector<std::int64_t> corners;
        constexpr std::array<std::pair<int, int>, 4> steps = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (const auto& [u, v] : steps) {
            Place corner = at;
            corner[a] += u;
            corner[b] += v;
            corners.push_back(node(corner));
        }
        return corners;
    }
    void add_face(ElementPart& part, const Place& at, int normal) const {
        const auto corners = face(at, normal);
        part.add(dimension_ == 2 ? VTK_LINE : VTK_QUAD, corners.data(), corners.size());
    }

private:
    Place nodes_;
    int dimension_;
};

/// Calls `act` with every place from `low` to `high`, both included.
template <typename Act>
void for_places(const Place& low, const Place& high, Act&& act) {
    Place at{};
    for (at[2] = low[2]; at[2] <= high[2]; ++at[2]) {
        for (at[1] = low[1]; at[1] <= high[1]; ++at[1]) {
            for (at[0] = low[0]; at[0] <= high[0]; ++at[0]) {
                act(at);
            }
        }
    }
}

class Finder {
public:
    Finder(const CgnsFile& file, const CgnsZone& zone, const CgnsCondition& condition)
        : file_(file), zone_(zone), condition_(condition), block_(zone, file.cell_dimension()) {
        const auto indices = static_cast<std::size_t>(block_.dimension());
        for (std::size_t i = 0; i + indices <= condition.numbers.size(); i += indices) {
            Place place{};
            for (std::size_t k = 0; k < indices; ++k) {
                place[k] = condition.numbers[i + k] - 1;
            }
            places_.push_back(place);
        }
        if (condition.range && places_.size() == 2) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(places_[0][k], places_[1][k]);
                low_[k] = low;
                high_[k] = high;
            }
        }
    }

    BlockFaces find() {
        result_.surface.condition = &condition_;
        result_.surface.part.name = zone_.name + "/" + condition_.name;
        result_.surface.part.kind = condition_.kind;
        result_.surface.part.original_kind = condition_.type;
        if (places_.empty() || condition_.where == CgnsCondition::Where::nowhere ||
            (condition_.range && places_.size() != 2)) {
            result_.told = "has no faces: it names neither faces nor vertices";
        } else if (condition_.where == CgnsCondition::Where::faces) {
            add_faces();
        } else {
            condition_.range ? add_between_vertices() : add_faces_of_vertices();
        }
        if (result_.told.empty() && result_.surface.part.elements() == 0) {
            result_.told = "has no faces: none has all its vertices among those that it names";
        }
        return std::move(result_);
    }

private:
    static constexpr int of_nodes = -1;

    /// Faces are as many as nodes across their index, and one less along the others.
    [[nodiscard]] bool inside(const Place& low, const Place& high, int normal) const {
        for (int k = 0; k < block_.dimension(); ++k) {
            const std::int64_t less = k == normal || normal == of_nodes ? 0 : 1;
            if (low[static_cast<std::size_t>(k)] < 0 || high[static_cast<std::size_t>(k)] >= block_.nodes(k) - less) {
                return false;
            }
        }
        return true;
    }
    void check(const Place& low, const Place& high, int normal) const {
        if (!inside(low, high, normal)) {
            file_.fail(zone_, "condition '" + condition_.name + "' lies outside the zone");
        }
    }

    /// The next of the faces that the condition names, in its order.
    void add_face(const Place& at, int normal) {
        result_.surface.entries.push_back(static_cast<std::int64_t>(result_.surface.part.elements()));
        block_.add_face(result_.surface.part, at, normal);
    }

    /// The index across faces of which the file says no more than that they are faces: the only one that is the same
    /// for all of them; -1 when that does not tell.
    [[nodiscard]] int normal_by_extent() const {
        std::vector<int> flat;
        for (int k = 0; k < block_.dimension(); ++k) {
            const auto index = static_cast<std::size_t>(k);
            const bool same = std::all_of(places_.begin(), places_.end(),
                                          [&](const Place& place) { return place[index] == places_[0][index]; });
            if (same && places_[0][index] == block_.nodes(k) - 1) {
                return k;  // behind the last cell there are faces across this index alone
            }
            if (same) {
                flat.push_back(k);
            }
        }
        return flat.size() == 1 ? flat[0] : -1;
    }

    void add_faces() {
        const int normal =
            condition_.normal >= 0 && condition_.normal < block_.dimension() ? condition_.normal : normal_by_extent();
        if (normal < 0) {
            result_.told = "has no faces: the file does not say across which index they lie";
            return;
        }
        const auto all_inside = [&](int kind) {
            return std::all_of(places_.begin(), places_.end(),
                               [&](const Place& place) { return inside(place, place, kind); });
        };
        if (!all_inside(normal) && all_inside(of_nodes)) {  // some write FaceCenter to lists and ranges of vertices
            result_.told = "is taken by its vertices: it goes one beyond the faces that there are";
            condition_.range ? add_between_vertices() : add_faces_of_vertices();
            return;
        }
        if (condition_.range) {
            check(low_, high_, normal);
            for_places(low_, high_, [&](const Place& at) { add_face(at, normal); });
            return;
        }
        for (const auto& place : places_) {
            check(place, place, normal);
            add_face(place, normal);
        }
    }

    void add_between_vertices() {
        check(low_, high_, of_nodes);
        std::vector<int> flat;
        Place last = high_;
        for (int k = 0; k < block_.dimension(); ++k) {
            const auto index = static_cast<std::size_t>(k);
            if (low_[index] == high_[index]) {
                flat.push_back(k);
            } else {
                --last[index];
            }
        }
        if (flat.size() != 1) {
            result_.told =
                std::string("has no faces: its vertices ") + (flat.empty() ? "fill a block" : "lie on a line");
            return;
        }
        for_places(low_, last, [&](const Place& at) { block_.add_face(result_.surface.part, at, flat[0]); });
    }

    /// The faces round the block all of whose nodes are in the list.
    void add_faces_of_vertices() {
        std::vector<bool> named(static_cast<std::size_t>(zone_.nodes[0] * zone_.nodes[1] * zone_.nodes[2]));
        for (const auto& place : places_) {
            check(place, place, of_nodes);
            named[static_cast<std::size_t>(block_.node(place))] = true;
        }
        for (int normal = 0; normal < block_.dimension(); ++normal) {
            if (condition_.normal >= 0 && condition_.normal != normal) {
                continue;
            }
            for (const std::int64_t side : {std::int64_t{0}, block_.nodes(normal) - 1}) {
                Place low{};
                Place high{};
                for (int k = 0; k < block_.dimension(); ++k) {
                    high[static_cast<std::size_t>(k)] = block_.nodes(k) - 2;
                }
                low[static_cast<std::size_t>(normal)] = high[static_cast<std::size_t>(normal)] = side;
                for_places(low, high, [&](const Place& at) {
                    const auto corners = block_.face(at, normal);
                    if (std::all_of(corners.begin(), corners.end(),
                                    [&](std::int64_t node) { return named[static_cast<std::size_t>(node)]; })) {
                        block_.add_face(result_.surface.part, at, normal);
                    }
                });
            }
        }
    }

    const CgnsFile& file_;
    const CgnsZone& zone_;
    const CgnsCondition& condition_;
    Block block_;
    std::vector<Place> places_;
    Place low_{};
    Place high_{};
    BlockFaces result_;
};

}  // namespace

ElementPart cells_of_block(const CgnsZone& zone, int dimension, core::Progress& progress) {
    const std::int64_t ni = zone.nodes[0];
    const std::int64_t nj = zone.nodes[1];
    const std::int64_t nk = zone.nodes[2];
    const auto node = [&](std::int64_t i, std::int64_t j, std::int64_t k) { return (k * nj + j) * ni + i; };
    ElementPart volume;
    const std::int64_t layers = dimension == 3 ? nk - 1 : 1;
    for (std::int64_t k = 0; k < layers; ++k) {
        progress.check();
        for (std::int64_t j = 0; j + 1 < nj; ++j) {
            for (std::int64_t i = 0; i + 1 < ni; ++i) {
                std::array<std::int64_t, 8> n = {
                    node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k), 0, 0, 0, 0};
                for (std::size_t c = 0; c < 4; ++c) {
                    n[c + 4] = n[c] + ni * nj;
                }
                dimension == 3 ? volume.add(VTK_HEXAHEDRON, n.data(), 8) : volume.add(VTK_QUAD, n.data(), 4);
            }
        }
    }
    return volume;
}

BlockFaces faces_of_block(const CgnsFile& file, const CgnsZone& zone, const CgnsCondition& condition) {
    return Finder(file, zone, condition).find();
}

}  // namespace underbody::postproc
