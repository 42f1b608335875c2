#include "surrogates/dynamics/simulate/body_run.h"

#include <algorithm>
#include <cmath>

#include "core/angle.h"
#include "core/text.h"
#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/motion_step.h"
#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::dynamics {

namespace {

enum Index { place_x, place_y, height, nose, heading, surge, sway, rise, nose_rate, turn };

constexpr double longest_step = 0.02;  ///< s
/// rad: with more roll the lift turns more than a twentieth of itself aside.
constexpr double much_roll = 0.05;

/// A load as force and moment in body axes.
Wrench wrench_of(std::size_t load, const BodyState& b) {
    const double st = std::sin(b[state_theta]), ct = std::cos(b[state_theta]);
    switch (load) {
        case 0:
            return {{ct, 0, st}, {}};
        case 1:
            return {{0, 1, 0}, {}};
        case 2:
            return {{st, 0, -ct}, {}};
        case 3:
            return {{}, {0, 1, 0}};
        default:
            return {{}, {0, 0, 1}};
    }
}

}  // namespace

MeasuredBody::MeasuredBody(const Model& model, const MeasuredRun& run, const RecordReading& records)
    : signals_(inputs_of_body(run, records)),
      body_(model, signals_.held, varying_channels(signals_)),
      inputs_(body_.vertical(), signals_),
      thrusts_(model, run, records) {
    if (body_.remembers()) {
        throw core::InputError("motion", "history_force cannot be predicted in the motion of the whole body",
                               {model.name, {}, {}, {}}, "leave the effect out, or say motion = \"heave\" of the runs");
    }
    take_readings(run, records, {height, nose});
    need_columns(run);
    unwrap(readings_.value[heading]);
    look_at_roll(run);
    BodyState level{};
    level[state_z] = body_.height_for_gap(1e3, 0);
    constexpr std::array<std::size_t, 5> answers{state_u, state_v, state_w, state_q, state_r};
    for (std::size_t l = 0; l < answers.size(); ++l) {
        inertia_[l] = 1 / std::abs(body_.answer(level, wrench_of(l, level))[answers[l]]);
    }
}

void MeasuredBody::need_columns(const MeasuredRun& run) const {
    const auto has = [&](Index i) { return !readings_.value[i].empty(); };
    const auto need = [&](bool enough, const char* what) {
        if (!enough) {
            throw core::InputError("missing", "run " + run.name + " of the whole body has no " + what,
                                   {run.table.source, {}, {}, {}},
                                   "gap [m] and pitch [rad]; heading or yaw_rate; position_x and position_y with the "
                                   "heading, or speed and sway_velocity");
        }
    };
    need(has(heading) || has(turn), "heading and no yaw_rate");
    need((has(place_x) && has(place_y) && has(heading)) || (has(surge) && has(sway)),
         "places (position_x, position_y, heading) and no speeds (speed, sway_velocity)");
}

void MeasuredBody::look_at_roll(const MeasuredRun& run) {
    const core::Column* column = run.table.find("roll");
    double most = 0;
    for (std::size_t k = 0; column != nullptr && k < column->numbers.size(); ++k) {
        most = std::isfinite(column->numbers[k]) ? std::max(most, std::abs(column->numbers[k])) : most;
    }
    if (most > much_roll) {
        of_roll_ = "run " + run.name + ": the roll reaches " + core::format_number(most / core::degree, 3) +
                   " deg, while the motion of the whole body holds it at zero: what it does to the other axes passes "
                   "for forces that the model lacks";
    }
}

std::vector<std::string> MeasuredBody::clean_readings(const std::string& name, const Model& model) {
    std::vector<std::string> said = thrusts_.remarks();
    if (!of_roll_.empty()) {
        said.push_back(of_roll_);
    }
    return clean_after(std::move(said), name, model);
}

