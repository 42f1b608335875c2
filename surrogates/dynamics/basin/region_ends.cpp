#include <algorithm>
#include <array>
#include <cmath>

#include "core/no_limit.h"
#include "core/parallel.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/basin/region_parts.h"
#include "surrogates/dynamics/plant/loop_actuator.h"
#include "surrogates/dynamics/simulate/dormand_prince.h"

namespace underbody::dynamics {

namespace {

constexpr std::array<double, 3> checked_at{0.15, 0.45, 0.75};  ///< of a stretch of the curve of static force
constexpr double curve_error = 1e-11;                          ///< of the largest force
constexpr double same_slope = 1e-7;                            ///< of two stretches that meet
constexpr double least_stretch = 1e-12, knot_apart = 1e-10;    ///< of the range, of a stretch
constexpr double rounding = 1e-15;
constexpr double rest_gap = 1e-3;    ///< m, at which a resistance without speed is told from one by speed
constexpr double speed_ratio = 1.3;  ///< between the speeds at which a resistance is asked whether it takes energy
constexpr double near_ground = 1e-4, far_from_ground = 0.3;  ///< m; of the way to escape: the gaps for that
constexpr double below_rim = 1e-12;    ///< of a well's depth: rounding never captures what would pass
constexpr double last_quarter = 0.75;  ///< of the time, whose swing is compared with the one before
constexpr double at_rest = 2e-3;       ///< swing over a well's width: less is rest
constexpr double shrinking = 0.9;      ///< ratio of the two swings: less goes to rest
constexpr double steady_swing = 0.05;  ///< change of the swing: less is a cycle

/// Ends, and the knots of the lift between them.
std::vector<double> static_knots(const HeavePlant& plant, double lower, double upper) {
    std::vector<double> knots{lower, upper};
    if (!plant.lift_curve().empty()) {
        for (const double knot : plant.lift_curve().knots()) {
            if (knot > lower && knot < upper) {
                knots.push_back(knot);
            }
        }
    }
    std::sort(knots.begin(), knots.end());
    // Knots a hair apart keep two tables apart where one ends; here each stretch takes its slopes from its own inside.
    const double hair = 1e-8 * (upper - lower);
    knots.erase(std::unique(knots.begin(), knots.end(), [hair](double l, double r) { return r - l <= hair; }),
                knots.end());
    return knots;
}

/// Knots with values and slopes, gathered piece by piece from below.
struct PiecewiseKnots {
    std::vector<double> x, value, slope;

    struct Knot {
        double x, value, slope;
    };
    /// Two knots a hair apart stand where the slopes of two pieces differ: each piece keeps its own.
    void add(const Knot& left, const Knot& right, double alike) {
        if (!x.empty() && std::abs(slope.back() - left.slope) <= alike) {
            x.pop_back();
            value.pop_back();
            slope.pop_back();
            x.push_back(left.x);
        } else if (!x.empty()) {
            x.push_back(left.x + std::max(knot_apart * (right.x - left.x), rounding * std::abs(left.x)));
        } else {
            x.push_back(left.x);
        }
        value.push_back(left.value);
        slope.push_back(left.slope);
        x.push_back(right.x);
        value.push_back(right.value);
        slope.push_back(right.slope);
    }
};

/// Everything that acts on the body at rest, against the gap, as one curve over [lower, upper].
Curve static_curve(const HeavePlant& plant, double lower, double upper) {
    const std::vector<double> knots = static_knots(plant, lower, upper);
    const double size = [&] {
        double largest = core::least_divisor;
        for (const double h : knots) {
            largest = std::max(largest, std::abs(plant.static_force(h)));
        }
        return largest;
    }();
    PiecewiseKnots curve;
    const auto f = [&](double h) { return plant.static_force(h); };
    // Slopes from inside the interval: exact for a cubic, and right on both sides of the kinks of a clamped table.
    const auto end_slope = [&](double end, double inner) {
        const double d = (inner - end) / 3;
        return (-11 * f(end) + 18 * f(end + d) - 9 * f(end + 2 * d) + 2 * f(inner)) / (6 * d);
    };
    const auto refine = [&](auto&& self, double l, double r, int depth) -> void {
        const double sl = end_slope(l, r), sr = end_slope(r, l), width = r - l;
        const double vl = f(l), vr = f(r);
        double worst = 0;
        for (const double t : checked_at) {
            const double q = 1 - t;
            const double hermite =
                vl * q * q * (1 + 2 * t) + vr * t * t * (3 - 2 * t) + width * t * q * (sl * q - sr * t);
            worst = std::max(worst, std::abs(hermite - f(l + t * width)));
        }
        if (worst > curve_error * size && depth < 8) {
            self(self, l, (l + r) / 2, depth + 1);
            self(self, (l + r) / 2, r, depth + 1);
            return;
        }
        curve.add({l, vl, sl}, {r, vr, sr}, same_slope * (std::abs(sl) + size / (upper - lower)));
    };
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        if (knots[i + 1] - knots[i] > least_stretch * (upper - lower)) {
            refine(refine, knots[i], knots[i + 1], 0);
        }
    }
    return {std::move(curve.x), std::move(curve.value), std::move(curve.slope)};
}

/// A stable equilibrium between two rims.
struct Well {
    int class_index = 0;
    double lower = 0, upper = 0;
    double rim = 0;  ///< J: less energy than this cannot leave
};

}  // namespace

