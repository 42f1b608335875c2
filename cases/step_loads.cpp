// Loads of every case, in parallel, and the table of them.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "cases/body_of_case.h"
#include "cases/case_loads.h"
#include "cases/engine.h"
#include "cases/names_in_study.h"
#include "cases/time_means.h"
#include "core/parallel.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/field/field.h"
#include "postproc/field/problems_json.h"
#include "postproc/loads/declared.h"
#include "postproc/loads/loads.h"
#include "postproc/loads/loads_case.h"
#include "postproc/loads/loads_table.h"
#include "postproc/loads/settled.h"

namespace underbody::cases {

namespace {

using nlohmann::json;

Key loads_key(const Study& study, const Case& entry) {
    Key key("loads", {"postproc"});
    key.add("forward", study.forward).add("up", study.up).add("symmetry", study.symmetry);
    key.add("reference", study.reference).add("speed", study.speed_of(entry).value_or(0));
    if (const auto own = entry.conditions.number("density")) {
        key.add("density", *own);
    }
    for (const char* declared : {"gap", "pitch", "jet_flow", "jet_voltage"}) {  // held against what the file shows
        if (const auto own = entry.conditions.number(declared)) {
            key.add(declared, *own);
        }
    }
    if (study.moments_about) {
        for (const double x : *study.moments_about) {
            key.add("moments_about", x);
        }
    }
    for (const auto& zone : entry.zones) {
        key.add("zone", zone);
    }
    add_units(key, entry);
    key.close();
    return key;
}

/// The keys of all cases. Where the conditions that a key is made of are the same, it is made once.
class LoadsKeys {
public:
    explicit LoadsKeys(const Study& study) {
        using Units = std::vector<std::pair<std::string, std::string>>;
        using Number = std::optional<double>;
        std::map<std::tuple<Number, std::vector<Number>, std::vector<std::string>, std::string, Units>, std::size_t>
            known;
        for (const auto& entry : study.cases) {
            const Conditions& own = entry.conditions;
            const auto [at, fresh] = known.try_emplace({study.speed_of(entry),
                                                        {own.number("density"), own.number("gap"), own.number("pitch"),
                                                         own.number("jet_flow"), own.number("jet_voltage")},
                                                        entry.zones,
                                                        entry.length_unit,
                                                        entry.units},
                                                       keys_.size());
            if (fresh) {
                keys_.push_back(loads_key(study, entry));
            }
            of_case_.push_back(at->second);
        }
    }
    const Key& operator[](std::size_t i) const { return keys_[of_case_[i]]; }

private:
    std::vector<Key> keys_;
    std::vector<std::size_t> of_case_;
};

/// Findings of what was read, with the path that they have in the study.
core::Problems findings(const Engine& engine, const postproc::Field& field, const postproc::LoadsResult& result) {
    core::Problems all = field.problems;
    all.insert(all.end(), result.problems.begin(), result.problems.end());
    name_in_study(engine, all);
    return all;
}

std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
    return text;
}

/// What a list of cases shows, quick to read for ten thousand of them: a line for each value (name, unit, number) and
/// for each warning ("!", file, message), one for the verdict on the solution ("?", verdict, why), one for the tilt of
/// the base ("^", rad) and one for the extent of the body ("#", length and height, m), parted by tabs.
std::string brief(const std::vector<postproc::LoadsColumn>& columns, const postproc::Settled& settled,
                  double base_pitch, const postproc::LoadsResult& result, const core::Problems& problems) {
    std::string text;
    for (const auto& column : columns) {
        text += column.name + "\t" + column.unit + "\t" + core::format_number(column.value) + "\n";
    }
    text += "?\t" + to_string(settled.verdict) + "\t" + one_line(settled.why) + "\n";
    text += "^\trad\t" + core::format_number(base_pitch) + "\n";
    if (result.dimension == 3) {
        text += "#\t" + core::format_number(result.extent[0]) + "\t" + core::format_number(result.extent[2]) + "\n";
    }
    for (const auto& problem : problems) {
        if (problem.severity != core::Problem::Severity::note) {
            text += "!\t" + one_line(problem.place.file) + "\t" + one_line(problem.message) + "\n";
        }
    }
    return text;
}

/// What a list of cases shows and judges them by.
bool is_listed(std::string_view value) {
    return value == "lift_force" || value == "drag_force" || value == "side_force" || value == "lift_pressure" ||
           value.ends_with("_sigma");
}

/// `list`: only the values that one shows; ten thousand cases have a hundred thousand others.
void take_brief(std::string_view text, CaseLoads& loads, bool list) {
    const auto word = [&](char end) {
        const std::size_t at = std::min(text.find(end), text.size());
        const std::string_view result = text.substr(0, at);
        text.remove_prefix(std::min(at + 1, text.size()));
        return result;
    };
    loads.values.reserve(list ? 4 : static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')));
    while (!text.empty()) {
        const std::string_view name = word('\t');
        const std::string_view unit = word('\t');
        const std::string_view rest = word('\n');
        if (name == "!") {
            loads.warnings.push_back(
                {core::Problem::Severity::warning, std::string(rest), {std::string(unit), {}, {}, {}}});
        } else if (name == "?") {
            loads.settled = std::string(unit);
            loads.settled_why = std::string(rest);
        } else if (name == "^") {
            loads.base_pitch = core::parse_number(rest).value_or(NAN);
        } else if (name == "#") {
            loads.body_length = core::parse_number(unit).value_or(NAN);
            loads.body_height = core::parse_number(rest).value_or(NAN);
        } else if (!list || is_listed(name)) {
            loads.values.push_back(
                {std::string(name), std::string(unit), core::parse_number(rest).value_or(std::nan(""))});
        }
    }
}

/// What a study says of a case that its file is to bear out.
postproc::Declared declared(const Case& entry) {
    const auto number = [&](const char* name) { return entry.conditions.number(name); };
    postproc::Declared said{number("gap").value_or(NAN), number("pitch").value_or(NAN)};
    said.zones_named = !entry.zones.empty();
    said.driven = number("jet_flow").value_or(0) != 0 || number("jet_voltage").value_or(0) != 0;
    return said;
}

Value compute_loads(Engine& engine, const Case& entry) {
    postproc::ReadOptions reading = read_options(entry);
    reading.surfaces_only = true;
    const postproc::Field field = postproc::read_field(entry.file, reading, engine.progress);
    postproc::LoadsResult result = postproc::loads(field, loads_options(engine.study, entry), engine.progress);
    postproc::Declared said = declared(entry);
    said.speed = engine.study.speed_of(entry).value_or(NAN);
    const core::Problems faults = postproc::declared_faults(field, result, said);
    result.problems.insert(result.problems.end(), faults.begin(), faults.end());
    core::Problems problems = findings(engine, field, result);
    core::Problems notes;
    const postproc::Settled settled =
        postproc::settled_by(result, postproc::stated_beside(entry.file, result), entry.file, notes);
    if (settled.verdict == postproc::SettledVerdict::not_settled) {
        problems.push_back({core::Problem::Severity::warning,
                            "the solution has not settled: " + settled.why,
                            {engine.path_in_study(entry.file), {}, {}, {}}});
    }
    std::copy_if(notes.begin(), notes.end(), std::back_inserter(problems),
                 [](const core::Problem& note) { return note.severity != core::Problem::Severity::note; });
    // What the loads scatter by from iteration to iteration is an error of theirs.
    auto columns = postproc::table_columns(result);
    for (const auto& load : settled.loads) {
        if (load.sigma > 0) {
            columns.push_back({load.quantity + "_sigma", core::find_quantity(load.quantity)->unit, load.sigma});
        }
    }
    json document;
    postproc::to_json(document, result);
    document["file"] = engine.path_in_study(entry.file);
    document["problems"] = postproc::json_of(problems);
    document["columns"] = json::array();
    document["settled"] = settled;
    for (const auto& column : columns) {
        document["columns"].push_back({{"name", column.name}, {"unit", column.unit}, {"value", column.value}});
    }
    document["format"] = field.format;
    document["writer"] = field.writer;
    document["metadata"] = field.metadata;
    document["pressure_viscous"] = {{"lift_pressure", result.named_pressure.lift_force},
                                    {"lift_viscous", result.named_viscous.lift_force},
                                    {"drag_pressure", result.named_pressure.drag_force},
                                    {"drag_viscous", result.named_viscous.drag_force}};
    return {document.dump(-1, ' ', false, json::error_handler_t::replace),
            brief(columns, settled, postproc::base_tilt(result, said.base), result, problems)};
}

/// Copies of one file under several names, a warning with the last of each; a file in another unit than the rest;
/// pitches that do not agree.
void warn_of_odd_ones(const Study& study, std::vector<CaseLoads>& all) {
    std::vector<postproc::ConditionedLoads> cases;
    std::vector<std::size_t> place;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].values.empty()) {
            continue;
        }
        const Conditions& conditions = study.cases[i].conditions;
        postproc::ConditionedLoads one{all[i].name,
                                       conditions.texts,
                                       {all[i].value("lift_force"), all[i].value("drag_force"),
                                        all[i].value("side_force"), all[i].value("lift_pressure")},
                                       all[i].base_pitch};
        for (const auto& [name, value] : conditions.numbers) {
            if (!postproc::is_result(name)) {
                one.conditions.emplace_back(name, core::format_number(value));
            }
        }
        cases.push_back(std::move(one));
        place.push_back(i);
    }
    BodiesOfCases bodies(study);
    for (CaseLoads& loads : all) {
        if (auto fault = bodies.fault(loads)) {
            loads.warnings.push_back(std::move(*fault));
        }
    }
    for (const auto& [problem, last] : postproc::odd_loads(cases)) {
        CaseLoads& loads = all[place[last]];
        loads.warnings.push_back(problem);
        loads.warnings.back().place.file = loads.file;
    }
}

}  // namespace

