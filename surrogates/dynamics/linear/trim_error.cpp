#include "surrogates/dynamics/linear/trim_error.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/parallel.h"
#include "core/quantile.h"
#include "surrogates/dynamics/model/force_error.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"

namespace underbody::dynamics {

namespace {

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

Conditions at_rest(const Model& model, const Conditions& held, double gap, double pitch) {
    Conditions at = held.over(model.conditions);
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

struct Drawn {
    double stiffness = std::nan("");
    std::vector<Mode> modes;
};

/// Each draw's stiffness and modes; draws that make no model count as none.
TrimError spread_of(std::size_t draws, const std::vector<Mode>& own, const std::function<Drawn(std::size_t)>& draw) {
    std::vector<Drawn> all(draws);
    core::parallel_for(draws, [&](std::size_t d) {
        try {
            all[d] = draw(d);
        } catch (const core::Error&) {
            all[d] = {};
        }
    });
    TrimError error;
    error.stated = true;
    std::vector<double> stiffness;
    std::size_t known = 0, stable = 0, like = 0;
    for (const Drawn& one : all) {
        if (std::isfinite(one.stiffness)) {
            stiffness.push_back(one.stiffness);
            ++known;
            like += one.modes.size() == own.size() ? 1U : 0U;
            stable += std::all_of(one.modes.begin(), one.modes.end(),
                                  [](const Mode& mode) { return mode.value.real() < no_growth; })
                          ? 1U
                          : 0U;
        }
    }
    error.stiffness = core::central_deviation(stiffness);
    error.stable = known > 0 ? static_cast<double>(stable) / static_cast<double>(known) : std::nan("");
    for (std::size_t m = 0; m < own.size(); ++m) {
        std::vector<double> real, imaginary, frequency, ratio;
        for (const Drawn& one : all) {
            if (one.modes.size() == own.size()) {
                real.push_back(one.modes[m].value.real());
                imaginary.push_back(one.modes[m].value.imag());
                frequency.push_back(one.modes[m].frequency);
                ratio.push_back(one.modes[m].damping_ratio);
            }
        }
        const double none = std::nan("");
        error.modes.push_back(10 * like < 9 * known
                                  ? ModeError{none, none, none, none}
                                  : ModeError{core::central_deviation(real), core::central_deviation(imaginary),
                                              core::central_deviation(frequency), core::central_deviation(ratio)});
    }
    return error;
}

}  // namespace

double heave_force_error(const Model& model, const Conditions& held, double gap, double pitch) {
    double sum = std::pow(error_of(model, "lift_force")(at_rest(model, held, gap, pitch)), 2);
    for (std::size_t e = 0; e < model.effects.size(); ++e) {
        const EffectUse& use = model.effects[e];
        for (std::size_t p = 0; p < use.values.size() && past_the_tables(use); ++p) {
            if (const auto beside = models_beside(model, e, p)) {
                const double change = HeavePlant(beside->above, held).static_force(gap) -
                                      HeavePlant(beside->below, held).static_force(gap);
                sum += std::pow(change / beside->apart * use.sigmas[p], 2);
            }
        }
    }
    return std::sqrt(sum);
}

LinearSystem heave_system(const HeavePlant& plant, double gap, double* stiffness) {
    double slope = 0;
    const double mass = plant.inertia(gap, slope), step = 1e-6;
    const double k = -(plant.static_force(gap + step) - plant.static_force(gap - step)) / (2 * step);
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

TrimError heave_trim_error(const Model& model, const Conditions& held, double gap, bool balanced, std::size_t draws) {
    if (!states_errors(model, false)) {
        return {};
    }
    double stiffness = 0;
    const HeavePlant plant(model, held);
    const std::vector<Mode> own = modes(heave_system(plant, gap, &stiffness), {"heave", "heave"});
    TrimError error = spread_of(draws, own, [&](std::size_t d) {
        const HeavePlant other(drawn_model(model, 1, d), held);
        const double moved = balanced ? (other.static_force(gap) - plant.static_force(gap)) / stiffness : 0;
        Drawn one;
        one.modes =
            modes(heave_system(other, std::max(gap + moved, other.contact_gap()), &one.stiffness), {"heave", "heave"});
        return one;
    });
    error.force = heave_force_error(model, held, gap);
    error.gap = balanced ? error.force / std::abs(stiffness) : 0;
    return error;
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
    TrimError error = spread_of(draws, own, [&](std::size_t d) {
        const HeavePitch other(drawn_model(model, 1, d), held);
        double force = 0, moment = 0;
        other.statics(gap, pitch, force, moment);
        const auto shift = balanced ? moved(force - f, moment - m) : std::array<double, 2>{};
        const LinearSystem system = other.linearised(std::max(gap + shift[0], other.contact_gap()), pitch + shift[1]);
        double unused = 0;
        return Drawn{-system.a(1, 0) * other.vertical().inertia(gap + shift[0], unused), modes(system, groups)};
    });
    const Conditions at = at_rest(model, held, gap, pitch);
    error.force = heave_force_error(model, held, gap, pitch);
    const double torque = error_of(model, "pitch_moment")(at), reach = plant.arm(pitch);
    if (balanced) {
        const auto by_lift = moved(error.force, reach * error.force), by_moment = moved(0, torque);
        error.gap = std::hypot(by_lift[0], by_moment[0]);
        error.pitch = std::hypot(by_lift[1], by_moment[1]);
    }
    return error;
}

}  // namespace underbody::dynamics
