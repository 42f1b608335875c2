// The matrix of surrogates/dynamics, under the names of this room.
#pragma once

#include "surrogates/dynamics/model/matrix.h"

namespace underbody::estimator {

using dynamics::Matrix;
using Vector = std::vector<double>;

}  // namespace underbody::estimator
