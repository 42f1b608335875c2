#include "postproc/views.h"

#include <vtkCellData.h>
#include <vtkPointData.h>
#include <vtkStaticCellLocator.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>

#include "core/text.h"
#include "postproc/colours.h"
#include "postproc/loads.h"
#include "postproc/mirror_plane.h"
#include "postproc/stated_loads.h"
#include "postproc/vector_math.h"
#include "postproc/view_parts.h"

namespace underbody::postproc {

namespace {

/// A scene with what is said about it.
struct Composed {
    Scene scene;
    std::string caption;
};

class Composer {
public:
    Composer(const Field& field, const ViewOptions& options) : field_(field), options_(options), zones_(body_zones(field, options.zones)) {
        starboard_ = cross(options.forward, options.up);
        body_ = empty_box();
        base_box_ = empty_box();
        for (const Zone* zone : zones_) {
            if (matches(options.base, zone->name)) {
                widen(base_box_, box_of(*zone));
                has_base_ = true;
            }
        }
        if (options.zones.empty()) {  // a ground is a wall too, but it would hide the body
            std::erase_if(zones_, [&](const Zone* zone) { return !near_body(*zone); });
        }
        for (const Zone* zone : zones_) {
            widen(body_, box_of(*zone));
        }
        find_mirror();
        name_ = options.case_name;
        if (name_.empty() && !field.files.empty()) {
            name_ = case_stem(field.files.front());
        }
    }

    [[nodiscard]] std::vector<std::string> possible() const {
        std::vector<std::string> names;
        if (field_.dimension == 2) {
            if (volume_has("pressure")) {
                names.emplace_back("pressure-plane");
            }
            if (volume_has("velocity")) {
                names.emplace_back("speed-plane");
            }
            return names;
        }
        if (!zones_.empty() && has_array("pressure")) {
            if (has_base_) {
                names.emplace_back("pressure-underbody");
            }
            names.emplace_back("pressure-hull");
        }
        if (!zones_.empty() && has_array("wall_shear")) {
            names.emplace_back("shear-underbody");
        }
        if (volume_has("pressure") && !zones_.empty()) {
            names.emplace_back("pressure-symmetry");
        }
        if (volume_has("velocity") && !zones_.empty()) {
            names.emplace_back("speed-symmetry");
            if (has_base_) {
                names.emplace_back("streamlines-gap");
            }
        }
        return names;
    }

    [[nodiscard]] Composed compose(const std::string& name) const {
        const auto names = possible();
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            throw core::InputError("view", "there is no view '" + name + "' of this field", {field_.files.empty() ? "" : field_.files.front(), {}, {}, {}},
                                   core::did_you_mean(name, names));
        }
        Composed composed = name == "pressure-underbody"   ? surface_view("pressure", true)
                            : name == "shear-underbody"    ? surface_view("wall_shear", true)
                            : name == "pressure-hull"      ? surface_view("pressure", false)
                            : name == "pressure-symmetry"  ? symmetry_view("pressure")
                            : name == "speed-symmetry"     ? symmetry_view("velocity")
                            : name == "pressure-plane"     ? plane_view("pressure")
                            : name == "speed-plane"        ? plane_view("velocity")
                                                           : gap_view();
        finish(composed, name);
        return composed;
    }

    [[nodiscard]] const Box& body() const { return body_; }
    [[nodiscard]] const std::vector<const Zone*>& zones() const { return zones_; }
    [[nodiscard]] const ViewMirror& mirror() const { return mirror_; }
    [[nodiscard]] Point base_centre() const {
        const Box& b = has_base_ ? base_box_ : body_;
        return {0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5])};
    }
    [[nodiscard]] const std::string& case_name() const { return name_; }

    /// From below, nose to the right.
    [[nodiscard]] Camera from_below() const {
        Camera camera;
        camera.towards = options_.up;
        camera.up = starboard_;
        camera.box = options_.box;
        return camera;
    }

