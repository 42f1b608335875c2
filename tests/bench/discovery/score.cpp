#include "tests/bench/discovery/score.h"

#include <algorithm>
#include <cstdio>

#include "core/normal.h"
#include "surrogates/discovery/statistics.h"

namespace underbody::bench {

namespace {

std::vector<std::string> sorted(std::vector<std::string> names) {
    std::sort(names.begin(), names.end());
    return names;
}

/// Two names for one law, which only the rig can tell apart.
bool same_law(const std::string& a, const std::string& b) {
    const auto pair = [&](const char* x, const char* y) { return (a == x && b == y) || (a == y && b == x); };
    return pair("input_delay", "gap_sensor_delay") || pair("cable_buoyancy", "strut_buoyancy");
}

template <typename... Values>
std::string text(const char* format, Values... values) {
    char line[400];
    std::snprintf(line, sizeof line, format, values...);
    return line;
}

}  // namespace

bool Outcome::right() const {
    const std::vector<std::string> said = verdict == "none" ? std::vector<std::string>{"none"} : sorted(names);
    if (std::any_of(also.begin(), also.end(), [&](const auto& one) { return said == sorted(one); })) {
        return true;
    }
    if (truth.empty()) {
        return verdict == "none";
    }
    return verdict != "none" && sorted(names) == sorted(truth);
}

bool Outcome::right_law() const {
    return right() ||
           (verdict == "effect" && truth.size() == 1 && names.size() == 1 && same_law(names.front(), truth.front()));
}

bool Outcome::tied() const {
    if (right() || verdict != "effect" || truth.empty()) {
        return false;
    }
    if (right_law()) {
        return true;
    }
    // a rival of several effects is told as "gap_offset + sensor_gain", in any order
    const auto all_of = [](std::string rest) {
        std::vector<std::string> parts;
        for (std::size_t plus = 0; (plus = rest.find(" + ")) != std::string::npos; rest.erase(0, plus + 3)) {
            parts.push_back(rest.substr(0, plus));
        }
        parts.push_back(rest);
        return sorted(parts);
    };
    return std::any_of(rivals.begin(), rivals.end(),
                       [&](const auto& rival) { return rival.second > 0.2 && all_of(rival.first) == sorted(truth); });
}

Outcome outcome_of(const discovery::Discovery& found, const std::vector<std::string>& truth,
                   const std::vector<std::string>& depends_on) {
    Outcome one;
    one.truth = truth;
    one.verdict = found.verdict;
    for (const discovery::FoundEffect& effect : found.effects) {
        one.names.push_back(effect.name);
    }
    for (const discovery::FoundEffect& rival : found.alternatives) {
        one.rivals.emplace_back(rival.name, rival.probability);
    }
    one.variables = sorted(found.depends_on) == sorted(depends_on);
    one.stated = found.effects.empty() ? found.none_probability : found.effects.front().probability;
    for (const auto& [rival, probability] : one.rivals) {
        one.stated += one.names.size() == 1 && same_law(one.names.front(), rival) ? probability : 0;
    }
    if (!found.error.empty()) {
        const discovery::ErrorChange& error = found.error.front();
        one.before = error.before.rmse / error.noise;
        one.after = error.after.rmse / error.noise;
    }
    one.seconds = found.seconds;
    return one;
}

std::string share(std::size_t of, std::size_t all) {
    const core::Interval w = core::wilson_interval(static_cast<double>(of), static_cast<double>(all));
    return text("%zu/%zu %.2f (%.2f-%.2f)", of, all, all > 0 ? static_cast<double>(of) / static_cast<double>(all) : 0.0,
                w.low, w.high);
}

double Tally::after() const {
    double sum = 0;
    for (const Outcome& one : outcomes) {
        sum += one.after * one.after;
    }
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count(), 1)));
}

double Tally::before() const {
    double sum = 0;
    for (const Outcome& one : outcomes) {
        sum += one.before * one.before;
    }
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count(), 1)));
}

double Tally::oracle_gap() const {
    std::vector<double> ratios;
    for (const Outcome& one : outcomes) {
        if (std::isfinite(one.best)) {
            ratios.push_back(one.after / one.best);
        }
    }
    return discovery::median(ratios);
}

