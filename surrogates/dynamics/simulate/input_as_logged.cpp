#include "surrogates/dynamics/simulate/input_as_logged.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "core/text.h"
#include "surrogates/dynamics/simulate/measured_motion.h"

namespace underbody::dynamics {

namespace {

// In -2 log likelihood; set on late inputs of heave (LateInput tests), the same for coupled motions.
constexpr double reading_gain = 40;  ///< by which another reading must be likelier than the inputs as logged
constexpr double said_as_gain = 60;  ///< by which it may be worse where a gain with a name says the same

double sum_of_squares(const std::vector<double>& values) {
    return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

}  // namespace

InputAsLogged better_input(const InputSearch& search) {
    InputAsLogged best;
    double least = search.as_logged - reading_gain;
    const auto attempt = [&](const InputAsLogged& reading) {
        if (reading.early < 0 || reading.early > search.longest) {
            return;
        }
        const double own = search.cost(reading);
        if (own < least) {
            least = own;
            best = reading;
        }
    };
    for (const double seconds : {0.02, 0.04, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 2.0}) {
        attempt({seconds});
    }
    // From the best of these half-way toward its neighbours and on: they lie up to twice as far apart.
    for (double step = std::max(0.02, best.early / 4); step > 0.002 && best.early > 0; step /= 2) {
        const double middle = best.early;
        attempt({middle - step});
        attempt({middle + step});
    }
    if (best.early == 0 && search.gain) {
        least += said_as_gain;  // the same said with a name; the slip is the likelier story
    }
    for (const std::string& column : search.columns) {
        for (const double times : {1e-3, 1e3, -1.0}) {
            attempt({0, times, column});
        }
    }
    return best;
}

RecordReading with_inputs(RecordReading records, const InputAsLogged& inputs, const std::vector<std::string>& columns) {
    const auto is_force = [](const std::string& column) { return column == "input_force"; };
    if (inputs.early != 0) {
        records.input_advance += std::any_of(columns.begin(), columns.end(), is_force) ? inputs.early : 0;
        records.others_advance += std::all_of(columns.begin(), columns.end(), is_force) ? 0 : inputs.early;
    }
    if (!inputs.clock()) {
        records.scale(inputs.column, inputs.factor);
    }
    return records;
}

std::string mended_text(const InputAsLogged& reading, const std::vector<std::string>& columns) {
    return reading.clock() ? (columns.size() == 1 ? columns.front() : "the recorded inputs") + " " +
                                 core::format_number(reading.early, 2) + " s earlier"
                           : reading.column + " times " + core::format_number(reading.factor, 4);
}

std::string doubt_text(const InputAsLogged& reading, const std::vector<std::string>& columns) {
    if (!reading.clock()) {
        return "the motion fits an " + reading.column + " " + core::format_number(reading.factor, 4) +
               " times the recorded one: " +
               (reading.factor < 0 ? reading.column == "input_force" ? "its sign is turned round (up is positive)"
                                                                     : "its sign is turned round"
                                   : "its unit is wrong by a thousand");
    }
    const bool one = columns.size() == 1;
    return "the recorded input comes about " + core::format_number(reading.early, 2) +
           " s after the motion that it makes: the clocks of " + (one ? columns.front() : "the inputs") + " and " +
           (one && columns.front() == "input_force" ? "gap" : "the readings") +
           " differ, or the vehicle has a law that leads as much";
}

double independent_count(const std::vector<double>& errors) {
    const double all = sum_of_squares(errors);
    const std::size_t most = std::min<std::size_t>(errors.size() / 2, 2000);
    double sum = 1;
    for (std::size_t lag = 1; lag < most && all > 0; ++lag) {
        const double rho =
            std::inner_product(errors.begin() + static_cast<std::ptrdiff_t>(lag), errors.end(), errors.begin(), 0.0) /
            all;
        if (rho <= 0) {
            break;
        }
        sum += 2 * rho;
    }
    return static_cast<double>(errors.size()) / sum;
}

std::optional<core::Problem> doubtful_input(const Measurements& data, const std::vector<std::string>& inputs,
                                            const RecordReading& records,
                                            const std::function<std::vector<double>(const RecordReading&)>& errors) {
    constexpr double far = 1.5;   ///< noises from the readings, below which no log is doubted
    constexpr double left = 0.3;  ///< of what is more than noise, that another reading may leave
    constexpr double least = 10;  ///< independent errors: far off, all windows err alike and count as hardly one
    std::vector<std::string> columns;
    std::copy_if(inputs.begin(), inputs.end(), std::back_inserter(columns), [&](const std::string& column) {
        return std::any_of(data.runs.begin(), data.runs.end(),
                           [&](const MeasuredRun& run) { return column_moves(run, column); });
    });
    double shortest = core::no_limit;
    for (const MeasuredRun& run : data.runs) {
        const std::vector<double>& time = run.table.numbers("time");
        shortest = std::min(shortest, time.empty() ? 0 : time.back() - time.front());
    }
    const auto mean_square = [](const std::vector<double>& values) {
        return values.empty() ? core::no_limit : sum_of_squares(values) / static_cast<double>(values.size());
    };
    const std::vector<double> as_logged = columns.empty() ? std::vector<double>() : errors(records);
    const double before = mean_square(as_logged);
    if (as_logged.empty() || !std::isfinite(before) || !(before > far * far)) {
        return {};
    }
    const double count = std::max(independent_count(as_logged), least);
    double nearest = before;
    InputSearch search{.columns = columns,
                       .as_logged = count * std::log(before),
                       .gain = false,
                       .longest = std::min(2.0, shortest / 4),
                       .cost = {}};
    search.cost = [&](const InputAsLogged& reading) {
        const double own = mean_square(errors(with_inputs(records, reading, columns)));
        nearest = std::isfinite(own) ? std::min(nearest, own) : nearest;
        return std::isfinite(own) ? count * std::log(own) : core::no_limit;
    };
    const InputAsLogged found = better_input(search);
    if (found.as_logged() || nearest - 1 > left * (before - 1)) {
        return {};
    }
    return core::Problem{core::Problem::Severity::warning,
                         doubt_text(found, columns) +
                             "; predicted as logged (`underbody discover` asks further and writes it to [records] of "
                             "the model)",
                         {data.folder.string(), {}, {}, {}}};
}

}  // namespace underbody::dynamics
