#include "surrogates/discovery/watch/watch.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/no_limit.h"
#include "core/told.h"
#include "surrogates/discovery/watch/still_reading.h"
#include "surrogates/discovery/watch/watch_fault.h"
#include "surrogates/discovery/watch/watch_scores.h"
#include "surrogates/dynamics/simulate/doubtful_readings.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::discovery {

namespace {

constexpr double first_step = 1e-3;  ///< s, taken where there is no reading before
constexpr double time_slack = 1e-6;  ///< of a step: the time of readings is rounded

constexpr double least_block = 1;             ///< s
constexpr double blocks_of_colour = 20;       ///< correlation times in a block: its neighbours do not know of it
constexpr double least_steps = 10;            ///< of a block
constexpr std::size_t steps_to_learn = 100;   ///< at least
constexpr std::size_t most_steps = 60000;     ///< kept
constexpr std::size_t most_waiting = 100000;  ///< inputs and velocities whose reading of the gap has not come
constexpr std::size_t most_plants = 64;
constexpr std::size_t most_backwards = 20;  ///< readings in a row that run backwards: the clock began anew
constexpr std::size_t set_back = 3;         ///< so many, then forwards again: the clock was set back a little
constexpr double calm = 0.5;                ///< share of a threshold below which what was read may be learned from
constexpr double longest_learned = 400;     ///< s, of what is learned from
constexpr double input_memory = 300;        ///< s: how much the input may change at once is remembered
constexpr double silence = 1;               ///< s without a reading: nothing is known of what was between
constexpr double input_late = 1.5;          ///< usual steps without an input: another one may have acted
constexpr double own_input_memory = 500;    ///< readings
constexpr double own_input_usual = 0.8;     ///< share of readings with an input of their own: one without lost it
constexpr double first_look = 1;            ///< s of readings, and ...
constexpr std::size_t first_readings = 20;  ///< ... so many, by which gaps are held against the tables
constexpr double off_tables = 6;            ///< noises of a reading: so near to a table it is inside

const char* words(std::size_t direction) {
    constexpr const char* all[watch_directions] = {
        "a constant force", "a force that grows with the velocity", "a force of the direction of motion",
        "a force that grows with the gap", "a force that grows with the input"};
    return all[direction];
}

}  // namespace

struct Watch::Parts {
    Parts(const dynamics::Model& of, WatchOptions with)
        : model(of), options(std::move(with)), next_learn(options.learn) {
        for (const auto& [name, value] : options.conditions) {
            dynamics::Channel channel{};
            if (dynamics::find_channel(name, channel)) {
                held[channel] = value;
            }
        }
        follow_conditions();
    }

    /// The plants of the model as it is, and with one of its numbers higher by the error that it states.
    struct Plants {
        WatchPlant plant;
        std::vector<WatchPlant> doubted;
    };

    [[nodiscard]] Plants make_plants() const {
        Plants out{std::make_shared<const dynamics::HeavePlant>(model, held), {}};
        for (std::size_t e = model.effects.size(); e-- > 0;) {  // what was found last first
            for (std::size_t i = 0; i < model.effects[e].sigmas.size() && out.doubted.size() < most_doubts; ++i) {
                if (model.effects[e].sigmas[i] > 0) {
                    dynamics::Model other = model;
                    other.effects[e].values[i] = moved_by_its_error(model.effects[e], i);
                    out.doubted.push_back(std::make_shared<const dynamics::HeavePlant>(other, held));
                }
            }
        }
        return out;
    }

    /// `plant` and `doubted` under the conditions that hold.
    void follow_conditions() {
        std::vector<double> key(held.value.begin(), held.value.end());
        std::replace_if(
            key.begin(), key.end(), [](double v) { return std::isnan(v); }, -core::no_limit);
        if (plants.size() > most_plants) {
            plants.clear();
        }
        const auto known = plants.find(key);
        const Plants& found = known != plants.end() ? known->second : plants.emplace(key, make_plants()).first->second;
        plant = found.plant;
        doubted = found.doubted;
    }