core::Table loads_table(const Study& study, const std::vector<CaseLoads>& loads) {
    std::vector<std::string> names, verdicts;
    std::vector<postproc::LoadsRow> rows;
    postproc::LoadsColumns columns;
    std::unordered_map<std::string, const Conditions*> first_with;  // number -> who says its unit
    std::unordered_set<std::string> found;
    for (const auto& one : loads) {
        if (one.values.empty()) {
            continue;
        }
        names.push_back(one.name);
        verdicts.push_back(one.settled);
        const Case& entry = study.cases[one.entry];
        auto& row = rows.emplace_back(postproc::LoadsRow{entry.conditions.texts, entry.conditions.numbers, {}});
        if (const auto speed = study.speed_of(entry); speed && !entry.conditions.number("speed")) {
            row.numbers.emplace_back("speed", *speed);
        }
        for (auto& [name, value] : row.numbers) {
            first_with.emplace(name, &entry.conditions);
            if (entry.mean && name == "time") {
                value = std::nan("");
            }
        }
        for (const auto& value : one.values) {
            row.values.emplace_back(value.name, value.value);
            if (found.insert(value.name).second) {
                columns.values.push_back({value.name, value.unit});
            }
        }
    }
    columns.units = [&](const std::string& name) {
        const Conditions& conditions = *first_with.at(name);
        return std::pair(conditions.unit(name), conditions.shown_unit(name));
    };
    // The error that a manifest states of a case is the case's; a load that it states stands beside the computed one.
    columns.is_found = [&](const std::string& name) { return found.count(name) != 0 && !name.ends_with("_sigma"); };
    core::Table table;
    table.source = study.folder().string();
    table.add_text("case", std::move(names));
    postproc::add_loads_rows(table, rows, columns);
    if (!rows.empty() && table.find("settled") == nullptr) {
        table.add_text("settled", std::move(verdicts));
    }
    return table;
}

