#include "cases/time_means.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/counted.h"
#include "core/text.h"
#include "postproc/loads/deviation.h"
#include "postproc/loads/transient.h"

namespace underbody::cases {

namespace {

/// What tells runs apart: all conditions but the time.
std::string run_of(const Conditions& conditions) {
    std::map<std::string, std::string> parts;
    for (const auto& [name, value] : conditions.numbers) {
        parts[name] = name == "time" ? "" : core::format_number(value, 9);
    }
    for (const auto& [name, value] : conditions.texts) {
        parts[name] = value;
    }
    std::string text;
    for (const auto& [name, value] : parts) {
        text += name + "=" + value + "\n";
    }
    return text;
}

using Run = std::vector<CaseLoads*>;

CaseLoads mean_of(const Study& study, Run run) {
    const auto time = [&](const CaseLoads* one) { return *study.cases[one->entry].conditions.number("time"); };
    std::stable_sort(run.begin(), run.end(), [&](const CaseLoads* a, const CaseLoads* b) { return time(a) < time(b); });
    std::vector<double> times;
    std::vector<std::string> files;
    for (const auto* one : run) {
        times.push_back(time(one));
        files.push_back(one->file);
    }
    CaseLoads mean = *run.front();
    try {
        postproc::check_times(times, files, mean.warnings);
    } catch (const core::InputError& error) {
        mean.state = StepState::failed;
        mean.error = error.message();
        mean.values.clear();
        return mean;
    }
    std::erase_if(mean.values, [](const LoadValue& value) { return value.name.ends_with("_sigma"); });
    std::vector<postproc::TimeHistory> histories;
    for (auto& value : mean.values) {
        postproc::TimeHistory history{value.name, value.unit, {}};
        double sum = 0;
        for (const auto* one : run) {
            history.values.push_back(one->value(value.name));
            sum += history.values.back();
        }
        value.value = sum / static_cast<double>(run.size());
        if ((value.unit == "N" || value.unit == "N m") && std::isfinite(sum)) {
            histories.push_back(std::move(history));
        }
    }
    const double length = mean.value("reference_length");
    const auto means =
        postproc::time_means(histories, postproc::resultant([&](const char* name) { return mean.value(name); }),
                             std::isfinite(length) ? length : 1, mean.file);
    for (const auto& [quantity, sigma] : means.sigmas) {
        const auto load = std::find_if(mean.values.begin(), mean.values.end(),
                                       [&](const LoadValue& value) { return value.name == quantity; });
        const std::string unit = load->unit;
        mean.values.push_back({quantity + "_sigma", unit, sigma});
    }
    mean.settled = to_string(means.settled.verdict);
    mean.settled_why = means.settled.why;
    return mean;
}

}  // namespace

std::vector<CaseLoads> with_means_in_time(const Study& study, std::vector<CaseLoads>& loads) {
    std::map<std::string, Run> runs;
    for (auto& one : loads) {
        if (study.cases[one.entry].mean) {
            runs[run_of(study.cases[one.entry].conditions)].push_back(&one);
        }
    }
    std::map<const CaseLoads*, CaseLoads> means;  // by the first file of each whole run
    std::set<const CaseLoads*> others;            // in such a mean
    for (const auto& [name, run] : runs) {
        const auto known =
            std::count_if(run.begin(), run.end(), [](const CaseLoads* one) { return !one->values.empty(); });
        if (run.size() > 1 && static_cast<std::size_t>(known) == run.size()) {
            means.emplace(run.front(), mean_of(study, run));
            others.insert(run.begin(), run.end());
        } else if (known > 0) {
            run.front()->warnings.push_back(
                {core::Problem::Severity::warning,
                 run.size() == 1 ? "this is a single instant: there are no other times to make a mean of"
                                 : "no mean in time: " +
                                       core::counted_of(run.size() - static_cast<std::size_t>(known), run.size(),
                                                        "time", "has", "have") +
                                       " no loads",
                 {run.front()->file, {}, {}, {}}});
        }
    }
    std::vector<CaseLoads> all;
    for (const auto& one : loads) {
        if (const auto mean = means.find(&one); mean != means.end()) {
            all.push_back(mean->second);
        } else if (!others.contains(&one)) {
            all.push_back(one);
        }
    }
    return all;
}

}  // namespace underbody::cases