private:
    void find_mirror() {
        const MirrorPlane plane = mirror_plane_from(options_.symmetry);
        mirror_.axis = plane.axis;
        if (plane.at) {
            mirror_.at = *plane.at;
        } else if (plane.is_half() && !zones_.empty()) {
            const double low = body_[static_cast<std::size_t>(2 * mirror_.axis)];
            const double high = body_[static_cast<std::size_t>(2 * mirror_.axis + 1)];
            mirror_.at = std::abs(low) < std::abs(high) ? low : high;
        }
    }

    [[nodiscard]] bool has_array(const std::string& array) const {
        return std::any_of(zones_.begin(), zones_.end(), [&](const Zone* z) {
            return z->surface->GetPointData()->HasArray(array.c_str()) != 0 || z->surface->GetCellData()->HasArray(array.c_str()) != 0;
        });
    }
    [[nodiscard]] bool volume_has(const std::string& array) const {
        return std::any_of(field_.zones.begin(), field_.zones.end(), [&](const Zone& z) {
            return z.volume != nullptr && (z.volume->GetPointData()->HasArray(array.c_str()) != 0 || z.volume->GetCellData()->HasArray(array.c_str()) != 0);
        });
    }

    [[nodiscard]] static std::string label(const std::string& array) { return array == "wall_shear" ? "wall shear" : array == "velocity" ? "speed" : array; }
    [[nodiscard]] static std::string unit(const std::string& array) { return array == "velocity" ? "m/s" : "Pa"; }

    [[nodiscard]] Composed surface_view(const std::string& array, bool below) const {
        Composed composed;
        Scene& scene = composed.scene;
        std::vector<double> values;
        for (const Zone* zone : zones_) {
            DrawnSurface surface = drawn_surface(*zone, array);
            if (!below || !has_base_ || matches(options_.base, zone->name)) {
                std::copy_if(surface.values.begin(), surface.values.end(), std::back_inserter(values), [](double v) { return std::isfinite(v); });
            }
            surface.contours = 12;
            mirror_into(surface, mirror_);
            scene.surfaces.push_back(std::move(surface));
        }
        std::string extremes;
        scene.range = telling_range(values, extremes, unit(array));
        scene.value_name = label(array);
        scene.value_unit = unit(array);
        scene.camera = below ? from_below() : from_bow();
        scene.title = scene.value_name + (below ? " on the underbody" : " on the hull");
        composed.caption = below ? "Seen from below, bow to the right." : "Seen from above the bow, port side.";
        composed.caption += extremes;
        return composed;
    }

public:
    /// The range that holds 98 % of the values where a few extremes (an edge, a stagnation point) would swallow the
    /// colours; they are named instead.
    [[nodiscard]] static std::pair<double, double> telling_range(std::vector<double> values, std::string& extremes, const std::string& unit) {
        if (values.empty()) {
            return {0, 1};
        }
        std::sort(values.begin(), values.end());
        const auto at = [&](double share) { return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]; };
        const double core_span = at(0.99) - at(0.01);
        double low = values.front();
        double high = values.back();
        if (at(0.01) - low > 0.25 * core_span) {
            low = at(0.01);
        }
        if (high - at(0.99) > 0.25 * core_span) {
            high = at(0.99);
        }
        if (low != values.front() || high != values.back()) {
            extremes = " Colours end at the 1st and 99th percentile; the extremes are " + core::format_number(values.front(), 4) + " and " +
                       core::format_number(values.back(), 4) + " " + unit + ".";
        }
        return {low, high};
    }

