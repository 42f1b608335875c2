#include "cases/design_curves.h"

#include <algorithm>

#include "core/error.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "core/told.h"
#include "geometry/body/variants.h"

namespace underbody::cases {

using core::InputError;
using core::TomlTable;
using tables::Curve;
using tables::CurveAsked;
using tables::Response;

namespace {

constexpr std::size_t fewest = 3;  // two values make a line, which turns nowhere

void need_several(const std::string& condition, std::size_t count, const Response& r, const core::Place& place) {
    if (count < fewest) {
        throw InputError("missing",
                         "\"" + r.name + "\" is a number of a curve over the " + condition +
                             ", of which [design] has " + std::to_string(count) + (count == 1 ? " value" : " values"),
                         place, "three at least: " + condition + " = [...] of [design]");
    }
}

void need_load(const std::string& quantity, const DesignSpec& spec, const Response& r, const core::Place& place) {
    if (std::find(spec.quantities.begin(), spec.quantities.end(), quantity) == spec.quantities.end()) {
        throw InputError("quantity",
                         "\"" + r.name + "\" is made of " + quantity + ", which is none of design.quantities", place,
                         core::did_you_mean(quantity, spec.quantities));
    }
}

double weight_for(const DesignSpec& spec, const Response& r, const core::Place& place) {
    if (!spec.net_weight) {
        throw InputError("missing",
                         "\"" + r.name + "\" asks for the balance of lift and net weight, and [design] states none",
                         place, "net_weight = \"0.3 N\" in [design]: weight less buoyancy");
    }
    return *spec.net_weight;
}

void refuse(const TomlTable& table, const char* key, const Response& r, const std::string& what) {
    if (table.has(key)) {
        throw InputError("name", table.path_of(key) + ": \"" + r.name + "\" " + what, table.place(key));
    }
}

void read_kick(const TomlTable& table, const DesignSpec& spec, Response& r) {
    CurveAsked& asked = *r.curve;
    const core::Place place = table.place();
    r.quantity = "lift_force";
    for (const char* key : {"quantity", "restoring", "moment_at_most"}) {
        refuse(table, key, r, "is made of the lift alone");
    }
    asked.net_weight = weight_for(spec, r, place);
    asked.virtual_mass = spec.virtual_mass;
    if (!(asked.virtual_mass > 0)) {
        throw InputError("missing", "\"" + r.name + "\" is a velocity by a mass, and [design] states none", place,
                         "virtual_mass = \"3.954 kg\" in [design]: mass and added mass in heave");
    }
    if (std::any_of(r.conditions.begin(), r.conditions.end(), [](const auto& c) { return c.name == "gap"; })) {
        throw InputError("condition", "\"" + r.name + "\" runs over the gap: it is at none", place,
                         "leave the gap out of at");
    }
}

void read_window(const TomlTable& table, const DesignSpec& spec, Response& r) {
    CurveAsked& asked = *r.curve;
    asked.restoring = table.boolean_or("restoring", false);
    asked.most_moment = table.quantity_or("moment_at_most", "N m", core::no_limit);
    if (!(asked.most_moment > 0)) {
        throw InputError("range", table.path_of("moment_at_most") + " must be above zero",
                         table.place("moment_at_most"), "moment_at_most = \"0.005 N m\"");
    }
    const auto about =
        std::find_if(r.conditions.begin(), r.conditions.end(), [](const auto& c) { return c.name == "pitch"; });
    if (about != r.conditions.end()) {
        asked.about = about->value;
        r.conditions.erase(about);
    }
    const bool at_a_gap = spec.gaps.size() == 1 || std::any_of(r.conditions.begin(), r.conditions.end(),
                                                               [](const auto& c) { return c.name == "gap"; });
    if (!at_a_gap) {
        asked.net_weight = weight_for(spec, r, table.place());
    }
    if (asked.of_moment()) {
        asked.moment = table.string_or("quantity", "pitch_moment");
        need_load(asked.moment, spec, r, table.place());
    } else {
        refuse(table, "quantity", r, "asks nothing of it (restoring = true, moment_at_most = \"0.005 N m\")");
    }
    if (at_a_gap && !asked.of_moment()) {
        throw InputError("missing", "\"" + r.name + "\" is a window at a stated gap of which nothing is asked",
                         table.place(),
                         "restoring = true, moment_at_most = \"0.005 N m\", or no gap: then a stable balance with "
                         "net_weight is");
    }
    r.quantity = at_a_gap ? asked.moment : "lift_force";
    need_several("pitch", spec.pitches.size(), r, table.place());
    if (!(asked.about > spec.pitches.front() && asked.about < spec.pitches.back())) {
        throw InputError("range",
                         "\"" + r.name + "\" lies about a pitch of " + geometry::shown_value(asked.about, "rad", 6) +
                             ", and [design] computes " + geometry::shown_value(spec.pitches.front(), "rad", 6) +
                             " to " + geometry::shown_value(spec.pitches.back(), "rad", 6),
                         table.place(), "a pitch between them");
    }
}

}  // namespace

void read_curve(const TomlTable& table, const DesignSpec& spec, Response& r) {
    for (const char* key : {"slope_along", "half_width"}) {
        refuse(table, key, r, "is a number of curves, which has no slope");
    }
    CurveAsked asked;
    asked.curve = *tables::curve_named(table.choice("curve", tables::curve_names()));
    r.curve = asked;
    if (asked.curve == Curve::kick) {
        read_kick(table, spec, r);
    } else {
        read_window(table, spec, r);
    }
    if (r.curve->net_weight) {
        need_load("lift_force", spec, r, table.place());
        need_several("gap", spec.gaps.size(), r, table.place());
    }
}

std::vector<core::FileKey> curve_keys() {
    return {
        {"curve", "kick | pitch_window", "\"kick\"", "none",
         "a number of whole curves: the kick that the stable balance with net_weight survives (of the gaps); how far "
         "the pitch may go either way while it is stable and what follows holds (of the pitches, and of the gaps "
         "where `at` states none)",
         "quantity"},
        {"restoring", "true or false", "true", "false",
         "of a pitch window: `quantity`, a moment, falls as the nose rises"},
        {"moment_at_most", "N m", "\"0.005 N m\"", "none", "of a pitch window: the size of `quantity` stays below"}};
}

std::vector<core::FileKey> keys_for_curves() {
    return {{"net_weight", "N", "\"0.30 N\"", "none",
             "weight less buoyancy, whatever the shape: for kicks and pitch windows"},
            {"virtual_mass", "kg", "\"3.954 kg\"", "0", "mass and added mass: for kicks"}};
}

std::string told_response(const tables::ResponseValue& value, bool of_curves, const std::string& unit) {
    const std::string text = core::told(value.value, value.sigma, unit, 4);
    if (!of_curves) {
        return text;
    }
    return value.value < 0 ? "none (" + text + ")" : (value.at_least ? "at least " : "") + text;
}

}  // namespace underbody::cases