BodyState MeasuredBody::plant_state(const MotionState& y) const {
    const auto [forward, aside] = body_.mass_offset();
    const double st = std::sin(y[nose]), ct = std::cos(y[nose]);
    const Vector3& base = body_.base_centre();
    BodyState b{};
    b[state_theta] = y[nose];
    b[state_psi] = y[heading];
    b[state_q] = y[nose_rate];
    b[state_r] = y[turn];
    b[state_v] = y[sway] + forward * y[turn];
    const double along = y[surge] - aside * y[turn] / ct - forward * y[nose_rate] * st,
                 down = (base[2] * st + base[0] * ct) * y[nose_rate] - y[rise];
    b[state_u] = along * ct - down * st;
    b[state_w] = along * st + down * ct;
    b[state_x] = y[place_x];
    b[state_y] = y[place_y];
    b[state_z] = body_.height_for_gap(y[height], y[nose]);
    return b;
}

MotionState MeasuredBody::motion_state(const BodyState& b) const {
    const auto [forward, aside] = body_.mass_offset();
    const double st = std::sin(b[state_theta]), ct = std::cos(b[state_theta]);
    MotionState y{};
    y[place_x] = b[state_x];
    y[place_y] = b[state_y];
    y[height] = body_.gap_at_base_centre(b);
    y[nose] = b[state_theta];
    y[heading] = b[state_psi];
    y[surge] = b[state_u] * ct + b[state_w] * st + aside * b[state_r] / ct + forward * b[state_q] * st;
    y[sway] = b[state_v] - forward * b[state_r];
    y[rise] = body_.rise_of_base(b);
    y[nose_rate] = b[state_q];
    y[turn] = b[state_r];
    return y;
}

MotionState MeasuredBody::rates_of(const BodyState& b, const std::array<double, 5>& change) const {
    const auto [forward, aside] = body_.mass_offset();
    const double st = std::sin(b[state_theta]), ct = std::cos(b[state_theta]);
    const Vector3& base = body_.base_centre();
    const auto [du, dv, dw, dq, dr] = change;
    MotionState rates{};
    rates[surge] = du * ct + dw * st + aside * dr / ct + forward * dq * st;
    rates[sway] = dv - forward * dr;
    rates[rise] = du * st - dw * ct + (base[2] * st + base[0] * ct) * dq;
    rates[nose_rate] = dq;
    rates[turn] = dr;
    return rates;
}

void MeasuredBody::plant_rate(std::size_t k, double t, const MotionState& y, ContactState bearing, MotionState& dydt,
                              const MotionLoads& loads) {
    const BodyState b = plant_state(y);
    const double part = (t - time()[k]) / (time()[k + 1] - time()[k]);
    BodyState d{};
    body_.rate(b, thrusts_.at(k, part), bearing, d, inputs_.at(t));
    std::array<double, 5> change{d[state_u], d[state_v], d[state_w], d[state_q], d[state_r]};
    for (std::size_t l = 0; l < loads.size(); ++l) {
        const std::array<double, 5> more = loads[l] != 0 ? body_.answer(b, wrench_of(l, b)) : std::array<double, 5>{};
        for (std::size_t i = 0; i < change.size(); ++i) {
            change[i] += loads[l] * more[i];
        }
    }
    const auto [forward, aside] = body_.mass_offset();
    const Vector3& base = body_.base_centre();
    const double st = std::sin(y[nose]), ct = std::cos(y[nose]), q = y[nose_rate], r = y[turn],
                 along = b[state_u] * ct + b[state_w] * st, down = -b[state_u] * st + b[state_w] * ct;
    dydt = rates_of(b, change);
    // what the turning of the axes adds
    dydt[surge] += down * q + aside * r * q * st / (ct * ct) + forward * q * q * ct;
    dydt[rise] += along * q + (base[2] * ct - base[0] * st) * q * q;
    dydt[place_x] = y[surge] * std::cos(y[heading]) - y[sway] * std::sin(y[heading]);
    dydt[place_y] = y[surge] * std::sin(y[heading]) + y[sway] * std::cos(y[heading]);
    dydt[height] = y[rise];
    dydt[nose] = q;
    dydt[heading] = r / ct;
}