private:
    [[nodiscard]] Camera from_bow() const {
        Camera camera;
        const Point eye = plus(plus(options_.forward, starboard_, -0.9), options_.up, 0.55);
        camera.towards = {-eye[0], -eye[1], -eye[2]};
        camera.up = options_.up;
        camera.box = options_.box;
        return camera;
    }

    /// The side from which the body's middle plane is looked at, and the plane.
    [[nodiscard]] std::pair<Point, Point> middle_plane() const {
        Point normal = {-starboard_[0], -starboard_[1], -starboard_[2]};
        Point through = base_centre();
        if (mirror_.axis >= 0) {
            const auto k = static_cast<std::size_t>(mirror_.axis);
            const double inside = 0.5 * (body_[2 * k] + body_[2 * k + 1]) > mirror_.at ? 1 : -1;
            normal = {0, 0, 0};
            normal[k] = inside;
            through[k] = mirror_.at + inside * 1e-5 * diagonal(body_);  // just inside the cells
        }
        return {through, normal};
    }

    /// A two-dimensional case as it lies: x to the right, y up, about its walls where these are small in it.
    [[nodiscard]] Composed plane_view(const std::string& array) const {
        Composed composed;
        Scene& scene = composed.scene;
        DrawnSurface plane = plane_cells(*volume_with(field_, {array}), array);
        if (plane.triangles.empty()) {
            throw core::InputError("view", "the plane case has no cells to draw", {field_.files.front(), {}, {}, {}});
        }
        Box all = empty_box();
        for (const auto& p : plane.points) {
            widen(all, p);
        }
        Box walls = empty_box();
        for (const auto& zone : field_.zones) {
            if (zone.kind == ZoneKind::wall && zone.surface != nullptr && zone.surface->GetNumberOfPoints() > 0) {
                widen(walls, box_of(zone));
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
        scene.value_name = label(array);
        scene.value_unit = unit(array);
        scene.camera.towards = {0, 0, -1};
        scene.camera.up = {0, 1, 0};
        scene.camera.box = options_.box.value_or(box);
        scene.title = scene.value_name + " in the plane";
        composed.caption = box == all ? "The whole plane of a two-dimensional case." : "A two-dimensional case, about its walls.";
        return composed;
    }

    [[nodiscard]] Composed symmetry_view(const std::string& array) const {
        Composed composed;
        Scene& scene = composed.scene;
        const auto volume = volume_with(field_, {array});
        const auto [through, normal] = middle_plane();
        DrawnSurface plane = cut(*volume, through, normal, array);
        if (plane.triangles.empty()) {
            throw core::InputError("view", "the middle plane does not meet the volume", {field_.files.front(), {}, {}, {}}, "for a half model give its symmetry plane");
        }
        const Box box = surroundings(plane);
        scene.range = range_within(plane, box);
        plane.contours = 14;
        scene.surfaces.push_back(std::move(plane));
        for (const Zone* zone : zones_) {
            if (near_body(*zone)) {
                DrawnSurface body = drawn_surface(*zone, "");
                body.colour = {0.80, 0.81, 0.83};
                body.smooth = false;
                scene.surfaces.push_back(std::move(body));
            }
        }
        scene.value_name = label(array);
        scene.value_unit = unit(array);
        scene.camera.towards = normal;
        scene.camera.up = options_.up;
        scene.camera.box = box;
        scene.title = scene.value_name + " in the symmetry plane";
        composed.caption = "The plane through the middle of the body; the body in grey.";
        return composed;
    }

    /// Walls that are far larger than the base (a ground) are no part of the body in a picture of its surroundings.
    [[nodiscard]] bool near_body(const Zone& zone) const {
        if (!has_base_) {
            return true;
        }
        return diagonal(box_of(zone)) < 4 * diagonal(base_box_);
    }
    [[nodiscard]] static Box box_of(const Zone& zone) {
        Box box{};
        zone.surface->GetBounds(box.data());
        return box;
    }

    [[nodiscard]] Box body_without_ground() const {
        Box box = empty_box();
        for (const Zone* zone : zones_) {
            if (near_body(*zone)) {
                widen(box, box_of(*zone));
            }
        }
        return box;
    }

public:
    /// Both halves of the body, without a ground.
    [[nodiscard]] Box whole_body() const {
        Box box = body_without_ground();
        if (mirror_.axis >= 0) {
            const auto k = static_cast<std::size_t>(mirror_.axis);
            const double reach = std::max(std::abs(box[2 * k] - mirror_.at), std::abs(box[2 * k + 1] - mirror_.at));
            box[2 * k] = mirror_.at - reach;
            box[2 * k + 1] = mirror_.at + reach;
        }
        return box;
    }

private:
    /// The body with some room, not beyond what there is.
    [[nodiscard]] Box surroundings(const DrawnSurface& plane) const {
        Box box = options_.box.value_or(body_without_ground());
        const double length = diagonal(box);
        Box all = empty_box();
        for (const auto& p : plane.points) {
            widen(all, p);
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const double share = std::abs(options_.forward[k]) > 0.5 ? 0.30 : std::abs(options_.up[k]) > 0.5 ? 0.30 : 0;
            box[2 * k] = std::max(box[2 * k] - share * length, std::min(all[2 * k], box[2 * k]));
            box[2 * k + 1] = std::min(box[2 * k + 1] + share * length, std::max(all[2 * k + 1], box[2 * k + 1]));
        }
        return box;
    }

    [[nodiscard]] static std::pair<double, double> range_within(const DrawnSurface& surface, const Box& box) {
        std::pair<double, double> range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
        for (std::size_t i = 0; i < surface.values.size(); ++i) {
            const Point& p = surface.points[i];
            bool inside = std::isfinite(surface.values[i]);
            for (std::size_t k = 0; k < 3; ++k) {
                const double slack = 0.02 * diagonal(box);
                inside = inside && p[k] >= box[2 * k] - slack && p[k] <= box[2 * k + 1] + slack;
            }
            if (inside) {
                range = {std::min(range.first, surface.values[i]), std::max(range.second, surface.values[i])};
            }
        }
        return range;
    }

    [[nodiscard]] Composed gap_view() const {
        Composed composed;
        Scene& scene = composed.scene;
        const auto volume = volume_with(field_, {"velocity"});
        Box all{};
        volume->GetBounds(all.data());
        const Point centre = base_centre();
        double ground = std::numeric_limits<double>::infinity();
        for (int corner = 0; corner < 8; ++corner) {
            ground = std::min(ground, dot({all[static_cast<std::size_t>(corner & 1)], all[static_cast<std::size_t>(2 + ((corner >> 1) & 1))],
                                           all[static_cast<std::size_t>(4 + ((corner >> 2) & 1))]}, options_.up));
        }
        const double gap = dot(centre, options_.up) - ground;
        std::vector<Point> seeds;
        const double half_length = 0.5 * extent(base_box_, options_.forward);
        const double width = extent(base_box_, starboard_) * (mirror_.axis >= 0 ? 1.0 : 0.5);
        const Point middle = plus(on_mirror(centre), options_.up, -0.5 * gap);
        const Point side = mirror_.axis >= 0 ? middle_plane().second : starboard_;
        // A line across the middle of the base, and one across its tail for the water that comes in from the sides.
        for (const auto& [station, across] : {std::pair{0.0, 22}, std::pair{-0.6, 7}}) {
            for (int i = 0; i < across; ++i) {
                const double share = station < 0 ? 0.75 + 0.3 * (i + 0.5) / across : (i + 0.5) / across;
                seeds.push_back(plus(plus(middle, options_.forward, station * half_length), side, share * width));
                if (mirror_.axis < 0) {
                    seeds.push_back(plus(plus(middle, options_.forward, station * half_length), side, -share * width));
                }
            }
        }
        for (auto& line : streamlines(*volume, seeds, 3 * diagonal(base_box_), mirror_)) {
            line.width = 2;
            if (mirror_.axis >= 0) {
                scene.lines.push_back(mirrored(line, mirror_));
            }
            scene.lines.push_back(std::move(line));
        }
        for (const Zone* zone : zones_) {
            if (near_body(*zone)) {
                DrawnSurface body = drawn_surface(*zone, "");
                const bool base = matches(options_.base, zone->name);
                body.colour = base ? Point{0.88, 0.89, 0.91} : Point{0.76, 0.78, 0.81};
                mirror_into(body, mirror_);
                scene.surfaces.push_back(std::move(body));
            }
        }
        scene.value_name = "speed";
        scene.value_unit = "m/s";
        scene.camera = from_below();
        scene.camera.box = options_.box.value_or(whole_body());
        scene.camera.zoom = 0.98;
        scene.title = "streamlines in the gap";
        composed.caption = "Through the middle of the gap (" + core::format_number(1000 * gap, 3) + " mm at the centre of the base), seen from below, bow to the right.";
        return composed;
    }

    [[nodiscard]] static double extent(const Box& box, const Point& axis) {
        return std::abs(axis[0]) * (box[1] - box[0]) + std::abs(axis[1]) * (box[3] - box[2]) + std::abs(axis[2]) * (box[5] - box[4]);
    }
    [[nodiscard]] Point on_mirror(Point p) const {
        if (mirror_.axis >= 0) {
            p[static_cast<std::size_t>(mirror_.axis)] = mirror_.at;
        }
        return p;
    }

    void finish(Composed& composed, const std::string& name) const {
        Scene& scene = composed.scene;
        scene.subtitle = name_;
        scene.width = options_.width;
        scene.height = options_.height;
        const std::string array = name.substr(0, name.find('-'));
        bool shared = false;
        const auto own = scene.range;
        for (const auto& [key, range] : options_.ranges) {
            if (key == name || (key == array && !shared) || (key == "velocity" && array == "speed" && !shared)) {
                scene.range = range;
                shared = shared || key == name;
            }
        }
        if (scene.range != own) {  // what was said of a range of its own holds no more
            if (const auto at = composed.caption.find(" Colours end at"); at != std::string::npos) {
                composed.caption.resize(at);
            }
            composed.caption += " Colours over the range given.";
        }
        if (scene.range) {
            scene.range = drawn_range(*scene.range, scene.colours);
        }
    }

    const Field& field_;
    const ViewOptions& options_;
    std::vector<const Zone*> zones_;
    Point starboard_{};
    Box body_{};
    Box base_box_{};
    bool has_base_ = false;
    ViewMirror mirror_;
    std::string name_;
};

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

View drawn(Composed composed, const std::string& name) {
    View view;
    view.name = name;
    view.title = composed.scene.title;
    view.range = range_of(composed.scene);
    view.caption = composed.caption + " Colours: " + composed.scene.value_name + " from " + core::format_number(view.range.first, 4) + " to " +
                   core::format_number(view.range.second, 4) + " " + composed.scene.value_unit + ".";
    view.png = draw_png(composed.scene);
    return view;
}

}  // namespace

