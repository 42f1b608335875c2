#include "cases/design.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "cases/design_file.h"
#include "core/error.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/search/sampling.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using tables::SearchVariable;

namespace {

std::string numbered(std::size_t index) {
    const std::string digits = std::to_string(index + 1);
    return "design-" + std::string(digits.size() < 3 ? 3 - digits.size() : 0, '0') + digits;
}

const std::vector<double>& numbers_of(const core::Table& table, const SearchVariable& v) {
    const core::Column* column = table.find(v.name);
    if (column == nullptr) {
        throw core::InputError("column", table.source + " has no column '" + v.name + "', which [design] varies", {},
                               "set the file aside, or vary what it holds");
    }
    return table.numbers(v.name);
}

std::vector<std::string> text_or(const core::Table& table, const std::string& name, const std::string& fallback) {
    return table.find(name) != nullptr ? table.text(name) : std::vector<std::string>(table.rows(), fallback);
}

std::size_t level_of(const DesignSpec& spec, const std::string& fidelity, const std::string& where) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < spec.fidelities.size(); ++i) {
        if (spec.fidelities[i].name == fidelity) {
            return i;
        }
        names.push_back(spec.fidelities[i].name);
    }
    throw core::InputError("name", where + ": there is no fidelity '" + fidelity + "' in [design]", {},
                           core::did_you_mean(fidelity, names));
}

std::vector<PlannedDesign> read_plan(const DesignSpec& spec, const fs::path& file) {
    const core::Table table = core::read_csv(file);
    std::vector<PlannedDesign> plan(table.rows());
    const auto names = table.text("design");
    const auto fidelities = text_or(table, "fidelity", spec.fidelities.front().name);
    const auto whys = text_or(table, "why", "typed");
    const auto states = text_or(table, "state", "planned");
    for (std::size_t i = 0; i < plan.size(); ++i) {
        plan[i] = {names[i], {}, fidelities[i], whys[i], states[i]};
        (void)level_of(spec, fidelities[i], file.string() + " row " + std::to_string(i + 1));
    }
    for (const SearchVariable& v : spec.variables) {
        const auto& values = numbers_of(table, v);
        for (std::size_t i = 0; i < plan.size(); ++i) {
            plan[i].at.push_back(values[i]);
        }
    }
    return plan;
}

std::vector<DesignRun> read_results(const DesignSpec& spec, const fs::path& file, core::Problems& notes) {
    const core::Table table = core::read_csv(file);
    std::vector<DesignRun> runs(table.rows());
    const auto designs = text_or(table, "design", "-");
    const auto fidelities = text_or(table, "fidelity", spec.fidelities.back().name);
    const auto states = text_or(table, "state", "solved");
    for (std::size_t i = 0; i < runs.size(); ++i) {
        runs[i].design = designs[i];
        runs[i].fidelity = fidelities[i];
        runs[i].state = states[i];
        (void)level_of(spec, fidelities[i], file.string() + " row " + std::to_string(i + 1));
    }
    for (const SearchVariable& v : spec.all_variables()) {
        const auto& values = numbers_of(table, v);
        for (std::size_t i = 0; i < runs.size(); ++i) {
            runs[i].at.push_back(values[i]);
            if (!std::isfinite(values[i])) {
                throw core::InputError("missing", "a run without " + v.name, table.place(i, v.name));
            }
        }
    }
    for (const std::string& q : spec.quantities) {
        const bool there = table.find(q) != nullptr, sigma = table.find(q + "_sigma") != nullptr;
        if (!there) {
            notes.push_back({core::Problem::Severity::warning,
                             "no column " + q + ": it cannot be learned",
                             {file.string(), {}, {}, {}}});
            continue;
        }
        const auto& values = table.numbers(q);
        for (std::size_t i = 0; i < runs.size(); ++i) {
            if (std::isfinite(values[i])) {
                runs[i].loads[q] = values[i];
                runs[i].sigmas[q] =
                    sigma && std::isfinite(table.numbers(q + "_sigma")[i]) ? table.numbers(q + "_sigma")[i] : 0;
            }
        }
    }
    return runs;
}

}  // namespace

