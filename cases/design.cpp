#include "cases/design.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "cases/design_file.h"
#include "cases/design_origin.h"
#include "cases/volume_fault.h"
#include "core/counted.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"
#include "surrogates/tables/search/sampling.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using tables::SearchVariable;

namespace {

/// The same case.
bool is_same(const std::vector<SearchVariable>& variables, const DesignRun& a, const DesignRun& b) {
    return a.design == b.design && a.fidelity == b.fidelity && same_numbers(variables, a.at, b.at) &&
           agree(a.origin, b.origin);
}

/// A run that stands twice counts once: of rows of one design the last that has loads, as where it is computed again;
/// of rows under two names, or none, those whose loads are equal to the last digit.
void find_repeated(const DesignSpec& spec, const core::Table& table, std::vector<DesignRun>& runs,
                   core::Problems& notes) {
    const auto variables = spec.all_variables();
    const bool named = table.find("design") != nullptr;
    for (std::size_t i = 1; i < runs.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            DesignRun &first = runs[j], &later = runs[i];
            if (!first.counts() || !later.counts() || !same_numbers(variables, first.at, later.at) ||
                first.fidelity != later.fidelity) {
                continue;
            }
            const bool copy = !first.loads.empty() && first.loads == later.loads;
            if (!copy && !(named && first.design == later.design)) {
                continue;
            }
            const bool first_counts = copy || (later.loads.empty() && !first.loads.empty());
            (first_counts ? later : first).repeated = true;
            if (first.loads.empty() && later.loads.empty()) {
                continue;  // failed twice
            }
            const bool differ = !first.loads.empty() && !later.loads.empty();
            notes.push_back({core::Problem::Severity::warning,
                             "rows " + std::to_string(j + 1) + " and " + std::to_string(i + 1) +
                                 " are of the same case (" + first.design +
                                 (later.design == first.design ? "" : ", " + later.design) + "): " +
                                 (copy ? "it counts once"
                                       : "the " + std::string(first_counts ? "first" : "last") + " counts, " +
                                             (differ ? "their loads differ" : "the other has no loads")),
                             table.place(first_counts ? i : j, variables.front().name)});
        }
    }
}

std::vector<DesignRun> rows_of(const DesignSpec& spec, const core::Table& table, core::Problems& notes) {
    const std::string& file = table.source;
    std::vector<DesignRun> runs(table.rows());
    const auto designs = text_or(table, "design", "-");
    const auto fidelities = text_or(table, "fidelity", spec.fidelities.back().name);
    const auto states = text_or(table, "state", "solved");
    for (std::size_t i = 0; i < runs.size(); ++i) {
        runs[i].design = designs[i];
        runs[i].fidelity = fidelities[i];
        runs[i].state = states[i];
        (void)level_of(spec, fidelities[i], file + " row " + std::to_string(i + 1));
    }
    for (const SearchVariable& v : spec.all_variables()) {
        const bool unsaid = !v.of_shape && table.find(v.name) == nullptr;  // had one value: the runs may say it
        const auto& values = unsaid ? std::vector<double>(runs.size(), std::nan("")) : numbers_of(table, v);
        for (std::size_t i = 0; i < runs.size(); ++i) {
            runs[i].at.push_back(values[i]);
        }
    }
    for (const std::string& q : spec.quantities) {
        const bool there = table.find(q) != nullptr, sigma = table.find(q + "_sigma") != nullptr;
        if (!there) {
            notes.push_back(
                {core::Problem::Severity::warning, "no column " + q + ": it cannot be learned", {file, {}, {}, {}}});
            continue;
        }
        const auto& values = table.numbers(q);
        for (std::size_t i = 0; i < runs.size(); ++i) {
            const double error = sigma ? table.numbers(q + "_sigma")[i] : std::nan("");
            if (error < 0) {
                throw core::InputError("range",
                                       "a standard deviation of " + core::format_number(error, 6) + ": below nought",
                                       table.place(i, q + "_sigma"), "leave it empty where it is not known");
            }
            if (std::isfinite(values[i])) {
                runs[i].loads[q] = values[i];
                if (std::isfinite(error)) {
                    runs[i].sigmas[q] = error;
                }
            }
        }
    }
    read_origins(table, spec, runs);
    return runs;
}

/// Throws where a run does not say where it stands, and no case in [design] folder does.
void check_places(const DesignSpec& spec, const core::Table& table, const std::vector<DesignRun>& runs) {
    const auto all = spec.all_variables();
    for (std::size_t i = 0; i < runs.size(); ++i) {
        for (std::size_t v = 0; v < all.size(); ++v) {
            if (!std::isfinite(runs[i].at[v])) {
                (void)numbers_of(table, all[v]);
                throw core::InputError("missing", "a run without " + all[v].name, table.place(i, all[v].name));
            }
        }
    }
}

