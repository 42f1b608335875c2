#include "geometry/mass_properties.h"

#include <nlohmann/json.hpp>

#include "core/error.h"

namespace underbody::geometry {

namespace {

// Integrals of 1, x, y, z, x^2, y^2, z^2, xy, yz, zx over the volume, by Eberly's sub-expressions for each triangle.
struct VolumeMoments {
    double one = 0;
    std::array<double, 3> first{}, square{}, product{};
};

void add_triangle(VolumeMoments& m, const Vec3& p, const Vec3& q, const Vec3& r) {
    const Vec3 d = cross(q - p, r - p);
    const std::array<double, 3> normal{d.x, d.y, d.z};
    const std::array<std::array<double, 3>, 3> w{{{p.x, q.x, r.x}, {p.y, q.y, r.y}, {p.z, q.z, r.z}}};
    std::array<double, 3> f1{}, f2{}, f3{}, g0{}, g1{}, g2{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto [w0, w1, w2] = w[k];
        const double sum01 = w0 + w1, square0 = w0 * w0, t = square0 + w1 * sum01;
        f1[k] = sum01 + w2;
        f2[k] = t + w2 * f1[k];
        f3[k] = w0 * square0 + w1 * t + w2 * f2[k];
        g0[k] = f2[k] + w0 * (f1[k] + w0);
        g1[k] = f2[k] + w1 * (f1[k] + w1);
        g2[k] = f2[k] + w2 * (f1[k] + w2);
    }
    m.one += normal[0] * f1[0] / 6;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        m.first[k] += normal[k] * f2[k] / 24;
        m.square[k] += normal[k] * f3[k] / 60;
        m.product[k] += normal[k] * (w[next][0] * g0[k] + w[next][1] * g1[k] + w[next][2] * g2[k]) / 120;
    }
}

}  // namespace

MassProperties mass_properties(const SurfaceMesh& mesh) {
    if (!is_watertight(mesh)) {
        throw core::InputError("open", "the surface is not closed: it has no volume", {},
                               "every edge must belong to two triangles that run through it in opposite directions");
    }
    MassProperties mass;
    mass.bounding_box = bounding_box(mesh);
    const Vec3 middle = 0.5 * (mass.bounding_box.lower + mass.bounding_box.upper);
    VolumeMoments m;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        add_triangle(m, mesh.corner(i, 0) - middle, mesh.corner(i, 1) - middle, mesh.corner(i, 2) - middle);
    }
    if (!(m.one > 0)) {
        throw core::InputError("orientation",
                               "the surface has a volume of " + std::to_string(m.one) + " m^3: it is inside out");
    }
    mass.volume = m.one;
    mass.area = area(mesh);
    const double x = m.first[0] / m.one, y = m.first[1] / m.one, z = m.first[2] / m.one;
    mass.centroid = middle + Vec3{x, y, z};
    const double xx = m.square[0] - m.one * x * x, yy = m.square[1] - m.one * y * y, zz = m.square[2] - m.one * z * z;
    const double xy = m.product[0] - m.one * x * y, yz = m.product[1] - m.one * y * z,
                 zx = m.product[2] - m.one * z * x;
    mass.inertia = {{{yy + zz, -xy, -zx}, {-xy, zz + xx, -yz}, {-zx, -yz, xx + yy}}};
    return mass;
}

void to_json(nlohmann::json& json, const MassProperties& mass) {
    const auto list = [](const Vec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
    json = {{"volume", mass.volume},
            {"area", mass.area},
            {"centroid", list(mass.centroid)},
            {"inertia", mass.inertia},
            {"buoyancy", mass.buoyancy()},
            {"bounding_box", {{"lower", list(mass.bounding_box.lower)}, {"upper", list(mass.bounding_box.upper)}}}};
}

}  // namespace underbody::geometry