void find_loads(Engine& engine, bool list) {
    const auto& cases = engine.study.cases;
    const std::size_t first = engine.results.steps.size();
    auto& all = engine.results.case_loads;
    all.resize(cases.size());
    const LoadsKeys keys(engine.study);
    core::parallel_for(
        cases.size(),
        [&](std::size_t i) {
            CaseLoads& one = all[i];
            one.entry = i;
            one.name = cases[i].name;
            one.file = engine.path_in_study(cases[i].file);
            StepResult step;
            const auto made = engine.make(
                "loads", one.file, keys[i], [&] { return compute_loads(engine, cases[i]); }, one.name, &step);
            one.state = step.state;
            one.error = step.error;
            if (made) {
                one.id = made->id;
                one.origin = made->identity;
                take_brief(made->summary, one, list);
            }
        },
        engine.progress);
    warn_of_odd_ones(engine.study, all);
    // Steps came from many threads: give them the order of the cases.
    auto& steps = engine.results.steps;
    std::stable_sort(steps.begin() + static_cast<std::ptrdiff_t>(first), steps.end(),
                     [](const StepResult& a, const StepResult& b) { return a.name < b.name; });
}

void run_loads(Engine& engine) {
    find_loads(engine, false);
    const auto& cases = engine.study.cases;
    auto& all = engine.results.case_loads;
    const bool in_time = std::any_of(cases.begin(), cases.end(), [](const Case& entry) { return entry.mean; });
    engine.results.loads =
        in_time ? loads_table(engine.study, with_means_in_time(engine.study, all)) : loads_table(engine.study, all);
}

}  // namespace underbody::cases
