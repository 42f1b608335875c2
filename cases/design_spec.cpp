#include "cases/design_spec.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/exact_body.h"
#include "geometry/body/variants.h"
#include "surrogates/tables/search/sampling.h"

namespace underbody::cases {

using core::FileTable;
using core::TomlTable;
using tables::Objective;

const std::vector<std::string>& geometry_measures() {
    static const std::vector<std::string> names = {"volume"};
    return names;
}

namespace {

const std::vector<std::string> plans = {"sobol", "latin_hypercube"};
const std::vector<std::string> senses = {"minimise", "maximise", "target"};

std::string shape_unit(const std::string& key, const core::Place& place) {
    std::vector<std::string> known;
    for (const auto& p : geometry::parameter_names()) {
        if (p.name == key && !p.unit.empty()) {
            return p.unit;
        }
        if (!p.unit.empty()) {
            known.push_back(p.name);
        }
    }
    throw core::InputError("name", "a shape has no number '" + key + "'", place, core::did_you_mean(key, known));
}

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
    return values;
}

tables::SearchVariable variable_from(const TomlTable& table) {
    tables::SearchVariable v;
    v.name = table.string("key");
    v.unit = shape_unit(v.name, table.place("key"));
    v.lower = table.quantity("from", v.unit);
    v.upper = table.quantity("to", v.unit);
    v.logarithmic = table.boolean_or("logarithmic", false);
    if (!(v.lower < v.upper)) {
        throw core::InputError("range", table.path_of("from") + " is not below to: the range is empty",
                               table.place("from"), "from = \"1 mm\", to = \"3 mm\"");
    }
    if (v.logarithmic && !(v.lower > 0)) {
        throw core::InputError("range", table.path_of("from") + " must be above zero on a logarithmic range",
                               table.place("from"));
    }
    return v;
}

TieSpec tie_from(const TomlTable& table) {
    TieSpec tie;
    tie.key = table.string("key");
    tie.of = table.string("of");
    const std::string unit = shape_unit(tie.key, table.place("key"));
    if (shape_unit(tie.of, table.place("of")) != unit) {
        throw core::InputError("unit", tie.key + " cannot be tied to " + tie.of + ": they are not of one kind",
                               table.place("of"));
    }
    tie.factor = table.quantity_or("factor", "1", 1);
    tie.offset = table.quantity_or("offset", unit, 0);
    return tie;
}

/// A response with the conditions of `at`; conditions that have one value need not be said.
tables::Response response_from(const TomlTable& table, const DesignSpec& spec) {
    tables::Response r;
    r.quantity = table.string("quantity");
    if (std::find(spec.quantities.begin(), spec.quantities.end(), r.quantity) == spec.quantities.end()) {
        throw core::InputError("quantity",
                               table.path_of("quantity") + ": " + r.quantity + " is none of design.quantities",
                               table.place("quantity"), core::did_you_mean(r.quantity, spec.quantities));
    }
    r.slope_along = table.string_or("slope_along", "");
    r.name = r.quantity;
    const TomlTable at = table.table_or_empty("at");
    std::set<std::string> known;
    for (const auto& v : spec.all_variables()) {
        if (!v.of_shape) {
            known.insert(v.name);
            if (!at.has(v.name)) {
                throw core::InputError("missing", table.path_of("at") + " does not say at which " + v.name,
                                       table.place(), "at = { " + v.name + " = ... }");
            }
            r.conditions.push_back({v.name, at.quantity(v.name, v.unit)});
            r.name += "_" + v.name +
                      core::format_number(core::convert(r.conditions.back().value, v.unit,
                                                        v.unit == "m"     ? "mm"
                                                        : v.unit == "rad" ? "deg"
                                                                          : v.unit),
                                          6);
        }
    }
    if (!r.slope_along.empty()) {
        if (!known.contains(r.slope_along)) {
            throw core::InputError(
                "condition",
                table.path_of("slope_along") + ": " + r.slope_along + " does not vary; it needs two values in [design]",
                table.place("slope_along"), core::did_you_mean(r.slope_along, {known.begin(), known.end()}));
        }
        const std::string unit = core::find_quantity(r.slope_along)->unit;
        r.half_width = table.quantity_or("half_width", unit, unit == "rad" ? 0.0174532925199433 : 1e-3);
        r.name += "_slope";
    }
    r.name = table.string_or("name", r.name);
    return r;
}

Objective objective_from(const TomlTable& table, const DesignSpec& spec) {
    Objective objective;
    objective.response = response_from(table, spec);
    const std::string sense = table.choice("sense", senses);
    objective.sense = sense == "minimise"   ? Objective::Sense::minimise
                      : sense == "maximise" ? Objective::Sense::maximise
                                            : Objective::Sense::target;
    if (objective.sense == Objective::Sense::target) {
        objective.target = table.quantity("target", core::find_quantity(objective.response.quantity)->unit);
    }
    return objective;
}

void limit_from(const TomlTable& table, DesignSpec& spec) {
    const bool geometry = table.has("measure");
    const std::string measure = geometry ? table.choice("measure", geometry_measures()) : "";
    if (!geometry && core::find_quantity(table.string("quantity")) == nullptr) {
        (void)response_from(table, spec);  // says what is wrong with it
    }
    const std::string unit = geometry ? "m^3" : core::find_quantity(table.string("quantity"))->unit;
    const auto lower = table.find_quantity("at_least", unit), upper = table.find_quantity("at_most", unit);
    if (!lower && !upper) {
        throw core::InputError("missing", table.path_of("at_least") + " and at_most are missing", table.place(),
                               "a limit needs one of them");
    }
    if (geometry) {
        spec.geometry_limits.push_back({measure, lower.value_or(-1e300), upper.value_or(1e300)});
    } else {
        spec.limits.push_back({response_from(table, spec), lower.value_or(-1e300), upper.value_or(1e300)});
    }
}

}  // namespace

