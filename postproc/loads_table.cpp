#include "postproc/loads_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/units.h"

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

/// What must agree for two cases to be one case on two meshes.
std::string set_point_of(const LoadsCase& one) {
    std::string key;
    for (const auto& [name, value] : one.texts) {
        if (name != "mesh") {
            key += name + "=" + value + ";";
        }
    }
    const auto loads = six(one.loads);
    for (const auto& [name, value] : one.numbers) {
        const bool load = std::any_of(loads.begin(), loads.end(), [&](const LoadsColumn& c) { return c.name == name; });
        if (!load && core::find_quantity(name) != nullptr) {
            key += name + "=" + core::format_number(value, 9) + ";";
        }
    }
    return key;
}

double scatter_of(const LoadsCase& one, const std::string& name) { return value_of(one.scatters, name, value_of(one.numbers, name + "_scatter", 0.0)); }

/// Size of a case's mesh from its number of cells, or from that of the faces that were integrated.
double mesh_size_of(const LoadsCase& one, const std::string& column) {
    if (column == "faces") {
        std::size_t faces = 0;
        for (const auto& zone : one.loads.zones) {
            faces += zone.faces;
        }
        return mesh_size(value_of(one.numbers, column, static_cast<double>(faces)), 2);
    }
    const double cells = value_of(one.numbers, column, std::numeric_limits<double>::quiet_NaN());
    if (!(cells > 0)) {
        throw core::InputError("range", "'" + column + "' is " + (std::isnan(cells) ? "missing" : core::format_number(cells)) + " for this case: a mesh study needs its number of cells", {one.file, {}, {}, {}});
    }
    return mesh_size(cells);
}

LoadsCase study_of(std::vector<const LoadsCase*> group, const std::string& column) {
    if (group.size() > 1) {  // finest first
        std::stable_sort(group.begin(), group.end(), [&](const LoadsCase* a, const LoadsCase* b) { return mesh_size_of(*a, column) < mesh_size_of(*b, column); });
        for (std::size_t i = 1; i < group.size(); ++i) {
            if (!(mesh_size_of(*group[i], column) > mesh_size_of(*group[i - 1], column) * (1 + 1e-9))) {
                throw core::InputError("range", "'" + group[i]->file + "' and '" + group[i - 1]->file + "' are the same case on meshes of the same size", {},
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

}  // namespace

std::vector<LoadsCase> with_iteration_sigmas(const std::vector<LoadsCase>& cases) {
    std::vector<LoadsCase> result;
    for (const auto& one : cases) {
        result.push_back(study_of({&one}, {}));
    }
    return result;
}

std::vector<LoadsCase> mesh_studies(const std::vector<LoadsCase>& cases, const std::string& column) {
    std::vector<std::pair<std::string, std::vector<const LoadsCase*>>> groups;
    for (const auto& one : cases) {
        const bool has = std::any_of(one.numbers.begin(), one.numbers.end(), [&](const auto& n) { return n.first == column; });
        if (!has && column != "faces") {
            std::vector<std::string> names = {"faces"};
            for (const auto& number : one.numbers) {
                names.push_back(number.first);
            }
            if (std::any_of(one.texts.begin(), one.texts.end(), [&](const auto& text) { return text.first == column; })) {
                throw core::InputError("missing", "the column '" + column + "' is text, for its heading has no unit", {one.file, {}, {}, {}}, "of a number of cells write '" + column + " [1]'");
            }
            throw core::InputError("missing", "no number of cells '" + column + "' is known of this case", {one.file, {}, {}, {}}, core::did_you_mean(column, names));
        }
        const std::string key = set_point_of(one);
        auto found = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == key; });
        if (found == groups.end()) {
            groups.push_back({key, {}});
            found = groups.end() - 1;
        }
        found->second.push_back(&one);
    }
    std::vector<LoadsCase> result;
    for (const auto& group : groups) {
        result.push_back(study_of(group.second, column));
    }
    return result;
}

std::vector<Comparison> compare_with_stated(const std::vector<LoadsCase>& cases) {
    std::vector<Comparison> result;
    for (const auto& one : cases) {
        const double lift = value_of(one.numbers, "lift_force", one.loads.named.lift_force);
        const double drag = value_of(one.numbers, "drag_force", one.loads.named.drag_force);
        const double side = value_of(one.numbers, "side_force", one.loads.named.side_force);
        const NamedLoads& own = one.loads.named;
        const double theirs = std::hypot(lift, drag, side);
        const double force = theirs > 0 ? theirs : std::hypot(own.lift_force, own.drag_force, own.side_force);
        const double length = std::sqrt(std::max(one.loads.area, 0.0));
        for (const auto& load : table_row(one.loads)) {
            const bool stated = std::any_of(one.numbers.begin(), one.numbers.end(), [&](const auto& n) { return n.first == load.name; });
            if (!stated || load.name == "closure") {
                continue;
            }
            const double scale = load.unit == "N m" ? force * length : force;
            const double other = value_of(one.numbers, load.name, 0.0);
            result.push_back({one.file, load.name, {}, load.value, other, share_of(load.value - other, scale, std::max(std::abs(load.value), std::abs(other)))});
        }
    }
    return result;
}

core::Table loads_table(const std::vector<LoadsCase>& cases, const std::vector<std::pair<std::string, std::string>>& written_units) {
    core::Table table;
    const std::vector<LoadsColumn> loads = cases.empty() ? std::vector<LoadsColumn>() : table_row(cases.front().loads);
    const auto free_name = [&](const std::string& name) {
        const bool taken = name == "file" || name == "values_from" || name == "reference_x" || name == "reference_y" || name == "reference_z" || std::any_of(loads.begin(), loads.end(), [&](const LoadsColumn& c) { return c.name == name || c.name + "_sigma" == name; });
        return taken ? name + "_stated" : name;
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
        const auto has_sigma = [&](const LoadsCase& c) { return std::any_of(c.sigmas.begin(), c.sigmas.end(), [&](const auto& s) { return s.first == loads[i].name; }); };
        if (std::any_of(cases.begin(), cases.end(), has_sigma)) {
            std::vector<double> sigmas;
            for (const auto& one : cases) {
                sigmas.push_back(value_of(one.sigmas, loads[i].name, std::numeric_limits<double>::quiet_NaN()));
            }
            table.add_numbers(loads[i].name + "_sigma", loads[i].unit, std::move(sigmas));
        }
    }
    if (std::any_of(cases.begin(), cases.end(), [](const LoadsCase& c) { return c.loads.coefficients.has_value(); })) {
        for (const auto& [name, which] : {std::pair{"lift_coefficient", &LoadsCoefficients::lift}, {"drag_coefficient", &LoadsCoefficients::drag},
                                          {"pitch_moment_coefficient", &LoadsCoefficients::pitch_moment}}) {
            std::vector<double> values;
            for (const auto& one : cases) {
                values.push_back(one.loads.coefficients ? (*one.loads.coefficients).*which : std::numeric_limits<double>::quiet_NaN());
            }
            table.add_numbers(free_name(name), "1", std::move(values));
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
    table.add_text("values_from", std::move(origins));
    table.add_text("file", std::move(files));
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
        if (!one.comparisons.empty()) {
            entry["comparison"] = one.comparisons;
        }
        files.push_back(std::move(entry));
    }
    return {{"files", std::move(files)}};
}

}  // namespace underbody::postproc
