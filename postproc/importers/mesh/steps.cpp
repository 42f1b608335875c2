#include "postproc/importers/mesh/steps.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"

namespace underbody::postproc {

std::size_t step_at(const std::vector<double>& times, double wanted, const std::string& file) {
    const core::Place place{file, {}, {}, {}};
    const auto nearest = std::min_element(
        times.begin(), times.end(), [&](double a, double b) { return std::abs(a - wanted) < std::abs(b - wanted); });
    if (nearest == times.end()) {
        throw core::InputError("range", "the file states no times", place, "leave option 'time' away");
    }
    if (!(std::abs(*nearest - wanted) <= 1e-6 * std::max(std::abs(wanted), std::abs(*nearest)))) {
        throw core::InputError("range",
                               "there is no time " + core::format_number(wanted) + " s among the " +
                                   std::to_string(times.size()) + " of the file",
                               place,
                               "the nearest is " + core::format_number(*nearest) + " s; there are " +
                                   core::format_number(*std::min_element(times.begin(), times.end())) + " to " +
                                   core::format_number(*std::max_element(times.begin(), times.end())) + " s");
    }
    return static_cast<std::size_t>(nearest - times.begin());
}

}  // namespace underbody::postproc
