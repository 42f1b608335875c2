#include "postproc/importers/reports/residual_history.h"

#include <cmath>

#include "core/counted.h"

namespace underbody::postproc {

void ResidualHistory::begin(double iteration) {
    at_ = iteration;
    rows_[iteration];
}

void ResidualHistory::add(const std::string& equation, double residual) {
    const auto [column, is_new] = columns_.try_emplace(equation, columns_.size());
    if (is_new) {
        monitor_.columns.push_back(equation);
    }
    odd_ += std::isfinite(residual) ? 0 : 1;
    rows_[at_.value_or(0)][column->second] = residual;
}

Monitor ResidualHistory::finish(const std::string& first_column) {
    monitor_.title = "residuals";
    monitor_.values.assign(columns_.size() + 1, {});
    for (const auto& [iteration, row] : rows_) {
        if (row.empty()) {
            continue;  // cut short before its table
        }
        monitor_.values[0].push_back(iteration);
        for (std::size_t c = 0; c < columns_.size(); ++c) {
            const auto found = row.find(c);
            monitor_.values[c + 1].push_back(found == row.end() ? std::nan("") : found->second);
        }
    }
    monitor_.columns.insert(monitor_.columns.begin(), first_column);
    if (monitor_.values[0].empty()) {
        throw core::InputError("format", "the solver's output holds no residuals", {monitor_.file, {}, {}, {}});
    }
    if (odd_ > 0) {
        monitor_.problems.push_back(
            {core::Problem::Severity::warning,
             core::counted(odd_, "residual is", "residuals are") + " not finite: the solution has diverged",
             {monitor_.file, {}, {}, {}}});
    }
    return std::move(monitor_);
}

}  // namespace underbody::postproc
