#include "core/figure.h"

#include <array>

namespace underbody::core {

Colour palette(std::size_t index) {
    static constexpr std::array<Colour, 8> colours = {{{0, 114, 178, 255},
                                                       {213, 94, 0, 255},
                                                       {0, 158, 115, 255},
                                                       {204, 121, 167, 255},
                                                       {230, 159, 0, 255},
                                                       {86, 180, 233, 255},
                                                       {0, 0, 0, 255},
                                                       {240, 228, 66, 255}}};
    return colours[index % colours.size()];
}

}  // namespace underbody::core
