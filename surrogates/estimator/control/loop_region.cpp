#include "surrogates/estimator/control/loop_region.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "core/text.h"
#include "surrogates/dynamics/basin/region_parts.h"

namespace underbody::estimator {

namespace {

using dynamics::End;
using dynamics::EndClass;
using dynamics::EndKind;

struct Outcome {
    EndKind kind = EndKind::undecided;
    double gap = NAN;  // at rest
    double time = 0;
    bool outside = false;  // of the force tables, at a sample
};

// Range and mean of the gap over a stretch of time.
struct Stretch {
    double lowest = INFINITY, highest = -INFINITY, sum = 0, count = 0;
    void add(double gap) {
        if (std::isfinite(gap)) {
            lowest = std::min(lowest, gap);
            highest = std::max(highest, gap);
            sum += gap;
            count += 1;
        }
    }
    [[nodiscard]] double mean() const { return sum / count; }
};

struct Judge {
    const SeparatedPlant& plant;
    const ControlLaw& law;
    const LoopEstimator& estimator;
    const LoopOptions& loop;
    double far = 0, tolerance = 0;

    [[nodiscard]] Outcome of(double gap, double velocity, std::uint64_t draw = 0) const {
        const std::uint64_t place =
            (std::bit_cast<std::uint64_t>(gap) * 0x9e3779b97f4a7c15ULL ^ std::bit_cast<std::uint64_t>(velocity)) +
            draw * 0xd1b54a32d192ed03ULL;
        Loop run(plant, law, estimator, loop, gap, velocity, place);
        const auto samples = static_cast<std::size_t>(std::round(loop.duration / loop.step));
        // At rest: the mean gap of one window after another stays, and so does the gap within each. Noise widens the
        // bands.
        const bool noisy = loop.gap_noise > 0 || loop.velocity_noise > 0 || loop.disturbance;
        const auto window = static_cast<std::size_t>(std::ceil((noisy ? 10.0 : 1.0) / loop.step));
        const double within = noisy ? tolerance : 2e-5, between = noisy ? 0.02 * tolerance + 4 * loop.gap_noise : 1e-5;
        double lowest = INFINITY, highest = -INFINITY, sum = 0, last = NAN;
        bool outside = gap < plant.lower || gap > plant.upper;
        Stretch third, fourth;
        for (std::size_t k = 1; k <= samples; ++k) {
            run.advance();
            const double h = run.gap(), time = loop.step * static_cast<double>(k);
            const double reached = std::clamp(h, plant.contact_gap, far);
            outside = outside || reached < plant.lower || reached > plant.upper;
            if (h <= plant.contact_gap) {
                return {EndKind::contact, NAN, time, outside};
            }
            if (!std::isfinite(h) || h > far) {
                return {EndKind::escape, NAN, time, outside};
            }
            lowest = std::min(lowest, h);
            highest = std::max(highest, h);
            sum += h;
            (4 * k > 3 * samples ? fourth : third).add(2 * k > samples ? h : NAN);
            if (k % window == 0) {
                const double mean = sum / static_cast<double>(window);
                if (highest - lowest < within && std::abs(mean - last) < between) {
                    return {EndKind::attractor, mean, time, outside};
                }
                last = mean;
                lowest = INFINITY;
                highest = -INFINITY;
                sum = 0;
            }
        }
        // Still swinging, but about one place: the means of the last two quarters agree beside the swing.
        const double swing = std::max(third.highest, fourth.highest) - std::min(third.lowest, fourth.lowest);
        if (swing < 10 * tolerance && std::abs(third.mean() - fourth.mean()) < 0.2 * swing + between) {
            return {EndKind::attractor, 0.5 * (third.mean() + fourth.mean()), loop.duration, outside};
        }
        return {EndKind::undecided, NAN, loop.duration, outside};
    }
};

// Gaps where starts come to rest, each once; the reference is not among them.
std::vector<double> resting_places(const std::vector<Outcome>& outcomes, double reference, double tolerance) {
    std::vector<double> gaps, places;
    for (const Outcome& o : outcomes) {
        if (o.kind == EndKind::attractor && std::abs(o.gap - reference) > tolerance) {
            gaps.push_back(o.gap);
        }
    }
    std::sort(gaps.begin(), gaps.end());
    for (std::size_t i = 0; i < gaps.size();) {
        std::size_t j = i;
        double sum = 0;
        for (; j < gaps.size() && (j == i || gaps[j] - gaps[j - 1] < 2 * tolerance); ++j) {
            sum += gaps[j];
        }
        places.push_back(sum / static_cast<double>(j - i));
        i = j;
    }
    return places;
}

std::string rule_of(const LoopEstimator& e, const ControlLaw& law, const LoopOptions& o) {
    const bool by_estimates = o.feedback == Feedback::estimated;
    std::string text = "loop closed, feedback on " + (by_estimates ? "the estimates of " + e.name : "the sensors") +
                       ", forces cancelled by: " + (law.cancel ? e.name : std::string("none")) + ", sample time " +
                       core::format_number(o.step, 3) + " s";
    if (std::isfinite(law.limit)) {
        text += ", limit " + core::format_number(1e3 * law.limit, 3) + " mN";
    }
    if (o.actuator_lag > 0) {
        text += ", lag " + core::format_number(o.actuator_lag, 3) + " s";
    }
    if (o.gap_noise > 0 || o.velocity_noise > 0) {
        text += ", sensor noise " + core::format_number(1e3 * o.gap_noise, 3) + " mm and " +
                core::format_number(1e3 * o.velocity_noise, 3) + " mm/s";
    }
    return text;
}

/// The grid of starts and who judges them.
struct Prepared {
    dynamics::RegionOptions grid;
    bool swapped = false;  ///< the first axis is heave_velocity
    Judge judge;
};

Prepared prepared(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
                  const LoopOptions& loop, const LoopRegionOptions& options) {
    dynamics::RegionOptions grid;
    grid.axes = options.axes;
    grid.columns = options.columns;
    grid.rows = options.rows;
    grid.duration = loop.duration;
    grid.refine = options.refine;
    dynamics::check_region_options(grid);
    const bool swapped = grid.axes[0].name == "heave_velocity";
    const core::NamedRange& gaps = grid.axes[swapped ? 1 : 0];
    if (gaps.name != "gap" || grid.axes[swapped ? 0 : 1].name != "heave_velocity") {
        throw core::InputError("name", "the region of a loop that holds a gap has the axes gap and heave_velocity");
    }
    const double length = gaps.upper - gaps.lower;
    const double tolerance = 0.02 * length;  // so near to the reference counts as held
    return {grid, swapped, {plant, law, estimator, loop, gaps.upper + length, tolerance}};
}

/// One draw: how many starts are held, and those that are added to the map.
std::size_t add_draw(dynamics::ProbabilityMap& map, const Prepared& ready, double reference_gap, std::size_t draw,
                     core::Progress& progress) {
    const std::size_t count = map.columns * map.rows;
    std::vector<unsigned char> held(count, 0), outside(count, 0);
    dynamics::region_grid(
        ready.grid,
        [&](std::span<const double> x, std::span<const double> y, std::span<End>) {
            core::parallel_for(
                count,
                [&](std::size_t i) {
                    const Outcome end =
                        ready.swapped ? ready.judge.of(y[i], x[i], draw) : ready.judge.of(x[i], y[i], draw);
                    outside[i] = end.outside ? 1 : 0;
                    held[i] =
                        end.kind == EndKind::attractor && std::abs(end.gap - reference_gap) <= ready.judge.tolerance;
                },
                progress);
        },
        progress);
    std::size_t good = 0;
    for (std::size_t i = 0; i < count; ++i) {
        map.safe[i] += held[i] != 0 ? 1.0F : 0.0F;
        good += held[i];
        map.path_outside_fraction += outside[i] / static_cast<double>(count * map.draws);
    }
    return good;
}

}  // namespace

dynamics::ProbabilityMap loop_probability(const SeparatedPlant& plant, const ControlLaw& law,
                                          const LoopEstimator& estimator, const LoopOptions& loop,
                                          const LoopRegionOptions& options, std::size_t draws,
                                          core::Progress& progress) {
    if (draws < 1) {
        throw core::UsageError("range", "a probability map needs at least one draw");
    }
    const Prepared ready = prepared(plant, law, estimator, loop, options);
    dynamics::ProbabilityMap map;
    map.axes = ready.grid.axes;
    map.columns = ready.grid.columns;
    map.rows = ready.grid.rows;
    map.draws = draws;
    const std::size_t count = map.columns * map.rows;
    map.safe.assign(count, 0.0F);
    double sum = 0, squares = 0;
    for (std::size_t draw = 0; draw < draws; ++draw) {
        progress.check();
        progress.report(static_cast<double>(draw) / static_cast<double>(draws), "drawing the sensors' noise");
        const std::size_t good = add_draw(map, ready, law.reference_gap, draw, progress);
        const double share = static_cast<double>(good) / static_cast<double>(count);
        sum += share;
        squares += share * share;
    }
    dynamics::take_mean(map, sum, squares);
    dynamics::add_path_remark(map.remarks, map.path_outside_fraction,
                              dynamics::table_range_text(plant.lower, plant.upper));
    if (!(loop.gap_noise > 0 || loop.velocity_noise > 0)) {
        map.remarks.push_back({core::Problem::Severity::note, "the sensors have no noise: every draw is the same", {}});
    }
    return map;
}

namespace {

/// The classes of a loop's ends: held, parked at other gaps, contact, escape, undecided.
struct LoopEnds {
    LoopEnds(double held_gap, const std::vector<double>& parked, double within)
        : held(held_gap), places(parked), tolerance(within), classes{{"held", EndKind::attractor, held_gap, 0}} {
        for (std::size_t i = 0; i < places.size(); ++i) {
            classes.push_back({"parked " + std::to_string(i + 1), EndKind::attractor, places[i], 0});
        }
        contact = static_cast<int>(classes.size());
        classes.push_back({"contact", EndKind::contact, NAN, 0});
        classes.push_back({"escape", EndKind::escape, NAN, 0});
        classes.push_back({"undecided", EndKind::undecided, NAN, 0});
    }

