#include "studio/figures/colour_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace underbody::studio {

namespace {

template <std::size_t N>
core::Colour between(const std::array<std::array<unsigned char, 3>, N>& stops, double t) {
    const double where = std::clamp(std::isfinite(t) ? t : 0.0, 0.0, 1.0) * static_cast<double>(N - 1);
    const std::size_t first = std::min(static_cast<std::size_t>(where), N - 2);
    const double part = where - static_cast<double>(first);
    const auto mix = [&](std::size_t channel) {
        return static_cast<unsigned char>(
            std::lround((1 - part) * stops[first][channel] + part * stops[first + 1][channel]));
    };
    return {mix(0), mix(1), mix(2), 255};
}

constexpr std::array<std::array<unsigned char, 3>, 17> viridis_stops = {{{68, 1, 84},
                                                                         {72, 21, 104},
                                                                         {71, 40, 120},
                                                                         {66, 58, 131},
                                                                         {59, 76, 138},
                                                                         {51, 92, 141},
                                                                         {44, 109, 142},
                                                                         {38, 124, 142},
                                                                         {33, 140, 141},
                                                                         {31, 156, 137},
                                                                         {40, 172, 129},
                                                                         {64, 187, 116},
                                                                         {98, 200, 95},
                                                                         {137, 210, 70},
                                                                         {180, 218, 48},
                                                                         {220, 225, 31},
                                                                         {253, 231, 37}}};

constexpr std::array<std::array<unsigned char, 3>, 11> diverging_stops = {{{5, 48, 97},
                                                                           {33, 102, 172},
                                                                           {67, 147, 195},
                                                                           {146, 197, 222},
                                                                           {209, 229, 240},
                                                                           {247, 247, 247},
                                                                           {253, 219, 199},
                                                                           {244, 165, 130},
                                                                           {214, 96, 77},
                                                                           {178, 24, 43},
                                                                           {103, 0, 31}}};

}  // namespace

core::Colour viridis(double t) { return between(viridis_stops, t); }

core::Colour diverging(double t) { return between(diverging_stops, t); }

}  // namespace underbody::studio
