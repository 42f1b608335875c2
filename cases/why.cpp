#include "cases/why.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "cases/engine.h"
#include "cases/export_files.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using nlohmann::json;

const Fact* Origin::fact(const std::string& fact_name) const {
    const auto found = std::find_if(facts.begin(), facts.end(), [&](const Fact& one) { return one.name == fact_name; });
    return found == facts.end() ? nullptr : &*found;
}

namespace {

using Name = std::pair<std::string, std::string>;  ///< kind and name, as a person knows them

std::string shown(const Name& name) { return name.first + "/" + name.second; }

/// The file beside the report that holds a result; empty: none does.
std::string file_of(const Name& name) {
    const auto& [kind, of] = name;
    if (kind == "model") {
        return "models/" + of + "/model.toml";
    }
    const auto as = of.rfind(" as ");
    return kind != "export" || as == std::string::npos ? ""
                                                       : "exports/" + export_file(of.substr(0, as), of.substr(as + 4));
}

/// "'cube-h2'", "report/exports/lift.h" without what says nothing of the result.
std::string bare(std::string what) {
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
    return shown(name) == what || name.second == what || in_file;
}

/// What the head of an exported file says of its making.
struct Head {
    Name result;
    std::string id;       ///< of the result
    std::string content;  ///< hash of the file that it was made from
};

/// The text behind the first `word`, as much as a line of a head may hold.
std::string behind(const std::string& bytes, const std::string& word) {
    const auto at = bytes.find(word);
    return at == std::string::npos ? "" : bytes.substr(at + word.size(), 300);
}

Head head_of(const fs::path& file) {
    Head head;
    const std::string bytes = core::read_file(file);
    std::smatch found;
    static const std::regex result("^([a-z]+)/([^\n]{1,200}?) ([0-9a-f]{16})");
    if (const std::string line = behind(bytes, "Result: "); std::regex_search(line, found, result)) {
        head.result = {found[1], found[2]};
        head.id = found[3];
    }
    static const std::regex content("^([0-9a-f]{16,})\\)");
    if (const std::string line = behind(bytes, "(content "); std::regex_search(line, found, content)) {
        head.content = found[1];
    }
    return head;
}

class Walk {
public:
    Walk(const Study& study, const RunOptions& options)
        : study_(study), engine_(study, options, Engine::Mode::look, core::Progress::none()) {
        engine_.watch([this](const std::string& shown_name, const StoredResult& result) {
            true_.insert_or_assign({result.kind, shown_name}, result);
        });
        look_at_all(engine_);
    }

    Way from(const std::string& what) {
        for (const fs::path& file : {fs::path(what), engine_.report_folder() / bare(what)}) {
            std::error_code ignored;
            if (fs::is_regular_file(file, ignored) && from_file(file)) {
                return std::move(way_);
            }
        }
        if (!what.empty() && !find_true(bare(what)) &&
            (std::isdigit(static_cast<unsigned char>(what.front())) != 0 || what.front() == '-') && from_number(what)) {
            return std::move(way_);
        }
        std::string quantity;
        std::string name = bare(what);
        if (const auto of = name.find(" of "); of != std::string::npos && !find_true(name)) {
            quantity = name.substr(0, of);
            name.erase(0, of + 4);
        }
        walk(*result_called(name));
        if (!quantity.empty()) {
            ask(quantity);
        }
        return std::move(way_);
    }

private:
    using Known = std::map<Name, StoredResult>;

    [[nodiscard]] core::Place place() const { return {study_.folder().string(), {}, {}, {}}; }

    [[nodiscard]] bool find_true(const std::string& what) const {
        return std::any_of(true_.begin(), true_.end(), [&](const auto& one) { return is_called(one.first, what); });
    }

    Known::const_iterator result_called(const std::string& what) const {
        std::vector<Known::const_iterator> found;
        std::vector<std::string> names;
        for (auto one = true_.begin(); one != true_.end(); ++one) {
            names.push_back(shown(one->first));
            if (shown(one->first) == what) {
                return one;
            }
            if (is_called(one->first, what) && one->first.first != "figure") {
                found.push_back(one);
            }
        }
        if (found.empty()) {
            throw core::InputError("missing", "the study has no result '" + what + "' that is still true", place(),
                                   names.empty() ? "run the study first" : core::did_you_mean(what, names));
        }
        if (found.size() > 1) {
            std::string list;
            for (const auto& one : found) {
                list += (list.empty() ? "" : ", ") + shown(one->first);
            }
            throw core::InputError("name", "several results are called '" + what + "': " + list, place(),
                                   "name it with its kind");
        }
        return found.front();
    }

