// Regions of heave and pitch together.
#include <algorithm>
#include <cmath>

#include "core/no_limit.h"
#include "core/parallel.h"
#include "core/told.h"
#include "surrogates/dynamics/basin/region_parts.h"
#include "surrogates/dynamics/basin/region_pitch_ends.h"
#include "surrogates/dynamics/simulate/feedback.h"

namespace underbody::dynamics {

namespace {

std::size_t state_of(const std::string& axis) {
    return axis == "gap" ? 0 : axis == "heave_velocity" ? 1 : axis == "pitch" ? 2 : 3;
}

void add_flow(const HeavePitch& plant, const RegionOptions& o, const PitchState& middle, StabilityRegion& region) {
    const std::size_t first = state_of(o.axes[0].name), second = state_of(o.axes[1].name);
    constexpr int across = 22, up = 14;
    for (int j = 0; j < up; ++j) {
        for (int i = 0; i < across; ++i) {
            PitchState y = middle, d{};
            y[first] = place_along(o.axes[0], o.gap_by_ratio, (i + 0.5) / across);
            y[second] = place_along(o.axes[1], o.gap_by_ratio, (j + 0.5) / up);
            const std::array<double, 2> gaps = plant.edge_gaps(y);
            if (std::min(gaps[0], gaps[1]) < 0) {
                continue;
            }
            plant.rate(y, ContactState::free, d);
            region.flow_x.push_back(y[first]);
            region.flow_y.push_back(y[second]);
            // From rest, over gap and pitch, both rates vanish: the accelerations say where a start sets off.
            const bool at_rest = first % 2 == 0 && second % 2 == 0 && d[first] == 0 && d[second] == 0;
            region.flow_dx.push_back(at_rest ? d[first + 1] : d[first]);
            region.flow_dy.push_back(at_rest ? d[second + 1] : d[second]);
        }
    }
}

/// Everything a region or a list of starts needs of a model.
struct PitchSetup {
    HeavePitch plant;
    PitchState middle{}, sizes{};
    double escape = 0;

    PitchSetup(const Model& model, const RegionOptions& options, double highest_start = -core::no_limit)
        : plant(model, options.held) {
        if (options.pitch_feedback) {
            plant.close_loop(*options.pitch_feedback);
        } else if (options.feedback) {
            PitchFeedback heave;
            heave.force_gain = {options.feedback->gap_gain, options.feedback->velocity_gain, 0, 0};
            heave.reference[0] = options.feedback->reference;
            heave.force_limit = options.feedback->limit;
            plant.close_loop(heave);
        }
        const double top = core::is_limit(plant.table_upper()) ? plant.table_upper() : 1.0;
        middle = {options.held.get(Channel::gap, 0.5 * top), options.held.get(Channel::heave_velocity, 0),
                  options.held.get(Channel::pitch, 0), options.held.get(Channel::pitch_rate, 0)};
        constexpr double usual_speed = 0.1, usual_pitch = 0.2, usual_rate = 0.2;  // m/s, rad, rad/s: no axes of the map
        sizes = {top - plant.contact_gap(), usual_speed, usual_pitch, usual_rate};
        double highest = std::max(middle[0], highest_start);
        for (const core::NamedRange& axis : options.axes) {
            sizes[state_of(axis.name)] = axis.upper - axis.lower;
            highest = axis.name == "gap" ? std::max(axis.upper, highest_start) : highest;
        }
        escape = std::isnan(options.escape_gap) ? std::max(top, highest) : options.escape_gap;
    }
};

std::string rule_of(const RegionOptions& options) {
    return std::string(
               "heave and pitch coupled: a start belongs to an attractor once inside a level set of a Lyapunov "
               "function that falls on every shell (checked at 1500 points each), or when its swing over the last "
               "quarter of the time shrinks; ") +
           (options.through_contact ? "impacts are gone through, contact is to come to rest on the ground"
                                    : "contact is the first touch of an edge");
}

}  // namespace

StabilityRegion pitch_region(const Model& model, const RegionOptions& options, core::Progress& progress) {
    const PitchSetup setup(model, options);
    const HeavePitch& plant = setup.plant;
    check_gap_axis(options, plant.contact_gap());
    const std::size_t first = state_of(options.axes[0].name), second = state_of(options.axes[1].name);
    if (first != 0 && second != 0 && !options.held.has(Channel::gap)) {
        throw core::InputError("missing", "the region holds the gap, but nothing says at what", {},
                               "give it: option 'conditions gap=20mm'");
    }
    const PitchEnds ends(plant, options, setup.escape, setup.sizes);
    progress.report(0.02, "finding where starts end");
    const RegionBatch batch = [&](std::span<const double> x, std::span<const double> y, std::span<End> out) {
        core::parallel_blocks(
            x.size(), 16,
            [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    PitchState state = setup.middle;
                    state[first] = x[i];
                    state[second] = y[i];
                    out[i] = ends.of(state);
                }
            },
            progress);
    };
    const std::vector<End> found = region_grid(options, batch, progress);
    StabilityRegion region = region_map(options, batch, found, ends.classes(), progress);
    region.contact_gap = plant.contact_gap();
    region.table_lower = plant.table_lower();
    region.table_upper = plant.table_upper();
    region.pitch_lower = plant.pitch_lower();
    region.pitch_upper = plant.pitch_upper();
    region.escape_gap = setup.escape;
    region.equilibria = ends.equilibria();
    region.model = model.name;
    region.held = options.held.over(model.conditions);
    region.rule = rule_of(options);
    add_traced_boundaries(region, options, batch, found, progress);
    region.outside_fraction = outside_share(region);
    add_flow(plant, options, setup.middle, region);
    add_model_remarks(region, model, options.held);
    return region;
}

FoundEnds pitch_ends_of_starts(const Model& model, const core::Table& starts, const RegionOptions& options,
                               core::Progress& progress) {
    const char* names[] = {"gap", "heave_velocity", "pitch", "pitch_rate"};
    const std::vector<double>& gap = starts.numbers("gap");
    const RegionOptions& each = options;
    const PitchSetup setup(model, each, gap.empty() ? -core::no_limit : *std::max_element(gap.begin(), gap.end()));
    std::vector<PitchState> states(starts.rows(), setup.middle);
    for (std::size_t k = 0; k < 4; ++k) {
        if (!starts.find(names[k])) {
            continue;
        }
        const std::vector<double>& column = starts.numbers(names[k]);
        for (std::size_t i = 0; i < states.size(); ++i) {
            if (!std::isfinite(column[i])) {
                throw core::InputError("missing", std::string("a start has no ") + names[k], starts.place(i, names[k]));
            }
            states[i][k] = column[i];
        }
    }
    for (std::size_t i = 0; i < states.size(); ++i) {
        const std::array<double, 2> gaps = setup.plant.edge_gaps(states[i]);
        if (std::min(gaps[0], gaps[1]) < 0) {
            throw core::InputError("range",
                                   "a start lies in the ground: gaps of nose and tail edge " +
                                       core::told(gaps[0], "m", 4) + ", " + core::told(gaps[1], "m", 4),
                                   starts.place(i, "gap"));
        }
    }
    const PitchEnds judge(setup.plant, each, setup.escape, setup.sizes);
    std::vector<End> ends(states.size());
    core::parallel_blocks(
        states.size(), 16,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                ends[i] = judge.of(states[i]);
            }
        },
        progress);
    const HeavePitch& plant = setup.plant;
    return {std::move(ends), judge.classes(),
            table_range_text(plant.table_lower(), plant.table_upper(), plant.pitch_lower(), plant.pitch_upper())};
}

}  // namespace underbody::dynamics
