// What actions are called, how they merge, and the command lines that do the same.
#include <algorithm>

#include "core/text.h"
#include "studio/desktop/state/actions.h"

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

/// `underbody body FILE --set ...` of a shape as it is in the state.
Words body_command(const State& state, const Session& session, const std::string& name) {
    const auto changed = state.design.changes.find(name);
    ShapeChanges changes = changed == state.design.changes.end() ? ShapeChanges{} : changed->second;
    Words words = {"underbody", "body", file_of(state, session, name, changes)};
    for (const auto& [parameter, text] : changes) {
        words.push_back("--set");
        words.push_back(parameter + "=" + text);
    }
    return words;
}

void add_operation(const State& state, Words& words) {
    words.insert(words.end(), {"--gap", core::format_number(state.design.gap) + "m"});
    if (state.design.pitch != 0) {
        words.insert(words.end(), {"--pitch", core::format_number(state.design.pitch) + "rad"});
    }
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

std::string region_command(const State& state, const Session& session, const std::string& name) {
    const auto& regions = session.study.regions;
    const auto spec =
        std::find_if(regions.begin(), regions.end(), [&](const auto& region) { return region.name == name; });
    const auto view = state.regions.find(name);
    if (spec == regions.end() || view == state.regions.end()) {
        return {};
    }
    // The model with the study's tables, as `study run` writes it.
    Words line = {"underbody", "region", state.study + "/report/models/" + name + "/model.toml", "--axes", spec->axes};
    const std::string cells = std::to_string(view->second.cells);
    line.insert(line.end(), {"--grid", cells + "x" + cells});
    if (view->second.duration) {
        line.insert(line.end(), {"--for", core::format_number(*view->second.duration) + "s"});
    } else {
        line.insert(line.end(), {"--for", core::format_number(spec->duration) + "s"});
    }
    for (const auto& [parameter, value] : view->second.set) {
        line.insert(line.end(), {"--set", parameter + "=" + core::format_number(value)});
    }
    return line_of(line);
}

}  // namespace

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
    } else if (kind.verb == "table" || kind.verb == "region") {
        key += words.size() > 2 ? " " + words[1] + " " + key_of(words[2]) : "";
    }
    return key;
}

std::string command_of(const State& after, const Words& words, const Session& session) {
    const std::string& verb = kind_of(words).verb;
    if (verb == "open") {
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
        Words line = body_command(after, session, name);
        add_operation(after, line);
        return line_of(line);
    }
    if (verb == "keep") {
        Words line = body_command(after, session, words.at(1));
        line.insert(line.end(), {"--as", words.at(1) + ".toml"});
        return line_of(line);
    }
    if (verb == "table") {
        return table_command(after, words);
    }
    return verb == "region" ? region_command(after, session, words.at(1)) : std::string();
}

}  // namespace underbody::studio
