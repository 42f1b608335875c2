#include "surrogates/dynamics/simulate/jet_drive.h"

#include <algorithm>

namespace underbody::dynamics {

MotionDriver::Settings body_settings(const BodyOptions& options, const RecordedInputs& inputs, std::size_t states) {
    constexpr double longest = 0.1;  // s
    const double corner = inputs.max_step();
    return {.states = states,
            .duration = options.duration,
            .output_step = options.output_step,
            .tolerance = options.tolerance,
            .absolute = 1e-2,
            .max_step = corner > 0 ? std::min(corner, longest) : longest};
}

JetDrive::JetDrive(const std::vector<Jet>& jets, const JetCommand& command, double command_step, std::size_t first)
    : jets_(jets), command_(command), command_step_(command_step), first_(first) {
    for (std::size_t i = 0; i < jets.size(); ++i) {
        if (jets[i].lag > 0) {
            lagged_.push_back(i);
        }
    }
}

std::vector<std::string> JetDrive::names() const {
    std::vector<std::string> names;
    for (const Jet& jet : jets_) {
        names.push_back(jet.name);
    }
    return names;
}

void JetDrive::sample(double t, const BodyState& body) {
    sampled_.clear();
    if (command_step_ > 0 && command_) {
        sampled_ = commanded(t, body);
    }
}

std::vector<double> JetDrive::commanded(double t, const BodyState& body) const {
    if (sampled()) {
        return sampled_;
    }
    std::vector<double> thrust = command_ ? command_(t, body) : std::vector<double>{};
    thrust.resize(jets_.size(), 0.0);
    for (std::size_t i = 0; i < thrust.size(); ++i) {
        thrust[i] = std::clamp(thrust[i], jets_[i].minimum, jets_[i].maximum);
    }
    return thrust;
}

void JetDrive::start(double t, const BodyState& body, std::vector<double>& y) const {
    const std::vector<double> first = commanded(t, body);
    for (const std::size_t jet : lagged_) {
        y.push_back(first[jet]);
    }
}

std::vector<double> JetDrive::thrusts(double t, const BodyState& body, const double* y) const {
    std::vector<double> thrust = commanded(t, body);
    for (std::size_t k = 0; k < lagged_.size(); ++k) {
        thrust[lagged_[k]] = y[first_ + k];
    }
    return thrust;
}

std::vector<double> JetDrive::rates(double t, const BodyState& body, const double* y, double* rate) const {
    std::vector<double> thrust = commanded(t, body);
    for (std::size_t k = 0; k < lagged_.size(); ++k) {
        double& at = thrust[lagged_[k]];
        rate[first_ + k] = (at - y[first_ + k]) / jets_[lagged_[k]].lag;
        at = y[first_ + k];
    }
    return thrust;
}

}  // namespace underbody::dynamics