    // ---- from readings to steps
    void add_input(double time, double force) {
        const double t = time - model.records.input_advance, u = force * model.records.input_factor;
        if (!input_time.empty() && t <= input_time.back()) {
            return;
        }
        if (!input_time.empty()) {
            const double forgotten = std::exp((input_time.back() - t) / input_memory);
            largest_change = std::max(forgotten * largest_change, std::abs(u - input_value.back()));
        }
        if (input_time.size() > most_waiting) {  // inputs alone, no gap
            input_time.erase(input_time.begin(), input_time.begin() + most_waiting / 2);
            input_value.erase(input_value.begin(), input_value.begin() + most_waiting / 2);
        }
        input_time.push_back(t);
        input_value.push_back(u);
    }

    /// True where the reading at `time` has no input of its own while nearly all have one: its field was not read.
    bool input_is_lost(double time) {
        if (input_time.empty() || !(usual_step > 0)) {
            return false;
        }
        const auto next = std::lower_bound(input_time.begin(), input_time.end(), time - 0.5 * usual_step);
        const bool own = next != input_time.end() && *next < time + 0.5 * usual_step;
        own_input += ((own ? 1 : 0) - own_input) / own_input_memory;
        return !own && own_input > own_input_usual;
    }

    /// Rows of the log are lost, and with them what a controller commanded: it went the way from the last to the next
    /// command that is known (held, a controller's answer to the motion would look like damping that is missing), and
    /// how much else is said. `unread`: the input at `from` is missing, whatever came after it.
    void bridge_lost_inputs(double from, bool unread, WatchStep& step) {
        const auto after = std::upper_bound(input_time.begin(), input_time.end(), from + 1e-9) - input_time.begin();
        const auto next = static_cast<std::size_t>(after);
        const bool before_step = next < input_time.size() && input_time[next] < step.time - 0.5 * usual_step;
        if (input_time.empty() || (before_step && !unread)) {
            return;  // logged by itself
        }
        step.unknown_for = (before_step ? input_time[next] : step.time) - from;
        const double missed = step.unknown_for / usual_step;
        step.unknown_input = 0.5 * std::abs(plant->terms.actuator.gain) * largest_change * std::sqrt(missed);
        if (next == 0 || next == input_time.size() || input_time[next] > step.time + 0.5 * usual_step) {
            return;
        }
        const double t0 = input_time[next - 1], u0 = input_value[next - 1];
        const double slope = (input_value[next] - u0) / (input_time[next] - t0);
        std::vector<double> times, values;
        for (double t = t0 + usual_step; t < input_time[next] - 0.5 * usual_step; t += usual_step) {
            times.push_back(t);
            values.push_back(u0 + slope * (t - t0));
        }
        input_time.insert(input_time.begin() + after, times.begin(), times.end());
        input_value.insert(input_value.begin() + after, values.begin(), values.end());
    }

    /// Mean input that reached the body over the step, out of the last inputs; older ones are forgotten.
    void find_input(double from, WatchStep& step) {
        const dynamics::Actuator& actuator = plant->terms.actuator;
        if (input_time.empty()) {
            step.input = plant->held_input();
            return;
        }
        from = std::min(from, step.time - first_step);  // the first step has none before it
        std::vector<double> out;
        const bool hold = model.records.input_between != dynamics::RecordReading::Between::linear;
        dynamics::Actuator{}.mean_over_steps(input_time, input_value, hold, {from, step.time}, out);
        step.command = out[1];
        actuator.mean_over_steps(input_time, input_value, hold, {from, step.time}, out);
        step.input = out[1];
        const double needed = from - std::max(actuator.delay, 0.0) - 12 * actuator.lag;
        const auto old = std::upper_bound(input_time.begin(), input_time.end(), needed) - input_time.begin() - 1;
        if (old > 64) {
            input_time.erase(input_time.begin(), input_time.begin() + old);
            input_value.erase(input_value.begin(), input_value.begin() + old);
        }
    }