Design Design::open(const Study& study) {
    if (!study.design) {
        throw core::InputError("missing", (study.folder() / "study.toml").string() + " has no [design]", {},
                               "[design] with shape, [[design.vary]] and [[design.objective]]");
    }
    Design design;
    design.spec_ = *study.design;
    check_responses(design.spec_);
    design.base_ = geometry::read_shape(design.spec_.shape);
    const fs::path plan = design.spec_.folder / "plan.csv", results = design.spec_.folder / "results.csv";
    if (fs::exists(plan)) {
        design.plan_ = read_plan(design.spec_, plan);
    }
    if (fs::exists(results)) {
        design.runs_ = read_results(design.spec_, results, design.notes);
    }
    std::size_t unsettled = 0;
    for (const DesignRun& run : design.runs_) {
        unsettled += run.state == not_settled_state ? 1 : 0;
    }
    if (unsettled > 0) {
        design.notes.push_back({core::Problem::Severity::warning,
                                std::to_string(unsettled) + " runs have not settled: they are left out",
                                {results.string(), {}, {}, {}}});
    }
    return design;
}

std::size_t Design::make_plan(core::Progress& progress) {
    const std::size_t axes = spec_.variables.size();
    std::size_t had = 0;
    for (const PlannedDesign& design : plan_) {
        had += design.why == "plan" ? 1 : 0;
    }
    if (had >= spec_.points) {
        return 0;
    }
    // A hypercube cannot be continued: what is missing is a hypercube of its own.
    const std::size_t count = spec_.points - had;
    const tables::Plan points = spec_.plan == "sobol" ? tables::sobol_plan(count, axes, spec_.seed, had)
                                                      : tables::latin_hypercube(count, axes, spec_.seed + had);
    for (const std::vector<double>& u : points) {
        progress.check();
        PlannedDesign design{numbered(plan_.size()), {}, spec_.fidelities.front().name, "plan", "planned"};
        for (std::size_t v = 0; v < axes; ++v) {
            design.at.push_back(spec_.variables[v].unscaled(u[v]));
        }
        plan_.push_back(std::move(design));
    }
    write();
    return count;
}

void Design::add(const std::vector<tables::Candidate>& candidates, const std::string& why) {
    for (const tables::Candidate& c : candidates) {
        plan_.push_back({numbered(plan_.size()), c.at,
                         spec_.fidelities.at(std::min(c.level, spec_.fidelities.size() - 1)).name, one_field(why),
                         "planned"});
    }
    write();
}

void Design::write() const {
    std::vector<PlannedDesign> plan = plan_;
    for (PlannedDesign& design : plan) {
        const fs::path file = spec_.folder / "shapes" / (design.name + ".toml");
        try {
            geometry::BodyShape shape = shape_at(spec_, base_, design.at);
            shape.name = design.name;
            const std::string text = geometry::write_shape(shape);
            if (!fs::exists(file) || core::read_file(file) != text) {
                fs::create_directories(file.parent_path());
                core::write_file(file, text);
            }
        } catch (const core::InputError& error) {
            design.state = one_field(error.message());
        }
    }
    Design written = *this;
    written.plan_ = std::move(plan);
    fs::create_directories(spec_.folder);
    core::write_csv(spec_.folder / "plan.csv", written.plan_table());
    if (!runs_.empty()) {
        core::write_csv(spec_.folder / "results.csv", results_table());
    }
}

core::Table Design::plan_table() const {
    core::Table table;
    std::vector<std::string> names, fidelities, whys, states;
    for (const PlannedDesign& d : plan_) {
        names.push_back(d.name);
        fidelities.push_back(d.fidelity);
        whys.push_back(d.why);
        states.push_back(d.state);
    }
    table.add_text("design", names);
    for (std::size_t v = 0; v < spec_.variables.size(); ++v) {
        std::vector<double> values;
        for (const PlannedDesign& d : plan_) {
            values.push_back(d.at[v]);
        }
        table.add_numbers(spec_.variables[v].name, spec_.variables[v].unit, values,
                          geometry::shown_unit(spec_.variables[v].unit));
    }
    table.add_text("fidelity", fidelities);
    table.add_text("why", whys);
    table.add_text("state", states);
    return table;
}