    [[nodiscard]] End end_of(const Outcome& o) const {
        if (o.kind == EndKind::contact || o.kind == EndKind::escape || o.kind == EndKind::undecided) {
            const int after = o.kind == EndKind::contact ? 0 : o.kind == EndKind::escape ? 1 : 2;
            return End{contact + after, o.time, o.outside};
        }
        if (std::abs(o.gap - held) <= tolerance || places.empty()) {
            return End{0, o.time, o.outside};
        }
        const auto nearest = std::min_element(places.begin(), places.end(), [&](double a, double b) {
            return std::abs(a - o.gap) < std::abs(b - o.gap);
        });
        return End{1 + static_cast<int>(nearest - places.begin()), o.time, o.outside};
    }

    double held;
    const std::vector<double>& places;
    double tolerance;
    std::vector<EndClass> classes;
    int contact = 0;
};

}  // namespace

dynamics::StabilityRegion loop_region(const SeparatedPlant& plant, const ControlLaw& law,
                                      const LoopEstimator& estimator, const LoopOptions& loop,
                                      const LoopRegionOptions& options, core::Progress& progress) {
    const Prepared ready = prepared(plant, law, estimator, loop, options);
    dynamics::RegionOptions grid = ready.grid;
    const bool swapped = ready.swapped;
    const Judge& judge = ready.judge;
    const double tolerance = judge.tolerance;
    const auto outcomes_of = [&](std::span<const double> x, std::span<const double> y) {
        std::vector<Outcome> outcomes(x.size());
        core::parallel_for(
            x.size(), [&](std::size_t i) { outcomes[i] = swapped ? judge.of(y[i], x[i]) : judge.of(x[i], y[i]); },
            progress);
        return outcomes;
    };
    // First the grid, to find the resting places; they are the classes of the refinement too.
    std::vector<Outcome> first;
    dynamics::region_grid(
        grid, [&](std::span<const double> x, std::span<const double> y, std::span<End>) { first = outcomes_of(x, y); },
        progress);
    const std::vector<double> places = resting_places(first, law.reference_gap, tolerance);
    const LoopEnds judged(law.reference_gap, places, tolerance);
    const auto end_of = [&](const Outcome& o) { return judged.end_of(o); };
    std::vector<End> ends;
    for (const Outcome& o : first) {
        ends.push_back(end_of(o));
    }
    dynamics::StabilityRegion region = dynamics::region_map(
        grid,
        [&](std::span<const double> x, std::span<const double> y, std::span<End> out) {
            const auto outcomes = outcomes_of(x, y);
            std::transform(outcomes.begin(), outcomes.end(), out.begin(), end_of);
        },
        ends, judged.classes, progress);
    region.contact_gap = plant.contact_gap;
    region.escape_gap = judge.far;
    region.table_lower = plant.lower;
    region.table_upper = plant.upper;
    region.rule = rule_of(estimator, law, loop);
    region.outside_fraction = dynamics::outside_share(region);
    region.remarks = plant.remarks;
    dynamics::add_outside_remarks(region);
    // Motions of a loop take long: lines midway between starts, without further runs.
    grid.refine = false;
    dynamics::add_traced_boundaries(region, grid, {}, ends, progress);
    return region;
}

}  // namespace underbody::estimator
