// The pitch that was declared of cases against the tilt of the base in their files.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/angle.h"
#include "core/counted.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "postproc/field/field.h"
#include "postproc/loads/declared.h"

namespace underbody::postproc {

namespace {

using core::Problem;

std::string told_tilt(double rad) { return core::told(std::abs(rad) < 1e-5 ? 0 : rad, "rad", 4); }

/// Is one angle the other, times the degrees of a radian? `shown`: the one in the file, which has to be one.
bool is_turned_unit(double larger, double smaller, double shown) {
    constexpr double slack = 1.02, least = 0.3 * core::degree;
    const double ratio = larger * core::degree / smaller;
    return std::abs(shown) > least && ratio < slack && ratio > 1 / slack;
}

/// What to ask about a pitch that one case alone shows to be wrong, `tilt` NaN: no base is known; else empty.
std::string question_of_pitch(double pitch, double tilt) {
    constexpr double most = std::numbers::pi / 2, most_of_base = 15 * core::degree;  // as shapes may have it
    if (is_turned_unit(pitch, tilt, tilt) || (std::isnan(tilt) && std::abs(pitch) > most)) {
        return "is it in deg, and was read in rad?";
    }
    if (is_turned_unit(tilt, pitch, tilt)) {
        return "is it in rad, and was read in deg?";
    }
    return std::abs(pitch) > most || std::abs(pitch - tilt) > most_of_base + core::degree
               ? "is the unit right, and the file the one that was meant?"
               : "";
}

/// rad: by how much a pitch may be off for the digits that it is written with, as degrees.
double pitch_rounding(double pitch) {
    const std::string digits = core::format_number(pitch / core::degree, 9);
    const auto point = digits.find('.');
    const auto behind = point == std::string::npos ? 0 : static_cast<double>(digits.size() - point - 1);
    return digits.find('e') == std::string::npos ? 0.5 * core::degree * std::pow(10.0, -behind) : 0;
}

/// Of a case, what its file shows against what was said of it.
struct PitchOfCase {
    std::size_t at = 0;
    double pitch = 0, tilt = 0;
    [[nodiscard]] double off() const { return tilt - pitch; }
    [[nodiscard]] bool is_off(double offset) const {
        return std::abs(off() - offset) > 0.2 * core::degree + pitch_rounding(pitch);
    }
};

/// The tilt of the base against the body that most of the cases have; 0 where they have none in common.
double common_offset(const std::vector<PitchOfCase>& cases) {
    double common = 0;
    std::size_t most = cases.size() / 2;
    for (const auto& candidate : cases) {
        const auto agree = static_cast<std::size_t>(std::count_if(
            cases.begin(), cases.end(), [&](const PitchOfCase& one) { return !one.is_off(candidate.off()); }));
        if (agree > most) {
            most = agree;
            common = candidate.off();
        }
    }
    const auto at_nought = static_cast<std::size_t>(
        std::count_if(cases.begin(), cases.end(), [](const PitchOfCase& one) { return !one.is_off(0); }));
    return at_nought >= most ? 0 : common;
}

/// What of a case tells which body it is: words, and numbers that are none of the flow.
std::string body_of(const ConditionedLoads& one) {
    std::string body;
    for (const auto& [name, value] : one.conditions) {
        const bool of_flow = core::find_quantity(name) != nullptr || name == "density" || name == "cells";
        body += of_flow ? "" : name + "=" + value + "\n";
    }
    return body;
}

/// The cases that have a pitch and a tilt, by their body; those that are wrong by themselves are told already.
std::map<std::string, std::vector<PitchOfCase>> pitches_by_body(const std::vector<ConditionedLoads>& cases) {
    std::map<std::string, std::vector<PitchOfCase>> bodies;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        for (const auto& [name, value] : cases[i].conditions) {
            const double pitch = name == "pitch" ? core::parse_number(value).value_or(NAN) : NAN;
            const double tilt = cases[i].base_pitch;
            if (std::isfinite(pitch) && std::isfinite(tilt) && question_of_pitch(pitch, tilt).empty()) {
                bodies[body_of(cases[i])].push_back({i, pitch, tilt});
            }
        }
    }
    return bodies;
}

/// One warning for bodies that lie alike in all of their files whatever pitch was said.
std::optional<Problem> alike_in_files(const std::vector<PitchOfCase>& cases) {
    const auto [lowest, highest] = std::minmax_element(
        cases.begin(), cases.end(), [](const PitchOfCase& a, const PitchOfCase& b) { return a.pitch < b.pitch; });
    const bool alike = std::all_of(cases.begin(), cases.end(), [&](const PitchOfCase& one) {
        return std::abs(one.tilt - cases.front().tilt) < 0.02 * core::degree;
    });
    if (!alike || !(highest->pitch - lowest->pitch > 0.25 * core::degree)) {
        return {};
    }
    return Problem{Problem::Severity::warning,
                   core::counted(cases.size(), "case") + " of one body are declared with pitches from " +
                       core::told_range(lowest->pitch, highest->pitch, "rad", 4) +
                       ", but in all of their files the base is pitched by " + told_tilt(cases.front().tilt) +
                       ": are they the files that were meant? If the flow was turned instead of the body, the forces "
                       "are along the body's axes, not the flow's",
                   {}};
}

}  // namespace

