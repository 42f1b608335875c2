#include <map>

#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::dynamics {

namespace {

namespace fs = std::filesystem;

std::string quantity(double value, const std::string& unit) {
    const std::string number = core::format_number(value);
    return unit == "1" || unit.empty() ? number : core::toml_string(number + " " + unit);
}

std::string effect_text(const EffectUse& use, const std::string& parameter_unit) {
    std::string text = "\n[[effect]]\nname = " + core::toml_string(use.name) + "\n";
    if (!use.quantity.empty()) {
        text += "quantity = " + core::toml_string(use.quantity) + "\n";
    }
    if (!use.parameter.empty()) {
        text += "parameter = " + core::toml_string(use.parameter) + "\n";
    }
    if (!use.table_file.empty()) {
        text += "table = " + core::toml_string(use.table_file) + "\n";
    }
    const std::vector<EffectParameter>& parameters = effect(use.name).info().parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const std::string& unit = parameters[i].unit == "parameter" ? parameter_unit : parameters[i].unit;
        text += parameters[i].name + " = { value = " + quantity(use.values[i], unit);
        text += use.sigmas.size() > i && use.sigmas[i] > 0 ? ", sigma = " + quantity(use.sigmas[i], unit) + " }\n"
                                                           : std::string(" }\n");
    }
    return text;
}

std::string records_text(const RecordReading& records) {
    if (records == RecordReading{}) {
        return {};
    }
    std::string text = "\n[records]\n";
    const auto factor = [&](const char* key, double value) {
        text += value != 1 ? std::string(key) + " = " + core::format_number(value) + "\n" : "";
    };
    factor("input_force_factor", records.input_factor);
    text += records.input_advance != 0 ? "input_force_advance = " + quantity(records.input_advance, "s") + "\n" : "";
    text += records.others_advance != 0 ? "other_inputs_advance = " + quantity(records.others_advance, "s") + "\n" : "";
    if (records.input_between != RecordReading::Between::unsaid) {
        const bool held = records.input_between == RecordReading::Between::held;
        text += std::string("input_force_between = \"") + (held ? "held" : "linear") + "\"\n";
    }
    factor("heave_velocity_factor", records.velocity_factor);
    text += records.factors.empty() ? "" : "\n[records.factors]\n";
    for (const auto& [column, value] : records.factors) {
        factor(core::toml_string(column).c_str(), value);
    }
    return text;
}

/// Where a table is written: below the new model under its own relative name when that stays inside, else beside it.
std::string new_name(const std::string& written, std::map<std::string, fs::path>& taken, const fs::path& source) {
    const fs::path relative = fs::path(written).lexically_normal();
    std::string name = relative.is_absolute() || relative.begin() == relative.end() || *relative.begin() == ".."
                           ? relative.filename().generic_string()
                           : relative.generic_string();
    for (int count = 2; taken.count(name) && taken[name] != source; ++count) {
        const fs::path base(relative.filename());
        name = base.stem().string() + "-" + std::to_string(count) + base.extension().string();
    }
    taken[name] = source;
    return name;
}

void replace_quoted(std::string& text, const std::string& from, const std::string& to) {
    for (const char quote : {'"', '\''}) {
        const std::string old = quote + from + quote;
        for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at + to.size())) {
            text.replace(at, old.size(), core::toml_string(to));
        }
    }
}

}  // namespace

void write_model(const Model& model, const std::filesystem::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    std::string text = model.base_text;
    std::map<std::string, fs::path> taken;
    std::vector<std::pair<fs::path, std::string>> copies;
    const auto bring = [&](const std::string& written, const fs::path& path, const std::string& bytes) {
        const std::string name = new_name(written, taken, fs::weakly_canonical(path));
        if (name != written) {
            replace_quoted(text, written, name);
        }
        copies.emplace_back(folder / name, bytes);
    };
    for (const ForceSource& source : model.forces) {
        if (!source.table_file.empty()) {
            const bool there = fs::exists(source.table_path);
            bring(source.table_file, source.table_path,
                  there ? core::read_file(source.table_path) : core::write_csv(source.table.points()));
        }
    }
    if (model.vehicle.added_mass_heave_table) {
        const tables::ForceTable& table = *model.vehicle.added_mass_heave_table;
        bring(model.vehicle.added_mass_heave_file, table.source(), core::write_csv(table.points()));
    }
    std::map<std::string, std::string> units;
    for (const DeclaredParameter& parameter : model.parameters()) {
        units[parameter.name] = parameter.unit;
    }
    for (const std::string& name : model.changed) {
        EffectUse use = neutral_use("declared_parameter");
        use.parameter = name;
        use.values[0] = model.parameter(name);
        text += effect_text(use, units[name]);
    }
    int count = 0;
    for (EffectUse use : model.effects) {
        if (use.table) {
            ++count;
            const std::string wish =
                use.table_file.empty() ? "correction-" + std::to_string(count) + ".csv" : use.table_file;
            use.table_file = new_name(wish, taken, fs::path("effect " + std::to_string(count)));
            copies.emplace_back(folder / use.table_file, core::write_csv(use.table->points()));
        }
        text += effect_text(use, use.parameter.empty() ? "1" : units[use.parameter]);
    }
    text += records_text(model.records);
    if (!model.lineage.made_from.empty()) {
        text += "\n[lineage]\nmade_from = [";
        for (const std::string& line : model.lineage.made_from) {
            text += "\n  " + core::toml_string(line) + ",";
        }
        text += "\n]\n";
    }
    for (const auto& [path, bytes] : copies) {
        core::write_file(path, bytes);
    }
    core::write_file(file, text);
}

}  // namespace underbody::dynamics