const char* end_kind_name(EndKind kind) {
    switch (kind) {
        case EndKind::attractor:
            return "attractor";
        case EndKind::contact:
            return "contact";
        case EndKind::escape:
            return "escape";
        case EndKind::cycle:
            return "cycle";
        case EndKind::undecided:
            break;
    }
    return "undecided";
}

struct HeaveEnds::Impl {
    const HeavePlant& plant;
    double contact, escape, duration, scale_gap, scale_velocity, gap_size, velocity_size;
    std::vector<HeaveEquilibrium> equilibria;
    std::vector<EndClass> classes;
    std::vector<Well> wells;
    int contact_class = 0, escape_class = 0, undecided_class = 0;
    bool energy = false;    ///< the energy argument holds
    bool lossless = false;  ///< and nothing dissipates
    Curve force;
    double rest_resistance = 0;
    std::string rule;

    Impl(const HeavePlant& p, double contact_gap, double escape_gap, double time, double tolerance, double gap_scale,
         double velocity_scale)
        : plant(p),
          contact(contact_gap),
          escape(escape_gap),
          duration(time),
          scale_gap(tolerance * gap_scale),
          scale_velocity(tolerance * velocity_scale),
          gap_size(gap_scale),
          velocity_size(velocity_scale) {
        equilibria = heave_equilibria(plant);
        const double margin = 0.02 * (escape - contact);
        force = static_curve(plant, contact - margin, escape + margin);
        rest_resistance = plant.resistance(std::max(contact, rest_gap), 0.0);
        judge_dissipation();
        name_classes();
    }

    void judge_dissipation() {
        bool depends_on_both = plant.terms.extras.empty();
        for (const HeaveTerms::Correction& correction : plant.terms.corrections) {
            depends_on_both = depends_on_both && correction.axes.size() == 1 &&
                              (correction.axes[0] == Channel::gap || correction.axes[0] == Channel::heave_velocity);
        }
        energy = plant.autonomous() && depends_on_both && plant.single_curve() && !plant.loop;
        double most = 0;
        for (double size = 1e-6; size < 1e3 && energy; size *= speed_ratio) {
            for (const double w : {size, -size}) {
                for (const double h : {contact + near_ground, contact + far_from_ground * (escape - contact)}) {
                    const double loss = (plant.resistance(h, w) - rest_resistance) * w;
                    energy = energy && loss >= -rounding * w * w;
                    most = std::max(most, loss / (w * w));
                }
            }
        }
        lossless = energy && most <= rounding;
        rule = !energy ? "settled" : lossless ? "energy without loss" : "energy";
    }

