// Pictures and the report of a design search.
#include <algorithm>
#include <cmath>
#include <limits>

#include "cases/design.h"
#include "core/counted.h"
#include "core/error.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::cases {

using core::Figure;
using geometry::shown_unit;
using tables::Candidate;
using tables::SearchVariable;
using tables::Surrogate;

namespace {

double shown(double value, const std::string& unit) { return core::convert(value, unit, shown_unit(unit)); }
std::string label(const std::string& name) {
    std::string text = name;
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}
std::string with_unit(double value, const std::string& unit) { return geometry::shown_value(value, unit, 5); }

}  // namespace

Figure left_out_figure(const Surrogate& surrogate) {
    const auto& check = surrogate.check();
    Figure figure;
    figure.title = label(surrogate.quantity()) + ": shapes left out";
    figure.caption =
        "Each shape's runs predicted from all other shapes, against what was computed; bars are two standard "
        "deviations. " +
        core::format_number(100 * check.inside_95, 3) + " % lie within 1.96 standard deviations.";
    figure.x = {"computed", surrogate.unit()};
    figure.y = {"predicted without the shape", surrogate.unit()};
    core::FigurePoints points;
    points.name = core::counted(check.points, "run") + " of " + core::counted(check.shapes, "shape");
    points.x = check.measured;
    points.y = check.predicted;
    for (const double s : check.sigma) {
        points.y_error.push_back(2 * s);
    }
    points.colour = core::palette(0);
    figure.points.push_back(points);
    const auto [low, high] = std::minmax_element(check.measured.begin(), check.measured.end());
    if (low != check.measured.end()) {
        core::FigureCurve line;
        line.name = "equal";
        line.x = {*low, *high};
        line.y = line.x;
        line.dashed = true;
        line.colour = {120, 120, 120, 255};
        figure.curves.push_back(line);
    }
    return figure;
}

Figure sensitivity_figure(const Surrogate& surrogate, const tables::SobolIndices& indices) {
    Figure figure;
    figure.title = "What " + label(surrogate.quantity()) + " depends on";
    figure.caption =
        "Sobol's indices of the surrogate's mean over the ranges searched: a variable alone, and with all its "
        "interactions; bars are 95 % intervals of the sampling.";
    figure.y = {"share of the variance", ""};
    for (const bool total : {false, true}) {
        core::FigureBars bars;
        bars.name = total ? "with interactions" : "alone";
        bars.colour = core::palette(total ? 1 : 0);
        for (std::size_t v = 0; v < surrogate.variables().size(); ++v) {
            const tables::SobolIndex& index = (total ? indices.total : indices.first)[v];
            bars.labels.push_back(surrogate.variables()[v].name);
            bars.values.push_back(index.value);
            bars.errors.push_back(0.5 * (index.upper - index.lower));
        }
        figure.bars.push_back(bars);
    }
    return figure;
}

std::vector<Figure> one_at_a_time(const Surrogate& surrogate, const std::vector<double>& at) {
    std::vector<Figure> figures;
    for (std::size_t v = 0; v < surrogate.variables().size(); ++v) {
        const SearchVariable& variable = surrogate.variables()[v];
        Figure figure;
        figure.title = label(surrogate.quantity()) + " along " + variable.name;
        figure.x = {variable.name, shown_unit(variable.unit)};
        figure.y = {label(surrogate.quantity()), surrogate.unit()};
        core::FigureBand band;
        core::FigureCurve curve;
        band.name = "two standard deviations";
        curve.name = "surrogate";
        curve.colour = core::palette(0);
        for (int i = 0; i <= 60; ++i) {
            std::vector<double> x = at;
            x[v] = variable.unscaled(i / 60.0);
            const auto p = surrogate.at(x);
            curve.x.push_back(shown(x[v], variable.unit));
            curve.y.push_back(p.value);
            band.x.push_back(curve.x.back());
            band.lower.push_back(p.value - 2 * p.sigma);
            band.upper.push_back(p.value + 2 * p.sigma);
        }
        figure.bands.push_back(band);
        figure.curves.push_back(curve);
        figures.push_back(figure);
    }
    return figures;
}

