#include "cases/found_force.h"

#include <algorithm>
#include <cmath>

#include "cases/accept.h"
#include "core/file.h"
#include "core/hash.h"
#include "surrogates/dynamics/model/force_tables.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// Points that were written to a file and read back; their order stays.
bool same_points(const core::Table& a, const core::Table& b, const TableSpec& spec) {
    std::vector<std::string> columns = spec.axes;
    columns.push_back(spec.quantity);
    const auto near = [](double x, double y) { return std::abs(x - y) <= 1e-9 * (std::abs(x) + std::abs(y)); };
    return a.rows() == b.rows() && std::all_of(columns.begin(), columns.end(), [&](const std::string& name) {
               const auto *of_a = a.find(name), *of_b = b.find(name);
               return of_a != nullptr && of_b != nullptr && !of_a->is_text() && !of_b->is_text() &&
                      std::equal(of_a->numbers.begin(), of_a->numbers.end(), of_b->numbers.begin(), near);
           });
}

/// Names of the effects that change the force at rest and go with the vehicle.
std::string effects_on(const dynamics::Model& model, const std::string& quantity) {
    std::string names;
    for (const auto& use : model.effects) {
        const auto& info = dynamics::effect(use.name).info();
        const bool of_the_force = !info.takes_parameter || use.parameter.starts_with("force");
        if (!info.belongs_to_the_rig && info.seen_in != dynamics::SeenIn::time_series && of_the_force &&
            (use.quantity.empty() || use.quantity == quantity)) {
            names += (names.empty() ? "" : ", ") + use.name;
        }
    }
    return names;
}

/// The text of the model and of what lies beside it.
std::string digest_of(const fs::path& model, const dynamics::Model& read) {
    std::string text = core::read_file(model);
    for (const auto& source : read.forces) {
        text += "\n" + core::read_file(source.table_path);
    }
    return core::content_hash(text);
}

std::optional<FoundForce> found_in(const MeasurementSpec& measurement, const core::Table& points,
                                   const TableSpec& spec) {
    const auto model = dynamics::read_model(measurement.model);
    const auto of_quantity = [&](const auto& source) { return source.quantity == spec.quantity; };
    const auto source = std::find_if(model.forces.begin(), model.forces.end(), of_quantity);
    const auto effects = effects_on(model, spec.quantity);
    if (effects.empty() || std::count_if(model.forces.begin(), model.forces.end(), of_quantity) != 1 ||
        !same_points(points, source->table.points(), spec)) {
        return std::nullopt;
    }
    return FoundForce{measurement.name, measurement.model, effects, digest_of(measurement.model, model)};
}

}  // namespace

std::optional<FoundForce> found_force(const Study& study, const StudyResults& results, const TableSpec& spec,
                                      const std::set<std::string>& accepted) {
    std::optional<core::Table> points;
    for (const auto& one : study.measurements) {
        const bool written = same_place(one.model, study.folder() / accepted_model(one.name));
        if (!written && !accepted.contains(one.name)) {
            continue;
        }
        try {
            points = points ? points : table_points(spec, results);
            if (auto found = found_in(one, *points, spec)) {
                return found;
            }
        } catch (const core::Error&) {  // its own step says why
        }
    }
    return std::nullopt;
}

tables::ForceTable table_of_found(const FoundForce& found, const TableSpec& spec, const tables::RangePolicies& range,
                                  core::Progress& progress) {
    dynamics::ForceTablesOptions options;
    options.quantities = {spec.quantity};
    options.range = range;
    for (const auto& axis : spec.axes) {
        options.axes.push_back({axis, {}, {}});
    }
    auto model = dynamics::read_model(found.model);
    model.name = accepted_model(found.measurement).generic_string();  // where it is written, wherever it lies now
    auto made = dynamics::force_tables(model, options, progress);
    return std::move(made.tables.front());
}

}  // namespace underbody::cases