    /// The number of the first result that is called so.
    void ask(const std::string& quantity) {
        const Origin& first = way_.origins.front();
        if (const Fact* fact = first.fact(quantity)) {
            way_.asked = *fact;
            return;
        }
        std::vector<std::string> names;
        for (const auto& fact : first.facts) {
            names.push_back(fact.name);
        }
        throw core::InputError("name", first.kind + " '" + first.name + "' says nothing of '" + quantity + "'", place(),
                               core::did_you_mean(quantity, names));
    }

    /// A file that was exported from the study, here or elsewhere. False: its head says nothing, or of another study.
    bool from_file(const fs::path& file) {
        const Head head = head_of(file);
        if (!head.id.empty()) {
            return from_id(file, head);
        }
        if (head.content.empty()) {
            return false;
        }
        for (auto one = true_.begin(); one != true_.end(); ++one) {
            const std::string beside = file_of(one->first);
            std::error_code ignored;
            const fs::path made = engine_.report_folder() / beside;
            if (!beside.empty() && fs::is_regular_file(made, ignored) &&
                core::content_hash_of_file(made) == head.content) {
                way_.notes.push_back("the file was made of " + beside + " of this study");
                walk(*one);
                return true;
            }
        }
        throw core::InputError("missing",
                               "the file was made from one with the content " + head.content +
                                   ", which is no file beside the report of this study",
                               {file.string(), {}, {}, {}}, "its head names the file that it was made from");
    }

    bool from_id(const fs::path& file, const Head& head) {
        for (auto one = true_.begin(); one != true_.end(); ++one) {
            if (one->first == head.result && one->second.identity().starts_with(head.id)) {
                walk(*one);
                return true;
            }
        }
        for (const auto& stored : stored_results()) {
            if (stored.kind == head.result.first && stored.identity().starts_with(head.id)) {
                const bool again = true_.contains(head.result);
                way_.notes.push_back(
                    "the file holds an earlier result: " + shown(head.result) +
                    (again ? " has been made anew since, of other inputs" : " is no longer that of the study's files"));
                walk({head.result, stored});
                way_.origins.front().state = StepState::changed;
                return true;
            }
        }
        throw core::InputError("missing",
                               "the file holds the result " + shown(head.result) + " " + head.id +
                                   ", which the store of this study does not have",
                               {file.string(), {}, {}, {}},
                               "it is of another study, or so old that the store has forgotten it");
    }

    /// A number as a report prints it: that of one result, as far as its digits go.
    bool from_number(const std::string& what) {
        core::Quantity asked;
        try {
            asked = core::parse_quantity(what);
        } catch (const core::InputError&) {
            return false;
        }
        const std::string digits = what.substr(0, what.find_first_not_of("0123456789.-+"));
        const auto point = digits.find('.');
        const double half = 0.5 * std::pow(10, point == std::string::npos ? 0
                                                                          : 1.0 + static_cast<double>(point) -
                                                                                static_cast<double>(digits.size()));
        const std::string unit = asked.unit.empty() ? "1" : asked.unit;
        std::vector<std::pair<Known::const_iterator, Fact>> found;
        for (auto one = true_.begin(); one != true_.end(); ++one) {
            const std::string kind = one->first.first;
            if (kind == "figure" || kind.ends_with("picture") || kind == "export" || kind == "model") {
                continue;
            }
            for (const auto& fact :
                 facts_of(kind, engine_.store()->value(one->second.id).value_or(""), study_.folder())) {
                if (fact.number && std::isfinite(*fact.number) && core::same_dimension(unit, fact.unit) &&
                    std::abs(core::convert(*fact.number, fact.unit, unit) - asked.value) <= half * (1 + 1e-9)) {
                    found.emplace_back(one, fact);
                    break;  // one of its numbers is enough to name the result
                }
            }
        }
        if (found.empty()) {
            return false;
        }
        if (found.size() > 1) {
            std::string list;
            for (std::size_t i = 0; i < std::min<std::size_t>(found.size(), 12); ++i) {
                list += (i == 0 ? "" : "; ") + found[i].second.name + " of " + shown(found[i].first->first) + " (" +
                        found[i].second.value + ")";
            }
            throw core::InputError("name",
                                   std::to_string(found.size()) + " numbers of the study are " + what + ": " + list +
                                       (found.size() > 12 ? "; ..." : ""),
                                   place(), "name one of them");
        }
        way_.asked = found.front().second;
        walk(*found.front().first);
        return true;
    }

