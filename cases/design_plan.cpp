// The plan of a design search: plan.csv and the shapes of its designs.
#include <algorithm>
#include <array>
#include <cmath>

#include "cases/design.h"
#include "cases/design_file.h"
#include "cases/design_origin.h"
#include "cases/volume_fault.h"
#include "core/error.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "geometry/body/variants.h"
#include "surrogates/tables/search/sampling.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using tables::Response;
using tables::SearchVariable;

namespace {

/// A name that no design of the plan has.
std::string next_name(const std::vector<PlannedDesign>& plan) {
    for (std::size_t index = plan.size() + 1;; ++index) {
        const std::string digits = std::to_string(index);
        std::string name = "design-" + std::string(digits.size() < 3 ? 3 - digits.size() : 0, '0') + digits;
        if (std::none_of(plan.begin(), plan.end(), [&](const PlannedDesign& d) { return d.name == name; })) {
            return name;
        }
    }
}

const std::string said_before = "_predicted", its_error = "_predicted_sigma", cut = "_predicted_at_least",
                  said_of = "predicted_of";

void read_predictions(const DesignSpec& spec, const core::Table& table, std::vector<PlannedDesign>& plan) {
    const auto of = text_or(table, said_of, "");
    for (std::size_t i = 0; i < plan.size(); ++i) {
        plan[i].predicted_of = of[i];
    }
    for (const Response& response : spec.responses()) {
        const std::string& name = response.name;
        if (table.find(name + said_before) == nullptr || table.find(name + its_error) == nullptr) {
            continue;
        }
        const auto &value = table.numbers(name + said_before), &sigma = table.numbers(name + its_error);
        for (std::size_t i = 0; i < plan.size(); ++i) {
            if (std::isfinite(value[i]) && std::isfinite(sigma[i])) {
                plan[i].predicted[name] = {value[i], sigma[i]};
                plan[i].predicted[name].at_least =
                    table.find(name + cut) != nullptr && table.numbers(name + cut)[i] > 0;
            }
        }
    }
}

std::vector<PlannedDesign> planned_in(const DesignSpec& spec, const core::Table& table) {
    const std::string& file = table.source;
    std::vector<PlannedDesign> plan(table.rows());
    const auto names = table.text("design");
    const auto fidelities = text_or(table, "fidelity", spec.fidelities.front().name);
    const auto whys = text_or(table, "why", "typed");
    const auto states = text_or(table, "state", "planned");
    for (std::size_t i = 0; i < plan.size(); ++i) {
        plan[i] = {names[i], {}, fidelities[i], whys[i], states[i], {}, {}};
        (void)level_of(spec, fidelities[i], file + " row " + std::to_string(i + 1));
    }
    for (const SearchVariable& v : spec.variables) {
        const auto& values = numbers_of(table, v);
        for (std::size_t i = 0; i < plan.size(); ++i) {
            plan[i].at.push_back(values[i]);
        }
    }
    read_predictions(spec, table, plan);
    for (std::size_t i = 0; i < plan.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (plan[i].name == plan[j].name &&
                (plan[i].fidelity == plan[j].fidelity || !same_numbers(spec.variables, plan[i].at, plan[j].at))) {
                throw core::InputError("duplicate", "the design " + plan[i].name + " stands twice",
                                       table.place(i, "design"), "a name of its own for each");
            }
        }
    }
    return plan;
}

/// One of the files in shapes, which follow plan.csv and the shape of [design].
void write_shape_file(const fs::path& file, const std::string& text) {
    if (fs::exists(file) && core::read_file(file) == text) {
        return;
    }
    fs::create_directories(file.parent_path());
    try {
        core::write_file(file, text);
    } catch (const core::InputError&) {
        throw core::InputError("exists",
                               "the shape of this design is another one now (the shape of [design] or plan.csv has "
                               "changed), and this file was copied or changed by hand",
                               {file.string(), {}, {}, {}},
                               "remove " + file.parent_path().string() + ": its files are made anew");
    }
}

}  // namespace

void Design::read_plan(const fs::path& file) {
    std::vector<std::string> own = names_of(plan_table());
    for (const Response& response : spec_.responses()) {
        own.insert(own.end(), {response.name + said_before, response.name + its_error, response.name + cut});
    }
    own.push_back(said_of);
    plan_ = planned_in(spec_, plan_file_.read(file, own));
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
        PlannedDesign design{next_name(plan_), {}, spec_.fidelities.front().name, "plan", "planned", {}, {}};
        for (std::size_t v = 0; v < axes; ++v) {
            design.at.push_back(spec_.variables[v].unscaled(u[v]));
        }
        try {
            // What is known without a run costs none.
            const std::string fault = volume_fault(spec_, shape_at(design.at));
            if (!fault.empty()) {
                design.state = one_field(fault);
            }
        } catch (const core::InputError&) {
            // No possible shape: its state says so when the shapes are written.
        }
        plan_.push_back(std::move(design));
    }
    write_plan();
    return count;
}

void Design::write_plan() {
    write_shapes();
    fs::create_directories(spec_.folder);
    plan_file_.write(spec_.folder / "plan.csv", plan_table());
}

