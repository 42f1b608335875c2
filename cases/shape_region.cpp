#include "cases/shape_region.h"

#include <algorithm>

#include "cases/region_model.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::cases {

namespace {

const std::string lift_quantity = "lift_force";

/// A force that is nothing while the jet is off; one over the jet as an axis is the whole lift.
bool of_the_jet_alone(const dynamics::ForceSource& source) {
    return std::any_of(source.scales.begin(), source.scales.end(), [](const dynamics::ForceScale& scale) {
        return (scale.channel == dynamics::Channel::jet_voltage || scale.channel == dynamics::Channel::jet_flow) &&
               scale.exponent > 0;
    });
}

/// The known lift as a force of a model, and the speed that it is at.
struct LiftSource {
    dynamics::ForceSource source;
    std::optional<double> speed;
};

LiftSource lift_source(const StudyResults& results, const ShapeRegion& asked, const LearnedLoads* surrogate) {
    const auto made = [](tables::ForceTable table) {
        return dynamics::ForceSource{lift_quantity, {}, {}, std::move(table), {dynamics::Channel::gap}, {}};
    };
    if (asked.lift.basis == KnownLift::Basis::surrogate && surrogate != nullptr) {
        return {made(surrogate_lift_table(*surrogate, asked.lift, asked.pitch, asked.speed)),
                surrogate_speed(*surrogate, asked.speed)};
    }
    if (asked.lift.table == nullptr) {
        throw core::InputError("missing", "no lift of a shape like this one is known", {}, "ask for its CFD");
    }
    const TableSpec& table = *asked.lift.table;
    const core::Table points = table_points(table, results);
    LiftSource lift{made(tables::ForceTable::fit(points, table.quantity, fit_options(table))), speed_of(table, points)};
    if (lift.speed && table.speed_exponent != 0) {
        lift.source.scales.push_back({dynamics::Channel::speed, *lift.speed, table.speed_exponent});
    }
    return lift;
}

/// Any table that stands in the model as a lift over the gap alone.
const dynamics::ForceSource* lift_in(const dynamics::Model& model) {
    for (const auto& source : model.forces) {
        if (source.quantity == lift_quantity && source.axes == std::vector{dynamics::Channel::gap} &&
            !of_the_jet_alone(source)) {
            return &source;
        }
    }
    return nullptr;
}

}  // namespace

RegionSpec vehicle_of(const Study& study, const std::string& region) {
    for (const auto& one : study.regions) {
        if (one.name == region) {
            return one;
        }
    }
    if (!study.regions.empty()) {
        return study.regions.front();
    }
    if (study.measurements.empty()) {
        throw core::InputError("missing", "the study declares no vehicle", {},
                               "write its mass, drag and net weight as model.toml and name it in a [[region]]");
    }
    RegionSpec vehicle;
    vehicle.name = study.measurements.front().name;
    vehicle.model = study.measurements.front().model;
    return vehicle;
}

dynamics::Model shape_model(const Study& study, const StudyResults& results, const ShapeRegion& asked,
                            const LearnedLoads* surrogate) {
    LiftSource lift = lift_source(results, asked, surrogate);
    dynamics::Model model = region_model(study, asked.vehicle, results);
    // Before anything is replaced: the names of changed numbers count the forces as they were.
    for (const auto& [name, value] : asked.set) {
        model = model.with_parameter(name, value);
    }
    if (asked.net_weight) {
        model = model.with_parameter("vehicle.net_weight", *asked.net_weight);
    }
    model = model.resolved();
    const std::vector<std::string>& names = asked.vehicle.forces;
    const std::size_t own = model.forces.size() - names.size();
    std::vector<dynamics::ForceSource> forces;
    bool there = false;
    for (std::size_t i = 0; i < model.forces.size(); ++i) {
        // With its factor and scale as they were changed by hand.
        const bool same =
            asked.lift.basis != KnownLift::Basis::surrogate && i >= own && names[i - own] == asked.lift.table->name;
        if (same || model.forces[i].quantity != lift_quantity || of_the_jet_alone(model.forces[i])) {
            forces.push_back(std::move(model.forces[i]));
            there = there || same;
        }
    }
    if (!there) {
        forces.push_back(std::move(lift.source));
    }
    model.forces = std::move(forces);
    if (lift.speed) {
        model.conditions[dynamics::Channel::speed] = *lift.speed;
    }
    return model;
}

dynamics::RegionOptions shape_region_options(const ShapeRegion& asked, const dynamics::Model& model,
                                             std::size_t starts) {
    dynamics::RegionOptions options;
    const auto is = [](const core::NamedRange& axis, const char* name) { return axis.name == name; };
    if (!asked.vehicle.axes.empty()) {
        options = region_options(asked.vehicle);
    }
    if (options.axes.size() != 2 || !is(options.axes[0], "gap") || !is(options.axes[1], "heave_velocity")) {
        const auto* lift = lift_in(model);
        const double lower = lift != nullptr ? lift->table.axes().front().lower : 0;
        const double upper = lift != nullptr ? lift->table.axes().front().upper : 0.1;
        options.axes = {{"gap", lower, upper}, {"heave_velocity", -0.05, 0.05}};
    }
    options.duration = asked.vehicle.duration;
    options.columns = options.rows = starts;
    options.gap_by_ratio =
        options.axes[0].lower > 0 && tables::spans_decades(options.axes[0].lower, options.axes[0].upper);
    return options;
}

std::string vehicle_words(const ShapeRegion& asked, const dynamics::Model& model) {
    const auto number = [](double value) { return core::format_number(value, 4); };
    std::string words =
        asked.vehicle.model.filename().string() + ", net weight " + number(model.vehicle.net_weight) + " N, ";
    words += model.vehicle.added_mass_heave_table ? number(model.vehicle.mass) + " kg and its added mass over the gap"
                                                  : number(model.heave_mass()) + " kg with its added mass";
    return words + (model.conditions.has(dynamics::Channel::speed)
                        ? ", " + number(model.conditions[dynamics::Channel::speed]) + " m/s"
                        : "");
}

core::Figure shape_region_figure(const dynamics::StabilityRegion& region, const KnownLift& lift,
                                 const std::string& vehicle) {
    core::Figure figure = dynamics::region_figure(region);
    figure.title = lift.words();
    figure.caption = "Lift: " + lift.words() + ". Vehicle: " + vehicle + ". " + figure.caption;
    return figure;
}

}  // namespace underbody::cases