    [[nodiscard]] double potential(double h) const { return -force.integral(h); }

    void name_classes() {
        for (const HeaveEquilibrium& e : equilibria) {
            if (e.stable && e.gap > contact && e.gap < escape) {
                classes.push_back({e.name, EndKind::attractor, e.gap, 0});
            }
        }
        const std::size_t attractors = classes.size();
        contact_class = static_cast<int>(classes.size());
        classes.push_back({"contact", EndKind::contact});
        escape_class = static_cast<int>(classes.size());
        classes.push_back({"escape", EndKind::escape});
        for (std::size_t i = 0; i < attractors; ++i) {
            classes.push_back({"about " + classes[i].name, EndKind::cycle, classes[i].gap, 0});
        }
        undecided_class = static_cast<int>(classes.size());
        classes.push_back({"undecided", EndKind::undecided});
        for (std::size_t i = 0; i < attractors; ++i) {
            Well well;
            well.class_index = static_cast<int>(lossless ? attractors + 2 + i : i);
            well.lower = contact;
            well.upper = escape;
            for (const HeaveEquilibrium& e : equilibria) {
                if (!e.stable && e.gap < classes[i].gap) {
                    well.lower = std::max(well.lower, e.gap);
                }
                if (!e.stable && e.gap > classes[i].gap) {
                    well.upper = std::min(well.upper, e.gap);
                }
            }
            // A hair below the rim, so that rounding never captures what would pass.
            const double bottom = potential(classes[i].gap);
            const double rim = std::min(potential(well.lower), potential(well.upper));
            well.rim = rim - below_rim * std::abs(rim - bottom);
            wells.push_back(well);
        }
    }

    [[nodiscard]] bool outside(double h) const { return h < plant.terms.table_lower || h > plant.terms.table_upper; }

    struct Captured {
        int index = -1;
        bool within_tables = true;  ///< it lacks the energy to reach a gap that no force table covers
    };
    [[nodiscard]] Captured captured(double h, double w) const {
        for (const Well& well : wells) {
            if (h > well.lower && h < well.upper) {
                double slope = 0;
                const double energy_now = 0.5 * plant.inertia(h, slope) * w * w + potential(h);
                const auto reaches = [&](double edge) {
                    return edge > well.lower && edge < well.upper && potential(edge) <= energy_now;
                };
                return {energy_now < well.rim ? well.class_index : -1,
                        !reaches(plant.terms.table_lower) && !reaches(plant.terms.table_upper)};
            }
        }
        return {};
    }

    /// The heave equation with all that depends on the gap alone taken from one curve.
    struct StaticRate {
        const HeaveTerms* terms;
        const Curve* force;
        double rest;
        void operator()(double, const double* y, double* d) const {
            HeaveLoad load{(*force)(y[0]) + rest, 0, 0};
            add_water_drag<false>(*terms, y[1], load);
            add_guided_resistance<false>(*terms, y[0], y[1], 0, load);
            HeaveSlopes unused;
            d[0] = y[1];
            d[1] = heave_acceleration<false>(*terms, y[0], y[1], load, {}, unused);
        }
    };
    /// Gap, velocity, with `Loop` the force after the lag of the loop's actuator, with `Memory` that of the water.
    template <bool Memory, bool Loop>
    struct FullRate {
        static constexpr std::size_t memory = Loop ? 3 : 2;
        static constexpr std::size_t size = memory + (Memory ? history_states : 0);
        const HeavePlant* plant;
        double given;  ///< N, the input that is held
        const LoopActuator<2>* actuator;
        void operator()(double t, const double* y, double* d) const {
            HeaveMoment moment;
            moment.t = t;
            moment.input = given;
            if constexpr (Loop) {
                const double driven = actuator->driven(t, y);
                moment.input = actuator->lagged() ? y[2] : driven;
                d[2] = actuator->lagged() ? (driven - y[2]) / plant->terms.actuator.lag : 0;
            }
            d[0] = y[1];
            d[1] = plant->acceleration(y[0], y[1], moment, Memory ? y + memory : nullptr);
            if constexpr (Memory) {
                const HistoryKernel& kernel = history_kernel();
                for (std::size_t i = 0; i < history_states; ++i) {
                    d[memory + i] = -kernel.rate[i] * (y[memory + i] + y[1]);
                }
            }
        }
    };
    template <bool Memory, bool Loop>
    [[nodiscard]] End through(double h, double w) const {
        using Law = FullRate<Memory, Loop>;
        const double given = plant.held_input();
        LoopActuator<2> actuator(
            plant.terms, [this, given](double, const double* y) { return given + plant.loop->command(y[0], y[1]); });
        std::array<double, Law::size> y{};
        y.fill(-w);
        y[0] = h;
        y[1] = w;
        const Law rate{&plant, given, &actuator};
        if constexpr (Loop) {
            const double still[2] = {w, 0};
            actuator.start(0, y.data(), still);
            y[2] = actuator.driven(0, y.data());
            std::array<double, Law::size> begin{};
            rate(0, y.data(), begin.data());
            actuator.accept(0, y.data(), begin.data());
        }
        return go<Law::size>(rate, y, Loop ? &actuator : nullptr);
    }

