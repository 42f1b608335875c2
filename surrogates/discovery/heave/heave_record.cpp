#include "surrogates/discovery/heave/heave_record.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>

#include "core/normal.h"
#include "core/text.h"
#include "surrogates/discovery/heave/heave_filter.h"
#include "surrogates/discovery/statistics.h"
#include "surrogates/dynamics/model/force_sources.h"
#include "surrogates/dynamics/model/repeated_runs.h"
#include "surrogates/dynamics/model/taken_as_zero.h"
#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/doubtful_clock.h"
#include "surrogates/dynamics/simulate/predict.h"
#include "surrogates/dynamics/simulate/read_records.h"
#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::discovery {

using dynamics::Channel;

namespace {

void remark(core::Problems& problems, const std::string& text, const std::string& file) {
    problems.push_back({core::Problem::Severity::warning, text, core::Place{file, {}, {}, {}}});
}

dynamics::Conditions held_conditions(const dynamics::MeasuredRun& run) {
    dynamics::Conditions held;
    for (const auto& [name, value] : run.conditions) {
        Channel channel{};
        if (dynamics::find_channel(name, channel)) {
            held[channel] = value;
        }
    }
    // a channel that was recorded but did not change is a condition; one that changed is held at its mean
    for (const core::Column& column : run.table.columns()) {
        Channel channel{};
        if (!column.is_text() && dynamics::find_channel(column.name, channel) && channel != Channel::time &&
            channel != Channel::gap && channel != Channel::heave_velocity && channel != Channel::input_force) {
            double sum = 0;
            double count = 0;
            for (const double value : column.numbers) {
                if (std::isfinite(value)) {
                    sum += value;
                    count += 1;
                }
            }
            if (count > 0) {
                held[channel] = sum / count;
            }
        }
    }
    return held;
}

/// The input at its own samples, and at the end of the record; rows of other sensors between them say nothing of it.
void read_input(const dynamics::MeasuredRun& run, const dynamics::RecordReading& records, HeaveRecord& record) {
    const std::vector<double>& time = run.table.numbers("time");
    const std::vector<double> written = run.values("input_force");
    const std::vector<double> values = dynamics::as_read(run, "input_force", records);
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (values.empty() || std::isfinite(written[i]) || i + 1 == time.size()) {
            record.raw_time.push_back(time[i] - records.input_advance);
            record.raw_input.push_back(values.empty() || !std::isfinite(values[i]) ? 0 : values[i]);
        }
    }
}

bool stuck(const std::vector<double>& values) {
    std::size_t same = 0;
    std::size_t longest = 0;
    std::size_t readings = 0;
    double last = std::nan("");
    for (const double value : values) {
        if (std::isfinite(value)) {  // rows of other sensors stand between the readings
            same = value == last ? same + 1 : 0;
            longest = std::max(longest, same);
            last = value;
            ++readings;
        }
    }
    return readings > 20 && longest > readings / 5;
}

void average(const std::vector<double>& time, const std::vector<double>& values,
             const std::vector<std::size_t>& step_of, std::size_t steps, std::vector<double>& mean_value,
             std::vector<double>& share) {
    mean_value.assign(steps, 0);
    std::vector<double> count(steps, 0);
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (std::isfinite(values[i])) {
            mean_value[step_of[i]] += values[i];
            count[step_of[i]] += 1;
        }
    }
    share.assign(steps, 1);
    for (std::size_t k = 0; k < steps; ++k) {
        mean_value[k] = count[k] > 0 ? mean_value[k] / count[k] : std::nan("");
        share[k] = count[k] > 0 ? 1 / std::sqrt(count[k]) : 1;
    }
}