/// Before anything is computed: what no surrogate can learn is not worth a run.
void check_count(const DesignSpec& spec, const Study& study) {
    const auto all = spec.all_variables();
    if (all.size() <= tables::Surrogate::most_variables) {
        return;
    }
    std::string conditions;
    for (std::size_t v = spec.variables.size(); v < all.size(); ++v) {
        conditions += (v + 1 == all.size() ? " and " : ", ") + all[v].name;
    }
    throw core::InputError("range",
                           "[design] has " + std::to_string(all.size()) + " variables: " +
                               core::counted(spec.variables.size(), "number") + " of the shape" + conditions,
                           {(study.folder() / "study.toml").string(), {}, {}, {}},
                           "surrogates learn " + std::to_string(tables::Surrogate::most_variables) +
                               " at most: vary fewer numbers, or give a condition one value");
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
    check_count(design.spec_, study);
    design.water_ = {study.reference.number("density"), !study.symmetry.empty(), study.moments_about};
    design.base_ = geometry::read_shape(design.spec_.shape);
    const auto& varied = design.spec_.variables;
    if (design.spec_.jet.any() && !design.base_.nozzle &&
        std::none_of(varied.begin(), varied.end(), [](const auto& v) { return v.name.starts_with("nozzle."); })) {
        throw core::InputError("missing", "the body has no nozzle for the jet of [design]",
                               {design.spec_.shape.string(), {}, {}, {}}, "[nozzle] with diameter = \"5 mm\"");
    }
    const fs::path plan = design.spec_.folder / "plan.csv", results = design.spec_.folder / "results.csv";
    if (fs::exists(plan)) {
        design.read_plan(plan);
    }
    if (fs::exists(results)) {
        design.read_results(results);
    }
    return design;
}

void Design::read_results(const fs::path& file) {
    const core::Table table = results_file_.read(file, names_of(results_table()));
    runs_ = rows_of(spec_, table, notes);
    settle_origins(table, spec_, base_, water_, runs_, notes);
    check_places(spec_, table, runs_);
    note_other_conditions(spec_, table, notes);
    find_repeated(spec_, table, runs_, notes);
    note_unknown_sigmas();
    note_unsettled();
    note_silent_rows(spec_, file.string(), runs_, notes);
}

RunOrigin Design::origin_now(const std::vector<double>& at, const std::string& fidelity) const {
    try {
        RunOrigin now = origin_of(spec_, base_, asked_for(spec_, base_, water_, at, fidelity));
        now.moments = moments_about(spec_, water_);
        return now;
    } catch (const core::InputError&) {
        return {};  // no such shape
    }
}

void Design::note_unsettled() {
    const auto unsettled = std::count_if(runs_.begin(), runs_.end(), [](const DesignRun& run) {
        return run.state == not_settled_state && run.counts();
    });
    if (unsettled > 0) {
        notes.push_back({core::Problem::Severity::warning,
                         core::counted(unsettled, "run") + (unsettled == 1 ? " has not settled: it is left out"
                                                                           : " have not settled: they are left out"),
                         {(spec_.folder / "results.csv").string(), {}, {}, {}}});
    }
}

DesignRun* Design::find(const DesignRun& run) {
    const auto variables = spec_.all_variables();
    const auto same = std::find_if(runs_.begin(), runs_.end(), [&](const DesignRun& known) {
        return known.counts() && is_same(variables, known, run);
    });
    return same == runs_.end() ? nullptr : &*same;
}

void Design::keep(const DesignRun& run) {
    DesignRun* same = find(run);
    if (same != nullptr) {
        if (same->loads.empty() && run.loads.empty() && same->state == run.state) {
            return;  // failed again in the same way
        }
        *same = run;
        rows_changed_ = true;  // the case itself is there to be read again; the file follows
        return;
    }
    runs_.push_back(run);
    if (results_file_.ours() && !rows_changed_) {
        results_file_.append(results_table(runs_.size() - 1));
    } else {
        write_results();
    }
}

void Design::write_results() {
    fs::create_directories(spec_.folder);
    results_file_.write(spec_.folder / "results.csv", results_table());
    rows_changed_ = false;
}

void Design::note_unknown_sigmas() {
    for (const std::string& q : spec_.quantities) {
        std::size_t without = 0, with = 0;
        for (const DesignRun& run : runs_) {
            if (run.usable() && run.loads.contains(q)) {
                (run.sigmas.contains(q) ? with : without) += 1;
            }
        }
        if (without > 0) {
            notes.push_back({core::Problem::Severity::note,
                             q + ": of " + core::counted(without, "run") + " the standard deviation is unknown: " +
                                 (with > 0 ? "learned with the median of the others of their fidelity"
                                           : "their scatter is estimated with the surrogate"),
                             {(spec_.folder / "results.csv").string(), {}, {}, {}}});
        }
    }
}

core::Table Design::results_table(std::size_t first) const {
    core::Table table;
    const std::span<const DesignRun> runs = std::span(runs_).subspan(first);
    std::vector<std::string> designs, fidelities, states, shapes, meshes, moments;
    for (const DesignRun& run : runs) {
        designs.push_back(run.design);
        fidelities.push_back(run.fidelity);
        states.push_back(run.state);
        shapes.push_back(run.origin.shape);
        meshes.push_back(run.origin.mesh);
        moments.push_back(run.origin.moments);
    }
    table.add_text("design", designs);
    const auto all = spec_.all_variables();
    for (std::size_t v = 0; v < all.size(); ++v) {
        std::vector<double> values;
        for (const DesignRun& run : runs) {
            values.push_back(run.at[v]);
        }
        table.add_numbers(all[v].name, all[v].unit, values, geometry::shown_unit(all[v].unit));
    }
    for (const auto& [name, unit] : origin_columns(spec_)) {
        std::vector<double> values;
        for (const DesignRun& run : runs) {
            const auto known = run.origin.numbers.find(name);
            values.push_back(known == run.origin.numbers.end() ? std::nan("") : known->second);
        }
        table.add_numbers(name, unit, values, geometry::shown_unit(unit));
    }
    table.add_text("shape_hash", shapes);
    table.add_text("fidelity", fidelities);
    table.add_text("mesh_settings", meshes);
    if (has_moments(spec_)) {
        table.add_text("moments_about", moments);
    }
    for (const std::string& q : spec_.quantities) {
        std::vector<double> values, sigmas;
        for (const DesignRun& run : runs) {
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

}  // namespace underbody::cases
