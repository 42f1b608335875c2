#include "geometry/water/theory.h"

#include "geometry/body/mass_properties.h"
#include "geometry/water/ellipsoid_added_mass.h"

namespace underbody::geometry {

namespace {

using core::ClosedForm;

ClosedForm::Result ellipsoid(const ClosedForm::Values& v) {
    const double a = v("a"), b = v("b"), c = v("c"), rho = v("density"), mass = v("mass");
    const EllipsoidAddedMass e = ellipsoid_added_mass(a, b, c);
    ClosedForm::Result r;
    const auto out = [&r](const std::string& name, const char* unit, double value, const char* meaning) {
        r.outputs.push_back({name, unit, value, meaning});
    };
    out("volume", "m^3", e.volume, "");
    out("displaced_mass", "kg", rho * e.volume, "");
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string axis(1, "xyz"[i]);
        out("integral_" + axis, "1", e.integral[i], "alpha0, beta0, gamma0 of Lamb; their sum is 2");
        out("k_" + axis, "1", e.translation[i] / e.volume, "added mass over displaced mass");
        out("added_mass_" + axis, "kg", rho * e.translation[i], "");
        out("virtual_mass_" + axis, "kg", mass + rho * e.translation[i], "with the mass of the body");
    }
    const double squares[3] = {b * b + c * c, c * c + a * a, a * a + b * b};
    const char* names[3] = {"roll", "pitch", "yaw"};
    for (std::size_t i = 0; i < 3; ++i) {
        const double displaced = e.volume * squares[i] / 5;
        out(std::string("added_inertia_") + names[i], "kg m^2", rho * e.rotation[i], "about the centre");
        out(std::string("k_") + names[i], "1", e.rotation[i] / displaced,
            "added inertia over that of the displaced water");
        out(std::string("virtual_inertia_") + names[i], "kg m^2", mass * squares[i] / 5 + rho * e.rotation[i],
            "with that of a body of even density");
    }
    out("munk_yaw", "kg", rho * (e.translation[0] - e.translation[1]), "C_mm = A_x - A_y");
    out("munk_pitch", "kg", rho * (e.translation[2] - e.translation[0]), "A_z - A_x");
    r.limits.push_back(
        {"unbounded ideal fluid: farther from the ground than about the body's length (for nearer see body added-mass)",
         true});
    return r;
}

}  // namespace

const std::vector<core::ClosedForm>& closed_forms() {
    static const std::vector<core::ClosedForm> all{
        {"ellipsoid",
         "Added mass of an ellipsoid in unbounded fluid",
         "A_x = rho V alpha0/(2 - alpha0) and cyclic; alpha0 = 2/3 abc R_D(b^2, c^2, a^2)",
         "Lamb, Hydrodynamics, 114 and 115",
         {{"a", "m", "half axis along x", std::nullopt},
          {"b", "m", "half axis along y", std::nullopt},
          {"c", "m", "half axis along z", std::nullopt},
          {"density", "kg/m^3", "of the water", default_water_density},
          {"mass", "kg", "of the body", 0.0}},
         ellipsoid}};
    return all;
}

}  // namespace underbody::geometry