/// Groups readings into steps; a gap in time gets empty steps. Fills times and returns each reading's step.
std::vector<std::size_t> make_steps(const std::vector<double>& time, double step, std::vector<double>& step_time) {
    std::vector<std::size_t> step_of(time.size());
    std::vector<double> sum;
    std::vector<double> count;
    double begin = -1e300;
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (time[i] - begin >= step * (1 - 1e-6)) {
            if (i > 0 && time[i] - time[i - 1] > 2 * step) {
                const double gap = time[i] - time[i - 1];
                const auto empty = static_cast<std::size_t>(gap / step) - 1;
                for (std::size_t k = 1; k <= empty; ++k) {
                    sum.push_back(time[i - 1] + gap * static_cast<double>(k) / static_cast<double>(empty + 1));
                    count.push_back(1);
                }
            }
            begin = time[i];
            sum.push_back(0);
            count.push_back(0);
        }
        step_of[i] = sum.size() - 1;
        sum.back() += time[i];
        count.back() += 1;
    }
    step_time.resize(sum.size());
    for (std::size_t k = 0; k < sum.size(); ++k) {
        step_time[k] = sum[k] / count[k];
    }
    return step_of;
}

/// Steps are made of the readings of the gap and lie at their mean time, and where it is silent for longer of those of
/// the velocity; rows of other sensors belong to the nearest.
std::vector<std::size_t> steps_of_rows(const std::vector<double>& time, const std::vector<double>& gap,
                                       const std::vector<double>& velocity, double step,
                                       std::vector<double>& step_time) {
    std::vector<double> until_next(time.size(), 1e300), own;
    for (std::size_t i = time.size(); i-- > 0;) {
        until_next[i] = std::isfinite(gap[i]) ? 0
                        : i + 1 < time.size() ? until_next[i + 1] + time[i + 1] - time[i]
                                              : 1e300;
    }
    double last = -1e300;
    for (std::size_t i = 0; i < time.size(); ++i) {
        last = std::isfinite(gap[i]) ? time[i] : last;
        const bool silent = time[i] - last > step && until_next[i] > step;
        if (time[i] == last || (silent && i < velocity.size() && std::isfinite(velocity[i]))) {
            own.push_back(time[i]);
        }
    }
    if (own.size() == time.size()) {
        return make_steps(time, step, step_time);
    }
    make_steps(own, step, step_time);
    std::vector<std::size_t> step_of(time.size());
    for (std::size_t i = 0, k = 0; i < time.size(); ++i) {
        while (k + 1 < step_time.size() && time[i] > 0.5 * (step_time[k] + step_time[k + 1])) {
            ++k;
        }
        step_of[i] = k;
    }
    return step_of;
}

/// Short and fast runs (half a second at 1.5 kHz) are not averaged away: a hundred steps each, where they have as many
/// readings.
double step_for(const dynamics::Measurements& data) {
    std::vector<double> lasted;
    for (const dynamics::MeasuredRun& run : data.runs) {
        const std::vector<double>& time = run.table.numbers("time");
        lasted.push_back(time.back() - time.front());
    }
    return lasted.empty() ? record_step : std::min(record_step, median(lasted) / 100);
}

/// Means of coloured noise scatter as much as single readings do, and are smoother than any noise of first order: they
/// would pass for motion.
bool means_keep_scatter(const HeaveRecord& record, double noise) {
    std::vector<double> shares;
    for (std::size_t k = 0; k < record.gap.size(); ++k) {
        if (std::isfinite(record.gap[k])) {
            shares.push_back(record.gap_share[k]);
        }
    }
    const double share = shares.empty() ? 1 : median(shares);
    return share < 0.8 && dynamics::sensor_noise(record.time, record.gap) > 1.5 * share * noise;
}

std::vector<double> first_of_steps(const std::vector<double>& values, const std::vector<std::size_t>& step_of,
                                   std::size_t steps) {
    std::vector<double> first(steps, std::nan(""));
    for (std::size_t i = step_of.size(); i-- > 0;) {
        first[step_of[i]] = values[i];
    }
    return first;
}

/// One reading a step, at its own time, in the place of the mean.
void keep_first_of_steps(const std::vector<double>& time, const std::vector<double>& gap,
                         const std::vector<std::size_t>& step_of, HeaveRecord& record) {
    for (std::size_t i = step_of.size(); i-- > 0;) {
        record.time[step_of[i]] = time[i];
    }
    record.gap = first_of_steps(gap, step_of, record.time.size());
    record.gap_share.assign(record.time.size(), 1);
}

dynamics::GapRange tables_of(const dynamics::HeavePlant& plant) {
    return {plant.terms.table_lower, plant.terms.table_upper};
}

