#include "surrogates/dynamics/linear/trim_error.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/parallel.h"
#include "core/quantile.h"
#include "surrogates/dynamics/model/force_error.h"
#include "surrogates/dynamics/plant/resting_gaps.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"

namespace underbody::dynamics {

namespace {

constexpr double slope_step = 1e-8;  ///< m, over which the stiffness is taken

/// Effects whose numbers reach the force at rest past the tables: of the motion, or a declared number that is no
/// table's.
bool past_the_tables(const EffectUse& use) {
    const bool of_a_force = use.parameter.starts_with("force.") || use.parameter.starts_with("coupling.");
    return effect(use.name).info().seen_in == SeenIn::time_series || (!use.parameter.empty() && !of_a_force);
}

bool states_errors(const Model& model, bool moment) {
    const bool numbers = std::any_of(model.effects.begin(), model.effects.end(), [](const EffectUse& use) {
        return std::any_of(use.sigmas.begin(), use.sigmas.end(), [](double s) { return s > 0; });
    });
    return numbers || !ForceError(model, "lift_force").none() || (moment && !ForceError(model, "pitch_moment").none());
}

Conditions at_rest(Conditions at, double gap, double pitch) {
    at[Channel::gap] = gap;
    at[Channel::heave_velocity] = at[Channel::pitch_rate] = 0;
    at[Channel::pitch] = at.has(Channel::pitch) && pitch == 0 ? at[Channel::pitch] : pitch;
    return at;
}

/// The force without what belongs to the rig, which no motion feels.
ForceError error_of(Model model, const std::string& quantity) {
    std::erase_if(model.effects, [](const EffectUse& use) { return effect(use.name).info().belongs_to_the_rig; });
    return {model, quantity};
}

/// What a draw makes of a trim.
struct Drawn {
    double stiffness = std::nan(""), mass = std::nan("");
    std::vector<Mode> modes;
    bool exists = false;
};
/// By draw, then by trim.
using Draws = std::vector<std::vector<Drawn>>;

/// Draws that make no model count as none.
Draws draws_of(std::size_t draws, std::size_t trims, const std::function<std::vector<Drawn>(std::size_t)>& draw) {
    Draws all(draws);
    core::parallel_for(draws, [&](std::size_t d) {
        try {
            all[d] = draw(d);
        } catch (const core::Error&) {
            all[d].assign(trims, {});
        }
    });
    return all;
}

double part_of(std::size_t part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : std::nan("");
}

/// One standard deviation of a number; none where it is the rounding of a slope, beside a point that is exact.
double deviation(std::vector<double> values, double number) {
    constexpr double rounding = 1e-5;
    const double found = core::central_deviation(std::move(values));
    return found > rounding * std::abs(number) ? found : 0;
}

/// Of each draw's stiffness and modes.
TrimError spread_of(const Draws& draws, std::size_t trim, const std::vector<Mode>& own, double own_stiffness) {
    TrimError error;
    error.stated = true;
    std::vector<double> stiffness, swing;
    std::size_t known = 0, stable = 0, like = 0, exist = 0;
    for (const auto& drawn : draws) {
        const Drawn& one = drawn[trim];
        exist += one.exists ? 1U : 0U;
        if (std::isfinite(one.stiffness)) {
            stiffness.push_back(one.stiffness);
            swing.push_back(std::sqrt(one.stiffness / one.mass));  // no number where it would be unstable
            ++known;
            like += one.modes.size() == own.size() ? 1U : 0U;
            stable += std::all_of(one.modes.begin(), one.modes.end(),
                                  [](const Mode& mode) { return mode.value.real() < no_growth; })
                          ? 1U
                          : 0U;
        }
    }
    error.stiffness = deviation(stiffness, own_stiffness);
    error.swing = deviation(swing, own.front().frequency);
    error.stable = part_of(stable, known);
    error.exists = part_of(exist, draws.size());
    for (std::size_t m = 0; m < own.size(); ++m) {
        std::vector<double> real, imaginary, frequency, ratio;
        for (const auto& drawn : draws) {
            const Drawn& one = drawn[trim];
            if (one.modes.size() == own.size()) {
                real.push_back(one.modes[m].value.real());
                imaginary.push_back(one.modes[m].value.imag());
                frequency.push_back(one.modes[m].frequency);
                ratio.push_back(one.modes[m].damping_ratio);
            }
        }
        const double none = std::nan("");
        error.modes.push_back(
            10 * like < 9 * known
                ? ModeError{none, none, none, none}
                : ModeError{deviation(real, own[m].value.real()), deviation(imaginary, own[m].value.imag()),
                            deviation(frequency, own[m].frequency), deviation(ratio, own[m].damping_ratio)});
    }
    return error;
}

}  // namespace

HeaveForceError::HeaveForceError(const Model& model, const Conditions& held)
    : of_tables_(error_of(model, "lift_force")), held_(held.over(model.conditions)) {
    for (std::size_t e = 0; e < model.effects.size(); ++e) {
        const EffectUse& use = model.effects[e];
        for (std::size_t p = 0; p < use.values.size() && past_the_tables(use); ++p) {
            if (const auto beside = models_beside(model, e, p)) {
                beside_.push_back(
                    {HeavePlant(beside->above, held), HeavePlant(beside->below, held), use.sigmas[p] / beside->apart});
            }
        }
    }
}

double HeaveForceError::operator()(double gap, double pitch) const {
    double sum = std::pow(of_tables_(at_rest(held_, gap, pitch)), 2);
    for (const Beside& one : beside_) {
        sum += std::pow(one.share * (one.above.static_force(gap) - one.below.static_force(gap)), 2);
    }
    return std::sqrt(sum);
}

LinearSystem heave_system(const HeavePlant& plant, double gap, double* stiffness) {
    double slope = 0;
    const double mass = plant.inertia(gap, slope);
    const double k = -(plant.static_force(gap + slope_step) - plant.static_force(gap - slope_step)) / (2 * slope_step);
    if (stiffness) {
        *stiffness = k;
    }
    LinearSystem system;
    system.a = Matrix{{-plant.damping(gap) / mass, -k / mass}, {1, 0}};
    system.b = Matrix{{1 / mass}, {0}};
    system.states = {"heave_velocity", "gap"};
    system.inputs = {"input_force"};
    return system;
}

namespace {

/// A gap about which draws are linearised.
struct HeaveTrim {
    double gap = 0, stiffness = 0;
    std::vector<Mode> modes;
};

HeaveTrim trim_at(const HeavePlant& plant, double gap) {
    HeaveTrim trim{gap, 0, {}};
    trim.modes = modes(heave_system(plant, gap, &trim.stiffness), {"heave", "heave"});
    return trim;
}

/// The draw about the gap that the balance moves to in it, or about the given one.
Drawn drawn_trim(const HeavePlant& plant, const HeavePlant& other, const HeaveTrim& trim, bool balanced) {
    const double moved = balanced ? (other.static_force(trim.gap) - plant.static_force(trim.gap)) / trim.stiffness : 0;
    const auto [lower, upper] = resting_range(other);  // as a table's draws, no further than the tables reach
    HeaveTrim there = trim_at(other, std::clamp(trim.gap + moved, lower, upper - slope_step));
    double slope = 0;
    return {there.stiffness, other.inertia(there.gap, slope), std::move(there.modes), false};
}

constexpr std::uint64_t seed_of_draws = 1;

}  // namespace

TrimError heave_trim_error(const Model& model, const Conditions& held, double gap, bool balanced, std::size_t draws) {
    if (!states_errors(model, false)) {
        return {};
    }
    const HeavePlant plant(model, held);
    const HeaveTrim trim = trim_at(plant, gap);
    const Draws all = draws_of(draws, 1, [&](std::size_t d) {
        const HeavePlant other(drawn_model(model, seed_of_draws, d), held);
        return std::vector{drawn_trim(plant, other, trim, balanced)};
    });
    TrimError error = spread_of(all, 0, trim.modes, trim.stiffness);
    error.force = HeaveForceError(model, held)(gap);
    error.gap = balanced ? error.force / std::abs(trim.stiffness) : 0;
    return error;
}

std::vector<TrimError> heave_trim_errors(const Model& model, const Conditions& held,
                                         const std::vector<BalancedGap>& balanced, std::size_t draws) {
    if (balanced.empty() || !states_errors(model, false)) {
        return std::vector<TrimError>(balanced.size());
    }
    const HeavePlant plant(model, held);
    std::vector<HeaveTrim> trims;
    for (const BalancedGap& one : balanced) {
        trims.push_back(trim_at(plant, one.gap));
    }
    const Draws all = draws_of(draws, trims.size(), [&](std::size_t d) {
        const HeavePlant other(drawn_model(model, seed_of_draws, d), held);
        const std::vector<HeaveEquilibrium> found = heave_equilibria(other);
        std::vector<Drawn> drawn;
        for (std::size_t i = 0; i < trims.size(); ++i) {
            drawn.push_back(drawn_trim(plant, other, trims[i], true));
            drawn.back().exists = std::any_of(found.begin(), found.end(), [&](const HeaveEquilibrium& e) {
                return e.stable == balanced[i].stable && std::abs(e.gap - balanced[i].gap) <= balanced[i].reach;
            });
        }
        return drawn;
    });
    const HeaveForceError force_error(model, held);
    std::vector<TrimError> errors;
    for (std::size_t i = 0; i < trims.size(); ++i) {
        errors.push_back(spread_of(all, i, trims[i].modes, trims[i].stiffness));
        errors.back().force = force_error(trims[i].gap);
        errors.back().gap = errors.back().force / std::abs(trims[i].stiffness);
    }
    return errors;
}

TrimError pitch_trim_error(const Model& model, const Conditions& held, double gap, double pitch, bool balanced,
                           std::size_t draws) {
    if (!states_errors(model, true)) {
        return {};
    }
    const std::vector<std::string> groups{"heave", "heave", "pitch", "pitch"};
    const HeavePitch plant(model, held);
    const double dh = 1e-6, dp = 1e-6;
    double f = 0, m = 0, up = 0, turn = 0, down = 0, back = 0;
    plant.statics(gap, pitch, f, m);
    double slope[2][2];
    for (const int along : {0, 1}) {
        const double h = along == 0 ? dh : 0, p = along == 1 ? dp : 0;
        plant.statics(gap + h, pitch + p, up, turn);
        plant.statics(gap - h, pitch - p, down, back);
        slope[0][along] = (up - down) / (2 * (h + p));
        slope[1][along] = (turn - back) / (2 * (h + p));
    }
    const double determinant = slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0];
    /// Where a change of force and moment takes the balance.
    const auto moved = [&](double force, double moment) {
        return std::array<double, 2>{(-slope[1][1] * force + slope[0][1] * moment) / determinant,
                                     (slope[1][0] * force - slope[0][0] * moment) / determinant};
    };
    const std::vector<Mode> own = modes(plant.linearised(gap, pitch), groups);
    const Draws all = draws_of(draws, 1, [&](std::size_t d) {
        const HeavePitch other(drawn_model(model, seed_of_draws, d), held);
        double force = 0, moment = 0;
        other.statics(gap, pitch, force, moment);
        const auto shift = balanced ? moved(force - f, moment - m) : std::array<double, 2>{};
        const LinearSystem system = other.linearised(std::max(gap + shift[0], other.contact_gap()), pitch + shift[1]);
        double unused = 0;
        const double mass = other.vertical().inertia(gap + shift[0], unused);
        return std::vector{Drawn{-system.a(1, 0) * mass, mass, modes(system, groups), false}};
    });
    TrimError error = spread_of(all, 0, own, 0);
    const Conditions at = at_rest(held.over(model.conditions), gap, pitch);
    error.force = HeaveForceError(model, held)(gap, pitch);
    const double torque = error_of(model, "pitch_moment")(at), reach = plant.arm(pitch);
    if (balanced) {
        const auto by_lift = moved(error.force, reach * error.force), by_moment = moved(0, torque);
        error.gap = std::hypot(by_lift[0], by_moment[0]);
        error.pitch = std::hypot(by_lift[1], by_moment[1]);
    }
    return error;
}

}  // namespace underbody::dynamics
