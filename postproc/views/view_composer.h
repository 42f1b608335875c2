// The pictures of one case as scenes, before they are drawn.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "postproc/field/field.h"
#include "postproc/field/lists.h"
#include "postproc/loads/vehicle_axes.h"
#include "postproc/views/view_parts.h"
#include "postproc/views/views.h"

namespace underbody::postproc {

/// A scene with what is said about it.
struct ComposedView {
    Scene scene;
    std::string caption;
    std::string of_range;  ///< what is to be said of the colours' ends, unless a range is given
};

/// The range that holds 98 % of the values where a few extremes (an edge, a stagnation point) would swallow the
/// colours; `extremes` names the end that was cut then, in `unit`. Of no values the range is empty (its end lies before
/// its begin).
std::pair<double, double> robust_colour_range(std::vector<double> values, std::string& extremes,
                                              const std::string& unit);

/// What people call an array, and its unit: "wall shear", "Pa".
std::string view_label(const std::string& array);
std::string view_unit(const std::string& array);

/// The array that a view shows; empty for no view's name.
std::string array_of_view(const std::string& name);

/// What a range is of: "speed" and "shear" are the arrays velocity and wall_shear, other words are themselves.
std::string range_key(const std::string& word);

/// Throws core::UsageError, with the nearest name: a range of what is not among the `shown` keys, one that ends before
/// it begins.
void check_ranges(const ViewOptions& options, const std::vector<std::string>& shown);

/// The picture of a scene.
View drawn(const ComposedView& composed, const std::string& name);

/// Colours as they will be drawn: the scene's range, else that of its values.
std::pair<double, double> range_of(const Scene& scene);

/// What a case has to show, and from where it is looked at. Lives shorter than field and options.
class ViewComposer {
public:
    /// Throws core::UsageError: a symmetry plane that is none, axes that are not perpendicular, a range for a view that
    /// nobody knows; core::InputError: zones that are not there, a half model that is none (`place_mirror`).
    ViewComposer(const Field& field, const ViewOptions& options);

    [[nodiscard]] std::vector<std::string> possible() const;

    /// Throws core::InputError with the nearest name for a view that is not possible.
    [[nodiscard]] ComposedView compose(const std::string& name) const;

    [[nodiscard]] const std::vector<const Zone*>& zones() const { return zones_; }  ///< of the body, without a ground
    [[nodiscard]] const PlacedMirror& mirror() const { return mirror_; }
    [[nodiscard]] const std::string& mirror_said() const { return mirror_said_; }  ///< for captions; mostly empty
    [[nodiscard]] const std::string& case_name() const { return name_; }
    [[nodiscard]] Point base_centre() const;  ///< m, of what there is of it: half a model has half a base
    [[nodiscard]] Box whole_body() const;     ///< both halves
    [[nodiscard]] Camera from_below() const;  ///< bow to the right
    /// The camera that the options name, when they do.
    void take_camera(Scene& scene) const;
    [[nodiscard]] std::string camera_said() const;  ///< "seen from below"

private:
    /// A view: its name, the array that it shows, how it is composed and when that is possible.
    struct Kind {
        const char* name;
        const char* array;
        const char* meaning;
        ComposedView (ViewComposer::*compose)(const std::string& array) const;
        bool (ViewComposer::*possible)(const std::string& array) const;
    };
    static const std::vector<Kind>& kinds();
    static std::vector<std::string> keys_of_ranges();
    friend std::vector<RangeKey> range_keys();
    friend std::vector<ViewKind> view_kinds();
    friend std::string array_of_view(const std::string& name);

    [[nodiscard]] bool on_underbody(const std::string& array) const;
    [[nodiscard]] bool on_hull(const std::string& array) const;
    [[nodiscard]] bool on_hull_alone(const std::string& array) const;
    [[nodiscard]] bool in_volume(const std::string& array) const;
    [[nodiscard]] bool in_gap(const std::string& array) const;
    [[nodiscard]] bool in_plane(const std::string& array) const;

    [[nodiscard]] ComposedView underbody_view(const std::string& array) const;
    [[nodiscard]] ComposedView hull_view(const std::string& array) const;
    [[nodiscard]] ComposedView symmetry_view(const std::string& array) const;
    [[nodiscard]] ComposedView gap_view(const std::string& array) const;
    [[nodiscard]] ComposedView plane_view(const std::string& array) const;
    [[nodiscard]] ComposedView surface_view(const std::string& array, bool base_range) const;

    void find_symmetry_zone();
    [[nodiscard]] std::string file() const { return field_.files.empty() ? "" : field_.files.front(); }
    [[nodiscard]] bool has_array(const std::string& array) const;
    [[nodiscard]] bool volume_has(const std::string& array) const;
    [[nodiscard]] std::pair<Point, Point> middle_plane() const;
    [[nodiscard]] Box surroundings(const DrawnSurface& plane) const;
    [[nodiscard]] std::vector<Point> gap_seeds(double gap) const;
    void finish(ComposedView& composed, const Kind& kind) const;

    const Field& field_;
    const ViewOptions& options_;
    VehicleAxes axes_;
    std::vector<const Zone*> zones_;
    Box body_ = empty_box();
    Box base_box_ = empty_box();
    bool has_base_ = false;
    PlacedMirror mirror_;
    std::string mirror_said_;     ///< for the captions: where nobody said that the plane lies
    PlacedMirror symmetry_zone_;  ///< a flat boundary that the file calls a symmetry, when no mirror was asked for
    std::string name_;
};

}  // namespace underbody::postproc