/// What gaps that lie outside the tables would be inside as: the question that the whole data set is asked.
struct Misread {
    const char* text = "";  ///< ": a thousandth would fit"
    const char* hint = "";
};

double share_outside(const std::vector<double>& gaps, double factor, double lower, double upper) {
    const auto out =
        std::count_if(gaps.begin(), gaps.end(), [&](double x) { return factor * x < lower || factor * x > upper; });
    return static_cast<double>(out) / static_cast<double>(gaps.size());
}

/// Only what fits as it stands, and far from fitting as it was read: a gap of 1.69 m beside tables to 1.6 m is none in
/// mm, and one below the ground none in m.
Misread misread(const std::vector<double>& gaps, double lower, double upper) {
    constexpr double most = 0.1, far = 3;
    const double middle = median(gaps);
    const auto fits = [&](double factor) { return share_outside(gaps, factor, lower, upper) < most; };
    if (middle > far * upper && fits(1e-3)) {
        return {": a thousandth would fit", "is the column's unit mm, and was it read in m?"};
    }
    if (middle > 0 && far * middle < lower && fits(1e3)) {
        return {": a thousandfold would fit", "is the column's unit m, and was it read in mm?"};
    }
    if (middle < 0 && fits(-1)) {
        return {": with the other sign it would fit",
                "gap counts upward from the ground; a depth or a z down is turned by sign = -1 in [log.channel.gap]"};
    }
    return {};
}

/// Why the declared model cannot run this run; empty where it can.
std::string cannot_run(const std::vector<double>& gap, const dynamics::HeavePlant& plant, std::string& hint) {
    const double lower = plant.terms.table_lower;
    const double upper = plant.terms.table_upper;
    if (lower < -1e299 || upper > 1e299) {
        return "";
    }
    std::vector<double> finite;
    std::copy_if(gap.begin(), gap.end(), std::back_inserter(finite), [](double x) { return std::isfinite(x); });
    const double middle = median(finite), margin = 0.05 * (upper - lower);
    const double outside = share_outside(finite, 1, lower, upper);
    const bool beyond = !(middle > lower - margin && middle < upper + margin);
    if (!beyond && !(outside > 0.5)) {
        return "";
    }
    const Misread likely = misread(finite, lower, upper);
    hint = likely.hint;
    const std::string where = dynamics::range_text(tables_of(plant));
    return (beyond ? "its gap, " + core::format_number(middle, 4) + " m in the middle, lies"
                   : "it spends " + core::format_number(100 * outside, 3) + " % of its time") +
           " outside the tables of the declared model " + where + likely.text;
}

/// Leaves the longest stretch inside the tables: a body that came back from beyond them would be given an effect for
/// what the tables lack. What it is told of that; empty where all of it lies inside.
std::string keep_inside_tables(HeaveRecord& record, double noise) {
    const dynamics::InsideTables inside = dynamics::longest_inside(record.gap, tables_of(*record.plant), noise);
    if (inside.outside == 0) {
        return "";
    }
    for (std::vector<double>* values :
         {&record.time, &record.gap, &record.gap_share, &record.velocity, &record.velocity_share, &record.lift_scale}) {
        if (!values->empty()) {  // not measured, or no condition changes
            *values = {values->begin() + static_cast<std::ptrdiff_t>(inside.first),
                       values->begin() + static_cast<std::ptrdiff_t>(inside.last)};
        }
    }
    return dynamics::unused_text(record.name, inside, tables_of(*record.plant), record.time);
}

/// What the measured velocity says beside the gap's own changes over a second each; both NaN without enough motion.
struct VelocityScale {
    double slope = std::nan("");  ///< regression: a foreign channel gives about 0, a turned one -1
    double ratio = std::nan("");  ///< root of the mean squares' ratio: a delay of one sensor leaves it at 1
};

