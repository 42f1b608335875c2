#include "surrogates/dynamics/plant/environment.h"

#include <algorithm>

#include "surrogates/dynamics/model/table_notes.h"
#include "surrogates/dynamics/plant/contact_gap.h"

namespace underbody::dynamics {

HeavePlant vertical_channel(const Model& resolved, const Conditions& held, const std::vector<Channel>& varying) {
    Model alone = resolved;
    alone.forces.clear();
    HeavePlant plant(alone, held, varying);
    plant.keep_channels();
    plant.terms.contact_gap = contact_gap(resolved);
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

double RecordedInputs::max_step() const {
    double step = 0;
    if (run_) {
        step = std::numeric_limits<double>::max();
        for (std::size_t i = 0; i + 1 < run_->samples(); ++i) {
            step = std::min(step, run_->time()[i + 1] - run_->time()[i]);
        }
    }
    for (const HeaveTerms::Wave& wave : vertical_.terms.waves) {
        const double part = 0.1 / std::max(wave.frequency, 1e-9);
        step = step > 0 ? std::min(step, part) : part;
    }
    return step;
}

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

core::Problems motion_remarks(const Model& model, const Conditions& held) {
    core::Problems remarks = model.remarks;
    for (const core::Problems& more :
         {effects_without_motion(model), held_outside(model, held.over(model.conditions))}) {
        remarks.insert(remarks.end(), more.begin(), more.end());
    }
    return remarks;
}

}  // namespace underbody::dynamics
