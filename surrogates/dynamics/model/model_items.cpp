#include "surrogates/dynamics/model/model_items.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text.h"
#include "surrogates/dynamics/model/lineage.h"
#include "surrogates/dynamics/model/matrix_algebra.h"

namespace underbody::dynamics {

namespace {

constexpr double inertia_rounding = 1e-9, weight_rounding = 1.0001;  ///< of numbers written with a few digits

constexpr const char* length_hint = "a bare number is metres: write it with its unit, such as \"203.2 mm\"";
constexpr const char* mass_hint = "a bare number is kilograms: write it with its unit, such as \"2200 g\"";
constexpr const char* force_hint = "a bare number is newtons; grams-force are \"gf\", so \"50 gf\" is 0.49 N";
constexpr const char* drag_hint = "a resistance is not negative; its unit is N s/m (linear) or N s^2/m^2 (quadratic)";
constexpr const char* none = "";

void add_vehicle(std::vector<ModelItem>& items) {
#define ITEM(key, unit, lower, upper, required, meaning, hint)                                                         \
    items.push_back({"vehicle", #key, unit, lower, upper, required, [](Model& m) -> double& { return m.vehicle.key; }, \
                     meaning, hint})
    ITEM(mass, "kg", 1e-3, 5e3, true, "mass of the vehicle", mass_hint);
    ITEM(added_mass_surge, "kg", 0, 5e4, false, "added mass along x", mass_hint);
    ITEM(added_mass_sway, "kg", 0, 5e4, false, "added mass along y", mass_hint);
    ITEM(added_mass_heave, "kg", 0, 5e4, false, "added mass along z; mass + added mass is the virtual mass in heave",
         mass_hint);
    ITEM(roll_inertia, "kg m^2", 1e-9, 1e6, false, "I_xx about the centre of gravity", "kg m^2, not kg mm^2");
    ITEM(pitch_inertia, "kg m^2", 1e-9, 1e6, false, "I_yy about the centre of gravity", "kg m^2, not kg mm^2");
    ITEM(yaw_inertia, "kg m^2", 1e-9, 1e6, false, "I_zz about the centre of gravity", "kg m^2, not kg mm^2");
    ITEM(added_inertia_roll, "kg m^2", 0, 1e6, false, "added inertia about x", "kg m^2");
    ITEM(added_inertia_pitch, "kg m^2", 0, 1e6, false, "added inertia about y", "kg m^2");
    ITEM(added_inertia_yaw, "kg m^2", 0, 1e6, false, "added inertia about z", "kg m^2");
    ITEM(inertia_product_xy, "kg m^2", -1e6, 1e6, false, "integral of x y dm about the centre of gravity", "kg m^2");
    ITEM(inertia_product_xz, "kg m^2", -1e6, 1e6, false, "integral of x z dm about the centre of gravity", "kg m^2");
    ITEM(inertia_product_yz, "kg m^2", -1e6, 1e6, false, "integral of y z dm about the centre of gravity", "kg m^2");
    ITEM(net_weight, "N", -5e4, 5e4, false, "weight less buoyancy, positive sinks", force_hint);
    ITEM(length, "m", 1e-3, 50, false, "length of the hull", length_hint);
    ITEM(width, "m", 1e-3, 50, false, "width of the hull", length_hint);
    ITEM(height, "m", 1e-3, 50, false, "height of the hull", length_hint);
    ITEM(buoyancy_height, "m", -10, 10, false, "centre of buoyancy above the centre of gravity", length_hint);
    ITEM(base_depth, "m", 0, 20, false, "base below the centre of gravity", length_hint);
    ITEM(base_half_length, "m", 1e-4, 25, false, "half length of the flat base", length_hint);
    ITEM(base_half_width, "m", 1e-4, 25, false, "half width of the flat base", length_hint);
    ITEM(drag_height, "m", -10, 10, false, "surge drag acts so far above the centre of gravity (nose-up moment)",
         length_hint);
#undef ITEM
}

void add_environment(std::vector<ModelItem>& items) {
#define ITEM(key, unit, lower, upper, meaning, hint)                 \
    items.push_back({"environment", #key, unit, lower, upper, false, \
                     [](Model& m) -> double& { return m.environment.key; }, meaning, hint})
    ITEM(density, "kg/m^3", 0.1, 2e4, "density of the water",
         "water is about 1000 kg/m^3; \"0.998 g/cm^3\" can be written so");
    ITEM(kinematic_viscosity, "m^2/s", 1e-8, 1e-2, "kinematic viscosity of the water",
         "water at 20 degC is 1.0e-6 m^2/s; the dynamic viscosity, 1.0e-3 Pa s, is another quantity");
    ITEM(temperature, "K", 200, 400, "temperature of the water", "a bare number is kelvin: write \"20 degC\"");
    ITEM(gravity, "m/s^2", 0, 100, "acceleration of gravity", none);
#undef ITEM
}

void add_drag(std::vector<ModelItem>& items) {
#define DIRECTION(section, member, linear_unit, quadratic_unit)                                                    \
    items.push_back({section, "linear", linear_unit, 0, 1e6, false,                                                \
                     [](Model& m) -> double& { return m.member.linear; }, "linear part of the resistance",         \
                     drag_hint});                                                                                  \
    items.push_back({section, "quadratic", quadratic_unit, 0, 1e7, false,                                          \
                     [](Model& m) -> double& { return m.member.quadratic; }, "quadratic part of the resistance",   \
                     drag_hint});                                                                                  \
    items.push_back({section, "length", "m", 1e-3, 50, false, [](Model& m) -> double& { return m.member.length; }, \
                     "length of the Reynolds number of the mixed law", length_hint})
    DIRECTION("drag.surge", drag_surge, "N s/m", "N s^2/m^2");
    DIRECTION("drag.sway", drag_sway, "N s/m", "N s^2/m^2");
    DIRECTION("drag.heave", drag_heave, "N s/m", "N s^2/m^2");
    DIRECTION("drag.pitch", drag_pitch, "N m s", "N m s^2");
    DIRECTION("drag.yaw", drag_yaw, "N m s", "N m s^2");
#undef DIRECTION
}

void add_contact(std::vector<ModelItem>& items) {
    items.push_back({"contact", "gap", "m", -10, 10, false, [](Model& m) -> double& { return m.contact.gap; },
                     "gap at which the body touches the ground", length_hint});
    items.push_back({"contact", "restitution", "1", 0, 1, false,
                     [](Model& m) -> double& { return m.contact.restitution; },
                     "speed after over speed before an impact", "between 0 (stays) and 1 (loses nothing)"});
    items.push_back({"contact", "friction", "1", 0, 5, false, [](Model& m) -> double& { return m.contact.friction; },
                     "kinetic coefficient of Coulomb friction on the ground", "a pure number, about 0.1 to 1"});
    items.push_back({"contact", "slip_speed", "m/s", 1e-7, 1, false,
                     [](Model& m) -> double& { return m.contact.slip_speed; },
                     "speed over which friction changes sign smoothly", none});
    items.push_back({"coupling", "limit_speed", "m/s", 1e-6, 1e3, false,
                     [](Model& m) -> double& { return m.coupling.limit_speed; },
                     "cross-flow that halves the jet's part (law sheltered)", none});
}

std::string number(double value) { return core::format_number(value, 6); }

}  // namespace

const std::vector<ModelItem>& model_items() {
    static const std::vector<ModelItem> items = [] {
        std::vector<ModelItem> all;
        add_vehicle(all);
        add_environment(all);
        add_drag(all);
        add_contact(all);
        return all;
    }();
    return items;
}

void check_item(const ModelItem& item, double value, const core::Place& place) {
    if (!std::isfinite(value) || value < item.lower || value > item.upper) {
        throw core::InputError("range",
                               std::string(item.section) + "." + item.key + " = " + number(value) + " " + item.unit +
                                   " cannot be: accepted is " + number(item.lower) + " to " + number(item.upper) + " " +
                                   item.unit,
                               place, item.hint);
    }
}

namespace {

/// The tensor must be that of a body: positive definite, each principal moment at most the sum of the other two.
void check_inertia(const Vehicle& v, const core::TomlTable& vehicle) {
    const bool products = v.inertia_product_xy != 0 || v.inertia_product_xz != 0 || v.inertia_product_yz != 0;
    if (std::isnan(v.roll_inertia) || std::isnan(v.pitch_inertia) || std::isnan(v.yaw_inertia)) {
        if (products) {
            throw core::InputError("missing", "products of inertia need roll_inertia, pitch_inertia and yaw_inertia",
                                   vehicle.place("mass"));
        }
        return;
    }
    const Matrix tensor{{v.roll_inertia, -v.inertia_product_xy, -v.inertia_product_xz},
                        {-v.inertia_product_xy, v.pitch_inertia, -v.inertia_product_yz},
                        {-v.inertia_product_xz, -v.inertia_product_yz, v.yaw_inertia}};
    std::vector<double> principal;
    for (const EigenPair& one : eigen(tensor)) {
        principal.push_back(one.value.real());
    }
    std::sort(principal.begin(), principal.end());
    const std::string text =
        "(" + number(principal[0]) + ", " + number(principal[1]) + ", " + number(principal[2]) + ") kg m^2";
    if (!(principal[0] > 0)) {
        throw core::InputError("range", "the inertia is not positive definite: its principal moments are " + text,
                               vehicle.place(products ? "inertia_product_xz" : "yaw_inertia"),
                               "a product of inertia is smaller than the root of the two moments beside it");
    }
    if (principal[0] + principal[1] < principal[2] * (1 - inertia_rounding)) {
        throw core::InputError(
            "range", "no body has the inertia " + text + ": each may be at most the sum of the other two",
            vehicle.place("yaw_inertia"), "added inertia is declared apart: added_inertia_roll, ...");
    }
}

void check_centres(const Vehicle& v, const core::TomlTable& vehicle) {
    if (v.buoyancy_height != 0 && (v.centre_of_gravity || v.centre_of_buoyancy)) {
        throw core::InputError("range", "buoyancy_height and the two centres say the same thing",
                               vehicle.place("buoyancy_height"),
                               "leave out buoyancy_height, or centre_of_gravity and centre_of_buoyancy");
    }
    const double size = std::isnan(v.length) ? 50 : v.length;
    for (const auto& [name, centre] :
         {std::pair{"centre_of_gravity", v.centre_of_gravity}, std::pair{"centre_of_buoyancy", v.centre_of_buoyancy}}) {
        if (centre && std::hypot((*centre)[0], (*centre)[1], (*centre)[2]) > size) {
            throw core::InputError("range", std::string("vehicle.") + name + " lies outside the hull",
                                   vehicle.place(name), length_hint);
        }
    }
}

}  // namespace

void check_model(Model& model, const core::TomlTable& root) {
    const Vehicle& v = model.vehicle;
    const core::TomlTable vehicle = root.table("vehicle");
    check_inertia(v, vehicle);
    check_centres(v, vehicle);
    if (!std::isnan(v.length) && !std::isnan(v.width)) {
        const double height = std::isnan(v.height) ? std::min(v.length, v.width) : v.height;
        const double displaced = model.environment.density * std::numbers::pi / 6 * v.length * v.width * height;
        if (v.mass > 30 * displaced || v.mass < displaced / 300) {
            throw core::InputError("range",
                                   "vehicle.mass = " + number(v.mass) +
                                       " kg, but a hull of that size displaces about " + number(displaced) + " kg",
                                   vehicle.place("mass"),
                                   std::string(mass_hint) + "; or the hull's size has another unit");
        }
        constexpr double most_added =
            300;  // times the displaced water: a flat base a hundredth of its length up has 10
        if (v.added_mass_heave > most_added * displaced) {
            throw core::InputError("range",
                                   "vehicle.added_mass_heave = " + number(v.added_mass_heave) +
                                       " kg, but a hull of that size displaces about " + number(displaced) + " kg",
                                   vehicle.place("added_mass_heave"),
                                   "give it with its unit: added_mass_heave = \"1.754 kg\"");
        }
    }
    if (std::abs(v.net_weight) > v.mass * model.environment.gravity * weight_rounding && v.net_weight > 0) {
        throw core::InputError("range",
                               "vehicle.net_weight = " + number(v.net_weight) + " N is more than the whole weight, " +
                                   number(v.mass * model.environment.gravity) + " N",
                               vehicle.place("net_weight"), "net weight is weight less buoyancy, in newtons");
    }
    const DragLaw& heave = model.drag_heave;
    if (heave.linear == 0 && heave.quadratic == 0) {
        model.remarks.push_back({core::Problem::Severity::note,
                                 "no drag in heave: free motion will not settle unless an effect damps it",
                                 root.place("drag")});
    }
    for (const std::string& line : model.lineage.made_from) {
        if (line.starts_with(tied_line)) {
            model.remarks.push_back({core::Problem::Severity::warning,
                                     "its data could not well tell what was found from other effects (" +
                                         line.substr(tied_line.size()) +
                                         "): where nothing was measured the model may be wrong",
                                     root.place("lineage")});
        }
    }
}

}  // namespace underbody::dynamics
