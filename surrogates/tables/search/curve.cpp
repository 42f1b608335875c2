#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "surrogates/tables/analysis/balances.h"
#include "surrogates/tables/search/curve_forces.h"

namespace underbody::tables {

namespace {

constexpr std::pair<Curve, const char*> curve_words[] = {{Curve::kick, "kick"}, {Curve::pitch_window, "pitch_window"}};

Line line_through(const std::vector<double>& x, std::span<const double> values, SlopeRule rule) {
    std::vector<double> value(values.begin(), values.end()), slope(value.size());
    line_slopes(rule, x, value, slope);
    return {x, std::move(value), std::move(slope)};
}

/// A stable balance, or the nearest there is to one.
struct Balance {
    double gap = 0;
    double margin = 0;    ///< N, up or down, that it bears and still is; below zero: what lacks
    bool at_end = false;  ///< an end of the range of gaps decides it
};

/// Largest force up on the way down from `zero` to `from`, and largest down on the way up to `to`: what a constant
/// force may take away.
Balance bearing(const Line& force, const std::vector<Line::Extreme>& extremes, double from, double zero, double to) {
    double up = force.value(from), down = -force.value(to);
    bool up_at_end = from == force.lower(), down_at_end = to == force.upper();
    for (const Line::Extreme& one : extremes) {
        if (one.x > from && one.x < zero && one.value > up) {
            up = one.value;
            up_at_end = false;
        } else if (one.x > zero && one.x < to && -one.value > down) {
            down = -one.value;
            down_at_end = false;
        }
    }
    return {zero, std::min(up, down), up < down ? up_at_end : down_at_end};
}

/// There is no stable balance: the force has one sign, or rises from below zero to above.
Balance nearest_to_one(const Line& force, const std::vector<Line::Extreme>& extremes) {
    const double at_lower = force.value(force.lower()), at_upper = force.value(force.upper());
    if (at_lower <= 0 && at_upper >= 0) {
        const bool lower = -at_lower < at_upper;
        return {lower ? force.lower() : force.upper(), -std::min(-at_lower, at_upper), true};
    }
    Balance nearest{force.lower(), -std::abs(at_lower), true};
    const auto take = [&](double gap, double value, bool at_end) {
        if (-std::abs(value) > nearest.margin) {
            nearest = {gap, -std::abs(value), at_end};
        }
    };
    take(force.upper(), at_upper, true);
    for (const Line::Extreme& one : extremes) {
        take(one.x, one.value, false);
    }
    return nearest;
}

/// Of the stable balances the one that bears most.
Balance best_balance(const Line& force) {
    const auto zeros = force.zeros();
    const auto extremes = force.extremes();
    std::optional<Balance> best;
    for (std::size_t i = 0; i < zeros.size(); ++i) {
        if (!(zeros[i].before > 0 && zeros[i].after < 0)) {
            continue;
        }
        const double from = i > 0 ? zeros[i - 1].x : force.lower();
        const double to = i + 1 < zeros.size() ? zeros[i + 1].x : force.upper();
        const Balance one = bearing(force, extremes, from, zeros[i].x, to);
        if (!best || one.margin > best->margin) {
            best = one;
        }
    }
    return best ? *best : nearest_to_one(force, extremes);
}

/// As `table equilibria` tells it.
CurveNumber kick(const CurveAsked& asked, const CurveForces& forces) {
    const Line force = line_through(forces.gaps, forces.lift, forces.between).scaled(1, -asked.net_weight.value_or(0));
    Equilibria found;
    set_balances(found, force, [&](double) { return AtBalance{0, asked.virtual_mass, 0}; });
    std::optional<CurveNumber> largest;
    for (const Equilibrium& e : found.all) {
        if (e.stability == Stability::stable && (!largest || e.kick_velocity > largest->value)) {
            largest = {e.kick_velocity, e.limited_by_range};
        }
    }
    if (largest) {
        return *largest;
    }
    const double lacking = std::max(0.0, -best_balance(force).margin);
    return {-std::sqrt(2 * lacking * (force.upper() - force.lower()) / asked.virtual_mass), false};
}

/// Something that is asked for over the pitch: it holds where the line is above zero.
struct Demand {
    Line line;
    std::vector<bool> at_end;  ///< of each pitch: an end of the range of gaps decides; empty: nowhere
};

bool decided_at_end(const Demand& demand, const std::vector<double>& pitches, double pitch) {
    if (demand.at_end.empty()) {
        return false;
    }
    const auto nearest = std::min_element(
        pitches.begin(), pitches.end(), [&](double a, double b) { return std::abs(a - pitch) < std::abs(b - pitch); });
    return demand.at_end[static_cast<std::size_t>(nearest - pitches.begin())];
}

std::vector<Demand> demands_of(const CurveAsked& asked, const CurveForces& forces) {
    const std::vector<double>& pitches = forces.pitches;
    const std::size_t gaps = forces.gaps.size();
    std::vector<double> bears, moment;
    std::vector<bool> at_end;
    for (std::size_t j = 0; j < pitches.size(); ++j) {
        double gap = forces.gaps.front();
        if (asked.net_weight) {
            const Balance balance =
                best_balance(line_through(forces.gaps, std::span(forces.lift).subspan(j * gaps, gaps), forces.between)
                                 .scaled(1, -*asked.net_weight));
            gap = balance.gap;
            bears.push_back(balance.margin / forces.lift_size);
            at_end.push_back(balance.at_end);
        }
        if (asked.of_moment()) {
            const auto here = std::span(forces.moment).subspan(j * gaps, gaps);
            moment.push_back(gaps == 1 ? here.front() : line_through(forces.gaps, here, forces.between).value(gap));
        }
    }
    std::vector<Demand> demands;
    const auto add = [&](std::vector<double> margin, std::vector<bool> ends) {
        demands.push_back({line_through(pitches, margin, SlopeRule::monotone), std::move(ends)});
    };
    if (asked.net_weight) {
        add(std::move(bears), std::move(at_end));
    }
    if (asked.restoring) {
        std::vector<double> falls(moment.size());
        line_slopes(forces.between, pitches, moment, falls);
        const double size = forces.moment_size / (pitches.back() - pitches.front());
        std::transform(falls.begin(), falls.end(), falls.begin(), [&](double slope) { return -slope / size; });
        add(std::move(falls), {});
    }
    for (const double side : {-1.0, 1.0}) {
        if (core::is_limit(asked.most_moment)) {
            std::vector<double> room;
            for (const double m : moment) {
                room.push_back((asked.most_moment - side * m) / forces.moment_size);
            }
            add(std::move(room), {});
        }
    }
    return demands;
}

double least(const std::vector<Demand>& demands, double pitch) {
    double margin = std::numeric_limits<double>::infinity();
    for (const Demand& demand : demands) {
        margin = std::min(margin, demand.line.value(pitch));
    }
    return margin;
}

/// All holds at `about`: how far either way it goes on.
CurveNumber reach(const CurveForces& forces, const std::vector<Demand>& demands, double about) {
    CurveNumber window{std::min(about - forces.pitches.front(), forces.pitches.back() - about), true};
    for (const Demand& demand : demands) {
        for (const Line::Zero& edge : demand.line.zeros()) {
            if (std::abs(edge.x - about) < window.value) {
                window = {std::abs(edge.x - about), decided_at_end(demand, forces.pitches, edge.x)};
            }
        }
    }
    return window;
}

/// Something does not hold at `about`: minus the least way to where all does, or as much of the pitches as lacks there.
CurveNumber missed(const CurveForces& forces, const std::vector<Demand>& demands, double about) {
    const double all = forces.pitches.back() - forces.pitches.front();
    double way = std::numeric_limits<double>::infinity();
    const auto take = [&](double pitch) {
        way = std::min(way, std::abs(pitch - about) + all * std::max(0.0, -least(demands, pitch)));
    };
    take(about);
    std::for_each(forces.pitches.begin(), forces.pitches.end(), take);
    for (const Demand& demand : demands) {
        for (const Line::Zero& edge : demand.line.zeros()) {
            take(edge.x);
        }
    }
    return {-way, false};
}

}  // namespace

std::string to_string(Curve curve) {
    return std::find_if(std::begin(curve_words), std::end(curve_words), [&](const auto& n) { return n.first == curve; })
        ->second;
}

std::optional<Curve> curve_named(std::string_view name) {
    for (const auto& [curve, known] : curve_words) {
        if (name == known) {
            return curve;
        }
    }
    return {};
}

std::vector<std::string> curve_names() {
    std::vector<std::string> all;
    for (const auto& [curve, name] : curve_words) {
        all.emplace_back(name);
    }
    return all;
}

std::string unit_of(Curve curve) { return curve == Curve::kick ? "m/s" : "rad"; }

std::vector<std::string> CurveAsked::runs_over() const {
    if (curve == Curve::kick) {
        return {"gap"};
    }
    return net_weight ? std::vector<std::string>{"gap", "pitch"} : std::vector<std::string>{"pitch"};
}

CurveNumber curve_number(const CurveAsked& asked, const CurveForces& forces) {
    if (asked.curve == Curve::kick) {
        return kick(asked, forces);
    }
    const std::vector<Demand> demands = demands_of(asked, forces);
    return least(demands, asked.about) > 0 ? reach(forces, demands, asked.about) : missed(forces, demands, asked.about);
}

}  // namespace underbody::tables
