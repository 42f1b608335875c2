#include "postproc/loads/half_model.h"

#include <array>
#include <cmath>

#include "core/text.h"
#include "postproc/field/field.h"
#include "postproc/loads/body_zones.h"

namespace underbody::postproc {

namespace {

using Bounds = std::array<double, 6>;

Bounds bounds_of(const Zone& zone) {
    Bounds bounds{};
    zone.surface->GetBounds(bounds.data());
    return bounds;
}

bool has_faces(const Zone& zone) { return zone.surface && zone.surface->GetNumberOfCells() > 0; }

/// The axis across which the box has no width; -1: none.
int flat_across(const Bounds& b, double size) {
    for (int axis = 0; axis < 3; ++axis) {
        if (b[2 * axis + 1] - b[2 * axis] <= 1e-6 * size) {
            return axis;
        }
    }
    return -1;
}

}  // namespace

std::string half_model_advice(const std::string& axis) { return "a half model? then option 'symmetry " + axis + "'"; }

std::optional<LikelyHalf> likely_half(const Field& field) {
    if (field.dimension != 3) {
        return {};
    }
    std::vector<const Zone*> said_otherwise;
    const auto walls = possible_walls(field, said_otherwise);
    std::optional<LikelyHalf> found;
    int axis_found = -1;
    double at_found = 0;
    for (const Zone& zone : field.zones) {
        if (zone.kind != ZoneKind::symmetry || !has_faces(zone)) {
            continue;
        }
        const Bounds b = bounds_of(zone);
        const double size = std::hypot(b[1] - b[0], b[3] - b[2], b[5] - b[4]);
        const int axis = flat_across(b, size);
        const double at = axis < 0 ? 0 : (b[2 * axis] + b[2 * axis + 1]) / 2;
        if (axis >= 0 && axis == axis_found && std::abs(at - at_found) <= 1e-6 * size) {
            continue;  // another patch of the same plane
        }
        if (axis < 0 || found) {
            return {};
        }
        bool above = false, below = false;
        for (const Zone* wall : walls) {
            if (has_faces(*wall)) {
                const Bounds w = bounds_of(*wall);
                above = above || w[2 * axis + 1] > at + 1e-6 * size;
                below = below || w[2 * axis] < at - 1e-6 * size;
            }
        }
        if (above == below) {
            return {};
        }
        axis_found = axis;
        at_found = at;
        const std::string letter(1, "xyz"[axis]);
        found = LikelyHalf{std::abs(at) <= 1e-6 * size ? letter : letter + "=" + core::format_number(at), zone.name};
    }
    return found;
}

}  // namespace underbody::postproc
