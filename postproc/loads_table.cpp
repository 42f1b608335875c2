#include "postproc/loads_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/batch_problems.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/loads_parts.h"

namespace underbody::postproc {

namespace {

/// Names in the order in which they first occur.
template <typename Get>
std::vector<std::string> names_in(const std::vector<LoadsCase>& cases, Get get) {
    std::vector<std::string> names;
    for (const auto& one : cases) {
        for (const auto& entry : get(one)) {
            if (std::find(names.begin(), names.end(), entry.first) == names.end()) {
                names.push_back(entry.first);
            }
        }
    }
    return names;
}

template <typename T>
T value_of(const std::vector<std::pair<std::string, T>>& list, const std::string& name, T fallback) {
    for (const auto& [key, value] : list) {
        if (key == name) {
            return value;
        }
    }
    return fallback;
}

template <typename T>
bool has(const std::vector<std::pair<std::string, T>>& list, const std::string& name) {
    return std::any_of(list.begin(), list.end(), [&](const auto& entry) { return entry.first == name; });
}

std::string si_unit_of(const std::string& name, const std::string& written) {
    if (const auto* known = core::find_quantity(name)) {
        return known->unit;
    }
    return written.empty() ? "1" : core::si_unit(written);
}

/// The six named loads of a result.
std::vector<LoadsColumn> six(const LoadsResult& result) {
    auto row = table_row(result);
    row.resize(6);
    return row;
}

const std::array<std::pair<const char*, double LoadsCoefficients::*>, 3> coefficients = {
    {{"lift_coefficient", &LoadsCoefficients::lift}, {"drag_coefficient", &LoadsCoefficients::drag},
     {"pitch_moment_coefficient", &LoadsCoefficients::pitch_moment}}};

/// Names that a table of loads gives to what it found, with or without _sigma, _scatter, _stated: a condition of such a
/// name (the table of an earlier run as the manifest) does not tell cases apart.
bool is_result(std::string name) {
    for (bool cut = true; cut;) {
        cut = false;
        for (const std::string_view ending : {"_stated", "_sigma", "_scatter"}) {
            if (name.ends_with(ending)) {
                name.resize(name.size() - ending.size());
                cut = true;
            }
        }
    }
    const auto row = table_row({});
    return name == "values_from" || name == "settled" ||
           std::any_of(row.begin(), row.end(), [&](const LoadsColumn& c) { return c.name == name; }) ||
           std::any_of(coefficients.begin(), coefficients.end(), [&](const auto& c) { return c.first == name; });
}

/// What tells cases apart: their conditions but the mesh and what was computed.
using SetPoint = std::vector<std::pair<std::string, std::string>>;

SetPoint set_point_of(const LoadsCase& one, const std::string& column) {
    SetPoint point = {{"dimension", std::to_string(one.loads.dimension)}};
    for (const auto& [name, value] : one.texts) {
        if (name != "mesh" && !is_result(name)) {
            point.emplace_back(name, value);
        }
    }
    for (const auto& [name, value] : one.numbers) {
        const bool mesh = name == column || name == "cells" || name == "faces" || name == "nodes" || name == "points" || name == "elements";
        if (!mesh && !is_result(name)) {
            point.emplace_back(name, core::format_number(value, 9));
        }
    }
    std::sort(point.begin(), point.end());
    return point;
}

/// Names in which two set points are not alike.
std::vector<std::string> differences(const SetPoint& a, const SetPoint& b) {
    std::vector<std::string> names;
    for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
        for (const auto& [name, value] : *one) {
            if (std::find(other->begin(), other->end(), std::pair(name, value)) == other->end() && std::find(names.begin(), names.end(), name) == names.end()) {
                names.push_back(name);
            }
        }
    }
    return names;
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
                             "'" + like->second->cases.front()->file + "' and '" + group.cases.front()->file + "' differ in " + names +
                                 ": taken for two cases, not for two meshes of one (what follows from the mesh is not to be a condition)",
                             {}});
        }
    }
    if (std::all_of(groups.begin(), groups.end(), [](const Group& group) { return group.cases.size() == 1; })) {
        const bool by_text = std::any_of(varying.begin(), varying.end(), [&](const std::string& name) {
            return std::any_of(groups.begin(), groups.end(), [&](const Group& g) { return has(g.cases.front()->texts, name); });
        });
        const std::string others = (varying.empty() ? "" : "; they differ in " + quoted(varying) + " too") +
                                   (by_text ? " (a text that names the mesh alone is called 'mesh')" : "");
        notes.push_back({core::Problem::Severity::warning, "no mesh study by '" + column + "': no case is there on two meshes" + others, {}});
    }
}

double scatter_of(const LoadsCase& one, const std::string& name) {
    check_scatters(one.numbers, {one.file, {}, {}, {}});
    const double stated = value_of(one.numbers, name + "_scatter", 0.0);
    return value_of(one.scatters, name, std::isfinite(stated) ? stated : 0.0);
}

