#include "geometry/body/body_figures.h"

#include <algorithm>
#include <cmath>

#include "core/angle.h"
#include "core/text.h"
#include "geometry/mesh/slice.h"

namespace underbody::geometry {

namespace {

constexpr double sharp = 12 * core::degree;
constexpr core::Colour ink{30, 30, 30, 255}, blue{0, 114, 178, 255}, grey{120, 120, 120, 255};

// Four figures: what a mesh cuts off a curve (203.18 of 203.2 mm) is no dimension of the body.
std::string mm(double metres) { return core::format_number(1e3 * metres, 4) + " mm"; }

core::FigureCurve line(double x0, double y0, double x1, double y1, core::Colour colour, double width = 1) {
    core::FigureCurve curve;
    curve.x = {x0, x1};
    curve.y = {y0, y1};
    curve.colour = colour;
    curve.width = width;
    return curve;
}

// A dimension between two points of one line, with end ticks and its length in the middle.
void dimension(core::Figure& figure, double x0, double y0, double x1, double y1, double tick, double metres) {
    figure.curves.push_back(line(x0, y0, x1, y1, grey));
    const bool across = std::abs(x1 - x0) > std::abs(y1 - y0);
    for (const auto& [x, y] : {std::pair{x0, y0}, std::pair{x1, y1}}) {
        figure.curves.push_back(across ? line(x, y - tick, x, y + tick, grey) : line(x - tick, y, x + tick, y, grey));
    }
    figure.notes.push_back({0.5 * (x0 + x1), 0.5 * (y0 + y1), mm(metres)});
}

struct Extent {
    double low = 1e9, high = -1e9;
    void add(double v) { low = std::min(low, v), high = std::max(high, v); }
    [[nodiscard]] double size() const { return high - low; }
};

struct PatchExtent {
    Extent x, y, z;
    bool any = false;
};

PatchExtent extent_of(const SurfaceMesh& body, const std::string& patch) {
    PatchExtent extent;
    for (std::size_t t = 0; t < body.triangles.size(); ++t) {
        if (body.patch_names[static_cast<std::size_t>(body.patch[t])] == patch) {
            extent.any = true;
            for (std::size_t k = 0; k < 3; ++k) {
                extent.x.add(body.corner(t, k).x);
                extent.y.add(body.corner(t, k).y);
                extent.z.add(body.corner(t, k).z);
            }
        }
    }
    return extent;
}

// How far a patch stands out of the plane of the base, whatever its pitch.
double height_over_base(const SurfaceMesh& body, const std::string& patch) {
    Vec3 vector, centre;
    double area = 0, height = 0;
    const auto is = [&](std::size_t t, const std::string& name) {
        return body.patch_names[static_cast<std::size_t>(body.patch[t])] == name;
    };
    for (std::size_t t = 0; t < body.triangles.size(); ++t) {
        if (is(t, "base")) {
            const double part = norm(body.area_vector(t));
            vector += body.area_vector(t);
            centre += part * body.centre(t);
            area += part;
        }
    }
    for (std::size_t t = 0; area > 0 && t < body.triangles.size(); ++t) {
        if (is(t, patch)) {
            for (std::size_t k = 0; k < 3; ++k) {
                height = std::max(height, dot(body.corner(t, k) - centre / area, unit(vector)));
            }
        }
    }
    return height;
}

void add_section(core::Figure& figure, const SurfaceMesh& body, double dx, double dy, double width) {
    for (const auto& loop : slice(body, Axis::y, 0)) {
        core::FigureCurve curve;
        curve.colour = ink;
        curve.width = width;
        for (const Vec3& p : loop) {
            curve.x.push_back(dx + 1e3 * p.x);
            curve.y.push_back(dy + 1e3 * p.z);
        }
        figure.curves.push_back(curve);
    }
}

void add_underside(core::Figure& figure, const SurfaceMesh& body, double dx, double dy, double width) {
    const Box box = bounding_box(body);
    // The widest level of the hull, among a few.
    std::vector<std::vector<Vec3>> widest;
    double largest = 0;
    for (int i = 1; i < 40; ++i) {
        auto loops = slice(body, Axis::z, box.lower.z + (box.upper.z - box.lower.z) * i / 40);
        Extent extent;
        for (const auto& loop : loops) {
            for (const Vec3& p : loop) {
                extent.add(p.x);
            }
        }
        if (extent.size() > largest) {
            largest = extent.size();
            widest = std::move(loops);
        }
    }
    for (const auto& loop : widest) {
        core::FigureCurve curve;
        curve.colour = ink;
        curve.width = width;
        for (const Vec3& p : loop) {
            curve.x.push_back(dx + 1e3 * p.x);
            curve.y.push_back(dy + 1e3 * p.y);
        }
        figure.curves.push_back(curve);
    }
    const double top = box.lower.z + 0.45 * (box.upper.z - box.lower.z);
    for (const std::vector<Vec3>& points : feature_lines(body, sharp)) {
        core::FigureCurve curve;
        curve.colour = blue;
        curve.width = width;
        for (const Vec3& p : points) {
            if (p.z < top) {
                curve.x.push_back(dx + 1e3 * p.x);
                curve.y.push_back(dy + 1e3 * p.y);
            }
        }
        if (curve.x.size() > 1) {
            figure.curves.push_back(std::move(curve));
        }
    }
}

core::Figure frame(const std::string& title, const char* x, const char* y) {
    core::Figure figure;
    figure.title = title;
    figure.x = {x, "mm", 0, 0, false};
    figure.y = {y, "mm", 0, 0, false};
    figure.equal_scales = true;
    figure.legend = false;
    return figure;
}

}  // namespace

core::Figure section_figure(const SurfaceMesh& body, const std::string& name) {
    core::Figure figure = frame(name + ": section", "x, forward", "z, up");
    figure.caption = "Section in the plane of symmetry.";
    add_section(figure, body, 0, 0, 2);
    const Box box = bounding_box(body);
    const double tick = 5 * (box.upper.x - box.lower.x), step = 80 * (box.upper.x - box.lower.x);
    dimension(figure, 1e3 * box.lower.x, 1e3 * box.upper.z + step, 1e3 * box.upper.x, 1e3 * box.upper.z + step, tick,
              box.upper.x - box.lower.x);
    dimension(figure, 1e3 * box.upper.x + step, 1e3 * box.lower.z, 1e3 * box.upper.x + step, 1e3 * box.upper.z, tick,
              box.upper.z - box.lower.z);
    const PatchExtent base = extent_of(body, "base");
    if (base.any) {
        const double y = 1e3 * box.lower.z - step;
        dimension(figure, 1e3 * base.x.low, y, 1e3 * base.x.high, y, tick, base.x.size());
        // Under its line, where the axis makes room for it: over it is the room of protrusion and nozzle.
        figure.notes.back().y -= step;
    }
    if (const PatchExtent bump = extent_of(body, "protrusion"); bump.any) {
        // One unit for both, in two lines: the text has its room within the body in a small picture.
        const std::string length = mm(bump.x.size());
        figure.notes.push_back(
            {500 * (bump.x.low + bump.x.high), 1e3 * bump.z.high + 0.9 * step,
             "protrusion\n" + length.substr(0, length.find(' ')) + " × " + mm(height_over_base(body, "protrusion"))});
    }
    if (const PatchExtent nozzle = extent_of(body, "nozzle"); nozzle.any) {
        figure.notes.push_back(
            {500 * (nozzle.x.low + nozzle.x.high), 1e3 * nozzle.z.high + 1.8 * step, "nozzle " + mm(nozzle.x.size())});
    }
    return figure;
}

core::Figure underbody_figure(const SurfaceMesh& body, const std::string& name) {
    core::Figure figure = frame(name + ": under side", "x, forward", "y, to port");
    figure.caption =
        "Seen through the body from above: black the widest outline, blue the edges of base, protrusion and nozzle.";
    add_underside(figure, body, 0, 0, 1.5);
    const Box box = bounding_box(body);
    const double tick = 5 * (box.upper.x - box.lower.x), step = 80 * (box.upper.x - box.lower.x);
    dimension(figure, 1e3 * box.lower.x, 1e3 * box.upper.y + step, 1e3 * box.upper.x, 1e3 * box.upper.y + step, tick,
              box.upper.x - box.lower.x);
    dimension(figure, 1e3 * box.upper.x + step, 1e3 * box.lower.y, 1e3 * box.upper.x + step, 1e3 * box.upper.y, tick,
              box.upper.y - box.lower.y);
    const PatchExtent base = extent_of(body, "base");
    if (base.any) {
        dimension(figure, 1e3 * base.x.low, 1e3 * box.lower.y - step, 1e3 * base.x.high, 1e3 * box.lower.y - step, tick,
                  base.x.size());
        dimension(figure, 1e3 * box.lower.x - step, 1e3 * base.y.low, 1e3 * box.lower.x - step, 1e3 * base.y.high, tick,
                  base.y.size());
    }
    if (const PatchExtent bump = extent_of(body, "protrusion"); bump.any) {
        const double middle = 500 * (bump.x.low + bump.x.high);
        dimension(figure, middle, 1e3 * bump.y.low, middle, 1e3 * bump.y.high, tick, bump.y.size());
        if (base.any) {  // where it is: from the nose end of the base to its axis
            const double y = 1e3 * box.lower.y - 0.5 * step;
            dimension(figure, middle, y, 1e3 * base.x.high, y, tick, base.x.high - 1e-3 * middle);
        }
    }
    if (const PatchExtent nozzle = extent_of(body, "nozzle"); nozzle.any) {
        figure.notes.push_back(
            {500 * (nozzle.x.low + nozzle.x.high), 1e3 * nozzle.y.high + 0.15 * step, "nozzle " + mm(nozzle.x.size())});
    }
    return figure;
}

core::Figure sheet_figure(const std::vector<NamedBody>& bodies, const std::string& title) {
    core::Figure figure = frame(title, "", "");
    figure.caption = "Above the section, below the under side of each body, at one scale.";
    double width = 0, height = 0;
    for (const NamedBody& body : bodies) {
        const Box box = bounding_box(*body.mesh);
        width = std::max(width, 1e3 * (box.upper.x - box.lower.x));
        height = std::max(height, 1e3 * (box.upper.z - box.lower.z + box.upper.y - box.lower.y));
    }
    const auto columns = static_cast<std::size_t>(
        std::max(1.0, std::ceil(std::sqrt(1.6 * static_cast<double>(bodies.size()) * height / width))));
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const Box box = bounding_box(*bodies[i].mesh);
        const double x = static_cast<double>(i % columns) * 1.15 * width,
                     y = -static_cast<double>(i / columns) * 1.6 * height;
        add_section(figure, *bodies[i].mesh, x, y - 1e3 * box.lower.z, 1);
        add_underside(figure, *bodies[i].mesh, x, y - 0.05 * height - 1e3 * box.upper.y, 1);
        // Over the left end, with room for a line of text below the next row: every name stands at its own body.
        figure.notes.push_back({x - 0.5 * width, y + 1e3 * (box.upper.z - box.lower.z), bodies[i].name});
    }
    return figure;
}

}  // namespace underbody::geometry
