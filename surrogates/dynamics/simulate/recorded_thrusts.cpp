#include "surrogates/dynamics/simulate/recorded_thrusts.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "surrogates/dynamics/simulate/clean_readings.h"
#include "surrogates/dynamics/simulate/read_records.h"

namespace underbody::dynamics {

namespace {

constexpr const char* of_thrust = "thrust_";

}  // namespace

std::string RecordedThrusts::column(const Jet& jet) { return of_thrust + jet.name; }

std::vector<std::string> RecordedThrusts::columns(const Model& model) {
    std::vector<std::string> columns;
    for (const Jet& jet : model.jets) {
        columns.push_back(column(jet));
    }
    return columns;
}

RecordedThrusts::RecordedThrusts(const Model& model, const MeasuredRun& run, const RecordReading& records)
    : acting_(model.jets.size(), 0.0), linear_(records.input_between == RecordReading::Between::linear) {
    const core::Place whole{run.table.source, {}, {}, {}};
    std::vector<std::string> given, of_jets;
    for (const core::Column& column : run.table.columns()) {
        if (column.name.starts_with(of_thrust)) {
            given.push_back(column.name);
        }
    }
    for (const Jet& jet : model.jets) {
        of_jets.push_back(column(jet));
        const core::Column* column = run.table.find(of_jets.back());
        if (column == nullptr) {
            throw core::InputError("missing", "run " + run.name + " lacks the thrust of the jet '" + jet.name + "'",
                                   whole,
                                   "a column " + of_jets.back() + " [N], the thrust as it acted; 0 where it is off" +
                                       (given.empty() ? "" : "; " + core::did_you_mean(of_jets.back(), given)));
        }
        if (column->is_text() || column->unit != "N") {
            throw core::InputError(
                "unit",
                "the thrust " + column->name + " is in " + (column->is_text() ? "words" : "'" + column->unit + "'"),
                run.table.place(0, column->name), "a force: " + column->name + " [N]");
        }
        thrust_.emplace_back();
        const std::vector<double>& time = run.table.numbers("time");
        const auto first = std::find_if(column->numbers.begin(), column->numbers.end(),
                                        [](double value) { return std::isfinite(value); });
        if (!as_acted(run, column->name, records, thrust_.back())) {
            throw core::InputError("missing", "run " + run.name + ": the column " + column->name + " has no value",
                                   run.table.place(0, column->name), "the thrust as it acted; 0 where the jet is off");
        }
        constexpr double soon = 0.1;  // s
        if (const double begins = time[static_cast<std::size_t>(first - column->numbers.begin())];
            begins - time.front() > soon) {
            remarks_.push_back("run " + run.name + ": " + column->name + " has no value before " +
                               core::format_number(begins, 4) + " s: its first one is taken until then");
        }
        double most = 0;
        for (const double value : thrust_.back()) {
            most = value > 1.01 * jet.maximum + 1e-9 || value < 1.01 * jet.minimum - 1e-9
                       ? std::max(most, std::abs(value))
                       : most;
        }
        if (most > 0) {
            remarks_.push_back("run " + run.name + ": " + column->name + " reaches " + core::format_number(most, 3) +
                               " N, while the jet is declared for " + core::format_number(jet.minimum, 3) + " to " +
                               core::format_number(jet.maximum, 3) +
                               " N: its unit, or the jet's minimum and maximum in the model, are others");
        }
    }
    for (const std::string& name : given) {
        if (std::find(of_jets.begin(), of_jets.end(), name) == of_jets.end()) {
            remarks_.push_back("run " + run.name + ": the column " + name + " is not used: the model has no jet '" +
                               name.substr(std::string(of_thrust).size()) + "'");
        }
    }
}

std::span<const double> RecordedThrusts::at(std::size_t k, double part) {
    for (std::size_t j = 0; j < acting_.size(); ++j) {
        acting_[j] = thrust_[j][k] + (linear_ && part > 0 ? part * (thrust_[j][k + 1] - thrust_[j][k]) : 0);
    }
    return acting_;
}

InputSignals inputs_of_body(const MeasuredRun& run, const RecordReading& records) {
    InputSignals signals = signals_of(run, records);
    std::erase_if(signals.signals, [](const InputSignals::Signal& signal) {
        return signal.channel == Channel::speed || signal.channel == Channel::gap || signal.channel == Channel::pitch ||
               signal.channel == Channel::heave_velocity || signal.channel == Channel::pitch_rate;
    });
    return signals;
}

}  // namespace underbody::dynamics
