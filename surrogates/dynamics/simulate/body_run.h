// A measured run of the whole vehicle off the ground against a model: its motion under the recorded thrusts.
#pragma once

#include "surrogates/dynamics/plant/environment.h"
#include "surrogates/dynamics/simulate/measured_motion.h"
#include "surrogates/dynamics/simulate/recorded_thrusts.h"
#include "surrogates/dynamics/simulate/rigid_body.h"

namespace underbody::dynamics {

/// Readings gap and pitch; position_x, position_y and heading (unwrapped), or speed and sway_velocity, and heading or
/// yaw_rate; perhaps the other rates. Inputs thrust_NAME of each jet of the model, N, as it acted, and input_force.
/// Places and speeds are those of the centre of gravity as declared, wherever effects put it; roll is held at zero.
class MeasuredBody final : public MeasuredMotion {
public:
    /// Throws core::InputError as RigidBody and RecordedThrusts do; for missing columns, and a history force.
    MeasuredBody(const Model& model, const MeasuredRun& run, const RecordReading& records);

    [[nodiscard]] const MotionShape& shape() const override { return body_motion().shape(); }
    [[nodiscard]] const std::vector<double>& time() const override { return signals_.time; }
    void rate(std::size_t k, double t, const MotionState& y, MotionState& dydt, const MotionLoads& loads) override {
        plant_rate(k, t, y, ContactState::free, dydt, loads);
    }
    /// In steps of at most 20 ms.
    void advance(std::size_t k, MotionState& y, ContactState& bearing, const MotionLoads& loads) override;
    [[nodiscard]] bool goes_on(const MotionState& y) const override;
    [[nodiscard]] double reading(std::size_t sample, std::size_t state, const MotionState& y) const override;
    [[nodiscard]] double delay(std::size_t state) const override;
    void load_rates(const MotionState& y, std::array<MotionState, most_loads>& rates) const override;
    [[nodiscard]] double inertia(std::size_t load) const override { return inertia_[load]; }
    [[nodiscard]] std::optional<MotionStart> start(const MotionReadings& readings, std::size_t from,
                                                   std::size_t last) const override;
    [[nodiscard]] std::size_t free_rows() const override;
    std::vector<std::string> clean_readings(const std::string& name, const Model& model) override;

private:
    void need_columns(const MeasuredRun& run) const;
    void look_at_roll(const MeasuredRun& run);
    [[nodiscard]] BodyState plant_state(const MotionState& y) const;
    [[nodiscard]] MotionState motion_state(const BodyState& b) const;
    /// What changes of the body's speeds u, v, w, q, r, beside the kinematics, are in the rates of this motion.
    [[nodiscard]] MotionState rates_of(const BodyState& b, const std::array<double, 5>& change) const;
    void plant_rate(std::size_t k, double t, const MotionState& y, ContactState bearing, MotionState& dydt,
                    const MotionLoads& loads);
    InputSignals signals_;
    RigidBody body_;
    RecordedInputs inputs_;
    RecordedThrusts thrusts_;
    MotionLoads inertia_{};
    std::string of_roll_;  ///< what is said of a roll that moves
};

}  // namespace underbody::dynamics
