// The closed forms of this room: what a linear model of two separate forces promises, for numbers of one's own.
#pragma once

#include <vector>

#include "core/closed_form.h"

namespace underbody::estimator {

/// margins: how much a 2 x 2 matrix may change and stay stable. two_forces: what can be told apart of ground force and
/// drag in a linear model, with which gain of the observer, and where the estimates go.
const std::vector<core::ClosedForm>& closed_forms();

}  // namespace underbody::estimator