std::vector<std::string> possible_views(const Field& field, const ViewOptions& options) { return Composer(field, options).possible(); }

View view(const Field& field, const std::string& name, const ViewOptions& options, core::Progress& progress) {
    progress.check();
    return drawn(Composer(field, options).compose(name), name);
}

std::vector<View> views(const Field& field, const ViewOptions& options, core::Progress& progress) {
    const Composer composer(field, options);
    const auto names = composer.possible();
    if (names.empty()) {
        throw core::InputError("view", "the field has no surface with a pressure to draw, nor a plane of cells with one", {field.files.empty() ? "" : field.files.front(), {}, {}, {}});
    }
    std::vector<View> result;
    for (std::size_t i = 0; i < names.size(); ++i) {
        progress.check();
        progress.report(static_cast<double>(i) / static_cast<double>(names.size()), "drawing " + names[i]);
        result.push_back(drawn(composer.compose(names[i]), names[i]));
    }
    return result;
}

ViewOptions shared_view_options(const std::vector<const Field*>& fields, const ViewOptions& options, core::Progress& progress) {
    ViewOptions shared = options;
    shared.ranges.clear();
    Box box = empty_box();
    for (const Field* field : fields) {
        ViewOptions own = options;
        own.ranges.clear();
        const Composer composer(*field, own);
        widen(box, composer.whole_body());
        for (const auto& name : composer.possible()) {
            progress.check();
            const auto range = range_of(composer.compose(name).scene);
            const auto found = std::find_if(shared.ranges.begin(), shared.ranges.end(), [&](const auto& entry) { return entry.first == name; });
            if (found == shared.ranges.end()) {
                shared.ranges.emplace_back(name, range);
            } else {
                found->second = {std::min(found->second.first, range.first), std::max(found->second.second, range.second)};
            }
        }
    }
    if (!options.box && box[0] <= box[1]) {
        shared.box = box;
    }
    for (const auto& given : options.ranges) {  // what the caller fixed stays
        std::erase_if(shared.ranges, [&](const auto& entry) { return entry.first == given.first || entry.first.starts_with(given.first + "-"); });
        shared.ranges.push_back(given);
    }
    return shared;
}

