// A measured run on the ground against a model: its motion under the recorded thrusts of the jets.
#pragma once

#include "surrogates/dynamics/plant/environment.h"
#include "surrogates/dynamics/simulate/measured_motion.h"
#include "surrogates/dynamics/simulate/recorded_thrusts.h"
#include "surrogates/dynamics/simulate/surface_motion.h"

namespace underbody::dynamics {

/// Readings position_x, position_y and heading (unwrapped), perhaps speed, sway_velocity and yaw_rate; inputs
/// thrust_NAME of each jet of the model, N, as it acted. Flat on the ground all the time.
class MeasuredSurface final : public MeasuredMotion {
public:
    /// Throws core::InputError as SurfaceMotion does; for a model without jets, and a run without their thrusts in N.
    MeasuredSurface(const Model& model, const MeasuredRun& run, const RecordReading& records);

    [[nodiscard]] const MotionShape& shape() const override { return surface_motion().shape(); }
    [[nodiscard]] const std::vector<double>& time() const override { return signals_.time; }
    void rate(std::size_t k, double t, const MotionState& y, MotionState& dydt, const MotionLoads& loads) override;
    /// In steps of at most 20 ms, and no longer than the slip law of the ground bears.
    void advance(std::size_t k, MotionState& y, ContactState& bearing, const MotionLoads& loads) override;
    [[nodiscard]] double reading(std::size_t /*sample*/, std::size_t state, const MotionState& y) const override {
        return y[state];
    }
    [[nodiscard]] double delay(std::size_t /*state*/) const override { return 0; }
    void load_rates(const MotionState& y, std::array<MotionState, most_loads>& rates) const override;
    [[nodiscard]] double inertia(std::size_t load) const override { return motion_.inertias()[load]; }
    [[nodiscard]] std::optional<MotionStart> start(const MotionReadings& readings, std::size_t from,
                                                   std::size_t last) const override;
    [[nodiscard]] std::size_t free_rows() const override { return time().size(); }
    std::vector<std::string> clean_readings(const std::string& name, const Model& model) override {
        return clean_after(thrusts_.remarks(), name, model);
    }

private:
    InputSignals signals_;
    SurfaceMotion motion_;
    RecordedInputs inputs_;
    RecordedThrusts thrusts_;
    double longest_step_ = 0.02;  ///< s
};

}  // namespace underbody::dynamics
