#include "studio/desktop/state/known_things.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <unordered_set>

#include "core/missing_file.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"
#include "studio/desktop/state/known_models.h"

namespace underbody::studio::action {

namespace fs = std::filesystem;
using core::UsageError;

namespace {

template <class Things>
std::vector<std::string> names_in(const Things& things) {
    std::vector<std::string> names;
    for (const auto& thing : things) {
        names.push_back(thing.name);
    }
    return names;
}

std::string kind_of_thing(const std::string& id) {
    const auto at = id.find('/');
    if (at == std::string::npos || at == 0 || at + 1 == id.size()) {
        throw UsageError("words", "'" + id + "' is not KIND/NAME", {}, "such as case/ellipse-h5-p0");
    }
    const std::string kind = id.substr(0, at);
    need_one_of(kind, kinds_of_things(), "kind of thing");
    return kind;
}

}  // namespace

const std::vector<std::string>& kinds_of_things() {
    static const std::vector<std::string> kinds = {"shape",       "case",    "table", "region",
                                                   "measurement", "picture", "field", "export"};
    return kinds;
}

std::vector<std::string> names_of(const State& state, const Session& session, const std::string& kind) {
    std::vector<std::string> names;
    if (kind == "shape") {
        return shape_names(state, session);
    }
    if (kind == "picture") {
        for (const auto& [key, png] : session.results.pictures) {
            names.push_back(key);
        }
    } else if (kind == "field") {
        for (const auto& entry : state.files) {
            names.push_back(entry.substr(entry.find(':') + 1));
        }
    } else if (kind == "measurement") {
        names = names_in(session.study.measurements);
        for (const auto& [name, record] : state.measured) {
            if (std::find(names.begin(), names.end(), name) == names.end()) {
                names.push_back(name);  // it is on its way to the disk
            }
        }
    } else if (kind == "export") {
        for (const auto& [file, record] : state.exports) {
            names.push_back(file);
        }
    }
    const auto& study = session.study;
    return kind == "case"     ? names_in(study.cases)
           : kind == "table"  ? names_in(study.tables)
           : kind == "region" ? names_in(study.regions)
                              : names;
}

void need_things(const State& state, const Session& session, const std::vector<std::string>& ids) {
    std::map<std::string, std::unordered_set<std::string>> known;
    for (const auto& id : ids) {
        const std::string kind = kind_of_thing(id);
        const auto [at, fresh] = known.try_emplace(kind);
        if (fresh) {
            for (auto& name : names_of(state, session, kind)) {
                at->second.insert(std::move(name));
            }
        }
        if (const std::string name = id.substr(kind.size() + 1); !at->second.contains(name)) {
            need_one_of(name, names_of(state, session, kind), kind);
        }
    }
}

void need_one_of(const std::string& name, const std::vector<std::string>& known, const std::string& what) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
        throw UsageError("missing",
                         "there is no " + what + " '" + name + "'" + (known.empty() ? ", nor any other" : ""), {},
                         core::did_you_mean(name, known));
    }
}

std::string whole_path(const fs::path& path) {
    const fs::path whole = fs::absolute(path).lexically_normal();
    return whole.has_filename() || !whole.has_relative_path() ? whole.string() : whole.parent_path().string();
}

std::string existing_path(const fs::path& path) {
    const fs::path whole = whole_path(path);
    if (!fs::exists(whole)) {
        throw core::InputError("missing", "there is no file or folder of this name", {whole.string(), {}, {}, {}},
                               core::hint_for_missing(whole));
    }
    return whole.string();
}

void need_column(const Session& session, const std::string& name) {
    std::vector<std::string> known;
    const auto& loads = session.results.loads;
    for (const auto& column : loads.columns()) {
        if (!column.is_text()) {
            known.push_back(column.name);
        }
    }
    if (loads.rows() == 0) {  // they are not computed yet
        for (const auto& quantity : core::quantity_names()) {
            known.push_back(quantity.name);
        }
        for (const auto& entry : session.study.cases) {
            for (const auto& [condition, value] : entry.conditions.numbers) {
                known.push_back(condition);
            }
        }
    }
    for (const auto& column : geometry::variant_columns()) {
        known.push_back(column.name);
    }
    for (const auto& parameter : geometry::parameter_names()) {
        known.push_back(parameter.name);
    }
    need_one_of(name, known, "column");
}

void need_table_view(const std::vector<std::string>& axes, const std::string& text) {
    if (text.empty()) {
        return;
    }
    std::vector<std::string> words;
    for (const auto word : core::split(text, ' ')) {
        words.emplace_back(word);
    }
    need_one_of(words.front(), {"curve", "family", "map"}, "view of a table");
    if (words.size() != (words.front() == "curve" ? 2U : 3U) || (words.size() == 3 && words[1] == words[2])) {
        throw UsageError("words", "'" + text + "' is no view of a table", {},
                         "curve AXIS, family AXIS AXIS or map AXIS AXIS");
    }
    for (std::size_t i = 1; i < words.size(); ++i) {
        need_one_of(words[i], axes, "axis");
    }
}

namespace {

/// The number of a force that the study's tables add behind the model's own ones: "force.2.factor".
bool is_of_added_force(const std::string& name, std::size_t own, std::size_t added) {
    std::size_t number = 0;
    const std::string prefix = "force.";
    if (!name.starts_with(prefix)) {
        return false;
    }
    const char* end = name.data() + name.size();
    const auto read = std::from_chars(name.data() + prefix.size(), end, number);
    const std::string rest(read.ptr, end);
    return read.ec == std::errc() && number > own && number <= own + added &&
           (rest == ".factor" || rest == ".scale.speed.exponent" || rest == ".scale.speed.reference" ||
            rest == ".scale.speed.dead_band");
}

}  // namespace

void need_parameter(const Session& session, const std::string& region, const std::string& name, double value) {
    for (const auto& spec : session.study.regions) {
        if (spec.name == region) {
            const auto model = known_model(spec.model);
            if (!is_of_added_force(name, model->forces.size(), spec.forces.size())) {
                static_cast<void>(model->with_parameter(name, value));
            }
        }
    }
}

}  // namespace underbody::studio::action
