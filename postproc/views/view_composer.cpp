// Which views a case has, from where they are seen, what is said of them; `view_scenes.cpp` composes each.
#include "postproc/views/view_composer.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/text.h"
#include "postproc/field/vector_math.h"
#include "postproc/loads/stated_loads.h"
#include "postproc/views/colours.h"

namespace underbody::postproc {

namespace {

Box box_of(const Zone& zone) {
    Box box{};
    zone.surface->GetCellsBounds(
        box.data());  // of the faces: a surface cut out of another may bring all points of that
    return box;
}

}  // namespace

std::string view_label(const std::string& array) {
    return array == "wall_shear" ? "wall shear" : array == "velocity" ? "speed" : array;
}

std::string view_unit(const std::string& array) { return array == "velocity" ? "m/s" : "Pa"; }

const std::vector<ViewComposer::Kind>& ViewComposer::kinds() {
    using C = ViewComposer;
    static const std::vector<Kind> all = {
        {"pressure-underbody", "pressure", "pressure on the body seen from below", &C::underbody_view,
         &C::on_underbody},
        {"pressure-hull", "pressure", "pressure on the body seen from above and ahead", &C::hull_view, &C::on_hull},
        {"shear-underbody", "wall_shear", "wall shear stress on the body seen from below", &C::underbody_view,
         &C::on_underbody},
        {"shear-hull", "wall_shear", "wall shear stress on the hull, of a body without a zone that is its base",
         &C::hull_view, &C::on_hull_alone},
        {"pressure-symmetry", "pressure", "pressure in the plane of symmetry, of a field with a volume",
         &C::symmetry_view, &C::in_volume},
        {"speed-symmetry", "velocity", "speed in the plane of symmetry, of a field with a volume", &C::symmetry_view,
         &C::in_volume},
        {"streamlines-gap", "velocity", "streamlines in the gap under the base, of a field with a volume", &C::gap_view,
         &C::in_gap},
        {"pressure-plane", "pressure", "pressure of a two-dimensional case", &C::plane_view, &C::in_plane},
        {"speed-plane", "velocity", "speed of a two-dimensional case", &C::plane_view, &C::in_plane},
    };
    return all;
}

std::string array_of_view(const std::string& name) {
    for (const auto& key : ViewComposer::kinds()) {
        if (key.name == name) {
            return key.array;
        }
    }
    return {};
}

std::vector<ViewKind> view_kinds() {
    std::vector<ViewKind> all;
    for (const auto& kind : ViewComposer::kinds()) {
        all.push_back({kind.name, view_unit(kind.array), kind.meaning});
    }
    return all;
}

std::vector<RangeKey> range_keys() {
    std::vector<RangeKey> keys = {{"pressure", "Pa"}, {"wall_shear", "Pa"}, {"velocity", "m/s"}, {"difference", ""}};
    for (const auto& kind : ViewComposer::kinds()) {
        keys.push_back({kind.name, view_unit(kind.array)});
    }
    return keys;
}

std::vector<std::string> ViewComposer::keys_of_ranges() {
    std::vector<std::string> keys = {"pressure", "wall_shear", "shear", "velocity", "speed"};
    for (const auto& kind : kinds()) {
        keys.emplace_back(kind.name);
    }
    return keys;
}

ViewComposer::ViewComposer(const Field& field, const ViewOptions& options)
    : field_(field),
      options_(options),
      axes_(vehicle_axes(options.forward, options.up)),
      zones_(surfaces_of_body(field, options.zones, options.base, mirror_plane_from(options.symmetry).is_half())) {
    for (const Zone* zone : zones_) {
        widen(body_, box_of(*zone));
        if (matches(options.base, zone->name)) {
            widen(base_box_, box_of(*zone));
            has_base_ = true;
        }
    }
    core::Problems problems;
    mirror_ = mirror_of(options.symmetry, zones_, field, problems);
    for (const auto& problem : problems) {
        mirror_said_ += " Note: " + problem.message + ".";
    }
    if (mirror_.axis < 0) {
        find_symmetry_zone();
    }
    check_ranges(options, keys_of_ranges());
    name_ = options.case_name;
    if (name_.empty() && !field.files.empty()) {
        name_ = case_stem(field.files.front());
    }
}

std::vector<std::string> ViewComposer::possible() const {
    std::vector<std::string> names;
    for (const auto& kind : kinds()) {
        if ((this->*kind.possible)(kind.array)) {
            names.emplace_back(kind.name);
        }
    }
    return names;
}

ComposedView ViewComposer::compose(const std::string& name) const {
    const auto names = possible();
    if (std::find(names.begin(), names.end(), name) == names.end()) {
        throw core::InputError("view", "there is no view '" + name + "' of this field", {file(), {}, {}, {}},
                               core::did_you_mean(name, names));
    }
    const Kind& kind = *std::find_if(kinds().begin(), kinds().end(), [&](const Kind& k) { return k.name == name; });
    ComposedView composed = (this->*kind.compose)(kind.array);
    finish(composed, kind);
    return composed;
}

bool ViewComposer::on_underbody(const std::string& array) const { return on_hull(array) && has_base_; }

bool ViewComposer::on_hull(const std::string& array) const {
    return field_.dimension == 3 && !zones_.empty() && has_array(array);
}

bool ViewComposer::on_hull_alone(const std::string& array) const { return on_hull(array) && !has_base_; }

bool ViewComposer::in_volume(const std::string& array) const {
    return field_.dimension == 3 && !zones_.empty() && volume_has(array);
}

bool ViewComposer::in_gap(const std::string& array) const { return in_volume(array) && has_base_; }

bool ViewComposer::in_plane(const std::string& array) const { return field_.dimension == 2 && volume_has(array); }

namespace {

/// Is the array there, with a value somewhere? Of missing values alone there is nothing to show.
bool has_values(vtkDataSet& data, const std::string& name) {
    for (vtkDataSetAttributes* attributes : {static_cast<vtkDataSetAttributes*>(data.GetPointData()),
                                             static_cast<vtkDataSetAttributes*>(data.GetCellData())}) {
        auto* array = attributes->GetArray(name.c_str());
        for (vtkIdType i = 0; array != nullptr && i < array->GetNumberOfTuples(); ++i) {
            if (std::isfinite(array->GetComponent(i, 0))) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace

bool ViewComposer::has_array(const std::string& array) const {
    return std::any_of(zones_.begin(), zones_.end(),
                       [&](const Zone* zone) { return has_values(*zone->surface, array); });
}

bool ViewComposer::volume_has(const std::string& array) const {
    return std::any_of(field_.zones.begin(), field_.zones.end(),
                       [&](const Zone& zone) { return zone.volume != nullptr && has_values(*zone.volume, array); });
}

void ViewComposer::find_symmetry_zone() {
    int found = 0;
    for (const auto& zone : field_.zones) {
        if (zone.kind != ZoneKind::symmetry || zone.surface == nullptr || zone.surface->GetNumberOfPolys() == 0) {
            continue;
        }
        const Box box = box_of(zone);
        for (std::size_t k = 0; k < 3; ++k) {
            if (box[2 * k + 1] - box[2 * k] < 1e-6 * diagonal(box)) {
                symmetry_zone_ = {static_cast<int>(k), 0.5 * (box[2 * k] + box[2 * k + 1])};
                ++found;
            }
        }
    }
    if (found != 1) {  // several: nobody can tell which one is meant
        symmetry_zone_ = {};
    }
}

Point ViewComposer::base_centre() const {
    const Box& b = has_base_ ? base_box_ : body_;
    return {0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5])};
}

Box ViewComposer::whole_body() const {
    Box box = body_;
    if (mirror_.axis >= 0) {
        const auto k = static_cast<std::size_t>(mirror_.axis);
        const double reach = std::max(std::abs(box[2 * k] - mirror_.at), std::abs(box[2 * k + 1] - mirror_.at));
        box[2 * k] = mirror_.at - reach;
        box[2 * k + 1] = mirror_.at + reach;
    }
    return box;
}

Camera ViewComposer::from_below() const {
    Camera camera;
    camera.towards = axes_.up;
    camera.up = axes_.starboard;
    camera.box = options_.box;
    return camera;
}

const std::vector<std::string>& camera_names() {
    static const std::vector<std::string> names = {"bottom", "top", "side", "front", "iso"};
    return names;
}

NamedCamera named_camera(const std::string& name, const Point& forward, const Point& up) {
    const VehicleAxes axes = vehicle_axes(forward, up);
    const auto& f = axes.forward;
    const auto& s = axes.starboard;
    const auto& u = axes.up;
    const auto from = [](const Point& eye) { return Point{-eye[0], -eye[1], -eye[2]}; };
    if (name == "bottom") {
        return {u, s};
    }
    if (name == "top") {
        return {from(u), from(s)};
    }
    if (name == "side") {
        return {from(s), u};
    }
    if (name == "front") {
        return {from(f), u};
    }
    if (name == "iso") {
        const Point eye = plus(plus(f, s, 0.8), u, -0.45);
        const double length = std::sqrt(dot(eye, eye));
        return {{-eye[0] / length, -eye[1] / length, -eye[2] / length}, u};
    }
    throw core::UsageError("unknown", "there is no camera '" + name + "'", {},
                           core::did_you_mean(name, camera_names()));
}

void ViewComposer::take_camera(Scene& scene) const {
    if (options_.turned || !options_.camera.empty()) {
        const NamedCamera named =
            options_.turned ? *options_.turned : named_camera(options_.camera, options_.forward, options_.up);
        scene.camera.towards = named.towards;
        scene.camera.up = named.up;
    }
}

std::string ViewComposer::camera_said() const {
    const std::string& name = options_.camera;
    return options_.turned    ? "seen as it was turned by hand"
           : name == "bottom" ? "seen from below, bow to the right"
           : name == "top"    ? "seen from above, bow to the right"
           : name == "side"   ? "seen from starboard"
           : name == "front"  ? "seen from ahead"
                              : "seen from below the bow, starboard side";
}

void ViewComposer::finish(ComposedView& composed, const Kind& kind) const {
    Scene& scene = composed.scene;
    scene.subtitle = name_;
    scene.width = options_.width;
    scene.height = options_.height;
    scene.text_size = options_.text_size;
    scene.value_name = view_label(kind.array);
    scene.value_unit = view_unit(kind.array);
    const auto given = [&](const std::string& key) {
        return std::find_if(options_.ranges.rbegin(), options_.ranges.rend(),
                            [&](const auto& entry) { return range_key(entry.first) == key; });
    };
    auto range = given(kind.name);  // its own counts over its array's
    range = range == options_.ranges.rend() ? given(kind.array) : range;
    if (range != options_.ranges.rend() && scene.range != range->second) {
        composed.of_range = " Colours on the scale given for all pictures.";
        scene.range = range->second;
    }
    // A pressure on a scale about zero has two colours, so that suction and pressure are told apart.
    const bool about_zero = scene.range && scene.range->second > 0 &&
                            std::abs(scene.range->first + scene.range->second) <= 1e-9 * scene.range->second;
    if (about_zero && std::string_view(kind.array) == "pressure") {
        scene.colours = ColourMap::diverging;
    }
    if (scene.range) {
        scene.range = drawn_range(*scene.range, scene.colours);
    }
    composed.caption += composed.of_range + mirror_said_;
}

std::pair<double, double> robust_colour_range(std::vector<double> values, std::string& extremes,
                                              const std::string& unit) {
    if (values.empty()) {
        return range_of({});
    }
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    const double core_span = at(0.99) - at(0.01);
    double low = values.front();
    double high = values.back();
    if (at(0.01) - low > 0.25 * core_span) {
        low = at(0.01);
    }
    if (high - at(0.99) > 0.25 * core_span) {
        high = at(0.99);
    }
    const std::string lowest = core::format_number(values.front(), 4);
    const std::string highest = core::format_number(values.back(), 4);
    if (low != values.front() && high != values.back()) {
        extremes = " Colours end at the 1st and 99th percentile; the extremes are " + lowest + " and " + highest + " " +
                   unit + ".";
    } else if (low != values.front()) {
        extremes = " Colours begin at the 1st percentile; the lowest is " + lowest + " " + unit + ".";
    } else if (high != values.back()) {
        extremes = " Colours end at the 99th percentile; the highest is " + highest + " " + unit + ".";
    }
    return {low, high};
}

std::pair<double, double> range_of(const Scene& scene) {
    if (scene.range) {
        return *scene.range;
    }
    std::pair<double, double> range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto take = [&](const std::vector<double>& values) {
        for (const double v : values) {
            if (std::isfinite(v)) {
                range = {std::min(range.first, v), std::max(range.second, v)};
            }
        }
    };
    for (const auto& surface : scene.surfaces) {
        take(surface.values);
    }
    for (const auto& line : scene.lines) {
        take(line.values);
    }
    return range;
}

}  // namespace underbody::postproc