    /// The result and all that it rests on. What a result of before was made of is looked for in the store as it was.
    void walk(const Known::value_type& start) {
        std::deque<Known::value_type> next = {start};
        std::set<Name> seen = {start.first};
        while (!next.empty()) {
            way_.origins.push_back(origin_of(next.front().first, next.front().second));
            const json about = next.front().second.id != 0 ? about_of(next.front().second) : json::object();
            next.pop_front();
            for (const auto& source : about.value("from", json::array())) {
                const Name name{source.at("kind"), source.at("name")};
                if (seen.insert(name).second) {
                    next.emplace_back(name, source_result(name, source.value("id", "")));
                }
            }
        }
    }

    /// With id 0 when nothing is known of it any more.
    StoredResult source_result(const Name& name, const std::string& id) {
        const auto now = true_.find(name);
        if (now != true_.end() && (id.empty() || now->second.identity().starts_with(id))) {
            return now->second;
        }
        for (const auto& stored : stored_results()) {
            if (!id.empty() && stored.kind == name.first && stored.identity().starts_with(id)) {
                return stored;
            }
        }
        if (now != true_.end()) {
            return now->second;  // made anew since, with the same numbers
        }
        StoredResult gone;
        gone.kind = name.first;
        return gone;
    }

    json about_of(const StoredResult& result) {
        return json::parse(engine_.store()->made(result.id).value_or(Store::Made{"{}", ""}).about);
    }

    Origin origin_of(const Name& name, const StoredResult& result) {
        Origin origin;
        origin.kind = name.first;
        origin.name = name.second;
        if (result.id == 0) {
            origin.state = StepState::changed;
            return origin;
        }
        const auto now = true_.find(name);
        origin.state = now != true_.end() && now->second.id == result.id ? StepState::unchanged : StepState::changed;
        origin.id = result.identity().substr(0, 16);
        origin.files = result.inputs;
        const Store::Made made = engine_.store()->made(result.id).value_or(Store::Made{"{}", ""});
        origin.made = made.when;
        const json about = json::parse(made.about);
        const json options = about.value("options", json::object());
        const json code = about.value("code", json::object());
        for (const auto& [label, value] : options.items()) {
            origin.options.emplace_back(label, value.get<std::string>());
        }
        for (const auto& [room, version] : code.items()) {
            origin.code.emplace_back(room, version.get<std::string>());
        }
        for (const auto& source : about.value("from", json::array())) {
            origin.from.emplace_back(source.at("kind").get<std::string>(), source.at("name").get<std::string>());
        }
        origin.facts = facts_of(result.kind, engine_.store()->value(result.id).value_or(""), study_.folder());
        return origin;
    }

    const std::vector<StoredResult>& stored_results() {
        if (!stored_) {
            stored_ = engine_.store() ? engine_.store()->results() : std::vector<StoredResult>();
        }
        return *stored_;
    }

    const Study& study_;
    Engine engine_;
    Known true_;  ///< all results that are those of the study as it is
    std::optional<std::vector<StoredResult>> stored_;
    Way way_;
};

}  // namespace

Way way_back(const Study& study, const RunOptions& options, const std::string& what) {
    return Walk(study, options).from(what);
}

void to_json(json& all, const Fact& fact) {
    all = {{"name", fact.name}, {"value", fact.value}};
    if (fact.number && std::isfinite(*fact.number)) {
        all["number"] = *fact.number;
        all["unit"] = fact.unit;
    }
}

void to_json(json& all, const Origin& origin) {
    const auto object = [](const std::vector<std::pair<std::string, std::string>>& pairs) {
        json result = json::object();
        for (const auto& [key, value] : pairs) {
            result[key] = value;
        }
        return result;
    };
    all = {{"kind", origin.kind},
           {"name", origin.name},
           {"id", origin.id},
           {"state", to_string(origin.state)},
           {"made", origin.made}};
    all["facts"] = origin.facts;
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
