#include "studio/desktop/state/state.h"

#include <algorithm>
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
        names.push_back(name);
    }
    return names;
}

std::string state_hash(const State& state) { return core::content_hash(json(state).dump()); }

namespace {

template <class T>
json optional_json(const std::optional<T>& value) {
    return value ? json(*value) : json();
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

json json_of(const DesignView& v) {
    json variants = json::object();
    for (const auto& [name, one] : v.variants) {
        variants[name] = {{"of", one.of}, {"set", one.set}};
    }
    return {{"shape", v.shape},     {"gap", v.gap},         {"pitch", v.pitch},   {"speed", v.speed},
            {"changes", v.changes}, {"variants", variants}, {"before", v.before}, {"before_shape", v.before_shape}};
}

DesignView design_from(const json& object) {
    DesignView v;
    take(object, "shape", v.shape);
    take(object, "gap", v.gap);
    take(object, "pitch", v.pitch);
    take(object, "speed", v.speed);
    take(object, "changes", v.changes);
    take(object, "before", v.before);
    take(object, "before_shape", v.before_shape);
    const json variants = object.value("variants", json::object());
    for (const auto& [name, one] : variants.items()) {
        v.variants[name] = {one.at("of").get<std::string>(), one.at("set").get<ShapeChanges>()};
    }
    return v;
}

json json_of(const FieldView& v) {
    return {{"array", v.array},
            {"whole_range", v.whole_range},
            {"edges", v.edges},
            {"mirror", optional_json(v.mirror)},
            {"range", optional_json(v.range)},
            {"difference", v.difference},
            {"camera", v.camera},
            {"view", v.view},
            {"time", optional_json(v.time)},
            {"probe", optional_json(v.probe)},
            {"zones", v.zones}};
}

FieldView fields_from(const json& object) {
    FieldView v;
    take(object, "array", v.array);
    take(object, "whole_range", v.whole_range);
    take(object, "edges", v.edges);
    take(object, "mirror", v.mirror);
    take(object, "range", v.range);
    take(object, "difference", v.difference);
    take(object, "camera", v.camera);
    take(object, "view", v.view);
    take(object, "time", v.time);
    take(object, "probe", v.probe);
    take(object, "zones", v.zones);
    return v;
}

json json_of(const FileReading& v) {
    return {{"length_unit", v.length_unit},
            {"units", v.units},
            {"symmetry", v.symmetry},
            {"density", optional_json(v.density)},
            {"zones", v.zones}};
}

FileReading reading_from(const json& object) {
    FileReading v;
    take(object, "length_unit", v.length_unit);
    take(object, "units", v.units);
    take(object, "symmetry", v.symmetry);
    take(object, "density", v.density);
    take(object, "zones", v.zones);
    return v;
}

json json_of(const TableView& v) {
    return {{"net_weight", optional_json(v.net_weight)},
            {"virtual_mass", optional_json(v.virtual_mass)},
            {"shown", v.shown},
            {"held", v.held},
            {"logarithmic", optional_json(v.logarithmic)}};
}

TableView table_from(const json& object) {
    TableView v;
    take(object, "net_weight", v.net_weight);
    take(object, "virtual_mass", v.virtual_mass);
    take(object, "shown", v.shown);
    take(object, "held", v.held);
    take(object, "logarithmic", v.logarithmic);
    return v;
}

json json_of(const RegionView& v) {
    return {{"set", v.set},
            {"cells", v.cells},
            {"show", v.show},
            {"axes", v.axes},
            {"sweep", v.sweep},
            {"steps", v.steps},
            {"draws", v.draws},
            {"gap_noise", v.gap_noise},
            {"velocity_noise", v.velocity_noise},
            {"drag_error", v.drag_error},
            {"logarithmic", optional_json(v.logarithmic)},
            {"duration", optional_json(v.duration)},
            {"start", optional_json(v.start)}};
}

RegionView region_from(const json& object) {
    RegionView v;
    take(object, "set", v.set);
    take(object, "cells", v.cells);
    take(object, "show", v.show);
    take(object, "axes", v.axes);
    take(object, "sweep", v.sweep);
    take(object, "steps", v.steps);
    take(object, "draws", v.draws);
    take(object, "gap_noise", v.gap_noise);
    take(object, "velocity_noise", v.velocity_noise);
    take(object, "drag_error", v.drag_error);
    take(object, "logarithmic", v.logarithmic);
    take(object, "duration", v.duration);
    take(object, "start", v.start);
    return v;
}

json json_of(const ExportRecord& v) {
    return {{"table", v.table},
            {"made_of", v.made_of},
            {"format", v.format},
            {"name", v.name},
            {"frame", v.frame},
            {"number", v.number},
            {"max_error", optional_json(v.max_error)},
            {"range", v.range}};
}

ExportRecord export_from(const json& object) {
    ExportRecord v;
    take(object, "table", v.table);
    take(object, "made_of", v.made_of);
    take(object, "format", v.format);
    take(object, "name", v.name);
    take(object, "frame", v.frame);
    take(object, "number", v.number);
    take(object, "max_error", v.max_error);
    take(object, "range", v.range);
    return v;
}

json json_of(const MeasuredRecord& v) {
    return {{"model", v.model}, {"data", v.data}, {"channels", v.channels}, {"clock", v.clock}};
}

MeasuredRecord measured_from(const json& object) {
    MeasuredRecord v;
    take(object, "model", v.model);
    take(object, "data", v.data);
    take(object, "channels", v.channels);
    take(object, "clock", v.clock);
    return v;
}

json json_of(const ExploreView& v) {
    json vary = json::array();
    for (const auto& one : v.vary) {
        vary.push_back({{"key", one.key}, {"values", one.values}});
    }
    return {{"x", v.x}, {"y", v.y}, {"brush", v.brush}, {"vary", vary}, {"shapes", v.shapes}};
}

State read_state(const json& object) {
    State state;
    take(object, "study", state.study);
    take(object, "files", state.files);
    take(object, "workspace", state.workspace);
    take(object, "selection", state.selection);
    take(object, "last", state.last);
    take(object, "stars", state.stars);
    take(object, "accepted", state.accepted);
    state.design = design_from(object.value("design", json::object()));
    state.fields = fields_from(object.value("fields", json::object()));
    const json explore = object.value("explore", json::object());
    take(explore, "x", state.explore.x);
    take(explore, "y", state.explore.y);
    take(explore, "brush", state.explore.brush);
    take(explore, "shapes", state.explore.shapes);
    for (const auto& one : explore.value("vary", json::array())) {
        state.explore.vary.push_back(
            {one.at("key").get<std::string>(), one.at("values").get<std::vector<std::string>>()});
    }
    const json tables = object.value("tables", json::object());
    for (const auto& [name, one] : tables.items()) {
        state.tables[name] = table_from(one);
    }
    const json exports = object.value("exports", json::object());
    for (const auto& [file, one] : exports.items()) {
        state.exports[file] = export_from(one);
    }
    const json measured = object.value("measured", json::object());
    for (const auto& [name, one] : measured.items()) {
        state.measured[name] = measured_from(one);
    }
    const json readings = object.value("readings", json::object());
    for (const auto& [file, one] : readings.items()) {
        state.readings[file] = reading_from(one);
    }
    const json regions = object.value("regions", json::object());
    for (const auto& [name, one] : regions.items()) {
        state.regions[name] = region_from(one);
    }
    return state;
}

}  // namespace

void to_json(json& object, const State& state) {
    object = {{"study", state.study},
              {"files", state.files},
              {"workspace", state.workspace},
              {"selection", state.selection},
              {"last", state.last},
              {"stars", state.stars},
              {"accepted", state.accepted},
              {"design", json_of(state.design)},
              {"fields", json_of(state.fields)},
              {"explore", json_of(state.explore)},
              {"tables", json::object()},
              {"readings", json::object()},
              {"regions", json::object()},
              {"measured", json::object()},
              {"exports", json::object()}};
    for (const auto& [file, one] : state.exports) {
        object["exports"][file] = json_of(one);
    }
    for (const auto& [name, one] : state.measured) {
        object["measured"][name] = json_of(one);
    }
    for (const auto& [name, one] : state.tables) {
        object["tables"][name] = json_of(one);
    }
    for (const auto& [file, one] : state.readings) {
        object["readings"][file] = json_of(one);
    }
    for (const auto& [name, one] : state.regions) {
        object["regions"][name] = json_of(one);
    }
}

State state_from_json(const json& object) {
    try {
        return read_state(object);
    } catch (const json::exception& error) {
        throw core::InputError("parse", std::string("the state of the window cannot be read: ") + error.what());
    }
}

}  // namespace underbody::studio