bool Design::write_shapes() {
    bool refused = false;
    for (PlannedDesign& design : plan_) {
        std::string text;
        try {
            geometry::BodyShape shape = shape_at(design.at);
            shape.name = design.name;
            text = geometry::write_shape(shape);
        } catch (const core::InputError& error) {
            refused = refused || design.state == "planned";
            design.state = one_field(error.message() + (error.hint().empty() ? "" : "; " + error.hint()));
            continue;
        }
        write_shape_file(spec_.folder / "shapes" / (design.name + ".toml"), text);
    }
    return refused;
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
    add_predictions(table);
    return table;
}

std::string Design::what_is_asked() const {
    core::Hasher hash;
    hash.add(hash_of_base(spec_, base_));
    // As shape_hash(): the same number written in other units differs in its last bits.
    const auto number = [&](double value) { hash.add(core::format_number(value == 0 ? 0.0 : value, 12)); };
    const auto numbers = [&](const std::string& of, const auto& values) {
        hash.add(of);
        std::for_each(values.begin(), values.end(), number);
    };
    number(spec_.kinematic_viscosity);
    number(water_.density.value_or(geometry::default_water_density));
    if (water_.moments_about) {
        numbers("moments about", *water_.moments_about);
    }
    for (const ComputedCondition& condition : spec_.conditions()) {
        numbers(condition.name, condition.values);
    }
    numbers("flow of a voltage", std::array{spec_.jet.flow_per_volt, spec_.jet.dead_band});
    for (const Response& response : spec_.responses()) {
        hash.add(response.name).add(response.quantity).add(response.slope_along);
        number(response.half_width);
        for (const auto& condition : response.conditions) {
            hash.add(condition.name);
            number(condition.value);
        }
        if (response.curve) {
            const tables::CurveAsked& asked = *response.curve;
            hash.add(tables::to_string(asked.curve)).add(asked.net_weight ? "weight" : "no weight").add(asked.moment);
            numbers("numbers of a curve", std::array{asked.net_weight.value_or(0), asked.virtual_mass, asked.about,
                                                     asked.restoring ? 1.0 : 0.0, asked.most_moment});
        }
    }
    return hash.digest().substr(0, 12);
}

std::vector<std::string> Design::add(const std::vector<tables::Candidate>& candidates, const std::string& why) {
    std::vector<std::string> names;
    for (const tables::Candidate& c : candidates) {
        PlannedDesign chosen{{},
                             c.at,
                             spec_.fidelities.at(std::min(c.level, spec_.fidelities.size() - 1)).name,
                             one_field(why),
                             "planned",
                             {},
                             what_is_asked()};
        bool planned = false;
        for (const PlannedDesign& d : plan_) {
            if (same_numbers(spec_.variables, d.at, c.at)) {
                chosen.name = d.name;  // one shape, one name, on each of its meshes
                chosen.at = d.at;
                planned = planned || d.fidelity == chosen.fidelity;
            }
        }
        if (chosen.name.empty()) {
            chosen.name = next_name(plan_);
        }
        names.push_back(chosen.name);
        if (planned) {
            continue;
        }
        for (std::size_t k = 0; k < c.objectives.size() && k < spec_.objectives.size(); ++k) {
            chosen.predicted[spec_.objectives[k].response.name] = c.objectives[k];
        }
        for (std::size_t k = 0; k < c.limits.size() && k < spec_.limits.size(); ++k) {
            chosen.predicted[spec_.limits[k].response.name] = c.limits[k];
        }
        plan_.push_back(std::move(chosen));
    }
    write_plan();
    return names;
}

std::vector<std::string> Design::add_for_proof(std::vector<tables::Candidate> best) {
    for (tables::Candidate& one : best) {
        one.level = spec_.fidelities.size() - 1;
    }
    return add(best, "best by the surrogates: to be proved on " + spec_.fidelities.back().name);
}

void Design::add_predictions(core::Table& table) const {
    if (std::none_of(plan_.begin(), plan_.end(), [](const PlannedDesign& d) { return !d.predicted_of.empty(); })) {
        return;
    }
    std::vector<std::string> of;
    for (const PlannedDesign& d : plan_) {
        of.push_back(d.predicted_of);
    }
    for (const Response& response : spec_.responses()) {
        std::vector<double> values, sigmas, at_least;
        for (const PlannedDesign& d : plan_) {
            const auto said = d.predicted.find(response.name);
            at_least.push_back(said == d.predicted.end() ? std::nan("") : said->second.at_least ? 1 : 0);
            values.push_back(said == d.predicted.end() ? std::nan("") : said->second.value);
            sigmas.push_back(said == d.predicted.end() ? std::nan("") : said->second.sigma);
        }
        table.add_numbers(response.name + said_before, response_unit(response), values);
        table.add_numbers(response.name + its_error, response_unit(response), sigmas);
        if (response.curve) {
            table.add_numbers(response.name + cut, "1", at_least);
        }
    }
    table.add_text(said_of, of);
}

}  // namespace underbody::cases
