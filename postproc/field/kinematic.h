// Pressure and wall shear over density, as incompressible solvers keep them.
#pragma once

#include <optional>

#include "postproc/field/field.h"

namespace underbody::postproc {

/// True when the field has p/rho (or wall shear over rho) and no pressure in Pa beside it.
bool is_kinematic(const Field& field);

/// Multiplies kinematic_pressure and kinematic_wall_shear by the density [kg/m^3], on nodes, faces and cells: they
/// become pressure and wall_shear [Pa]. Other arrays stay. Arrays that other fields share are not touched.
void multiply_by_density(Field& field, double density);

/// The same with the density that is given, else with the field's own. False: there is neither, and the field stays
/// over density.
bool bring_to_pascal(Field& field, std::optional<double> density);

}  // namespace underbody::postproc
