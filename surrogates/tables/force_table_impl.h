// What a ForceTable points to. For the files of this room only.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "surrogates/tables/error_model.h"
#include "surrogates/tables/force_table.h"
#include "surrogates/tables/grid.h"

namespace underbody::tables {

struct ForceTable::Impl {
    std::string quantity;
    std::string unit;
    std::string kind;
    std::string source;
    std::vector<TableAxis> axes;
    core::Problems remarks;
    core::Table points;
    std::vector<std::pair<std::string, double>> constants;
    RangePolicy range = RangePolicy::clamp;
    SlopeRule rule = SlopeRule::monotone;
    CubicGrid surface;  ///< what value() evaluates
    ErrorModel error;   ///< variance over the same axes
};

}  // namespace underbody::tables
