#include "surrogates/dynamics/simulate/pitch_run.h"

#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/heave_pitch_contact.h"
#include "surrogates/dynamics/simulate/motion_step.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"
#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::dynamics {

namespace {

constexpr double longest_step = 0.02;  ///< s
/// Standard deviations of its noise that a pitch has to move by for its motion to be one.
constexpr double moves_by = 5;

static_assert(pitch_states <= most_states);

PitchState plant_state(const MotionState& y) { return {y[0], y[1], y[2], y[3]}; }

/// The inputs of a run without its states.
InputSignals inputs_of(const MeasuredRun& run, const RecordReading& records) {
    InputSignals signals = signals_of(run, records);
    std::erase_if(signals.signals, [](const InputSignals::Signal& signal) {
        return std::find(pitch_channels.begin(), pitch_channels.end(), signal.channel) != pitch_channels.end();
    });
    return signals;
}

bool pitch_moves(const MeasuredRun& run) {
    const core::Column* column = run.table.find("pitch");
    if (column == nullptr || column->is_text()) {
        return false;
    }
    const std::vector<double>& time = run.table.numbers("time");
    std::vector<double> values = column->numbers;
    const double noise = sensor_noise(time, values);
    drop_outliers(values, std::max(noise, 1e-9));
    double sum = 0, square = 0, count = 0;
    for (const double value : values) {
        if (std::isfinite(value)) {
            sum += value;
            square += value * value;
            ++count;
        }
    }
    if (count < 5) {
        return false;
    }
    const double spread = std::sqrt(std::max(0.0, square / count - sum * sum / (count * count)));
    return spread > 1e-9 && spread > moves_by * noise;
}

}  // namespace

bool moves_in_pitch(const Model& model, const Measurements& data) {
    if (data.kind != MeasurementKind::time_series || data.motion == "heave") {
        return false;
    }
    if (data.motion == "heave_pitch") {
        for (const MeasuredRun& run : data.runs) {
            if (run.table.find("pitch") == nullptr) {
                throw core::InputError("missing", "run " + run.name + " is of heave with pitch and has no column pitch",
                                       {run.table.source, {}, {}, {}},
                                       "pitch [rad], positive nose up; or motion = "
                                       "\"heave\"");
            }
        }
        return true;
    }
    const Vehicle& v = model.vehicle;
    const std::vector<std::string> sources = model.quantities();
    return !std::isnan(v.pitch_inertia) && !std::isnan(v.base_depth) && !std::isnan(v.base_half_length) &&
           std::find(sources.begin(), sources.end(), "pitch_moment") != sources.end() && !data.runs.empty() &&
           std::all_of(data.runs.begin(), data.runs.end(), pitch_moves);
}

PitchRun::PitchRun(const Model& model, const MeasuredRun& run, const RecordReading& records)
    : signals_(inputs_of(run, records)),
      plant_(model, signals_.held, varying_channels(signals_)),
      inputs_(plant_.vertical(), signals_),
      linear_(records.input_between == RecordReading::Between::linear) {
    if (plant_.remembers()) {
        throw core::InputError("motion", "history_force cannot be predicted in heave with pitch",
                               {model.name, {}, {}, {}}, "leave the effect out, or say motion = \"heave\" of the runs");
    }
    if (run.has("input_moment") && !as_acted(run, "input_moment", records, input_moment_)) {
        input_moment_.clear();
    }
    take_readings(run, records, {0, 2});
}

void PitchRun::plant_rate(std::size_t k, double t, const MotionState& y, ContactState bearing, MotionState& dydt,
                          const MotionLoads& loads) {
    Surroundings around = inputs_.at(t);
    around.force = loads[0];
    around.moment = loads[1];
    if (!input_moment_.empty()) {
        const double part = linear_ ? (t - time()[k]) / (time()[k + 1] - time()[k]) : 0;
        around.moment += plant_.vertical().terms.pitch.moment_gain *
                         (input_moment_[k] + (part > 0 ? part * (input_moment_[k + 1] - input_moment_[k]) : 0));
    }
    PitchState rate{};
    plant_.rate(plant_state(y), bearing, rate, around);
    std::copy(rate.begin(), rate.end(), dydt.begin());
}

void PitchRun::rate(std::size_t k, double t, const MotionState& y, MotionState& dydt, const MotionLoads& loads) {
    plant_rate(k, t, y, ContactState::free, dydt, loads);
}

