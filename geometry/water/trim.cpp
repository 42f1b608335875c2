#include "geometry/water/trim.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/angle.h"
#include "core/text.h"

namespace underbody::geometry {

namespace {

// Mass, and mass times position, of all but one.
struct Sums {
    double mass = 0;
    Vec3 moment;
};

double hull_mass(const MassProperties& body, const Loading& loading) {
    return loading.hull_mass > 0 ? loading.hull_mass : loading.uniform_density * body.volume;
}

Sums sums(const MassProperties& body, const Loading& loading, const PointMass* without = nullptr) {
    Sums s{hull_mass(body, loading), {}};
    s.moment = s.mass * body.centroid;
    for (const PointMass& p : loading.points) {
        if (&p != without) {
            s.mass += p.mass;
            s.moment += p.mass * p.position;
        }
    }
    return s;
}

void add_point(Matrix3& inertia, double mass, const Vec3& d) {
    inertia[0][0] += mass * (d.y * d.y + d.z * d.z);
    inertia[1][1] += mass * (d.z * d.z + d.x * d.x);
    inertia[2][2] += mass * (d.x * d.x + d.y * d.y);
    inertia[0][1] = inertia[1][0] -= mass * d.x * d.y;
    inertia[1][2] = inertia[2][1] -= mass * d.y * d.z;
    inertia[0][2] = inertia[2][0] -= mass * d.z * d.x;
}

}  // namespace

Trim trim(const MassProperties& body, const Loading& loading, double water_density) {
    const Sums all = sums(body, loading);
    if (!(all.mass > 0)) {
        throw core::InputError("mass", "the body has no mass", {}, "give [mass] a hull or a density, or point masses");
    }
    Trim result;
    result.mass = all.mass;
    result.centre_of_gravity = all.moment / all.mass;
    result.centre_of_buoyancy = body.centroid;
    result.buoyancy = body.buoyancy(water_density);
    result.net_weight = all.mass * standard_gravity - result.buoyancy;
    const double hull = hull_mass(body, loading);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            result.inertia[i][j] = hull / body.volume * body.inertia[i][j];
        }
    }
    add_point(result.inertia, hull, body.centroid - result.centre_of_gravity);
    for (const PointMass& p : loading.points) {
        add_point(result.inertia, p.mass, p.position - result.centre_of_gravity);
    }
    const Vec3 up = result.centre_of_buoyancy - result.centre_of_gravity;
    result.neutral = norm(up) <= 1e-9 * std::cbrt(body.volume);
    result.stable = !result.neutral && up.z > 0;
    if (result.stable) {
        result.roll = std::atan2(up.y, up.z);
        result.pitch = std::atan2(up.x, std::hypot(up.y, up.z));
    }
    result.righting_stiffness = result.buoyancy * std::copysign(norm(up), up.z);
    return result;
}

double Trim::pitch_moment(double at_pitch) const {
    // Buoyancy acts up at the centre of buoyancy; about the centre of gravity, nose up: force times its arm forward.
    const Vec3 up = centre_of_buoyancy - centre_of_gravity;
    return buoyancy * (up.x * std::cos(at_pitch) - up.z * std::sin(at_pitch));
}

Vec3 ballast_position(const MassProperties& body, const Loading& loading, const std::string& name, double pitch,
                      double roll) {
    const auto found =
        std::find_if(loading.points.begin(), loading.points.end(), [&](const PointMass& p) { return p.name == name; });
    if (found == loading.points.end()) {
        std::vector<std::string> names;
        for (const PointMass& p : loading.points) {
            names.push_back(p.name);
        }
        throw core::InputError("name", "there is no point mass '" + name + "'", {}, core::did_you_mean(name, names));
    }
    const Sums rest = sums(body, loading, &*found), all = sums(body, loading);
    const double height = body.centroid.z - all.moment.z / all.mass;
    if (!(height > 0)) {
        throw core::InputError("stability",
                               "the centre of gravity lies " + core::format_number(-1000 * height, 4) +
                                   " mm above the centre of buoyancy: the body turns over at any trim",
                               {}, "put heavy parts lower");
    }
    const double side = height * std::tan(roll), fore = std::hypot(height, side) * std::tan(pitch);
    const Vec3 wanted{body.centroid.x - fore, body.centroid.y - side, all.moment.z / all.mass};
    Vec3 place = (all.mass * wanted - rest.moment) / found->mass;
    place.z = found->position.z;
    const Vec3 &low = body.bounding_box.lower, &high = body.bounding_box.upper;
    if (place.x < low.x || place.x > high.x || place.y < low.y || place.y > high.y) {
        const double x = std::clamp(place.x, low.x, high.x), y = std::clamp(place.y, low.y, high.y);
        const Vec3 moment = rest.moment + found->mass * Vec3{x, y, place.z};
        const Vec3 up = body.centroid - moment / all.mass;
        throw core::InputError("range",
                               "'" + name + "' would have to lie at (" + core::format_number(1000 * place.x, 4) + ", " +
                                   core::format_number(1000 * place.y, 4) + ") mm, outside the body",
                               {},
                               "the nearest allowed trim: pitch " +
                                   core::format_number(std::atan2(up.x, std::hypot(up.y, up.z)) / core::degree, 4) +
                                   " deg, roll " + core::format_number(std::atan2(up.y, up.z) / core::degree, 4) +
                                   " deg, or a heavier ballast");
    }
    return place;
}

void to_json(nlohmann::json& json, const Trim& trim) {
    const auto list = [](const Vec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
    json = {{"mass", trim.mass},
            {"centre_of_gravity", list(trim.centre_of_gravity)},
            {"inertia", trim.inertia},
            {"buoyancy", trim.buoyancy},
            {"net_weight", trim.net_weight},
            {"centre_of_buoyancy", list(trim.centre_of_buoyancy)},
            {"stable", trim.stable},
            {"neutral", trim.neutral},
            {"pitch", trim.pitch},
            {"roll", trim.roll},
            {"righting_stiffness", trim.righting_stiffness}};
}

}  // namespace underbody::geometry
