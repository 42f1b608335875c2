#include "surrogates/dynamics/model/repeated_runs.h"

#include <algorithm>
#include <cmath>

namespace underbody::dynamics {

bool same_readings(const MeasuredRun& a, const MeasuredRun& b) {
    const auto same = [&](const char* channel) {
        const std::vector<double> of_a = a.values(channel), of_b = b.values(channel);
        return std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                          [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
    };
    return same("gap") && same("input_force");
}

core::Problem used_once(const MeasuredRun& repeated, const MeasuredRun& first) {
    return {core::Problem::Severity::warning,
            repeated.name + " is the same as " + first.name + ", reading by reading: used once",
            {repeated.table.source, {}, {}, {}}};
}

void drop_repeated_runs(Measurements& data) {
    if (data.kind != MeasurementKind::time_series) {
        return;
    }
    std::vector<MeasuredRun> kept;
    for (MeasuredRun& run : data.runs) {
        const auto first =
            std::find_if(kept.begin(), kept.end(), [&](const MeasuredRun& other) { return same_readings(other, run); });
        if (first == kept.end()) {
            kept.push_back(std::move(run));
        } else {
            data.problems.push_back(used_once(run, *first));
        }
    }
    data.runs = std::move(kept);
}

}  // namespace underbody::dynamics