    [[nodiscard]] End of(double h, double w) const {
        if (h <= contact) {
            return {contact_class, 0, outside(h)};
        }
        if (h >= escape) {
            return {escape_class, 0, outside(h)};
        }
        if (energy) {
            const Captured now = captured(h, w);
            if (now.index >= 0 && (now.within_tables || outside(h))) {
                return {now.index, 0, outside(h)};
            }
            return go<2>(StaticRate{&plant.terms, &force, rest_resistance}, {h, w});
        }
        if (plant.loop_has_states()) {
            return plant.terms.history != 0 ? through<true, true>(h, w) : through<false, true>(h, w);
        }
        return plant.terms.history != 0 ? through<true, false>(h, w) : through<false, false>(h, w);
    }

    /// The extent of the motion over a part of the time.
    struct Extent {
        double low = core::no_limit, high = -core::no_limit;
        void take(double h) {
            low = std::min(low, h);
            high = std::max(high, h);
        }
        [[nodiscard]] double size() const { return high - low; }
    };

    template <std::size_t N, class Rate>
    End go(const Rate& rate, const std::array<double, N>& start, LoopActuator<2>* actuator = nullptr) const {
        std::array<double, N> scale;
        scale.fill(scale_velocity);
        scale[0] = scale_gap;
        if constexpr (N > 2) {
            // A force that changes the velocity so much within a second.
            scale[2] = actuator ? scale_velocity * plant.terms.mass : scale[2];
        }
        const double look_back = actuator && actuator->delayed() ? actuator->max_step() : core::no_limit;
        DormandPrince<N, Rate> ode(rate, 0.0, start, scale, first_motion_step);
        Extent third, fourth;
        End held{-1, 0, outside(start[0])};  // once it can no longer leave a well, it may still leave the tables
        if (energy) {
            held.index = captured(start[0], start[1]).index;
        }
        while (ode.t() < duration) {
            if (!ode.step(std::min(duration, ode.t() + look_back)) || ode.tries() > 200000) {
                return held.index >= 0 ? held : End{undecided_class, ode.t(), held.outside};
            }
            if (actuator) {
                actuator->accept(ode.t(), ode.y().data(), ode.rate().data());
            }
            const double h = ode.y()[0], w = ode.y()[1];
            const double turned = turning_gap(ode);
            const End event = passed(ode, turned);
            if (event.index >= 0 && held.index < 0) {  // the step went on beyond, the motion did not
                const double level = event.index == contact_class ? contact : escape;
                return {event.index, event.time, held.outside || outside(level)};
            }
            held.outside = held.outside || outside(h) || outside(turned);
            if (energy) {
                const Captured now = captured(h, w);
                if (held.index < 0 && now.index >= 0) {
                    held = {now.index, ode.t(), held.outside};
                }
                if (held.index >= 0 && (held.outside || now.within_tables)) {
                    return held;
                }
            } else if (ode.t() > 0.5 * duration) {
                (ode.t() > last_quarter * duration ? fourth : third).take(h);
            }
        }
        if (held.index >= 0) {
            return held;
        }
        End end = energy ? End{undecided_class, duration} : settled(ode.y()[0], third, fourth);
        end.outside = held.outside;
        return end;
    }

