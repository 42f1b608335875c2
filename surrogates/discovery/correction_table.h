// A smooth law without a name as an effect that a model can hold.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "surrogates/dynamics/model/effect.h"

namespace underbody::discovery {

/// A smooth force (N, up) as the effect "unknown": a table over one to three variables (SI; names of channels) from
/// `lower` to `upper`, what was seen of each, nowhere larger than `largest` (N), that fades to nothing over a tenth of
/// the range beyond. `force` takes the variables in this order.
dynamics::EffectUse correction_table(const std::vector<std::string>& variables, const std::vector<double>& lower,
                                     const std::vector<double>& upper,
                                     const std::function<double(const double*)>& force, double largest);

}  // namespace underbody::discovery
