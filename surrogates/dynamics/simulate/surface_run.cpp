#include "surrogates/dynamics/simulate/surface_run.h"

#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::dynamics {

namespace {

enum Index { place_x, place_y, heading, surge, sway, turn };

SurfaceState plant_state(const MotionState& y) {
    return {y[surge], y[sway], y[turn], y[heading], y[place_x], y[place_y]};
}

}  // namespace

MeasuredSurface::MeasuredSurface(const Model& model, const MeasuredRun& run, const RecordReading& records)
    : signals_(inputs_of_body(run, records)),
      motion_(model, signals_.held, varying_channels(signals_)),
      inputs_(motion_.vertical(), signals_),
      thrusts_(model, run, records) {
    constexpr double of_stability = 1.5;  // the rule of Runge and Kutta bears 2.8 times the time constant of the slip
    if (model.jets.empty()) {
        throw core::InputError("missing", "runs on the ground need the jets that drive them", {model.name, {}, {}, {}},
                               "declare them: [[jet]] name = ..., position, direction, maximum");
    }
    const double friction = model.contact.friction + std::max(0.0, motion_.vertical().terms.surface.friction);
    const double pressed = std::abs(motion_.contact({}, std::vector<double>(model.jets.size(), 0.0)).normal) + 1e-9;
    const double fastest =
        friction * pressed / model.contact.slip_speed / std::min(motion_.inertias()[0], motion_.inertias()[1]);
    longest_step_ = std::clamp(of_stability / std::max(fastest, 1e-9), 5e-4, longest_step_);
    take_readings(run, records, {place_x, place_y, heading});
    unwrap(readings_.value[heading]);
}

void MeasuredSurface::rate(std::size_t k, double t, const MotionState& y, MotionState& dydt, const MotionLoads& loads) {
    const double part = (t - time()[k]) / (time()[k + 1] - time()[k]);
    SurfaceState d{};
    motion_.rate(plant_state(y), thrusts_.at(k, part), d, inputs_.at(t));
    const std::array<double, 3> inertia = motion_.inertias();
    dydt = {d[4], d[5], d[3], d[0] + loads[0] / inertia[0], d[1] + loads[1] / inertia[1], d[2] + loads[2] / inertia[2]};
}

void MeasuredSurface::advance(std::size_t k, MotionState& y, ContactState& /*bearing*/, const MotionLoads& loads) {
    const double width = time()[k + 1] - time()[k];
    const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(width / longest_step_ * (1 - 1e-9))));
    const double h = width / static_cast<double>(steps);
    for (std::size_t s = 0; s < steps; ++s) {
        // the last moment of a step still has the input that is held over it
        const double begin = time()[k] + h * static_cast<double>(s), last = begin + h * (1 - 1e-9);
        runge_kutta(h, y, [&](double part, const MotionState& at, MotionState& d) {
            rate(k, part < 1 ? begin + part * h : last, at, d, loads);
        });
    }
}

void MeasuredSurface::load_rates(const MotionState& /*y*/, std::array<MotionState, most_loads>& rates) const {
    rates = {};
    const std::array<double, 3> inertia = motion_.inertias();
    rates[0][surge] = 1 / inertia[0];
    rates[1][sway] = 1 / inertia[1];
    rates[2][turn] = 1 / inertia[2];
}

std::optional<MotionStart> MeasuredSurface::start(const MotionReadings& readings, std::size_t from,
                                                  std::size_t last) const {
    std::array<StartState, 3> line;
    for (std::size_t i = 0; i < line.size(); ++i) {
        line[i] = start_state(time(), readings.value[i], from, last);
        if (!line[i].found()) {
            return {};
        }
    }
    const double c = std::cos(line[heading].gap), s = std::sin(line[heading].gap), along = line[place_x].velocity,
                 across = line[place_y].velocity;
    MotionStart begin;
    begin.state = {line[place_x].gap,      line[place_y].gap,      line[heading].gap,
                   c * along + s * across, c * across - s * along, line[heading].velocity};
    const double straight = std::max(line[place_x].slope_factor, line[place_y].slope_factor);
    begin.slope_factor = {0, 0, 0, straight, straight, line[heading].slope_factor};
    return begin;
}

namespace {

class SurfaceKind final : public Motion {
public:
    [[nodiscard]] const MotionShape& shape() const override {
        static const MotionShape shape{
            "surface",
            "the motion on the ground",
            "leaves it",
            {{"position_x", "m", 0, 1e-3, 1e-5, 0.1, 0, 0, 1e4},
             {"position_y", "m", 1, 1e-3, 1e-5, 0.1, 0, 0, 1e4},
             {"heading", "rad", 2, 2e-3, 1e-5, 0.2, 0, 0, 1e4},
             {"speed", "m/s", 0, 1e-2, 1e-5, 0.2, 0.1, 0.1, 1e300},
             {"sway_velocity", "m/s", 1, 1e-2, 1e-5, 0.2, 0.1, 0.1, 1e300},
             {"yaw_rate", "rad/s", 2, 1e-2, 1e-4, 1, 0.3, 0.5, 1e300}},
            {{"surge_force", "N", 0.002, 0.001}, {"side_force", "N", 0.002, 0.001}, {"yaw_moment", "N m", 0.02, 0.05}},
            {{"speed", 3}, {"sway_velocity", 4}, {"yaw_rate", 5}, {"heading", 2}},
            {0, 2}};
        return shape;
    }
    [[nodiscard]] std::unique_ptr<MeasuredMotion> run(const Model& model, const MeasuredRun& run,
                                                      const RecordReading& records) const override {
        return std::make_unique<MeasuredSurface>(model, run, records);
    }
    [[nodiscard]] std::vector<std::string> inputs(const Model& model) const override {
        return RecordedThrusts::columns(model);
    }
};

}  // namespace

const Motion& surface_motion() {
    static const SurfaceKind motion;
    return motion;
}

}  // namespace underbody::dynamics
