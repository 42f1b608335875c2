#include "postproc/loads/transient.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/text.h"

namespace underbody::postproc {

namespace {

std::optional<double> time_of(const LoadsCase& one) {
    const auto named =
        std::find_if(one.numbers.begin(), one.numbers.end(), [](const auto& entry) { return entry.first == "time"; });
    return one.loads.time               ? one.loads.time
           : named != one.numbers.end() ? std::optional<double>(named->second)
                                        : std::nullopt;
}

/// What tells runs apart: all conditions but the time; loads that a manifest states are of one time too.
std::string run_of(const LoadsCase& one) {
    std::vector<std::string> parts;
    for (const auto& [name, value] : one.numbers) {
        if (name != "time" && !is_result(name)) {
            parts.push_back(name + "=" + core::format_number(value, 9));
        }
    }
    for (const auto& [name, value] : one.texts) {
        parts.push_back(name + "=" + value);
    }
    std::sort(parts.begin(), parts.end());
    std::string text;
    for (const auto& part : parts) {
        text += part + "\n";
    }
    return text;
}

using Run = std::vector<const LoadsCase*>;

void mean_vector(Vector& target, const Run& run, const auto& member) {
    target = {};
    for (const LoadsCase* one : run) {
        const Vector& value = member(one->loads);
        for (std::size_t k = 0; k < 3; ++k) {
            target[k] += value[k] / static_cast<double>(run.size());
        }
    }
}

void mean_wrench(Wrench& target, const Run& run, const auto& member) {
    mean_vector(target.force, run, [&](const LoadsResult& loads) -> const Vector& { return member(loads).force; });
    mean_vector(target.moment, run, [&](const LoadsResult& loads) -> const Vector& { return member(loads).moment; });
}

void mean_named(NamedLoads& target, const Run& run, NamedLoads LoadsResult::*which) {
    for (double NamedLoads::*load : {&NamedLoads::lift_force, &NamedLoads::drag_force, &NamedLoads::side_force,
                                     &NamedLoads::pitch_moment, &NamedLoads::roll_moment, &NamedLoads::yaw_moment}) {
        double sum = 0;
        for (const LoadsCase* one : run) {
            sum += (one->loads.*which).*load;
        }
        target.*load = sum / static_cast<double>(run.size());
    }
}

/// Throws core::InputError where times are missing or come twice; warns of unequal steps.
void sort_by_time(Run& run, core::Problems& notes) {
    for (const LoadsCase* one : run) {
        if (!time_of(*one)) {
            throw core::InputError("missing",
                                   "the time of this file is not known, so that it has no place among the others",
                                   {one->file, {}, {}, {}}, "let the name of the file carry it: 'run-{time:s}.csv'");
        }
    }
    std::stable_sort(run.begin(), run.end(),
                     [](const LoadsCase* a, const LoadsCase* b) { return *time_of(*a) < *time_of(*b); });
    std::vector<double> times;
    std::vector<std::string> files;
    for (const LoadsCase* one : run) {
        times.push_back(*time_of(*one));
        files.push_back(one->file);
    }
    check_times(times, files, notes);
}

/// Forces and moments of the run, one history each.
std::vector<TimeHistory> histories_of(const LoadsResult& like, const Run& run) {
    std::vector<TimeHistory> histories;
    for (const auto& column : table_row(like)) {
        if (column.unit != "N" && column.unit != "N m") {
            continue;
        }
        histories.push_back({column.name, column.unit, {}});
        for (const LoadsCase* one : run) {
            const auto row = table_row(one->loads);
            histories.back().values.push_back(std::find_if(row.begin(), row.end(), [&](const LoadsColumn& c) {
                                                  return c.name == column.name;
                                              })->value);
        }
    }
    return histories;
}

void mean_coefficients(LoadsResult& loads, const Run& run) {
    if (loads.coefficients) {
        for (double LoadsCoefficients::*which :
             {&LoadsCoefficients::lift, &LoadsCoefficients::drag, &LoadsCoefficients::pitch_moment}) {
            double sum = 0;
            for (const LoadsCase* one : run) {
                sum += one->loads.coefficients ? (*one->loads.coefficients).*which : std::nan("");
            }
            (*loads.coefficients).*which = sum / static_cast<double>(run.size());
        }
    }
}

/// What is of one instant.
void leave_out_instant(LoadsCase& result) {
    result.loads.zones.clear();  // of one instant
    result.loads.stations.clear();
    result.loads.centre_of_pressure.reset();
    result.loads.time.reset();
    result.comparisons.clear();
    result.scatters.clear();
    std::erase_if(result.numbers, [](const auto& entry) { return is_result(entry.first); });  // stated of one instant
}

LoadsCase mean_of(Run run, core::Problems& notes) {
    sort_by_time(run, notes);
    LoadsCase result = *run.back();
    mean_named(result.loads.named, run, &LoadsResult::named);
    mean_named(result.loads.named_pressure, run, &LoadsResult::named_pressure);
    mean_named(result.loads.named_viscous, run, &LoadsResult::named_viscous);
    mean_wrench(result.loads.total, run, [](const LoadsResult& loads) -> const Wrench& { return loads.total; });
    mean_wrench(result.loads.pressure, run, [](const LoadsResult& loads) -> const Wrench& { return loads.pressure; });
    mean_wrench(result.loads.viscous, run, [](const LoadsResult& loads) -> const Wrench& { return loads.viscous; });
    mean_coefficients(result.loads, run);
    leave_out_instant(result);
    for (const LoadsCase* one : run) {
        result.loads.closure = std::max(result.loads.closure, one->loads.closure);
        for (const core::Problem& problem : one->loads.problems) {
            const auto& known = result.loads.problems;
            if (std::none_of(known.begin(), known.end(),
                             [&](const core::Problem& p) { return p.message == problem.message; })) {
                result.loads.problems.push_back(problem);
            }
        }
    }
    const std::vector<TimeHistory> histories = histories_of(result.loads, run);
    TimeMeans means = time_means(histories, norm(result.loads.total.force), result.loads.length, result.file);
    result.sigmas = std::move(means.sigmas);
    result.settled = std::move(means.settled);
    std::erase_if(result.numbers, [](const auto& entry) { return entry.first == "time"; });
    for (const auto& [name, value] : {std::pair{"samples", static_cast<double>(run.size())},
                                      {"first_time", *time_of(*run.front())},
                                      {"last_time", *time_of(*run.back())},
                                      {"correlation_time", means.correlation_time}}) {
        result.numbers.emplace_back(name, value);
    }
    return result;
}

}  // namespace

void check_times(const std::vector<double>& times, const std::vector<std::string>& files, core::Problems& notes) {
    double shortest = HUGE_VAL;
    double longest = 0;
    for (std::size_t i = 1; i < times.size(); ++i) {
        const double step = times[i] - times[i - 1];
        if (!(step > 0)) {
            throw core::InputError(
                "duplicate",
                "'" + files[i - 1] + "' and '" + files[i] + "' are of one time, " + core::format_number(times[i]),
                {files[i], {}, {}, {}}, "conditions have to tell runs apart");
        }
        shortest = std::min(shortest, step);
        longest = std::max(longest, step);
    }
    if (longest > 1.5 * shortest) {
        notes.push_back({core::Problem::Severity::warning,
                         "the times are " + core::format_number(shortest, 3) + " to " +
                             core::format_number(longest, 3) +
                             " apart: each counts alike in the mean, and the correlation is taken by number",
                         {files.front(), {}, {}, {}}});
    }
}

TimeMeans time_means(const std::vector<TimeHistory>& loads, double force, double length, const std::string& file) {
    TimeMeans means;
    means.settled.transient = true;
    std::size_t samples = 0;
    std::string drift;
    for (const auto& load : loads) {
        samples = load.values.size();
        const MeanInTime mean = mean_in_time(load.values);
        means.correlation_time = load.quantity == "lift_force" ? mean.correlation_time : means.correlation_time;
        if (mean.error > 0) {
            means.sigmas.emplace_back(load.quantity, mean.error);
        }
        if (samples >= shortest_history) {
            const IterationScatter scatter = iteration_scatter(load.values);
            const std::string fault = fault_of(scatter, force * (load.unit == "N m" ? length : 1), true);
            drift += fault.empty() ? "" : (drift.empty() ? "" : "; ") + load.quantity + " " + fault;
            means.settled.loads.push_back({load.quantity, file, scatter, mean.error});
        }
    }
    const bool few = samples < shortest_history;
    means.settled.verdict = few             ? SettledVerdict::unknown
                            : drift.empty() ? SettledVerdict::settled
                                            : SettledVerdict::not_settled;
    means.settled.why = "mean over " + std::to_string(samples) + " times, " +
                        core::format_number(static_cast<double>(samples) / means.correlation_time, 3) +
                        " of them independent" +
                        (few             ? ": too few to see a drift"
                         : drift.empty() ? ", no drift"
                                         : ": " + drift);
    return means;
}

std::vector<LoadsCase> means_in_time(const std::vector<LoadsCase>& cases, core::Problems& notes) {
    std::map<std::string, std::size_t> places;
    std::vector<Run> runs;
    for (const auto& one : cases) {
        const auto [place, fresh] = places.emplace(run_of(one), runs.size());
        if (fresh) {
            runs.emplace_back();
        }
        runs[place->second].push_back(&one);
    }
    std::vector<LoadsCase> result;
    if (cases.size() > 1 && runs.size() == cases.size()) {
        notes.push_back({core::Problem::Severity::warning,
                         "no two cases differ in their time alone: there is nothing to take a mean of",
                         {cases.front().file, {}, {}, {}}});
    }
    for (auto& run : runs) {
        result.push_back(run.size() > 1 ? mean_of(run, notes) : *run.front());
    }
    return result;
}

}  // namespace underbody::postproc
