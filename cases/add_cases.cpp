#include "cases/add_cases.h"

#include <algorithm>
#include <optional>

#include "core/file.h"
#include "core/name_pattern.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/toml.h"
#include "postproc/importers/importer.h"

namespace underbody::cases {

namespace {

/// The text with `symmetry` under [frame]. Throws core::UsageError when it says another plane already.
std::string with_symmetry(std::string text, const std::string& symmetry, const Study* before) {
    if (symmetry.empty() || (before != nullptr && before->symmetry == symmetry)) {
        return text;
    }
    if (before != nullptr && !before->symmetry.empty()) {
        throw core::UsageError("range",
                               "the study's half models have their plane across " + before->symmetry + " already", {},
                               "all cases of a study have one; a study of its own for the others");
    }
    if (before != nullptr && !before->cases.empty()) {
        throw core::UsageError("range",
                               "the cases that the study has already are whole bodies: with a symmetry plane they "
                               "would be taken for halves",
                               {},
                               "a study of its own for the half models, or symmetry = " + core::toml_string(symmetry) +
                                   " under [frame] by hand");
    }
    const std::string line = "symmetry = " + core::toml_string(symmetry) + "\n";
    const std::size_t frame = ("\n" + text).find("\n[frame]");
    if (frame == std::string::npos) {
        return text + "\n[frame]\n" + line;
    }
    const std::size_t end = text.find('\n', frame);
    return end == std::string::npos ? text + "\n" + line : text.insert(end + 1, line);
}

/// The lines of a [[case]] whose conditions stand in a table of design points.
std::string design_points_of(const std::filesystem::path& folder, const NewCases& cases) {
    if (cases.design_points.empty()) {
        return {};
    }
    const std::filesystem::path table = std::filesystem::absolute(cases.design_points)
                                            .lexically_relative(std::filesystem::absolute(folder).lexically_normal());
    std::string text = "design_points = " + core::toml_string(table.string()) + "\n";
    for (const auto& [parameter, quantity] : cases.parameters) {
        text += "parameters." + core::toml_string(parameter) + " = " + core::toml_string(quantity) + "\n";
    }
    return text;
}

std::string case_text(const std::filesystem::path& folder, const NewCases& cases) {
    std::string text = "\n[[case]]\nfiles = " + core::toml_string(cases.files) + "\n";
    std::string zones;
    for (const auto& zone : cases.zones) {
        zones += (zones.empty() ? "" : ", ") + core::toml_string(zone);
    }
    text += zones.empty() ? "" : "zones = [" + zones + "]\n";
    text += cases.length_unit.empty() ? "" : "length_unit = " + core::toml_string(cases.length_unit) + "\n";
    for (const auto& [variable, unit] : cases.units) {
        text += "units." + core::toml_string(variable) + " = " + core::toml_string(unit) + "\n";
    }
    for (const auto& [name, value] : cases.conditions) {
        text += "conditions." + name + " = " + core::toml_string(value) + "\n";
    }
    return text + design_points_of(folder, cases);
}

/// Files, and folders that are cases, that fit but for a number.
std::vector<std::filesystem::path> near_misses(const core::NamePattern& pattern, const std::filesystem::path& folder) {
    auto missed = pattern.near_misses(folder, true);
    std::erase_if(missed, [](const std::filesystem::path& path) {
        return std::filesystem::is_directory(path) && postproc::importer_for(path) == nullptr;
    });
    return missed;
}

/// What is wrong stands in the lines to be added, which nobody has seen yet: says it without their place.
void say_of_new_lines(const core::InputError& error, const std::filesystem::path& folder, const NewCases& cases,
                      const std::filesystem::path& file, std::ptrdiff_t old_lines) {
    if (error.place().file != file.string() || error.place().line.value_or(0) <= old_lines) {
        return;
    }
    std::string hint = error.hint();
    if (error.kind() == "missing") {
        const core::NamePattern pattern(cases.files);
        if (const auto missed = near_misses(pattern, folder); !missed.empty()) {
            hint = std::to_string(missed.size()) + " come near, such as " + missed.front().string() + ": " +
                   pattern.why_not(missed.front(), folder);
        }
    }
    const std::string message = error.message() + "; nothing was added to " + file.string();
    if (error.kind() == "missing" || error.kind() == "duplicate") {
        throw core::InputError(error.kind(), message, {}, hint);
    }
    throw core::UsageError(error.kind(), message, {}, hint);
}

std::vector<std::pair<std::filesystem::path, std::string>> left_out(const std::filesystem::path& folder,
                                                                    const std::string& files) {
    const core::NamePattern pattern(files);
    std::vector<std::pair<std::filesystem::path, std::string>> list;
    for (const auto& missed : near_misses(pattern, folder)) {
        list.emplace_back(missed, pattern.why_not(missed, folder));
    }
    return list;
}

}  // namespace

AddedCases with_new_cases(const std::filesystem::path& folder, const NewCases& cases) {
    AddedCases added;
    added.file = folder / "study.toml";
    std::optional<Study> before;
    std::string text =
        "title = " +
        core::toml_string(
            std::filesystem::absolute(folder / ".").lexically_normal().parent_path().filename().string()) +
        "\n";
    if (std::filesystem::exists(added.file)) {
        text = core::read_file(added.file);
        before = Study::from_text(text, added.file);
    }
    const auto old_lines = std::count(text.begin(), text.end(), '\n');
    added.text = with_symmetry(std::move(text), cases.symmetry, before ? &*before : nullptr) + case_text(folder, cases);
    try {
        added.study = Study::from_text(added.text, added.file);
    } catch (const core::InputError& error) {
        say_of_new_lines(error, folder, cases, added.file, old_lines);
        throw;
    }
    added.count = added.study.cases.size() - (before ? before->cases.size() : 0);
    added.left_out = left_out(folder, cases.files);
    return added;
}

void write_added(const AddedCases& added) {
    const core::ReplacingAllowed of_the_user;  // who asked for it
    core::write_file(added.file, added.text);
}

}  // namespace underbody::cases
