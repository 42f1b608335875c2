// What a ForceTable points to. For the files of this room only.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "surrogates/tables/fit/error_model.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/grid.h"

namespace underbody::tables {

class Hull;
class Support;
struct ProcessMixture;

struct ForceTable::Impl {
    std::string quantity;
    std::string unit;
    std::string kind;
    std::string source;
    std::vector<TableAxis> axes;
    core::Problems remarks;
    std::vector<std::string> told;  ///< of an exported table: lines of its head that no column says
    core::Table points;
    std::vector<std::pair<std::string, double>> constants;
    SlopeRule rule = SlopeRule::monotone;
    CubicGrid surface;                                ///< what value() evaluates
    ErrorModel error;                                 ///< standard deviation over the same axes
    std::shared_ptr<const ProcessMixture> processes;  ///< of a table by Gaussian processes; null for others
    std::shared_ptr<const Hull> hull;                 ///< of scattered points of two and more axes; null for others
    std::shared_ptr<const Support>
        support;  ///< where there is data, when it is not the hull that says so; null for others

    double sampling_error = 0;
    double point_scatter = 0;  ///< of points that state no errors: taken as their error, a mean; 0: none is

    /// Null: everywhere within the axes.
    [[nodiscard]] const Support* data_support() const;
};

}  // namespace underbody::tables