// ---- difference of two cases ----

namespace {

/// A surface to look values up on, from all body zones of a field, moved by `shift`.
class Lookup {
public:
    Lookup(const std::vector<const Zone*>& zones, const std::string& array, const Point& shift) {
        vtkNew<vtkPoints> points;
        vtkNew<vtkCellArray> cells;
        for (const Zone* zone : zones) {
            const DrawnSurface surface = drawn_surface(*zone, array);
            if (surface.values.empty()) {
                continue;
            }
            const vtkIdType first = points->GetNumberOfPoints();
            for (std::size_t i = 0; i < surface.points.size(); ++i) {
                const Point p = plus(surface.points[i], shift);
                points->InsertNextPoint(p.data());
                values_.push_back(surface.values[i]);
            }
            for (const auto& [a, b, c] : surface.triangles) {
                cells->InsertNextCell({first + a, first + b, first + c});
            }
        }
        data_->SetPoints(points);
        data_->SetPolys(cells);
        if (data_->GetNumberOfCells() > 0) {
            locator_->SetDataSet(data_);
            locator_->BuildLocator();
        }
    }

    [[nodiscard]] bool empty() const { return data_->GetNumberOfCells() == 0; }

    /// Value at the nearest place; the distance to it goes out.
    double at(const Point& p, double& distance) {
        double nearest[3];
        vtkIdType cell = -1;
        int sub = 0;
        double square = 0;
        locator_->FindClosestPoint(p.data(), nearest, cell, sub, square);
        distance = std::sqrt(square);
        vtkNew<vtkIdList> ids;
        data_->GetCellPoints(cell, ids);
        std::array<Point, 3> x{};
        for (int i = 0; i < 3; ++i) {
            data_->GetPoint(ids->GetId(i), x[static_cast<std::size_t>(i)].data());
        }
        const Point q = {nearest[0], nearest[1], nearest[2]};
        const Point normal = cross(plus(x[1], x[0], -1), plus(x[2], x[0], -1));
        const double area = dot(normal, normal);
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point part = cross(plus(x[(i + 1) % 3], q, -1), plus(x[(i + 2) % 3], q, -1));
            const double weight = area > 0 ? dot(part, normal) / area : 1.0 / 3;
            sum += weight * values_[static_cast<std::size_t>(ids->GetId(static_cast<vtkIdType>(i)))];
        }
        return sum;
    }

private:
    vtkNew<vtkPolyData> data_;
    vtkNew<vtkStaticCellLocator> locator_;
    std::vector<double> values_;
};

}  // namespace

