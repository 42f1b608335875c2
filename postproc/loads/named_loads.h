// A force in the vehicle's sense.
#pragma once

#include "postproc/loads/loads_result.h"
#include "postproc/loads/vehicle_axes.h"

namespace underbody::postproc {

/// Lift, drag, pitch moment ... (docs/conventions.md section 1) of a force and moment in the file's axes.
NamedLoads named_loads(const Wrench& wrench, const VehicleAxes& axes);

}  // namespace underbody::postproc
