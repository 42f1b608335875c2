#include "cases/why.h"

#include <algorithm>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cases/engine.h"
#include "core/text.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

using Name = std::pair<std::string, std::string>;  ///< kind and name, as a person knows them

std::string in_words(const json& value, const std::string& unit = {}) {
    const std::string text = value.is_string()   ? value.get<std::string>()
                             : value.is_number() ? core::format_number(value.get<double>(), 6)
                                                 : value.dump();
    return unit.empty() || unit == "1" ? text : text + " " + unit;
}

void facts_of_loads(const json& document, Origin& origin) {
    for (const auto& column : document.value("columns", json::array())) {
        origin.facts.emplace_back(column.at("name").get<std::string>(),
                                  in_words(column.at("value"), column.at("unit").get<std::string>()));
    }
    for (const auto& zone : document.value("zones", json::array())) {
        origin.facts.emplace_back("zone '" + zone.at("name").get<std::string>() + "'",
                                  in_words(zone.at("faces")) + " faces, " + in_words(zone.at("area"), "m^2"));
    }
    for (const char* key : {"values_from", "orientation", "reference_from", "format", "writer"}) {
        if (document.contains(key) && !document.at(key).empty() && document.at(key) != "") {
            origin.facts.emplace_back(key, in_words(document.at(key)));
        }
    }
    const json said = document.value("metadata", json::array());
    for (const auto& entry : said) {  // of the solver and its settings
        origin.facts.emplace_back("the file says " + in_words(entry.at(0)), in_words(entry.at(1)));
    }
    for (const auto& problem : document.value("problems", json::array())) {
        origin.facts.emplace_back(problem.at("severity").get<std::string>(), problem.at("message").get<std::string>());
    }
}

void facts_of_table(const json& document, Origin& origin) {
    origin.facts.emplace_back("fit", in_words(document.at("kind")));
    const std::string points = document.value("points", "");
    std::size_t count = 0;
    for (const auto line : core::split(points, '\n')) {
        const std::string text(core::trimmed(line));
        if (!text.empty() && text.front() != '#') {
            origin.facts.emplace_back(count == 0 ? "points" : "point " + std::to_string(count), text);
            ++count;
        }
    }
    for (const auto& point : document.value("equilibria", json::array())) {
        origin.facts.emplace_back(point.value("stable", false) ? "stable gap" : "unstable gap",
                                  in_words(point.value("gap", json()), "m"));
    }
}

void take_facts(const std::string& value, Origin& origin) {
    const json document =
        json::parse(value.substr(0, value.find('\n') == std::string::npos || value.front() != '{' ? value.size()
                                                                                                  : value.find('\n')),
                    nullptr, false);
    if (!document.is_object()) {
        return;
    }
    if (origin.kind == "loads") {
        facts_of_loads(document, origin);
    } else if (origin.kind == "table") {
        facts_of_table(document, origin);
    }
    for (const auto& entry : origin.kind == "region" ? document.value("classes", json::array()) : json::array()) {
        origin.facts.emplace_back(
            in_words(entry.at("name")),
            core::format_number(100 * entry.at("fraction").get<double>(), 4) + " % of the starts");
    }
    if (origin.kind == "mesh") {
        const json quantities = document.value("quantities", json::object());
        for (const auto& [quantity, found] : quantities.items()) {
            origin.facts.emplace_back(quantity, in_words(found.value("verdict", json())) + ", standard uncertainty " +
                                                    in_words(found.value("standard_uncertainty", json())));
        }
    }
}

Origin origin_of(const Name& name, const StoredResult& result, Store& store) {
    Origin origin;
    origin.kind = name.first;
    origin.name = name.second;
    origin.files = result.inputs;
    const Store::Made made = store.made(result.id).value_or(Store::Made{"{}", ""});
    origin.made = made.when;
    const json about = json::parse(made.about);
    const json options = about.value("options", json::object());
    const json code = about.value("code", json::object());
    const json from = about.value("from", json::array());
    for (const auto& [label, value] : options.items()) {
        origin.options.emplace_back(label, value.get<std::string>());
    }
    for (const auto& [room, version] : code.items()) {
        origin.code.emplace_back(room, version.get<std::string>());
    }
    for (const auto& entry : from) {
        origin.from.emplace_back(entry.at("kind").get<std::string>(), entry.at("name").get<std::string>());
    }
    take_facts(store.value(result.id).value_or(""), origin);
    return origin;
}