VelocityScale velocity_scale(const HeaveRecord& record, double gap_noise) {
    double cross = 0;
    double by_velocity = 0;
    double by_gap = 0;
    constexpr double window = 1;  // s: short beside a run, long enough that the noise of the gap hardly counts
    for (std::size_t begin = 0, end = 1; end < record.time.size(); ++end) {
        const double lasted = record.time[end] - record.time[begin];
        if (lasted < window) {
            continue;
        }
        double sum = 0;
        double weights = 0;
        for (std::size_t i = begin; i <= end; ++i) {
            if (std::isfinite(record.velocity[i])) {
                const double weight = i == begin || i == end ? 0.5 : 1;
                sum += weight * record.velocity[i];
                weights += weight;
            }
        }
        const double change = record.gap[end] - record.gap[begin];
        if (std::isfinite(change) && weights > 0.5 * static_cast<double>(end - begin)) {
            const double path = lasted * sum / weights;
            cross += change * path;
            by_velocity += path * path;
            by_gap += change * change - 2 * gap_noise * gap_noise;
        }
        begin = end;
    }
    return by_gap > 0 ? VelocityScale{cross / by_gap, std::sqrt(by_velocity / by_gap)} : VelocityScale{};
}

/// A run that can be used, and what it says of the whole set: nothing of one that is left out counts there.
struct UsedRun {
    HeaveRecord record;
    double gap_noise = 0, velocity_noise = std::nan("");  ///< NaN: not measured
    std::vector<double> steps;                            ///< s, between readings
    bool input_recorded = false;
    core::Problems said;
};

/// Of measurements that were read none is left; those made in memory may have some.
void drop_copies(std::vector<UsedRun>& used, const dynamics::Measurements& data, core::Problems& problems) {
    for (std::size_t a = 0; a < used.size(); ++a) {
        for (std::size_t b = used.size(); b-- > a + 1;) {
            const dynamics::MeasuredRun &first = data.runs[used[a].record.run], &later = data.runs[used[b].record.run];
            if (dynamics::same_readings(first, later)) {
                problems.push_back(dynamics::used_once(later, first));
                used.erase(used.begin() + static_cast<std::ptrdiff_t>(b));
            }
        }
    }
}

void put_together(std::vector<UsedRun> used, HeaveRecords& result) {
    std::vector<double> gap_noises, velocity_noises, steps;
    for (UsedRun& one : used) {
        gap_noises.push_back(one.gap_noise);
        if (std::isfinite(one.velocity_noise)) {
            velocity_noises.push_back(one.velocity_noise);
        }
        steps.insert(steps.end(), one.steps.begin(), one.steps.end());
        result.input_recorded = result.input_recorded || one.input_recorded;
        result.problems.insert(result.problems.end(), one.said.begin(), one.said.end());
        result.records.push_back(std::move(one.record));
    }
    result.velocity_measured = !velocity_noises.empty();
    result.raw_step = median(steps);
    result.gap_noise = median(gap_noises);
    result.velocity_noise = velocity_noises.empty() ? 0 : median(velocity_noises);
}

/// Conditions that changed within a run: over each step what the lift of the one table source is, over what it is with
/// the condition held at its mean. A channel that cannot be followed so is named in `held_at_mean`.
std::vector<double> lift_over_steps(const dynamics::Model& model, const dynamics::MeasuredRun& run,
                                    const dynamics::Conditions& held, const std::vector<std::size_t>& step_of,
                                    std::size_t steps, std::string& held_at_mean) {
    std::vector<double> scale;
    std::size_t sources = 0;
    for (const dynamics::ForceSource& source : model.forces) {
        sources += source.quantity == "lift_force" ? 1 : 0;
    }
    for (const core::Column& column : run.table.columns()) {
        Channel channel{};
        if (column.is_text() || !dynamics::find_channel(column.name, channel) || channel == Channel::time ||
            channel == Channel::gap || channel == Channel::heave_velocity || channel == Channel::input_force) {
            continue;
        }
        std::vector<double> finite;
        std::copy_if(column.numbers.begin(), column.numbers.end(), std::back_inserter(finite),
                     [](double x) { return std::isfinite(x); });
        const double middle = held.get(channel, 0);
        if (finite.empty() || robust_deviation(finite) < 0.01 * std::abs(middle)) {
            continue;
        }
        for (const dynamics::ForceSource& source : model.forces) {
            const bool axis = std::find(source.axes.begin(), source.axes.end(), channel) != source.axes.end();
            const auto own = std::find_if(source.scales.begin(), source.scales.end(),
                                          [&](const auto& s) { return s.channel == channel; });
            if (source.quantity != "lift_force" || (!axis && own == source.scales.end())) {
                continue;
            }
            const auto strength = [&](double x) { return dynamics::scale_factor(*own, x); };
            if (axis || sources != 1 || !(strength(middle) > 0)) {
                held_at_mean = column.name;
                continue;
            }
            std::vector<double> sum(steps, 0), count(steps, 0);
            for (std::size_t i = 0; i < step_of.size(); ++i) {
                if (std::isfinite(column.numbers[i])) {
                    sum[step_of[i]] += strength(column.numbers[i]);
                    count[step_of[i]] += 1;
                }
            }
            scale.resize(steps, 1);
            double last = 1;
            for (std::size_t k = 0; k < steps; ++k) {
                last = count[k] > 0 ? sum[k] / count[k] / strength(middle) : last;
                scale[k] *= last;
            }
        }
    }
    return scale;
}

