#include "cases/why.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "cases/engine.h"
#include "cases/export_files.h"
#include "cases/why_names.h"
#include "core/counted.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::cases {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

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
        const fs::path beside = engine_.report_folder();
        for (const fs::path& file : {fs::path(what), beside / bare(what), beside / "exports" / bare(what)}) {
            std::error_code ignored;
            if (fs::is_regular_file(file, ignored) && (from_file(file) || from_model_folder(file))) {
                return std::move(way_);
            }
        }
        const std::string asked = bare(what);
        if (!asked.empty() && !find_true(asked) && from_number(asked)) {
            return std::move(way_);
        }
        std::string quantity;
        std::string name = asked;
        if (const auto of = name.find(" of "); of != std::string::npos && !find_true(name)) {
            // "gap of A of region/glide": what stands behind the last "of" that is a result
            std::size_t cut = of;
            for (auto next = of; next != std::string::npos; next = name.find(" of ", next + 1)) {
                cut = find_true(name.substr(next + 4)) ? next : cut;
            }
            quantity = name.substr(0, cut);
            name.erase(0, cut + 4);
        } else if (!find_true(name) && from_fact(name)) {
            return std::move(way_);
        }
        const auto& called = *result_called(name);
        const json about = called.first.first == "export" && shown(called.first) != name
                               ? about_of(called.second).value("from", json::array())
                               : json::array();
        const auto source = about.empty() ? true_.end() : true_.find({about[0].at("kind"), about[0].at("name")});
        walk(source == true_.end() ? called : *source);  // a file says what its table says
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
        if (!head.id.empty() && !head.again) {
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
        if (head.again && !head.id.empty()) {
            return from_id(file, head);
        }
        throw core::InputError("missing",
                               "the file was made from one with the content " + head.content +
                                   ", which is no file beside the report of this study",
                               {file.string(), {}, {}, {}}, "its head names the file that it was made from");
    }

    bool from_id(const fs::path& file, const Head& head) {
        for (auto one = true_.begin(); one != true_.end(); ++one) {
            if (one->first == head.result && one->second.identity().starts_with(head.id)) {
                compare_with_exports(file, head);
                walk(*one);
                return true;
            }
        }
        for (const auto& stored : stored_results()) {
            if (stored.kind == head.result.first && stored.identity().starts_with(head.id)) {
                compare_with_exports(file, head);
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

    /// A head says of what a file was made, not that nobody changed the rest.
    void compare_with_exports(const fs::path& file, const Head& head) {
        if (head.again) {
            way_.notes.push_back("the file was exported anew from one that held " + shown(head.result));
            return;
        }
        const std::string bytes = core::read_file(file);
        bool any = false;
        for (const auto& stored : stored_results()) {
            if (stored.kind != "export") {
                continue;
            }
            for (const auto& source : about_of(stored).value("from", json::array())) {
                if (Name{source.at("kind"), source.at("name")} == head.result && source.value("id", "") == head.id) {
                    const std::string value = engine_.store()->value(stored.id).value_or("[]\n");
                    const auto files = exported_files(value);
                    if (std::any_of(files.begin(), files.end(), [&](const auto& one) { return one.second == bytes; })) {
                        return;
                    }
                    any = true;
                }
            }
        }
        way_.notes.push_back(
            any ? "this file differs from what was exported for the study: it was written by hand (with another "
                  "name or error, say) or changed since; what follows is of " +
                      shown(head.result) + ", which its head names"
                : "the store has no export of " + shown(head.result) + " " + head.id +
                      " any more: whether the file was changed since is not known");
    }

    using Hit = std::pair<Known::const_iterator, Fact>;

    /// The first fact of each result that is asked for. Pictures and files say nothing themselves.
    std::vector<Hit> hits(const std::function<bool(const Fact&)>& asked) {
        std::vector<Hit> found;
        for (auto one = true_.begin(); one != true_.end(); ++one) {
            const std::string& kind = one->first.first;
            if (kind == "figure" || kind.ends_with("picture") || kind == "export" || kind == "model") {
                continue;
            }
            const auto facts = facts_of(kind, engine_.store()->value(one->second.id).value_or(""), study_.folder());
            if (const auto fact = std::find_if(facts.begin(), facts.end(), asked); fact != facts.end()) {
                found.emplace_back(one, *fact);
            }
        }
        return found;
    }

    static std::string listed(const std::vector<Hit>& found) {
        constexpr std::size_t most = 12;
        std::string list;
        for (std::size_t i = 0; i < std::min(found.size(), most); ++i) {
            const Fact& fact = found[i].second;
            list += (i == 0 ? "\"" : "; \"") + fact.name + " of " + shown(found[i].first->first) + "\"" +
                    (fact.number ? " (" + fact.value + ")" : "");
        }
        return list + (found.size() > most ? "; ..." : "");
    }

    /// All that a result was made of, by name.
    std::set<Name> made_of(const Known::value_type& result) {
        std::set<Name> all;
        std::deque<Known::value_type> next = {result};
        while (!next.empty()) {
            const json about = next.front().second.id != 0 ? about_of(next.front().second) : json::object();
            next.pop_front();
            for (const auto& source : about.value("from", json::array())) {
                const Name name{source.at("kind"), source.at("name")};
                if (const auto now = true_.find(name); all.insert(name).second && now != true_.end()) {
                    next.push_back(*now);
                }
            }
        }
        return all;
    }

    /// One number may stand in several results, when those rest on the one where it was found first.
    const Hit* first_of_one_number(const std::vector<Hit>& found) {
        for (const Hit& first : found) {
            const bool one = std::all_of(found.begin(), found.end(), [&](const Hit& other) {
                const double size = std::abs(first.second.number.value_or(NAN));
                return &other == &first ||
                       (std::abs(other.second.number.value_or(NAN) - first.second.number.value_or(NAN)) <=
                            1e-7 * size &&
                        other.second.unit == first.second.unit && made_of(*other.first).contains(first.first->first));
            });
            if (one) {
                return &first;
            }
        }
        return nullptr;
    }

    void answer(const Hit& hit, const std::vector<Hit>& found) {
        for (const Hit& other : found) {
            if (&other != &hit) {
                way_.notes.push_back("the same number is the " + other.second.name + " of " +
                                     shown(other.first->first) + ", which rests on it");
            }
        }
        way_.asked = hit.second;
        walk(*hit.first);
    }

    /// A number as a report prints it, as far as its digits go, in its unit; without one, as the numbers are told
    /// (mm, deg, N ...). Where no number is such, a sentence that says it. False: it is no number.
    bool from_number(const std::string& what) {
        static const std::regex form("([-+]?[0-9]+\\.?([0-9]*)([eE][-+]?[0-9]+)?)( *[^0-9.].*)?");
        std::smatch parts;
        if (!std::regex_match(what, parts, form)) {
            return false;
        }
        core::Quantity asked;
        try {
            asked = core::parse_quantity(what);
        } catch (const core::InputError&) {
            return false;
        }
        const int power = parts[3].matched ? std::stoi(parts[3].str().substr(1)) : 0;
        const double half = 0.5 * std::pow(10, power - static_cast<int>(parts[2].length()));
        const auto near = [&](double value) { return std::abs(value - asked.value) <= half * (1 + 1e-9); };
        auto found = hits([&](const Fact& fact) {
            if (!fact.number || !std::isfinite(*fact.number)) {
                return false;
            }
            if (asked.unit.empty()) {
                return near(core::parse_number(fact.value.substr(0, fact.value.find(' '))).value_or(NAN));
            }
            return core::same_dimension(asked.unit, fact.unit) &&
                   near(core::convert(*fact.number, fact.unit, asked.unit));
        });
        if (found.empty()) {
            const std::string digits = parts[1];
            found = hits([&](const Fact& fact) { return !fact.number && says(fact.value, digits); });
            if (found.size() == 1) {
                answer(found.front(), {});
                return true;
            }
        }
        if (found.empty()) {
            throw core::InputError("missing", "the study has no result with the number " + what + " that is still true",
                                   place(),
                                   "a number is asked for as it is printed, with its unit (\"3.5 mm\"), or by its name "
                                   "(\"stable gap of table/lift\"); study list names the cases");
        }
        const Hit* first = found.front().second.number ? first_of_one_number(found) : nullptr;
        if (first == nullptr) {
            throw core::InputError(
                "name", std::to_string(found.size()) + " numbers of the study are " + what + ": " + listed(found),
                place(), "ask for one of them by its name");
        }
        answer(*first, found);
        return true;
    }

    /// `digits` stand in `text` as a number of their own.
    static bool says(const std::string& text, const std::string& digits) {
        const auto part_of_number = [](char c) {
            return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-';
        };
        for (auto at = text.find(digits); at != std::string::npos; at = text.find(digits, at + 1)) {
            const std::size_t end = at + digits.size();
            const bool ends = end >= text.size() || std::isdigit(static_cast<unsigned char>(text[end])) == 0;
            if ((at == 0 || !part_of_number(text[at - 1])) && ends) {
                return true;
            }
        }
        return false;
    }

    /// A number by its name alone. False: no result has one of that name.
    bool from_fact(const std::string& name) {
        const auto found = hits([&](const Fact& fact) { return fact.number && fact.name == name; });
        if (found.empty()) {
            return false;
        }
        if (found.size() > 1) {
            throw core::InputError(
                "name",
                core::counted(found.size(), "result says", "results say") + " a '" + name + "': " + listed(found),
                place(), "ask for one of them by its whole name");
        }
        answer(found.front(), {});
        return true;
    }

    /// A table or another file beside an exported model.
    bool from_model_folder(const fs::path& file) {
        auto part = std::find(file.begin(), file.end(), fs::path("models"));
        if (part == file.end() || ++part == file.end()) {
            if (file.extension() == ".html") {
                throw core::InputError("name", "'" + file.string() + "' is a report of many numbers", place(),
                                       "ask for one of them as it is printed there, such as \"3.5 mm\"");
            }
            return false;
        }
        const auto model = true_.find({"model", part->string()});
        if (model == true_.end()) {
            return false;
        }
        walk(*model);
        return true;
    }

    /// The result and all that it rests on. What a result of before was made of is looked for in the store as it was.
    void walk(const Known::value_type& start) {
        std::deque<Known::value_type> next = {start};
        std::set<Name> seen = {start.first};
        while (!next.empty()) {
            way_.origins.push_back(origin_of(next.front().first, next.front().second));
            const json about = next.front().second.id != 0 ? about_of(next.front().second) : json::object();
            // What is true now has been held against what it rests on now: that may have been made anew, of equal
            // numbers.
            const bool is_true = way_.origins.back().state == StepState::unchanged;
            next.pop_front();
            for (const auto& source : about.value("from", json::array())) {
                const Name name{source.at("kind"), source.at("name")};
                if (seen.insert(name).second) {
                    const auto now = is_true ? true_.find(name) : true_.end();
                    next.emplace_back(name,
                                      now != true_.end() ? now->second : source_result(name, source.value("id", "")));
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
        origin.files = result.inputs.all();
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

}  // namespace underbody::cases