/// The file beside the report that holds a result; empty: none does.
std::string file_of(const Name& name) {
    const auto& [kind, of] = name;
    const auto as = of.rfind(" as ");
    if (kind == "model") {
        return "models/" + of + "/model.toml";
    }
    if (kind != "export" || as == std::string::npos) {
        return {};
    }
    std::string file = of.substr(0, as);
    std::replace_if(
        file.begin(), file.end(), [](char c) { return c == ' ' || c == ','; }, '_');
    for (const auto& format : tables::export_formats()) {
        file += format.name == of.substr(as + 4) ? format.ending : "";
    }
    return "exports/" + file;
}

/// "lift_force of cube-h2", "'cube-h2'", "report/exports/lift.h" without what says nothing of the result.
std::string bare(std::string what) {
    if (const auto of = what.rfind(" of "); of != std::string::npos) {
        what = what.substr(of + 4);
    }
    std::erase(what, '\'');
    for (const std::string_view folder : {"./", "report/"}) {
        if (what.starts_with(folder)) {
            what.erase(0, folder.size());
        }
    }
    return what;
}

bool is_called(const Name& name, const std::string& what) {
    const std::string file = file_of(name);
    const bool in_file = !file.empty() && (what == file || what == fs::path(file).filename().string());
    return name.first + "/" + name.second == what || name.second == what || in_file;
}

template <class Known>
Name result_called(const Known& known, const std::string& asked, const Study& study) {
    const std::string what = bare(asked);
    std::vector<Name> found;
    std::vector<std::string> names;
    for (const auto& [name, result] : known) {
        names.push_back(name.first + "/" + name.second);
        if (is_called(name, what) && name.first != "figure") {
            found.push_back(name);
        }
    }
    const auto whole = std::find_if(found.begin(), found.end(),
                                    [&](const Name& name) { return name.first + "/" + name.second == what; });
    if (whole != found.end()) {
        return *whole;
    }
    const core::Place place{study.folder().string(), {}, {}, {}};
    if (found.empty()) {
        throw core::InputError("missing", "the study has no result '" + what + "' that is still true", place,
                               names.empty() ? "run the study first" : core::did_you_mean(what, names));
    }
    if (found.size() > 1) {
        std::string list;
        for (const auto& [kind, name] : found) {
            list += (list.empty() ? "" : ", ") + kind + "/" + name;
        }
        throw core::InputError("name", "several results are called '" + what + "': " + list, place,
                               "name it with its kind");
    }
    return found.front();
}

}  // namespace

std::vector<Origin> origins(const Study& study, const RunOptions& options, const std::string& what) {
    std::map<Name, StoredResult> known;
    Engine engine(study, options, Engine::Mode::look, core::Progress::none());
    engine.watch([&](const std::string& shown_name, const StoredResult& result) {
        known.insert_or_assign({result.kind, shown_name}, result);
    });
    look_at_all(engine);
    std::vector<Origin> all;
    std::deque<Name> next = {result_called(known, what, study)};
    std::set<Name> seen = {next.front()};
    for (; !next.empty(); next.pop_front()) {
        const auto result = known.find(next.front());
        if (result == known.end()) {
            Origin gone;
            gone.kind = next.front().first;
            gone.name = next.front().second;
            gone.state = StepState::changed;
            all.push_back(std::move(gone));
            continue;
        }
        all.push_back(origin_of(result->first, result->second, *engine.store()));
        for (const auto& source : all.back().from) {
            if (seen.insert(source).second) {
                next.push_back(source);
            }
        }
    }
    return all;
}

void to_json(json& all, const Origin& origin) {
    const auto object = [](const std::vector<std::pair<std::string, std::string>>& pairs) {
        json result = json::object();
        for (const auto& [key, value] : pairs) {
            result[key] = value;
        }
        return result;
    };
    all = {{"kind", origin.kind}, {"name", origin.name}, {"state", to_string(origin.state)}, {"made", origin.made}};
    all["facts"] = json::array();
    for (const auto& [key, value] : origin.facts) {
        all["facts"].push_back({{"name", key}, {"value", value}});
    }
    all["options"] = object(origin.options);
    all["code"] = object(origin.code);
    all["files"] = json::array();
    for (const auto& file : origin.files) {
        const char* kind = file.kind == core::Input::Kind::content ? "content"
                           : file.kind == core::Input::Kind::names ? "names"
                                                                   : "presence";
        all["files"].push_back({{"path", file.path}, {"kind", kind}, {"state", file.state}});
        if (!file.pattern.empty()) {
            all["files"].back()["pattern"] = file.pattern;
        }
    }
    all["from"] = json::array();
    for (const auto& [kind, name] : origin.from) {
        all["from"].push_back({{"kind", kind}, {"name", name}});
    }
}

}  // namespace underbody::cases
