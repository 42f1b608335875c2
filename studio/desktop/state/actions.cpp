#include "studio/desktop/state/actions.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <unordered_set>

#include "cases/accept.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"
#include "studio/desktop/state/action_parts.h"
#include "studio/desktop/state/exports.h"
#include "studio/desktop/state/known_things.h"
#include "studio/desktop/state/session_file.h"
#include "surrogates/tables/points/range_policy.h"

namespace underbody::studio {

namespace {

using action::assignment;
using action::existing_path;
using action::names_of;
using action::need;
using action::need_one_of;
using action::need_shape;
using action::need_things;
using action::unknown_key;
using action::whole_path;
using action::within;
using core::UsageError;

State open_study(State state, const Words& words, const Session&) {
    need(words, 1, 1, "open FOLDER");
    State fresh;
    fresh.workspace = state.workspace;
    fresh.files = state.files;
    fresh.study = whole_path(words[0]);
    if (std::filesystem::path(fresh.study).filename() == "study.toml") {
        fresh.study = std::filesystem::path(fresh.study).parent_path().string();
    }
    static_cast<void>(existing_path(fresh.study));
    if (!std::filesystem::exists(std::filesystem::path(fresh.study) / "study.toml")) {
        throw core::InputError("missing", "there is no study.toml in this folder", {fresh.study, {}, {}, {}},
                               "a study is a folder with a study.toml; see cases/evie");
    }
    return fresh;
}

/// What is not there any more is left out, but for the study itself.
State open_as_kept(State, const Words& words, const Session&) {
    need(words, 1, 1, "session FILE");
    auto saved = read_session(existing_path(words[0]));
    const auto gone = [&](const std::string& path) {
        return std::find(saved.missing.begin(), saved.missing.end(), path) != saved.missing.end();
    };
    if (gone(saved.state.study)) {
        throw core::InputError("missing", "the session needs " + saved.state.study + ", which is not there",
                               {words[0], {}, {}, {}}, "open the study where it is now");
    }
    std::erase_if(saved.state.files, [&](const std::string& entry) { return gone(entry.substr(entry.find(':') + 1)); });
    return saved.state;
}

State add_file(State state, const Words& words, const Session&) {
    need(words, 2, 2, "add field|shape FILE");
    if (words[0] != "field" && words[0] != "shape") {
        throw UsageError("unknown", "files are added as field or shape, not as '" + words[0] + "'", {},
                         core::did_you_mean(words[0], {"field", "shape"}));
    }
    const std::string path = existing_path(words[1]);
    if (words[0] == "shape") {
        static_cast<void>(geometry::read_shape(path));  // says what is wrong with it
    }
    const std::string entry = words[0] + ":" + path;
    if (std::find(state.files.begin(), state.files.end(), entry) == state.files.end()) {
        state.files.push_back(entry);
    }
    return state;
}

State remove_file(State state, const Words& words, const Session& session) {
    need(words, 1, words.size(), "remove FILE ...");
    for (const auto& word : words) {
        const std::string path = whole_path(word);
        need_one_of(path, names_of(state, session, "field"), "file from outside the study");
        std::erase_if(state.files, [&](const std::string& entry) { return entry.ends_with(":" + path); });
        state.readings.erase(path);
    }
    return state;
}

State locate(State state, const Words& words, const Session& session) {
    need(words, 2, 2, "locate OLD NEW");
    const std::string newer = existing_path(words[1]);
    std::vector<std::string> known = names_of(state, session, "field");
    known.push_back(state.study);
    need_one_of(words[0], known, "study or file");
    if (state.study == words[0]) {
        state.study = newer;
    }
    for (auto& entry : state.files) {
        if (entry.substr(entry.find(':') + 1) == words[0]) {
            entry = entry.substr(0, entry.find(':') + 1) + newer;
        }
    }
    if (auto reading = state.readings.extract(words[0]); !reading.empty()) {
        reading.key() = newer;
        state.readings.insert(std::move(reading));
    }
    return state;
}

State show_workspace(State state, const Words& words, const Session&) {
    need(words, 1, 1, "workspace NAME");
    const auto& names = workspace_names();
    if (std::find(names.begin(), names.end(), words[0]) == names.end()) {
        throw UsageError("unknown", "there is no workspace '" + words[0] + "'", {},
                         core::did_you_mean(words[0], names));
    }
    state.workspace = words[0];
    return state;
}

State select(State state, const Words& words, const Session& session) {
    need_things(state, session, words);
    auto outside = state.selected("field");
    const bool was_outside = !outside.empty();
    if (const auto last = state.last.find("field");
        !was_outside && state.selected("case").empty() && last != state.last.end()) {
        outside = last->second;  // a shape, a table is selected: what was compared before it
    }
    state.selection.clear();
    std::map<std::string, std::vector<std::string>> kinds;
    std::unordered_set<std::string_view> seen;  // thousands of cases are chosen at once
    for (const auto& id : words) {
        const auto at = id.find('/');
        if (seen.insert(id).second) {
            state.selection.push_back(id);
            kinds[id.substr(0, at)].push_back(id.substr(at + 1));
        }
    }
    for (auto& [kind, names] : kinds) {
        state.last[kind] = names;
    }
    if (kinds.contains("shape")) {
        state.design.shape = kinds["shape"].front();
    }
    const bool others = kinds.contains("field")
                            ? std::find_first_of(kinds["field"].begin(), kinds["field"].end(), outside.begin(),
                                                 outside.end()) == kinds["field"].end()
                            : kinds.contains("case") && was_outside;
    if (others) {
        state.fields.turned.reset();  // other files from outside may be of any size
    }
    return state;
}

State star(State state, const Words& words, const Session& session) {
    need(words, 1, 1000, "star KIND/NAME ...");
    need_things(state, session, words);
    state.stars.insert(words.begin(), words.end());
    return state;
}

State unstar(State state, const Words& words, const Session&) {
    need(words, 1, 1000, "unstar KIND/NAME ...");
    for (const auto& id : words) {
        need_one_of(id, {state.stars.begin(), state.stars.end()}, "star at");
        state.stars.erase(id);
    }
    return state;
}

State choose_shape(State state, const Words& words, const Session& session) {
    need(words, 1, 1, "shape NAME");
    static_cast<void>(shape_of(state, session, words[0]));
    state.design.shape = words[0];
    return state;
}

State set_parameters(State state, const Words& words, const Session& session) {
    need(words, 1, 100, "set PARAMETER=VALUE ...");
    const std::string name = need_shape(state, session);
    for (const auto& word : words) {
        const auto [parameter, text] = assignment(word);
        state.design.changes[name][parameter] = text;
    }
    static_cast<void>(shape_of(state, session, name));
    state.design.shape = name;
    return state;
}

State reset_parameters(State state, const Words& words, const Session& session) {
    const std::string name = need_shape(state, session);
    for (const auto& parameter : words) {
        static_cast<void>(geometry::parameter_unit(parameter, {}));
    }
    if (words.empty()) {
        state.design.changes.erase(name);
    } else if (const auto changed = state.design.changes.find(name); changed != state.design.changes.end()) {
        for (const auto& parameter : words) {
            changed->second.erase(parameter);
        }
        if (changed->second.empty()) {
            state.design.changes.erase(changed);
        }
    }
    static_cast<void>(shape_of(state, session, name));
    return state;
}

State pin_before(State state, const Words& words, const Session& session) {
    need(words, 0, 0, "pin");
    state.design.before_shape = need_shape(state, session);
    const auto changed = state.design.changes.find(state.design.before_shape);
    state.design.before = changed == state.design.changes.end() ? ShapeChanges{} : changed->second;
    return state;
}

/// The changes become a shape of their own; the one they were made on is as before.
State keep_variant(State state, const Words& words, const Session& session) {
    need(words, 1, 1, "keep NAME");
    const std::string name = need_shape(state, session);
    const auto known = shape_names(state, session);
    if (words[0].empty() || words[0].find('/') != std::string::npos) {
        throw UsageError("range", "'" + words[0] + "' is no name of a shape", {}, "a name without '/'");
    }
    if (std::find(known.begin(), known.end(), words[0]) != known.end()) {
        throw UsageError("exists", "there is a shape '" + words[0] + "' already", {}, "take another name");
    }
    static_cast<void>(shape_of(state, session, name));
    const auto changed = state.design.changes.find(name);
    state.design.variants[words[0]] = {name, changed == state.design.changes.end() ? ShapeChanges{} : changed->second};
    state.design.changes.erase(name);
    state.design.shape = words[0];
    return state;
}

State forget_variant(State state, const Words& words, const Session&) {
    need(words, 1, 1, "forget NAME");
    std::vector<std::string> names;
    for (const auto& [name, variant] : state.design.variants) {
        names.push_back(name);
        if (variant.of == words[0]) {
            throw UsageError("used", "the variant '" + name + "' is made of '" + words[0] + "'", {},
                             "forget that one first");
        }
    }
    if (state.design.variants.erase(words[0]) == 0) {
        throw UsageError("missing", "there is no variant '" + words[0] + "'", {}, core::did_you_mean(words[0], names));
    }
    state.design.changes.erase(words[0]);
    if (state.design.shape == words[0]) {
        state.design.shape.clear();
    }
    return state;
}

State operate(State state, const Words& words, const Session&) {
    need(words, 1, 3, "operation gap=5mm pitch=2deg speed=0.5m/s");
    for (const auto& word : words) {
        const auto [key, text] = assignment(word);
        if (key == "gap") {
            state.design.gap = within(core::parse_in(text, "m"), 1e-6, 100, "gap (m)");
        } else if (key == "pitch") {
            state.design.pitch = within(core::parse_in(text, "rad"), -1, 1, "pitch (rad)");
        } else if (key == "speed") {
            state.design.speed = within(core::parse_in(text, "m/s"), 0, 1000, "speed (m/s)");
        } else {
            unknown_key(key, {"gap", "pitch", "speed"});
        }
    }
    return state;
}

State accept(State state, const Words& words, const Session& session) {
    need(words, 1, 1, "accept MEASUREMENT");
    static_cast<void>(cases::with_accepted(session.study, session.results, words[0]));  // says why it cannot be
    state.accepted.insert(words[0]);
    return state;
}

State unaccept(State state, const Words& words, const Session&) {
    need(words, 1, 1, "unaccept MEASUREMENT");
    if (state.accepted.erase(words[0]) == 0) {
        throw UsageError("missing", "no model of '" + words[0] + "' is accepted", {},
                         core::did_you_mean(words[0], {state.accepted.begin(), state.accepted.end()}));
    }
    return state;
}

/// Formats, frames, numbers and ranges beyond the table that an export knows.
void check_export(const State& state, const Session& session, const ExportRecord& record) {
    need_one_of(record.table, names_of(state, session, "table"), "table");
    std::vector<std::string> formats;
    for (const auto& format : tables::export_formats()) {
        formats.push_back(format.name);
    }
    need_one_of(record.format, formats, "format");
    need_one_of(record.frame, {"up", "ned"}, "frame");
    need_one_of(record.number, {"double", "float"}, "kind of number");
    for (const auto& [axis, policy] : record.range) {
        need_one_of(axis, session.study.find_table(record.table)->axes, "axis");
        if (!tables::range_policy(policy)) {
            throw UsageError("unknown", "there is no policy beyond the range '" + policy + "'", {},
                             core::did_you_mean(policy, {"clamp", "refuse", "extrapolate"}));
        }
    }
}

/// One file: FILE TABLE KEY=VALUE ...
void remember_export(State& state, const Words& words, const Session& session) {
    need(words, 2, 100, "exported FILE TABLE KEY=VALUE ... [and FILE TABLE KEY=VALUE ...]");
    ExportRecord record;
    record.table = words[1];
    const std::map<std::string, std::string*> texts = {{"made_of", &record.made_of}, {"written", &record.written},
                                                       {"format", &record.format},   {"name", &record.name},
                                                       {"frame", &record.frame},     {"number", &record.number}};
    for (std::size_t i = 2; i < words.size(); ++i) {
        const auto [key, text] = assignment(words[i]);
        if (const auto known = texts.find(key); known != texts.end()) {
            *known->second = text;
        } else if (key == "max_error") {
            record.max_error = within(core::parse_in(text, "1"), 0, 1, "error allowed");
        } else if (key.starts_with("range.")) {
            record.range[key.substr(6)] = text;
        } else {
            unknown_key(key, {"made_of", "written", "format", "name", "frame", "number", "max_error", "range.AXIS"});
        }
    }
    check_export(state, session, record);
    state.exports[whole_path(words[0])] = record;
}

State exported(State state, const Words& words, const Session& session) {
    for (const auto& one : split_exports(words)) {
        remember_export(state, one, session);
    }
    return state;
}

}  // namespace

const std::vector<ActionKind>& action_kinds() {
    static const std::vector<ActionKind> kinds = {
        {"open", "FOLDER", "opens a study", "open cases/evie", false, open_study},
        {"session", "FILE", "opens a study as it was left", "session evie/.underbody/session.ubs", false, open_as_kept},
        {"add", "field|shape FILE", "shows a file from outside the study", "add shape hull.toml", false, add_file},
        {"remove", "FILE ...", "no longer shows such files", "remove hull.toml", false, remove_file},
        {"locate", "OLD NEW", "says where a study or file has moved to", "locate /old/evie /new/evie", false, locate},
        {"workspace", "NAME", "shows a workspace", "workspace tables", true, show_workspace, true},
        {"select", "KIND/NAME ...", "selects cases, shapes, tables, ...", "select case/ellipse-h5-p0", true, select,
         true},
        {"star", "KIND/NAME ...", "marks with a star", "star case/ellipse-h5-p0", false, star},
        {"unstar", "KIND/NAME ...", "takes the star away", "unstar case/ellipse-h5-p0", false, unstar},
        {"shape", "NAME", "shows a shape in Design", "shape ellipse", true, choose_shape},
        {"set", "PARAMETER=VALUE ...", "changes parameters of the shape", "set 'protrusion.height=2 mm'", false,
         set_parameters},
        {"reset", "[PARAMETER ...]", "takes parameters back to the file's", "reset protrusion.height", false,
         reset_parameters},
        {"pin", "", "compares results with those of now", "pin", false, pin_before},
        {"keep", "NAME", "keeps the changed shape as a variant", "keep ellipse-2", false, keep_variant},
        {"forget", "NAME", "drops a kept variant", "forget ellipse-2", false, forget_variant},
        {"operation", "gap=... pitch=... speed=...", "sets where the body operates", "operation gap=5mm", false,
         operate},
        {"read", "FILE ... KEY=VALUE ...", "says of files from outside what they do not say",
         "read body.csv length_unit=mm unit.Pressure=Pa symmetry=y density=998kg/m^3", false, action::read_as},
        {"fields", "KEY=VALUE ...", "sets how fields are looked at", "fields array=pressure camera=bottom", true,
         action::look_at_fields},
        {"turn", "design|compare [FROM/AT/UP/HEIGHT]", "turns a 3D view as a hand did; no place: as it was before",
         "turn design 0.3,0.2,-0.1/0,0,0/0,0,1/0.05", true, action::turn, true},
        {"outline", "on|off", "draws the body before as a line around the one of now", "outline off", true,
         action::outline},
        {"table", "NAME KEY=VALUE ...", "sets numbers and view of a force table", "table lift net_weight=0.28N", false,
         action::look_at_table},
        {"region", "NAME KEY=VALUE ...", "changes numbers and view of a stability map", "region glide cells=100", false,
         action::look_at_region},
        {"measure", "NAME model=FILE data=FILE ... channel=... clock=...", "takes measurements into the study",
         "measure tank model=model.toml data=runs channel=gap=rng_cm:cm clock=t_ms:ms", false, action::measure},
        {"accept", "MEASUREMENT", "the model that was found counts as the declared one", "accept 'heave test'", false,
         accept},
        {"unaccept", "MEASUREMENT", "the declared model counts again", "unaccept 'heave test'", false, unaccept},
        {"exported", "FILE TABLE KEY=VALUE ... [and ...]", "remembers files that were exported, and how",
         "exported lift.h lift format=c", false, exported},
        {"axes", "X Y", "chooses what the scatter plot shows", "axes gap lift_force", true, action::explore_axes},
        {"brush", "COLUMN=LOW:HIGH|VALUE ...", "keeps cases within ranges, or at a value; no range: all",
         "brush gap=2mm:5mm", true, action::brush},
        {"order", "[COLUMN ...]", "puts axes of the lines in this order, from the left; none: as the table has them",
         "order lift_force gap", true, action::order},
        {"vary", "PARAMETER=FROM:TO:COUNT ...", "makes the shapes between; no parameter: none",
         "vary protrusion.height=1mm:3mm:5", false, action::vary},
        {"rows", "cases|shapes", "explores the cases of the study or the shapes that vary", "rows cases", true,
         action::rows},
        {"show", "points|pictures [VIEW]|lift|map",
         "brings a view to the front: of Explore the points or the pictures, of Design the lift or the stability map",
         "show pictures", true, action::show, true},
        {"cells", "WORKSPACE [VIEW ...]", "shows these views of a workspace; no view: all of them",
         "cells design body section", true, action::choose_cells},
    };
    return kinds;
}

const ActionKind& kind_of(const Words& words) {
    const std::string verb = words.empty() ? "" : words.front();
    std::vector<std::string> verbs;
    for (const auto& kind : action_kinds()) {
        if (kind.verb == verb) {
            return kind;
        }
        verbs.push_back(kind.verb);
    }
    throw UsageError("unknown", "there is no action '" + verb + "'", {}, core::did_you_mean(verb, verbs));
}

State applied(const State& state, const Words& words, const Session& session) {
    const ActionKind& kind = kind_of(words);
    return kind.apply(state, Words(words.begin() + 1, words.end()), session);
}

}  // namespace underbody::studio
