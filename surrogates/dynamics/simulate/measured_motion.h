// A measured run of a motion against a model: what predict() and discovery ask of it, whichever motion it is.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "surrogates/dynamics/plant/contact.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::dynamics {

inline constexpr std::size_t most_states = 10, most_loads = 5;
/// States in the order of MotionShape::states; what a motion has not is 0.
using MotionState = std::array<double, most_states>;
/// Forces (N) and moments (N m) beside the model's, in the order of MotionShape::loads.
using MotionLoads = std::array<double, most_loads>;

/// What a motion is made of.
struct MotionShape {
    struct State {
        std::string channel;        ///< column of its readings
        std::string unit;           ///< SI
        std::size_t place = 0;      ///< the state whose change it is; of a place its own number
        double noise = 1e-3;        ///< of a reading where neither declared nor seen in the scatter
        double small = 1e-5;        ///< step of a difference quotient
        double largest = 0.1;       ///< step of a fit
        double begin_width = 0.05;  ///< rates: how loosely a line through the first readings is believed by a filter
        double fit_width = 0.05;    ///< the same by a fit to the readings before a window
        double far = 100;           ///< a motion beyond this has run away
        bool ignorable = false;     ///< no rate depends on it
    };
    struct Load {
        std::string quantity, unit;
        double process = 0.002;  ///< m/s^2 s^(1/2) or rad/s^2: white load that a search of the noise begins at
        double walk = 0.001;     ///< m/s^2 or rad/s^2 in a second: how fast a residual may walk
    };
    /// What a law may hang on: a state's number.
    struct Variable {
        std::string quantity;
        std::size_t state = 0;
    };
    std::string name;  ///< as dataset.toml says it
    std::string words;
    std::string end_of_free;  ///< "touches the ground with an edge": what ends the free motion of a run
    std::vector<State> states;
    std::vector<Load> loads;
    std::vector<Variable> variables;
    std::array<std::size_t, 2> together{};  ///< of `variables`: two that a law may hang on at once
    [[nodiscard]] bool is_place(std::size_t state) const { return states[state].place == state; }
};

/// What was measured of a run, state by state.
struct MotionReadings {
    std::array<std::vector<double>, most_states> value;  ///< empty: not measured; NaN: no reading
    std::array<double, most_states> noise{};             ///< one standard deviation of a reading
};

/// A state out of lines through the first readings.
struct MotionStart {
    MotionState state{};
    std::array<double, most_states> slope_factor{};  ///< rates: variance of the line's slope over that of a reading
};

/// One run with the plant of one model: inputs as the model's [records] say, held where these say nothing. Not for
/// several threads at once.
class MeasuredMotion {
public:
    MeasuredMotion() = default;
    virtual ~MeasuredMotion() = default;
    MeasuredMotion(const MeasuredMotion&) = delete;
    MeasuredMotion& operator=(const MeasuredMotion&) = delete;

    [[nodiscard]] virtual const MotionShape& shape() const = 0;
    [[nodiscard]] virtual const std::vector<double>& time() const = 0;
    /// dy/dt of the free motion within the interval after sample k.
    virtual void rate(std::size_t k, double t, const MotionState& y, MotionState& dydt, const MotionLoads& loads) = 0;
    /// From sample k to the next, through contact; `bearing` is where it stands, and then.
    virtual void advance(std::size_t k, MotionState& y, ContactState& bearing, const MotionLoads& loads) = 0;
    /// False where the equations of the motion end: a body on its nose, or a contact that no force holds. What is
    /// predicted stands still there.
    [[nodiscard]] virtual bool goes_on(const MotionState& /*y*/) const { return true; }
    /// What the sensor of a state reads at a sample.
    [[nodiscard]] virtual double reading(std::size_t sample, std::size_t state, const MotionState& y) const = 0;
    /// s: how late the reading of a place is, to first order in its rate.
    [[nodiscard]] virtual double delay(std::size_t state) const = 0;
    /// What each load adds to the rates: rates[load][state].
    virtual void load_rates(const MotionState& y, std::array<MotionState, most_loads>& rates) const = 0;
    /// kg or kg m^2 that a load moves.
    [[nodiscard]] virtual double inertia(std::size_t load) const = 0;
    /// Nothing where the places were not read often enough within from..last.
    [[nodiscard]] virtual std::optional<MotionStart> start(const MotionReadings& readings, std::size_t from,
                                                           std::size_t last) const = 0;
    /// How many rows from the first on the body moves freely.
    [[nodiscard]] virtual std::size_t free_rows() const = 0;
    /// Readings that a model is not judged by become missing; what is said of it.
    virtual std::vector<std::string> clean_readings(const std::string& name, const Model& model) {
        return clean_after({}, name, model);
    }

