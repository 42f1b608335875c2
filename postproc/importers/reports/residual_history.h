// Residuals by iteration, whatever equations turn up on the way.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "postproc/importers/reports/monitor.h"

namespace underbody::postproc {

/// Collects what a solver prints. Equations may join and leave; an iteration that comes again counts as it came last.
class ResidualHistory {
public:
    explicit ResidualHistory(std::string file) { monitor_.file = std::move(file); }

    /// What is added from now on is of that iteration.
    void begin(double iteration);
    /// The iteration that began last; nothing before the first.
    [[nodiscard]] std::optional<double> at() const { return at_; }
    void add(const std::string& equation, double residual);

    /// Columns in the order of their first appearance behind `first_column`; NaN where an equation has no residual. A
    /// residual that is not finite becomes a warning. Throws InputError when there are none at all.
    Monitor finish(const std::string& first_column);

private:
    Monitor monitor_;
    std::map<std::string, std::size_t> columns_;
    std::map<double, std::map<std::size_t, double>> rows_;
    std::optional<double> at_;
    std::size_t odd_ = 0;
};

}  // namespace underbody::postproc
