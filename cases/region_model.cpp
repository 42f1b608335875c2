// The model behind a stability map of a study.
#include "cases/region_model.h"

#include "core/file.h"
#include "core/text.h"
#include "core/toml.h"
#include "core/units.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// The model's text with one [[force]] for each table of the study, whose files are named by `place`.
std::string composed_text(const Study& study, const RegionSpec& spec, const std::string& place) {
    std::string text = core::read_file(spec.model);
    for (std::size_t i = 0; i < spec.forces.size(); ++i) {
        const TableSpec& table = *study.find_table(spec.forces[i]);
        text += "\n[[force]]                        # the study's table '" + spec.forces[i] + "'\nquantity = " +
                core::toml_string(table.quantity) + "\ntable = " +
                core::toml_string(place + table.quantity + "-" + std::to_string(i + 1) + ".csv") + "\n";
        if (const auto speed = table.where.number("speed"); speed && *speed > 0) {
            text += "scale.speed = { reference = \"" + core::format_number(*speed) + " m/s\", exponent = 2 }\n";
        }
    }
    return text;
}

/// The declared model with the study's tables as its forces.
dynamics::Model composed_model(const Study& study, const RegionSpec& spec, const StudyResults& results, const fs::path& scratch) {
    for (std::size_t i = 0; i < spec.forces.size(); ++i) {
        const TableSpec& table = *study.find_table(spec.forces[i]);
        core::Table points = table_points(table, results);
        points.comments.push_back("table '" + table.name + "' of the study '" + study.title + "'; " + study.origin);
        core::write_csv(scratch / (table.quantity + "-" + std::to_string(i + 1) + ".csv"), points);
    }
    return dynamics::read_model_text(composed_text(study, spec, scratch.string() + "/"), spec.model.string(),
                                     spec.model.has_parent_path() ? spec.model.parent_path() : fs::path("."));
}

}  // namespace

dynamics::Model region_model(const Study& study, const RegionSpec& spec, const StudyResults& results, const fs::path& tables) {
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