std::vector<tables::SearchVariable> DesignSpec::all_variables() const {
    std::vector<tables::SearchVariable> all = variables;
    const auto add = [&](const char* name, const char* unit, const std::vector<double>& values, bool logarithmic) {
        if (values.size() > 1) {
            all.push_back({name, unit, values.front(), values.back(), logarithmic && values.front() > 0, false});
        }
    };
    add("gap", "m", gaps, true);
    add("pitch", "rad", pitches, false);
    add("speed", "m/s", speeds, true);
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
    spec.quantities = design.has("quantities") ? design.strings("quantities")
                                               : std::vector<std::string>{"lift_force", "drag_force", "pitch_moment"};
    for (const std::string& q : spec.quantities) {
        if (core::find_quantity(q) == nullptr) {
            throw core::InputError("quantity", design.path_of("quantities") + ": there is no quantity " + q,
                                   design.place("quantities"), "underbody list quantities");
        }
    }
    for (const TomlTable& table : design.tables("vary")) {
        spec.variables.push_back(variable_from(table));
    }
    if (spec.variables.empty()) {
        throw core::InputError("missing", "[design] varies nothing", design.place(),
                               "[[design.vary]] key = \"protrusion.height\", from = \"1 mm\", to = \"3 mm\"");
    }
    for (const TomlTable& table : design.tables("tie")) {
        spec.ties.push_back(tie_from(table));
    }
    std::set<std::string> names;
    for (const TomlTable& table : design.tables("fidelity")) {
        FidelitySpec f;
        f.name = table.string("name");
        f.cell = table.quantity_or("cell", "1", f.cell);
        f.surface_level = static_cast<int>(table.integer_or("surface_level", f.surface_level));
        f.layers = static_cast<int>(table.integer_or("layers", f.layers));
        f.iterations = static_cast<int>(table.integer_or("iterations", f.iterations));
        f.cost = table.quantity_or("cost", "s", 1);
        if (!names.insert(f.name).second) {
            throw core::InputError("name", table.path_of("name") + ": there are two fidelities " + f.name,
                                   table.place("name"));
        }
        spec.fidelities.push_back(f);
    }
    if (spec.fidelities.empty()) {
        spec.fidelities = {{"medium", 0.125, 3, 3, 400, 1}};
    }
    for (const TomlTable& table : design.tables("objective")) {
        spec.objectives.push_back(objective_from(table, spec));
    }
    for (const TomlTable& table : design.tables("limit")) {
        limit_from(table, spec);
    }
    return spec;
}

