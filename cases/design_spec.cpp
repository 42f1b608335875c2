#include "cases/design_spec.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "cases/volume_fault.h"
#include "core/error.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/exact_body.h"
#include "geometry/body/variants.h"
#include "geometry/water/placement.h"
#include "surrogates/tables/search/sampling.h"

namespace underbody::cases {

using core::TomlTable;

namespace {

const std::vector<std::string> plans = {"sobol", "latin_hypercube"};

std::vector<double> one_or_more(const TomlTable& table, const char* key, const char* unit, double fallback) {
    if (!table.has(key)) {
        return {fallback};
    }
    std::vector<double> values =
        table.is_array(key) ? table.quantities(key, unit) : std::vector<double>{table.quantity(key, unit)};
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    if (values.empty()) {
        throw core::InputError("empty", table.path_of(key) + " is empty", table.place(key));
    }
    const bool is_angle = std::string_view(unit) == "rad";
    for (const double value : values) {
        if (is_angle ? std::abs(value) >= std::numbers::pi / 2 : value <= 0) {
            throw core::InputError("range",
                                   table.path_of(key) + " is " + geometry::shown_value(value, unit, 6) +
                                       (is_angle ? ": it must lie within +-90 deg" : ": it must be above zero"),
                                   table.place(key));
        }
    }
    return values;
}

std::vector<std::string> quantities_of(const TomlTable& design) {
    if (!design.has("quantities")) {
        return {"lift_force", "drag_force", "pitch_moment"};
    }
    const auto is_load = [](const std::string& q) {
        return (q.ends_with("_force") || q.ends_with("_moment") || q == "pitch_moment_at_buoyancy") &&
               !q.starts_with("input_");
    };
    const std::vector<std::string> quantities = design.strings("quantities");
    std::set<std::string> seen;
    for (const std::string& q : quantities) {
        if (core::find_quantity(q) == nullptr || !is_load(q)) {
            throw core::InputError("quantity", design.path_of("quantities") + ": there is no load '" + q + "'",
                                   design.place("quantities"),
                                   core::did_you_mean(q, {"lift_force", "drag_force", "side_force", "pitch_moment",
                                                          "pitch_moment_at_buoyancy", "roll_moment", "yaw_moment"}));
        }
        if (!seen.insert(q).second) {
            throw core::InputError("name", design.path_of("quantities") + " says " + q + " twice",
                                   design.place("quantities"));
        }
    }
    if (quantities.empty()) {
        throw core::InputError("empty", design.path_of("quantities") + " is empty", design.place("quantities"),
                               "quantities = [\"lift_force\", \"pitch_moment\"]");
    }
    return quantities;
}

bool says_its_mesh(const TomlTable& table) {
    const auto keys = case_mesh_keys("medium");
    return std::any_of(keys.begin(), keys.end(), [&](const core::FileKey& key) { return table.has(key.name); });
}

FidelitySpec fidelity_from(const TomlTable& table) {
    FidelitySpec f;
    f.name = table.string("name");
    if (f.name.empty() || f.name == "." || f.name == ".." || f.name.find('/') != std::string::npos) {
        throw core::InputError("name", table.path_of("name") + ": '" + f.name + "' is no name of a folder",
                               table.place("name"), "name = \"coarse\"");
    }
    const auto& densities = geometry::density_names();
    if (std::find(densities.begin(), densities.end(), f.name) != densities.end()) {
        f.mesh.density = f.name;
    } else if (const std::string near = core::nearest_name(f.name, densities); !near.empty() && !says_its_mesh(table)) {
        throw core::InputError(
            "name", table.path_of("name") + ": '" + f.name + "' is no density of the mesh, and no mesh is said",
            table.place("name"), "did you mean '" + near + "'? Else say mesh_density");
    }
    f.mesh = read_case_mesh(table, f.mesh);
    f.cost = table.quantity_or("cost", "s", 1);
    if (!(f.cost > 0)) {
        throw core::InputError("range", table.path_of("cost") + " must be above zero", table.place("cost"),
                               "cost = \"120 s\"");
    }
    return f;
}

tables::SearchVariable variable_from(const TomlTable& table) {
    tables::SearchVariable v;
    v.name = table.string("key");
    for (const char* condition : {"gap", "pitch", "speed", "jet_flow", "jet_voltage"}) {
        if (v.name == condition) {
            throw core::InputError("name", v.name + " is a condition, not a number of the shape", table.place("key"),
                                   v.name +
                                       " = [...] in [design]: every design is computed at each, and surrogates know "
                                       "what lies between");
        }
    }
    v.unit = geometry::parameter_unit(v.name, table.place("key"));
    if (v.unit.empty()) {
        throw core::InputError("name", "'" + v.name + "' of a shape is a choice, not a number with a range",
                               table.place("key"), "a study for each choice, or 'body sweep' with its values");
    }
    v.lower = table.quantity("from", v.unit);
    v.upper = table.quantity("to", v.unit);
    v.logarithmic = table.boolean_or("logarithmic", false);
    if (!(v.lower < v.upper)) {
        throw core::InputError("range",
                               table.path_of("from") + " is " + geometry::shown_value(v.lower, v.unit, 6) +
                                   ", not below to, " + geometry::shown_value(v.upper, v.unit, 6) +
                                   ": the range is empty",
                               table.place("from"), "the lower end as from, the upper one as to");
    }
    if (v.logarithmic && !(v.lower > 0)) {
        throw core::InputError("range", table.path_of("from") + " must be above zero on a logarithmic range",
                               table.place("from"));
    }
    return v;
}

/// What is varied, and what follows it.
void read_variables(const TomlTable& design, DesignSpec& spec) {
    std::set<std::string> varied, tied;
    for (const TomlTable& table : design.tables("vary")) {
        spec.variables.push_back(variable_from(table));
        if (!varied.insert(spec.variables.back().name).second) {
            throw core::InputError("name", table.path_of("key") + ": " + spec.variables.back().name + " varies twice",
                                   table.place("key"));
        }
    }
    if (spec.variables.empty()) {
        throw core::InputError("missing", "[design] varies nothing", design.place(),
                               "[[design.vary]] key = \"protrusion.height\", from = \"1 mm\", to = \"3 mm\"");
    }
    for (const TomlTable& table : design.tables("tie")) {
        spec.ties.push_back(geometry::tie_from(table));
        const std::string& key = spec.ties.back().key;
        if (varied.contains(key) || !tied.insert(key).second) {
            throw core::InputError("name",
                                   table.path_of("key") + ": " + key +
                                       (varied.contains(key) ? " varies by itself, too" : " is tied twice"),
                                   table.place("key"), "[[design.vary]] or one [[design.tie]] of it");
        }
    }
}

void read_fidelities(const TomlTable& design, DesignSpec& spec) {
    std::set<std::string> names;
    for (const TomlTable& table : design.tables("fidelity")) {
        const FidelitySpec f = fidelity_from(table);
        if (!names.insert(f.name).second) {
            throw core::InputError("name", table.path_of("name") + ": there are two fidelities " + f.name,
                                   table.place("name"));
        }
        spec.jet.check(f.mesh, design.place(spec.jet.quantity));
        spec.fidelities.push_back(f);
    }
    if (spec.fidelities.empty()) {
        spec.fidelities = {{"medium", {}, 1}};
    }
}

}  // namespace

std::vector<ComputedCondition> DesignSpec::conditions() const {
    std::vector<ComputedCondition> all{
        {"gap", "m", gaps, true}, {"pitch", "rad", pitches, false}, {"speed", "m/s", speeds, true}};
    if (jet.any()) {
        all.push_back({jet.quantity, jet.unit(), jet.values, false});
    }
    return all;
}

std::vector<tables::SearchVariable> DesignSpec::all_variables() const {
    std::vector<tables::SearchVariable> all = variables;
    for (const ComputedCondition& c : conditions()) {
        if (c.values.size() > 1) {
            const bool logarithmic = c.logarithmic && c.values.front() > 0;
            all.push_back({c.name, c.unit, c.values.front(), c.values.back(), logarithmic, false});
        }
    }
    return all;
}

DesignSpec read_design(const TomlTable& design, const std::filesystem::path& study_folder) {
    DesignSpec spec;
    spec.shape = design.file("shape");
    spec.folder = study_folder / design.string_or("folder", "design");
    spec.plan = design.choice("plan", plans, "sobol");
    const std::int64_t points = design.integer_or("points", 24);
    if (points < 1 || points > 100000) {
        throw core::InputError("range", design.path_of("points") + " is " + std::to_string(points),
                               design.place("points"), "1 to 100000 designs");
    }
    spec.points = static_cast<std::size_t>(points);
    spec.seed = static_cast<std::uint64_t>(design.integer_or("seed", 1));
    spec.gaps = one_or_more(design, "gap", "m", 5e-3);
    spec.pitches = one_or_more(design, "pitch", "rad", 0);
    spec.speeds = one_or_more(design, "speed", "m/s", 0.5);
    spec.jet = read_jet_axis(design);
    spec.kinematic_viscosity = design.quantity_or("kinematic_viscosity", "m^2/s", spec.kinematic_viscosity);
    if (!(spec.kinematic_viscosity > 0)) {
        throw core::InputError("range", design.path_of("kinematic_viscosity") + " must be above zero",
                               design.place("kinematic_viscosity"), "kinematic_viscosity = \"1.0e-6 m^2/s\"");
    }
    spec.quantities = quantities_of(design);
    spec.net_weight = design.find_quantity("net_weight", "N");
    spec.virtual_mass = design.quantity_or("virtual_mass", "kg", 0);
    if (!(spec.virtual_mass >= 0)) {
        throw core::InputError("range", design.path_of("virtual_mass") + " must not be negative",
                               design.place("virtual_mass"), "mass and added mass in heave");
    }
    read_variables(design, spec);
    read_fidelities(design, spec);
    read_wishes(design, spec);
    return spec;
}

std::size_t level_of(const DesignSpec& spec, const std::string& fidelity, const std::string& where) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < spec.fidelities.size(); ++i) {
        if (spec.fidelities[i].name == fidelity) {
            return i;
        }
        names.push_back(spec.fidelities[i].name);
    }
    throw core::InputError("name", where + ": there is no fidelity '" + fidelity + "' in [design]", {},
                           core::did_you_mean(fidelity, names));
}

