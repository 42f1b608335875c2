#include "surrogates/discovery/heave_record.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/text.h"
#include "surrogates/discovery/statistics.h"

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
        if (!column.is_text() && dynamics::find_channel(column.name, channel) && channel != Channel::time && channel != Channel::gap &&
            channel != Channel::heave_velocity && channel != Channel::input_force) {
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

/// Readings far from the middle of their neighbours become missing.
std::size_t drop_outliers(std::vector<double>& values, double sigma) {
    constexpr std::size_t half = 3;
    std::vector<std::size_t> bad;
    std::vector<double> window;
    for (std::size_t i = 0; i < values.size(); ++i) {
        window.clear();
        for (std::size_t k = i >= half ? i - half : 0; k <= std::min(i + half, values.size() - 1); ++k) {
            if (std::isfinite(values[k])) {
                window.push_back(values[k]);
            }
        }
        if (window.size() >= 4 && std::isfinite(values[i])) {
            const double spread = quantile(window, 0.8) - quantile(window, 0.2);
            if (std::abs(values[i] - median(window)) > 8 * sigma + 2 * spread) {
                bad.push_back(i);
            }
        }
    }
    for (const std::size_t i : bad) {
        values[i] = std::nan("");
    }
    return bad.size();
}

bool stuck(const std::vector<double>& values) {
    std::size_t same = 0;
    std::size_t longest = 0;
    for (std::size_t i = 1; i < values.size(); ++i) {
        same = values[i] == values[i - 1] ? same + 1 : 0;
        longest = std::max(longest, same);
    }
    return values.size() > 20 && longest > values.size() / 5;
}

void average(const std::vector<double>& time, const std::vector<double>& values, const std::vector<std::size_t>& step_of,
             std::size_t steps, std::vector<double>& mean_value, std::vector<double>& share) {
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
std::vector<std::size_t> make_steps(const std::vector<double>& time, std::vector<double>& step_time) {
    std::vector<std::size_t> step_of(time.size());
    std::vector<double> sum;
    std::vector<double> count;
    double begin = -1e300;
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (time[i] - begin >= record_step * (1 - 1e-6)) {
            if (i > 0 && time[i] - time[i - 1] > 2 * record_step) {
                const double gap = time[i] - time[i - 1];
                const auto empty = static_cast<std::size_t>(gap / record_step) - 1;
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

void check_scale(const dynamics::MeasuredRun& run, const std::vector<double>& gap, const dynamics::HeavePlant& plant) {
    const double middle = median(gap);
    const double lower = plant.terms.table_lower;
    const double upper = plant.terms.table_upper;
    if (lower < -1e299 || upper > 1e299) {
        return;
    }
    const core::Place place{run.table.source, {}, {}, {}};
    const auto inside = [&](double value) { return value > lower - 0.05 * (upper - lower) && value < upper + 0.05 * (upper - lower); };
    if (!inside(middle)) {
        for (const double factor : {1e-3, 1e3}) {
            if (inside(middle * factor)) {
                throw core::InputError("unit", "the gap is " + core::format_number(middle, 4) + " m in the middle, outside the tables (" +
                                                   core::format_number(lower, 4) + " to " + core::format_number(upper, 4) + " m)",
                                       place, std::string("a thousandth or a thousandfold fits: is the column's unit ") +
                                                  (factor < 1 ? "mm" : "m written as mm") + "?");
            }
        }
        throw core::InputError("range", "the declared model cannot run this experiment: the gap " + core::format_number(middle, 4) +
                                            " m lies outside its tables (" + core::format_number(lower, 4) + " to " +
                                            core::format_number(upper, 4) + " m)",
                               place, "give the model a table that covers the gaps that were measured");
    }
}

}  // namespace

HeaveRecords prepare_heave_records(const dynamics::Model& model, const dynamics::Measurements& data) {
    HeaveRecords result;
    std::vector<double> gap_noises;
    std::vector<double> velocity_noises;
    std::vector<double> steps;
    std::map<std::vector<double>, std::shared_ptr<const dynamics::HeavePlant>> plants;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const dynamics::MeasuredRun& run = data.runs[r];
        const std::string file = run.table.source;
        HeaveRecord record;
        record.name = run.name;
        record.run = r;
        const dynamics::Conditions held = held_conditions(run);
        std::vector<double> key(held.value.begin(), held.value.end());
        std::replace_if(key.begin(), key.end(), [](double v) { return std::isnan(v); }, -1e300);
        std::shared_ptr<const dynamics::HeavePlant>& plant = plants[key];
        if (!plant) {
            plant = std::make_shared<dynamics::HeavePlant>(model, held);
        }
        record.plant = plant;
        const std::vector<double>& time = run.table.numbers("time");
        std::vector<double> gap = run.table.numbers("gap");
        if (stuck(gap)) {
            remark(result.problems, "the gap of " + run.name + " stands still for a fifth of the run: a stuck sensor? the run is left out", file);
            continue;
        }
        check_scale(run, gap, *plant);
        const double noise = noise_from_second_differences(gap);
        const std::size_t outliers = drop_outliers(gap, std::max(noise, 1e-9));
        if (outliers > 0) {
            remark(result.problems, std::to_string(outliers) + " gap readings of " + run.name + " lie far from their neighbours: not used", file);
        }
        gap_noises.push_back(noise);
        for (std::size_t i = 1; i < time.size(); ++i) {
            steps.push_back(time[i] - time[i - 1]);
        }
        const std::vector<std::size_t> step_of = make_steps(time, record.time);
        average(time, gap, step_of, record.time.size(), record.gap, record.gap_share);
        const core::Column* velocity = run.table.find("heave_velocity");
        if (velocity != nullptr && !velocity->is_text()) {
            std::vector<double> values = velocity->numbers;
            const double own = noise_from_second_differences(values);
            drop_outliers(values, std::max(own, 1e-9));
            velocity_noises.push_back(own);
            average(time, values, step_of, record.time.size(), record.velocity, record.velocity_share);
            result.velocity_measured = true;
        }
        record.raw_time = time;
        record.raw_input = run.values("input_force");
        if (record.raw_input.empty()) {
            record.raw_input.assign(time.size(), 0);
        } else {
            result.input_recorded = true;
        }
        double last = 0;
        for (double& u : record.raw_input) {
            u = std::isfinite(u) ? u : last;
            last = u;
        }
        if (record.time.size() < 20) {
            remark(result.problems, run.name + " has fewer than 20 steps: left out", file);
            continue;
        }
        result.records.push_back(std::move(record));
    }
    if (result.records.empty()) {
        throw core::InputError("range", "no run can be used", core::Place{data.folder.string(), {}, {}, {}},
                               result.problems.empty() ? "" : result.problems.front().message);
    }
    result.raw_step = median(steps);
    result.gap_noise = median(gap_noises);
    result.velocity_noise = velocity_noises.empty() ? 0 : median(velocity_noises);
    return result;
}

}  // namespace underbody::discovery
