#include "cases/sweep_record.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/code_version.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// Nine digits: the same length written in other units differs in its last bits.
std::string in_unit(double value, const std::string& si, const std::string& unit) {
    const std::string text = core::format_number(core::convert(value, si, unit), 9);
    return unit == "1" ? text : text + " " + unit;
}

/// Keys and values of a SHAPE.toml, "body.length" -> "0.2032 m". The name of the body changes nothing.
void add_shape(CaseRecord& record, const geometry::BodyShape& shape) {
    std::string section;
    const std::string text = geometry::write_shape(shape);
    for (const auto raw : core::split(text, '\n')) {
        const std::string line(core::trimmed(raw));
        const auto equals = line.find(" = ");
        if (line.starts_with("[")) {
            section = line.substr(1, line.size() - 2);
        } else if (equals != std::string::npos && line.substr(0, equals) != "name") {
            std::string value = line.substr(equals + 3);
            std::erase(value, '"');
            record.made_of.emplace_back(section + "." + line.substr(0, equals), value);
        }
    }
}

/// The words of system/controlDict that say how the run is written, not what is solved.
std::string solved_part(const std::string& name, std::string text) {
    if (name != "system/controlDict") {
        return text;
    }
    std::string kept;
    for (const auto line : core::split(text, '\n')) {
        const auto bare = core::trimmed(line);
        const bool of_writing =
            bare.starts_with("writeInterval ") || bare.starts_with("purgeWrite ") || bare.starts_with("startFrom ");
        kept += of_writing ? "" : std::string(line) + "\n";
    }
    return kept;
}

}  // namespace

CaseRecord record_of(const geometry::BodyShape& shape, const geometry::FlowOptions& flow) {
    CaseRecord record;
    record.shape = geometry::shape_hash(shape);
    record.code = code_versions().at("geometry");
    add_shape(record, shape);
    const auto add = [&](const char* name, const std::string& value) { record.made_of.emplace_back(name, value); };
    add("gap", in_unit(flow.placement.gap, "m", "mm"));
    add("pitch", in_unit(flow.placement.pitch, "rad", "deg"));
    add("speed", in_unit(flow.speed, "m/s", "m/s"));
    add("density", in_unit(flow.density, "kg/m^3", "kg/m^3"));
    add("kinematic_viscosity", in_unit(flow.kinematic_viscosity, "m^2/s", "m^2/s"));
    add("turbulence_intensity", in_unit(flow.turbulence_intensity, "1", "1"));
    add("viscosity_ratio", in_unit(flow.viscosity_ratio, "1", "1"));
    add("half model", flow.half ? "yes" : "no");
    if (flow.mesher == geometry::CaseMesher::blocks) {
        add("mesher", "blocks");
        add("mesh density", geometry::name_of(flow.mesh_density));
        if (flow.jet_flow != 0) {
            add("jet_flow", in_unit(flow.jet_flow, "m^3/s", "mL/s"));
        }
    } else {
        add("cell", in_unit(flow.cell, "1", "1"));
        add("surface_level", std::to_string(flow.surface_level));
        add("layers", std::to_string(flow.layers));
    }
    add("iterations", std::to_string(iterations_of(flow)));
    return record;
}

std::map<std::string, std::string> case_files(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const char* part : {"system", "constant", "0"}) {
        std::error_code error;
        for (auto entry = fs::recursive_directory_iterator(folder / part, error);
             !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
            const std::string name = entry->path().lexically_relative(folder).generic_string();
            const bool of_mesher =
                name == "constant/polyMesh" || name == "constant/extendedFeatureEdgeMesh" || name == "0/polyMesh";
            const bool of_cores = name == "system/decomposeParDict";  // how it is run, not what is solved
            if (of_mesher) {
                entry.disable_recursion_pending();
            } else if (entry->is_regular_file(error) && entry->path().extension() != ".eMesh" && !of_cores) {
                files[name] = core::content_hash(solved_part(name, core::read_file(entry->path())));
            }
        }
    }
    return files;
}

std::vector<std::string> differences(const CaseRecord& there, const CaseRecord& now) {
    const auto value_in = [](const CaseRecord& record, const std::string& name) -> std::string {
        const auto found = std::find_if(record.made_of.begin(), record.made_of.end(),
                                        [&](const auto& item) { return item.first == name; });
        return found == record.made_of.end() ? "nothing" : found->second;
    };
    std::vector<std::string> found;
    const auto compare = [&](const std::string& name) {
        const bool of_shape = name.find('.') != std::string::npos;
        const std::string old_value = value_in(there, name);
        const std::string new_value = value_in(now, name);
        const std::string text = name + ": " + old_value + " there, " + new_value + " now";
        // A default that is written out makes no other shape.
        if (old_value != new_value && !(of_shape && there.shape == now.shape) &&
            std::find(found.begin(), found.end(), text) == found.end()) {
            found.push_back(text);
        }
    };
    for (const auto* record : {&there, &now}) {
        for (const auto& item : record->made_of) {
            compare(item.first);
        }
    }
    if (there.shape != now.shape && std::none_of(found.begin(), found.end(), [](const std::string& text) {
            return text.find('.') < text.find(':');
        })) {
        found.push_back("shape: " + there.shape.substr(0, 8) + " there, " + now.shape.substr(0, 8) + " now");
    }
    return found;
}

std::vector<std::string> different_files(const CaseRecord& there, const CaseRecord& now) {
    std::vector<std::string> names;
    for (const auto& [name, hash] : now.files) {
        const auto old = there.files.find(name);
        if (old == there.files.end() || old->second != hash) {
            names.push_back(name);
        }
    }
    for (const auto& [name, hash] : there.files) {
        if (!now.files.contains(name)) {
            names.push_back(name);
        }
    }
    return names;
}

nlohmann::json to_json(const CaseRecord& record) {
    nlohmann::json made_of = nlohmann::json::array();
    for (const auto& [name, value] : record.made_of) {
        made_of.push_back({{"name", name}, {"value", value}});
    }
    return {{"made_of", made_of},
            {"shape", record.shape},
            {"code", record.code},
            {"files", record.files},
            {"walls", record.walls}};
}

std::optional<CaseRecord> record_from(const nlohmann::json& json) {
    try {
        CaseRecord record;
        for (const auto& item : json.at("made_of")) {
            record.made_of.emplace_back(item.at("name").get<std::string>(), item.at("value").get<std::string>());
        }
        record.shape = json.at("shape").get<std::string>();
        record.code = json.at("code").get<std::string>();
        record.files = json.at("files").get<std::map<std::string, std::string>>();
        record.walls = json.at("walls").get<std::vector<std::string>>();
        return record;
    } catch (const nlohmann::json::exception&) {
        return {};
    }
}

}  // namespace underbody::cases