    /// Share of the last step after which the motion turned round; 1 when it did not.
    template <class Integrator>
    static double turning_part(const Integrator& ode) {
        const double w = ode.y()[1], w0 = ode.before()[1];
        return w0 != 0 && (w0 < 0) != (w < 0) ? w0 / (w0 - w) : 1;
    }
    /// The gap farthest along within the last step: where the motion turned round, else at the end.
    template <class Integrator>
    static double turning_gap(const Integrator& ode) {
        const double part = turning_part(ode);
        return part < 1 ? ode.between(part, 0) : ode.y()[0];
    }

    /// Contact or escape within the last step; a negative index when neither.
    template <class Integrator>
    End passed(const Integrator& ode, double turned) const {
        const double h = ode.y()[0];
        double part = 1;
        bool low = h <= contact, high = h >= escape;
        if (!low && !high) {
            part = turning_part(ode);
            low = turned <= contact;
            high = turned >= escape;
        }
        if (!low && !high) {
            return {-1, 0};
        }
        const double level = low ? contact : escape;
        double lo = 0, hi = part;
        for (int i = 0; i < 50; ++i) {
            const double middle = (lo + hi) / 2;
            const bool beyond = low ? ode.between(middle, 0) <= level : ode.between(middle, 0) >= level;
            (beyond ? hi : lo) = middle;
        }
        return {low ? contact_class : escape_class, ode.before_t() + hi * (ode.t() - ode.before_t())};
    }

    [[nodiscard]] End settled(double h, const Extent& third, const Extent& fourth) const {
        const Extent both{std::min(third.low, fourth.low), std::max(third.high, fourth.high)};
        for (const Well& well : wells) {
            if (both.low <= well.lower || both.high >= well.upper || h <= well.lower || h >= well.upper) {
                continue;
            }
            const double width = well.upper - well.lower;
            if (fourth.size() < at_rest * width) {
                return {well.class_index, duration};
            }
            if (fourth.size() < shrinking * third.size()) {
                return {well.class_index, duration};  // shrinking toward it
            }
            if (std::abs(fourth.size() - third.size()) < steady_swing * third.size()) {
                return {static_cast<int>(static_cast<std::size_t>(well.class_index) + 2 + wells.size()), duration};
            }
        }
        return {undecided_class, duration};
    }
};

HeaveEnds::HeaveEnds(const HeavePlant& plant, double contact_gap, double escape_gap, double duration, double tolerance,
                     double gap_size, double velocity_size)
    : impl_(std::make_unique<Impl>(plant, contact_gap, escape_gap, duration, tolerance, gap_size, velocity_size)) {}

HeaveEnds::~HeaveEnds() = default;

End HeaveEnds::of(double gap, double velocity) const { return impl_->of(gap, velocity); }

void HeaveEnds::of(std::span<const double> gap, std::span<const double> velocity, std::span<End> out,
                   core::Progress& progress) const {
    core::parallel_blocks(
        gap.size(), 256,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                out[i] = impl_->of(gap[i], velocity[i]);
            }
        },
        progress);
}

const std::vector<EndClass>& HeaveEnds::classes() const { return impl_->classes; }
const std::vector<HeaveEquilibrium>& HeaveEnds::equilibria() const { return impl_->equilibria; }
const std::string& HeaveEnds::rule() const { return impl_->rule; }

}  // namespace underbody::dynamics