std::string Tally::fresh_line() const {
    double worst = 0;
    std::size_t all = 0, harmed = 0;
    for (const Outcome& one : outcomes) {
        if (std::isfinite(one.fresh)) {
            worst = std::max(worst, one.fresh);
            harmed += one.fresh > 1.05 ? 1 : 0;
            ++all;
        }
    }
    return all == 0 ? ""
                    : text("fresh error over before: worst %.2f, above 1.05: %s", worst, share(harmed, all).c_str());
}

std::string Tally::line() const {
    const std::size_t right = count([](const Outcome& o) { return o.right(); });
    const std::size_t tied = count([](const Outcome& o) { return o.tied(); });
    const std::size_t wrong = count([](const Outcome& o) { return o.wrong(); });
    const std::size_t none = count([](const Outcome& o) { return !o.right() && o.verdict == "none"; });
    const std::size_t unknown = count([](const Outcome& o) { return !o.right() && o.verdict == "unknown"; });
    const std::size_t variables = count([](const Outcome& o) { return o.variables; });
    double seconds = 0;
    for (const Outcome& one : outcomes) {
        seconds += one.seconds;
    }
    return text(
        "%-26s tied %2zu wrong %2zu none %2zu unknown %2zu | variables %zu | error %.2f -> %.2f noise, over best %.3f "
        "| %.2f s",
        share(right + tied, count()).c_str(), tied, wrong, none, unknown, variables, before(), after(), oracle_gap(),
        seconds / static_cast<double>(std::max<std::size_t>(count(), 1)));
}

namespace {

const std::vector<double> edges{0, 0.5, 0.7, 0.85, 0.95, 0.99, 1.01};

struct Bin {
    double stated = 0;  ///< summed
    std::size_t right = 0, count = 0;
    [[nodiscard]] double off() const { return std::abs(stated - static_cast<double>(right)); }
};

/// Of the outcomes that `among` is true of, by what was stated.
template <typename Predicate>
std::vector<Bin> binned(const std::vector<Outcome>& outcomes, Predicate among) {
    std::vector<Bin> bins(edges.size() - 1);
    for (const Outcome& one : outcomes) {
        for (std::size_t b = 0; b < bins.size(); ++b) {
            if (among(one) && one.stated >= edges[b] && one.stated < edges[b + 1]) {
                bins[b].stated += one.stated;
                bins[b].right += one.right_law() ? 1 : 0;
                ++bins[b].count;
            }
        }
    }
    return bins;
}

std::string lines_of(const std::vector<Bin>& bins, const char* said) {
    std::string lines;
    for (std::size_t b = 0; b < bins.size(); ++b) {
        if (bins[b].count > 0) {
            lines +=
                text("stated %.2f to %.2f%s: mean %.3f, right %s\n", edges[b], std::min(edges[b + 1], 1.0), said,
                     bins[b].stated / static_cast<double>(bins[b].count), share(bins[b].right, bins[b].count).c_str());
        }
    }
    return lines;
}

}  // namespace

std::string calibration_lines(const std::vector<Outcome>& outcomes) {
    const std::vector<Bin> all = binned(outcomes, [](const Outcome&) { return true; });
    std::string lines = lines_of(all, "");
    const auto lacking = [](const Outcome& one) { return !one.truth.empty(); };
    lines += lines_of(binned(outcomes, lacking), ", of sets that lack something");
    for (const auto& [verdict, said] :
         {std::pair{"effect", ", a name"}, {"unknown", ", unknown"}, {"none", ", nothing is missing"}}) {
        const auto is_said = [name = verdict](const Outcome& one) { return one.verdict == name; };
        lines += lines_of(binned(outcomes, is_said), said);
    }
    double off = 0, total = 0;
    for (const Bin& bin : all) {
        off += bin.off();
        total += static_cast<double>(bin.count);
    }
    return lines + text("mean difference between stated and frequency, weighted by count: %.3f\n",
                        total > 0 ? off / total : 0.0);
}

std::string coverage_line(const std::vector<Outcome>& outcomes) {
    std::size_t inside = 0, all = 0;
    for (const Outcome& one : outcomes) {
        if (std::isfinite(one.pull)) {
            ++all;
            inside += std::abs(one.pull) < 1.96 ? 1 : 0;
        }
    }
    return "95 % intervals that hold the true number: " + share(inside, all) + "\n";
}

}  // namespace underbody::bench
