#include "postproc/loads/mesh_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/counted.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/field/vector_math.h"
#include "postproc/loads/loads_parts.h"

namespace underbody::postproc {

SetPoint set_point(const std::vector<std::pair<std::string, std::string>>& texts,
                   const std::vector<std::pair<std::string, double>>& numbers, const std::string& column) {
    SetPoint point;
    for (const auto& [name, value] : texts) {
        if (name != "mesh" && name != column && !is_result(name)) {
            point.emplace_back(name, value);
        }
    }
    for (const auto& [name, value] : numbers) {
        const bool mesh = name == column || name == "cells" || name == "faces" || name == "nodes" || name == "points" ||
                          name == "elements";
        if (!mesh && !is_result(name)) {
            point.emplace_back(name, core::format_number(value, 9));
        }
    }
    std::sort(point.begin(), point.end());
    return point;
}

std::vector<std::string> differences(const SetPoint& a, const SetPoint& b) {
    std::vector<std::string> names;
    for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
        for (const auto& [name, value] : *one) {
            if (std::find(other->begin(), other->end(), std::pair(name, value)) == other->end() &&
                std::find(names.begin(), names.end(), name) == names.end()) {
                names.push_back(name);
            }
        }
    }
    return names;
}

MeshUncertainty mesh_uncertainty_of(const std::vector<MeshValue>& values, bool moment, const LoadScale& scale) {
    constexpr double rounding = 1e-9;
    return mesh_uncertainty(values, 2, rounding * scale.force * (moment ? scale.length : 1));
}

namespace {

/// The six named loads of a result.
std::vector<LoadsColumn> six(const LoadsResult& result) {
    auto row = table_row(result);
    row.resize(6);
    return row;
}

SetPoint set_point_of(const LoadsCase& one, const std::string& column) {
    SetPoint point = set_point(one.texts, one.numbers, column);
    point.emplace_back("dimension", std::to_string(one.loads.dimension));
    return point;
}

/// Cases on one mesh each, by set points.
struct Group {
    SetPoint point;
    std::vector<const LoadsCase*> cases;
};

/// Cases that are alike but for numbers whose names say nothing (nose_radius, or y_plus): they may be two cases, or two
/// meshes of one. And studies that are none.
void note_what_is_apart(const std::vector<Group>& groups, const std::string& column, core::Problems& notes) {
    std::map<SetPoint, const Group*> by_known;  // by what has a known name
    std::vector<std::string> said;
    std::vector<std::string> varying;
    for (const auto& group : groups) {
        for (const auto& name : differences(groups.front().point, group.point)) {
            if (std::find(varying.begin(), varying.end(), name) == varying.end()) {
                varying.push_back(name);
            }
        }
        SetPoint known = group.point;
        std::erase_if(known, [&](const auto& condition) {
            const auto& numbers = group.cases.front()->numbers;
            return core::find_quantity(condition.first) == nullptr && has(numbers, condition.first);
        });
        const auto [like, is_new] = by_known.emplace(std::move(known), &group);
        const std::string names = is_new ? std::string() : quoted(differences(like->second->point, group.point));
        if (!is_new && std::find(said.begin(), said.end(), names) == said.end()) {
            said.push_back(names);
            notes.push_back({core::Problem::Severity::warning,
                             "'" + like->second->cases.front()->file + "' and '" + group.cases.front()->file +
                                 "' differ in " + names +
                                 ": taken for two cases, not for two meshes of one (what follows from the mesh is not "
                                 "to be a condition)",
                             {}});
        }
    }
    if (std::all_of(groups.begin(), groups.end(), [](const Group& group) { return group.cases.size() == 1; })) {
        const bool by_text = std::any_of(varying.begin(), varying.end(), [&](const std::string& name) {
            return std::any_of(groups.begin(), groups.end(),
                               [&](const Group& g) { return has(g.cases.front()->texts, name); });
        });
        const std::string others = (varying.empty() ? "" : "; they differ in " + quoted(varying) + " too") +
                                   (by_text ? " (a text that names the mesh alone is called 'mesh')" : "");
        notes.push_back({core::Problem::Severity::warning,
                         "no mesh study by '" + column + "': no case is there on two meshes" + others,
                         {}});
    }
}

double scatter_of(const LoadsCase& one, const std::string& name) {
    check_scatters(one.numbers, {one.file, {}, {}, {}});
    const double stated = value_of(one.numbers, name + "_scatter", 0.0);
    return value_of(one.scatters, name, std::isfinite(stated) ? stated : 0.0);
}

/// Size of a case's mesh from its number of cells, or from that of the faces that were integrated: lines of a plane
/// case.
double mesh_size_of(const LoadsCase& one, const std::string& column) {
    if (column == "faces") {
        std::size_t faces = 0;
        for (const auto& zone : one.loads.zones) {
            faces += zone.faces;
        }
        return mesh_size(value_of(one.numbers, column, static_cast<double>(faces)), one.loads.dimension - 1);
    }
    const double cells = value_of(one.numbers, column, std::numeric_limits<double>::quiet_NaN());
    if (!(cells > 0)) {
        throw core::InputError("range",
                               "'" + column + "' is " + (std::isnan(cells) ? "missing" : core::format_number(cells)) +
                                   " for this case: a mesh study needs its number of cells",
                               {one.file, {}, {}, {}});
    }
    return mesh_size(cells, one.loads.dimension);
}

LoadsCase study_of(std::vector<const LoadsCase*> group, const std::string& column) {
    if (group.size() > 1) {  // finest first
        std::stable_sort(group.begin(), group.end(), [&](const LoadsCase* a, const LoadsCase* b) {
            return mesh_size_of(*a, column) < mesh_size_of(*b, column);
        });
        for (std::size_t i = 1; i < group.size(); ++i) {
            if (!(mesh_size_of(*group[i], column) > mesh_size_of(*group[i - 1], column) * (1 + 1e-9))) {
                throw core::InputError("range",
                                       "'" + group[i]->file + "' and '" + group[i - 1]->file +
                                           "' are the same case on meshes of the same size",
                                       {},
                                       "a mesh study needs meshes that differ in '" + column +
                                           "', and conditions that tell other cases apart");
            }
        }
    }
    const LoadsCase* finest = group.front();
    LoadsCase result = *finest;
    const auto names = six(finest->loads);
    for (std::size_t i = 0; i < names.size(); ++i) {
        double mesh = 0;
        if (group.size() > 1) {
            std::vector<MeshValue> values;
            for (const LoadsCase* one : group) {
                values.push_back({mesh_size_of(*one, column), six(one->loads)[i].value});
            }
            result.meshes.emplace_back(names[i].name,
                                       mesh_uncertainty_of(values, names[i].unit == "N m",
                                                           {norm(finest->loads.total.force), finest->loads.length}));
            mesh = result.meshes.back().second.standard_uncertainty;
        }
        const auto known = std::find_if(result.sigmas.begin(), result.sigmas.end(),
                                        [&](const auto& entry) { return entry.first == names[i].name; });
        const bool in_time = known != result.sigmas.end();  // the error of a mean, in place of the iterations' scatter
        const double sigma =
            combined(std::vector<double>{mesh, in_time ? known->second : scatter_of(*finest, names[i].name)});
        if (in_time) {
            known->second = sigma;
        } else if (sigma > 0) {  // nought is no standard deviation: of what symmetry makes nought, say
            result.sigmas.emplace_back(names[i].name, sigma);
        }
    }
    return result;
}

}  // namespace