/// A velocity that does not belong to its gap is left out, everywhere: the filter would trust it.
void check_velocities(HeaveRecords& result, const dynamics::Measurements& data) {
    if (!result.velocity_measured) {
        return;
    }
    std::vector<double> slopes;
    std::vector<double> ratios;
    for (const HeaveRecord& record : result.records) {
        const VelocityScale scale =
            record.velocity.empty() ? VelocityScale{} : velocity_scale(record, result.gap_noise);
        if (std::isfinite(scale.slope)) {
            slopes.push_back(scale.slope);
            ratios.push_back(scale.ratio);
        }
    }
    const double slope = slopes.empty() ? 1 : median(slopes);
    const double ratio = ratios.empty() ? 1 : median(ratios);
    std::vector<double> apart;
    for (const double one : ratios) {
        apart.push_back(std::abs(one - ratio));
    }
    // five standard errors of the runs' median, and never for a few hundredths; one or two runs show no scatter
    const double tolerance = ratios.size() < 3
                                 ? 0.25
                                 : std::max(0.05, 5 * 1.25 * core::sigma_of_median_distance * median(apart) /
                                                      std::sqrt(static_cast<double>(ratios.size())));
    std::string text;
    if (slope < -0.5 && slope > -2) {
        text = "heave_velocity has the opposite sign of the gap's changes (positive is up: it is turned round)";
    } else if (std::abs(slope) < 0.5 || std::abs(slope) > 2) {
        const bool thousand = (slope > 500 && slope < 2000) || (slope > 5e-4 && slope < 2e-3);
        text = "heave_velocity is " + core::format_number(slope, 3) + " times what the gap's changes say" +
               (thousand ? ": a unit wrong by a thousand?" : ": another channel, another run, or swapped columns?") +
               " It is not used";
    } else if (std::abs(ratio - 1) > tolerance) {
        text = "heave_velocity is " + core::format_number(ratio, 3) +
               " times what the gap's changes say: is the scale of one of the two wrong? It is not used";
    }
    if (text.empty()) {
        return;
    }
    remark(result.problems, text, data.folder.string());
    const bool turn = slope < -0.5 && slope > -2;
    for (HeaveRecord& record : result.records) {
        if (turn) {
            for (double& value : record.velocity) {
                value = -value;
            }
        } else {
            record.velocity.clear();
            record.velocity_share.clear();
        }
    }
    result.velocity_measured = turn;
    result.velocity_turned = turn;
}

/// What is learned while the runs are read, one after the other.
struct Reading {
    const dynamics::Model& model;
    const dynamics::Measurements& data;
    HeaveRecords& result;
    std::map<std::vector<double>, std::shared_ptr<const dynamics::HeavePlant>> plants{};  ///< by what a run holds
    std::string unit{};       ///< hint where a gap looks to be in another one
    std::size_t still = 0;    ///< runs whose gap stands still
    std::size_t swapped = 0;  ///< runs whose gap and input look exchanged
};

std::shared_ptr<const dynamics::HeavePlant> plant_of(Reading& reading, const dynamics::Conditions& held) {
    std::vector<double> key(held.value.begin(), held.value.end());
    std::replace_if(
        key.begin(), key.end(), [](double v) { return std::isnan(v); }, -1e300);
    std::shared_ptr<const dynamics::HeavePlant>& plant = reading.plants[key];
    if (!plant) {
        plant = std::make_shared<dynamics::HeavePlant>(reading.model, held);
    }
    return plant;
}

