#include "cases/volume_fault.h"

#include "core/no_limit.h"
#include "core/text.h"
#include "geometry/body/exact_body.h"

namespace underbody::cases {

bool limits_volume(const DesignSpec& spec) { return spec.least_volume > 0 || core::is_limit(spec.most_volume); }

std::string volume_fault(const DesignSpec& spec, const geometry::BodyShape& shape) {
    if (!limits_volume(spec)) {
        return {};
    }
    const double volume = geometry::ExactBody(shape).volume();
    const bool small = volume < spec.least_volume;
    if (!small && volume <= spec.most_volume) {
        return {};
    }
    return "it has " + core::format_number(1e3 * volume, 4) + " L and design.volume wants at " +
           (small ? "least " : "most ") + core::format_number(1e3 * (small ? spec.least_volume : spec.most_volume), 4) +
           " L";
}

}  // namespace underbody::cases
