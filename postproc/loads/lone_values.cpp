#include "postproc/loads/lone_values.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "core/counted.h"
#include "core/text.h"

namespace underbody::postproc {

namespace {

struct Band {
    double middle = 0, reach = 0;
};

/// The middle of the pressures, and how far from it a value may lie; by a part of them where there are many.
Band band_of(const std::vector<SummedZone>& parts) {
    constexpr std::size_t enough = 4096;
    constexpr double far = 1000, share = 0.99;
    std::size_t count = 0;
    for (const auto& part : parts) {
        count += part.values.pressure.size();
    }
    const std::size_t stride = std::max<std::size_t>(1, count / enough);
    std::vector<double> some;
    for (const auto& part : parts) {
        for (std::size_t i = 0; i < part.values.pressure.size(); i += stride) {
            some.push_back(part.values.pressure[i]);
        }
    }
    if (some.empty()) {
        return {0, HUGE_VAL};
    }
    const auto at = [&some](double where) {
        const auto place = some.begin() + static_cast<std::ptrdiff_t>(where * static_cast<double>(some.size() - 1));
        std::nth_element(some.begin(), place, some.end());
        return *place;
    };
    const double middle = at(0.5);
    for (double& p : some) {
        p = std::abs(p - middle);
    }
    constexpr double of_the_middle = 1e-3, least = 1e-3;  // Pa: where all others are one number
    return {middle, far * std::max({at(share), of_the_middle * std::abs(middle), least})};
}

}  // namespace

void warn_of_lone_values(const std::vector<SummedZone>& parts, LoadsResult& result) {
    const Band band = band_of(parts);
    const auto lone = [&band](double p) { return std::abs(p - band.middle) > band.reach; };
    std::size_t count = 0;
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    std::string first;
    for (const auto& part : parts) {
        for (std::size_t i = 0; i < part.values.pressure.size(); ++i) {
            const double p = part.values.pressure[i];
            if (!lone(p)) {
                lowest = std::min(lowest, p);
                highest = std::max(highest, p);
                continue;
            }
            first = count++ > 0
                        ? first
                        : core::format_number(p, 4) + " Pa at " + (part.values.pressure_on_nodes ? "node " : "face ") +
                              std::to_string(i) + " of zone '" + part.name + "'";
        }
    }
    if (count > 0) {
        result.problems.push_back(
            {core::Problem::Severity::warning,
             "the pressure is " + first +
                 (count > 1 ? " and as far off at " + core::counted(count - 1, "other place") : std::string()) +
                 ", all others lie between " + core::format_number(lowest, 4) + " and " +
                 core::format_number(highest, 4) + " Pa: such a value decides the force; look at it in the file",
             {}});
    }
}

}  // namespace underbody::postproc
