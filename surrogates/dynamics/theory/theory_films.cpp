// Closed forms of thin films and jets (docs/physics.md sections 4 and 5), with what they leave out.
#include <cmath>
#include <numbers>

#include "core/text.h"
#include "core/water.h"
#include "surrogates/dynamics/theory/film.h"
#include "surrogates/dynamics/theory/theory.h"

namespace underbody::dynamics {

namespace {

using core::ClosedForm;
using Inputs = std::vector<ClosedForm::Input>;
using Result = ClosedForm::Result;
using Values = ClosedForm::Values;

using std::numbers::pi;

const ClosedForm::Input viscosity{"viscosity", "Pa s", "dynamic viscosity of the water", 1.0e-3};
const ClosedForm::Input density{"density", "kg/m^3", "of the water", core::default_water_density};
const ClosedForm::Input speed{"speed", "m/s", "of the ground under the body", 0.5};

std::string number(double value) { return core::format_number(value, 3); }

/// The inertia of the water is left out where the reduced Reynolds number is small.
ClosedForm::Limit inertia_limit(double reduced) {
    return {"the water's inertia is left out: U h^2/(nu L) = " + number(reduced) + ", to be below 1", reduced <= 1};
}

ClosedForm::Limit thin_limit(double gap, double size) {
    constexpr double thin = 0.1;
    return {"the film is thin: gap over size = " + number(gap / size) + ", to be below 0.1", gap <= thin * size};
}

/// First-order inertia beside friction, rho Q h/(pi mu a b): of a radial film over the ellipse half of which lies
/// beyond. Beside CFD (cases/evie/jet, docs/physics.md section 5.2) the force is 6 % off at 0.35, 36 % at 1.1, and of
/// the other sign at 2.5.
ClosedForm::Limit film_inertia_limit(double flow, double gap, double a, double b, double mu, double rho) {
    constexpr double most = 0.4;
    const double reduced = rho * flow * gap / (pi * mu * a * b);
    return {"the film's inertia is small: Q h/(pi nu a b) = " + number(reduced) +
                ", to be below 0.4 (beside CFD 6 % off at 0.35, 36 % at 1.1, of the other sign at 2.5)",
            reduced <= most};
}

Result slider(const Values& v) {
    const double inlet = v("inlet"), outlet = v("outlet"), length = v("length"), u = v("speed"), mu = v("viscosity");
    const SliderFilm film =
        slider_film([&](double x) { return inlet + (outlet - inlet) * x / length; }, length, {}, u, mu, v("density"));
    const double ratio = best_slider_ratio();
    return {{{"load_per_width", "N/m", plane_slider_load(inlet, outlet, length, u, mu), "up, per metre of width"},
             {"peak_pressure", "Pa", plane_slider_peak(inlet, outlet, length, u, mu),
              inlet >= outlet ? "highest, where the gap is 2 hi ho/(hi + ho)"
                              : "lowest, where the gap is 2 hi ho/(hi + ho)"},
             {"outlet_pressure", "Pa", film.pressure.back(), "ambient: 0"},
             {"centre_of_pressure", "m", film.centre_of_pressure, "from the inlet"},
             {"centre_of_pressure_share", "1", film.centre_of_pressure / length, "of the length"},
             {"load_by_quadrature", "N/m", film.load_per_width, "the same load, integrated"},
             {"best_ratio", "1", ratio, "inlet over outlet of highest load"},
             {"best_load_coefficient", "1", slider_load_coefficient(ratio), "W ho^2/(mu U L^2) at that ratio"},
             {"reduced_reynolds", "1", film.reduced_reynolds, "U h^2/(nu L) at the largest gap"}},
            {inertia_limit(film.reduced_reynolds), thin_limit(std::max(inlet, outlet), length)}};
}

Result wedge(const Values& v) {
    const double front = v("front"), land = v("land"), rear = v("rear"), ends = v("end_gap"), h = v("gap");
    const double length = front + land + rear, tilt = std::tan(v("pitch"));
    const auto gap = [&](double x) {
        const double level = x < front                        ? ends + (h - ends) * x / front
                             : x <= front + land || rear == 0 ? h
                                                              : h + (ends - h) * (x - front - land) / rear;
        return level + (length / 2 - x) * tilt;  // nose up: the gap opens towards the nose, where x = 0
    };
    std::vector<double> corners{front};
    if (rear > 0) {
        corners.push_back(front + land);
    }
    const SliderFilm film = slider_film(gap, length, corners, v("speed"), v("viscosity"), v("density"));
    std::size_t corner = 0;
    while (film.x[corner] < front * (1 - 1e-12)) {
        ++corner;
    }
    return {{{"load_per_width", "N/m", film.load_per_width, "up, per metre of width"},
             {"highest_pressure", "Pa", film.highest, ""},
             {"lowest_pressure", "Pa", film.lowest, ""},
             {"land_pressure", "Pa", film.pressure[corner], "where the front wedge ends and the land begins"},
             {"reduced_reynolds", "1", film.reduced_reynolds, "U h^2/(nu L) at the largest gap"}},
            {inertia_limit(film.reduced_reynolds), thin_limit(ends, length)}};
}

Result radial(const Values& v) {
    const double q = v("flow"), h = v("gap"), r1 = v("nozzle_radius"), r2 = v("plate_radius"), mu = v("viscosity"),
                 rho = v("density");
    const double at_lip = rho * q / (2 * pi * r1 * mu);
    return {{{"pressure", "Pa", radial_film_pressure(q, h, r1, r2, mu), "viscous, at the nozzle's lip"},
             {"viscous_load", "N", radial_film_load(q, h, r1, r2, mu), "up"},
             {"inertial_load_inviscid", "N", radial_inertia_load(q, h, r1, r2, rho, inviscid_film_factor),
              "up; factor 1/2"},
             {"inertial_load_laminar", "N", radial_inertia_load(q, h, r1, r2, rho, laminar_film_factor),
              "up; factor 27/35, laminar to first order"},
             {"gradient_factor", "1", laminar_film_gradient, "dp/dr over rho ubar^2/r of the laminar film, 54/35"},
             {"reynolds_at_lip", "1", at_lip, "Q/(2 pi r1 nu)"}},
            {{"the film is laminar: Q/(2 pi r1 nu) = " + number(at_lip) + ", to be below 2000", at_lip <= 2000},
             film_inertia_limit(q, h, r2, r2, mu, rho),
             thin_limit(h, r2 - r1)}};
}

Result film_of_jet(const Values& v) {
    const double a = v("half_length"), b = v("half_width"), r1 = v("nozzle_radius"), q = v("flow"), mu = v("viscosity"),
                 rho = v("density"), h = v("gap");
    const JetFilm film = jet_film(a, b, r1, q, mu, rho, v("inertia_factor"));
    const double at_lip = rho * q / (2 * pi * r1 * mu);
    return {{{"force", "N", film.force(h), "up, at the gap"},
             {"viscous_load", "N", elliptic_film_load(q, h, a, b, mu),
              "of a source under the whole ellipse, up, at the gap"},
             {"zero_gap", "m", film.zero(), "where the force vanishes: stable"},
             {"lowest_gap", "m", film.lowest_gap(), "of the strongest suction"},
             {"lowest_force", "N", film.lowest(), "there"},
             {"stiffness", "N/m", film.stiffness(), "-dF/dh at the zero"},
             {"reynolds_at_lip", "1", at_lip, "Q/(2 pi r1 nu)"}},
            {{"the film is laminar: Q/(2 pi r1 nu) = " + number(at_lip) + ", to be below 2000", at_lip <= 2000},
             film_inertia_limit(q, h, a, b, mu, rho),
             thin_limit(h, b)}};
}

Result squeeze(const Values& v) {
    const double a = v("half_length"), b = v("half_width"), h = v("gap"), mu = v("viscosity"), rho = v("density");
    return {{{"damping", "N s/m", squeeze_damping(a, b, h, mu), "force against the rate of the gap, slow motion"},
             {"added_mass", "kg", gap_added_mass(a, b, h, rho), "of the film in heave, fast motion"},
             {"film_integral", "m^4", film_integral(a, b), "G = pi a^3 b^3/(4 (a^2 + b^2))"},
             {"viscous_time", "s", rho * h * h / (12 * mu), "added mass over damping: slow is slower than this"}},
            {thin_limit(h, b)}};
}

Result jet(const Values& v) {
    const JetFlow flow = jet_flow(v("thrust"), v("diameter"), v("density"), v("kinematic_viscosity"));
    const double rim = ellipse_perimeter(v("half_length"), v("half_width"));
    return {
        {{"velocity", "m/s", flow.velocity, "in the nozzle"},
         {"flow", "m^3/s", flow.flow, ""},
         {"reynolds", "1", flow.reynolds, "of the nozzle"},
         {"perimeter", "m", rim, "of the ellipse with those half axes"},
         {"rim_reynolds", "1", rim_reynolds(flow.flow, rim, v("kinematic_viscosity")),
          "Q/(nu perimeter): the same at every gap"}},
        {{"the intake is at rest and the exhaust at ambient pressure: the nozzle is not throttled by the gap", true}}};
}

const Inputs ellipse{{"half_length", "m", "half axis of the base along x", std::nullopt},
                     {"half_width", "m", "half axis of the base across", std::nullopt}};

Inputs with(Inputs first, const Inputs& more) {
    first.insert(first.end(), more.begin(), more.end());
    return first;
}

}  // namespace

std::vector<core::ClosedForm> film_forms() {
    return {
        {"slider",
         "Plane slider over a moving ground, one-dimensional film",
         "d/dx(h^3 dp/dx) = 6 mu U dh/dx; W = 6 mu U L^2/(ho^2 (K-1)^2) (ln K - 2 (K-1)/(K+1)), K = hi/ho",
         "Reynolds 1886",
         {{"inlet", "m", "gap where the water enters", std::nullopt},
          {"outlet", "m", "gap where it leaves", std::nullopt},
          {"length", "m", "between them", std::nullopt},
          speed,
          viscosity,
          density},
         slider},
        {"wedge",
         "Wedge, land, wedge over a moving ground, one-dimensional film",
         "q = U/2 I2/I3, In = integral of h^-n; dp/dx = 6 mu U/h^2 - 12 mu q/h^3",
         "Reynolds 1886; by Gauss quadrature",
         {{"front", "m", "length of the front wedge", std::nullopt},
          {"land", "m", "length of the level part", std::nullopt},
          {"rear", "m", "length of the rear wedge (0: none)", 0.0},
          {"end_gap", "m", "gap at the open ends", std::nullopt},
          {"gap", "m", "gap of the land", std::nullopt},
          {"pitch", "rad", "about the middle, nose up", 0.0},
          speed,
          viscosity,
          density},
         wedge},
        {"radial",
         "Radial film of a jet in the middle of a round plate",
         "p = 6 mu Q/(pi h^3) ln(r2/r1); F = 3 mu Q (r2^2 - r1^2)/h^3; inertia -f rho Q^2/(2 pi h^2) (ln(r2/r1) - (1 - "
         "r1^2/r2^2)/2)",
         "lubrication, and laminar inertia to first order",
         {{"flow", "m^3/s", "of the jet", std::nullopt},
          {"gap", "m", "", std::nullopt},
          {"nozzle_radius", "m", "", std::nullopt},
          {"plate_radius", "m", "", std::nullopt},
          viscosity,
          density},
         radial},
        {"jet_film", "Film of a jet in the middle of an elliptic base",
         "F = A3/h^3 - B2/h^2; viscous part 6 mu Q a^2 b^2/((a^2 + b^2) h^3)",
         "lubrication on the ellipse (torsion function), inertia on the circle of equal film",
         with(ellipse,
              {{"nozzle_radius", "m", "", std::nullopt},
               {"flow", "m^3/s", "of the jet", std::nullopt},
               {"gap", "m", "", 1e-3},
               {"inertia_factor", "1", "1/2 inviscid, 3/5 momentum integral, 27/35 laminar", laminar_film_factor},
               viscosity,
               density}),
         film_of_jet},
        {"squeeze", "Film under an elliptic base whose gap changes: damping and added mass near the ground",
         "c = 12 mu G/h^3, m = rho G/h, G = pi a^3 b^3/(4 (a^2 + b^2))", "Stefan 1874 for the circle",
         with(ellipse, {{"gap", "m", "", std::nullopt}, viscosity, density}), squeeze},
        {"jet",
         "Jet of a given thrust: velocity, flow, Reynolds numbers",
         "F = rho Q^2/A",
         "momentum",
         {{"thrust", "N", "", std::nullopt},
          {"diameter", "m", "of the nozzle", std::nullopt},
          density,
          {"kinematic_viscosity", "m^2/s", "of the water", 1.0e-6},
          {"half_length", "m", "half axis of the body in plan", 0.1016},
          {"half_width", "m", "half axis across", 0.076}},
         jet},
    };
}

}  // namespace underbody::dynamics
