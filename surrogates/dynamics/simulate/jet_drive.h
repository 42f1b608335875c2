// The jets of a motion: commanded by a controller, continuously or from sample to sample, within their limits, after
// their lags.
#pragma once

#include <string>
#include <vector>

#include "surrogates/dynamics/simulate/motion_driver.h"
#include "surrogates/dynamics/simulate/rigid_body.h"

namespace underbody::dynamics {

/// Of motions with jets; `states`: how many there are.
MotionDriver::Settings body_settings(const BodyOptions& options, const RecordedInputs& inputs, std::size_t states);

/// The thrusts of jets with a lag are states, which stand in the motion's from `first` on.
class JetDrive {
public:
    JetDrive(const std::vector<Jet>& jets, const JetCommand& command, double command_step, std::size_t first);

    [[nodiscard]] std::vector<std::string> names() const;
    [[nodiscard]] std::size_t states() const { return lagged_.size(); }
    /// Takes the controller's next sample, which holds until the next one.
    void sample(double t, const BodyState& body);
    [[nodiscard]] bool sampled() const { return !sampled_.empty(); }
    /// The states at the start: what is commanded there, at the end of `y`.
    void start(double t, const BodyState& body, std::vector<double>& y) const;
    [[nodiscard]] std::vector<double> thrusts(double t, const BodyState& body, const double* y) const;
    /// The thrusts, and how those with a lag change.
    std::vector<double> rates(double t, const BodyState& body, const double* y, double* rate) const;

private:
    [[nodiscard]] std::vector<double> commanded(double t, const BodyState& body) const;
    const std::vector<Jet>& jets_;
    const JetCommand& command_;
    double command_step_;
    std::size_t first_;
    std::vector<std::size_t> lagged_;
    std::vector<double> sampled_;  ///< what a digital controller holds; empty: continuous
};

}  // namespace underbody::dynamics
