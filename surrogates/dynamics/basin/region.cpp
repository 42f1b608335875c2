#include "surrogates/dynamics/basin/region.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "core/no_limit.h"
#include "core/parallel.h"
#include "core/text.h"
#include "core/told.h"
#include "surrogates/dynamics/basin/region_parts.h"
#include "surrogates/dynamics/model/simulated_columns.h"
#include "surrogates/dynamics/plant/environment.h"
#include "surrogates/dynamics/simulate/dormand_prince.h"
#include "surrogates/dynamics/simulate/feedback.h"

namespace underbody::dynamics {

namespace {

constexpr double least_room = 1e-3;                    ///< m, between contact and escape
constexpr double line_error = 1e-9, line_step = 1e-3;  ///< of the axes, a step; s, the first: of a boundary's line
constexpr double grazing = 1e-12;                      ///< m, m/s, off the ground or the rim

/// nullptr when the name is not an axis.
const core::NamedRange* axis_of(const RegionOptions& options, const std::string& name) {
    for (const core::NamedRange& axis : options.axes) {
        if (axis.name == name) {
            return &axis;
        }
    }
    return nullptr;
}

}  // namespace

HeaveRegionSetup::HeaveRegionSetup(const Model& model, const RegionOptions& options,
                                   const std::vector<double>* start_gaps)
    : plant(model, options.held) {
    if (options.feedback) {
        close_loop(plant, *options.feedback);
    }
    const core::NamedRange* gap_axis = axis_of(options, "gap");
    const core::NamedRange* velocity_axis = axis_of(options, "heave_velocity");
    contact_gap = plant.terms.contact_gap;
    double top = core::is_limit(plant.terms.table_upper) ? plant.terms.table_upper : contact_gap + 1;
    double highest = gap_axis ? gap_axis->upper : start_gaps ? contact_gap : options.held.get(Channel::gap, top);
    if (start_gaps) {
        for (const double gap : *start_gaps) {
            highest = std::max(highest, gap);
        }
    }
    top = std::max(top, highest * (highest > 0 ? 1.0 : -1.0));
    escape_gap = std::isnan(options.escape_gap) ? std::max(top, contact_gap + least_room) : options.escape_gap;
    if (escape_gap <= contact_gap) {
        throw core::InputError("range", "the escape gap " + core::told(escape_gap, "m") +
                                            " is not above the contact gap " + core::told(contact_gap, "m"));
    }
    const double gap_size =
        gap_axis ? std::min(gap_axis->upper - gap_axis->lower, escape_gap - contact_gap) : escape_gap - contact_gap;
    const double velocity_size = velocity_axis ? velocity_axis->upper - velocity_axis->lower : 0.1;
    ends = std::make_unique<HeaveEnds>(plant, contact_gap, escape_gap, options.duration, options.tolerance, gap_size,
                                       velocity_size);
}

namespace {

struct BackwardRate {
    const HeavePlant* plant;
    double input;
    void operator()(double, const double* y, double* d) const {
        HeaveMoment moment;
        moment.input = input;
        d[0] = -y[1];
        d[1] = -plant->acceleration(y[0], y[1], moment);
    }
};

/// The motion backward in time from a point until it leaves a box three times as large as the map.
RegionBoundary backward(const HeaveRegionSetup& setup, const RegionOptions& o, bool gap_first, const std::string& name,
                        double gap, double velocity) {
    const core::NamedRange& ga = gap_first ? o.axes[0] : o.axes[1];
    const core::NamedRange& va = gap_first ? o.axes[1] : o.axes[0];
    const double gap_size = ga.upper - ga.lower, velocity_size = va.upper - va.lower;
    RegionBoundary line;
    line.name = name;
    const BackwardRate rate{&setup.plant, setup.plant.held_input()};
    DormandPrince<2, BackwardRate> ode(rate, 0.0, {gap, velocity}, {line_error * gap_size, line_error * velocity_size},
                                       line_step);
    const auto add = [&](double h, double w) {
        line.x.push_back(gap_first ? h : w);
        line.y.push_back(gap_first ? w : h);
    };
    add(gap, velocity);
    while (ode.t() < 20 * o.duration && line.x.size() < 20000) {
        if (!ode.step(20 * o.duration)) {
            break;
        }
        for (int k = 1; k <= 4; ++k) {
            add(ode.between(k / 4.0, 0), ode.between(k / 4.0, 1));
        }
        const double h = ode.y()[0], w = ode.y()[1];
        if (h < std::max(ga.lower - gap_size, setup.contact_gap) ||
            h > std::min(ga.upper + gap_size, setup.escape_gap) || w < va.lower - velocity_size ||
            w > va.upper + velocity_size) {
            break;
        }
    }
    return line;
}

void add_boundaries(const HeaveRegionSetup& setup, const RegionOptions& o, bool gap_first, StabilityRegion& region) {
    const HeavePlant& plant = setup.plant;
    const core::NamedRange& ga = gap_first ? o.axes[0] : o.axes[1];
    const double nudge = 1e-6 * (ga.upper - ga.lower);
    for (const HeaveEquilibrium& e : region.equilibria) {
        if (e.stable || e.gap <= setup.contact_gap || e.gap >= setup.escape_gap) {
            continue;
        }
        double slope = 0;
        const double mass = plant.inertia(e.gap, slope);
        const double damping = (plant.resistance(e.gap, 1e-7) - plant.resistance(e.gap, -1e-7)) / 2e-7;
        const double half = damping / (2 * mass);
        const double along = -half - std::sqrt(half * half - e.stiffness / mass);
        for (const double side : {-1.0, 1.0}) {
            region.boundaries.push_back(
                backward(setup, o, gap_first, e.name, e.gap + side * nudge, side * nudge * along));
        }
    }
    // Where the ground (or the rim) pushes back, the motion that just grazes it parts those that touch from those that
    // do not.
    if (plant.static_force(setup.contact_gap) > 0) {
        region.boundaries.push_back(
            backward(setup, o, gap_first, "grazes the ground", setup.contact_gap + grazing, -grazing));
    }
    if (plant.static_force(setup.escape_gap) < 0) {
        region.boundaries.push_back(
            backward(setup, o, gap_first, "grazes the upper end", setup.escape_gap - grazing, grazing));
    }
}

/// A range that is too short calls motions lost that come back.
void remark_on_escapes(const HeaveRegionSetup& setup, const RegionOptions& options, StabilityRegion& region) {
    const bool escapes = std::any_of(region.classes.begin(), region.classes.end(), [](const EndClass& end) {
        return end.kind == EndKind::escape && end.fraction > 0;
    });
    if (escapes && std::isnan(options.escape_gap) && setup.plant.static_force(setup.escape_gap) < 0) {
        region.escapes_return = core::Problem{
            core::Problem::Severity::warning,
            "escape is counted where a motion passes " + core::format_number(1e3 * setup.escape_gap, 5) +
                " mm, the upper end of tables and map, but the force there pulls the vehicle back: many of "
                "these motions return. A larger escape gap, or a map to larger gaps, follows them",
            {}};
        region.remarks.push_back(*region.escapes_return);
    }
}

void add_flow(const HeaveRegionSetup& setup, const RegionOptions& o, bool gap_first, StabilityRegion& region) {
    constexpr int across = 22, up = 14;
    const HeavePlant& plant = setup.plant;
    for (int j = 0; j < up; ++j) {
        for (int i = 0; i < across; ++i) {
            const double x = place_along(o.axes[0], o.gap_by_ratio, (i + 0.5) / across);
            const double y = place_along(o.axes[1], o.gap_by_ratio, (j + 0.5) / up);
            const double h = gap_first ? x : y, w = gap_first ? y : x;
            if (h < setup.contact_gap) {
                continue;
            }
            HeaveMoment moment = plant.held_moment();
            // With delay or lag in the loop: as after having stood in this state for long.
            moment.input = plant.loop_has_states() ? plant.closed_input(h, w, moment.input).force : moment.input;
            const double a = plant.acceleration(h, w, moment);
            region.flow_x.push_back(x);
            region.flow_y.push_back(y);
            region.flow_dx.push_back(gap_first ? w : a);
            region.flow_dy.push_back(gap_first ? a : w);
        }
    }
}

std::string rule_text(const std::string& rule) {
    if (rule == "energy") {
        return "a start belongs to an attractor once its energy is below the rim of the attractor's well, which it "
               "then cannot leave; contact and "
               "escape within the time given";
    }
    if (rule == "energy without loss") {
        return "nothing takes energy out of the motion: it circles for ever where it cannot leave a well";
    }
    return "forces change with time or memory, or feed the motion: a start belongs to an attractor when its swing over "
           "the last quarter of the time is small "
           "or shrinks, to a cycle when it stays as large";
}

void add_remarks(StabilityRegion& region, const Model& model, const Conditions& held) {
    add_model_remarks(region, model, held);
    if (region.rule.starts_with("nothing takes")) {
        region.remarks.push_back(
            {core::Problem::Severity::warning, "the model has no resistance in heave: it never settles", {}});
    }
}

}  // namespace

StabilityRegion stability_region(const Model& model, const RegionOptions& options, core::Progress& progress) {
    check_region_options(options);
    if (in_heave_and_pitch(options)) {
        return pitch_region(model, options, progress);
    }
    if (!axis_of(options, "gap") || !axis_of(options, "heave_velocity")) {
        throw core::InputError(
            "range", "heave alone has the states gap and heave_velocity: a region in heave needs both", {},
            "leave out option 'motion heave', or use option 'axes gap=0:0.5,heave_velocity=-0.1:0.1'");
    }
    const HeaveRegionSetup setup(model, options);
    check_gap_axis(options, setup.contact_gap);
    const bool gap_first = options.axes[0].name == "gap";
    progress.report(0.02, "finding where starts end");
    const RegionBatch batch = [&](std::span<const double> x, std::span<const double> y, std::span<End> out) {
        setup.ends->of(gap_first ? x : y, gap_first ? y : x, out, progress);
    };
    const std::vector<End> ends = region_grid(options, batch, progress);
    StabilityRegion region = region_map(options, batch, ends, setup.ends->classes(), progress);
    region.contact_gap = setup.contact_gap;
    region.escape_gap = setup.escape_gap;
    region.table_lower = setup.plant.terms.table_lower;
    region.table_upper = setup.plant.terms.table_upper;
    region.equilibria = setup.ends->equilibria();
    region.model = model.name;
    region.held = setup.plant.held();
    region.rule = rule_text(setup.ends->rule());
    region.outside_fraction = outside_share(region);
    if (setup.ends->rule() == "settled") {
        add_traced_boundaries(region, options, batch, ends, progress);
    } else {
        add_boundaries(setup, options, gap_first, region);
    }
    add_flow(setup, options, gap_first, region);
    add_remarks(region, model, options.held);
    remark_on_escapes(setup, options, region);
    return region;
}

namespace {

FoundEnds heave_ends_of_starts(const Model& model, const core::Table& starts, const RegionOptions& options,
                               core::Progress& progress) {
    const std::vector<double>& gap = starts.numbers("gap");
    const std::vector<double> velocity =
        starts.find("heave_velocity")
            ? starts.numbers("heave_velocity")
            : std::vector<double>(starts.rows(), options.held.get(Channel::heave_velocity, 0));
    const HeaveRegionSetup setup(model, options, &gap);
    for (std::size_t i = 0; i < gap.size(); ++i) {
        if (!std::isfinite(gap[i]) || !std::isfinite(velocity[i])) {
            throw core::InputError("missing", "a start has no gap or no velocity", starts.place(i, "gap"));
        }
        if (gap[i] < setup.contact_gap) {
            throw core::InputError("range",
                                   "a start lies in the ground: gap " + core::told(gap[i], "m") + " is below " +
                                       core::told(setup.contact_gap, "m"),
                                   starts.place(i, "gap"));
        }
    }
    std::vector<End> ends(gap.size());
    setup.ends->of(gap, velocity, ends, progress);
    const HeaveTerms& terms = setup.plant.terms;
    return {std::move(ends), setup.ends->classes(), table_range_text(terms.table_lower, terms.table_upper)};
}

}  // namespace

StartEnds ends_of_starts(const Model& model, const core::Table& starts, const RegionOptions& options,
                         core::Progress& progress) {
    FoundEnds found = in_heave_and_pitch(options, &starts) ? pitch_ends_of_starts(model, starts, options, progress)
                                                           : heave_ends_of_starts(model, starts, options, progress);
    std::vector<std::string> names, kinds;
    std::vector<double> times, outside;
    for (const End& end : found.ends) {
        EndClass& of = found.classes[static_cast<std::size_t>(end.index)];
        of.fraction += 1.0 / static_cast<double>(found.ends.size());
        of.outside += end.outside ? 1.0 / static_cast<double>(found.ends.size()) : 0.0;
        outside.push_back(end.outside ? 1 : 0);
        names.push_back(of.name);
        kinds.emplace_back(end_kind_name(of.kind));
        times.push_back(end.time);
    }
    StartEnds result{starts, std::move(found.classes), motion_remarks(model, options.held)};
    result.table.add_text("class", names);
    result.table.add_text("kind", kinds);
    result.table.add_numbers("time", "s", times);
    result.table.add_numbers(outside_table_column, "1", outside);
    const double share =
        outside.empty() ? 0
                        : std::accumulate(outside.begin(), outside.end(), 0.0) / static_cast<double>(outside.size());
    add_path_remark(result.remarks, share, found.range);
    return result;
}

RegionSweep swept_regions(const Model& model, const RegionOptions& options, const core::NamedRange& range,
                          std::size_t count, core::Progress& progress) {
    Channel channel{};
    if (!find_channel(range.name, channel)) {
        throw core::InputError("name", "'" + range.name + "' cannot be swept", {},
                               core::did_you_mean(range.name, channel_names()));
    }
    if (axis_of(options, range.name)) {
        throw core::InputError("range", "'" + range.name + "' is an axis of the region: it cannot be swept too");
    }
    if (count < 2 || count > 1000) {
        throw core::InputError("range", "a sweep has between 2 and 1000 values");
    }
    RegionSweep sweep;
    sweep.name = range.name;
    RegionOptions each = options;
    if (channel == Channel::pitch || channel == Channel::pitch_rate) {
        each.motion = RegionOptions::Motion::heave_pitch;
    }
    for (std::size_t i = 0; i < count; ++i) {
        progress.check();
        sweep.value.push_back(range.lower +
                              (range.upper - range.lower) * static_cast<double>(i) / static_cast<double>(count - 1));
        each.held[channel] = sweep.value.back();
        sweep.regions.push_back(stability_region(model, each, progress));
    }
    return sweep;
}

core::Table region_table(const StabilityRegion& region) {
    core::Table table;
    std::vector<double> x, y, time;
    std::vector<std::string> names, kinds;
    for (std::size_t k = 0; k < region.index.size(); ++k) {
        const auto part = [&](const core::NamedRange& axis, std::size_t i, std::size_t count) {
            return place_along(axis, region.gap_by_ratio, (static_cast<double>(i) + 0.5) / static_cast<double>(count));
        };
        x.push_back(part(region.axes[0], k % region.columns, region.columns));
        y.push_back(part(region.axes[1], k / region.columns, region.rows));
        const EndClass& end = region.classes[static_cast<std::size_t>(region.index[k])];
        names.push_back(end.name);
        kinds.emplace_back(end_kind_name(end.kind));
        time.push_back(static_cast<double>(region.time[k]));
    }
    Channel channel{};
    for (const std::size_t axis : {0, 1}) {
        find_channel(region.axes[axis].name, channel);
        table.add_numbers(region.axes[axis].name, channel_unit(channel), axis == 0 ? x : y);
    }
    table.add_text("class", names);
    table.add_text("kind", kinds);
    table.add_numbers("time", "s", time);
    return table;
}

double StabilityRegion::fraction(const std::string& class_name) const {
    for (const EndClass& end : classes) {
        if (end.name == class_name) {
            return end.fraction;
        }
    }
    return 0;
}

std::size_t StabilityRegion::count(EndKind kind) const {
    return static_cast<std::size_t>(std::count_if(
        index.begin(), index.end(), [&](int i) { return classes[static_cast<std::size_t>(i)].kind == kind; }));
}

void to_json(nlohmann::json& json, const StabilityRegion& region) {
    json = nlohmann::json::object();
    json["model"] = region.model;
    json["axes"] = nlohmann::json::array();
    for (const core::NamedRange& axis : region.axes) {
        json["axes"].push_back({{"name", axis.name}, {"lower", axis.lower}, {"upper", axis.upper}});
    }
    json["columns"] = region.columns;
    json["rows"] = region.rows;
    json["duration"] = region.duration;
    json["contact_gap"] = region.contact_gap;
    json["escape_gap"] = region.escape_gap;
    json["outside_table_fraction"] = region.outside_fraction;
    json["outside_table_path_fraction"] = region.path_outside_fraction;
    json["rule"] = region.rule;
    json["classes"] = nlohmann::json::array();
    for (const EndClass& end : region.classes) {
        nlohmann::json one = {{"name", end.name},
                              {"kind", end_kind_name(end.kind)},
                              {"fraction", end.fraction},
                              {"outside_table_path_fraction", end.outside}};
        if (!std::isnan(end.gap)) {
            one["gap"] = end.gap;
        }
        json["classes"].push_back(one);
    }
    json["equilibria"] = nlohmann::json::array();
    for (const HeaveEquilibrium& e : region.equilibria) {
        json["equilibria"].push_back({{"name", e.name},
                                      {"gap", e.gap},
                                      {"stable", e.stable},
                                      {"stiffness", e.stiffness},
                                      {"frequency", e.frequency},
                                      {"frequency_unit", "rad/s"},
                                      {"frequency_in_hertz", e.frequency / (2 * std::numbers::pi)},
                                      {"damping_ratio", e.damping_ratio},
                                      {"growth", e.growth}});
    }
    json["remarks"] = nlohmann::json::array();
    for (const core::Problem& remark : region.remarks) {
        json["remarks"].push_back(remark.message);
    }
}

}  // namespace underbody::dynamics