/// Size of a case's mesh from its number of cells, or from that of the faces that were integrated: lines of a plane case.
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
        std::stable_sort(group.begin(), group.end(),
                         [&](const LoadsCase* a, const LoadsCase* b) { return mesh_size_of(*a, column) < mesh_size_of(*b, column); });
        for (std::size_t i = 1; i < group.size(); ++i) {
            if (!(mesh_size_of(*group[i], column) > mesh_size_of(*group[i - 1], column) * (1 + 1e-9))) {
                throw core::InputError("range",
                                       "'" + group[i]->file + "' and '" + group[i - 1]->file + "' are the same case on meshes of the same size", {},
                                       "a mesh study needs meshes that differ in '" + column + "', and conditions that tell other cases apart");
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
            const Vector& force = finest->loads.total.force;
            const double scale = std::hypot(force[0], force[1], force[2]) * (names[i].unit == "N m" ? std::sqrt(std::max(finest->loads.area, 0.0)) : 1);
            constexpr double rounding = 1e-9;
            result.meshes.emplace_back(names[i].name, mesh_uncertainty(values, 2, rounding * scale));
            mesh = result.meshes.back().second.standard_uncertainty;
        }
        const double sigma = combined(std::vector<double>{mesh, scatter_of(*finest, names[i].name)});
        if (sigma > 0) {  // nought is no standard deviation: of what symmetry makes nought, say
            result.sigmas.emplace_back(names[i].name, sigma);
        }
    }
    return result;
}

/// Forces per metre and forces have no column in common.
void refuse_mixed_depths(const std::vector<LoadsCase>& cases) {
    for (const auto& one : cases) {
        if (one.loads.depth != cases.front().loads.depth) {
            const auto shown = [](const LoadsCase& c) { return "'" + c.file + "' " + (c.loads.depth.empty() ? "of a body" : c.loads.depth); };
            throw core::InputError("mismatch", "the forces are those " + shown(cases.front()) + " and " + shown(one) + ": one table cannot hold both", {},
                                   "make a table of each");
        }
    }
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
            throw core::InputError(
                "range", column.name + "_scatter is " + core::format_number(scatter) + " " + column.unit + ": no uncertainty is negative", place);
        }
    }
}

std::vector<LoadsCase> mesh_studies(const std::vector<LoadsCase>& cases, const std::string& column, core::Problems& notes) {
    std::vector<Group> groups;
    std::map<SetPoint, std::size_t> known;
    for (const auto& one : cases) {
        if (!has(one.numbers, column) && column != "faces") {
            std::vector<std::string> names = {"faces"};
            for (const auto& number : one.numbers) {
                names.push_back(number.first);
            }
            if (has(one.texts, column)) {
                throw core::InputError("missing", "the column '" + column + "' is text, for its heading has no unit", {one.file, {}, {}, {}},
                                       "of a number of cells write '" + column + " [1]'");
            }
            throw core::InputError("missing", "no number of cells '" + column + "' is known of this case", {one.file, {}, {}, {}},
                                   core::did_you_mean(column, names));
        }
        SetPoint point = set_point_of(one, column);
        const auto [found, fresh] = known.emplace(point, groups.size());
        if (fresh) {
            groups.push_back({std::move(point), {}});
        }
        groups[found->second].cases.push_back(&one);
    }
    note_what_is_apart(groups, column, notes);
    std::vector<LoadsCase> result;
    for (const auto& group : groups) {
        result.push_back(study_of(group.cases, column));
    }
    return result;
}

std::vector<Comparison> compare_with_stated(const std::vector<LoadsCase>& cases, core::Problems& notes) {
    std::vector<Comparison> result;
    for (const auto& one : cases) {
        const NamedLoads& own = one.loads.named;
        const auto stated = [&](const std::string& name, double otherwise) {
            const double value = value_of(one.numbers, name, otherwise);
            return std::isfinite(value) ? value : otherwise;
        };
        const double theirs = std::hypot(stated("lift_force", own.lift_force), stated("drag_force", own.drag_force), stated("side_force", own.side_force));
        const double force = theirs > 0 ? theirs : std::hypot(own.lift_force, own.drag_force, own.side_force);
        const double length = std::sqrt(std::max(one.loads.area, 0.0));
        std::vector<std::string> missing;
        for (const auto& load : table_row(one.loads)) {
            if (!has(one.numbers, load.name) || load.name == "closure") {
                continue;
            }
            const double other = value_of(one.numbers, load.name, 0.0);
            if (!std::isfinite(other)) {
                missing.push_back(load.name);
                continue;
            }
            const double scale = load.unit == "N m" ? force * length : force;
            const double most = std::max(std::abs(load.value), std::abs(other));
            result.push_back({one.file, load.name, {}, load.value, other, share_of(load.value - other, scale, most)});
        }
        if (!missing.empty()) {
            notes.push_back({core::Problem::Severity::warning, quoted(missing) + " is not stated of this case: not compared", {one.file, {}, {}, {}}});
        }
    }
    return result;
}

