#include "geometry/body/mass_properties.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "geometry/body/exact_body.h"

namespace underbody::geometry {

namespace {

// Integrals of 1, x, y, z, x^2, y^2, z^2, xy, yz, zx over the volume, by Eberly's sub-expressions for each triangle.
struct TriangleMoments {
    double one = 0;
    std::array<double, 3> first{}, square{}, product{};
};

constexpr double smooth_turn = 0.94;  // cosine of 20 degrees: more is a sharp edge

void add_triangle(TriangleMoments& m, const Vec3& p, const Vec3& q, const Vec3& r) {
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
    TriangleMoments m;
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

MassProperties mass_properties(const ExactBody& body, const SurfaceMesh& mesh) {
    const VolumeMoments m = body.moments();
    MassProperties mass;
    mass.volume = m.one;
    mass.area = area(mesh);
    const double x = m.x / m.one, z = m.z / m.one;
    mass.centroid = {x, 0, z};
    const double xx = m.xx - m.one * x * x, yy = m.yy, zz = m.zz - m.one * z * z, zx = m.zx - m.one * z * x;
    mass.inertia = {{{yy + zz, 0, -zx}, {0, zz + xx, 0}, {-zx, 0, xx + yy}}};
    // The whole ellipsoid stands above its midplane; below it a bend may reach further.
    mass.bounding_box = bounding_box(mesh);
    Vec3 &low = mass.bounding_box.lower, &high = mass.bounding_box.upper;
    low.x = std::min(low.x, -body.semi_x() - body.base_centre());
    high.x = std::max(high.x, body.semi_x() - body.base_centre());
    high.y = std::max(high.y, body.semi_y());
    low.y = -high.y;
    high.z = std::max(high.z, body.top());
    return mass;
}

double volume_left_out(const SurfaceMesh& mesh) {
    std::vector<std::vector<std::size_t>> around(mesh.points.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const auto point : mesh.triangles[i]) {
            around[static_cast<std::size_t>(point)].push_back(i);
        }
    }
    // The normal at a corner, of the triangles around it that do not lie beyond a sharp edge.
    const auto normal = [&](std::size_t triangle, std::int32_t corner) {
        const Vec3 own = mesh.area_vector(triangle);
        Vec3 sum;
        for (const std::size_t other : around[static_cast<std::size_t>(corner)]) {
            const Vec3 vector = mesh.area_vector(other);
            sum += dot(own, vector) > smooth_turn * norm(own) * norm(vector) ? vector : Vec3{};
        }
        return norm(sum) > 0 ? unit(sum) : Vec3{};
    };
    // A quadratic that vanishes at the corners and stands m above the middles of the edges holds area/3 times the sum
    // of m; an edge e of a curve with the normals a and b at its ends has m = e . (b - a)/8.
    double sum = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Triangle& t = mesh.triangles[i];
        const std::array<Vec3, 3> n{normal(i, t[0]), normal(i, t[1]), normal(i, t[2])};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            sum += norm(mesh.area_vector(i)) / 24 * dot(mesh.corner(i, next) - mesh.corner(i, k), n[next] - n[k]);
        }
    }
    return sum;
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
