// The model behind a stability map of a study.
#include "cases/region_model.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/file.h"
#include "core/text.h"
#include "core/toml.h"
#include "core/units.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// Where the model's speed is not the one of a table, its force in the map is not the one of the report.
void remark_on_speeds(dynamics::Model& model, const Study& study, const RegionSpec& spec, const StudyResults& results) {
    for (const auto& name : spec.forces) {
        const TableSpec& table = *study.find_table(name);
        const core::Table points = table_points(table, results);
        const auto speed = speed_of(table, points);
        const double held = model.conditions.get(dynamics::Channel::speed, speed.value_or(0));
        if (points.find("speed") == nullptr && model.conditions.has(dynamics::Channel::speed)) {
            model.remarks.push_back({core::Problem::Severity::warning,
                                     "no case of the table '" + name +
                                         "' states a speed, nor does [reference]: its force is taken as that at " +
                                         core::format_number(held, 6) + " m/s, the model's",
                                     {model.name, {}, {}, {}}});
        }
        if (speed && std::abs(held - *speed) > 1e-9 * *speed) {
            model.remarks.push_back(
                {core::Problem::Severity::warning,
                 "the table '" + name + "' was made at " + core::format_number(*speed, 6) + " m/s, the model holds " +
                     core::format_number(held, 6) + " m/s: the map takes the table's force times (" +
                     core::format_number(held, 6) + "/" + core::format_number(*speed, 6) + ")^" +
                     core::format_number(table.speed_exponent, 4) + ", the table's own equilibria do not",
                 {model.name, {}, {}, {}}});
        }
    }
}

/// Where a table's own equilibria are of another weight or mass than the model's, the report has two answers to one
/// question.
void remark_on_weights(dynamics::Model& model, const Study& study, const RegionSpec& spec) {
    const auto told = [&](const std::string& table, const char* what, double of_table, double of_model,
                          const char* unit) {
        const double size = std::max(std::abs(of_table), std::abs(of_model));
        if (!std::isfinite(of_model) || std::abs(of_table - of_model) <= 1e-6 * size) {
            return;
        }
        model.remarks.push_back({core::Problem::Severity::warning,
                                 "the equilibria of the table '" + table + "' are for a " + what + " of " +
                                     core::format_number(of_table, 6) + " " + unit + ", the model's " + what + " is " +
                                     core::format_number(of_model, 6) + " " + unit +
                                     ": the map's attractors are not the table's equilibria",
                                 {model.name, {}, {}, {}}});
    };
    for (const auto& name : spec.forces) {
        const TableSpec& table = *study.find_table(name);
        if (table.quantity == "lift_force" && table.net_weight) {
            told(name, "net weight", *table.net_weight, model.vehicle.net_weight, "N");
            if (table.virtual_mass > 0 && !model.vehicle.added_mass_heave_table) {
                told(name, "mass with added mass", table.virtual_mass, model.heave_mass(), "kg");
            }
        }
    }
}

/// Of one water: that of the cases, or of the study.
std::optional<std::pair<double, double>> densities_of(const Study& study, const TableSpec& table,
                                                      const StudyResults& results) {
    auto range = range_in_cases(table, results, "density");
    if (const auto held = study.reference.number("density"); !range && held) {
        range = {*held, *held};
    }
    return range;
}

/// Forces grow with the density: a table of several waters is not that of one. (Of one water the model's reader says
/// it.)
void remark_on_densities(dynamics::Model& model, const Study& study, const RegionSpec& spec,
                         const StudyResults& results) {
    for (const auto& name : spec.forces) {
        const TableSpec& table = *study.find_table(name);
        const auto range = densities_of(study, table, results);
        const double own = model.environment.density;
        if (range && range->second > range->first &&
            std::max(std::abs(range->first - own), std::abs(range->second - own)) > 2e-3 * own) {
            model.remarks.push_back({core::Problem::Severity::warning,
                                     "the table '" + name + "' is of water of " + core::format_number(range->first, 6) +
                                         " to " + core::format_number(range->second, 6) +
                                         " kg/m^3, the model's is of " + core::format_number(own, 6) +
                                         " kg/m^3: the map takes the table's forces as they are",
                                     {model.name, {}, {}, {}}});
        }
    }
}