void MeasuredBody::advance(std::size_t k, MotionState& y, ContactState& bearing, const MotionLoads& loads) {
    const double width = time()[k + 1] - time()[k];
    const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(width / longest_step * (1 - 1e-9))));
    const double h = width / static_cast<double>(steps);
    for (std::size_t s = 0; s < steps; ++s) {
        // the last moment of a step still has the input that is held over it
        const double begin = time()[k] + h * static_cast<double>(s), last = begin + h * (1 - 1e-9);
        motion_step(h, shape(), body_.vertical().terms, height, rise, y,
                    [&](double part, const MotionState& at, MotionState& d) {
                        plant_rate(k, part < 1 ? begin + part * h : last, at, bearing, d, loads);
                    });
        BodyState there = plant_state(y);
        const std::array<double, 2> gaps = body_.edge_gaps(there);
        const bool down = std::min(gaps[0], gaps[1]) < 0;
        if (down) {
            (void)strike(body_, there);
            y = motion_state(there);
        }
        if (down || bearing != ContactState::free) {
            const double part = (last - time()[k]) / width;
            bearing = body_.settle(there, thrusts_.at(k, part), down ? touching_edges(body_, there) : bearing,
                                   inputs_.at(last));
        }
    }
}

/// Upright, as simulate_body asks of a start: heading and yaw lose their meaning where the body stands on its nose.
bool MeasuredBody::goes_on(const MotionState& y) const {
    constexpr double upright = 1.5;  // rad
    return std::abs(y[nose]) < upright;
}

double MeasuredBody::reading(std::size_t sample, std::size_t state, const MotionState& y) const {
    const HeaveTerms& terms = body_.vertical().terms;
    switch (state) {
        case height:
            return y[height] - terms.sensor_delay * y[rise] + terms.sensor_offset(time()[sample]);
        case nose:
            return y[nose] + terms.pitch.sensor_bias;
        default:
            return y[state];
    }
}

double MeasuredBody::delay(std::size_t state) const {
    return state == height ? body_.vertical().terms.sensor_delay : 0;
}

void MeasuredBody::load_rates(const MotionState& y, std::array<MotionState, most_loads>& rates) const {
    const BodyState b = plant_state(y);
    for (std::size_t l = 0; l < rates.size(); ++l) {
        rates[l] = rates_of(b, body_.answer(b, wrench_of(l, b)));
    }
}

std::optional<MotionStart> MeasuredBody::start(const MotionReadings& readings, std::size_t from,
                                               std::size_t last) const {
    std::array<StartState, turn + 1> line;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (!readings.value[i].empty()) {
            line[i] = start_state(time(), readings.value[i], from, last);
        }
    }
    const auto slope = [&](Index place, Index rate) {
        return line[place].found() ? line[place].velocity : line[rate].gap;
    };
    const bool places = line[place_x].found() && line[place_y].found() && line[heading].found(),
               speeds = line[surge].found() && line[sway].found();
    if (!line[height].found() || !line[nose].found() || !(line[heading].found() || line[turn].found()) ||
        !(places || speeds)) {
        return {};
    }
    const HeaveTerms& terms = body_.vertical().terms;
    const double c = std::cos(line[heading].gap), s = std::sin(line[heading].gap), tilt = line[nose].gap;
    MotionStart begin;
    begin.state = {line[place_x].gap, line[place_y].gap, line[height].gap - terms.sensor_offset(time()[from]),
                   tilt - terms.pitch.sensor_bias, line[heading].gap};
    begin.state[surge] = places ? c * line[place_x].velocity + s * line[place_y].velocity : line[surge].gap;
    begin.state[sway] = places ? c * line[place_y].velocity - s * line[place_x].velocity : line[sway].gap;
    begin.state[rise] = slope(height, rise);
    begin.state[nose_rate] = slope(nose, nose_rate);
    begin.state[turn] = line[heading].found() ? line[heading].velocity * std::cos(tilt) : line[turn].gap;
    const double straight = places ? std::max(line[place_x].slope_factor, line[place_y].slope_factor) : 0;
    begin.slope_factor[surge] = begin.slope_factor[sway] = straight;
    begin.slope_factor[rise] = line[height].slope_factor;
    begin.slope_factor[nose_rate] = line[nose].slope_factor;
    begin.slope_factor[turn] = line[heading].slope_factor;
    return begin;
}

