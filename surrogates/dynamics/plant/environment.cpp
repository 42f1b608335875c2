#include "surrogates/dynamics/plant/environment.h"

#include <algorithm>

#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/plant/contact_gap.h"
#include "surrogates/dynamics/plant/longest_step.h"

namespace underbody::dynamics {

HeavePlant vertical_channel(const Model& resolved, const Conditions& held, const std::vector<Channel>& varying) {
    Model alone = resolved;
    alone.forces.clear();
    HeavePlant plant(alone, held, varying);
    plant.keep_channels();
    plant.terms.contact_gap = contact_gap(resolved);
    if (!resolved.effects.empty()) {  // an effect may draw its correction from the lift, which is not here
        plant.terms.corrections = HeavePlant(resolved, held, varying).terms.corrections;
    }
    return plant;
}

RecordedInputs::RecordedInputs(const HeavePlant& vertical, const InputSignals& inputs) : vertical_(vertical) {
    if (!inputs.signals.empty()) {
        run_ = std::make_unique<HeaveRun>(vertical, inputs);
    }
}

Surroundings RecordedInputs::at(double t, const double* memory) {
    Surroundings around;
    around.t = t;
    around.memory = memory;
    if (run_) {
        HeaveMoment moment;
        run_->moment(t, moment, buffer_);
        around.input = moment.input;
        around.channels = moment.channels;
    }
    return around;
}

double RecordedInputs::max_step() const { return within_waves(run_ ? longest_step(run_->time()) : 0, vertical_.terms); }

std::vector<Channel> varying_channels(const InputSignals& inputs) {
    std::vector<Channel> varying;
    for (const InputSignals::Signal& signal : inputs.signals) {
        varying.push_back(signal.channel);
    }
    return varying;
}

core::Problems effects_without_motion(const Model& model) {
    core::Problems remarks;
    for (const EffectUse& use : model.effects) {
        const EffectInfo& info = effect(use.name).info();
        if (info.seen_in == SeenIn::static_set && info.belongs_to_the_rig) {
            remarks.push_back(
                {core::Problem::Severity::warning,
                 "effect " + use.name + " belongs to the rig of a static measurement; it leaves the motion as it is",
                 {}});
        }
    }
    return remarks;
}

namespace {

/// A condition holds from long before the start, and what an actuator makes of a constant late or slowly is that
/// constant. Who declares a delay or a lag and gives a constant may have meant a step.
core::Problems held_before_start(const Model& model, const Conditions& held) {
    HeaveTerms terms;
    for (const EffectUse& use : model.effects) {
        effect(use.name).add_to(terms, use, model);
    }
    if (!terms.actuator.has_states() || held.get(Channel::input_force, 0) == 0) {
        return {};
    }
    return {{core::Problem::Severity::warning,
             "input_force is a condition: it has acted since long before the start, so that the declared delay and lag "
             "of the actuator do not show; a force that begins at a time is an input over time, 0 before it",
             {}}};
}

}  // namespace

core::Problems motion_remarks(const Model& model, const Conditions& held) {
    core::Problems remarks = model.remarks;
    const Conditions all = held.over(model.conditions);
    for (const core::Problems& more :
         {effects_without_motion(model), held_outside(model, all), held_before_start(model, all),
          held_in_vain(model, held), gaps_of_another_size(model)}) {
        remarks.insert(remarks.end(), more.begin(), more.end());
    }
    return remarks;
}

}  // namespace underbody::dynamics