std::vector<LoadsCase> with_iteration_sigmas(const std::vector<LoadsCase>& cases) {
    std::vector<LoadsCase> result;
    for (const auto& one : cases) {
        result.push_back(study_of({&one}, {}));
    }
    return result;
}

void check_scatters(const std::vector<std::pair<std::string, double>>& numbers, const core::Place& place) {
    for (const auto& column : six({})) {
        if (const double scatter = value_of(numbers, column.name + "_scatter", 0.0); scatter < 0) {
            throw core::InputError("range",
                                   column.name + "_scatter is " + core::format_number(scatter) + " " + column.unit +
                                       ": no uncertainty is negative",
                                   place);
        }
    }
}

std::vector<LoadsCase> mesh_studies(const std::vector<LoadsCase>& cases, const std::string& column,
                                    core::Problems& notes) {
    std::vector<Group> groups;
    std::map<SetPoint, std::size_t> places;
    for (const auto& one : cases) {
        if (!has(one.numbers, column) && column != "faces") {
            std::vector<std::string> names = {"faces"};
            for (const auto& number : one.numbers) {
                names.push_back(number.first);
            }
            if (has(one.texts, column)) {
                throw core::InputError("missing", "the column '" + column + "' is text, for its heading has no unit",
                                       {one.file, {}, {}, {}}, "of a number of cells write '" + column + " [1]'");
            }
            throw core::InputError("missing", "no number of cells '" + column + "' is known of this case",
                                   {one.file, {}, {}, {}}, core::did_you_mean(column, names));
        }
        SetPoint point = set_point_of(one, column);
        const auto [found, is_new] = places.emplace(point, groups.size());
        if (is_new) {
            groups.push_back({std::move(point), {&one}});
        } else {
            groups[found->second].cases.push_back(&one);
        }
    }
    note_what_is_apart(groups, column, notes);
    const auto alone = std::count_if(groups.begin(), groups.end(), [](const Group& g) { return g.cases.size() == 1; });
    if (alone > 0 && static_cast<std::size_t>(alone) < groups.size()) {
        const auto one = std::find_if(groups.begin(), groups.end(), [](const Group& g) { return g.cases.size() == 1; });
        notes.push_back({core::Problem::Severity::warning,
                         core::counted_of(alone, groups.size(), "case", "has", "have") +
                             " one mesh alone: " + (alone == 1 ? "its error is" : "their errors are") +
                             " without that of the mesh, and a table made of all takes " +
                             (alone == 1 ? "it" : "them") + " for far more exact than the others",
                         {one->cases.front()->file, {}, {}, {}}});
    }
    std::vector<LoadsCase> result;
    for (const auto& group : groups) {
        result.push_back(study_of(group.cases, column));
    }
    return result;
}

}  // namespace underbody::postproc