Figure convergence_figure(const Design& design, const tables::DesignSearch& search) {
    const auto& objective = search.problem().objectives.front();
    Figure figure;
    figure.title = "The search so far";
    figure.caption =
        "The first objective as the surrogate gives it for each design that was run, and the best of those "
        "that meet the limits.";
    figure.x = {"design", ""};
    figure.y = {label(objective.response.name), search.unit_of(objective.response)};
    core::FigurePoints points;
    points.name = "designs";
    points.colour = core::palette(0);
    core::FigureCurve best;
    best.name = "best";
    best.steps = true;
    best.colour = core::palette(1);
    std::vector<std::vector<double>> until;
    std::size_t number = 0;
    for (const PlannedDesign& d : design.plan()) {
        ++number;
        const bool run = std::any_of(design.runs().begin(), design.runs().end(),
                                     [&](const DesignRun& r) { return r.design == d.name && r.usable(); });
        if (!run) {
            continue;
        }
        until.push_back(d.at);
        const auto value = search.evaluate(objective.response, d.at);
        points.x.push_back(static_cast<double>(number));
        points.y.push_back(value.value);
        points.y_error.push_back(value.sigma);
        const double so_far = search.best_of(until);
        if (!std::isnan(so_far)) {
            best.x.push_back(static_cast<double>(number));
            best.y.push_back(objective.sense == tables::Objective::Sense::maximise ? -so_far : so_far);
        }
    }
    figure.points.push_back(points);
    if (objective.sense != tables::Objective::Sense::target && best.x.size() > 1) {
        figure.curves.push_back(best);
    }
    return figure;
}

Figure front_figure(const tables::DesignSearch& search, const std::vector<Candidate>& front,
                    const std::vector<Candidate>& known) {
    const auto& objectives = search.problem().objectives;
    Figure figure;
    figure.title = "What can be had together";
    figure.caption = "Designs of which none is better in both, by the surrogates; bars are one standard deviation.";
    figure.x = {label(objectives[0].response.name), search.unit_of(objectives[0].response)};
    figure.y = {label(objectives[1].response.name), search.unit_of(objectives[1].response)};
    const auto add = [&](const std::vector<Candidate>& designs, const std::string& name, std::size_t colour) {
        core::FigurePoints points;
        points.name = name;
        points.colour = core::palette(colour);
        for (const Candidate& c : designs) {
            points.x.push_back(c.objectives[0].value);
            points.y.push_back(c.objectives[1].value);
            points.y_error.push_back(c.objectives[1].sigma);
        }
        figure.points.push_back(points);
    };
    add(known, "designs that were run", 7);
    add(front, "front", 1);
    return figure;
}

Figure coverage_figure(const Design& design, std::size_t x, std::size_t y) {
    const auto& variables = design.spec().variables;
    Figure figure;
    figure.title = "The plan over " + variables[x].name + " and " + variables[y].name;
    const auto axis = [&](std::size_t v) {
        return core::FigureAxis{variables[v].name, shown_unit(variables[v].unit),
                                shown(variables[v].lower, variables[v].unit),
                                shown(variables[v].upper, variables[v].unit), variables[v].logarithmic};
    };
    figure.x = axis(x);
    figure.y = axis(y);
    core::FigurePoints planned, chosen, refused;
    planned.name = "plan";
    planned.colour = core::palette(0);
    chosen.name = "chosen by the search";
    chosen.colour = core::palette(1);
    chosen.shape = core::FigurePoints::Shape::diamond;
    refused.name = "no such shape";
    refused.colour = core::palette(5);
    refused.shape = core::FigurePoints::Shape::cross;
    for (const PlannedDesign& d : design.plan()) {
        core::FigurePoints& to = d.state != "planned" ? refused : d.why == "plan" ? planned : chosen;
        to.x.push_back(shown(d.at[x], variables[x].unit));
        to.y.push_back(shown(d.at[y], variables[y].unit));
    }
    for (const auto& points : {planned, chosen, refused}) {
        if (!points.x.empty()) {
            figure.points.push_back(points);
        }
    }
    return figure;
}

namespace {

void pictures(core::HtmlPage& page, const FigureRenderer& renderer, const std::vector<Figure>& figures) {
    if (!renderer || figures.empty()) {
        return;
    }
    std::vector<core::HtmlPage::Picture> all;
    for (const Figure& figure : figures) {
        all.push_back(
            {renderer(figure), figure.title + (figure.caption.empty() ? "" : ". " + figure.caption), figure.title});
    }
    page.pictures(all);
}

void designs_table(core::HtmlPage& page, const tables::DesignSearch& search, const std::vector<Candidate>& designs,
                   const std::string& caption) {
    std::vector<std::string> header;
    const auto& problem = search.problem();
    for (const SearchVariable& v : problem.variables) {
        header.push_back(v.name);
    }
    for (const auto& objective : problem.objectives) {
        header.push_back(objective.response.name);
    }
    for (const auto& limit : problem.limits) {
        header.push_back(limit.response.name);
    }
    header.push_back("limits hold");
    std::vector<std::vector<std::string>> rows;
    for (const Candidate& c : designs) {
        std::vector<std::string> row;
        for (std::size_t v = 0; v < problem.variables.size(); ++v) {
            row.push_back(with_unit(c.at[v], problem.variables[v].unit));
        }
        const auto value = [&](const tables::ResponseValue& r, const tables::Response& response) {
            return core::format_number(r.value, 4) + " +- " + core::format_number(r.sigma, 2) + " " +
                   search.unit_of(response);
        };
        for (std::size_t k = 0; k < c.objectives.size(); ++k) {
            row.push_back(value(c.objectives[k], problem.objectives[k].response));
        }
        for (std::size_t k = 0; k < c.limits.size(); ++k) {
            row.push_back(value(c.limits[k], problem.limits[k].response));
        }
        row.push_back(core::format_number(100 * c.chance_valid, 3) + " %");
        rows.push_back(row);
    }
    page.table(header, rows, caption);
}

}  // namespace

