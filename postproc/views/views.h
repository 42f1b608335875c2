// Pictures of fields and bodies, with or without a display.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/progress.h"

namespace underbody::postproc {

struct Field;

/// A surface to be drawn, as plain values: points in m, faces as triangles, one value per point (or none).
struct DrawnSurface {
    std::vector<std::array<double, 3>> points;
    std::vector<std::array<int, 3>> triangles;
    std::vector<double> values;  ///< per point; empty: one colour
    std::array<double, 3> colour{0.72, 0.75, 0.78};
    double opacity = 1;
    bool edges = false;  ///< draw the triangles' edges
    bool smooth = true;  ///< round shading over edges below 30 degrees; false: flat colours, no light
    int contours = 0;    ///< about so many thin lines of equal value, at round values
};

/// A line to be drawn: streamlines, traces.
struct DrawnLine {
    std::vector<std::array<double, 3>> points;
    std::vector<double> values;  ///< per point, by the scene's colour map; empty: one colour
    std::array<double, 3> colour{0.1, 0.1, 0.1};
    double width = 2;  ///< pixels of a picture 800 high; thinner in smaller ones
};

/// Where the picture is taken from; axes of the drawn points.
struct Camera {
    std::array<double, 3> towards{-1, 0.9, -0.55};  ///< direction of looking
    std::array<double, 3> up{0, 0, 1};
    bool parallel = true;  ///< no perspective: lengths can be compared, the scale bar is true
    double zoom = 1;
    /// The box to fit (x0, x1, y0, y1, z0, z1); default: everything drawn. Give the same one to compare pictures.
    std::optional<std::array<double, 6>> box;
};

enum class ColourMap {
    viridis,    ///< values from low to high
    diverging,  ///< blue, white, red (Moreland 2009), centred on zero
    grey,
};

struct Scene {
    std::vector<DrawnSurface> surfaces;
    std::vector<DrawnLine> lines;
    std::string title;                               ///< what is shown: "pressure on the underbody"
    std::string subtitle;                            ///< the case: "ellipse, gap 5 mm, pitch 0 deg"
    std::string value_name;                          ///< "pressure"; empty: no colour bar
    std::string value_unit;                          ///< "Pa"
    std::optional<std::pair<double, double>> range;  ///< of the colours; default: of the values
    ColourMap colours = ColourMap::viridis;
    Camera camera;
    int width = 1200;
    int height = 800;
    double text_size = 1;  ///< of the words, as a multiple; 1: those of a picture 800 high, smaller ones in proportion
    bool scale_bar = true;
    bool axes = true;  ///< small arrows of the axes' directions
    std::array<std::string, 3> axis_names{"x", "y", "z"};
};

/// Draws and returns a PNG file's bytes. Starts its own Xvfb when there is no usable display.
/// Throws core::SystemError (kind "display") when neither is to be had; never aborts.
std::string draw_png(const Scene& scene);

/// Ends the process-wide Xvfb that draw_png may have started; called at exit by itself.
void end_drawing();

// ---- pictures of a case ----

/// Where a camera looks and what is up in its picture, unit vectors in file axes.
struct NamedCamera {
    std::array<double, 3> towards, up;
};

/// How a case's pictures are made.
struct ViewOptions {
    std::array<double, 3> forward{1, 0, 0};  ///< file axes
    std::array<double, 3> up{0, 0, 1};
    std::string symmetry;  ///< half model: its plane, "y" or "y=0.1"; the mirror image is drawn too. A body on both
                           ///< sides of it is refused
    std::vector<std::string>
        zones;  ///< surfaces of the body; empty: as `loads` chooses them, without a ground or a tunnel
    std::string base = "*base*";  ///< zone seen from below
    std::string case_name;        ///< for the subtitle; default: the file's name
    double speed = 0;             ///< m/s, for pressure coefficients in subtitles; 0: unknown
    int width = 1200;
    int height = 800;
    double text_size = 1;  ///< see Scene::text_size
    /// From where surfaces of the body are seen, one of `camera_names()`; empty: as each view is defined.
    std::string camera;
    /// From where instead of `camera`: as a hand turned it.
    std::optional<NamedCamera> turned;
    /// Colour ranges to share between cases, SI, by the view's name ("pressure-underbody") or by what it shows
    /// (pressure, wall_shear, velocity; also "speed" and "shear"); a view's own counts over that of all. Other keys are
    /// refused.
    std::vector<std::pair<std::string, std::pair<double, double>>> ranges;
    /// Box to fit, file axes, to share between cases (see Camera::box).
    std::optional<std::array<double, 6>> box;
};

struct View {
    std::string name;  ///< "pressure-underbody": file name without ending
    std::string title;
    std::string caption;  ///< what it shows, from what it was made, its range
    std::string png;
    std::pair<double, double> range;  ///< of the colours, SI
};

/// "bottom", "top", "side" (from starboard), "front", "iso" (from below the bow, starboard).
const std::vector<std::string>& camera_names();

/// Of a name. Throws core::UsageError: no such name (with the nearest); as `vehicle_axes`.
NamedCamera named_camera(const std::string& name, const std::array<double, 3>& forward,
                         const std::array<double, 3>& up);

/// What a colour range may be given for: every view's name, and the arrays pressure, wall_shear, velocity; the unit
/// that its ends have ("" for a difference, which has that of its array).
struct RangeKey {
    std::string name;
    std::string unit;
};
std::vector<RangeKey> range_keys();

/// Everything that this field allows. Two-dimensional cases: pressure and speed over their plane. Else pressure and
/// wall shear on the underbody (seen from below; without a base on the hull), pressure on the hull; with a volume also
/// pressure and speed in the symmetry plane (that of a half model or of the one flat symmetry boundary, else the middle
/// of the body) and streamlines in the gap. Throws core::InputError when the field has nothing of these.
std::vector<View> views(const Field& field, const ViewOptions& options = {},
                        core::Progress& progress = core::Progress::none());

/// Names that `views` can make of this field.
std::vector<std::string> possible_views(const Field& field, const ViewOptions& options = {});

/// One of them. Throws core::InputError with the nearest name.
View view(const Field& field, const std::string& name, const ViewOptions& options = {},
          core::Progress& progress = core::Progress::none());

/// Colour ranges of all views of these fields together, and the box around all bodies: give both to every case's
/// options and its pictures can be compared.
ViewOptions shared_view_options(const std::vector<const Field*>& fields, const ViewOptions& options = {},
                                core::Progress& progress = core::Progress::none());

/// `b` minus `a` of an array on the body's surface, on the mesh of `b`; `a`, whatever its mesh, is interpolated there
/// from its nearest faces. Of vectors their sizes are compared. Diverging colours centred on zero; ranges by
/// "difference" or "difference-ARRAY" alone. The caption says how far apart the surfaces lie. Pressures are brought to
/// one reference where both files say what theirs is. Throws core::InputError where that is not possible, or where the
/// array is not on both.
View difference_view(const Field& a, const Field& b, const std::string& array = "pressure",
                     const ViewOptions& options = {}, core::Progress& progress = core::Progress::none());

/// The picture of one of several differences, or why there is none.
struct DifferenceView {
    std::optional<View> view;
    std::string why;
};

/// Each of `others` minus `first`, as `difference_view`, all with one range of colours: the given one, else the widest
/// of all. Each is drawn once.
std::vector<DifferenceView> difference_views(const Field& first, const std::vector<const Field*>& others,
                                             const std::string& array, const ViewOptions& options = {},
                                             core::Progress& progress = core::Progress::none());

}  // namespace underbody::postproc