/// Of the points of the table at that place among the forces, in the folder of the model's tables.
std::string file_of(const TableSpec& table, std::size_t index) {
    return table.quantity + "-" + std::to_string(index + 1) + ".csv";
}

/// The model's text with one [[force]] for each table of the study, whose files are named by `place`.
std::string composed_text(const Study& study, const RegionSpec& spec, const StudyResults& results,
                          const std::string& place) {
    std::string text = core::read_file(spec.model);
    for (std::size_t i = 0; i < spec.forces.size(); ++i) {
        const TableSpec& table = *study.find_table(spec.forces[i]);
        text += "\n[[force]]                        # the study's table '" + spec.forces[i] +
                "'\nquantity = " + core::toml_string(table.quantity) +
                "\ntable = " + core::toml_string(place + file_of(table, i)) + "\n";
        text += "axes = [";
        for (const auto& axis : table.axes) {
            text += (&axis == &table.axes.front() ? "" : ", ") + core::toml_string(axis);
        }
        text += "]\nfit = " + core::toml_string(table.fit) + "\n";
        if (const auto speed = speed_of(table, table_points(table, results)); speed && table.speed_exponent != 0) {
            text += "scale.speed = { reference = \"" + core::format_number(*speed) +
                    " m/s\", exponent = " + core::format_number(table.speed_exponent) + " }\n";
        }
    }
    return text;
}

/// The declared model with the study's tables as its forces.
dynamics::Model composed_model(const Study& study, const RegionSpec& spec, const StudyResults& results,
                               const fs::path& scratch) {
    std::map<std::string, std::string> tables;  // what is said of a file that nobody has written is said of its table
    for (std::size_t i = 0; i < spec.forces.size(); ++i) {
        const TableSpec& table = *study.find_table(spec.forces[i]);
        core::Table points = table_points(table, results);
        if (const auto density = densities_of(study, table, results);
            density && density->first == density->second && points.find("density") == nullptr) {
            points.add_numbers("density", "kg/m^3", std::vector<double>(points.rows(), density->first));
        }
        points.comments.push_back("table '" + table.name + "' of the study '" + study.title + "'; " + study.origin);
        const fs::path file = scratch / file_of(table, i);
        core::write_csv(file, points);
        tables[file.string()] = points.source;
    }
    dynamics::Model model =
        dynamics::read_model_text(composed_text(study, spec, results, scratch.string() + "/"), spec.model.string(),
                                  spec.model.has_parent_path() ? spec.model.parent_path() : fs::path("."));
    for (core::Problem& remark : model.remarks) {
        if (const auto table = tables.find(remark.place.file); table != tables.end()) {
            remark.place = {table->second, {}, {}, {}};
        }
    }
    remark_on_speeds(model, study, spec, results);
    remark_on_weights(model, study, spec);
    remark_on_densities(model, study, spec, results);
    return model;
}

}  // namespace

dynamics::Model region_model(const Study& study, const RegionSpec& spec, const StudyResults& results,
                             const fs::path& tables) {
    if (!tables.empty()) {
        return composed_model(study, spec, results, tables);
    }
    const core::TemporaryFolder scratch;
    return composed_model(study, spec, results, scratch.path());
}

dynamics::RegionOptions region_options(const RegionSpec& spec) {
    dynamics::RegionOptions options;
    options.axes = core::parse_ranges(spec.axes);
    options.duration = spec.duration;
    options.columns = static_cast<std::size_t>(spec.columns);
    options.rows = static_cast<std::size_t>(spec.rows);
    return options;
}

}  // namespace underbody::cases
