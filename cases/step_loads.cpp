// Loads of every case, in parallel, and the table of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "cases/engine.h"
#include "core/parallel.h"
#include "core/units.h"
#include "postproc/field.h"
#include "postproc/loads.h"

namespace underbody::cases {

namespace {

postproc::LoadsOptions loads_options(const Study& study, const Case& entry) {
    postproc::LoadsOptions options;
    options.zones = entry.zones;
    options.forward = postproc::axis_from(study.forward);
    options.up = postproc::axis_from(study.up);
    options.symmetry = study.symmetry;
    options.reference = study.moments_about;
    options.references.density = study.reference.number("density");
    options.references.length = study.reference.number("length");
    options.references.width = study.reference.number("width");
    options.references.height = study.reference.number("height");
    options.references.speed = entry.conditions.number("speed");
    return options;
}

Key loads_key(Engine& engine, const Case& entry) {
    Key key("loads", {"postproc"});
    key.add(engine.hash_of(entry.file)).add(engine.study.forward).add(engine.study.up).add(engine.study.symmetry);
    key.add(engine.study.reference).add(entry.conditions.number("speed").value_or(0));
    if (engine.study.moments_about) {
        for (const double x : *engine.study.moments_about) {
            key.add(x);
        }
    }
    for (const auto& zone : entry.zones) {
        key.add(zone);
    }
    return key;
}

std::string compute_loads(Engine& engine, const Case& entry) {
    postproc::ReadOptions reading;
    reading.surfaces_only = true;
    const postproc::Field field = postproc::read_field(entry.file, reading, engine.progress);
    const postproc::LoadsResult result = postproc::loads(field, loads_options(engine.study, entry), engine.progress);
    nlohmann::json document;
    postproc::to_json(document, result);
    document["columns"] = nlohmann::json::array();
    for (const auto& column : postproc::table_row(result)) {
        document["columns"].push_back({{"name", column.name}, {"unit", column.unit}, {"value", column.value}});
    }
    document["format"] = field.format;
    document["pressure_viscous"] = {{"lift_pressure", result.named_pressure.lift_force},
                                    {"lift_viscous", result.named_viscous.lift_force},
                                    {"drag_pressure", result.named_pressure.drag_force},
                                    {"drag_viscous", result.named_viscous.drag_force}};
    return document.dump();
}

}  // namespace

core::Table loads_table(const Study& study, const std::vector<std::pair<const Case*, nlohmann::json>>& done) {
    std::vector<std::string> texts;
    std::vector<std::string> numbers;
    const auto remember = [](std::vector<std::string>& names, const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            names.push_back(name);
        }
    };
    for (const auto& [entry, document] : done) {
        for (const auto& [name, value] : entry->conditions.texts) {
            remember(texts, name);
        }
        for (const auto& [name, value] : entry->conditions.numbers) {
            remember(numbers, name);
        }
    }
    core::Table table;
    table.source = study.folder().string();
    std::vector<std::string> names;
    for (const auto& item : done) {
        names.push_back(item.first->name);
    }
    table.add_text("case", names);
    for (const auto& name : texts) {
        std::vector<std::string> values;
        for (const auto& item : done) {
            values.push_back(item.first->conditions.text(name).value_or(""));
        }
        table.add_text(name, std::move(values));
    }
    for (const auto& name : numbers) {
        std::vector<double> values;
        for (const auto& item : done) {
            values.push_back(item.first->conditions.number(name).value_or(std::numeric_limits<double>::quiet_NaN()));
        }
        const auto* quantity = core::find_quantity(name);
        const std::string unit = quantity != nullptr ? quantity->unit : "1";
        table.add_numbers(name, unit, std::move(values), name == "gap" ? "mm" : name == "pitch" ? "deg" : unit);
    }
    if (done.empty()) {
        return table;
    }
    for (const auto& column : done.front().second.at("columns")) {
        std::vector<double> values;
        for (const auto& item : done) {
            double value = std::numeric_limits<double>::quiet_NaN();
            for (const auto& candidate : item.second.at("columns")) {
                if (candidate.at("name") == column.at("name") && candidate.at("value").is_number()) {
                    value = candidate.at("value").get<double>();
                }
            }
            values.push_back(value);
        }
        if (table.find(column.at("name").get<std::string>()) == nullptr) {
            table.add_numbers(column.at("name"), column.at("unit"), std::move(values));
        }
    }
    return table;
}

void run_loads(Engine& engine) {
    const auto& cases = engine.study.cases;
    std::vector<std::optional<std::string>> documents(cases.size());
    core::parallel_for(
        cases.size(),
        [&](std::size_t i) {
            try {
                documents[i] = engine.make("loads", cases[i].name, loads_key(engine, cases[i]),
                                           [&] { return compute_loads(engine, cases[i]); });
            } catch (const core::InputError& error) {
                engine.fail("loads", cases[i].name, error.what());  // the file itself cannot be read
            }
        },
        engine.progress);
    std::vector<std::pair<const Case*, nlohmann::json>> done;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        if (documents[i]) {
            engine.add_document("loads/" + cases[i].name, *documents[i]);
            done.emplace_back(&cases[i], nlohmann::json::parse(*documents[i]));
        }
    }
    // Steps came from many threads: give them the order of the cases.
    auto& steps = engine.results.steps;
    std::stable_sort(steps.begin(), steps.end(), [](const StepResult& a, const StepResult& b) {
        return a.kind == "loads" && b.kind == "loads" && a.name < b.name;
    });
    engine.results.loads = loads_table(engine.study, done);
}

}  // namespace underbody::cases
