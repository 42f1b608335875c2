// underbody study add: cases for a study, or the beginning of one.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/name_pattern.h"
#include "core/own_files.h"
#include "core/text.h"
#include "core/toml.h"
#include "studio/cli/study_parts.h"

namespace underbody::studio {

namespace {

/// Files that the pattern passes over though they look as if they were meant, each with the reason.
nlohmann::json left_out(const StudyArguments& arguments, Shell& shell) {
    constexpr std::size_t most = 8;
    const core::NamePattern pattern(arguments.files);
    const auto missed = pattern.near_misses(arguments.folder);
    nlohmann::json list = nlohmann::json::array();
    std::string text = missed.empty() ? ""
                                      : std::to_string(missed.size()) +
                                            (missed.size() == 1 ? " file is" : " files are") + " left out:";
    for (std::size_t i = 0; i < missed.size(); ++i) {
        const std::string why = pattern.why_not(missed[i], arguments.folder);
        list.push_back({{"file", missed[i].string()}, {"why", why}});
        text += i < most ? "\n  " + missed[i].string() + ": " + why : "";
    }
    text += missed.size() > most ? "\n  and " + std::to_string(missed.size() - most) + " more" : "";
    if (!missed.empty()) {
        shell.print(text);
    }
    return list;
}

/// The text with `symmetry` under [frame]. Throws core::UsageError when it says another plane already.
std::string with_symmetry(std::string text, const std::string& symmetry, const cases::Study* before) {
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
std::string design_points_of(const StudyArguments& arguments) {
    if (arguments.design_points.empty() && arguments.parameters.empty()) {
        return {};
    }
    if (arguments.design_points.empty()) {
        throw core::UsageError("usage", "--parameter belongs to --design-points", {},
                               "--design-points points.csv --parameter P1=gap");
    }
    const std::filesystem::path table =
        std::filesystem::absolute(arguments.design_points)
            .lexically_relative(std::filesystem::absolute(arguments.folder).lexically_normal());
    std::string text = "design_points = " + core::toml_string(table.string()) + "\n";
    for (const auto& parameter : arguments.parameters) {
        const std::size_t equal = parameter.find('=');
        if (equal == std::string::npos) {
            throw core::UsageError("parse", "'" + parameter + "' is not of the form PARAMETER=quantity", {},
                                   "--parameter \"P1=gap [mm]\", or --parameter P2= for none");
        }
        text += "parameters." + core::toml_string(core::trimmed(std::string_view(parameter).substr(0, equal))) + " = " +
                core::toml_string(core::trimmed(std::string_view(parameter).substr(equal + 1))) + "\n";
    }
    return text;
}

std::string case_text(const StudyArguments& arguments) {
    std::string text = "\n[[case]]\nfiles = " + core::toml_string(arguments.files) + "\n";
    std::string zones;
    for (const auto& zone : arguments.zones) {
        zones += (zones.empty() ? "" : ", ") + core::toml_string(zone);
    }
    text += zones.empty() ? "" : "zones = [" + zones + "]\n";
    for (const auto& condition : arguments.conditions) {
        const std::size_t equal = condition.find('=');
        if (equal == std::string::npos) {
            throw core::UsageError("parse", "'" + condition + "' is not of the form name=value", {},
                                   "--condition speed=0.5m/s");
        }
        text +=
            "conditions." + condition.substr(0, equal) + " = " + core::toml_string(condition.substr(equal + 1)) + "\n";
    }
    return text + design_points_of(arguments);
}

/// What is wrong stands in the lines to be added, which nobody has seen yet: says it without their place.
void say_of_new_lines(const core::InputError& error, const StudyArguments& arguments, const std::filesystem::path& file,
                      std::ptrdiff_t old_lines) {
    if (error.place().file != file.string() || error.place().line.value_or(0) <= old_lines) {
        return;
    }
    std::string hint = error.hint();
    if (error.kind() == "missing") {
        const core::NamePattern pattern(arguments.files);
        if (const auto missed = pattern.near_misses(arguments.folder); !missed.empty()) {
            hint = std::to_string(missed.size()) + " come near, such as " + missed.front().string() + ": " +
                   pattern.why_not(missed.front(), arguments.folder);
        }
    }
    const std::string message = error.message() + "; nothing was added to " + file.string();
    if (error.kind() == "missing" || error.kind() == "duplicate") {
        throw core::InputError(error.kind(), message, {}, hint);
    }
    throw core::UsageError(error.kind(), message, {}, hint);
}

/// Appends a [[case]] to study.toml (or starts one), checked before anything is written.
int add(Shell& shell, const StudyArguments& arguments) {
    const std::filesystem::path folder = arguments.folder;
    const std::filesystem::path file = folder / "study.toml";
    std::optional<cases::Study> before;
    std::string text =
        "title = " +
        core::toml_string(
            std::filesystem::absolute(folder / ".").lexically_normal().parent_path().filename().string()) +
        "\n";
    if (std::filesystem::exists(file)) {
        text = core::read_file(file);
        before = cases::Study::from_text(text, file);
    }
    const auto old_lines = std::count(text.begin(), text.end(), '\n');
    text = with_symmetry(std::move(text), arguments.symmetry, before ? &*before : nullptr) + case_text(arguments);
    std::size_t count = 0;
    nlohmann::json notes = nlohmann::json::array();
    try {
        const auto after = cases::Study::from_text(text, file);
        count = after.cases.size() - (before ? before->cases.size() : 0);
        show_notes(shell, after);
        notes = json_of_notes(after, {});
    } catch (const core::InputError& error) {
        say_of_new_lines(error, arguments, file, old_lines);
        throw;
    }
    const core::ReplacingAllowed of_the_user;  // who asked for it
    core::write_file(file, text);
    const nlohmann::json passed_over = left_out(arguments, shell);
    shell.print(std::to_string(count) + " cases added to " + file.string());
    if (shell.json) {
        shell.print_json({{"added", count}, {"study", file.string()}, {"left_out", passed_over}, {"notes", notes}});
    }
    return done;
}

}  // namespace

void add_study_add(CLI::App* study, std::shared_ptr<StudyArguments> arguments, Shell& shell) {
    auto* command = study->add_subcommand("add", "add cases to a study, or start one");
    command->add_option("study", arguments->folder, "folder of the study")->required();
    command->add_option("--files", arguments->files, "pattern of the files, relative to the study")->required();
    command->add_option("--condition", arguments->conditions, "name=value held for all of them (repeatable)");
    command->add_option("--symmetry", arguments->symmetry,
                        "half models: normal axis of their plane (y), written to [frame]");
    command
        ->add_option("--zones", arguments->zones,
                     "zones that are the body: names, * and ? allowed; several with commas in one word")
        ->delimiter(',');
    command->add_option("--design-points", arguments->design_points,
                        "Workbench's table of design points (CSV): the conditions of the files; {design_point} in "
                        "--files is the number behind dp");
    command->add_option("--parameter", arguments->parameters,
                        "of that table: P1=gap, \"P1=gap [mm]\", or P2= for no condition (repeatable)");
    shell.on(command, [arguments, &shell] { return add(shell, *arguments); });
}

}  // namespace underbody::studio
