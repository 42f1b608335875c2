// underbody design STEP STUDY: a search for a better shape, from the plan to the best design.
#include "cases/design.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "cases/design_curves.h"
#include "cases/design_figures.h"
#include "cases/design_proof.h"
#include "cases/shape_loads.h"
#include "core/counted.h"
#include "core/file.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/commands.h"
#include "studio/cli/shell.h"
#include "studio/figures/render.h"
#include "surrogates/tables/search/limits_alone.h"

namespace underbody::studio {

namespace {

using nlohmann::json;

struct Arguments {
    std::string study;
    std::string shape, quantity, axes, where;
    int jobs = 1;
    std::size_t count = 1;
    bool learn = false;
    bool add = false;
    double sigmas = 1;
    std::size_t front = 0;
    std::string out;
};

std::string shown(double value, const std::string& unit) { return geometry::shown_value(value, unit, 6); }

cases::Design open(Shell& shell, const Arguments& a) {
    cases::Design design = cases::Design::open(cases::Study::open(a.study));
    shell.show(design.notes);
    return design;
}

json notes_json(const cases::Design& design) {
    json list = json::array();
    for (const auto& note : design.notes) {
        list.push_back(note.message);
    }
    return list;
}

/// Of what a run is expected to lower the error of.
std::string unit_of_load(const tables::SearchProblem& problem) {
    return core::find_quantity(problem.objectives.front().response.quantity)->unit;
}

json json_of(const tables::DesignSearch& search, const cases::DesignSpec& spec, const tables::Candidate& c) {
    const auto& problem = search.problem();
    json result = {{"variables", json::object()},
                   {"objectives", json::object()},
                   {"limits", json::object()},
                   {"chance_valid", c.chance_valid},
                   {"chance_solved", c.chance_solved},
                   {"fidelity", spec.fidelities.at(std::min(c.level, spec.fidelities.size() - 1)).name},
                   {"log_value", c.log_value},
                   {"sigma_of", problem.objectives.front().response.quantity},
                   {"sigma_unit", unit_of_load(problem)},
                   {"sigma_now", c.sigma_now},
                   {"sigma_after", c.sigma_after}};
    for (std::size_t v = 0; v < problem.variables.size(); ++v) {
        result["variables"][problem.variables[v].name] = c.at[v];
    }
    const auto put = [](json& to, const tables::Response& response, const tables::ResponseValue& value,
                        const std::string& unit) {
        const std::string& name = response.name;
        const bool of_curves = response.curve.has_value();
        to[name] = {{"value", value.value}, {"sigma", value.sigma}, {"unit", unit}};
        if (of_curves) {
            to[name]["at_least"] = value.at_least;
        }
    };
    for (std::size_t k = 0; k < c.objectives.size(); ++k) {
        const auto& response = problem.objectives[k].response;
        put(result["objectives"], response, c.objectives[k], search.unit_of(response));
    }
    for (std::size_t k = 0; k < c.limits.size(); ++k) {
        const auto& response = problem.limits[k].response;
        put(result["limits"], response, c.limits[k], search.unit_of(response));
    }
    return result;
}

std::string text_of(const tables::DesignSearch& search, const tables::Candidate& c) {
    const auto& problem = search.problem();
    std::string text;
    for (std::size_t v = 0; v < problem.variables.size(); ++v) {
        text += "  " + problem.variables[v].name + " = " + shown(c.at[v], problem.variables[v].unit) + "\n";
    }
    const auto line = [&](const tables::Response& response, const tables::ResponseValue& value) {
        text += "  " + response.name + ": " + cases::told_response(value, response) + "\n";
    };
    for (std::size_t k = 0; k < c.objectives.size(); ++k) {
        line(problem.objectives[k].response, c.objectives[k]);
    }
    for (std::size_t k = 0; k < c.limits.size(); ++k) {
        line(problem.limits[k].response, c.limits[k]);
    }
    if (!c.limits.empty()) {
        text += "  all limits hold with a chance of " + core::format_number(100 * c.chance_valid, 3) + " %\n";
    }
    return text;
}

int plan(Shell& shell, const Arguments& a) {
    cases::Design design = open(shell, a);
    const std::size_t fresh = design.make_plan(shell.progress());
    json refused = json::array();
    std::string reasons;
    for (const auto& d : design.plan()) {
        if (d.state != "planned") {
            refused.push_back({{"design", d.name}, {"state", d.state}});
            reasons += d.name + ": " + d.state + "\n";
        }
    }
    const bool none = !design.plan().empty() && refused.size() == design.plan().size();
    const std::string file = (design.spec().folder / "plan.csv").string();
    if (shell.json) {
        shell.print_json({{"plan", file},
                          {"designs", design.plan().size()},
                          {"new", fresh},
                          {"refused", refused.size()},
                          {"refused_designs", refused}});
    }
    shell.print(file + ": " + core::counted(design.plan().size(), "design") + ", " + std::to_string(fresh) +
                " of them new" +
                (refused.empty() ? ""
                 : none          ? "; none of them can be:"
                                 : "; " + std::to_string(refused.size()) + " of them cannot be:") +
                "\n" + reasons);
    return none ? wrong_input : done;
}

int run(Shell& shell, const Arguments& a) {
    const cases::Study study = cases::Study::open(a.study);
    cases::Design design = cases::Design::open(study);
    if (design.plan().empty()) {
        design.make_plan(shell.progress());
    }
    design.solve(study, a.jobs, shell.progress());
    std::size_t good = 0, computed = 0, all = 0;
    json failed = json::array();
    std::string text;
    for (const auto& one : design.runs()) {
        if (!one.counts()) {
            continue;
        }
        ++all;
        good += one.usable() ? 1 : 0;
        computed += one.loads.empty() ? 0 : 1;
        if (!one.usable()) {
            failed.push_back({{"design", one.design}, {"fidelity", one.fidelity}, {"state", one.state}});
            text += one.design + " (" + one.fidelity + "): " + one.state + "\n";
        }
    }
    const std::string file = (design.spec().folder / "results.csv").string();
    json proved = json::array();
    for (const auto& proof : cases::proofs(design)) {
        proved.push_back(proof);
        text += cases::proof_text(proof);
    }
    if (shell.json) {
        shell.print_json(
            {{"results", file}, {"runs", all}, {"usable", good}, {"failed", failed}, {"predicted", proved}});
    }
    shell.print(text + file + ": " + std::to_string(good) + " of " + core::counted(all, "run") + " can be used\n");
    return computed == 0 && all > 0 ? wrong_input : done;  // not one case gave loads
}

int fit(Shell& shell, const Arguments& a) {
    const cases::Design design = open(shell, a);
    json list = json::array();
    std::string text;
    for (const auto& [name, surrogate] : design.surrogates(shell.progress())) {
        list.push_back(surrogate);
        list.back()["fidelity"] = design.spec().fidelities.at(surrogate.fidelities().back()).name;
        const auto& check = surrogate.check();
        const std::string& finest = design.spec().fidelities.at(surrogate.fidelities().back()).name;
        text += name + ": " + core::counted(check.points, "run") + " (" +
                (check.shapes_of_best == 0 ? "coarser than " + finest
                 : check.shapes_of_best < check.shapes
                     ? finest + " of " + core::counted(check.shapes_of_best, "shape") + ", coarser of the others"
                     : finest) +
                ") of " + core::counted(check.shapes, "shape") + "; on shapes left out the error is " +
                core::format_number(check.root_mean_square, 3) + " " + surrogate.unit() +
                (std::isfinite(check.nearest_shape) ? " (" + core::format_number(check.nearest_shape, 3) + " " +
                                                          surrogate.unit() + " by the nearest shape)"
                                                    : "") +
                ", " + core::format_number(100 * check.inside_95, 3) + " % lie inside the 95 % band (" +
                core::format_number(100 * check.inside_lower, 3) + " to " +
                core::format_number(100 * check.inside_upper, 3) + " %, counted by shape; errors scaled by " +
                core::format_number(surrogate.error_factor(), 3) + ")\n";
    }
    if (shell.json) {
        shell.print_json({{"surrogates", list}, {"notes", notes_json(design)}});
    }
    shell.print(text);
    return done;
}

int next(Shell& shell, const Arguments& a) {
    cases::Design design = open(shell, a);
    const tables::DesignSearch search = design.search(design.surrogates(shell.progress()));
    auto options = design.known();
    options.count = a.count;
    options.region = design.trust_region(search);
    const auto designs =
        a.learn ? search.next_to_learn(options, shell.progress()) : search.next_designs(options, shell.progress());
    json list = json::array();
    std::string text;
    for (const auto& c : designs) {
        list.push_back(json_of(search, design.spec(), c));
        text += "fidelity " + design.spec().fidelities.at(std::min(c.level, design.spec().fidelities.size() - 1)).name +
                ": the error of its " + search.problem().objectives.front().response.quantity + " falls from " +
                core::told(c.sigma_now, unit_of_load(search.problem()), 3) + " to " +
                core::told(c.sigma_after, unit_of_load(search.problem()), 3) + "; it is solved with a chance of " +
                core::format_number(100 * c.chance_solved, 3) + " %\n" + text_of(search, c);
    }
    constexpr double hopeless = 0.01;  // chance that all limits hold
    if (!designs.empty() && std::all_of(designs.begin(), designs.end(),
                                        [](const tables::Candidate& c) { return c.chance_valid < hopeless; })) {
        shell.show_warning(
            "none of these designs meets all limits with a chance above 1 %: runs there would show where the limits "
            "lie; design optimise says which of them stand in the way");
    }
    if (designs.size() < a.count) {
        text += (designs.empty() ? std::string("No design") : "Only " + core::counted(designs.size(), "design")) +
                (designs.size() > 1 ? " that the plan has not yet meet" : " that the plan has not yet meets") +
                " the limits that are known without a run.\n";
    }
    if (a.add && !designs.empty()) {
        (void)design.add(designs, a.learn ? "largest drop of the error" : "expected improvement");
        text += "added to " + (design.spec().folder / "plan.csv").string() + "\n";
    }
    if (shell.json) {
        shell.print_json({{"next", list}, {"added", a.add}, {"notes", notes_json(design)}});
    }
    shell.print(text);
    return done;
}

/// Which limits stand in the way where no design meets all.
std::string what_excludes(const tables::DesignSearch& search,
                          const std::map<std::string, tables::Surrogate>& surrogates, const Arguments& a,
                          std::uint64_t seed, Shell& shell, json& list) {
    const auto& limits = search.problem().limits;
    const auto alone = tables::limits_alone(search.problem(), surrogates, a.sigmas, seed, shell.progress());
    std::string text;
    bool each = !limits.empty();
    for (std::size_t k = 0; k < limits.size(); ++k) {
        const std::string unit = search.unit_of(limits[k].response);
        json one = {{"name", limits[k].response.name}, {"met_alone", alone[k] && alone[k]->met}};
        text += "  " + limits[k].response.name + ": ";
        if (alone[k]) {
            one["nearest"] = {{"value", alone[k]->nearest.value}, {"sigma", alone[k]->nearest.sigma}};
            if (limits[k].response.curve) {
                one["nearest"]["at_least"] = alone[k]->nearest.at_least;
            }
            text += std::string(alone[k]->met ? "can be met alone, with " : "cannot be met: at the nearest ") +
                    cases::told_response(alone[k]->nearest, limits[k].response);
        } else {
            text += "no shape meets the limits that are known without a run";
        }
        const auto bound = [&](const char* words, double value) {
            text += core::is_limit(value) ? ", " + std::string(words) + " " + core::told(value, unit, 4) : "";
        };
        bound("wanted at least", limits[k].lower);
        bound("at most", limits[k].upper);
        text += "\n";
        each = each && alone[k] && alone[k]->met;
        list.push_back(std::move(one));
    }
    return text + (each             ? "  Each can be met alone, but not all at once.\n"
                   : limits.empty() ? "  No shape meets the limits that are known without a run ([design.volume], and "
                                      "clear of the ground at every gap and "
                                      "pitch of [design]).\n"
                                    : "");
}

int optimise(Shell& shell, const Arguments& a) {
    cases::Design design = open(shell, a);
    const auto surrogates = design.surrogates(shell.progress());
    const tables::DesignSearch search = design.search(surrogates);
    const auto best = search.optimum(a.sigmas, design.spec().seed, shell.progress());
    const auto front = a.front > 0 ? search.pareto_front(a.front, a.sigmas, design.spec().seed, shell.progress())
                                   : std::vector<tables::Candidate>{};
    json list = json::array();
    const std::string margin = core::counted_text(core::format_number(a.sigmas, 3), "standard deviation");
    const auto& objectives = search.problem().objectives;
    const std::string of_first = objectives.size() < 2 ? std::string()
                                                       : " in the first of " + std::to_string(objectives.size()) +
                                                             " objectives alone (--front weighs none of them)";
    std::string text = best ? "Best by the surrogates" + of_first + ", with every limit met by " + margin +
                                  ". It is a prediction: compute it.\n" + text_of(search, *best)
                            : "No design meets every limit by " + margin + ".\n";
    json excluded = json::array();
    if (!best) {
        text += what_excludes(search, surrogates, a, design.spec().seed, shell, excluded);
    }
    for (const auto& c : front) {
        list.push_back(json_of(search, design.spec(), c));
        text += "front:\n" + text_of(search, c);
    }
    std::vector<tables::Candidate> found = front;
    if (front.empty() && best) {
        found.push_back(*best);
    }
    if (!a.out.empty()) {
        core::write_csv(a.out, tables::table(search, found));
    }
    json added = json::array();
    if (a.add && !found.empty()) {
        const std::size_t before = design.plan().size();
        const auto names = design.add_for_proof(found);
        added = names;
        std::string all;
        for (const std::string& name : names) {
            all += (all.empty() ? "" : ", ") + name;
        }
        const std::size_t fresh = design.plan().size() - before;
        text += core::counted(fresh, "design") + " added to " + (design.spec().folder / "plan.csv").string() + " on " +
                design.spec().fidelities.back().name + " (" + all + ")" +
                (fresh < names.size() ? ", the others stand there already" : "") +
                "; `design run` computes them, `design report` has prediction beside result\n";
    }
    if (shell.json) {
        shell.print_json({{"best", best ? json_of(search, design.spec(), *best) : json()},
                          {"front", list},
                          {"added", added},
                          {"limits", excluded},
                          {"notes", notes_json(design)}});
    }
    shell.print(text);
    return best || !front.empty() ? done : check_failed;
}

int sensitivity(Shell& shell, const Arguments& a) {
    const cases::Design design = open(shell, a);
    json list = json::array();
    std::string text;
    const auto interval = [](const tables::SobolIndex& i) {
        return json{{"value", i.value}, {"lower", i.lower}, {"upper", i.upper}};
    };
    for (const auto& one : cases::learned_numbers(design, design.surrogates(shell.progress()))) {
        const tables::SobolIndices indices = design.sensitivity(one);
        json variables = json::array();
        const std::vector<double> middle = cases::middle_of(one.variables);
        text += one.name + " (share of the variance: alone, with interactions)\n";
        for (std::size_t v = 0; v < one.variables.size(); ++v) {
            json at = json::array(), value = json::array(), sigma = json::array();
            for (const cases::OneAtATime& point : cases::along(one, middle, v, 11)) {
                at.push_back(point.at);
                value.push_back(point.value);
                sigma.push_back(point.sigma);
            }
            variables.push_back({{"name", one.variables[v].name},
                                 {"first", interval(indices.first[v])},
                                 {"total", interval(indices.total[v])},
                                 {"held_at", middle[v]},
                                 {"one_at_a_time", {{"at", at}, {"value", value}, {"sigma", sigma}}}});
            text += "  " + one.variables[v].name + ": " + core::format_number(indices.first[v].value, 2) + ", " +
                    core::format_number(indices.total[v].value, 2) + " (" +
                    core::format_number(indices.total[v].lower, 2) + " to " +
                    core::format_number(indices.total[v].upper, 2) + ")\n";
        }
        list.push_back({{"quantity", one.name},
                        {"unit", one.unit},
                        {"mean", indices.mean},
                        {"variance", indices.variance},
                        {"variables", variables}});
    }
    if (shell.json) {
        shell.print_json({{"sensitivities", list}, {"notes", notes_json(design)}});
    }
    shell.print(text);
    return done;
}

std::vector<std::string> list_of(const std::string& text) {
    std::vector<std::string> names;
    for (const auto part : core::split(text, ',')) {
        if (!core::trimmed(part).empty()) {
            names.emplace_back(core::trimmed(part));
        }
    }
    return names;
}

/// A design of the plan by its name, else a file.
geometry::BodyShape shape_asked(const cases::Design& design, const std::string& what) {
    std::vector<std::string> names;
    for (const auto& planned : design.plan()) {
        if (planned.name == what) {
            geometry::BodyShape shape = design.shape_at(planned.at);
            shape.name = planned.name;
            return shape;
        }
        names.push_back(planned.name);
    }
    if (!std::filesystem::exists(what) && !what.ends_with(".toml")) {
        throw core::InputError("name", "there is no design '" + what + "' in the plan, and no such file", {},
                               core::did_you_mean(what, names));
    }
    return geometry::read_shape(what);
}

int table(Shell& shell, const Arguments& a) {
    Shell::will_write(a.out);
    const cases::Design design = open(shell, a);
    cases::AskedPoints asked{list_of(a.quantity), list_of(a.axes),
                             a.where.empty() ? cases::Conditions() : cases::conditions_from(a.where)};
    cases::check_asked(design.spec(), asked);
    const geometry::BodyShape shape = shape_asked(design, a.shape);
    const auto known = cases::learned_loads(design, asked.quantities, shell.progress());
    const core::Table points = cases::shape_points(*known, shape, asked);
    core::write_csv(a.out, points);
    std::string text;
    for (const auto& line : points.comments) {
        text += line + "\n";
    }
    if (shell.json) {
        json quantities = json::array();
        for (const auto& one : known->surrogates) {
            quantities.push_back(one.quantity());
        }
        shell.print_json({{"table", a.out},
                          {"points", points.rows()},
                          {"quantities", quantities},
                          {"rests_on", points.comments},
                          {"notes", notes_json(design)}});
    }
    shell.print(text + a.out + ": " + core::counted(points.rows(), "point") + "\n");
    return done;
}

int report(Shell& shell, const Arguments& a) {
    const std::string file =
        a.out.empty() ? (cases::Study::open(a.study).folder() / "report" / "design.html").string() : a.out;
    Shell::will_write(file);
    const cases::Design design = open(shell, a);
    std::filesystem::create_directories(std::filesystem::absolute(file).parent_path());
    core::write_file(file,
                     cases::design_report(
                         design, [](const core::Figure& figure) { return render_png(figure); }, shell.progress()));
    if (shell.json) {
        shell.print_json({{"report", file}});
    }
    shell.print("report: " + file + "\n");
    return done;
}

}  // namespace

void add_design_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("design", "a search for a better shape: [design] of study.toml");
    command->require_subcommand(1);
    auto a = std::make_shared<Arguments>();
    const auto step = [&](const char* name, const char* what, int (*action)(Shell&, const Arguments&),
                          const std::string& examples = "") {
        CLI::App* sub = command->add_subcommand(name, what);
        sub->footer("Examples:\n" +
                    (examples.empty() ? "  underbody design " + std::string(name) + " cases/evie-pitch\n" : examples));
        sub->add_option("study", a->study, "folder with study.toml, which has a [design]")->required();
        shell.on(sub, [action, a, &shell] { return action(shell, *a); });
        return sub;
    };
    step("plan", "the first designs, into plan.csv and shapes", plan,
         "  underbody design plan cases/evie-pitch\n"
         "Designs can be typed into design/plan.csv as well; `design run` makes their shapes.\n");
    step("run", "computes what is planned and has no result, by OpenFOAM", run,
         "  underbody design run cases/evie-pitch\n"
         "  underbody design run cases/evie-pitch --jobs 2\n"
         "Exit code 3 when not one case of results.csv gave loads.\n")
        ->add_option("--jobs", a->jobs, "cases at a time, each on one core")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    step("fit", "surrogates of the loads, checked on shapes left out", fit);
    CLI::App* more = step("next", "what to compute next, and what it is worth", next,
                          "  underbody design next cases/evie-pitch\n"
                          "  underbody design next cases/evie-pitch --count 2 --add\n"
                          "  underbody design next cases/evie-pitch --learn\n"
                          "Planned designs without a result count as run with what is predicted there.\n");
    more->add_option("--count", a->count, "designs at once, for so many machines")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    more->add_flag("--learn", a->learn, "where the error of the first objective falls most, not where it improves");
    more->add_flag("--add", a->add, "into the plan, to be run");
    CLI::App* best = step("optimise", "the best design by the surrogates, and fronts of several objectives", optimise,
                          "  underbody design optimise cases/evie-pitch\n"
                          "  underbody design optimise cases/evie-pitch --sigmas 2 --out best.csv\n"
                          "  underbody design optimise cases/evie-pitch --front 10\n"
                          "  underbody design optimise cases/evie-pitch --sigmas 0.2 --add      to be proved by CFD\n");
    best->add_option("--sigmas", a->sigmas, "limits are met by so many standard deviations")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    best->add_option("--front", a->front, "designs of the front of all objectives")->capture_default_str();
    best->add_option("--out", a->out, "CSV of the designs found");
    best->add_flag("--add", a->add,
                   "the best, or with --front these, into the plan on the finest mesh, with what is predicted of them");
    CLI::App* loads =
        step("table", "loads of one shape by the surrogates, as a force table", table,
             "  underbody design table cases/evie-pitch spread-03 --where pitch=0 --out loads.csv\n"
             "  underbody design table cases/evie-pitch my-shape.toml --quantity lift_force --axes gap,pitch "
             "--out lift.csv\n"
             "table, export and a model's [[force]] take it as they take a table of CFD cases. In a study a\n"
             "[[table]] with shape = \"my-shape.toml\" is the same, for its report, exports and maps.\n");
    loads->add_option("shape", a->shape, "a design of the plan, or SHAPE.toml that differs in the varied numbers alone")
        ->required();
    loads->add_option("--quantity", a->quantity, "lift_force,pitch_moment ... (default: all that [design] computes)");
    loads->add_option("--axes", a->axes,
                      "conditions that are axes, such as gap,pitch (default: all that vary and are not held)");
    loads->add_option("--where", a->where, "what is held, such as pitch=0,speed=0.5m/s");
    loads->add_option("--out", a->out, "CSV of the points, with their errors")->required();
    step("sensitivity", "which variables the loads depend on: Sobol's indices", sensitivity);
    step("report", "everything as one page", report,
         "  underbody design report cases/evie-pitch\n"
         "  underbody design report cases/evie-pitch --out design.html\n")
        ->add_option("--out", a->out, "HTML file (default STUDY/report/design.html)");
    command->footer(
        "Examples:\n"
        "  underbody design plan cases/evie-pitch\n"
        "  underbody design run cases/evie-pitch --jobs 2\n"
        "  underbody design next cases/evie-pitch --count 2 --add\n"
        "  underbody design optimise cases/evie-pitch --front 10\n");
}

}  // namespace underbody::studio
