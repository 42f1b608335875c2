#include "studio/desktop/state/state.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "core/hash.h"
#include "geometry/body/variants.h"

namespace underbody::studio {

using nlohmann::json;

std::vector<std::string> State::selected(const std::string& kind) const {
    std::vector<std::string> names;
    for (const auto& id : selection) {
        if (id.starts_with(kind + "/")) {
            names.push_back(id.substr(kind.size() + 1));
        }
    }
    return names;
}

std::string State::current(const std::string& kind, const std::vector<std::string>& known) const {
    if (const auto at = last.find(kind); at != last.end()) {
        for (const auto& name : at->second) {
            if (std::find(known.begin(), known.end(), name) != known.end()) {
                return name;
            }
        }
    }
    return known.empty() ? std::string() : known.front();
}

std::string shown_shape(const State& state, const Session& session) {
    const auto known = shape_names(state, session);
    const bool chosen = std::find(known.begin(), known.end(), state.design.shape) != known.end();
    return chosen ? state.design.shape : known.empty() ? std::string() : known.front();
}

const std::vector<std::string>& workspace_names() {
    static const std::vector<std::string> names = {"design", "explore", "compare", "tables", "stability", "loop"};
    return names;
}

const std::vector<WorkspaceView>& workspace_views(const std::string& workspace) {
    static const std::map<std::string, std::vector<WorkspaceView>> views = {
        {"design", {{"body", "Body"}, {"section", "Section"}, {"lift", "Lift"}, {"map", "Stability map"}}},
        {"explore", {{"lines", "Lines"}, {"table", "Table"}, {"points", "Points"}, {"pictures", "Pictures"}}},
        {"compare", {{"fields", "Fields"}, {"numbers", "Numbers"}}},
        {"tables", {{"curves", "Curves"}, {"equilibria", "Equilibria"}}},
        {"stability", {{"map", "Map"}, {"motion", "Motion"}}},
        {"loop", {{"verdict", "Verdict"}, {"pictures", "Pictures"}}}};
    return views.at(workspace);
}

bool State::shows(const std::string& of, const std::string& view) const {
    const auto at = cells.find(of);
    return at == cells.end() || std::find(at->second.begin(), at->second.end(), view) != at->second.end();
}

geometry::BodyShape shape_with(const State& state, const Session& session, const std::string& name,
                               const ShapeChanges& changes) {
    geometry::BodyShape shape;
    if (const auto kept = state.design.variants.find(name); kept != state.design.variants.end()) {
        shape = shape_with(state, session, kept->second.of, kept->second.set);
    } else if (const auto known = session.shapes.find(name); known != session.shapes.end()) {
        shape = known->second;
    } else {
        throw core::InputError("missing", "there is no shape '" + name + "'", {},
                               core::did_you_mean(name, shape_names(state, session)));
    }
    for (const auto& [parameter, text] : changes) {
        geometry::set_parameter(shape, parameter, text);
    }
    geometry::check(shape);
    return shape;
}

geometry::BodyShape shape_of(const State& state, const Session& session, const std::string& name) {
    const auto changed = state.design.changes.find(name);
    return shape_with(state, session, name, changed == state.design.changes.end() ? ShapeChanges{} : changed->second);
}

std::vector<std::string> shape_names(const State& state, const Session& session) {
    std::vector<std::string> names;
    for (const auto& body : session.study.bodies) {
        if (session.shapes.contains(body.name)) {
            names.push_back(body.name);
        }
    }
    for (const auto& [name, shape] : session.shapes) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            names.push_back(name);
        }
    }
    for (const auto& [name, variant] : state.design.variants) {
        if (!session.shapes.contains(name)) {  // a kept one may have become a body of the study since
            names.push_back(name);
        }
    }
    return names;
}

std::string proposed_name(const State& state, const Session& session) {
    const auto first_of = [&](const std::string& kind, const auto& known) {
        std::vector<std::string> names;
        for (const auto& one : known) {
            names.push_back(one.name);
        }
        return state.current(kind, names);
    };
    const auto& at = state.workspace;
    std::string what = at == "design"      ? shown_shape(state, session)
                       : at == "explore"   ? (state.explore.shapes ? "shapes" : "cases")
                       : at == "compare"   ? state.fields.array
                       : at == "tables"    ? first_of("table", session.study.tables)
                       : at == "stability" ? first_of("region", session.study.regions)
                                           : first_of("measurement", session.study.measurements);
    if (const auto cases = state.selected("case"); at == "compare" && !cases.empty()) {
        what += "-" + cases.front() + (cases.size() > 1 ? "-and-" + std::to_string(cases.size() - 1) : "");
    }
    std::string name = at + (what.empty() ? "" : "-" + what);
    for (char& letter : name) {
        const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '.' || letter == '-';
        letter = plain ? letter : '_';
    }
    return name;
}

std::string state_hash(const State& state) { return core::content_hash(json(state).dump()); }