core::Table loads_table(const std::vector<LoadsCase>& cases, const std::vector<std::pair<std::string, std::string>>& written_units) {
    refuse_mixed_depths(cases);
    core::Table table;
    const std::vector<LoadsColumn> loads = cases.empty() ? std::vector<LoadsColumn>() : table_row(cases.front().loads);
    const auto free_name = [&](std::string name) {
        const auto taken = [&] {
            return table.find(name) != nullptr || name == "file" || name == "values_from" || name == "settled" ||
                   name == "depth" || name == "reference_x" || name == "reference_y" || name == "reference_z" ||
                   std::any_of(coefficients.begin(), coefficients.end(),
                               [&](const auto& c) { return c.first == name; }) ||
                   std::any_of(loads.begin(), loads.end(),
                               [&](const LoadsColumn& c) { return c.name == name || c.name + "_sigma" == name; });
        };
        while (taken()) {
            name += "_stated";
        }
        return name;
    };
    for (const auto& name : names_in(cases, [](const LoadsCase& c) -> const auto& { return c.texts; })) {
        std::vector<std::string> values;
        for (const auto& one : cases) {
            values.push_back(value_of(one.texts, name, std::string()));
        }
        table.add_text(free_name(name), std::move(values));
    }
    for (const auto& name : names_in(cases, [](const LoadsCase& c) -> const auto& { return c.numbers; })) {
        std::vector<double> values;
        for (const auto& one : cases) {
            values.push_back(value_of(one.numbers, name, std::numeric_limits<double>::quiet_NaN()));
        }
        const std::string written = value_of(written_units, name, std::string());
        table.add_numbers(free_name(name), si_unit_of(name, written), std::move(values), written);
    }
    for (std::size_t i = 0; i < loads.size(); ++i) {
        std::vector<double> values;
        for (const auto& one : cases) {
            values.push_back(table_row(one.loads)[i].value);
        }
        table.add_numbers(loads[i].name, loads[i].unit, std::move(values));
        if (std::any_of(cases.begin(), cases.end(), [&](const LoadsCase& c) { return has(c.sigmas, loads[i].name); })) {
            std::vector<double> sigmas;
            for (const auto& one : cases) {
                sigmas.push_back(value_of(one.sigmas, loads[i].name, std::numeric_limits<double>::quiet_NaN()));
            }
            table.add_numbers(loads[i].name + "_sigma", loads[i].unit, std::move(sigmas));
        }
    }
    if (std::any_of(cases.begin(), cases.end(), [](const LoadsCase& c) { return c.loads.coefficients.has_value(); })) {
        for (const auto& [name, which] : coefficients) {
            std::vector<double> values;
            for (const auto& one : cases) {
                values.push_back(one.loads.coefficients ? (*one.loads.coefficients).*which : std::numeric_limits<double>::quiet_NaN());
            }
            table.add_numbers(name, "1", std::move(values));
        }
    }
    for (std::size_t k = 0; k < 3 && !cases.empty(); ++k) {
        std::vector<double> values;
        for (const auto& one : cases) {
            values.push_back(one.loads.reference[k]);
        }
        table.add_numbers(std::string("reference_") + "xyz"[k], "m", std::move(values));
    }
    std::vector<std::string> files;
    std::vector<std::string> origins;
    for (const auto& one : cases) {
        files.push_back(one.file);
        origins.push_back(one.loads.values_from);
        std::replace(origins.back().begin(), origins.back().end(), ',', ' ');
    }
    if (!cases.empty() && !cases.front().loads.depth.empty()) {
        table.add_text("depth", std::vector<std::string>(cases.size(), cases.front().loads.depth));
    }
    table.add_text("values_from", std::move(origins));
    if (!cases.empty()) {
        std::vector<std::string> verdicts;
        for (const auto& one : cases) {
            verdicts.push_back(to_string(one.settled.verdict));
        }
        table.add_text("settled", std::move(verdicts));
    }
    table.add_text("file", std::move(files));
    core::BatchProblems warnings;  // what makes numbers less than they seem goes with them
    for (const auto& one : cases) {
        warnings.add(one.file, one.loads.problems);
    }
    for (const auto& problem : warnings.gathered(false)) {
        if (problem.severity != core::Problem::Severity::note) {
            table.comments.push_back("warning: " + problem.place.file + ": " + problem.message);
        }
    }
    return table;
}

nlohmann::json loads_table_json(const std::vector<LoadsCase>& cases) {
    nlohmann::json files = nlohmann::json::array();
    for (const auto& one : cases) {
        nlohmann::json entry = one.loads;
        entry["conditions"] = nlohmann::json::object();
        for (const auto& [name, value] : one.texts) {
            entry["conditions"][name] = value;
        }
        for (const auto& [name, value] : one.numbers) {
            entry["conditions"][name] = value;
        }
        if (!one.sigmas.empty()) {
            entry["sigma"] = nlohmann::json::object();
            for (const auto& [name, value] : one.sigmas) {
                entry["sigma"][name] = value;
            }
        }
        for (const auto& [name, study] : one.meshes) {
            entry["mesh_uncertainty"][name] = study;
        }
        entry["settled"] = one.settled;
        if (!one.comparisons.empty()) {
            entry["comparison"] = one.comparisons;
        }
        files.push_back(std::move(entry));
    }
    return {{"files", std::move(files)}};
}

}  // namespace underbody::postproc
