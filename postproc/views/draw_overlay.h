// What is written over a picture: title, colour bar, scale, axes; laid out in pixels.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "postproc/field/vector_math.h"
#include "postproc/views/views.h"

class vtkRenderer;

namespace underbody::postproc {

/// How a picture is shared out: words above, the colour bar at the right with the axes below it, the scale at the foot,
/// the scene in what remains, so that nothing lies over it.
struct PictureLayout {
    double unit = 1;  ///< pixels of 1/800 of the height: words stay readable when a picture is shown small
    double left = 0, bottom = 0, width = 0, height = 0;  ///< of the scene, pixels from the lower left
    explicit PictureLayout(const Scene& scene);
};

/// Right and up as the camera sees the axes.
struct ScreenAxes {
    Vector right, up;
};

/// Adds words and shapes to a renderer that covers the whole picture.
class Overlay {
public:
    Overlay(vtkRenderer& renderer, const Scene& scene, const PictureLayout& layout)
        : renderer_(renderer), scene_(scene), layout_(layout) {}

    void add_title();
    /// `values`: of what is drawn; an end of the bar that some go beyond is pointed.
    void add_bar(std::pair<double, double> range, std::pair<double, double> values);
    void add_scale(double pixels_per_metre);
    void add_axes(const ScreenAxes& axes);

private:
    using Polygon = std::vector<long long>;

    /// `x`, `y` in pixels, `size` in units; `align`: -1 left, 0 centred, 1 right.
    void text(const std::string& words, double x, double y, double size, bool bold, double grey, int align);
    void shapes(const std::vector<Vector>& points, const std::vector<Polygon>& polygons,
                const std::vector<Polygon>& lines, const std::vector<Vector>& colours, double width);

    vtkRenderer& renderer_;
    const Scene& scene_;
    const PictureLayout& layout_;
};

}  // namespace underbody::postproc
