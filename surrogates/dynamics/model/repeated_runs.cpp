#include "surrogates/dynamics/model/repeated_runs.h"

#include <algorithm>
#include <cmath>

namespace underbody::dynamics {

namespace {

bool equal_numbers(const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

}  // namespace

bool same_readings(const MeasuredRun& a, const MeasuredRun& b) {
    for (const core::Column& column : a.table.columns()) {
        const core::Column* other = b.table.find(column.name);
        if (other != nullptr && !column.is_text() && !other->is_text() &&
            !equal_numbers(column.numbers, other->numbers)) {
            return false;  // a gap that stood still, say, under another pitch
        }
    }
    return equal_numbers(a.values("gap"), b.values("gap")) &&
           equal_numbers(a.values("input_force"), b.values("input_force"));
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