void PitchRun::advance(std::size_t k, MotionState& y, ContactState& bearing, const MotionLoads& loads) {
    const double width = time()[k + 1] - time()[k];
    const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(width / longest_step * (1 - 1e-9))));
    const double h = width / static_cast<double>(steps);
    for (std::size_t s = 0; s < steps; ++s) {
        // the last moment of a step still has the input that is held over it
        const double begin = time()[k] + h * static_cast<double>(s), last = begin + h * (1 - 1e-9);
        motion_step(h, shape(), plant_.vertical().terms, 0, 1, y,
                    [&](double part, const MotionState& at, MotionState& d) {
                        plant_rate(k, part < 1 ? begin + part * h : last, at, bearing, d, loads);
                    });
        PitchState there = plant_state(y);
        const std::array<double, 2> gaps = plant_.edge_gaps(there);
        if (std::min(gaps[0], gaps[1]) < 0) {
            land(plant_, there, bearing, inputs_.at(last));
            std::copy(there.begin(), there.end(), y.begin());
        } else if (bearing != ContactState::free) {
            bearing = plant_.settle(there, bearing, inputs_.at(last));
        }
    }
}

double PitchRun::reading(std::size_t sample, std::size_t state, const MotionState& y) const {
    const HeaveTerms& terms = plant_.vertical().terms;
    switch (state) {
        case 0:
            return y[0] - terms.sensor_delay * y[1] + terms.sensor_offset(time()[sample]);
        case 2:
            return y[2] + terms.pitch.sensor_bias;
        default:
            return y[state];
    }
}

void PitchRun::load_rates(const MotionState& y, std::array<MotionState, most_loads>& rates) const {
    rates = {};
    rates[0][1] = 1 / plant_.mass(y[0]);
    rates[1][1] = plant_.arm(y[2]) / plant_.inertia();
    rates[1][3] = 1 / plant_.inertia();
}

std::optional<MotionStart> PitchRun::start(const MotionReadings& readings, std::size_t from, std::size_t last) const {
    const StartState gap = start_state(time(), readings.value[0], from, last),
                     pitch = start_state(time(), readings.value[2], from, last);
    if (!gap.found() || !pitch.found()) {
        return {};
    }
    const HeaveTerms& terms = plant_.vertical().terms;
    MotionStart begin;
    begin.state = {gap.gap - terms.sensor_offset(time()[from]), gap.velocity, pitch.gap - terms.pitch.sensor_bias,
                   pitch.velocity};
    begin.slope_factor = {0, gap.slope_factor, 0, pitch.slope_factor};
    return begin;
}

/// Until an edge of the base comes to the ground.
std::size_t PitchRun::free_rows() const {
    constexpr double near_ground = 3;  // standard deviations of the lower edge's reading
    const double contact = plant_.contact_gap(), half = plant_.half_length();
    const MotionReadings& read = readings_;
    std::size_t end = 0;
    for (; end < time().size(); ++end) {
        const double edge = read.value[0][end] - contact - half * std::abs(std::sin(read.value[2][end]));
        if (edge < near_ground * std::hypot(read.noise[0], half * read.noise[2])) {
            break;
        }
    }
    return end;
}

namespace {

class HeavePitchMotion final : public Motion {
public:
    [[nodiscard]] const MotionShape& shape() const override {
        static const MotionShape shape{"heave_pitch",
                                       "heave with pitch",
                                       "touches the ground with an edge",
                                       {{"gap", "m", 0, 1e-4, 1e-5, 0.05, 0, 0, 100},
                                        {"heave_velocity", "m/s", 0, 1e-3, 1e-5, 0.2, 0.05, 0.05, 1e300},
                                        {"pitch", "rad", 2, 1e-3, 1e-5, 0.2, 0, 0, 10},
                                        {"pitch_rate", "rad/s", 2, 1e-2, 1e-4, 1, 0.3, 0.5, 1e300}},
                                       {{"lift_force", "N", 0.002, 0.001}, {"pitch_moment", "N m", 0.02, 0.05}},
                                       {{"gap", 0}, {"heave_velocity", 1}, {"pitch", 2}, {"pitch_rate", 3}},
                                       {0, 2}};
        return shape;
    }
    [[nodiscard]] std::unique_ptr<MeasuredMotion> run(const Model& model, const MeasuredRun& run,
                                                      const RecordReading& records) const override {
        return std::make_unique<PitchRun>(model, run, records);
    }
    [[nodiscard]] std::vector<std::string> inputs(const Model& /*model*/) const override {
        return {"input_force", "input_moment"};
    }
    [[nodiscard]] std::vector<HeaveEquilibrium> equilibria(const Model& model, const Conditions& held) const override {
        return HeavePitch(model, held).equilibria();
    }
};

}  // namespace

const Motion& heave_pitch_motion() {
    static const HeavePitchMotion motion;
    return motion;
}

}  // namespace underbody::dynamics