/// Until an edge of the base comes to the ground.
std::size_t MeasuredBody::free_rows() const {
    constexpr double near_ground = 3;  // standard deviations of the lower edge's reading
    const double half = body_.half_length();
    std::size_t end = 0;
    for (; end < time().size(); ++end) {
        const double edge =
            readings_.value[height][end] - body_.contact_gap() - half * std::abs(std::sin(readings_.value[nose][end]));
        if (edge < near_ground * std::hypot(readings_.noise[height], half * readings_.noise[nose])) {
            break;
        }
    }
    return end;
}

namespace {

class BodyKind final : public Motion {
public:
    [[nodiscard]] const MotionShape& shape() const override {
        static const MotionShape shape{"body",
                                       "the motion of the whole body",
                                       "touches the ground with an edge",
                                       {{"position_x", "m", place_x, 1e-3, 1e-5, 0.1, 0, 0, 1e4, true},
                                        {"position_y", "m", place_y, 1e-3, 1e-5, 0.1, 0, 0, 1e4, true},
                                        {"gap", "m", height, 1e-4, 1e-5, 0.05, 0, 0, 100},
                                        {"pitch", "rad", nose, 1e-3, 1e-5, 0.2, 0, 0, 10},
                                        {"heading", "rad", heading, 2e-3, 1e-5, 0.2, 0, 0, 1e4},
                                        {"speed", "m/s", place_x, 1e-2, 1e-5, 0.2, 0.1, 0.1, 1e300},
                                        {"sway_velocity", "m/s", place_y, 1e-2, 1e-5, 0.2, 0.1, 0.1, 1e300},
                                        {"heave_velocity", "m/s", height, 1e-3, 1e-5, 0.2, 0.05, 0.05, 1e300},
                                        {"pitch_rate", "rad/s", nose, 1e-2, 1e-4, 1, 0.3, 0.5, 1e300},
                                        {"yaw_rate", "rad/s", heading, 1e-2, 1e-4, 1, 0.3, 0.5, 1e300}},
                                       {{"surge_force", "N", 0.002, 0.001},
                                        {"side_force", "N", 0.002, 0.001},
                                        {"lift_force", "N", 0.002, 0.001},
                                        {"pitch_moment", "N m", 0.02, 0.05},
                                        {"yaw_moment", "N m", 0.02, 0.05}},
                                       {{"speed", surge},
                                        {"sway_velocity", sway},
                                        {"gap", height},
                                        {"heave_velocity", rise},
                                        {"pitch", nose},
                                        {"pitch_rate", nose_rate},
                                        {"yaw_rate", turn}},
                                       {2, 4}};
        return shape;
    }
    [[nodiscard]] std::unique_ptr<MeasuredMotion> run(const Model& model, const MeasuredRun& run,
                                                      const RecordReading& records) const override {
        return std::make_unique<MeasuredBody>(model, run, records);
    }
    [[nodiscard]] std::vector<std::string> inputs(const Model& model) const override {
        std::vector<std::string> columns = RecordedThrusts::columns(model);
        columns.emplace_back(channel_name(Channel::input_force));
        return columns;
    }
};

}  // namespace

const Motion& body_motion() {
    static const BodyKind motion;
    return motion;
}

}  // namespace underbody::dynamics
