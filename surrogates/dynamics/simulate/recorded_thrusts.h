// What acted on a body with jets, row by row of a measured run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

/// thrust_NAME of each jet of the model, N, as it acted, also where it has no value (fill_missing). Not for several
/// threads.
class RecordedThrusts {
public:
    /// As `records` say, held between samples where they do not. Throws core::InputError for a jet without its column
    /// in N, or with one that has no value.
    RecordedThrusts(const Model& model, const MeasuredRun& run, const RecordReading& records);
    [[nodiscard]] static std::string column(const Jet& jet);
    [[nodiscard]] static std::vector<std::string> columns(const Model& model);
    /// Within the interval after sample k, `part` of its width on; valid until the next call.
    std::span<const double> at(std::size_t k, double part);
    /// On thrusts beyond what a jet is declared for, and of no jet.
    [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

private:
    std::vector<std::vector<double>> thrust_;  ///< of each jet, row by row
    std::vector<double> acting_;
    std::vector<std::string> remarks_;
    bool linear_ = false;
};

/// The inputs of a run of a body with jets: without its states (gap, pitch, speed and their rates).
InputSignals inputs_of_body(const MeasuredRun& run, const RecordReading& records);

}  // namespace underbody::dynamics
