// Draws core::Figure with QCustomPlot: the same code for files, reports and the desktop.
//
// Needs no display. A process without a QApplication gets one on Qt's `offscreen` platform at its first picture (about
// 40 ms, once); a process that draws nothing pays nothing but the loading of the libraries. Safe from any thread:
// pictures are drawn one after the other, and in a program with a window on the window's own thread.
#pragma once

#include <filesystem>
#include <string>

#include "core/figure.h"

class QCustomPlot;

namespace underbody::studio {

struct PictureSize {
    int width = 900;  ///< px at scale 1
    int height = 560;
    double scale = 2;  ///< pixels per px, for sharp pictures on dense screens
};

/// The figure as PNG bytes, round(width * scale) x round(height * scale) pixels; the same bytes for the same figure.
/// Throws core::SystemError (kind "font", "platform") when no font or no offscreen platform is installed, and
/// core::InputError (kind "size") for a size that is not positive or above 20000 pixels a side.
std::string render_png(const core::Figure& figure, const PictureSize& size = {});

/// Vector PDF bytes, one page of width x height points at 96 px an inch (`scale` has no meaning here). Throws as
/// render_png.
std::string render_pdf(const core::Figure& figure, const PictureSize& size = {});

/// Writes the picture whole; the ending says which: .png or .pdf. Throws core::UsageError for another one.
void write_picture(const core::Figure& figure, const std::filesystem::path& path, const PictureSize& size = {});

/// Puts the figure into a plot widget (clears it first). Only on the thread of the QApplication. Interactions that the
/// caller has set stay; `plot.axisRect()`, `xAxis` and `yAxis` are new objects afterwards.
void draw(const core::Figure& figure, QCustomPlot& plot);

/// A unit as people write it: "N s^2/m^2" -> "N s²/m²", "degC" -> "°C", "1" -> "".
std::string pretty_unit(const std::string& unit);

/// "gap (mm)", or only the label when there is no unit.
std::string axis_title(const std::string& label, const std::string& unit);

}  // namespace underbody::studio
