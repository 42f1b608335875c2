#include "studio/cli/field_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>

#include "core/error.h"
#include "core/inputs.h"
#include "core/name_pattern.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/importer.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace fs = std::filesystem;

std::string trimmed_name(const std::string& name) { return std::string(core::trimmed(name)); }

void FieldOptions::add_to(CLI::App& command, bool with_zones) {
    if (with_zones) {
        command
            .add_option("--zones", zones,
                        "zones to take: names, * and ? allowed; several with commas in one word (hull,base)")
            ->delimiter(',')
            ->transform(trimmed_name);
    }
    command.add_option("--length-unit", length_unit, "unit of coordinates that the file does not say (mm, inch ...)");
    command.add_option("--unit", units, "unit of a variable that the file does not say: \"Pressure=Pa\"");
    command.add_option("--mesh", mesh, "the mesh or case file that a results file belongs to")
        ->check(CLI::ExistingFile);
    command.add_option("--cgns-base", base,
                       "which base of a CGNS file with several: its name, or its number from 1; default: the last");
    command.add_option(
        "--time", time,
        "which time of a file with several (CGNS, EnSight, OpenFOAM): a time that it states; default: the last");
}

postproc::ReadOptions FieldOptions::read_options() const {
    postproc::ReadOptions options;
    options.length_unit = length_unit;
    options.companion = mesh;
    options.base = base;
    if (!time.empty()) {
        options.time = option_value("--time", time, "s");
    }
    for (const auto& text : units) {
        const auto equals = text.rfind('=');
        if (equals == std::string::npos || equals == 0) {
            throw core::UsageError("usage", "--unit '" + text + "' is no NAME=UNIT", {},
                                   "for instance --unit \"Pressure=Pa\"");
        }
        options.units.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
    return options;
}

namespace {

/// A folder is a file of ours where it is an OpenFOAM case.
bool is_other_folder(const fs::path& path) { return fs::is_directory(path) && postproc::importer_for(path) == nullptr; }

/// Names of files that fit but for a number, the first few, each with the reason.
std::string near_misses(const core::NamePattern& pattern) {
    constexpr std::size_t most = 5;
    auto paths = pattern.near_misses(".", true);
    std::erase_if(paths, is_other_folder);
    std::string list;
    for (std::size_t i = 0; i < std::min(most, paths.size()); ++i) {
        list += (i == 0 ? "" : ", ") + paths[i].string() + " (" + pattern.why_not(paths[i]) + ")";
    }
    return list + (paths.size() > most ? " and " + std::to_string(paths.size() - most) + " more" : "");
}

void add_pattern(const std::string& text, Batch& batch) {
    const core::NamePattern pattern(text);
    auto found = pattern.files_and_folders();
    const auto folder = std::find_if(found.begin(), found.end(),
                                     [](const auto& one) { return one.folder && is_other_folder(one.path); });
    const std::string other = folder == found.end() ? "" : folder->path.string();
    std::erase_if(found, [](const auto& one) { return one.folder && is_other_folder(one.path); });
    const std::string missed = near_misses(pattern);
    if (found.empty()) {
        throw core::InputError(
            "file", "no file fits the pattern '" + text + "'" + (missed.empty() ? "" : "; these come near: " + missed),
            {},
            other.empty() ? "patterns may hold *, ?, {name} and {name:unit}"
                          : "what fits is a folder, and no OpenFOAM case: '" + other + "'");
    }
    if (!missed.empty()) {
        batch.problems.push_back({core::Problem::Severity::warning,
                                  std::string(Shell::left_out_by_pattern) + " '" + text + "': " + missed,
                                  {}});
    }
    for (const auto& one : found) {
        batch.files.push_back({one.path.string(), one.match.numbers, one.match.texts, {}});
    }
    for (const auto& part : pattern.parts()) {
        if (part.kind == core::NamePattern::Part::Kind::number) {
            batch.number_units.emplace_back(part.value, part.unit);
        }
    }
}

void add_row(const core::Table& table, std::size_t row, ConditionedFile& file) {
    file.row = table.place(row, {});
    for (const auto& column : table.columns()) {
        if (column.name == "file") {
            continue;
        }
        if (column.is_text()) {
            file.texts.emplace_back(column.name, column.text[row]);
        } else {
            file.numbers.emplace_back(column.name, column.numbers[row]);
        }
    }
}

/// Conditions of a manifest: for the files that were named, or, when none were, for all that it lists.
void add_manifest(const std::string& path, Batch& batch) {
    const core::Table table = core::read_csv(fs::path(path));
    const auto& names = table.text("file");
    const bool all = batch.files.empty();
    using Identity = std::pair<std::uint64_t, std::uint64_t>;  // of a file, whatever its path
    const auto identity = [](const fs::path& file) {
        const core::FileStamp stamp = core::stamp_of(file);
        return Identity(stamp.device, stamp.inode);
    };
    std::multimap<Identity, std::size_t> given;
    for (std::size_t i = 0; i < batch.files.size(); ++i) {
        given.emplace(identity(batch.files[i].path), i);
    }
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if (names[row].empty()) {
            throw core::InputError("missing", "row " + std::to_string(row + 1) + " of the manifest names no file",
                                   {path, {}, {}, {}});
        }
        const fs::path listed = fs::path(path).parent_path() / names[row];
        if (all) {
            batch.files.push_back({listed.string(), {}, {}, {}});
            add_row(table, row, batch.files.back());
            continue;
        }
        const auto [first, last] = given.equal_range(fs::exists(listed) ? identity(listed) : Identity(0, 0));
        for (auto found = first; found != last; ++found) {
            auto& file = batch.files[found->second];
            if (fs::exists(file.path)) {
                if (!file.row.file.empty() || !file.numbers.empty() || !file.texts.empty()) {
                    throw core::InputError("manifest",
                                           "row " + std::to_string(row + 1) + " of the manifest lists '" + names[row] +
                                               "' once more, or a pattern gave its conditions already",
                                           {path, {}, {}, {}}, "one row a file, or no pattern with a manifest");
                }
                add_row(table, row, file);
            }
        }
    }
    for (const auto& column : table.columns()) {
        if (!column.is_text()) {
            batch.number_units.emplace_back(column.name, column.written_unit);
        }
    }
    for (const auto& file : batch.files) {
        if (file.row.file.empty()) {
            throw core::InputError("missing", "the manifest does not list '" + file.path + "'", {path, {}, {}, {}},
                                   core::did_you_mean(fs::path(file.path).filename().string(), names));
        }
    }
}

}  // namespace

Batch find_files(const std::vector<std::string>& arguments, const std::string& manifest,
                 const std::vector<std::string>& zones) {
    Batch batch;
    for (const auto& argument : arguments) {
        // No file, and named as zones are: a list of zones that was parted by spaces.
        if (!zones.empty() && !fs::exists(argument) && argument.find_first_of("./\\") == std::string::npos) {
            throw core::UsageError(
                "file", "there is no file '" + argument + "'", {},
                "were it a zone: several zones are one word, --zones '" + zones.back() + "," + argument + "'");
        }
        if (!fs::exists(argument) && core::NamePattern::is_pattern(argument)) {
            add_pattern(argument, batch);
        } else {
            batch.files.push_back({argument, {}, {}, {}});
        }
    }
    if (!manifest.empty()) {
        add_manifest(manifest, batch);
    }
    return batch;
}

}  // namespace underbody::studio