std::string design_report(const Design& design, const FigureRenderer& renderer, core::Progress& progress) {
    const DesignSpec& spec = design.spec();
    core::HtmlPage page("Design search", spec.shape.filename().string());
    std::size_t solved = 0;
    for (const DesignRun& run : design.runs()) {
        solved += run.usable() ? 1 : 0;
    }
    page.facts({{std::to_string(spec.variables.size()), "numbers of the shape varied"},
                {std::to_string(design.plan().size()), "designs"},
                {std::to_string(solved) + " of " + std::to_string(design.runs().size()), "runs that can be used"}});
    for (const auto& note : design.notes) {
        page.warning(note.message);
    }
    page.section("Plan");
    std::vector<Figure> coverage;
    for (std::size_t v = 0; v + 1 < spec.variables.size(); ++v) {
        coverage.push_back(coverage_figure(design, v, v + 1));
    }
    pictures(page, renderer, coverage);
    std::vector<std::vector<std::string>> rows;
    for (const PlannedDesign& d : design.plan()) {
        std::vector<std::string> row = {d.name};
        for (std::size_t v = 0; v < spec.variables.size(); ++v) {
            row.push_back(with_unit(d.at[v], spec.variables[v].unit));
        }
        row.insert(row.end(), {d.fidelity, d.why, d.state});
        rows.push_back(row);
    }
    std::vector<std::string> header = {"design"};
    for (const SearchVariable& v : spec.variables) {
        header.push_back(v.name);
    }
    header.insert(header.end(), {"fidelity", "why", "state"});
    page.folded_table("All designs", header, rows);

    std::map<std::string, Surrogate> surrogates;
    try {
        surrogates = design.surrogates(progress);
    } catch (const core::InputError& error) {
        page.section("Surrogates");
        page.warning(error.message() + (error.hint().empty() ? "" : "; " + error.hint()));
        return page.text();
    }
    page.section("Surrogates");
    page.paragraph("A Gaussian process over shape and conditions" +
                   std::string(spec.fidelities.size() > 1
                                   ? ", each mesh a factor times the coarser one plus a process of its own"
                                   : "") +
                   "; its error is checked and scaled on shapes left out with all their runs.");
    rows.clear();
    std::vector<Figure> figures;
    for (const auto& [name, surrogate] : surrogates) {
        const auto& check = surrogate.check();
        rows.push_back({name, std::to_string(check.points),
                        core::format_number(check.root_mean_square, 3) + " " + surrogate.unit(),
                        core::format_number(check.nearest_shape, 3) + " " + surrogate.unit(),
                        core::format_number(100 * check.inside_95, 3) + " %",
                        core::format_number(surrogate.error_factor(), 3)});
        figures.push_back(left_out_figure(surrogate));
    }
    page.table({"quantity", "runs", "error on shapes left out", "error of the nearest shape", "inside the 95 % band",
                "error scaled by"},
               rows, "How surrogates do on shapes they have not seen");
    pictures(page, renderer, figures);

    page.section("Sensitivities");
    figures.clear();
    for (const auto& [name, surrogate] : surrogates) {
        figures.push_back(sensitivity_figure(surrogate, design.sensitivity(surrogate)));
    }
    pictures(page, renderer, figures);

    if (spec.objectives.empty()) {
        page.paragraph("[design] states no objective: nothing was searched.");
        return page.text();
    }
    const tables::DesignSearch search = design.search(std::move(surrogates));
    page.section("Search");
    pictures(page, renderer, {convergence_figure(design, search)});
    if (const auto best = search.optimum(1, spec.seed, progress)) {
        designs_table(page, search, {*best},
                      "The best design by the surrogates that meets every limit by one standard deviation. It is a "
                      "prediction: compute it.");
    } else {
        page.warning("No design meets every limit by one standard deviation.");
    }
    if (spec.objectives.size() > 1) {
        const auto front = search.pareto_front(15, spec.seed, progress);
        std::vector<Candidate> known;
        for (const auto& at : design.known().solved) {
            known.push_back(search.describe(at));
        }
        designs_table(page, search, front, "Designs of which none is better in all objectives");
        pictures(page, renderer, {front_figure(search, front, known)});
    }
    return page.text();
}

}  // namespace underbody::cases
