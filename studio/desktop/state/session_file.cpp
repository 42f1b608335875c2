#include "studio/desktop/state/session_file.h"

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/hash.h"

namespace underbody::studio {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr const char* schema = "underbody-session";
constexpr int version = 1;

std::string relative_to(const fs::path& folder, const std::string& path) {
    const fs::path relative = fs::path(path).lexically_relative(folder);
    return relative.empty() ? path : relative.string();
}

std::string absolute_in(const fs::path& folder, const std::string& path) {
    fs::path whole = (fs::path(path).is_absolute() ? fs::path(path) : folder / path).lexically_normal();
    if (!whole.has_filename() && whole.has_relative_path()) {
        whole = whole.parent_path();
    }
    return whole.string();
}

/// The file that stands for an input: of a study its study.toml.
fs::path file_of(const std::string& path) {
    return fs::is_directory(path) ? fs::path(path) / "study.toml" : fs::path(path);
}

std::string hash_of(const std::string& path) {
    const fs::path file = file_of(path);
    return fs::is_regular_file(file) ? core::content_hash_of_file(file) : std::string();
}

std::vector<std::string> inputs_of(const State& state) {
    std::vector<std::string> inputs;
    if (!state.study.empty()) {
        inputs.push_back(state.study);
    }
    for (const auto& entry : state.files) {
        inputs.push_back(entry.substr(entry.find(':') + 1));
    }
    return inputs;
}

json parsed(const fs::path& file) {
    const json document = json::parse(core::read_file(file), nullptr, false);
    if (!document.is_object() || document.value("schema", "") != schema) {
        throw core::InputError("format", "this is no session of the studio", {file.string(), {}, {}, {}},
                               "sessions are written by File > Save session (.ubs)");
    }
    if (document.value("version", 0) > version) {
        throw core::InputError("version", "the session was written by a later version of the program",
                               {file.string(), {}, {}, {}}, "open it with that version");
    }
    return document;
}

}  // namespace

void write_session(const State& state, const fs::path& file) {
    const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
    json document = json::object();
    if (fs::exists(file)) {
        document = parsed(file);
    }
    State relative = state;
    if (!relative.study.empty()) {
        relative.study = relative_to(folder, relative.study);
    }
    for (auto& entry : relative.files) {
        const auto at = entry.find(':') + 1;
        entry = entry.substr(0, at) + relative_to(folder, entry.substr(at));
    }
    relative.readings.clear();
    for (const auto& [path, reading] : state.readings) {
        relative.readings[relative_to(folder, path)] = reading;
    }
    document["schema"] = schema;
    document["version"] = version;
    document["state"] = relative;
    document["inputs"] = json::array();
    for (const auto& input : inputs_of(state)) {
        document["inputs"].push_back({{"path", relative_to(folder, input)}, {"hash", hash_of(input)}});
    }
    core::write_file(file, document.dump(2) + "\n");
}

fs::path kept_session(const fs::path& study) { return study / ".underbody" / "session.ubs"; }

SavedSession read_session(const fs::path& file) {
    const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
    const json document = parsed(file);
    SavedSession saved;
    saved.state = state_from_json(document.value("state", json::object()));
    if (!saved.state.study.empty()) {
        saved.state.study = absolute_in(folder, saved.state.study);
    }
    for (auto& entry : saved.state.files) {
        const auto at = entry.find(':') + 1;
        entry = entry.substr(0, at) + absolute_in(folder, entry.substr(at));
    }
    std::map<std::string, FileReading> readings;
    for (const auto& [path, reading] : saved.state.readings) {
        readings[absolute_in(folder, path)] = reading;
    }
    saved.state.readings = std::move(readings);
    for (const auto& input : document.value("inputs", json::array())) {
        const std::string path = absolute_in(folder, input.value("path", ""));
        if (!fs::exists(file_of(path))) {
            saved.missing.push_back(path);
            saved.problems.push_back({core::Problem::Severity::error,
                                      "the session needs " + path + ", which is not there: say where it is now",
                                      {file.string(), {}, {}, {}}});
        } else if (hash_of(path) != input.value("hash", "")) {
            saved.problems.push_back({core::Problem::Severity::note,
                                      path + " has changed since the session was saved",
                                      {file.string(), {}, {}, {}}});
        }
    }
    return saved;
}

}  // namespace underbody::studio