geometry::BodyShape shape_at(const DesignSpec& spec, const geometry::BodyShape& base, std::span<const double> at) {
    geometry::BodyShape shape = base;
    for (std::size_t v = 0; v < spec.variables.size(); ++v) {
        geometry::set_parameter(shape, spec.variables[v].name, core::format_number(at[v]));
    }
    for (const geometry::Tie& tie : spec.ties) {
        geometry::apply(tie, shape);
    }
    if (shape.protrusion && shape.protrusion->height == 0) {
        shape.protrusion.reset();  // none at the end of its range
    }
    geometry::check(shape);
    return shape;
}

namespace {

/// Of the condition at which it comes nearest to the ground: how far it stands below it, over that gap.
double below_ground(const DesignSpec& spec, const geometry::BodyShape& shape) {
    double worst = -1;
    const std::vector<double> lowest = geometry::clearances_of_base(shape, spec.pitches);
    for (const double gap : spec.gaps) {
        for (const double low : lowest) {
            worst = std::max(worst, -(gap + low) / gap);
        }
    }
    return worst;
}

}  // namespace

double broken_by(const DesignSpec& spec, const geometry::BodyShape& base, std::span<const double> at) {
    try {
        const geometry::BodyShape shape = shape_at(spec, base, at);
        double worst = below_ground(spec, shape);
        if (!limits_volume(spec)) {
            return worst;
        }
        const double volume = geometry::ExactBody(shape).volume();
        worst = std::max(worst, core::is_limit(spec.most_volume) ? volume / spec.most_volume - 1 : -1);
        if (spec.least_volume > 0) {
            worst = std::max(worst, 1 - volume / spec.least_volume);
        }
        return worst;
    } catch (const core::InputError&) {
        return 1;
    }
}

bool same_numbers(const std::vector<tables::SearchVariable>& variables, std::span<const double> a,
                  std::span<const double> b) {
    for (std::size_t v = 0; v < variables.size(); ++v) {
        if (std::abs(a[v] - b[v]) > 1e-7 * (variables[v].upper - variables[v].lower)) {
            return false;
        }
    }
    return true;
}

}  // namespace underbody::cases