    /// s: of what acted later the record knows nothing, and no prediction goes on.
    [[nodiscard]] double known_until() const { return known_until_; }
    /// Readings of the run, rates with the factor of the records; none beyond known_until().
    [[nodiscard]] const MotionReadings& readings() const { return readings_; }
    void set_noise(const std::array<double, most_states>& noise) { readings_.noise = noise; }

protected:
    /// Readings of all states of which the run has any. Throws core::InputError where it has none of one of `needed`.
    void take_readings(const MeasuredRun& run, const RecordReading& records,
                       std::initializer_list<std::size_t> needed = {});
    /// Outliers, and gaps at the end of the sensor's range, become missing; gaps outside the tables of the model are
    /// said. What is said of it, after `said`.
    std::vector<std::string> clean_after(std::vector<std::string> said, const std::string& name, const Model& model);
    MotionReadings readings_;

private:
    double known_until_ = 0;
};

/// A kind of motion that runs may be of.
class Motion {
public:
    virtual ~Motion() = default;
    [[nodiscard]] virtual const MotionShape& shape() const = 0;
    /// Throws core::InputError where the model lacks what the motion needs.
    [[nodiscard]] virtual std::unique_ptr<MeasuredMotion> run(const Model& model, const MeasuredRun& run,
                                                              const RecordReading& records) const = 0;
    /// Columns of what drives the body.
    [[nodiscard]] virtual std::vector<std::string> inputs(const Model& model) const = 0;
    /// True where the recorded inputs of a run move.
    [[nodiscard]] bool driven(const Model& model, const MeasuredRun& run) const;
    /// Equilibria without input, where the motion has some.
    [[nodiscard]] virtual std::vector<HeaveEquilibrium> equilibria(const Model& /*model*/,
                                                                   const Conditions& /*held*/) const {
        return {};
    }
};

/// Heave with pitch: gap, heave_velocity, pitch, pitch_rate; force up and moment nose up.
const Motion& heave_pitch_motion();
/// On the ground: position_x, position_y, heading, speed, sway_velocity, yaw_rate; forces forward and to starboard,
/// moment of yaw.
const Motion& surface_motion();
/// The vehicle off the ground, roll held at zero: position_x, position_y, gap, pitch, heading and their rates speed
/// (along the ground), sway_velocity, heave_velocity, pitch_rate, yaw_rate (about the body's own axis); forces forward,
/// to starboard and up, moments nose up and bow to starboard.
const Motion& body_motion();
/// The motion that these runs are of as dataset.toml says, or as model and readings tell; nullptr: heave alone.
const Motion* motion_of(const Model& model, const Measurements& data);

/// Values later than `known` (s) become missing.
void forget_after(const std::vector<double>& time, double known, std::vector<double>& values);

/// True where a run has such a column and its values differ; those that are missing tell nothing.
bool column_moves(const MeasuredRun& run, const std::string& column);

/// A step of `h` by the fourth-order rule of Runge and Kutta; rate(share of the step, state, its rate).
template <typename Rate>
void runge_kutta(double h, MotionState& y, const Rate& rate) {
    MotionState d1{}, d2{}, d3{}, d4{}, moved{};
    const auto along = [&](const MotionState& d, double part) {
        for (std::size_t i = 0; i < most_states; ++i) {
            moved[i] = y[i] + part * d[i];
        }
    };
    rate(0.0, y, d1);
    along(d1, 0.5 * h);
    rate(0.5, moved, d2);
    along(d2, 0.5 * h);
    rate(0.5, moved, d3);
    along(d3, h);
    rate(1.0, moved, d4);
    for (std::size_t i = 0; i < most_states; ++i) {
        y[i] += h / 6 * (d1[i] + 2 * d2[i] + 2 * d3[i] + d4[i]);
    }
}

/// A prediction of one window: from the state that fits the readings from..start best, to end.
struct MotionWindow {
    std::size_t from = 0, start = 0, end = 0;
    MotionState state{};              ///< at `from`
    std::vector<MotionState> motion;  ///< at from..end
    bool lost = false;                ///< it ended before (MeasuredMotion::goes_on)
    [[nodiscard]] const MotionState& at(std::size_t sample) const { return motion[sample - from]; }
};

/// The motion from sample `from` to `end`; `lost` (may be null): whether it ended before.
std::vector<MotionState> motion_from(MeasuredMotion& run, const MotionState& state, std::size_t from, std::size_t end,
                                     bool* lost = nullptr);

/// The state at `from` whose motion fits these readings from..start best, in units of their noise; nothing later is
/// looked at. Nothing where the places were not read often enough.
std::optional<MotionState> fitted_state(MeasuredMotion& run, const MotionReadings& readings, std::size_t from,
                                        std::size_t start);

/// Windows of `horizon` seconds one after the other, each begun from `past` seconds of readings.
std::vector<MotionWindow> predict_windows(MeasuredMotion& run, double horizon, double past);

}  // namespace underbody::dynamics