namespace {

template <class T>
void put(json& object, const char* key, const T& value) {
    object[key] = value;
}

template <class T>
void put(json& object, const char* key, const std::optional<T>& value) {
    object[key] = value ? json(*value) : json();
}

template <class T>
void take(const json& object, const char* key, T& value) {
    if (const auto at = object.find(key); at != object.end()) {
        at->get_to(value);
    }
}

template <class T>
void take(const json& object, const char* key, std::optional<T>& value) {
    if (const auto at = object.find(key); at != object.end()) {
        value = at->is_null() ? std::optional<T>() : std::optional<T>(at->get<T>());
    }
}

// The fields of each view by their keys, once for writing (`v` is const) and reading.

void fields(auto& v, const DesignView& /*kind*/, const auto& field) {
    field("shape", v.shape);
    field("gap", v.gap);
    field("pitch", v.pitch);
    field("speed", v.speed);
    field("changes", v.changes);
    field("before", v.before);
    field("before_shape", v.before_shape);
    field("map", v.map);
    field("outline", v.outline);
    field("turned", v.turned);
}

void fields(auto& v, const FieldView& /*kind*/, const auto& field) {
    field("array", v.array);
    field("whole_range", v.whole_range);
    field("edges", v.edges);
    field("mirror", v.mirror);
    field("range", v.range);
    field("difference", v.difference);
    field("camera", v.camera);
    field("view", v.view);
    field("time", v.time);
    field("probe", v.probe);
    field("turned", v.turned);
    field("zones", v.zones);
}

void fields(auto& v, const FileReading& /*kind*/, const auto& field) {
    field("length_unit", v.length_unit);
    field("units", v.units);
    field("symmetry", v.symmetry);
    field("density", v.density);
    field("zones", v.zones);
}

void fields(auto& v, const TableView& /*kind*/, const auto& field) {
    field("net_weight", v.net_weight);
    field("virtual_mass", v.virtual_mass);
    field("shown", v.shown);
    field("held", v.held);
    field("logarithmic", v.logarithmic);
    field("beside", v.beside);
}

void fields(auto& v, const RegionView& /*kind*/, const auto& field) {
    field("set", v.set);
    field("cells", v.cells);
    field("show", v.show);
    field("beside", v.beside);
    field("axes", v.axes);
    field("feedback", v.feedback);
    field("sweep", v.sweep);
    field("steps", v.steps);
    field("draws", v.draws);
    field("gap_noise", v.gap_noise);
    field("velocity_noise", v.velocity_noise);
    field("drag_error", v.drag_error);
    field("logarithmic", v.logarithmic);
    field("duration", v.duration);
    field("start", v.start);
    field("start_of", v.start_of);
}

void fields(auto& v, const ExportRecord& /*kind*/, const auto& field) {
    field("table", v.table);
    field("made_of", v.made_of);
    field("written", v.written);
    field("format", v.format);
    field("name", v.name);
    field("frame", v.frame);
    field("number", v.number);
    field("max_error", v.max_error);
    field("range", v.range);
}

void fields(auto& v, const MeasuredRecord& /*kind*/, const auto& field) {
    field("model", v.model);
    field("data", v.data);
    field("channels", v.channels);
    field("clock", v.clock);
}

void fields(auto& v, const ExploreView& /*kind*/, const auto& field) {
    field("x", v.x);
    field("y", v.y);
    field("brush", v.brush);
    field("order", v.order);
    field("shapes", v.shapes);
    field("pictures", v.pictures);
    field("picture", v.picture);
}

void fields(auto& v, const State& /*kind*/, const auto& field) {
    field("study", v.study);
    field("files", v.files);
    field("workspace", v.workspace);
    field("selection", v.selection);
    field("last", v.last);
    field("stars", v.stars);
    field("cells", v.cells);
    field("accepted", v.accepted);
}

template <class View>
json json_of(const View& v) {
    json object = json::object();
    fields(v, v, [&object](const char* key, const auto& value) { put(object, key, value); });
    return object;
}

template <class View>
void read_fields(const json& object, View& v) {
    fields(v, v, [&object](const char* key, auto& value) { take(object, key, value); });
}

/// The views that there are several of, by name.
void named_views(auto& state, const auto& each) {
    each("tables", state.tables);
    each("exports", state.exports);
    each("measured", state.measured);
    each("readings", state.readings);
    each("regions", state.regions);
}

State read_state(const json& object) {
    State state;
    read_fields(object, state);
    const json design = object.value("design", json::object()), explore = object.value("explore", json::object());
    read_fields(design, state.design);
    const json variants = design.value("variants", json::object());
    for (const auto& [name, one] : variants.items()) {
        state.design.variants[name] = {one.at("of").get<std::string>(), one.at("set").get<ShapeChanges>()};
    }
    read_fields(object.value("fields", json::object()), state.fields);
    read_fields(explore, state.explore);
    for (const auto& one : explore.value("vary", json::array())) {
        state.explore.vary.push_back(
            {one.at("key").get<std::string>(), one.at("values").get<std::vector<std::string>>()});
    }
    named_views(state, [&object](const char* kind, auto& views) {
        const json all = object.value(kind, json::object());
        for (const auto& [name, one] : all.items()) {
            read_fields(one, views[name]);
        }
    });
    return state;
}

}  // namespace

void to_json(json& object, const State& state) {
    object = json_of(state);
    object["design"] = json_of(state.design);
    json& variants = object["design"]["variants"] = json::object();
    for (const auto& [name, one] : state.design.variants) {
        variants[name] = {{"of", one.of}, {"set", one.set}};
    }
    object["fields"] = json_of(state.fields);
    object["explore"] = json_of(state.explore);
    json& vary = object["explore"]["vary"] = json::array();
    for (const auto& one : state.explore.vary) {
        vary.push_back({{"key", one.key}, {"values", one.values}});
    }
    named_views(state, [&object](const char* kind, const auto& views) {
        json& all = object[kind] = json::object();
        for (const auto& [name, one] : views) {
            all[name] = json_of(one);
        }
    });
}

State state_from_json(const json& object) {
    try {
        return read_state(object);
    } catch (const json::exception& error) {
        throw core::InputError("parse", std::string("the state of the window cannot be read: ") + error.what());
    }
}

}  // namespace underbody::studio
