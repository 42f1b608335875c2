// What a placement looks like: angles of contact, area against height, map of the gap.
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/angle.h"
#include "core/text.h"
#include "geometry/water/placement.h"

namespace underbody::geometry {

namespace {

using core::degree;

// The smallest positive angle at which the body touches: the body is lowered as the angle grows, scanned and then
// bisected.
template <class At>
std::optional<double> first_contact(const At& clearance_at) {
    double last = 0;
    if (clearance_at(0) <= 0) {
        return 0.0;
    }
    for (double angle = 0.5 * degree; angle <= 60 * degree; last = angle, angle += 0.5 * degree) {
        if (clearance_at(angle) <= 0) {
            double low = last, high = angle;
            for (int i = 0; i < 50; ++i) {
                const double mid = 0.5 * (low + high);
                (clearance_at(mid) > 0 ? low : high) = mid;
            }
            return 0.5 * (low + high);
        }
    }
    return {};
}

double lowest(const std::vector<Vec3>& points, const Placement& placement) {
    double z = std::numeric_limits<double>::max();
    for (const Vec3& p : points) {
        z = std::min(z, placed(p, placement).z);
    }
    return z;
}

bool is_underside(const std::string& patch) { return patch == "base" || patch == "protrusion" || patch == "nozzle"; }

}  // namespace

ContactAngles contact_angles(const SurfaceMesh& body, double gap) {
    std::vector<Vec3> low;  // only the lower half can touch within 60 degrees
    const Box box = bounding_box(body);
    for (const Vec3& p : body.points) {
        if (p.z < 0.6 * box.upper.z) {
            low.push_back(p);
        }
    }
    ContactAngles angles;
    angles.nose_up = first_contact([&](double a) { return lowest(low, {gap, a, 0}); });
    angles.nose_down = first_contact([&](double a) { return lowest(low, {gap, -a, 0}); });
    angles.roll = first_contact([&](double a) { return lowest(low, {gap, 0, a}); });
    return angles;
}

AreaBelow underside_area(const SurfaceMesh& body, const Placement& placement, double up_to, std::size_t points) {
    const SurfaceMesh mesh = placed(body, placement);
    AreaBelow result;
    result.height.resize(points);
    result.area.assign(points, 0.0);
    for (std::size_t i = 0; i < points; ++i) {
        result.height[i] = up_to * static_cast<double>(i) / static_cast<double>(points - 1);
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const double down = -mesh.area_vector(t).z;
        if (down <= 0) {
            continue;
        }
        std::array<double, 3> z{mesh.corner(t, 0).z, mesh.corner(t, 1).z, mesh.corner(t, 2).z};
        std::sort(z.begin(), z.end());
        for (std::size_t i = 0; i < points; ++i) {
            // Share of a triangle below a level: quadratic in the level between its corners.
            const double h = result.height[i];
            double share = h >= z[2] ? 1.0 : 0.0;
            if (h > z[0] && h < z[2]) {
                share = h < z[1] ? (h - z[0]) * (h - z[0]) / ((z[1] - z[0]) * (z[2] - z[0]))
                                 : 1 - (z[2] - h) * (z[2] - h) / ((z[2] - z[1]) * (z[2] - z[0]));
            }
            result.area[i] += down * share;
        }
    }
    return result;
}

core::Table table(const AreaBelow& below) {
    core::Table result;
    result.comments = {" area of the under side, seen from below, that lies lower than a height above the ground"};
    result.add_numbers("height", "m", below.height, "mm");
    result.add_numbers("area", "m^2", below.area, "cm^2");
    return result;
}

core::Figure figure(const AreaBelow& below) {
    core::Figure figure;
    figure.title = "Under side against height";
    figure.caption = "Area of the under side, seen from below, that lies lower than the height above the ground.";
    figure.x = {"height above the ground", "mm", 0, 0, false};
    figure.y = {"area", "cm^2", 0, 0, false};
    core::FigureCurve curve;
    curve.colour = core::palette(0);
    for (std::size_t i = 0; i < below.height.size(); ++i) {
        curve.x.push_back(1e3 * below.height[i]);
        curve.y.push_back(1e4 * below.area[i]);
    }
    figure.curves.push_back(curve);
    figure.legend = false;
    return figure;
}

namespace {

/// Extent of the under side in plan.
Box underside_box(const SurfaceMesh& mesh) {
    Box box{{1e9, 1e9, 0}, {-1e9, -1e9, 0}};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (is_underside(mesh.patch_names[static_cast<std::size_t>(mesh.patch[t])])) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& p = mesh.corner(t, k);
                box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), 0};
                box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), 0};
            }
        }
    }
    return box;
}

