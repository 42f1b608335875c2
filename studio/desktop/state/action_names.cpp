// What actions are called, how they merge, and the command lines that do the same.
#include <algorithm>
#include <filesystem>

#include "core/text.h"
#include "studio/desktop/state/actions.h"
#include "studio/desktop/state/exports.h"
#include "studio/desktop/state/measured.h"

namespace underbody::studio {

namespace {

std::string key_of(const std::string& word) { return word.substr(0, word.find('=')); }

std::string value_of(const std::string& word) {
    const auto at = word.find('=');
    return at == std::string::npos ? std::string() : word.substr(at + 1);
}

std::string change_name(const std::string& of, const std::string& word) {
    const std::string prefix = of.empty() ? "" : of + ": ";
    return value_of(word).empty() ? prefix + key_of(word) + " as before"
                                  : prefix + key_of(word) + " = " + value_of(word);
}

std::string file_of(const State& state, const Session& session, const std::string& name, ShapeChanges& changes) {
    if (const auto kept = state.design.variants.find(name); kept != state.design.variants.end()) {
        for (const auto& [parameter, text] : kept->second.set) {
            changes.emplace(parameter, text);  // what is changed on top counts more
        }
        return file_of(state, session, kept->second.of, changes);
    }
    const auto known = session.shape_files.find(name);
    return known == session.shape_files.end() ? name + ".toml" : known->second.string();
}

/// A unit-less number of a brush is SI there as here.
std::string sweep_command(const State& state, const Session& session) {
    const std::string name = shown_shape(state, session);
    if (name.empty() || state.explore.vary.empty() || !state.explore.shapes) {
        return {};
    }
    Words line = shape_command(state, session, name);
    line.insert(line.begin() + 2, "sweep");
    for (const auto& one : state.explore.vary) {
        std::string values;
        for (const auto& value : one.values) {
            values += (values.empty() ? "" : ",") + value;
        }
        line.insert(line.end(), {"--vary", one.key + "=" + values});
    }
    for (const auto& [column, range] : state.explore.brush) {
        line.insert(line.end(),
                    {"--where", column + "=" + core::format_number(range[0]) + ":" + core::format_number(range[1])});
    }
    return line_of(line);
}

void add_operation(const State& state, Words& words) {
    words.insert(words.end(), {"--gap", core::format_number(state.design.gap) + "m"});
    if (state.design.pitch != 0) {
        words.insert(words.end(), {"--pitch", core::format_number(state.design.pitch) + "rad"});
    }
}

/// Of the tables as `study run` writes them; what must be done before is done once.
std::string export_command(const State& state, const Session& session, const Words& words) {
    Words lines, remarks;
    const auto add = [](Words& to, const std::string& line) {
        if (!line.empty() && std::find(to.begin(), to.end(), line) == to.end()) {
            to.push_back(line);
        }
    };
    for (const auto& one : split_exports(Words(words.begin() + 1, words.end()))) {
        const auto at = state.exports.find(std::filesystem::absolute(one.at(0)).lexically_normal().string());
        const auto* spec = session.study.find_table(one.at(1));
        if (at == state.exports.end() || spec == nullptr) {
            return {};
        }
        const TableOfStudy table = table_of_study(session, spec->name);
        add(lines, table.first);
        add(lines, line_of(table.command(spec->quantity, one.at(0), at->second)));
        add(remarks, table.before);
    }
    std::string line;
    for (const auto& one : lines) {
        line += (line.empty() ? "" : " && ") + one;
    }
    for (const auto& one : remarks) {
        line += (&one == &remarks.front() ? "  # " : "; ") + one;
    }
    return line;
}

std::string table_command(const State& state, const Words& words) {
    Words line = {"underbody", "study", "set", state.study};
    for (std::size_t i = 2; i < words.size(); ++i) {
        const std::string key = key_of(words[i]);
        if ((key == "net_weight" || key == "virtual_mass") && !value_of(words[i]).empty()) {
            line.push_back("table." + words[1] + "." + words[i]);
        }
    }
    return line.size() > 4 ? line_of(line) : std::string();
}

/// With the data of a measurement of the study; without any the command has nothing to estimate from.
std::string estimate_command(const State& state, const Session& session, const std::string& name,
                             const RegionView& view) {
    if (session.study.measurements.empty() || !view.set.empty()) {
        return {};
    }
    Words line = {"underbody",
                  "estimate",
                  state.study + "/report/models/" + name + "/model.toml",
                  "--data",
                  session.study.measurements.front().data.string(),
                  "--gap-noise",
                  core::format_number(view.gap_noise) + "m"};
    if (view.velocity_noise > 0) {
        line.insert(line.end(), {"--velocity-noise", core::format_number(view.velocity_noise) + "m/s"});
    }
    line.insert(line.end(), {"--drag-error", core::format_number(view.drag_error), "--force-density", "1e-7",
                             "--blind-zones", "blind-zones.png"});
    return line_of(line);
}

std::string region_command(const State& state, const Session& session, const std::string& name) {
    const auto& regions = session.study.regions;
    const auto spec =
        std::find_if(regions.begin(), regions.end(), [&](const auto& region) { return region.name == name; });
    const auto view = state.regions.find(name);
    if (spec == regions.end() || view == state.regions.end()) {
        return {};
    }
    if (view->second.show == "estimator") {
        return estimate_command(state, session, name, view->second);
    }
    // The model with the study's tables, as `study run` writes it.
    Words line = {"underbody", "region", state.study + "/report/models/" + name + "/model.toml", "--axes",
                  view->second.axes.empty() ? spec->axes : view->second.axes};
    const std::string cells = std::to_string(view->second.cells);
    line.insert(line.end(), {"--grid", cells + "x" + cells});
    if (view->second.duration) {
        line.insert(line.end(), {"--for", core::format_number(*view->second.duration) + "s"});
    } else {
        line.insert(line.end(), {"--for", core::format_number(spec->duration) + "s"});
    }
    if (view->second.show == "probability") {
        line.insert(line.end(), {"--draws", std::to_string(view->second.draws)});
    } else if (view->second.show == "sweep" && !view->second.sweep.empty()) {
        line.insert(line.end(), {"--sweep", view->second.sweep, "--steps", std::to_string(view->second.steps)});
    }
    if (!view->second.feedback.empty()) {
        line.insert(line.end(), {"--feedback", view->second.feedback});
    }
    for (const auto& [parameter, value] : view->second.set) {
        line.insert(line.end(), {"--set", parameter + "=" + core::format_number(value)});
    }
    return line_of(line);
}

std::string path_of_field(const std::string& id, const Session& session) {
    if (id.starts_with("field/")) {
        return id.substr(6);
    }
    for (const auto& one : session.study.cases) {
        if ("case/" + one.name == id) {
            return one.file.string();
        }
    }
    return {};
}

void add_reading(const State& state, const std::string& file, Words& line) {
    const auto at = state.readings.find(file);
    if (at == state.readings.end()) {
        return;
    }
    const FileReading& reading = at->second;
    if (!reading.length_unit.empty()) {
        line.insert(line.end(), {"--length-unit", reading.length_unit});
    }
    for (const auto& [variable, unit] : reading.units) {
        line.insert(line.end(), {"--unit", variable + "=" + unit});
    }
    if (!reading.symmetry.empty()) {
        line.insert(line.end(), {"--symmetry", reading.symmetry});
    }
    if (reading.density) {
        line.insert(line.end(), {"--density", core::format_number(*reading.density) + "kg/m^3"});
    }
    std::string zones;
    for (const auto& zone : reading.zones) {
        zones += (zones.empty() ? "" : ",") + zone;
    }
    if (!zones.empty()) {
        line.insert(line.end(), {"--zones", zones});
    }
}

/// The values at a place of the first of the fields that are chosen.
std::string probe_command(const State& state, const Session& session) {
    const auto& at = *state.fields.probe;
    for (const auto& id : state.selection) {
        if (const std::string file = path_of_field(id, session); !file.empty()) {
            Words line = {
                "underbody",
                "probe",
                file,
                "--point",
                core::format_number(at[0]) + "," + core::format_number(at[1]) + "," + core::format_number(at[2]),
                "--on-surface"};
            add_reading(state, file, line);
            if (state.fields.time) {
                line.insert(line.end(), {"--time", core::format_number(*state.fields.time) + "s"});
            }
            return line_of(line);
        }
    }
    return {};
}

/// Pictures of the fields that are chosen; surfaces that are turned by hand have no command.
std::string view_command(const State& state, const Session& session) {
    if (state.fields.view == "surface") {
        return {};
    }
    Words line = {"underbody", "views"};
    for (const auto& id : state.selection) {
        if (const std::string file = path_of_field(id, session); !file.empty()) {
            line.push_back(file);
            add_reading(state, file, line);
        }
    }
    if (line.size() == 2) {
        return {};
    }
    line.insert(line.end(), {"--view", state.fields.view});
    if (!session.study.symmetry.empty() && std::find(line.begin(), line.end(), "--symmetry") == line.end()) {
        line.insert(line.end(), {"--symmetry", session.study.symmetry});
    }
    if (state.fields.time) {
        line.insert(line.end(), {"--time", core::format_number(*state.fields.time) + "s"});
    }
    return line_of(line);
}

/// The loads of the first file that was named.
std::string read_command(const State& state, const Words& words) {
    for (std::size_t i = 1; i < words.size(); ++i) {
        const std::string file = std::filesystem::absolute(words[i]).lexically_normal().string();
        if (std::find(state.files.begin(), state.files.end(), "field:" + file) != state.files.end()) {
            Words line = {"underbody", "loads", file};
            add_reading(state, file, line);
            return line_of(line);
        }
    }
    return {};
}

}  // namespace

Words shape_command(const State& state, const Session& session, const std::string& name) {
    const auto changed = state.design.changes.find(name);
    ShapeChanges changes = changed == state.design.changes.end() ? ShapeChanges{} : changed->second;
    Words words = {"underbody", "body", file_of(state, session, name, changes)};
    for (const auto& [parameter, text] : changes) {
        words.push_back("--set");
        words.push_back(parameter + "=" + text);
    }
    return words;
}

std::string name_of(const Words& words) {
    const std::string verb = kind_of(words).verb;
    const std::string first = words.size() > 1 ? words[1] : "";
    const std::string more = words.size() > 2 ? " ..." : "";
    if (verb == "set" || verb == "operation" || verb == "fields") {
        return change_name("", first) + more;
    }
    if (verb == "table" || verb == "region") {
        return change_name(first, words.size() > 2 ? words[2] : "") + (words.size() > 3 ? " ..." : "");
    }
    if (verb == "select") {
        return first.empty() ? "select nothing" : "select " + first.substr(first.find('/') + 1) + more;
    }
    if (verb == "reset") {
        return first.empty() ? "reset the shape" : "reset " + first + more;
    }
    if (verb == "read") {
        return "units of " + first.substr(first.rfind('/') + 1) + more;
    }
    if (verb == "measure") {
        return "take in " + first;
    }
    if (verb == "exported") {
        const auto count = split_exports(words).size();
        return "export " + first.substr(first.rfind('/') + 1) +
               (count > 1 ? " and " + std::to_string(count - 1) + " more" : "");
    }
    if (verb == "session") {
        return "open a study as it was left";
    }
    if (verb == "vary") {
        return first.empty() ? "vary nothing" : "vary " + key_of(first) + more;
    }
    if (verb == "turn") {
        return "turn the view of " + first;
    }
    if (verb == "order") {
        return words.size() > 1 ? "order of the axes" : "axes as the table has them";
    }
    if (verb == "pin") {
        return "compare with this";
    }
    return verb + (first.empty() ? "" : " " + first) + more;
}

std::string merge_key(const Words& words) {
    const ActionKind& kind = kind_of(words);
    std::string key = kind.verb;
    if (kind.verb == "set" || kind.verb == "operation") {
        key += words.size() > 1 ? " " + key_of(words[1]) : "";
    } else if (kind.verb == "turn") {
        key += words.size() > 1 ? " " + words[1] : "";
    } else if (kind.verb == "table" || kind.verb == "region") {
        key += words.size() > 2 ? " " + words[1] + " " + key_of(words[2]) : "";
    }
    return key;
}

std::string command_of(const State& after, const Words& words, const Session& session) {
    const std::string& verb = kind_of(words).verb;
    if (verb == "open" || verb == "session") {
        return line_of({"underbody", "study", "list", after.study});
    }
    if (verb == "add") {
        return line_of({"underbody", "info", words.at(2)});
    }
    if (verb == "set" || verb == "reset" || verb == "shape" || verb == "operation") {
        const std::string name = shown_shape(after, session);
        if (name.empty()) {
            return {};
        }
        Words line = shape_command(after, session, name);
        add_operation(after, line);
        return line_of(line);
    }
    if (verb == "read") {
        return read_command(after, words);
    }
    if (verb == "fields") {
        const bool probed = words.size() == 2 && words[1].starts_with("probe=") && after.fields.probe;
        return probed ? probe_command(after, session) : view_command(after, session);
    }
    if (verb == "keep") {
        Words line = shape_command(after, session, words.at(1));
        line.insert(line.end(), {"--as", words.at(1) + ".toml"});
        return line_of(line);
    }
    if (verb == "accept") {
        return line_of({"underbody", "study", "accept", after.study, words.at(1)});
    }
    if (verb == "measure") {
        return line_of(command_of_measurement(after.study, words.at(1), after.measured.at(words.at(1))));
    }
    if (verb == "exported") {
        return export_command(after, session, words);
    }
    if (verb == "vary" || verb == "brush") {
        return sweep_command(after, session);
    }
    if (verb == "table") {
        return table_command(after, words);
    }
    return verb == "region" ? region_command(after, session, words.at(1)) : std::string();
}

}  // namespace underbody::studio
