// Each kind of view: what is in it, its colours, where the camera stands.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/text.h"
#include "postproc/field/vector_math.h"
#include "postproc/views/view_composer.h"

namespace underbody::postproc {

namespace {

double extent(const Box& box, const Point& axis) {
    return std::abs(axis[0]) * (box[1] - box[0]) + std::abs(axis[1]) * (box[3] - box[2]) +
           std::abs(axis[2]) * (box[5] - box[4]);
}

Box box_of(const DrawnSurface& surface) {
    Box box = empty_box();
    for (const auto& p : surface.points) {
        widen(box, p);
    }
    return box;
}

std::pair<double, double> range_within(const DrawnSurface& surface, const Box& box) {
    std::pair<double, double> range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const double slack = 0.02 * diagonal(box);
    for (std::size_t i = 0; i < surface.values.size(); ++i) {
        const Point& p = surface.points[i];
        bool inside = std::isfinite(surface.values[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            inside = inside && p[k] >= box[2 * k] - slack && p[k] <= box[2 * k + 1] + slack;
        }
        if (inside) {
            range = {std::min(range.first, surface.values[i]), std::max(range.second, surface.values[i])};
        }
    }
    return range;
}

/// The part of a surface in one colour on the side that `normal` looks to: what lies before it would hide the cut.
DrawnSurface behind(const DrawnSurface& surface, const Point& through, const Point& normal) {
    DrawnSurface part = surface;
    part.triangles.clear();
    const auto height = [&](const Point& p) { return dot(plus(p, through, -1), normal); };
    for (const auto& triangle : surface.triangles) {
        std::vector<int> kept;
        for (std::size_t i = 0; i < 3; ++i) {
            const int a = triangle[i];
            const int b = triangle[(i + 1) % 3];
            const Point from = part.points[static_cast<std::size_t>(a)];
            const Point to = part.points[static_cast<std::size_t>(b)];
            const double ha = height(from);
            const double hb = height(to);
            if (ha >= 0) {
                kept.push_back(a);
            }
            if ((ha < 0) != (hb < 0)) {
                kept.push_back(static_cast<int>(part.points.size()));
                part.points.push_back(plus(from, plus(to, from, -1), ha / (ha - hb)));
            }
        }
        for (std::size_t i = 1; i + 1 < kept.size(); ++i) {
            part.triangles.push_back({kept[0], kept[i], kept[i + 1]});
        }
    }
    return part;
}

}  // namespace

ComposedView ViewComposer::underbody_view(const std::string& array) const {
    ComposedView composed = surface_view(array, true);
    composed.scene.camera = from_below();
    take_camera(composed.scene);
    composed.scene.title = view_label(array) + " on the underbody";
    composed.caption =
        (options_.camera.empty() ? "Seen from below, bow to the right." : "The body, " + camera_said() + ".") +
        composed.caption;
    return composed;
}

ComposedView ViewComposer::hull_view(const std::string& array) const {
    ComposedView composed = surface_view(array, false);
    const Point eye = plus(plus(axes_.forward, axes_.starboard, -0.9), axes_.up, 0.55);
    composed.scene.camera.towards = {-eye[0], -eye[1], -eye[2]};
    composed.scene.camera.up = axes_.up;
    composed.scene.camera.box = options_.box;
    take_camera(composed.scene);
    composed.scene.title = view_label(array) + " on the hull";
    composed.caption =
        (options_.camera.empty() ? "Seen from above the bow, port side." : "The body, " + camera_said() + ".") +
        composed.caption;
    return composed;
}

/// The body's surface; `base_range`: the colours are those of the base, where it has the array, whatever the rest has.
ComposedView ViewComposer::surface_view(const std::string& array, bool base_range) const {
    ComposedView composed;
    std::vector<double> of_base;
    std::vector<double> of_rest;
    for (const Zone* zone : zones_) {
        DrawnSurface surface = drawn_surface(*zone, array);
        std::vector<double>& values = matches(options_.base, zone->name) ? of_base : of_rest;
        std::copy_if(surface.values.begin(), surface.values.end(), std::back_inserter(values),
                     [](double v) { return std::isfinite(v); });
        surface.contours = 12;
        mirror_into(surface, mirror_);
        composed.scene.surfaces.push_back(std::move(surface));
    }
    if (base_range && of_base.empty()) {
        composed.caption = " The base has no " + view_label(array) + ": the colours are those of the rest.";
    }
    if (!base_range || of_base.empty()) {
        of_base.insert(of_base.end(), of_rest.begin(), of_rest.end());
    }
    composed.scene.range = robust_colour_range(std::move(of_base), composed.of_range, view_unit(array));
    return composed;
}

/// A two-dimensional case as it lies: x to the right, y up, about its walls where these are small in it.
ComposedView ViewComposer::plane_view(const std::string& array) const {
    ComposedView composed;
    Scene& scene = composed.scene;
    DrawnSurface plane = plane_cells(*volume_with(field_, {array}), array);
    if (plane.triangles.empty()) {
        throw core::InputError("view", "the plane case has no cells to draw", {file(), {}, {}, {}});
    }
    const Box all = box_of(plane);
    Box walls = empty_box();
    for (const auto& zone : field_.zones) {
        if (zone.kind == ZoneKind::wall && zone.surface != nullptr && zone.surface->GetNumberOfPoints() > 0) {
            Box one{};
            zone.surface->GetBounds(one.data());
            widen(walls, one);
        }
    }
    Box box = all;
    const double room = 1.5 * diagonal(walls);
    for (std::size_t k = 0; k < 2 && walls[0] <= walls[1]; ++k) {
        box[2 * k] = std::max(all[2 * k], walls[2 * k] - room);
        box[2 * k + 1] = std::min(all[2 * k + 1], walls[2 * k + 1] + room);
    }
    scene.range = range_within(plane, box);
    plane.contours = 14;
    scene.surfaces.push_back(std::move(plane));
    scene.camera.towards = {0, 0, -1};
    scene.camera.up = {0, 1, 0};
    scene.camera.box = options_.box.value_or(box);
    scene.title = view_label(array) + " in the plane";
    composed.caption =
        box == all ? "The whole plane of a two-dimensional case." : "A two-dimensional case, about its walls.";
    return composed;
}

/// A point of the plane through the middle of the body, and the direction in which one looks at it.
std::pair<Point, Point> ViewComposer::middle_plane() const {
    const PlacedMirror& plane = mirror_.axis >= 0 ? mirror_ : symmetry_zone_;
    Point through = base_centre();
    if (plane.axis < 0) {
        return {through, {-axes_.starboard[0], -axes_.starboard[1], -axes_.starboard[2]}};
    }
    const auto k = static_cast<std::size_t>(plane.axis);
    const double inside = 0.5 * (body_[2 * k] + body_[2 * k + 1]) > plane.at ? 1 : -1;
    through[k] = plane.at + inside * 1e-5 * diagonal(body_);  // just inside the cells
    Point normal{};
    normal[k] = inside;
    return {through, normal};
}

ComposedView ViewComposer::symmetry_view(const std::string& array) const {
    ComposedView composed;
    Scene& scene = composed.scene;
    const auto [through, normal] = middle_plane();
    DrawnSurface plane = cut(*volume_with(field_, {array}), through, normal, array);
    if (plane.triangles.empty()) {
        throw core::InputError("view", "the middle plane does not meet the volume", {file(), {}, {}, {}},
                               "for a half model give its symmetry plane");
    }
    const Box box = surroundings(plane);
    scene.range = range_within(plane, box);
    plane.contours = 14;
    scene.surfaces.push_back(std::move(plane));
    for (const Zone* zone : zones_) {
        DrawnSurface body = behind(drawn_surface(*zone, ""), through, normal);
        body.colour = {0.80, 0.81, 0.83};
        body.smooth = false;
        scene.surfaces.push_back(std::move(body));
    }
    scene.camera.towards = normal;
    scene.camera.up = axes_.up;
    scene.camera.box = box;
    const bool symmetry = mirror_.axis >= 0 || symmetry_zone_.axis >= 0;
    scene.title = view_label(array) + (symmetry ? " in the symmetry plane" : " in the middle plane");
    composed.caption = std::string(symmetry ? "The symmetry plane" : "The plane through the middle of the body") +
                       "; what lies behind it of the body in grey.";
    return composed;
}

/// The body with some room, not beyond what there is.
Box ViewComposer::surroundings(const DrawnSurface& plane) const {
    Box box = options_.box.value_or(body_);
    const double length = diagonal(box);
    const Box all = box_of(plane);
    for (std::size_t k = 0; k < 3; ++k) {
        const double share = std::abs(axes_.forward[k]) > 0.5 || std::abs(axes_.up[k]) > 0.5 ? 0.30 : 0;
        box[2 * k] = std::max(box[2 * k] - share * length, std::min(all[2 * k], box[2 * k]));
        box[2 * k + 1] = std::min(box[2 * k + 1] + share * length, std::max(all[2 * k + 1], box[2 * k + 1]));
    }
    return box;
}

/// A line across the middle of the base, and one across its tail for the water that comes in from the sides, half-way
/// between ground and base.
std::vector<Point> ViewComposer::gap_seeds(double gap) const {
    const bool half = mirror_.axis >= 0;
    const double half_length = 0.5 * extent(base_box_, axes_.forward);
    const double width = extent(base_box_, axes_.starboard) * (half ? 1.0 : 0.5);
    Point middle = plus(base_centre(), axes_.up, -0.5 * gap);
    if (half) {
        middle[static_cast<std::size_t>(mirror_.axis)] = mirror_.at;
    }
    const Point side = half ? middle_plane().second : axes_.starboard;
    std::vector<Point> seeds;
    for (const auto& [station, across] : {std::pair{0.0, 22}, std::pair{-0.6, 7}}) {
        for (int i = 0; i < across; ++i) {
            const double share = station < 0 ? 0.75 + 0.3 * (i + 0.5) / across : (i + 0.5) / across;
            const Point at = plus(middle, axes_.forward, station * half_length);
            seeds.push_back(plus(at, side, share * width));
            if (!half) {
                seeds.push_back(plus(at, side, -share * width));
            }
        }
    }
    return seeds;
}

ComposedView ViewComposer::gap_view(const std::string& array) const {
    ComposedView composed;
    Scene& scene = composed.scene;
    const auto volume = volume_with(field_, {array});
    const double gap = dot(base_centre(), axes_.up) - lowest(*volume, axes_.up);
    for (auto& line : streamlines(*volume, gap_seeds(gap), 3 * diagonal(base_box_), mirror_)) {
        line.width = 2;
        if (mirror_.axis >= 0) {
            scene.lines.push_back(mirrored(line, mirror_));
        }
        scene.lines.push_back(std::move(line));
    }
    for (const Zone* zone : zones_) {
        DrawnSurface body = drawn_surface(*zone, "");
        const double middle = dot(base_centre(), axes_.up) - 0.5 * gap;
        if (std::all_of(body.points.begin(), body.points.end(),
                        [&](const Point& p) { return dot(p, axes_.up) < middle; })) {
            continue;  // a ground that was named would hide the gap
        }
        const bool base = matches(options_.base, zone->name);
        body.colour = base ? Point{0.88, 0.89, 0.91} : Point{0.76, 0.78, 0.81};
        mirror_into(body, mirror_);
        scene.surfaces.push_back(std::move(body));
    }
    scene.camera = from_below();
    scene.camera.box = options_.box.value_or(whole_body());
    scene.camera.zoom = 0.98;
    scene.title = "streamlines in the gap";
    composed.caption = "Through the middle of the gap (" + core::format_number(1000 * gap, 3) +
                       " mm at the centre of the base), seen from below, bow to the right.";
    return composed;
}

}  // namespace underbody::postproc