/// Puts the height of a triangle, in mm, into the cells whose middle lies over it; the lower one of two counts.
void put_height(core::FigureMap& map, const Box& box, const Vec3& a, const Vec3& b, const Vec3& c) {
    const double dx = (box.upper.x - box.lower.x) / static_cast<double>(map.columns),
                 dy = (box.upper.y - box.lower.y) / static_cast<double>(map.rows);
    const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const auto cell = [](double v, double low, double step, std::size_t count) {
        return static_cast<std::size_t>(std::clamp((v - low) / step, 0.0, static_cast<double>(count - 1)));
    };
    const std::size_t i0 = cell(std::min({a.x, b.x, c.x}), box.lower.x, dx, map.columns),
                      i1 = cell(std::max({a.x, b.x, c.x}), box.lower.x, dx, map.columns);
    const std::size_t j0 = cell(std::min({a.y, b.y, c.y}), box.lower.y, dy, map.rows),
                      j1 = cell(std::max({a.y, b.y, c.y}), box.lower.y, dy, map.rows);
    for (std::size_t j = j0; j <= j1; ++j) {
        for (std::size_t i = i0; i <= i1; ++i) {
            const double x = box.lower.x + (static_cast<double>(i) + 0.5) * dx,
                         y = box.lower.y + (static_cast<double>(j) + 0.5) * dy;
            const double u = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / twice;
            const double v = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / twice;
            constexpr double edge = 1e-9;  // a middle of a cell on the edge of two triangles belongs to both
            if (u >= -edge && v >= -edge && u + v <= 1 + edge) {
                double& value = map.values[j * map.columns + i];
                const double gap = 1e3 * (a.z + u * (b.z - a.z) + v * (c.z - a.z));
                value = std::isnan(value) ? gap : std::min(value, gap);
            }
        }
    }
}

core::FigureMap gap_map(const SurfaceMesh& mesh) {
    const Box box = underside_box(mesh);
    core::FigureMap map;
    map.columns = 480;
    map.rows = static_cast<std::size_t>(
        std::clamp(480 * (box.upper.y - box.lower.y) / (box.upper.x - box.lower.x), 40.0, 960.0));
    map.x_lower = 1e3 * box.lower.x, map.x_upper = 1e3 * box.upper.x, map.y_lower = 1e3 * box.lower.y,
    map.y_upper = 1e3 * box.upper.y;
    map.values.assign(map.columns * map.rows, std::numeric_limits<double>::quiet_NaN());
    map.label = "gap";
    map.unit = "mm";
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!is_underside(mesh.patch_names[static_cast<std::size_t>(mesh.patch[t])]) || mesh.area_vector(t).z >= 0) {
            continue;
        }
        put_height(map, box, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    }
    return map;
}

}  // namespace

core::Figure gap_figure(const SurfaceMesh& body, const Placement& placement) {
    SurfaceMesh mesh = placed(body, placement);
    const auto& names = mesh.patch_names;
    if (std::find(names.begin(), names.end(), "nozzle_bore") != names.end()) {
        // The end of a bore is no part of the gap, and its height would hide all else.
        std::replace(mesh.patch_names.begin(), mesh.patch_names.end(), std::string("nozzle"), std::string("bore_end"));
    }
    const Clearance clear = clearance(body, placement);
    core::Figure figure;
    figure.title = "Gap under the base";
    figure.caption = "Height of the base over the ground; the cross marks the smallest clearance, " +
                     core::format_number(1e3 * clear.smallest, 4) + " mm on the " + clear.patch + ".";
    figure.x = {"x, forward", "mm", 0, 0, false};
    figure.y = {"y, to port", "mm", 0, 0, false};
    figure.equal_scales = true;
    figure.legend = false;
    figure.maps.push_back(gap_map(mesh));
    core::FigurePoints point;
    point.x = {1e3 * clear.where.x};
    point.y = {1e3 * clear.where.y};
    point.shape = core::FigurePoints::Shape::cross;
    point.colour = {220, 0, 0, 255};
    point.size = 11;
    figure.points.push_back(point);
    return figure;
}

void to_json(nlohmann::json& json, const AreaBelow& below) { json = {{"height", below.height}, {"area", below.area}}; }

void to_json(nlohmann::json& json, const Clearance& clear) {
    json = {
        {"smallest", clear.smallest}, {"where", {clear.where.x, clear.where.y, clear.where.z}}, {"patch", clear.patch}};
}

void to_json(nlohmann::json& json, const ContactAngles& angles) {
    const auto value = [](const std::optional<double>& v) { return v ? nlohmann::json(*v) : nlohmann::json(nullptr); };
    json = {{"nose_up", value(angles.nose_up)}, {"nose_down", value(angles.nose_down)}, {"roll", value(angles.roll)}};
}

}  // namespace underbody::geometry
