// The loads against what was stated of them.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/counted.h"
#include "core/text.h"
#include "postproc/field/vector_math.h"
#include "postproc/loads/deviation.h"
#include "postproc/loads/stated_loads.h"
#include "postproc/loads/stated_parts.h"

namespace underbody::postproc {

namespace {

struct Covered {
    Wrench total, pressure, viscous;
    std::string missing;  ///< a zone that is not there
};

void add_to(Wrench& sum, const Wrench& more) { sum = {plus(sum.force, more.force), plus(sum.moment, more.moment)}; }

Covered covered_by(const LoadsResult& result, const std::vector<std::string>& zones) {
    if (zones.empty()) {
        return {result.total, result.pressure, result.viscous, {}};
    }
    Covered sum;
    for (const auto& name : zones) {
        const std::string wanted = core::lower_case(name);
        const auto zone = std::find_if(result.zones.begin(), result.zones.end(),
                                       [&](const ZoneLoads& z) { return core::lower_case(z.name) == wanted; });
        if (zone == result.zones.end()) {
            sum.missing = name;
            return sum;
        }
        add_to(sum.pressure, zone->pressure);
        add_to(sum.viscous, zone->viscous);
    }
    add_to(sum.total, sum.pressure);
    add_to(sum.total, sum.viscous);
    return sum;
}

/// Both halves of a body cancel this quantity, or one half's number says nothing about it.
bool cancelled_by_symmetry(const LoadsResult& result, const StatedLoad& load) {
    if (result.mirror_axis < 0) {
        return false;
    }
    const double along = std::abs(load.direction[static_cast<std::size_t>(result.mirror_axis)]);
    return load.moment ? along < 1 - 1e-6 : along > 1e-6;
}

std::string label(const LoadsResult& result, const StatedLoad& load) {
    std::string text = load.quantity;
    for (const auto& axis : named_axes(result)) {
        const bool here =
            !load.moment || norm(plus(load.centre, result.reference, -1)) < 1e-9 + 1e-6 * std::sqrt(result.area);
        if (axis.moment == load.moment && here && dot(axis.direction, load.direction) > 1 - 1e-9) {
            text = axis.name;
        }
    }
    text = load.part == LoadPart::pressure  ? "pressure part of " + text
           : load.part == LoadPart::viscous ? "viscous part of " + text
                                            : text;
    if (!load.zones.empty() && load.zones.size() < result.zones.size()) {
        text += " on";
        for (const auto& zone : load.zones) {
            text += " '" + zone + "'";
        }
    }
    return text;
}

/// A report of another time than the field's: OpenFOAM writes times with six digits unless told otherwise.
bool of_another_time(const LoadsResult& result, const StatedLoad& load) {
    constexpr double written = 1e-5;
    return result.time && load.time &&
           std::abs(*load.time - *result.time) > written * std::max(std::abs(*load.time), std::abs(*result.time));
}

/// So far off that its numbers say nothing of this field; a row of the next step may still be the one.
bool of_a_far_time(const LoadsResult& result, const StatedLoad& load) {
    constexpr double far = 0.1;
    return of_another_time(result, load) &&
           std::abs(*load.time - *result.time) > far * std::max(std::abs(*load.time), std::abs(*result.time));
}

/// The largest component of the whole force that the same file states of the same zones.
double largest_stated_force(const std::vector<StatedLoad>& stated, const StatedLoad& like) {
    double largest = 0;
    for (const auto& load : stated) {
        if (!load.moment && load.part == LoadPart::total && load.file == like.file && load.zones == like.zones) {
            largest = std::max(largest, std::abs(load.value));
        }
    }
    return largest;
}

/// Notes about what is stated, each once for a file (or a zone).
class Notes {
public:
    explicit Notes(core::Problems& problems) : problems_(problems) {}

    void of_report(const LoadsResult& result, const StatedLoad& load) {
        const auto shown = [](double time) { return core::format_number(time, 9); };
        if (load.earlier > 0) {
            once("repeated", load.file, core::Problem::Severity::note,
                 std::to_string(load.earlier + 1) + " reports of the " + load.quantity +
                     ": the last of each quantity is compared",
                 load.file);
        }
        if (load.zones_unknown) {
            once("zones unknown", load.file, core::Problem::Severity::warning,
                 "system/controlDict does not say which patches these forces are of: compared with those on all zones "
                 "summed",
                 load.file);
        }
        if (of_another_time(result, load)) {
            once("time", load.file, core::Problem::Severity::warning,
                 "there is no row of the field's time " + shown(*result.time) + ": " +
                     (of_a_far_time(result, load)
                          ? "the nearest, of " + shown(*load.time) + ", is too far off to be compared"
                          : "the field is compared with the row of " + shown(*load.time)),
                 load.file);
        }
        if (load.later > 0) {
            once("later", load.file, core::Problem::Severity::note,
                 "the field is of " + shown(*load.time) + ": " +
                     core::counted(load.later, "later row is", "later rows are") + " not of it",
                 load.file);
        }
    }
    void of_missing(const std::string& zone, const std::string& file) {
        once("missing", zone, core::Problem::Severity::warning,
             "the report's zone '" + zone + "' is not among those integrated: its rows are not compared", file);
    }
    void of_halves(std::size_t cancelled) {
        const std::string more =
            cancelled > 0 ? ", and " + std::to_string(cancelled) + " that both halves cancel are left out" : "";
        once("halves", {}, core::Problem::Severity::note, "a half model: the solver's numbers are doubled" + more, {});
    }

private:
    void once(const std::string& what, const std::string& of, core::Problem::Severity severity,
              const std::string& message, const std::string& file) {
        if (said_.emplace(what, of).second) {
            problems_.push_back({severity, message, {file, {}, {}, {}}});
        }
    }

