#include "postproc/views/colours.h"

#include <algorithm>
#include <cmath>

namespace underbody::postproc {

namespace {

using Anchors = std::array<std::array<double, 3>, 9>;

// viridis (van der Walt and Smith 2015) and Moreland's cool-warm (2009), at every eighth; between them straight.
constexpr Anchors viridis = {{{0.267, 0.005, 0.329},
                              {0.278, 0.176, 0.482},
                              {0.231, 0.322, 0.545},
                              {0.173, 0.447, 0.557},
                              {0.129, 0.565, 0.549},
                              {0.153, 0.678, 0.506},
                              {0.365, 0.784, 0.388},
                              {0.667, 0.863, 0.196},
                              {0.992, 0.906, 0.145}}};
constexpr Anchors cool_warm = {{{0.230, 0.299, 0.754},
                                {0.384, 0.510, 0.918},
                                {0.554, 0.690, 0.996},
                                {0.723, 0.816, 0.977},
                                {0.866, 0.866, 0.866},
                                {0.959, 0.769, 0.678},
                                {0.957, 0.604, 0.482},
                                {0.871, 0.376, 0.302},
                                {0.706, 0.016, 0.150}}};

}  // namespace

std::array<double, 3> colour_at(ColourMap map, double share) {
    share = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0;
    if (map == ColourMap::grey) {
        const double g = 0.15 + 0.75 * share;
        return {g, g, g};
    }
    const Anchors& anchors = map == ColourMap::viridis ? viridis : cool_warm;
    const double at = share * 8;
    const auto i = std::min<std::size_t>(7, static_cast<std::size_t>(at));
    const double t = at - static_cast<double>(i);
    std::array<double, 3> colour{};
    for (std::size_t k = 0; k < 3; ++k) {
        colour[k] = (1 - t) * anchors[i][k] + t * anchors[i + 1][k];
    }
    return colour;
}

double round_below(double value) {
    if (!(value > 0)) {
        return 0;
    }
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    const double lead = value / power;
    return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}

std::vector<double> round_ticks(double low, double high, int count) {
    std::vector<double> ticks;
    const double span = high - low;
    // Ends that differ by rounding alone leave no room for a step: counting up would never end.
    if (!(span > 1e-12 * std::max(std::abs(low), std::abs(high))) || !std::isfinite(span) || count < 1) {
        return {low};
    }
    const double rough = span / count;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double lead = rough / power;
    const double step = (lead > 7.07 ? 10 : lead > 3.16 ? 5 : lead > 1.41 ? 2 : 1) * power;
    for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) {
        ticks.push_back(i == 0 ? 0.0 : i * step);
    }
    return ticks;
}

std::pair<double, double> drawn_range(std::pair<double, double> range, ColourMap map) {
    auto [low, high] = range;
    if (!std::isfinite(low) || !std::isfinite(high) || low > high) {
        return {0, 1};
    }
    if (map == ColourMap::diverging) {
        high = std::max(std::abs(low), std::abs(high));
        low = -high;
    }
    if (high - low <= 1e-9 * std::max(std::abs(low), std::abs(high))) {  // one value but for rounding
        const double pad = low == 0 ? 1 : 0.5 * std::abs(low);
        return {low - pad, high + pad};
    }
    return {low, high};
}

}  // namespace underbody::postproc
