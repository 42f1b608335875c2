#include "postproc/loads/deviation.h"

#include <algorithm>
#include <cmath>

namespace underbody::postproc {

double resultant(const std::function<double(const char*)>& value_of) {
    const auto known = [&](const char* name) {
        const double value = value_of(name);
        return std::isfinite(value) ? value : 0.0;
    };
    return std::hypot(known("lift_force"), known("drag_force"), known("side_force"));
}

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
