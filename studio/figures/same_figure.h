// Whether two figures are the same picture.
#pragma once

#include "core/figure.h"

namespace underbody::studio {

/// Equal in every number and word; a figure that holds a NaN is equal to none.
[[nodiscard]] bool same_figure(const core::Figure& a, const core::Figure& b);

}  // namespace underbody::studio
