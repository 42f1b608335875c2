#include "surrogates/dynamics/simulate/feedback.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/linear/trim_error.h"
#include "surrogates/dynamics/model/matrix_algebra.h"

namespace underbody::dynamics {

void close_loop(HeavePlant& plant, const HeaveFeedback& feedback) {
    HeaveTerms& terms = plant.terms;
    if (feedback.limit > 0 || terms.actuator.dead_zone > 0 || terms.actuator.has_states() || terms.thrust_loss != 0) {
        plant.loop = feedback;
        return;
    }
    const double gap_gain = terms.actuator.gain * feedback.gap_gain,
                 velocity_gain = terms.actuator.gain * feedback.velocity_gain;
    terms.constant += gap_gain * (feedback.reference - terms.stiffness_gap);
    terms.stiffness += gap_gain;
    terms.extra_linear += velocity_gain;
    terms.constant -= velocity_gain * terms.current;  // the feedback acts on w itself
}

void assign(const std::string& text, const std::vector<NamedNumber>& numbers) {
    std::vector<core::QuantityName> names;
    std::vector<std::string> words;
    for (const NamedNumber& number : numbers) {
        names.push_back({number.name, number.unit, "", ""});
        words.emplace_back(number.name);
    }
    for (const core::NamedValue& value : core::parse_assignments(text, names)) {
        bool found = false;
        for (const NamedNumber& number : numbers) {
            if (value.name == number.name) {
                *number.value = value.value;
                found = true;
            }
        }
        if (!found) {
            throw core::UsageError("name", "'" + value.name + "' is not known here", {},
                                   core::did_you_mean(value.name, words));
        }
    }
}

namespace {
void check_limit(double limit) {
    if (limit < 0) {
        throw core::UsageError("range", "a limit is not negative");
    }
}
}  // namespace

HeaveFeedback heave_feedback(const std::string& gains) {
    HeaveFeedback feedback;
    assign(gains, {{"gap_gain", "N/m", &feedback.gap_gain},
                   {"velocity_gain", "N s/m", &feedback.velocity_gain},
                   {"reference", "m", &feedback.reference},
                   {"limit", "N", &feedback.limit}});
    check_limit(feedback.limit);
    return feedback;
}

PitchFeedback pitch_feedback(const std::string& gains) {
    PitchFeedback feedback;
    assign(gains, {{"gap_gain", "N/m", &feedback.force_gain[0]},
                   {"velocity_gain", "N s/m", &feedback.force_gain[1]},
                   {"reference", "m", &feedback.reference[0]},
                   {"limit", "N", &feedback.force_limit},
                   {"pitch_gain", "N m/rad", &feedback.moment_gain[2]},
                   {"pitch_rate_gain", "N m s/rad", &feedback.moment_gain[3]},
                   {"pitch_reference", "rad", &feedback.reference[2]},
                   {"moment_limit", "N m", &feedback.moment_limit}});
    check_limit(std::min(feedback.force_limit, feedback.moment_limit));
    return feedback;
}

namespace {

/// N of the force at rest per N that is commanded.
double passed_on(const HeaveTerms& terms, double gap) { return terms.actuator.gain * (1 - terms.thrust_lost(gap)); }

/// Small motions with the force as it is commanded, before the actuator.
LinearSystem commanded(const HeavePitch& plant, double gap, double pitch) {
    LinearSystem system = plant.linearised(gap, pitch);
    for (std::size_t i = 0; i < system.b.rows(); ++i) {
        system.b(i, 0) *= passed_on(plant.vertical().terms, gap);
    }
    return system;
}

}  // namespace

HeaveFeedback heave_lqr(const HeavePlant& plant, double gap, double velocity_weight, double gap_weight,
                        double input_weight) {
    LinearSystem system = heave_system(plant, gap);
    const double passed = passed_on(plant.terms, gap);
    if (passed == 0) {
        return {0, 0, gap, 0};
    }
    system.b(0, 0) *= passed;
    const Regulator k = lqr(system, Matrix::diagonal({velocity_weight, gap_weight}), Matrix::diagonal({input_weight}));
    return {k.gain(0, 1), k.gain(0, 0), gap, 0};
}

PitchFeedback pitch_lqr(const HeavePitch& plant, double gap, double pitch, const PitchWeights& weights) {
    const LinearSystem system = commanded(plant, gap, pitch);
    const Regulator regulator = lqr(system, Matrix::diagonal({weights.state.begin(), weights.state.end()}),
                                    Matrix::diagonal({weights.force, weights.moment}));
    PitchFeedback feedback;
    for (std::size_t i = 0; i < 4; ++i) {
        feedback.force_gain[i] = regulator.gain(0, i);
        feedback.moment_gain[i] = regulator.gain(1, i);
    }
    feedback.reference = {gap, 0, pitch, 0};
    return feedback;
}

std::vector<std::complex<double>> closed_poles(const HeavePitch& plant, const PitchFeedback& feedback) {
    const LinearSystem system = commanded(plant, feedback.reference[0], feedback.reference[2]);
    Matrix gain(2, 4);
    for (std::size_t i = 0; i < 4; ++i) {
        gain(0, i) = feedback.force_gain[i];
        gain(1, i) = feedback.moment_gain[i];
    }
    return eigenvalues(system.a - system.b * gain);
}

EquilibriumSweep equilibrium_sweep(const Model& model, const Conditions& held, Channel channel, double lower,
                                   double upper, std::size_t count) {
    if (count < 2 || !(upper > lower)) {
        throw core::InputError("range", "a sweep needs a range and at least two values");
    }
    EquilibriumSweep sweep;
    sweep.channel = channel;
    for (std::size_t i = 0; i < count; ++i) {
        Conditions conditions = held;
        conditions[channel] = lower + (upper - lower) * static_cast<double>(i) / static_cast<double>(count - 1);
        sweep.value.push_back(conditions[channel]);
        sweep.equilibria.push_back(heave_equilibria(HeavePlant(model, conditions)));
    }
    return sweep;
}

core::Figure equilibrium_figure(const EquilibriumSweep& sweep) {
    core::Figure figure;
    figure.title = std::string("Equilibria against ") + channel_name(sweep.channel);
    figure.x = {channel_name(sweep.channel), channel_unit(sweep.channel)};
    figure.y = {"gap", "mm"};
    core::FigurePoints stable{"stable", {}, {}, {}, core::palette(2), core::FigurePoints::Shape::disc, 4};
    core::FigurePoints unstable{"unstable", {}, {}, {}, core::palette(5), core::FigurePoints::Shape::circle, 4};
    for (std::size_t i = 0; i < sweep.value.size(); ++i) {
        for (const HeaveEquilibrium& e : sweep.equilibria[i]) {
            core::FigurePoints& points = e.stable ? stable : unstable;
            points.x.push_back(sweep.value[i]);
            points.y.push_back(1e3 * e.gap);
        }
    }
    figure.points = {stable, unstable};
    figure.caption =
        "Gaps where the vertical forces balance; from a stable one the body comes back after a small push.";
    return figure;
}

}  // namespace underbody::dynamics