    std::optional<WatchAlarm> add_gap(double time, double value) {
        std::optional<WatchAlarm> alarm;
        if (count > 0 && time <= last_time) {
            ++passed_over;
            if (++backwards < most_backwards) {
                return alarm;
            }
            begin_anew();
        }
        if (backwards >= set_back) {
            begin_anew();  // how long these rows took is not known
        }
        backwards = 0;
        if (count_in_step > 0 && time - step_begin >= record_step * (1 - time_slack)) {
            alarm = flush(time);
        }
        if (count_in_step == 0) {
            step_begin = time;
        }
        ++count;
        last_time = time;
        ++count_in_step;
        sum_time += time;
        if (still.take(time, value)) {
            alarm = stands_still(still, time, "gap", "m");
        } else if (pending_alarm) {
            alarm = std::exchange(pending_alarm, std::nullopt);
        }
        if (std::isfinite(value)) {
            no_use = still.still() || !inside(value);
        }
        if (std::isfinite(value) && !no_use) {
            sum_gap += value;
            gaps += 1;
        }
        if (!noise) {
            raw_time.push_back(time);
            raw_gap.push_back(value);
            if (raw_time.size() > most_waiting) {
                raw_time.clear();
                raw_gap.clear();
            }
            if (!looked && raw_time.size() >= first_readings && raw_time.back() - raw_time.front() >= first_look) {
                looked = true;
                const auto beside = dynamics::beside_tables(raw_gap, tables());
                if (beside && !beside->hint.empty()) {
                    doubt = WatchDoubt{"this log is not the model's: " + beside->text, beside->hint};
                }
            }
        }
        return alarm;
    }

    [[nodiscard]] dynamics::GapRange tables() const { return {plant->terms.table_lower, plant->terms.table_upper}; }

    bool inside(double value) {
        const auto declared = options.noise.find("gap");
        const double sigma = noise                             ? std::hypot(noise->noise.gap, noise->noise.slow)
                             : declared != options.noise.end() ? declared->second
                                                               : dynamics::usual_gap_noise;
        const dynamics::GapRange range = tables();
        const bool in = value > range.lower - off_tables * sigma && value < range.upper + off_tables * sigma;
        outside += in ? 0 : 1;
        return in;
    }

    static WatchAlarm stands_still(const StillReading& still, double time, const std::string& channel,
                                   const std::string& unit) {
        WatchAlarm alarm;
        alarm.time = time;
        alarm.since = still.since();
        alarm.sensor = true;
        alarm.shows = "the " + channel + " stands still at " + core::told(still.value(), unit, 6) + ": " +
                      std::to_string(still.alike()) + " readings alike" +
                      (still.ever_changed() ? ", which its noise does not make: its sensor" : ", all that there are");
        return alarm;
    }

    /// The logger was started anew and its clock with it. What was learned stays.
    void begin_anew() {
        steps.clear();
        pending.clear();
        input_time.clear();
        input_value.clear();
        count_in_step = 0;
        sum_time = sum_gap = gaps = usual_step = 0;
        if (noise) {
            restart_filter();
            scores->restart();
        }
    }

    /// With the noise that was learned.
    void restart_filter() {
        residuals = std::make_unique<WatchResiduals>(plant, noise->noise);
        residuals->set_colours(noise->colours);
        residuals->set_doubted(doubted);
    }

    /// Readings up to `next_begin`, averaged.
    WatchStep make_step(double next_begin) {
        double sum_velocity = 0, velocities = 0;
        while (!pending.empty() && pending.front().first < next_begin) {
            sum_velocity += pending.front().second;
            velocities += 1;
            pending.pop_front();
        }
        WatchStep step;
        step.time = sum_time / static_cast<double>(count_in_step);
        step.gap = gaps > 0 ? sum_gap / gaps : std::nan("");
        step.gap_share = gaps > 0 ? 1 / std::sqrt(gaps) : 1;
        step.velocity = velocities > 0 ? sum_velocity / velocities : std::nan("");
        step.velocity_share = velocities > 0 ? 1 / std::sqrt(velocities) : 1;
        count_in_step = 0;
        sum_time = sum_gap = gaps = 0;
        return step;
    }

