#include "postproc/loads/loads_reference_point.h"

#include <algorithm>
#include <limits>

namespace underbody::postproc {

Extent::Extent() {
    lower.fill(std::numeric_limits<double>::infinity());
    upper.fill(-std::numeric_limits<double>::infinity());
}

void Extent::widen(const SummedZone& part) {
    const auto points = part.surface->points();
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
        for (std::size_t k = 0; k < 3; ++k) {
            lower[k] = std::min(lower[k], points[i + k]);
            upper[k] = std::max(upper[k], points[i + k]);
        }
    }
}

Extent extent_of(const std::vector<SummedZone>& parts) {
    Extent extent;
    for (const auto& part : parts) {
        extent.widen(part);
    }
    return extent;
}

Vector centre_of(const SummedZone& part, std::size_t face) {
    Vector sum{};
    const auto first = part.surface->offsets()[face];
    const auto last = part.surface->offsets()[face + 1];
    for (auto i = first; i < last; ++i) {
        const double* x = part.surface->points().data() + 3 * part.surface->connectivity()[static_cast<std::size_t>(i)];
        sum = plus(sum, {x[0], x[1], x[2]}, 1.0 / static_cast<double>(last - first));
    }
    return sum;
}

namespace {

Vector area_of(const SummedZone& part, std::size_t face) {
    const auto first = part.surface->offsets()[face];
    const auto last = part.surface->offsets()[face + 1];
    const auto point = [&](Index i) {
        const double* x = part.surface->points().data() + 3 * part.surface->connectivity()[static_cast<std::size_t>(i)];
        return Vector{x[0], x[1], x[2]};
    };
    const Vector origin = point(first);
    Vector sum{};
    for (Index i = first + 1; i + 1 < last; ++i) {
        sum = plus(sum, cross(plus(point(i), origin, -1), plus(point(i + 1), origin, -1)), 0.5);
    }
    return sum;
}

/// Mean normal and the offset below which half of the area lies.
std::pair<Vector, double> plane_of(const std::vector<const SummedZone*>& base, const Vector& up,
                                   const PlacedMirror& mirror) {
    struct Face {
        double offset, area;
    };
    std::vector<Face> faces;
    Vector normal{};
    std::vector<std::pair<Vector, double>> centres;
    double area = 0;
    for (const SummedZone* part : base) {
        for (std::size_t f = 0; f < part->surface->faces(); ++f) {
            const Vector a = area_of(*part, f);
            normal = plus(normal, a, dot(a, up) > 0 ? 1.0 : -1.0);
            centres.emplace_back(centre_of(*part, f), norm(a));
            area += norm(a);
        }
    }
    const double size = norm(normal);
    if (!(size > 0)) {
        return {up, 0};
    }
    normal = {normal[0] / size, normal[1] / size, normal[2] / size};
    if (mirror.axis >= 0) {  // the other half's normals make the mean one lie in the plane
        normal[static_cast<std::size_t>(mirror.axis)] = 0;
    }
    faces.reserve(centres.size());
    for (const auto& [centre, a] : centres) {
        faces.push_back({dot(centre, normal), a});
    }
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.offset < b.offset; });
    double below = 0;
    for (const auto& face : faces) {
        below += face.area;
        if (below >= 0.5 * area) {
            return {normal, face.offset};
        }
    }
    return {normal, faces.back().offset};
}

double lowest_along(const std::vector<SummedZone>& parts, const Vector& up) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const auto& part : parts) {
        const auto points = part.surface->points();
        for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
            lowest = std::min(lowest, dot({points[i], points[i + 1], points[i + 2]}, up));
        }
    }
    return lowest;
}

}  // namespace

MomentReference reference_from_base(const std::vector<SummedZone>& parts, const std::string& base, const Vector& up,
                                    const PlacedMirror& mirror) {
    MomentReference reference;
    std::vector<const SummedZone*> of_base;
    std::vector<std::string> names;
    Extent extent;
    for (const auto& part : parts) {
        if (matches(base, part.zone->name)) {
            of_base.push_back(&part);
            names.push_back(part.zone->name);
            extent.widen(part);
        }
    }
    if (of_base.empty()) {
        extent = extent_of(parts);
    }
    Vector& r = reference.point;
    for (std::size_t k = 0; k < 3; ++k) {
        r[k] = 0.5 * (extent.lower[k] + extent.upper[k]);
    }
    if (mirror.axis >= 0) {
        r[static_cast<std::size_t>(mirror.axis)] = mirror.at;
    }
    if (of_base.empty()) {
        r = plus(r, up, lowest_along(parts, up) - dot(r, up));
        reference.from = "lowest point under the centre of the bounding box (no zone fits '" + base + "')";
        reference.base_found = false;
        return reference;
    }
    reference.from = "centre of the base (zone " + quoted(names) + ")";
    const auto [normal, offset] = plane_of(of_base, up, mirror);
    if (std::abs(dot(normal, up)) > 0.5) {  // straight up or down, so that mid-length stays mid-length
        r = plus(r, up, (offset - dot(r, normal)) / dot(normal, up));
    }
    return reference;
}

}  // namespace underbody::postproc