/// The gap without the readings that are none, with its noise in `used`; false where the run is left out, and said.
bool read_gap(Reading& reading, const dynamics::MeasuredRun& run, std::vector<double>& gap, UsedRun& used) {
    const std::string file = run.table.source;
    core::Problems& problems = reading.result.problems;
    const std::vector<double>& time = run.table.numbers("time");
    const std::size_t saturated = dynamics::drop_saturated(time, gap);
    const double noise = dynamics::sensor_noise(time, gap);  // a reading at the end of the range has none
    if (saturated > 0) {
        remark(used.said, dynamics::saturated_text(run.name, saturated), file);
    }
    if (stuck(gap) || 2 * saturated > gap.size()) {
        remark(problems,
               "the gap of " + run.name + " stands still for a fifth of the run: a stuck sensor? the run is left out",
               file);
        ++reading.still;
        return false;
    }
    const std::string reason = cannot_run(gap, *used.record.plant, reading.unit);
    if (!reason.empty()) {
        remark(problems, run.name + " is left out: " + reason, file);
        return false;
    }
    const std::vector<double> pushed = run.values("input_force");
    const double input_noise = pushed.size() == gap.size() ? dynamics::sensor_noise(time, pushed) : 0;
    const std::optional<double> declared = reading.data.declared_noise("gap");
    if (declared && noise < 0.05 * *declared && input_noise > 0.5 * *declared && input_noise < 2 * *declared) {
        remark(
            problems,
            run.name +
                " is left out: gap has no noise and input_force that of the gap sensor; the two columns look swapped",
            file);
        ++reading.swapped;
        return false;
    }
    const std::size_t outliers = dynamics::drop_outliers(gap, std::max(noise, 1e-9));
    if (outliers > 0) {
        remark(used.said, dynamics::outliers_text(run.name, outliers), file);
    }
    if (!std::isfinite(noise)) {
        remark(problems, run.name + " is left out: it has hardly any gap readings", file);
        return false;
    }
    used.gap_noise = noise;
    return true;
}

std::vector<double> steps_between(const std::vector<double>& time, const std::vector<double>& gap) {
    std::vector<double> steps;
    for (std::size_t i = 0, before = time.size(); i < time.size(); ++i) {
        if (std::isfinite(gap[i])) {
            if (before < i) {
                steps.push_back(time[i] - time[before]);
            }
            before = i;
        }
    }
    return steps;
}

/// Where it is measured and moves. `coloured`: the first reading of each step stands for it.
void read_velocity(const Reading& reading, const dynamics::MeasuredRun& run, const std::vector<std::size_t>& step_of,
                   bool coloured, UsedRun& used) {
    const core::Column* velocity = run.table.find("heave_velocity");
    if (velocity == nullptr || velocity->is_text() || !dynamics::empty_text(run, "heave_velocity").empty()) {
        return;
    }
    HeaveRecord& record = used.record;
    const std::vector<double>& time = run.table.numbers("time");
    std::vector<double> values = dynamics::as_read(run, "heave_velocity", reading.model.records);
    const double own = dynamics::sensor_noise(time, values);
    if (stuck(values) || !std::isfinite(own)) {
        remark(used.said,
               "heave_velocity of " + run.name + " stands still for a fifth of the run or is missing: it is not used",
               run.table.source);
        return;
    }
    dynamics::drop_outliers(values, std::max(own, 1e-9));
    used.velocity_noise = own;
    average(time, values, step_of, record.time.size(), record.velocity, record.velocity_share);
    if (coloured) {
        record.velocity = first_of_steps(values, step_of, record.time.size());
        record.velocity_share.assign(record.time.size(), 1);
    }
}