View difference_view(const Field& a, const Field& b, const std::string& array, const ViewOptions& options, core::Progress& progress) {
    ViewOptions named = options;
    named.case_name.clear();
    const Composer from(a, named);
    const Composer to(b, named);
    const Point shift = plus(to.base_centre(), from.base_centre(), -1);
    std::vector<std::pair<std::string, std::unique_ptr<Lookup>>> lookups;
    for (const Zone* zone : from.zones()) {
        lookups.emplace_back(zone->name, std::make_unique<Lookup>(std::vector<const Zone*>{zone}, array, shift));
    }
    Lookup everywhere(from.zones(), array, shift);
    Composed composed;
    double furthest = 0;
    std::vector<double> on_base;
    for (const Zone* zone : to.zones()) {
        progress.check();
        DrawnSurface surface = drawn_surface(*zone, array);
        // Zones of one name are compared with each other: at an edge two zones have different values at one place.
        const auto same = std::find_if(lookups.begin(), lookups.end(), [&](const auto& entry) { return entry.first == zone->name; });
        Lookup& lookup = same == lookups.end() ? everywhere : *same->second;
        if (surface.values.empty() || lookup.empty()) {
            throw core::InputError("missing", "'" + array + "' is not on the surface of both cases", {b.files.empty() ? "" : b.files.front(), {}, {}, {}});
        }
        for (std::size_t i = 0; i < surface.points.size(); ++i) {
            double distance = 0;
            surface.values[i] -= lookup.at(surface.points[i], distance);
            furthest = std::max(furthest, distance);
            if (matches(options.base, zone->name)) {
                on_base.push_back(surface.values[i]);
            }
        }
        surface.contours = 12;
        mirror_into(surface, to.mirror());
        composed.scene.surfaces.push_back(std::move(surface));
    }
    Scene& scene = composed.scene;
    scene.colours = ColourMap::diverging;
    std::string extremes;
    if (!on_base.empty()) {
        scene.range = Composer::telling_range(on_base, extremes, "Pa");
    }
    for (const auto& [key, given] : options.ranges) {
        if (key == "difference" || key == "difference-" + array) {
            scene.range = given;
        }
    }
    scene.range = drawn_range(range_of(scene), scene.colours);
    scene.value_name = array == "pressure" ? "difference" : "difference of " + array;
    scene.value_unit = "Pa";
    if (const auto* info = to.zones().front()->find(array)) {
        scene.value_unit = info->unit;
    }
    scene.camera = to.from_below();
    scene.title = "difference of " + array + " on the underbody";
    scene.subtitle = options.case_name.empty() ? to.case_name() + "  minus  " + from.case_name() : options.case_name;
    scene.width = options.width;
    scene.height = options.height;
    composed.caption = "The second case less the first, seen from below, bow to the right; the first was moved by (" + core::format_number(1000 * shift[0], 3) + ", " +
                       core::format_number(1000 * shift[1], 3) + ", " + core::format_number(1000 * shift[2], 3) +
                       ") mm so that the bases lie on each other; the surfaces then lie at most " + core::format_number(1000 * furthest, 2) + " mm apart." + extremes;
    return drawn(std::move(composed), "difference-" + array);
}

}  // namespace underbody::postproc
