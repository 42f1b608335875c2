#include "postproc/loads/declared.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/counted.h"
#include "core/text.h"
#include "postproc/field/field.h"

namespace underbody::postproc {

namespace {

using core::Problem;

std::string shown_length(double metres) {
    const bool small = std::abs(metres) < 1;
    return core::format_number(small ? 1000 * metres : metres, 5) + (small ? " mm" : " m");
}

/// What to ask about a length that is `ratio` times another: which unit was likely taken for which. `slack`: how far
/// off the ratio may be, as a factor.
std::string likely_unit(double ratio, double slack) {
    struct Mistake {
        double factor;
        const char *meant, *taken;
    };
    constexpr double inch = 25.4, feet = 3.28084;  // mm, of a metre
    constexpr std::array mistakes = {Mistake{1000, "mm", "m"}, Mistake{100, "cm", "m"}, Mistake{10, "mm", "cm"},
                                     Mistake{inch, "mm", "in"}, Mistake{feet, "ft", "m"}};
    for (const auto& [factor, meant, taken] : mistakes) {
        for (const bool larger : {true, false}) {
            const double off = larger ? ratio / factor : ratio * factor;
            if (off < slack && off > 1 / slack) {
                return std::string("is it in ") + (larger ? meant : taken) + ", and was read in " +
                       (larger ? taken : meant) + "?";
            }
        }
    }
    return "is the unit right, and the file the one that was meant?";
}

/// Half a unit of the last digit that a length shows, in the unit (m or mm) in which it is shorter.
double rounding(double metres) {
    double half = 0;
    std::size_t shortest = 0;
    for (const double unit : {1e-3, 1.0}) {
        const std::string digits = core::format_number(metres / unit, 12);
        if (digits.find('e') != std::string::npos || (shortest > 0 && digits.size() >= shortest)) {
            continue;
        }
        const auto point = digits.find('.');
        shortest = digits.size();
        half = 0.5 * unit *
               (point == std::string::npos ? 1 : std::pow(10.0, -static_cast<double>(digits.size() - point - 1)));
    }
    return half;
}

/// m, along `up`: the highest flat wall across it that lies under the point and is not summed; nothing without one.
std::optional<double> ground_under(const Field& field, const LoadsResult& loads, double height) {
    const auto axis =
        static_cast<std::size_t>(std::max_element(loads.up.begin(), loads.up.end(),
                                                  [](double a, double b) { return std::abs(a) < std::abs(b); }) -
                                 loads.up.begin());
    std::optional<double> ground;
    for (const Zone& zone : field.zones) {
        const bool summed = std::any_of(loads.zones.begin(), loads.zones.end(),
                                        [&](const ZoneLoads& one) { return one.name == zone.name; });
        if (summed || zone.kind != ZoneKind::wall || !zone.surface || zone.surface->GetNumberOfCells() == 0) {
            continue;
        }
        std::array<double, 6> b{};
        zone.surface->GetBounds(b.data());
        const double size = std::hypot(b[1] - b[0], b[3] - b[2], b[5] - b[4]);
        const double level = loads.up[axis] * b[2 * axis];
        if (b[2 * axis + 1] - b[2 * axis] <= 1e-6 * size && level < height && level > ground.value_or(-HUGE_VAL)) {
            ground = level;
        }
    }
    return ground;
}

}  // namespace

std::optional<Problem> gap_fault(const Field& field, const LoadsResult& loads, double gap, double pitch) {
    if (loads.dimension != 3 || loads.reference_from == "given" || !std::isfinite(gap)) {
        return {};
    }
    const double height = dot(loads.reference, loads.up);
    const auto ground = ground_under(field, loads, height);
    const double found = height - ground.value_or(0);
    if (!(found > 1e-6 * loads.length)) {
        return {};
    }
    const double allowed =
        0.05 * found + rounding(gap) + (std::isfinite(pitch) ? 0.1 * loads.length * std::abs(std::sin(pitch)) : 0);
    if (std::abs(gap - found) <= allowed) {
        return {};
    }
    return Problem{Problem::Severity::warning,
                   "the gap is declared as " + shown_length(gap) + ", but in the file the body (" +
                       loads.reference_from + ") lies " + shown_length(found) + " over " +
                       (ground ? "the ground: "
                               : "the plane 0, taken as the ground because the file shows none (where it lies "
                                 "elsewhere, give the point of reference): ") +
                       likely_unit(gap / found, 1.2),
                   {loads.file, {}, {}, {}}};
}

std::optional<Problem> base_fault(const LoadsResult& loads, const std::string& base) {
    Vector area{};
    std::string names;
    for (const auto& zone : loads.zones) {
        if (matches(base, zone.name)) {
            area = plus(area, zone.area_vector);
            names += (names.empty() ? "'" : ", '") + zone.name + "'";
        }
    }
    const double size = norm(area), down = size > 0 ? -dot(area, loads.up) / size : 1;
    constexpr double open = 0.5;
    if (loads.dimension != 3 || size < 1e-3 * loads.area || down > 0.5 || (down < -0.5 && loads.closure > open)) {
        return {};
    }
    return Problem{Problem::Severity::warning,
                   "the base (zone " + names + ") faces " + (down < -0.5 ? "up" : "sideways") +
                       ": is up another direction of the file, or have two columns of coordinates changed places? The "
                       "sign of the lift and the gap rest on it",
                   {loads.file, {}, {}, {}}};
}

core::Problems size_faults(const LoadsReferences& given, const Vector& body, double limit, const core::Place& place) {
    const std::array<std::pair<const char*, std::optional<double>>, 3> sizes = {
        {{"length", given.length}, {"width", given.width}, {"height", given.height}}};
    core::Problems faults;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
        const auto& [name, value] = sizes[k];
        if (!value || !(body[k] > 0) || !(*value > 0)) {
            continue;
        }
        const double ratio = *value / body[k];
        if (ratio > limit || ratio < 1 / limit) {
            faults.push_back({Problem::Severity::warning,
                              std::string("the ") + name + " of reference is " + shown_length(*value) +
                                  ", that of the body in the file " + shown_length(body[k]) + ": " +
                                  likely_unit(ratio, 2) + " Coefficients rest on it",
                              place});
        }
    }
    return faults;
}

