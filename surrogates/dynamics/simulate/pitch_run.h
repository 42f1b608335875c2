// A measured run of heave with pitch against a model: the motion over its recorded inputs, and what sensors read of it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/plant/contact_gap.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/simulate/measured_motion.h"

namespace underbody::dynamics {

inline constexpr std::size_t pitch_states = 4;
/// Channels of the states of a PitchState, in their order.
inline constexpr std::array<Channel, pitch_states> pitch_channels = {Channel::gap, Channel::heave_velocity,
                                                                     Channel::pitch, Channel::pitch_rate};

/// Whether the runs are to be taken as heave with pitch: as dataset.toml says, else where the model declares the
/// inertia and geometry that pitch needs and has a source of pitch_moment, and the pitch of every run moves by more
/// than five times its noise. Throws core::InputError where dataset.toml says so and a run has no pitch.
bool moves_in_pitch(const Model& model, const Measurements& data);

/// One run with the plant of one model: inputs as the model's [records] say, held where these say nothing. Not for
/// several threads at once.
class PitchRun final : public MeasuredMotion {
public:
    /// Throws core::InputError as HeavePitch does, and for a model with a history force, which has no states here.
    PitchRun(const Model& model, const MeasuredRun& run, const RecordReading& records);

    [[nodiscard]] const MotionShape& shape() const override { return heave_pitch_motion().shape(); }
    [[nodiscard]] const HeavePitch& plant() const { return plant_; }
    [[nodiscard]] const std::vector<double>& time() const override { return signals_.time; }
    void rate(std::size_t k, double t, const MotionState& y, MotionState& dydt, const MotionLoads& loads) override;
    /// In steps of at most 20 ms.
    void advance(std::size_t k, MotionState& y, ContactState& bearing, const MotionLoads& loads) override;
    [[nodiscard]] double reading(std::size_t sample, std::size_t state, const MotionState& y) const override;
    [[nodiscard]] double delay(std::size_t state) const override {
        return state == 0 ? plant_.vertical().terms.sensor_delay : 0;
    }
    void load_rates(const MotionState& y, std::array<MotionState, most_loads>& rates) const override;
    [[nodiscard]] double inertia(std::size_t load) const override {
        return load == 0 ? plant_.mass() : plant_.inertia();
    }
    [[nodiscard]] std::optional<MotionStart> start(const MotionReadings& readings, std::size_t from,
                                                   std::size_t last) const override;
    [[nodiscard]] std::size_t free_rows() const override;

private:
    void plant_rate(std::size_t k, double t, const MotionState& y, ContactState bearing, MotionState& dydt,
                    const MotionLoads& loads);
    InputSignals signals_;
    HeavePitch plant_;
    RecordedInputs inputs_;
    std::vector<double> input_moment_;  ///< N m; empty: none
    bool linear_ = false;
};

}  // namespace underbody::dynamics