double base_tilt(const LoadsResult& loads, const std::string& base) {
    Vector sum{};
    double size = 0;
    for (const auto& zone : loads.zones) {
        if (matches(base, zone.name)) {
            sum = plus(sum, zone.area_vector);
            size += zone.area;
        }
    }
    constexpr double flat = 0.5;
    if (loads.dimension != 3 || !(norm(sum) > flat * size)) {
        return NAN;
    }
    const double side = dot(sum, loads.up) > 0 ? -1 : 1;  // of the base alone nothing tells its outside
    return std::atan2(side * dot(sum, loads.forward), -side * dot(sum, loads.up));
}

std::optional<Problem> pitch_fault(const LoadsResult& loads, const std::string& base, double pitch) {
    const double tilt = base_tilt(loads, base);
    const std::string question = std::isfinite(pitch) ? question_of_pitch(pitch, tilt) : "";
    if (question.empty()) {
        return {};
    }
    return Problem{Problem::Severity::warning,
                   "the pitch is declared as " + core::told(pitch, "rad", 5) +
                       (std::isfinite(tilt) ? ", but in the file the base is pitched by " + told_tilt(tilt) : "") +
                       ": " + question,
                   {loads.file, {}, {}, {}}};
}

std::vector<std::pair<Problem, std::size_t>> other_pitches(const std::vector<ConditionedLoads>& cases) {
    std::vector<std::pair<Problem, std::size_t>> found;
    for (const auto& [body, members] : pitches_by_body(cases)) {
        if (auto alike = alike_in_files(members)) {
            found.emplace_back(std::move(*alike), members.back().at);
            continue;
        }
        const double offset = members.size() > 1 ? common_offset(members) : members.front().off();
        for (const auto& one : members) {
            if (!one.is_off(offset)) {
                continue;
            }
            const PitchOfCase turned{one.at, -one.pitch, one.tilt};
            found.emplace_back(
                Problem{
                    Problem::Severity::warning,
                    "the pitch of '" + cases[one.at].name + "' is declared as " + core::told(one.pitch, "rad", 5) +
                        ", but in the file the base is pitched by " + told_tilt(one.tilt - offset) +
                        (offset == 0 ? "" : " against the body, as other cases have it") + ": " +
                        (turned.is_off(offset) ? "is the file the one that was meant, and of this body?"
                                               : "is its sign turned (nose up is positive), or the file another's?"),
                    {}},
                one.at);
        }
    }
    return found;
}

}  // namespace underbody::postproc
