// Draws core::Figure with QCustomPlot: the same code for files, reports and the desktop.
#pragma once

#include <string>

#include "core/figure.h"

class QCustomPlot;

namespace underbody::studio {

struct PictureSize {
    int width = 900;    ///< px at scale 1
    int height = 560;
    double scale = 2;   ///< pixels per px, for sharp pictures on dense screens
};

/// The figure as PNG bytes. Needs no display: starts a QApplication on the `offscreen` platform when there is none.
std::string render_png(const core::Figure& figure, const PictureSize& size = {});

/// Vector PDF bytes.
std::string render_pdf(const core::Figure& figure, const PictureSize& size = {});

/// Puts the figure into a plot widget (clears it first).
void draw(const core::Figure& figure, QCustomPlot& plot);

}  // namespace underbody::studio
