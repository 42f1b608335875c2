// What the sensors of a vehicle can know along the gap, as Stability shows it. Before any header of Qt, which makes
// `signals` a keyword.
#pragma once

#include "core/error.h"
#include "surrogates/estimator/observe/information.h"

namespace underbody::studio {

struct KnownAlongGap {
    estimator::InformationMap information;
    estimator::ObservabilityAlongGap observability;
    core::Problems remarks;
};

}  // namespace underbody::studio