core::Table Design::results_table() const {
    core::Table table;
    std::vector<std::string> designs, fidelities, states;
    for (const DesignRun& run : runs_) {
        designs.push_back(run.design);
        fidelities.push_back(run.fidelity);
        states.push_back(run.state);
    }
    table.add_text("design", designs);
    const auto all = spec_.all_variables();
    for (std::size_t v = 0; v < all.size(); ++v) {
        std::vector<double> values;
        for (const DesignRun& run : runs_) {
            values.push_back(run.at[v]);
        }
        table.add_numbers(all[v].name, all[v].unit, values, geometry::shown_unit(all[v].unit));
    }
    table.add_text("fidelity", fidelities);
    for (const std::string& q : spec_.quantities) {
        std::vector<double> values, sigmas;
        for (const DesignRun& run : runs_) {
            const auto load = run.loads.find(q), sigma = run.sigmas.find(q);
            values.push_back(load == run.loads.end() ? std::nan("") : load->second);
            sigmas.push_back(sigma == run.sigmas.end() ? std::nan("") : sigma->second);
        }
        const std::string unit = core::find_quantity(q)->unit;
        table.add_numbers(q, unit, values);
        table.add_numbers(q + "_sigma", unit, sigmas);
    }
    table.add_text("state", states);
    return table;
}

std::map<std::string, tables::Surrogate> Design::surrogates(core::Progress& progress) const {
    std::map<std::string, tables::Surrogate> result;
    for (const std::string& q : spec_.quantities) {
        std::vector<tables::SearchRun> runs;
        for (const DesignRun& run : runs_) {
            const auto load = run.loads.find(q);
            if (run.usable() && load != run.loads.end()) {
                runs.push_back({run.at, level_of(spec_, run.fidelity, run.design), load->second, run.sigmas.at(q)});
            }
        }
        result.emplace(q,
                       tables::Surrogate::fit(q, core::find_quantity(q)->unit, spec_.all_variables(), runs, progress));
    }
    return result;
}

tables::DesignSearch Design::search(std::map<std::string, tables::Surrogate> surrogates) const {
    tables::SearchProblem problem;
    problem.variables = spec_.variables;
    problem.objectives = spec_.objectives;
    problem.limits = spec_.limits;
    problem.known_limits.push_back(
        [spec = spec_, base = base_](std::span<const double> at) { return broken_by(spec, base, at); });
    return {std::move(problem), std::move(surrogates)};
}

tables::DesignSearch::NextOptions Design::known() const {
    tables::DesignSearch::NextOptions options;
    options.seed = spec_.seed + runs_.size();
    for (const FidelitySpec& fidelity : spec_.fidelities) {
        options.level_costs.push_back(fidelity.cost);
    }
    std::map<std::vector<double>, bool> solved;
    for (const DesignRun& run : runs_) {
        const std::vector<double> at(run.at.begin(),
                                     run.at.begin() + static_cast<std::ptrdiff_t>(spec_.variables.size()));
        auto [entry, fresh] = solved.try_emplace(at, run.usable());
        entry->second = entry->second && run.usable();
    }
    for (const auto& [at, good] : solved) {
        (good ? options.solved : options.failed).push_back(at);
    }
    return options;
}

tables::SobolIndices Design::sensitivity(const tables::Surrogate& surrogate) const {
    const auto& variables = surrogate.variables();
    return tables::sobol_indices(
        [&](std::span<const double> u) {
            std::vector<double> x;
            for (std::size_t v = 0; v < variables.size(); ++v) {
                x.push_back(variables[v].unscaled(u[v]));
            }
            return surrogate.at(x).value;
        },
        variables.size(), 1024, spec_.seed);
}

}  // namespace underbody::cases
