// What the forces of the vehicle alone are taken at: shared by force_points and force_tables. For the files of this
// room only.
#pragma once

#include "core/error.h"
#include "core/table.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

/// The model with declared_parameter carried out and only the static effects of the vehicle kept; what is left out
/// (effects of the rig and of the motion) is named in the remarks, and in those of the
/// model. Throws core::InputError when it has no force source.
Model of_the_vehicle(const Model& model, core::Problems& remarks);

/// Gives a value to every channel that scales a force and is no axis: the model's condition, else the reference of its
/// scale (references_of: none where scales differ, and each force stays at its own); said in the remarks.
void hold_scales(const Model& model, const std::vector<Channel>& axes, Conditions& held, core::Problems& remarks);

/// Columns of one value: held channels, and the vehicle and the water that the forces belong to.
void add_constants(core::Table& points, const Model& model, const std::vector<Channel>& axes, const Conditions& held);

}  // namespace underbody::dynamics
