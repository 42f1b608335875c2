// Many pictures on one labelled sheet: cases side by side, contact sheets of a sweep.
#pragma once

#include <string>
#include <vector>

namespace underbody::studio {

struct Tile {
    std::string png;    ///< PNG bytes; empty: a blank place with its label
    std::string label;  ///< under the picture, in one line (shortened in the middle when too long)
};

struct MontageOptions {
    std::string title;
    int columns = 0;       ///< 0: as square as the pictures make it
    int tile_width = 420;  ///< px; pictures keep their shape
    double scale = 1;      ///< pixels per px
};

/// The sheet as PNG bytes. Every tile has the height of the tallest picture. Throws core::InputError for bytes that are
/// no picture (named by their label), for no tiles, and for a sheet above 20000 pixels a side; core::SystemError as
/// render_png.
std::string montage_png(const std::vector<Tile>& tiles, const MontageOptions& options = {});

}  // namespace underbody::studio