/// One run on the steps of all; nothing where it is left out, which is said.
std::optional<UsedRun> used_run(Reading& reading, std::size_t index) {
    const dynamics::MeasuredRun& run = reading.data.runs[index];
    const std::string file = run.table.source;
    if (const std::string none = dynamics::empty_text(run, "gap"); !none.empty()) {
        remark(reading.result.problems, none + ": it is left out", file);
        return {};
    }
    UsedRun used;
    HeaveRecord& record = used.record;
    record.name = run.name;
    record.run = index;
    const dynamics::Conditions held = held_conditions(run);
    record.plant = plant_of(reading, held);
    const std::vector<double>& time = run.table.numbers("time");
    std::vector<double> gap = run.table.numbers("gap");
    if (!read_gap(reading, run, gap, used)) {
        return {};
    }
    used.steps = steps_between(time, gap);
    const std::vector<std::size_t> step_of =
        steps_of_rows(time, run.values("gap"), run.values("heave_velocity"), reading.result.step, record.time);
    average(time, gap, step_of, record.time.size(), record.gap, record.gap_share);
    const bool coloured = means_keep_scatter(record, used.gap_noise);
    if (coloured) {
        keep_first_of_steps(time, gap, step_of, record);
    }
    std::string held_at_mean;
    record.lift_scale = lift_over_steps(reading.model, run, held, step_of, record.time.size(), held_at_mean);
    if (!held_at_mean.empty()) {
        remark(used.said,
               held_at_mean + " changes within " + run.name +
                   " and moves a table or one of several sources of lift: held at its mean",
               file);
    }
    read_velocity(reading, run, step_of, coloured, used);
    if (const std::string outside = keep_inside_tables(record, used.gap_noise); !outside.empty()) {
        remark(used.said, outside, file);
    }
    read_input(run, reading.model.records, record);
    const std::vector<double> input = run.values("input_force");
    used.input_recorded = std::any_of(input.begin(), input.end(), [](double value) { return std::isfinite(value); });
    if (record.time.size() < 20) {
        remark(reading.result.problems, run.name + " has fewer than 20 steps: left out", file);
        return {};
    }
    prepare_input(record);
    return used;
}

/// Throws where what was left out says that the data are not what they are called.
void check_left_out(const Reading& reading, bool none_used) {
    const dynamics::Measurements& data = reading.data;
    if (reading.swapped > 0 && 2 * reading.swapped >= data.runs.size()) {
        // what looks right in the others is then chance
        throw core::InputError("swapped",
                               "gap and input_force look swapped in " + std::to_string(reading.swapped) + " of " +
                                   std::to_string(data.runs.size()) +
                                   " runs: gap has no noise, and input_force has that of the gap sensor",
                               core::Place{data.folder.string(), {}, {}, {}},
                               "exchange the two names in the header lines");
    }
    if (none_used) {
        const core::Problems& problems = reading.result.problems;
        const std::string first = problems.empty() ? "" : problems.front().message;
        throw core::InputError(reading.unit.empty() ? "range" : "unit",
                               "no run can be used" + (first.empty() ? std::string() : ": " + first),
                               core::Place{data.folder.string(), {}, {}, {}},
                               !reading.unit.empty() ? reading.unit
                               : reading.still == data.runs.size()
                                   ? "look at the gap sensor and its cable; a saturated one needs another range"
                                   : "give the model tables that cover the gaps that were measured, or runs within "
                                     "them; `underbody predict` shows the model beside each run");
    }
}

}  // namespace

HeaveRecords prepare_heave_records(const dynamics::Model& model, const dynamics::Measurements& data) {
    if (const auto doubt = dynamics::doubtful_clock(model, data)) {  // minutes of work over what is no motion
        throw core::InputError("unit", doubt->message, doubt->place, "mend the unit of time in the header line");
    }
    HeaveRecords result;
    result.step = step_for(data);
    Reading reading{model, data, result};
    std::vector<UsedRun> all_used;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        if (std::optional<UsedRun> used = used_run(reading, r)) {
            all_used.push_back(std::move(*used));
        }
    }
    check_left_out(reading, all_used.empty());
    const core::Problems unsaid = dynamics::input_taken_as_zero(model, data);
    result.problems.insert(result.problems.end(), unsaid.begin(), unsaid.end());
    drop_copies(all_used, data, result.problems);
    put_together(std::move(all_used), result);
    check_velocities(result, data);
    return result;
}

}  // namespace underbody::discovery
