// What the files of the stability region share.
#pragma once

#include "surrogates/dynamics/region.h"

namespace underbody::dynamics {

/// A plant with its bounds and its judge of ends.
struct HeaveRegionSetup {
    HeavePlant plant;
    double contact_gap = 0, escape_gap = 0;
    std::unique_ptr<HeaveEnds> ends;
    HeaveRegionSetup(const Model& model, const RegionOptions& options, const std::vector<double>* start_gaps = nullptr);
};

}  // namespace underbody::dynamics
