#include "postproc/loads/deviation.h"

#include <algorithm>
#include <cmath>

namespace underbody::postproc {

LoadScale load_scale(double own, double stated, double length) {
    constexpr double rounding = 1e-9;
    return {own > rounding * stated ? own : stated, length};
}

double load_measure(double own, double stated, bool moment, const LoadScale& scale) {
    const double measure = scale.force * (moment ? scale.length : 1);
    return measure > 0 ? measure : std::max(std::abs(own), std::abs(stated));
}

double deviation(double own, double stated, bool moment, const LoadScale& scale) {
    const double difference = std::abs(own - stated);
    const double size = load_measure(own, stated, moment, scale);
    return std::isnan(difference) ? difference : size > 0 ? difference / size : 0;
}

}  // namespace underbody::postproc
