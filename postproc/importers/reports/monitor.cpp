#include "postproc/importers/reports/monitor.h"

#include <cmath>

#include "core/counted.h"

namespace underbody::postproc {

core::Problem repeated_rows(std::size_t rows, const std::string& file) {
    return {core::Problem::Severity::note,
            core::counted(rows, "row repeats or goes back, as after a restart: the last one counts",
                          "rows repeat or go back, as after a restart: the last ones count"),
            {file, {}, {}, {}}};
}

void MonitorRows::add(std::vector<double> row) {
    if (!rows_.empty() && row[0] <= rows_.rbegin()->first) {
        ++repeated_;
    }
    rows_[row[0]] = std::move(row);
}

void MonitorRows::into(Monitor& monitor) const {
    monitor.values.assign(monitor.columns.size(), {});
    std::size_t odd = 0;
    for (const auto& [key, row] : rows_) {
        for (std::size_t c = 0; c < monitor.columns.size(); ++c) {
            monitor.values[c].push_back(row[c]);
            odd += std::isfinite(row[c]) ? 0 : 1;
        }
    }
    if (repeated_ > 0) {
        monitor.problems.push_back(repeated_rows(repeated_, monitor.file));
    }
    if (odd > 0) {
        monitor.problems.push_back(
            {core::Problem::Severity::warning,
             core::counted(odd, "value is", "values are") + " not finite: the solution has diverged",
             {monitor.file, {}, {}, {}}});
    }
}

const std::vector<double>* Monitor::find(const std::string& column) const {
    for (std::size_t c = 0; c < columns.size(); ++c) {
        if (columns[c] == column) {
            return &values[c];
        }
    }
    return nullptr;
}

}  // namespace underbody::postproc