    core::Problems& problems_;
    std::set<std::pair<std::string, std::string>> said_;
};

}  // namespace

namespace {

/// What a deviation looks like that is none of the numbers: the other sign, or one of them of half the body.
std::string hint_for(const Comparison& one, bool moment, const LoadScale& scale) {
    constexpr double large = 0.3;
    constexpr double alike = 0.05;
    if (!(one.of_force > large)) {
        return {};
    }
    const auto fits = [&](double factor) {
        return deviation(one.value, factor * one.stated, moment, scale) < alike * one.of_force;
    };
    return fits(-1) ? "it has the other sign: stated along the opposite direction? A monitor is turned round by \"" +
                          one.quantity + " [-1 " + (moment ? "N m" : "N") + "]=FILE\""
           : fits(2)   ? "twice of it would fit: is what is stated that of half the body?"
           : fits(0.5) ? "half of it would fit: is the field that of half the body?"
                       : "";
}

}  // namespace

std::vector<Comparison> compare_with_solver(const LoadsResult& result, const std::vector<StatedLoad>& stated,
                                            core::Problems& problems) {
    std::vector<Comparison> comparisons;
    Notes notes(problems);
    const double halves = result.mirror_axis >= 0 ? 2 : 1;
    std::size_t cancelled = 0;
    for (const auto& load : stated) {
        if (cancelled_by_symmetry(result, load)) {
            ++cancelled;
            continue;
        }
        const Covered body = covered_by(result, load.zones);
        if (!body.missing.empty()) {
            notes.of_missing(body.missing, load.file);
            continue;
        }
        notes.of_report(result, load);
        if (of_a_far_time(result, load)) {
            continue;
        }
        const Wrench& wrench = load.part == LoadPart::pressure  ? body.pressure
                               : load.part == LoadPart::viscous ? body.viscous
                                                                : body.total;
        const Vector moment = plus(wrench.moment, cross(plus(result.reference, load.centre, -1), wrench.force));
        Comparison one;
        one.file = result.file;
        one.quantity = label(result, load);
        one.stated_in = load.file;
        one.value = dot(load.moment ? moment : wrench.force, load.direction);
        one.stated = halves * load.value;
        const LoadScale scale =
            load_scale(norm(body.total.force), halves * largest_stated_force(stated, load), result.length);
        one.of_force = deviation(one.value, one.stated, load.moment, scale);
        one.hint = hint_for(one, load.moment, scale);
        comparisons.push_back(std::move(one));
    }
    if (result.mirror_axis >= 0 && !stated.empty()) {
        notes.of_halves(cancelled);
    }
    return comparisons;
}

void to_json(nlohmann::json& json, const Comparison& c) {
    json = {{"quantity", c.quantity},
            {"value", c.value},
            {"stated", c.stated},
            {"difference", c.value - c.stated},
            {"of_force", c.of_force}};
    if (!c.stated_in.empty()) {
        json["stated_in"] = c.stated_in;
    }
    if (!c.hint.empty()) {
        json["hint"] = c.hint;
    }
}

std::vector<std::pair<std::string, double>> iteration_sigmas(const LoadsResult& result,
                                                             const std::vector<StatedLoad>& stated) {
    std::vector<std::pair<std::string, double>> sigmas;
    for (const auto& load : stated) {
        if (!load.history || load.part != LoadPart::total || cancelled_by_symmetry(result, load)) {
            continue;
        }
        if (!load.zones.empty() && load.zones.size() < result.zones.size()) {
            continue;  // not the whole body
        }
        const double sigma = (result.mirror_axis >= 0 ? 2 : 1) * load.history->standard_uncertainty;
        const auto found =
            std::find_if(sigmas.begin(), sigmas.end(), [&](const auto& entry) { return entry.first == load.quantity; });
        if (found == sigmas.end()) {
            sigmas.emplace_back(load.quantity, sigma);
        } else {
            found->second = sigma;  // what the user named counts over what lies beside
        }
    }
    return sigmas;
}

}  // namespace underbody::postproc
