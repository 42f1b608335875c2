// The report of a discovery: pictures first, the verdict in a sentence, how sure, what else, what it changes, what to
// do next.
#include <algorithm>
#include <cmath>
#include <map>

#include "core/html.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/wording.h"

namespace underbody::discovery {

namespace {

constexpr double nearly_all = 99.5;  ///< %: above, and below 100 less that, a rounded number would say 0 or 100

std::string percent(double share) {
    const double value = 100 * share;
    return value > nearly_all && share < 1 ? "> 99 %"
           : value < 100 - nearly_all      ? "< 1 %"
                                           : core::format_number(std::round(value), 3) + " %";
}

std::string in_noise(const ErrorEstimate& estimate, double noise) {
    return core::format_number(estimate.rmse / core::never_zero(noise), 3);
}

std::string with_interval(const ErrorEstimate& e) {
    int digits = 3;  // more where the ends would read alike
    while (digits < 7 && e.low < e.high && core::format_number(e.low, digits) == core::format_number(e.high, digits)) {
        ++digits;
    }
    return core::format_number(e.rmse, digits) + " (" + core::format_number(e.low, digits) + " to " +
           core::format_number(e.high, digits) + ")";
}

void add_facts(core::HtmlPage& page, const Discovery& d) {
    std::vector<core::HtmlPage::Fact> facts;
    if (d.effects.empty()) {
        facts.push_back({percent(d.none_probability), "probability that nothing is missing"});
    } else {
        facts.push_back({percent(d.effects.front().probability), "probability of this verdict"});
        facts.push_back({percent(d.stability), "of resampled data give the same verdict"});
    }
    if (!d.error.empty()) {
        const ErrorChange& chief = d.error.front();
        facts.push_back({in_noise(chief.before, chief.noise) + " \u2192 " + in_noise(chief.after, chief.noise),
                         "error of " + chief.channel + error_is_on(d) + " in units of its noise, before \u2192 after"});
    }
    if (d.placebo.twins > 0) {
        facts.push_back({std::to_string(d.placebo.alarms) + " of " + std::to_string(d.placebo.twins),
                         "false alarms on twins with nothing missing"});
    }
    page.facts(facts);
}

void add_rivals(core::HtmlPage& page, const Discovery& d) {
    page.section("How sure, and what else it could be");
    std::vector<std::vector<std::string>> rows;
    const auto add = [&](const FoundEffect& effect, bool chosen) {
        std::string numbers;
        for (const FoundParameter& parameter : effect.parameters) {
            numbers += (numbers.empty() ? "" : "; ") + parameter.name + " " + value_text(parameter);
        }
        const std::string reason =
            chosen || effect.told_apart_by.empty() ? effect.evidence : "told apart: " + effect.told_apart_by;
        rows.push_back({effect.name, percent(effect.probability), numbers,
                        effect.depends_on.empty() ? "" : list_of(effect.depends_on), reason});
    };
    for (const FoundEffect& effect : d.effects) {
        add(effect, true);
    }
    for (const FoundEffect& effect : d.alternatives) {
        add(effect, false);
    }
    rows.push_back({"none", percent(d.none_probability), "", "",
                    "chance that noise alone shows as much structure: " + core::format_number(d.gate, 2)});
    page.table({"what is missing", "probability", "its numbers", "depends on", "why, or what tells it apart"}, rows);
    page.paragraph("Found without any named effect, the residual depends on: " +
                   list_of(d.verdict == "none" ? std::vector<std::string>{} : d.depends_on) + ".");
}

void add_error(core::HtmlPage& page, const Discovery& d) {
    page.section("Error before and after");
    page.paragraph("Measured on " + d.held_out + ".");
    std::vector<std::vector<std::string>> rows;
    for (const ErrorChange& change : d.error) {
        const std::string horizon = change.horizon <= 0          ? "set points"
                                    : std::isinf(change.horizon) ? "free run"
                                                                 : core::format_number(change.horizon, 3) + " s";
        rows.push_back({change.channel + " [" + change.unit + "]", horizon, with_interval(change.before),
                        with_interval(change.after), in_noise(change.before, change.noise),
                        in_noise(change.after, change.noise)});
    }
    page.table({"channel", "horizon", "before (95 %)", "after (95 %)", "before, in noise", "after, in noise"}, rows,
               "Root mean square of measured less predicted; intervals from resampling whole runs or set points.");
    std::vector<std::vector<std::string>> axes;
    for (const AxisResidual& axis : d.axes) {
        axes.push_back({axis.quantity + " [" + axis.unit + "]", core::format_number(axis.mean_before, 3),
                        core::format_number(axis.rms_before, 3), core::format_number(axis.mean_after, 3),
                        core::format_number(axis.rms_after, 3), core::format_number(axis.sigma, 2)});
    }
    if (!axes.empty()) {
        page.table({"lacking", "mean before", "rms before", "mean after", "rms after", "noise in it"}, axes,
                   "Force and moment that must be added for the motion that was measured, over the fitted runs, "
                   "smoothed with the model inside.");
    }
    if (d.placebo.twins > 0) {
        page.paragraph("Placebo: the whole procedure on " + std::to_string(d.placebo.twins) +
                       " simulated twins of these data in which nothing is missing. Something was found in " +
                       std::to_string(d.placebo.alarms) + "; their held-out error changed by a factor of " +
                       core::format_number(d.placebo.error_ratio, 4) + ".");
    }
}

void add_consequence(core::HtmlPage& page, const Consequence& consequence) {
    page.section("What it changes");
    if (!consequence.text.empty()) {
        page.paragraph(consequence.text);
    }
    const auto gap_text = [](double gap) {
        return std::isfinite(gap) ? core::format_number(1000 * gap, 4) : std::string("gone");
    };
    std::vector<std::vector<std::string>> rows;
    for (const EquilibriumPair& pair : consequence.equilibria) {
        rows.push_back({pair.name, pair.stable ? "stable" : "unstable",
                        std::isfinite(pair.gap_before) ? gap_text(pair.gap_before) : "not there",
                        gap_text(pair.gap_after)});
    }
    if (!rows.empty()) {
        page.table({"equilibrium", "kind", "gap before [mm]", "gap after [mm]"}, rows);
    }
    std::map<std::string, std::pair<double, double>> both;
    for (const auto& [name, share] : consequence.region_before) {
        both[name].first = share;
    }
    for (const auto& [name, share] : consequence.region_after) {
        both[name].second = share;
    }
    std::vector<std::vector<std::string>> regions;
    for (const auto& [name, shares] : both) {
        regions.push_back(
            {name, core::format_number(100 * shares.first, 3), core::format_number(100 * shares.second, 3)});
    }
    if (!regions.empty()) {
        page.table({"where a start ends", "share before [%]", "share after [%]"}, regions);
    }
    if (consequence.estimator_before > 0) {
        page.table({"state estimator", "before", "after"},
                   {{"error of heave_velocity [mm/s]", core::format_number(1000 * consequence.estimator_before, 3),
                     core::format_number(1000 * consequence.estimator_after, 3)}},
                   "Root mean square of the velocity that a Kalman filter gives with the declared model and with the "
                   "new one, less the velocity smoothed over "
                   "whole runs with the new one (there is no truer reference in the data), after the first 2 s.");
    }
}

/// The chain on to what a controller is given: its tables with the model as declared and as found.
void add_made_again(core::HtmlPage& page, const Discovery& d) {
    if (d.made_again_tables.empty()) {
        return;
    }
    page.section("Exports made again");
    for (const core::ReportTable& table : d.made_again_tables) {
        page.subsection(table.title);
        page.table(table.header, table.rows, table.note);
        for (const auto& [target, text] : table.links) {
            page.link(target, target + ": " + text);
        }
    }
}

void add_noise_and_limits(core::HtmlPage& page, const Discovery& d) {
    page.section("Noise and limits");
    std::vector<std::vector<std::string>> noise;
    for (const auto& [channel, used] : d.noise) {
        noise.push_back({channel + " [" + used.unit + "]", core::format_number(used.value, 3),
                         used.estimated > 0 ? core::format_number(used.estimated, 3) : "", used.from});
    }
    page.table({"channel", "used", "estimated from the scatter", "from"}, noise,
               "One standard deviation of a reading.");
    std::vector<std::vector<std::string>> limits;
    std::vector<std::string> seen;
    for (const DetectionLimit& limit : d.limits) {
        const std::string key = limit.name + limit.parameter;
        // Of what was found the finding speaks; its limit beside it would read as a contradiction.
        const bool found = std::any_of(d.effects.begin(), d.effects.end(),
                                       [&](const FoundEffect& effect) { return effect.name == limit.name; });
        if (!found && std::isfinite(limit.value) && std::find(seen.begin(), seen.end(), key) == seen.end()) {
            seen.push_back(key);
            limits.push_back({limit.name, limit.parameter,
                              core::format_number(limit.value, 3) + (limit.unit == "1" ? "" : " " + limit.unit)});
        }
    }
    const std::string title = "Smallest effects that would stand out of the noise of the fitted data" +
                              std::string(d.effects.empty() ? "" : " beside what was found") + " (nine times in ten)";
    if (d.verdict == "none") {
        page.table({"effect", "number", "limit"}, limits, title);
    } else {
        page.folded_table(title, {"effect", "number", "limit"}, limits);
    }
}

void add_pictures(core::HtmlPage& page, const Discovery& d, const FigureRenderer& renderer) {
    std::vector<core::HtmlPage::Picture> pictures;
    for (const core::Figure& figure : d.figures) {
        if (renderer) {
            pictures.push_back({renderer(figure), figure.caption, figure.title});
        }
    }
    page.pictures(pictures);
}

void add_next_experiment(core::HtmlPage& page, const Discovery& d) {
    page.section("The next experiment");
    page.paragraph(d.next_experiment);
    if (d.next_set_points.rows() > 0) {
        page.link("next-experiment.csv",
                  "next-experiment.csv: " + std::to_string(d.next_set_points.rows()) + " rows in the order to follow");
    }
}

/// What only tells, after what warns.
void add_notes(core::HtmlPage& page, const Discovery& d) {
    std::vector<std::string> notes;
    for (const core::Problem& problem : d.problems) {
        if (problem.severity == core::Problem::Severity::note) {
            notes.push_back(problem.message);
        }
    }
    if (!notes.empty()) {
        page.section("Remarks on the data");
        page.list(notes);
    }
}

void add_method(core::HtmlPage& page) {
    page.section("How it was decided");
    page.list({"Runs or set points were set aside before anything was fitted; the errors above are from them alone.",
               "The gate asks whether the residual has more structure than the fitted noise: its thresholds come from "
               "resampled noise of these data, not from a "
               "table. Only behind an open gate is anything named.",
               "Every effect of the catalogue was fitted inside the experiment within its physical bounds, alone and, "
               "where one left structure, in pairs. What "
               "free numbers cost is their count times the logarithm of the number of data (Schwarz 1978); laws of "
               "nature differ in form from the catalogue's, so "
               "that a small share of what is explained counts as undecided.",
               "'unknown' is said when the best named effect leaves a real part of the structure; a smooth correction "
               "over the variables that carry it is then in "
               "the model. The probabilities were held against frequencies on simulated data with known truth "
               "(tests/bench/discovery)."});
}

}  // namespace

std::string report_html(const Discovery& d, const dynamics::Model& before, const dynamics::Measurements& data,
                        const FigureRenderer& renderer) {
    core::HtmlPage page(headline(d),
                        before.name + " against " + (data.title.empty() ? data.folder.string() : data.title));
    page.paragraph(d.sentence);
    add_facts(page, d);
    for (const core::Problem& problem : d.problems) {
        if (problem.severity != core::Problem::Severity::note) {
            page.warning(problem.message);
        }
    }
    add_pictures(page, d, renderer);
    add_rivals(page, d);
    add_error(page, d);
    add_consequence(page, d.consequence);
    add_made_again(page, d);
    add_next_experiment(page, d);
    add_notes(page, d);
    add_noise_and_limits(page, d);
    add_method(page);
    page.section("From what it was made");
    page.list(d.model.lineage.made_from);
    return page.text();
}

}  // namespace underbody::discovery
