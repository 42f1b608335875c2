// Closed forms of the vehicle (docs/physics.md sections 2, 3, 4 and 6): coefficients, springs, scaling, drag, jets, the
// run on the ground.
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/text.h"
#include "core/water.h"
#include "surrogates/dynamics/linear/linear.h"
#include "surrogates/dynamics/model/drag.h"
#include "surrogates/dynamics/model/jets.h"
#include "surrogates/dynamics/simulate/rigid_body.h"
#include "surrogates/dynamics/theory/film.h"
#include "surrogates/dynamics/theory/scaling.h"
#include "surrogates/dynamics/theory/theory.h"

namespace underbody::dynamics {

namespace {

using core::ClosedForm;
using Result = ClosedForm::Result;
using Values = ClosedForm::Values;

using core::degree;
constexpr std::nullopt_t needed = std::nullopt;

std::string number(double value) { return core::format_number(value, 3); }

/// Coefficient of the regression of x^3 on x and x|x| for x spread evenly about 0, and the correlation of x and x|x|:
/// from the moments 1/3, 1/4, 1/5, 1/6 of |x|^2 ... |x|^5.
struct UniformDrag {
    double correlation = 1.0 / 4 / std::sqrt(1.0 / 3 * (1.0 / 5));
    double linear = 0, quadratic = 0;
    UniformDrag() {
        const double determinant = 1.0 / 3 * (1.0 / 5) - 1.0 / 16;
        linear = (1.0 / 5 * (1.0 / 5) - 1.0 / 4 * (1.0 / 6)) / determinant;
        quadratic = (1.0 / 3 * (1.0 / 6) - 1.0 / 4 * (1.0 / 5)) / determinant;
    }
};

Result coefficients(const Values& v) {
    const double length = v("length"), width = v("width"), height = v("height"), speed = v("speed"),
                 nu = v("kinematic_viscosity");
    const double plan = plan_area(length, width), section = cross_section(width, height), rho = v("density");
    return {{{"plan_area", "m^2", plan, "pi/4 length width, of C_L and C_M"},
             {"cross_section", "m^2", section, "pi/4 width height, of C_D"},
             {"printed_cross_section", "m^2", printed_cross_section(length), "pi/4 length^2, which some print for C_D"},
             {"lift_coefficient", "1", lift_coefficient(v("lift_force"), rho, speed, plan), "2 F/(rho U^2 plan area)"},
             {"drag_coefficient", "1", lift_coefficient(v("drag_force"), rho, speed, section),
              "2 F/(rho U^2 cross section)"},
             {"reynolds", "1", reynolds_number(speed, length, nu), "U length/nu"},
             {"length_of_reynolds_40000", "m", 40000 * nu / speed, "that a Reynolds number of 40000 would take"}},
            {{"there is a stream: speed above 0", speed > 0}}};
}

Result spring(const Values& v) {
    const double k = v("stiffness"), mass = v("virtual_mass"), gap = v("gap"), frequency = spring_frequency(k, mass);
    const double given = v("angular_frequency") > 0 ? v("angular_frequency") : frequency;
    return {
        {{"angular_frequency", "rad/s", frequency, "sqrt(k/M)"},
         {"frequency", "Hz", frequency / (2 * std::numbers::pi), ""},
         {"survivable_kick", "m/s", survivable_kick(given, gap),
          "downward speed at the gap that just touches: omega h, of the frequency given or found"},
         {"mass_of_frequency", "kg", k / (given * given), "virtual mass that gives the frequency with this stiffness"},
         {"stiffness_of_frequency", "N/m", mass * given * given, "stiffness that gives it with this mass"}},
        {{"the force is linear in the gap down to contact, and nothing damps: real films stiffen, so that the kick is "
          "a lower estimate",
          true}}};
}

Result scaling(const Values& v) {
    const ScaleFactors f = scaled(v("size"), v("speed"));
    return {{{"force", "1", f.force, "factor on forces"},
             {"mass", "1", f.mass, "factor on masses"},
             {"force_per_mass", "1", f.force_per_mass, ""},
             {"stiffness", "1", f.stiffness, ""},
             {"frequency", "1", f.frequency, ""},
             {"gap", "1", f.gap, "the gap in chords stays"},
             {"kick", "1", f.kick, "factor on the survivable kick, omega h"}},
            {{"the force coefficient depends on the gap in chords alone: Reynolds number large, no jet", true}}};
}

Result voltage(const Values& v) {
    return {
        {{"exponent", "1", thrust_exponent(v("low_thrust"), v("high_thrust"), v("low_voltage"), v("high_voltage")),
          "of thrust against voltage through the two points"},
         {"upwash", "1", upwash_at_equilibrium(v("neutral_voltage"), v("voltage")),
          "film force over free thrust where the body balances: (V0/V)^2 - 1"}},
        {{"film force and thrust both grow with the square of the flow, which is proportional to the voltage", true}}};
}

Result drag_law(const Values& v) {
    const MixedDrag d(v("linear"), v("quadratic"), v("length"), v("kinematic_viscosity"));
    const double w = v("velocity");
    const UniformDrag uniform;
    Result result{{{"w1", "m/s", d.w1, "Reynolds number 1: linear below"},
                   {"w2", "m/s", d.w2, "Reynolds number 1000: quadratic above"}},
                  {}};
    for (int i = 0; i < 6; ++i) {
        result.outputs.push_back(
            {"c" + std::to_string(i), "N", d.c[i], "of the quintic between, in s = (w - w1)/(w2 - w1)"});
    }
    result.outputs.insert(
        result.outputs.end(),
        {{"force", "N", d(w), "at the velocity"},
         {"slope", "N s/m", d.slope(w), "there"},
         {"gaussian_factor", "1", gaussian_drag_factor, "linear damping over D w_rms, Gaussian velocity: sqrt(8/pi)"},
         {"harmonic_factor_of_amplitude", "1", harmonic_drag_factor_of_amplitude,
          "over D times the amplitude, harmonic velocity: 8/(3 pi)"},
         {"harmonic_factor", "1", harmonic_drag_factor, "over D w_rms, harmonic velocity"},
         {"uniform_correlation", "1", uniform.correlation, "of w and w|w|, w spread evenly"},
         {"uniform_cubic_on_linear", "1", uniform.linear, "regression of w^3 on w ..."},
         {"uniform_cubic_on_quadratic", "1", uniform.quadratic, "... and on w|w|, w spread evenly over -1 to 1"}});
    result.limits.push_back({"the quintic rises throughout", d.monotone});
    return result;
}

EvieJets layout_of(const Values& v) {
    EvieJets jets;
    jets.alpha = v("alpha");
    jets.beta = v("beta");
    jets.gamma = v("gamma");
    jets.turn_x = v("turn_x");
    jets.turn_y = v("turn_y");
    jets.turn_z = v("turn_z");
    jets.pitch_x = v("pitch_x");
    jets.pitch_upper = v("pitch_upper");
    jets.pitch_lower = v("pitch_lower");
    jets.bottom = v("bottom_depth");
    return jets;
}

Result jets(const Values& v) {
    const EvieJets layout = layout_of(v);
    const std::vector<Jet> all = evie_jets(layout);
    std::vector<double> thrust;
    for (const char* name : {"J1", "J2", "J3", "J4", "J5", "J6", "J7", "J8", "bottom"}) {
        thrust.push_back(v(name));
    }
    const Wrench w = jet_wrench(all, thrust);
    return {{{"force_x", "N", w.force[0], "forward"},
             {"force_y", "N", w.force[1], "to starboard"},
             {"force_z", "N", w.force[2], "down"},
             {"moment_x", "N m", w.moment[0], "starboard down, about the centre of gravity"},
             {"moment_y", "N m", w.moment[1], "nose up"},
             {"moment_z", "N m", w.moment[2], "bow to starboard"},
             {"pitch_free_beta", "rad", pitch_free_elevation(layout.turn_x, layout.turn_z, layout.gamma),
              "elevation of J1, J2, J5, J6 whose thrust makes no pitch moment"},
             {"pitch_free_beta_degrees", "deg",
              pitch_free_elevation(layout.turn_x, layout.turn_z, layout.gamma) / degree, "the same"},
             {"best_gamma", "rad", std::atan2(layout.turn_x, layout.turn_y),
              "angle of most yaw torque of a pair: tan = turn_x/turn_y"}},
            {{"the body is rigid and the jets do not act on its pressure", true}}};
}

Result munk(const Values& v) {
    const double c = v("added_mass_x") - v("added_mass_y");
    const double u = v("speed"), slip = v("sideslip");
    return {{{"yaw_coefficient", "kg", c, "C_mm = A_x - A_y"},
             {"pitch_coefficient", "kg", v("added_mass_z") - v("added_mass_x"), "A_z - A_x, of u w"},
             {"yaw_moment", "N m", munk_yaw_moment(c, u, slip), "bow to starboard, 1/2 C_mm U^2 sin(2 sideslip)"}},
            {{"ideal fluid without a wake, far from the ground", true}}};
}

Result surface(const Values& v) {
    SurfaceCoefficients c;
    c.mass_x = v("mass") + v("added_mass_x");
    c.mass_y = v("mass") + v("added_mass_y");
    c.inertia_r = v("yaw_inertia") + v("added_inertia_yaw");
    c.munk = v("added_mass_x") - v("added_mass_y");
    const double speed = v("speed"), friction = v("friction_force");
    const auto poles = yaw_transfer(c, speed, friction, {}).poles;
    const HeadingBounds bounds = heading_bounds(c, speed, friction);
    double high = poles[0].real(), low = poles[1].real();
    if (high < low) {
        std::swap(high, low);
    }
    return {{{"virtual_mass_x", "kg", c.mass_x, "S_x"},
             {"virtual_mass_y", "kg", c.mass_y, "S_y"},
             {"virtual_inertia_yaw", "kg m^2", c.inertia_r, "S_r"},
             {"upper_pole", "1/s", high, "of sway and yaw; positive: the heading runs away"},
             {"lower_pole", "1/s", low, ""},
             {"omega_squared", "1/s^2", bounds.omega_squared, "S_x |C_mm| U^2/(S_y S_r)"},
             {"least_heading_gain", "N m/rad", bounds.least_k2_without_friction, "S_r Om^2, without friction"}},
            {{"small sideslip and yaw rate; friction " + number(friction) + " N at its full size, opposite to the slip",
              true}}};
}

Result kinematics(const Values& v) {
    BodyState y{};
    y[state_u] = v("u");
    y[state_v] = v("v");
    y[state_w] = v("w");
    y[state_theta] = v("theta");
    y[state_psi] = v("psi");
    const Vector3 rate = RigidBody::world_velocity(y);
    return {{{"north", "m/s", rate[0], "forward where heading and pitch are 0"},
             {"east", "m/s", rate[1], ""},
             {"down", "m/s", rate[2], ""}},
            {{"roll is 0", true}}};
}

std::vector<ClosedForm::Input> jet_inputs() {
    std::vector<ClosedForm::Input> inputs;
    for (const char* name : {"J1", "J2", "J3", "J4", "J5", "J6", "J7", "J8", "bottom"}) {
        inputs.push_back({name, "N", "thrust of that jet", 0.0});
    }
    const std::vector<ClosedForm::Input> layout{{"alpha", "rad", "of the pitch jets from the vertical", 20 * degree},
                                                {"beta", "rad", "elevation of the turning jets", 20 * degree},
                                                {"gamma", "rad", "their angle inward", 35 * degree},
                                                {"turn_x", "m", "arm of the turning jets along x", 0.08},
                                                {"turn_y", "m", "across", 0.05},
                                                {"turn_z", "m", "above the centre of gravity", 0.03},
                                                {"pitch_x", "m", "arm of the pitch jets along x", 0.06},
                                                {"pitch_upper", "m", "of J3, J4 above the centre of gravity", 0.05},
                                                {"pitch_lower", "m", "of J7, J8 below it", 0.04},
                                                {"bottom_depth", "m", "of the bottom jet below it", 0.05}};
    inputs.insert(inputs.end(), layout.begin(), layout.end());
    return inputs;
}

}  // namespace

std::vector<core::ClosedForm> vehicle_forms() {
    const ClosedForm::Input density{"density", "kg/m^3", "of the water", core::default_water_density},
        viscosity{"kinematic_viscosity", "m^2/s", "of the water", 1.0e-6};
    const ClosedForm::Input ax{"added_mass_x", "kg", "A_x", needed}, ay{"added_mass_y", "kg", "A_y", needed};
    return {
        {"coefficients",
         "Reference areas, force coefficients and Reynolds number of a body",
         "C = 2 F/(rho U^2 S)",
         "definitions",
         {{"length", "m", "of the whole ellipsoid", needed},
          {"width", "m", "", needed},
          {"height", "m", "", needed},
          {"speed", "m/s", "", needed},
          {"lift_force", "N", "", 0.0},
          {"drag_force", "N", "", 0.0},
          density,
          viscosity},
         coefficients},
        {"spring",
         "Heave about a stable gap as a spring and a mass",
         "omega = sqrt(k/M), kick = omega h",
         "linear oscillator",
         {{"stiffness", "N/m", "", needed},
          {"virtual_mass", "kg", "mass and added mass", needed},
          {"gap", "m", "height that is left", 0.0},
          {"angular_frequency", "rad/s", "a frequency to be explained (0: the spring's own)", 0.0}},
         spring},
        {"scaling",
         "A vehicle of another size or at another speed",
         "F ~ size^2 speed^2, m ~ size^3, h ~ size",
         "similarity at one force coefficient",
         {{"size", "1", "factor on all lengths", 1.0}, {"speed", "1", "factor on the speed", 1.0}},
         scaling},
        {"voltage",
         "How thrust follows the pump's voltage",
         "F ~ V^n; film/thrust = (V0/V)^2 - 1",
         "power law through two points",
         {{"low_thrust", "N", "", 1.0},
          {"high_thrust", "N", "", 2.0},
          {"low_voltage", "V", "", 1.0},
          {"high_voltage", "V", "", 2.0},
          {"neutral_voltage", "V", "at which the jet alone carries the body", 10.0},
          {"voltage", "V", "", 10.0}},
         voltage},
        {"drag",
         "The mixed drag law and its linear equivalents",
         "D1 w below Re 1, D2 w|w| above Re 1000, a quintic between, twice differentiable",
         "Hermite data at both ends",
         {{"linear", "N s/m", "D1", needed},
          {"quadratic", "N s^2/m^2", "D2", needed},
          {"length", "m", "of the Reynolds number", needed},
          {"velocity", "m/s", "", 0.0},
          viscosity},
         drag_law},
        {"jets", "Force and moment of the nine jets of the reference vehicle", "sum F, sum r x F", "rigid-body statics",
         jet_inputs(), jets},
        {"munk",
         "Munk's moments of a body in ideal fluid",
         "N = 1/2 (A_x - A_y) U^2 sin(2 sideslip)",
         "Munk 1924",
         {ax, ay, {"added_mass_z", "kg", "A_z", 0.0}, {"speed", "m/s", "", needed}, {"sideslip", "rad", "", needed}},
         munk},
        {"surface",
         "Sway and yaw of a straight run over the ground",
         "s^2 + a s - Om^2 = 0, a = mu N/(U S_y), Om^2 = S_x |C_mm| U^2/(S_y S_r)",
         "linearised motion",
         {{"mass", "kg", "", needed},
          ax,
          ay,
          {"yaw_inertia", "kg m^2", "of the body", needed},
          {"added_inertia_yaw", "kg m^2", "", 0.0},
          {"speed", "m/s", "", needed},
          {"friction_force", "N", "mu N", 0.0}},
         surface},
        {"kinematics",
         "Velocity over the ground out of body velocity, pitch and heading",
         "Euler angles ZYX",
         "Fossen",
         {{"u", "m/s", "forward", needed},
          {"v", "m/s", "to starboard", 0.0},
          {"w", "m/s", "down", 0.0},
          {"theta", "rad", "pitch, nose up", 0.0},
          {"psi", "rad", "heading", 0.0}},
         kinematics},
    };
}

const std::vector<core::ClosedForm>& closed_forms() {
    static const std::vector<core::ClosedForm> all = [] {
        std::vector<core::ClosedForm> forms = film_forms(), vehicle = vehicle_forms();
        forms.insert(forms.end(), vehicle.begin(), vehicle.end());
        return forms;
    }();
    return all;
}

}  // namespace underbody::dynamics