    void keep(const WatchStep& step) {
        watched += steps.empty() || (no_use && !scores) ? 0 : std::min(step.time - steps.back().time, silence);
        steps.push_back(step);
        while (steps.back().time - steps.front().time > options.remember || steps.size() > most_steps) {
            steps.pop_front();
        }
    }

    /// Readings that are missing: steps without one, each with its own input.
    void fill(const WatchStep& until) {
        const double begin = steps.back().time;
        for (int i = 1; begin + (i + 0.5) * usual_step < until.time; ++i) {
            WatchStep step;
            step.time = begin + i * usual_step;
            step.gap = step.velocity = std::nan("");
            find_input(steps.back().time, step);
            keep(step);
            if (scores) {
                residuals->take(step);
            }
        }
    }

    std::optional<WatchAlarm> flush(double next_begin) {
        WatchStep step = make_step(next_begin);
        if (!steps.empty()) {
            const double dt = step.time - steps.back().time;
            if (!(dt > 0)) {
                return {};
            }
            const bool late = usual_step > 0 && dt > input_late * usual_step;
            const bool unread = input_is_lost(steps.back().time);
            if (dt < silence && (late || unread)) {
                bridge_lost_inputs(steps.back().time, unread, step);
            }
            if (dt < silence && late) {
                fill(step);
            }
            follow_step(usual_step, dt);
        }
        find_input(steps.empty() ? step.time : steps.back().time, step);
        keep(step);
        const bool learn_now =
            watched >= next_learn && steps.size() >= steps_to_learn && (!scores || scores->nearest() < calm);
        if (!scores) {
            if (learn_now) {
                learn();
            }
            return {};
        }
        std::optional<WatchAlarm> alarm = judge(step);
        if (learn_now && !alarm && 2 * next_learn <= options.remember) {
            learn();
        }
        return alarm;
    }

    // ---- learning
    void learn() {
        next_learn = 2 * watched;
        HeaveNoise begin = noise ? noise->noise : noise_of_readings();
        begin.gap = noise ? std::hypot(begin.gap, begin.slow) : begin.gap;
        std::deque<WatchStep> recent = steps;
        while (recent.back().time - recent.front().time > longest_learned) {
            recent.pop_front();
        }
        if (!noise) {
            doubt = doubt ? doubt : doubtful_log(plant, recent);
        }
        noise = learn_noise(plant, recent, begin);
        if (!fault) {
            const auto declared = options.noise.find("gap");
            fault =
                fault_from_the_begin(plant, recent, *noise,
                                     declared != options.noise.end() ? std::optional(declared->second) : std::nullopt);
        }
        raw_time = {};
        raw_gap = {};
        restart_filter();
        const double block =
            std::max({least_block, least_steps * usual_step, blocks_of_colour * noise->correlation_time});
        // what was learned from also gives the scores their scale; sums that have begun go on where the blocks are
        // alike
        auto fresh =
            std::make_unique<WatchScores>(block, usual_step, options.false_alarms_per_day, options.fitted_over);
        const bool alike = scores && std::abs(block - scores->block()) < 0.2 * block;
        for (const WatchStep& step : recent) {
            const auto seen = residuals->take(step);
            if (!alike) {
                fresh->take(step.time, seen, false);
            }
        }
        if (!alike) {
            judged_before += scores ? scores->judged() : 0;
            scores = std::move(fresh);
        }
    }

    HeaveNoise noise_of_readings() {
        HeaveNoise out;
        const auto own = [&](const char* name, const std::vector<double>& time, const std::vector<double>& values,
                             double otherwise) {
            const auto declared = options.noise.find(name);
            const double found = dynamics::sensor_noise(time, values);
            return declared != options.noise.end()     ? declared->second
                   : std::isfinite(found) && found > 0 ? found
                                                       : otherwise;
        };
        std::vector<double> velocity_time, velocity;
        for (const WatchStep& step : steps) {
            if (std::isfinite(step.velocity)) {
                velocity_time.push_back(step.time);
                velocity.push_back(step.velocity / step.velocity_share);
            }
        }
        out.gap = own("gap", raw_time, raw_gap, dynamics::usual_gap_noise);
        out.velocity = own("heave_velocity", velocity_time, velocity, dynamics::usual_velocity_noise);
        return out;
    }

