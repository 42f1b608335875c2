// What the thesis printed, word for word, and the reference plant its studies are redrawn with. Origin: EVIE thesis,
// chapters 7 and 8.
#pragma once

#include <functional>

#include "surrogates/estimator/model/augmented_model.h"
#include "surrogates/estimator/model/training.h"

namespace underbody::thesis {

/// 1/S_z = 0.2529 1/kg.
double thesis_virtual_mass();

/// The curve REF-A: 38 knots through a not-a-knot spline, clamped outside (a stated choice; the thesis only draws its
/// curve). Gap shifted as in chapter 7: the stable zero lies at 0, the unstable one at 0.16 m.
std::function<double(double gap, double& slope)> reference_ground_force();
/// REF-A with the given drag, S of the thesis, no bias.
estimator::SeparatedPlant reference_plant(estimator::ResistanceLaw drag = estimator::quadratic_drag(0, 50.2));

estimator::AugmentedModel published_8_47();  ///< two nonlinear forces, order 6, with 8.48/8.49's blocks
estimator::AugmentedModel published_grid();  ///< section 7.5, "from grid data"
estimator::AugmentedModel published_7_48();  ///< linear drag, order 5
estimator::Matrix printed_covariance();      ///< 9 x 9, channels (u; w, h, F_g, F_d; their rates)
estimator::Matrix printed_basis();           ///< 9 x 5: U, V, W stacked
estimator::Vector printed_eigenvalues();

}  // namespace underbody::thesis