std::vector<FileTable> design_tables() {
    const core::FileKey at{"*", "1", "gap = \"5 mm\"", "", "a condition that takes several values in [design]"};
    const auto response = [](std::vector<core::FileKey> more) {
        std::vector<core::FileKey> keys = {
            {"quantity", "text", "\"lift_force\"", "", "one of design.quantities"},
            {"slope_along", "text", "\"pitch\"", "none", "its slope along this condition, not its value"},
            {"half_width", "rad or m or m/s", "\"1 deg\"", "1 deg, 1 mm, 1 mm/s",
             "the slope is the difference over twice this"},
            {"name", "text", "\"lift\"", "made of the others", "what it is called in tables"}};
        keys.insert(keys.end(), more.begin(), more.end());
        return keys;
    };
    return {{"design",
             "shapes to be tried: a plan, surrogates of what was computed, what to compute next, the best",
             {{"shape", "file", "\"shapes/evie.toml\"", "", "SHAPE.toml that is varied"},
              {"folder", "text", "\"design\"", "design", "of plan, shapes, runs and results, relative to this file"},
              {"plan", "sobol | latin_hypercube", "\"sobol\"", "sobol", "how the first designs fill the ranges"},
              {"points", "whole number", "24", "24", "designs of the first plan"},
              {"seed", "whole number", "1", "1", "of the plan and the searches"},
              {"gap", "m or list of m", "[\"3 mm\", \"5 mm\", \"10 mm\"]", "5 mm", "every design is computed at these"},
              {"pitch", "rad or list of rad", "[\"-1 deg\", \"1 deg\"]", "0", "and at these, positive nose up"},
              {"speed", "m/s or list of m/s", "\"0.5 m/s\"", "0.5 m/s", "and at these"},
              {"quantities", "list of texts", "[\"lift_force\", \"pitch_moment\"]",
               "lift_force, drag_force, pitch_moment", "loads that are learned"}}},
            {"design.vary[]",
             "a number of the shape and its range",
             {{"key", "text", "\"protrusion.height\"", "", "as in SHAPE.toml"},
              {"from", "unit of the key", "\"1 mm\"", "", "lower end"},
              {"to", "unit of the key", "\"3 mm\"", "", "upper end"},
              {"logarithmic", "true or false", "false", "false", "ratios count, not differences"}}},
            {"design.tie[]",
             "a number of the shape that follows another one",
             {{"key", "text", "\"protrusion.length\"", "", "the one that follows"},
              {"of", "text", "\"protrusion.height\"", "", "the one it follows"},
              {"factor", "1", "5", "1", "times this"},
              {"offset", "unit of the key", "\"0 mm\"", "0", "plus this"}}},
            {"design.fidelity[]",
             "a mesh; the cheapest first, the last is what counts",
             {{"name", "text", "\"coarse\"", "", "its folder below runs"},
              {"cell", "1", "0.125", "0.125", "as in [sweep]"},
              {"surface_level", "whole number", "3", "3", "as in [sweep]"},
              {"layers", "whole number", "3", "3", "as in [sweep]"},
              {"iterations", "whole number", "400", "400", "as in [sweep]"},
              {"cost", "s", "\"120 s\"", "1 s", "core-seconds of a case, to weigh what pays"}}},
            {"design.objective[]", "what is wanted; several make a front",
             response({{"sense", "minimise | maximise | target", "\"maximise\"", "", "which way"},
                       {"target", "unit of the quantity", "\"0 N m\"", "with sense = target", "the value wanted"}})},
            {"design.objective[].at", "the conditions it is taken at", {at}, false, "at = { gap = \"5 mm\" }"},
            {"design.limit[]", "what must hold: of a quantity, or of the body (measure)",
             [&] {
                 auto keys = response({{"measure", "volume", "\"volume\"", "a quantity instead",
                                        "of the body, known without a run", "quantity"},
                                       {"at_least", "its unit", "\"2 L\"", "none", "lower limit"},
                                       {"at_most", "its unit", "\"4 L\"", "none", "upper limit"}});
                 return keys;
             }()},
            {"design.limit[].at", "the conditions it is taken at", {at}, false, "at = { gap = \"5 mm\" }"}};
}

geometry::BodyShape shape_at(const DesignSpec& spec, const geometry::BodyShape& base, std::span<const double> at) {
    geometry::BodyShape shape = base;
    for (std::size_t v = 0; v < spec.variables.size(); ++v) {
        geometry::set_parameter(shape, spec.variables[v].name, core::format_number(at[v]));
    }
    for (const TieSpec& tie : spec.ties) {
        geometry::set_parameter(shape, tie.key,
                                core::format_number(tie.factor * geometry::parameter(shape, tie.of) + tie.offset));
    }
    geometry::check(shape);
    return shape;
}

double broken_by(const DesignSpec& spec, const geometry::BodyShape& base, std::span<const double> at) {
    try {
        const geometry::BodyShape shape = shape_at(spec, base, at);
        if (spec.geometry_limits.empty()) {
            return -1;
        }
        const geometry::ExactBody body(shape);
        double worst = -1;
        for (const GeometryLimit& limit : spec.geometry_limits) {
            const double value = body.volume();
            if (limit.upper < 1e299) {
                worst = std::max(worst, value / limit.upper - 1);
            }
            if (limit.lower > -1e299) {
                worst = std::max(worst, 1 - value / limit.lower);
            }
        }
        return worst;
    } catch (const core::InputError&) {
        return 1;
    }
}

}  // namespace underbody::cases
