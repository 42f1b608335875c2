#include "studio/desktop/state/actions.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cases/accept.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"

namespace underbody::studio {

namespace {

using core::UsageError;

void need(const Words& arguments, std::size_t least, std::size_t most, const char* form) {
    if (arguments.size() < least || arguments.size() > most) {
        throw UsageError("words", "this action takes other words", {}, std::string("write it as: ") + form);
    }
}

/// "KEY=VALUE" in two; the value may hold '='.
std::pair<std::string, std::string> assignment(const std::string& word) {
    const auto at = word.find('=');
    if (at == std::string::npos || at == 0) {
        throw UsageError("words", "'" + word + "' is not KEY=VALUE");
    }
    return {word.substr(0, at), word.substr(at + 1)};
}

[[noreturn]] void unknown_key(const std::string& key, const std::vector<std::string>& known) {
    throw UsageError("unknown", "there is no key '" + key + "' here", {}, core::did_you_mean(key, known));
}

bool yes_or_no(const std::string& text) {
    if (text != "on" && text != "off") {
        throw UsageError("range", "'" + text + "' is neither on nor off");
    }
    return text == "on";
}

/// Empty: none.
std::optional<double> number_or_none(const std::string& text, const char* unit) {
    return text.empty() ? std::optional<double>() : core::parse_in(text, unit);
}

double within(double value, double lower, double upper, const std::string& what) {
    if (!(value >= lower && value <= upper)) {
        throw UsageError("range", what + " " + core::format_number(value, 6) + " is out of range", {},
                         "between " + core::format_number(lower) + " and " + core::format_number(upper));
    }
    return value;
}

std::array<double, 2> range_of(const std::string& text, const char* unit) {
    const auto at = text.find(':', 1);
    if (at == std::string::npos) {
        throw UsageError("parse", "'" + text + "' is not LOW:HIGH");
    }
    const std::array<double, 2> range = {core::parse_in(text.substr(0, at), unit),
                                         core::parse_in(text.substr(at + 1), unit)};
    if (!(range[0] < range[1])) {
        throw UsageError("range", "the range " + text + " is empty", {}, "the first number is the smaller one");
    }
    return range;
}

State open_study(State state, const Words& words, const Session& session) {
    need(words, 1, 1, "open FOLDER");
    State fresh;
    fresh.workspace = state.workspace;
    fresh.files = state.files;
    fresh.study = std::filesystem::absolute(words[0]).lexically_normal().string();
    if (fresh.study.size() > 1 && fresh.study.ends_with('/')) {
        fresh.study.pop_back();
    }
    static_cast<void>(session);
    return fresh;
}

State add_file(State state, const Words& words, const Session&) {
    need(words, 2, 2, "add field|shape FILE");
    if (words[0] != "field" && words[0] != "shape") {
        throw UsageError("unknown", "files are added as field or shape, not as '" + words[0] + "'");
    }
    const std::string path = std::filesystem::absolute(words[1]).lexically_normal().string();
    const std::string entry = words[0] + ":" + path;
    if (std::find(state.files.begin(), state.files.end(), entry) == state.files.end()) {
        state.files.push_back(entry);
    }
    return state;
}

State remove_file(State state, const Words& words, const Session&) {
    need(words, 1, 1, "remove FILE");
    const std::string path = std::filesystem::absolute(words[0]).lexically_normal().string();
    std::erase_if(state.files, [&](const std::string& entry) { return entry.ends_with(":" + path); });
    return state;
}

State locate(State state, const Words& words, const Session&) {
    need(words, 2, 2, "locate OLD NEW");
    const std::string newer = std::filesystem::absolute(words[1]).lexically_normal().string();
    if (state.study == words[0]) {
        state.study = newer;
    }
    for (auto& entry : state.files) {
        if (entry.substr(entry.find(':') + 1) == words[0]) {
            entry = entry.substr(0, entry.find(':') + 1) + newer;
        }
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

State select(State state, const Words& words, const Session&) {
    state.selection.clear();
    std::map<std::string, std::vector<std::string>> kinds;
    for (const auto& id : words) {
        const auto at = id.find('/');
        if (at == std::string::npos || at == 0 || at + 1 == id.size()) {
            throw UsageError("words", "'" + id + "' is not KIND/NAME", {}, "such as case/ellipse-h5-p0");
        }
        if (std::find(state.selection.begin(), state.selection.end(), id) == state.selection.end()) {
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
    return state;
}

State star(State state, const Words& words, const Session&) {
    need(words, 1, 1000, "star KIND/NAME ...");
    state.stars.insert(words.begin(), words.end());
    return state;
}

State unstar(State state, const Words& words, const Session&) {
    need(words, 1, 1000, "unstar KIND/NAME ...");
    for (const auto& id : words) {
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

std::string need_shape(const State& state, const Session& session) {
    const std::string name = shown_shape(state, session);
    if (name.empty()) {
        throw UsageError("missing", "there is no shape to change", {}, "open a study with a [[body]], or a SHAPE.toml");
    }
    return name;
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

State look_at_fields(State state, const Words& words, const Session&) {
    need(words, 1, 1000, "fields KEY=VALUE ...");
    FieldView& view = state.fields;
    for (const auto& word : words) {
        const auto [key, text] = assignment(word);
        if (key == "array") {
            view.array = text;
        } else if (key == "whole_range") {
            view.whole_range = yes_or_no(text);
        } else if (key == "edges") {
            view.edges = yes_or_no(text);
        } else if (key == "mirror") {
            view.mirror = yes_or_no(text);
        } else if (key == "difference") {
            view.difference = yes_or_no(text);
        } else if (key == "range") {
            view.range = text.empty() ? std::optional<std::array<double, 2>>() : range_of(text, "1");
        } else if (key == "camera") {
            const std::vector<std::string> known = {"iso", "bottom", "top", "side", "front"};
            if (std::find(known.begin(), known.end(), text) == known.end()) {
                unknown_key(text, known);
            }
            view.camera = text;
        } else if (key.starts_with("zone.")) {
            view.zones[key.substr(5)] = yes_or_no(text);
        } else {
            unknown_key(key, {"array", "whole_range", "edges", "mirror", "difference", "range", "camera", "zone.NAME"});
        }
    }
    return state;
}

State look_at_table(State state, const Words& words, const Session& session) {
    need(words, 2, 100, "table NAME KEY=VALUE ...");
    std::vector<std::string> names;
    for (const auto& table : session.study.tables) {
        names.push_back(table.name);
    }
    if (std::find(names.begin(), names.end(), words[0]) == names.end()) {
        throw UsageError("missing", "there is no table '" + words[0] + "'", {}, core::did_you_mean(words[0], names));
    }
    TableView& view = state.tables[words[0]];
    for (std::size_t i = 1; i < words.size(); ++i) {
        const auto [key, text] = assignment(words[i]);
        if (key == "net_weight") {
            view.net_weight = number_or_none(text, "N");
        } else if (key == "virtual_mass") {
            view.virtual_mass = number_or_none(text, "kg");
            within(view.virtual_mass.value_or(0), 0, 1e9, "virtual mass (kg)");
        } else if (key == "shown") {
            view.shown = text;
        } else if (key == "logarithmic") {
            view.logarithmic = text.empty() ? std::optional<bool>() : yes_or_no(text);
        } else if (key.starts_with("held.")) {
            const auto* quantity = core::find_quantity(key.substr(5));
            view.held[key.substr(5)] = core::parse_in(text, quantity != nullptr ? quantity->unit : "1");
        } else {
            unknown_key(key, {"net_weight", "virtual_mass", "shown", "logarithmic", "held.AXIS"});
        }
    }
    return state;
}

State look_at_region(State state, const Words& words, const Session& session) {
    need(words, 2, 100, "region NAME KEY=VALUE ...");
    std::vector<std::string> names;
    for (const auto& region : session.study.regions) {
        names.push_back(region.name);
    }
    if (std::find(names.begin(), names.end(), words[0]) == names.end()) {
        throw UsageError("missing", "there is no region '" + words[0] + "'", {}, core::did_you_mean(words[0], names));
    }
    RegionView& view = state.regions[words[0]];
    for (std::size_t i = 1; i < words.size(); ++i) {
        const auto [key, text] = assignment(words[i]);
        if (key == "cells") {
            view.cells = static_cast<int>(within(core::parse_in(text, "1"), 20, 1000, "starts a side"));
        } else if (key == "show") {
            const std::vector<std::string> known = {"ends", "probability", "sweep"};
            if (std::find(known.begin(), known.end(), text) == known.end()) {
                unknown_key(text, known);
            }
            view.show = text;
        } else if (key == "axes") {
            if (!text.empty() && core::parse_ranges(text).size() != 2) {
                throw UsageError("range", "a map has two axes, not those of '" + text + "'", {},
                                 "such as gap=1mm:20mm,pitch=-3deg:3deg");
            }
            view.axes = text;
            view.start.reset();
        } else if (key == "sweep") {
            if (!text.empty() && core::parse_ranges(text).size() != 1) {
                throw UsageError("range", "one condition is swept, not '" + text + "'", {}, "such as speed=0.3:0.7");
            }
            view.sweep = text;
        } else if (key == "steps") {
            view.steps = static_cast<int>(within(core::parse_in(text, "1"), 2, 50, "maps of the sweep"));
        } else if (key == "draws") {
            view.draws = static_cast<int>(within(core::parse_in(text, "1"), 2, 1000, "draws"));
        } else if (key == "logarithmic") {
            view.logarithmic = text.empty() ? std::optional<bool>() : yes_or_no(text);
        } else if (key == "duration") {
            view.duration = number_or_none(text, "s");
            within(view.duration.value_or(1), 1e-3, 1e6, "duration (s)");
        } else if (key == "start") {
            if (text.empty()) {
                view.start.reset();
                continue;
            }
            const auto parts = core::split(text, ',');
            if (parts.size() != 2) {
                throw UsageError("parse", "a start is GAP,VELOCITY", {}, "such as start=5mm,10mm/s");
            }
            view.start = {core::parse_in(parts[0], "m"), core::parse_in(parts[1], "m/s")};
        } else if (key == "as_declared" && text.empty()) {
            view.set.clear();
        } else if (key.starts_with("set.")) {
            if (text.empty()) {
                view.set.erase(key.substr(4));
            } else {
                view.set[key.substr(4)] = core::parse_in(text, "1");
            }
        } else {
            unknown_key(key, {"cells", "duration", "start", "show", "axes", "sweep", "steps", "draws", "logarithmic",
                              "as_declared", "set.PARAMETER"});
        }
    }
    return state;
}

State explore_axes(State state, const Words& words, const Session&) {
    need(words, 2, 2, "axes X Y");
    state.explore.x = words[0];
    state.explore.y = words[1];
    return state;
}

/// SI unit of what is explored: a known quantity, a column of the loads, a parameter or number of a shape.
std::string unit_of_column(const std::string& name, const Session& session) {
    if (const auto* quantity = core::find_quantity(name)) {
        return quantity->unit;
    }
    if (const auto* column = session.results.loads.find(name); column != nullptr && !column->is_text()) {
        return column->unit;
    }
    for (const auto& column : geometry::variant_columns()) {
        if (column.name == name) {
            return column.unit;
        }
    }
    for (const auto& parameter : geometry::parameter_names()) {
        if (parameter.name == name && !parameter.unit.empty()) {
            return parameter.unit;
        }
    }
    return "1";
}

State brush(State state, const Words& words, const Session& session) {
    need(words, 0, 100, "brush COLUMN=LOW:HIGH ...");
    if (words.empty()) {
        state.explore.brush.clear();
    }
    for (const auto& word : words) {
        const auto [column, text] = assignment(word);
        if (text.empty()) {
            state.explore.brush.erase(column);
        } else {
            state.explore.brush[column] = range_of(text, unit_of_column(column, session).c_str());
        }
    }
    return state;
}

State vary(State state, const Words& words, const Session& session) {
    need(words, 0, 12, "vary PARAMETER=FROM:TO:COUNT ...");
    std::vector<geometry::Vary> varied;
    std::size_t count = 1;
    for (const auto& word : words) {
        varied.push_back(geometry::vary_from(word));
        count *= varied.back().values.size();
        const bool twice = std::count_if(varied.begin(), varied.end(),
                                         [&](const auto& one) { return one.key == varied.back().key; }) > 1;
        if (twice) {
            throw UsageError("words", "'" + varied.back().key + "' is varied twice", {}, "name it once");
        }
    }
    constexpr std::size_t most = 5000;  // made while somebody waits
    if (count > most) {
        throw UsageError("range", std::to_string(count) + " shapes are more than the window makes", {},
                         "at most " + std::to_string(most) + "; `underbody body sweep` makes more");
    }
    if (!varied.empty()) {
        static_cast<void>(shape_of(state, session, need_shape(state, session)));
    }
    state.explore.vary = std::move(varied);
    state.explore.shapes = !state.explore.vary.empty();
    return state;
}

State rows(State state, const Words& words, const Session&) {
    need(words, 1, 1, "rows cases|shapes");
    if (words[0] != "cases" && words[0] != "shapes") {
        throw UsageError("unknown", "rows are cases or shapes, not '" + words[0] + "'", {},
                         core::did_you_mean(words[0], {"cases", "shapes"}));
    }
    state.explore.shapes = words[0] == "shapes";
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

State exported(State state, const Words& words, const Session&) {
    need(words, 2, 100, "exported FILE TABLE KEY=VALUE ...");
    ExportRecord record;
    record.table = words[1];
    const std::map<std::string, std::string*> texts = {{"made_of", &record.made_of},
                                                       {"format", &record.format},
                                                       {"name", &record.name},
                                                       {"frame", &record.frame},
                                                       {"number", &record.number}};
    for (std::size_t i = 2; i < words.size(); ++i) {
        const auto [key, text] = assignment(words[i]);
        if (const auto known = texts.find(key); known != texts.end()) {
            *known->second = text;
        } else if (key == "max_error") {
            record.max_error = within(core::parse_in(text, "1"), 0, 1, "error allowed");
        } else if (key.starts_with("range.")) {
            record.range[key.substr(6)] = text;
        } else {
            unknown_key(key, {"made_of", "format", "name", "frame", "number", "max_error", "range.AXIS"});
        }
    }
    state.exports[std::filesystem::absolute(words[0]).lexically_normal().string()] = record;
    return state;
}

}  // namespace

const std::vector<ActionKind>& action_kinds() {
    static const std::vector<ActionKind> kinds = {
        {"open", "FOLDER", "opens a study", "open cases/evie", false, open_study},
        {"add", "field|shape FILE", "shows a file from outside the study", "add shape hull.toml", false, add_file},
        {"remove", "FILE", "no longer shows such a file", "remove hull.toml", false, remove_file},
        {"locate", "OLD NEW", "says where a study or file has moved to", "locate /old/evie /new/evie", false, locate},
        {"workspace", "NAME", "shows a workspace", "workspace tables", true, show_workspace},
        {"select", "KIND/NAME ...", "selects cases, shapes, tables, ...", "select case/ellipse-h5-p0", true, select},
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
        {"fields", "KEY=VALUE ...", "sets how fields are looked at", "fields array=pressure camera=bottom", true,
         look_at_fields},
        {"table", "NAME KEY=VALUE ...", "sets numbers and view of a force table", "table lift net_weight=0.28N", false,
         look_at_table},
        {"region", "NAME KEY=VALUE ...", "changes numbers and view of a stability map", "region glide cells=100", false,
         look_at_region},
        {"accept", "MEASUREMENT", "the model that was found counts as the declared one", "accept 'heave test'", false,
         accept},
        {"unaccept", "MEASUREMENT", "the declared model counts again", "unaccept 'heave test'", false, unaccept},
        {"exported", "FILE TABLE KEY=VALUE ...", "remembers a file that was exported, and how",
         "exported lift.h lift format=c", false, exported},
        {"axes", "X Y", "chooses what the scatter plot shows", "axes gap lift_force", true, explore_axes},
        {"brush", "COLUMN=LOW:HIGH ...", "keeps cases within ranges; no range: all", "brush gap=2mm:5mm", true, brush},
        {"vary", "PARAMETER=FROM:TO:COUNT ...", "makes the shapes between; no parameter: none",
         "vary protrusion.height=1mm:3mm:5", false, vary},
        {"rows", "cases|shapes", "explores the cases of the study or the shapes that vary", "rows cases", true, rows},
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