    // ---- judging
    std::optional<WatchAlarm> judge(const WatchStep& step) {
        const auto seen = residuals->take(step);
        const auto passed = scores->take(step.time, seen, true);
        WatchAlarm alarm;
        alarm.time = step.time;
        constexpr double long_block = 2, soon = 1, not_soon = 4;  // s: short ones say as soon what it is, mostly
        const bool beyond = residuals->beyond(scores->block() > long_block ? soon : not_soon);
        const bool jumped = beyond && !jump_told;
        jump_told = beyond;
        if (jumped && !passed) {
            alarm.since = residuals->beyond_since();
            alarm.shows = "a jump of the gap, or a large force";
            return alarm;
        }
        if (!passed) {
            return {};
        }
        alarm.since = step.time - passed->since;
        alarm.shows = passed->scatter ? "more scatter than before" : "";
        for (const auto& [index, size] : passed->directions) {
            const char* side = index == 0 ? (size > 0 ? ", up" : ", down") : size > 0 ? ", with it" : ", against it";
            alarm.shows += (alarm.shows.empty() ? "" : ", or ") + std::string(words(index)) + side;
        }
        if (!passed->directions.empty() && passed->directions[0].index == 0) {
            alarm.force = passed->directions[0].size;
        }
        return alarm;
    }

    dynamics::Model model;
    WatchOptions options;
    dynamics::Conditions held;
    WatchPlant plant;
    std::vector<WatchPlant> doubted;
    std::map<std::vector<double>, Plants> plants;
    std::optional<WatchNoise> noise;
    std::optional<WatchFault> fault;
    std::optional<WatchDoubt> doubt;
    bool no_use = false;     ///< the last reading: of a sensor that stands still, or outside the tables
    bool looked = false;     ///< whether the gaps are those of the tables
    bool jump_told = false;  ///< the one that lasts
    StillReading still, still_velocity;
    std::optional<WatchAlarm> pending_alarm;  ///< told with the next reading of the gap
    std::unique_ptr<WatchResiduals> residuals;
    std::unique_ptr<WatchScores> scores;
    double next_learn, watched = 0;
    double judged_before = 0;  ///< s, by scores that others took the place of

    std::vector<double> input_time, input_value, raw_time, raw_gap;
    double largest_change = 0;  ///< N, of the input from one to the next, lately
    double own_input = 0;       ///< share of the readings that have an input of their own, lately
    std::deque<WatchStep> steps;
    std::size_t count = 0, count_in_step = 0, passed_over = 0, backwards = 0, outside = 0;
    double last_time = 0, step_begin = 0, sum_time = 0, sum_gap = 0, gaps = 0, usual_step = 0;
    std::deque<std::pair<double, double>> pending;  ///< velocities whose step is not complete
};

Watch::Watch(const dynamics::Model& model, WatchOptions options) {
    for (const double value : {options.false_alarms_per_day, options.learn, options.remember}) {
        if (!(value > 0)) {
            throw core::UsageError("range", "rates and times of a watch must be positive");
        }
    }
    parts_ = std::make_unique<Parts>(model, std::move(options));
}

Watch::~Watch() = default;

void Watch::input(double time, double force) {
    if (std::isfinite(force)) {
        parts_->add_input(time, force);
    }
}

void Watch::condition(const std::string& quantity, double value) {
    if (!std::isfinite(value)) {
        return;
    }
    // two digits: a plant for each hundredth or so, not for each reading
    const double size = value == 0 ? 1 : std::pow(10.0, std::floor(std::log10(std::abs(value))) - 1);
    const double rounded = std::round(value / size) * size;
    dynamics::Channel channel{};
    if (dynamics::find_channel(quantity, channel) && parts_->held[channel] != rounded) {
        parts_->held[channel] = rounded;
        parts_->follow_conditions();
        if (parts_->residuals) {
            parts_->residuals->set_plant(parts_->plant);
            parts_->residuals->set_doubted(parts_->doubted);
        }
    }
}