namespace {

/// "'a', 'b', 'c' and 7 more"
std::string first_names(const std::vector<ConditionedLoads>& cases, const std::vector<std::size_t>& group) {
    constexpr std::size_t most = 6;
    std::string names;
    for (std::size_t i = 0; i < std::min(most, group.size()); ++i) {
        names += (names.empty() ? "'" : ", '") + cases[group[i]].name + "'";
    }
    return names + (group.size() > most ? " and " + std::to_string(group.size() - most) + " more" : "");
}

}  // namespace

std::vector<std::pair<Problem, std::size_t>> same_loads(const std::vector<ConditionedLoads>& cases) {
    std::map<std::vector<double>, std::vector<std::size_t>> alike;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const auto& loads = cases[i].loads;
        if (std::any_of(loads.begin(), loads.end(), [](double load) { return load != 0; }) &&
            std::all_of(loads.begin(), loads.end(), [](double load) { return std::isfinite(load); })) {
            alike[loads].push_back(i);
        }
    }
    std::vector<std::pair<Problem, std::size_t>> found;
    std::size_t further = 0, last = 0;
    for (const auto& [loads, group] : alike) {
        std::string differing;
        for (const auto& [name, value] : cases[group.front()].conditions) {
            const bool differs =
                name != "time" && std::any_of(group.begin(), group.end(), [&](std::size_t i) {
                    const auto& others = cases[i].conditions;
                    return std::find(others.begin(), others.end(), std::pair(name, value)) == others.end();
                });
            if (differs) {
                differing += (differing.empty() ? "" : ", ") + name;
            }
        }
        if (differing.empty()) {
            continue;
        }
        constexpr std::size_t most_groups = 5;
        if (found.size() == most_groups) {
            ++further;
            last = group.back();
            continue;
        }
        found.emplace_back(Problem{Problem::Severity::warning,
                                   first_names(cases, group) +
                                       " have the same loads to the last digit although their conditions differ (" +
                                       differing + "): is one file a copy of the other?",
                                   {}},
                           group.back());
    }
    if (further > 0) {
        found.emplace_back(
            Problem{Problem::Severity::warning,
                    "and " + core::counted(further, "more group of cases has", "more groups of cases have") +
                        " the same loads to the last digit although their conditions differ",
                    {}},
            last);
    }
    return found;
}

