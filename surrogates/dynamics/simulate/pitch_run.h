// A measured run of heave with pitch against a model: the motion over its recorded inputs, and what sensors read of it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/plant/contact_gap.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"

namespace underbody::dynamics {

inline constexpr std::size_t pitch_states = 4;
/// Channels of the states of a PitchState, in their order.
inline constexpr std::array<Channel, pitch_states> pitch_channels = {Channel::gap, Channel::heave_velocity,
                                                                     Channel::pitch, Channel::pitch_rate};

/// Whether the runs are to be taken as heave with pitch: as dataset.toml says, else where the model declares the
/// inertia and geometry that pitch needs and has a source of pitch_moment, and the pitch of every run moves by more
/// than five times its noise. Throws core::InputError where dataset.toml says so and a run has no pitch.
bool moves_in_pitch(const Model& model, const Measurements& data);

/// What was measured of a run, state by state.
struct PitchReadings {
    std::array<std::vector<double>, pitch_states> value;  ///< empty: not measured; NaN: no reading
    std::array<double, pitch_states> noise{};             ///< one standard deviation of a reading
};

/// One run with the plant of one model: inputs as the model's [records] say, held where these say nothing. Not for
/// several threads at once.
class PitchRun {
public:
    /// Throws core::InputError as HeavePitch does, and for a model with a history force, which has no states here.
    PitchRun(const Model& model, const MeasuredRun& run, const RecordReading& records);
    PitchRun(const PitchRun&) = delete;
    PitchRun& operator=(const PitchRun&) = delete;

    [[nodiscard]] const HeavePitch& plant() const { return plant_; }
    [[nodiscard]] const std::vector<double>& time() const { return signals_.time; }
    /// dy/dt within the interval after sample k, with a force (N up) and a moment (N m nose up) beside the model's.
    void rate(std::size_t k, double t, const PitchState& y, ContactState bearing, PitchState& dydt, double force = 0,
              double moment = 0);
    /// From sample k to the next by the fourth-order rule of Runge and Kutta in steps of at most 20 ms, through
    /// contact.
    void advance(std::size_t k, PitchState& y, ContactState& bearing, double force = 0, double moment = 0);
    /// What the sensor of a state reads at a sample; a delay of the gap's sensor to first order in its velocity.
    [[nodiscard]] double reading(std::size_t sample, std::size_t state, const PitchState& y) const;
    /// Readings of the run, velocities with the factor of the records.
    [[nodiscard]] const PitchReadings& readings() const { return readings_; }
    void set_noise(const std::array<double, pitch_states>& noise) { readings_.noise = noise; }
    /// Readings that a model is not judged by become missing: outliers, and gaps at the end of the sensor's range. What
    /// is said of it, and of gaps outside the tables of the model.
    std::vector<std::string> clean_readings(const std::string& name, const GapRange& tables);

private:
    InputSignals signals_;
    HeavePitch plant_;
    RecordedInputs inputs_;
    std::vector<double> input_moment_;  ///< N m; empty: none
    bool linear_ = false;
    PitchReadings readings_;
};

/// A prediction of one window: from the state that fits the readings from..start best, to end.
struct PitchWindow {
    std::size_t from = 0, start = 0, end = 0;
    PitchState state{};              ///< at `from`
    std::vector<PitchState> motion;  ///< at from..end
    [[nodiscard]] const PitchState& at(std::size_t sample) const { return motion[sample - from]; }
};

/// The motion from sample `from` to `end`.
std::vector<PitchState> motion_from(PitchRun& run, const PitchState& state, std::size_t from, std::size_t end);

/// The state at `from` whose motion fits these readings from..start best, in units of their noise; nothing later is
/// looked at. Nothing where gap or pitch were not read often enough.
std::optional<PitchState> fitted_state(PitchRun& run, const PitchReadings& readings, std::size_t from,
                                       std::size_t start);

/// Windows of `horizon` seconds one after the other, each begun from `past` seconds of readings.
std::vector<PitchWindow> predict_windows(PitchRun& run, double horizon, double past);

}  // namespace underbody::dynamics
