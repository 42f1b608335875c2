// The report of a design search.
#include <algorithm>
#include <cmath>

#include "cases/design.h"
#include "cases/design_curves.h"
#include "cases/design_figures.h"
#include "cases/design_proof.h"
#include "core/error.h"
#include "core/text.h"
#include "core/told.h"

namespace underbody::cases {

using core::Figure;
using tables::Candidate;
using tables::SearchVariable;
using tables::Surrogate;

namespace {

std::string with_unit(double value, const std::string& unit) { return geometry::shown_value(value, unit, 5); }

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
            return told_response(r, response);
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

/// What a page is made of.
struct Sources {
    const Design& design;
    const FigureRenderer& renderer;
    core::HtmlPage& page;
    core::Progress& progress;
};
using Surrogates = std::map<std::string, Surrogate>;

void add_facts(const Sources& from) {
    const auto& [design, renderer, page, progress] = from;
    std::size_t solved = 0, runs = 0;
    for (const DesignRun& run : design.runs()) {
        solved += run.usable() ? 1 : 0;
        runs += run.counts() ? 1 : 0;
    }
    page.facts({{std::to_string(design.spec().variables.size()), "numbers of the shape varied"},
                {std::to_string(design.plan().size()), "designs"},
                {std::to_string(solved) + " of " + std::to_string(runs), "runs that can be used"}});
    for (const auto& note : design.notes) {
        page.warning(note.message);
    }
}

void add_plan(const Sources& from) {
    const auto& [design, renderer, page, progress] = from;
    const DesignSpec& spec = design.spec();
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
        const auto of_it = [&](const DesignRun& run) { return run.design == d.name && run.other.empty(); };
        const bool begun = std::any_of(design.runs().begin(), design.runs().end(), of_it);
        row.insert(row.end(), {d.fidelity, d.why, begun && d.state == "planned" ? "computed" : d.state});
        rows.push_back(row);
    }
    std::vector<std::string> header = {"design"};
    for (const SearchVariable& v : spec.variables) {
        header.push_back(v.name);
    }
    header.insert(header.end(), {"fidelity", "why", "state"});
    page.folded_table("All designs", header, rows);
}

void add_surrogates(const Sources& from, const Surrogates& surrogates) {
    const auto& [design, renderer, page, progress] = from;
    page.section("Surrogates");
    page.paragraph("A Gaussian process over shape and conditions" +
                   std::string(design.spec().fidelities.size() > 1
                                   ? ", each mesh a factor times the coarser one plus a process of its own"
                                   : "") +
                   "; its error is checked and scaled on shapes left out with all their runs.");
    std::vector<std::vector<std::string>> rows;
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
}

void add_sensitivities(const Sources& from, const Surrogates& surrogates) {
    const auto& [design, renderer, page, progress] = from;
    page.section("Sensitivities");
    std::vector<Figure> figures;
    for (const LearnedNumber& one : learned_numbers(design, surrogates)) {
        figures.push_back(sensitivity_figure(one, design.sensitivity(one)));
        figures.push_back(one_at_a_time_figure(one, middle_of(one.variables)));
    }
    pictures(page, renderer, figures);
}

void add_search(const Sources& from, Surrogates surrogates) {
    const auto& [design, renderer, page, progress] = from;
    const DesignSpec& spec = design.spec();
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
    std::vector<Candidate> known, front;
    for (const auto& at : design.known().solved) {
        known.push_back(search.describe(at));
    }
    if (spec.objectives.size() > 1) {
        front = search.pareto_front(15, 1, spec.seed, progress);
        designs_table(page, search, front, "Designs of which none is better in all objectives");
    }
    if (renderer) {
        if (!front.empty()) {
            pictures(page, renderer,
                     {front_figure(design, search, front, known, progress), bodies_figure(design, front, progress)});
        }
        pictures(page, renderer, {parallel_figure(search, known, front)});
    }
}

/// What was predicted of the designs that a search chose, beside what their runs say.
void add_proofs(const Sources& from) {
    const auto& [design, renderer, page, progress] = from;
    const std::vector<ProofOfDesign> all = proofs(design);
    if (all.empty()) {
        return;
    }
    page.section("Prediction beside result");
    std::vector<std::vector<std::string>> rows;
    for (const ProofOfDesign& proof : all) {
        if (!proof.note.empty()) {
            rows.push_back({proof.design, proof.fidelity, proof.why, "", "", proof.note, ""});
        }
        for (const ProofOfResponse& one : proof.responses) {
            const double apart = one.difference_in_sigmas();
            rows.push_back(
                {proof.design, proof.fidelity, proof.why, one.name,
                 told_response(one.predicted, one.of_curves, one.unit),
                 one.computed ? told_response(*one.computed, one.of_curves, one.unit) : "its runs do not tell it",
                 std::isfinite(apart) ? core::format_number(std::abs(apart), 2) : ""});
        }
    }
    page.table({"design", "mesh", "why", "of", "predicted", "computed", "standard deviations apart"}, rows,
               "Designs that a search chose: what the surrogates said before they were computed, and what their own "
               "runs say, linear between these where an objective or a limit lies between them. The prediction is of "
               "the finest mesh that the surrogates had learned from: beside runs on a finer one the difference holds "
               "the error of the mesh as well.");
    pictures(page, renderer, proof_figures(all));
}

}  // namespace

std::string design_report(const Design& design, const FigureRenderer& renderer, core::Progress& progress) {
    core::HtmlPage page("Design search", design.spec().shape.filename().string());
    const Sources from{design, renderer, page, progress};
    add_facts(from);
    add_plan(from);
    add_proofs(from);
    Surrogates surrogates;
    try {
        surrogates = design.surrogates(progress);
    } catch (const core::InputError& error) {
        page.section("Surrogates");
        page.warning(error.message() + (error.hint().empty() ? "" : "; " + error.hint()));
        return page.text();
    }
    add_surrogates(from, surrogates);
    add_sensitivities(from, surrogates);
    if (design.spec().objectives.empty()) {
        page.paragraph("[design] states no objective: nothing was searched.");
    } else {
        add_search(from, std::move(surrogates));
    }
    return page.text();
}

}  // namespace underbody::cases