namespace {

/// Of each case, its force over the square of its speed where all state one; 0: no force, or none that is known.
std::vector<double> force_sizes(const std::vector<ConditionedLoads>& cases) {
    std::vector<double> sizes, squares;
    for (const auto& one : cases) {
        double square = 0;
        for (std::size_t k = 0; k < std::min<std::size_t>(3, one.loads.size()); ++k) {
            square += one.loads[k] * one.loads[k];
        }
        sizes.push_back(std::isfinite(square) ? std::sqrt(square) : 0);
        for (const auto& [name, value] : one.conditions) {
            const double speed = name == "speed" ? core::parse_number(value).value_or(0) : 0;
            if (speed > 0) {
                squares.push_back(speed * speed);
            }
        }
    }
    for (std::size_t i = 0; squares.size() == sizes.size() && i < sizes.size(); ++i) {
        sizes[i] /= squares[i];
    }
    return sizes;
}

}  // namespace

std::vector<std::pair<Problem, std::size_t>> other_sizes(const std::vector<ConditionedLoads>& cases) {
    constexpr double far = 300, thousand = 1000, slack = 1.3;
    const std::vector<double> sizes = force_sizes(cases);
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        if (sizes[i] > 0) {
            order.push_back(i);
        }
    }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return sizes[a] < sizes[b]; });
    std::vector<std::pair<Problem, std::size_t>> found;
    const std::size_t few = order.size() < 4 ? 0 : order.size() / 3;
    /// Cases from..to beside the one of the others that is nearest in size.
    const auto tell = [&](std::size_t from, std::size_t to, std::size_t nearest) {
        for (std::size_t k = from; k < to; ++k) {
            found.emplace_back(
                Problem{Problem::Severity::warning,
                        "'" + cases[order[k]].name + "' has forces " +
                            core::format_number(sizes[order[k]] / sizes[order[nearest]], 3) +
                            (to - from > 1 ? " times those of most other cases" : " times those of every other case") +
                            ": is its pressure in another unit, or over density?",
                        {}},
                order[k]);
        }
    };
    std::size_t large = 0, small = 0;  // of each, the largest group that stands apart
    for (std::size_t k = 1; k <= few; ++k) {
        const std::size_t n = order.size();
        const double above = sizes[order[n - k]] / sizes[order[n - k - 1]];
        const double below = sizes[order[k]] / sizes[order[k - 1]];
        if (above > far) {
            large = k;
        }
        // A force that passes through nought may be as small as it likes; one read in kPa is so by a thousand.
        if (below > thousand / slack && below < thousand * slack) {
            small = k;
        }
    }
    if (large > 0) {
        tell(order.size() - large, order.size(), order.size() - large - 1);
    }
    if (small > 0) {
        tell(0, small, small);
    }
    return found;
}

std::vector<std::pair<Problem, std::size_t>> odd_loads(const std::vector<ConditionedLoads>& cases) {
    auto all = same_loads(cases);
    for (const auto& more : {other_sizes(cases), other_pitches(cases)}) {
        all.insert(all.end(), more.begin(), more.end());
    }
    return all;
}

}  // namespace underbody::postproc