void Watch::velocity(double time, double value) {
    if (std::isfinite(value)) {
        if (parts_->pending.size() > most_waiting) {
            parts_->pending.pop_front();  // a log with velocities and no gap
        }
        if (parts_->still_velocity.take(time, value)) {
            parts_->pending_alarm = Parts::stands_still(parts_->still_velocity, time, "heave velocity", "m/s");
        }
        if (!parts_->still_velocity.still()) {
            parts_->pending.emplace_back(time, value * parts_->model.records.velocity_factor);
        }
    }
}

std::optional<WatchAlarm> Watch::gap(double time, double value) { return parts_->add_gap(time, value); }
bool Watch::learned() const { return parts_->scores != nullptr; }
const std::optional<WatchFault>& Watch::fault() const { return parts_->fault; }
const std::optional<WatchDoubt>& Watch::doubt() const { return parts_->doubt; }
std::size_t Watch::outside() const { return parts_->outside; }
std::size_t Watch::readings() const { return parts_->count; }
std::size_t Watch::passed_over() const { return parts_->passed_over; }
double Watch::noise() const {
    return parts_->noise ? std::hypot(parts_->noise->noise.gap, parts_->noise->noise.slow) : 0;
}
double Watch::correlation_time() const { return parts_->noise ? parts_->noise->correlation_time : 0; }
double Watch::block() const { return parts_->scores ? parts_->scores->block() : 0; }
double Watch::judged() const { return parts_->judged_before + (parts_->scores ? parts_->scores->judged() : 0); }
double Watch::not_judged() const { return parts_->scores ? parts_->scores->open(parts_->last_time) : 0; }
double Watch::nearest() const { return parts_->scores ? parts_->scores->nearest() : 0; }

void Watch::reset() {
    if (parts_->scores) {
        parts_->scores->reset();
        parts_->next_learn = std::numeric_limits<double>::infinity();
    }
}

void Watch::go_on_with(const dynamics::Model& model, double fitted_over) {
    Parts& p = *parts_;
    p.model = model;
    p.options.fitted_over = fitted_over;
    p.plants.clear();
    p.follow_conditions();
    if (p.scores) {
        p.restart_filter();
        p.scores->go_on(fitted_over);
        p.next_learn = std::numeric_limits<double>::infinity();
    }
}

dynamics::Measurements Watch::since(double since) const {
    std::vector<WatchStep> kept;
    for (const WatchStep& step : parts_->steps) {
        if (step.time >= since) {
            kept.push_back(step);
        }
    }
    dynamics::Measurements data;
    data.title = "watched";
    const std::size_t runs =
        kept.empty()
            ? 0
            : std::clamp<std::size_t>(static_cast<std::size_t>((kept.back().time - kept.front().time) / 10), 1, 8);
    for (std::size_t r = 0; r < runs; ++r) {
        dynamics::MeasuredRun run;
        run.name = "watched-" + std::to_string(r + 1);
        run.conditions = parts_->options.conditions;
        std::vector<double> time, gap, velocity, input;
        for (std::size_t i = r * kept.size() / runs; i < (r + 1) * kept.size() / runs; ++i) {
            time.push_back(kept[i].time);
            gap.push_back(kept[i].gap);
            velocity.push_back(kept[i].velocity);
            // the mean that led to a step is the input from the step before on
            input.push_back(i + 1 < kept.size() ? kept[i + 1].command : kept[i].command);
        }
        run.table.source = run.name;
        run.table.add_numbers("time", "s", time);
        run.table.add_numbers("gap", "m", gap);
        if (std::any_of(velocity.begin(), velocity.end(), [](double v) { return std::isfinite(v); })) {
            run.table.add_numbers("heave_velocity", "m/s", velocity);
        }
        if (!parts_->input_time.empty()) {
            run.table.add_numbers("input_force", "N", input);
        }
        data.runs.push_back(std::move(run));
    }
    return data;
}

}  // namespace underbody::discovery
