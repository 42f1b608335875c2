// underbody import FILE... --out FILE.vtp: CFD exports as VTK files.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "core/counted.h"
#include "core/text.h"
#include "postproc/field/summary.h"
#include "postproc/field/vtk_files.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

namespace fs = std::filesystem;

/// "case" of "a/case/" and of "a/case.csv"; `whole` with its ending.
std::string name_of(const std::string& file, bool whole) {
    fs::path path = fs::absolute(file).lexically_normal();
    path = path.has_filename() ? path : path.parent_path();
    return whole ? path.filename().string() : path.stem().string();
}

/// Its last `depth` folders and its name: "a-case".
std::string name_from(const std::string& file, std::size_t depth, bool whole) {
    fs::path path = fs::absolute(file).lexically_normal();
    path = path.has_filename() ? path : path.parent_path();
    std::string name = name_of(file, whole);
    for (std::size_t i = 0; i < depth && path.has_parent_path() && path.parent_path() != path.root_path(); ++i) {
        path = path.parent_path();
        name.insert(0, path.filename().string() + "-");
    }
    return name;
}

/// Several inputs go into several outputs: OUT-NAME.ending, with folders or endings before and behind NAME where files
/// share it.
std::vector<fs::path> outputs_for(const std::string& out, const std::vector<ConditionedFile>& files) {
    const fs::path path(out);
    if (files.size() == 1) {
        return {path};
    }
    for (const bool whole : {false, true}) {
        for (std::size_t depth = 0; depth < 16; ++depth) {
            std::vector<fs::path> outputs;
            std::set<fs::path> different;
            for (const auto& file : files) {
                outputs.push_back(
                    path.parent_path() /
                    (path.stem().string() + "-" + name_from(file.path, depth, whole) + path.extension().string()));
                different.insert(outputs.back());
            }
            if (different.size() == files.size()) {
                return outputs;
            }
        }
    }
    throw core::UsageError("usage", "a file is named twice, or several have one name: their outputs would be one", {},
                           "name each file once, or import them apart");
}

/// Before anything is written: no input may be lost.
void check_outputs(const std::vector<fs::path>& outputs, const std::vector<ConditionedFile>& files) {
    for (const auto& output : outputs) {
        postproc::check_vtk_ending(output);
        for (const auto& file : files) {
            std::error_code error;
            const fs::path input = fs::weakly_canonical(file.path, error);
            const bool in_blocks =
                output.extension() == ".vtm" &&
                input.parent_path() == fs::weakly_canonical(fs::path(output).replace_extension(""), error);
            if (fs::equivalent(output, file.path, error) || in_blocks) {
                throw core::UsageError(
                    "usage", "'" + output.string() + "' would be written over '" + file.path + "', which is to be read",
                    {}, "name another --out");
            }
        }
    }
}

/// Names of --arrays that fit nothing: a list for several files may name more than each has, but a slip of the pen
/// loses an array.
void show_missing_arrays(Shell& shell, const postproc::Field& field, const std::vector<std::string>& wanted) {
    for (const auto& name : wanted) {
        const bool found = std::any_of(field.zones.begin(), field.zones.end(), [&](const postproc::Zone& zone) {
            return std::any_of(zone.arrays.begin(), zone.arrays.end(), [&](const postproc::ArrayInfo& info) {
                return postproc::matches(name, info.name) ||
                       core::lower_case(info.original_name).find(core::lower_case(name)) != std::string::npos;
            });
        });
        if (!found && name.find_first_of("*?") == std::string::npos) {
            shell.show_warning(field.files.front() + ": there is no array '" + name + "'");
        }
    }
}

/// What is not a number goes into the file as it is: who draws or sums it has to know.
void show_missing_values(Shell& shell, const postproc::FieldSummary& summary) {
    for (const auto& array : summary.arrays) {
        if (array.missing > 0) {
            shell.show_warning(summary.file + ": '" + array.name + "' has " +
                               core::counted(array.missing, "value that is", "values that are") +
                               " not a number: written as NaN");
        }
    }
}

/// Folders that were not there: a name misspelt makes one.
void show_new_folder(Shell& shell, const fs::path& output) {
    std::error_code error;
    if (output.has_parent_path() && !fs::exists(output.parent_path(), error)) {
        shell.info("made the folder '" + output.parent_path().string() + "', which was not there");
    }
}

/// What a batch leaves behind when a file of it fails.
std::string those_written(const nlohmann::json& written, std::size_t all) {
    std::string names;
    for (const auto& entry : written) {
        names += (names.empty() ? "" : ", ") + entry["out"].get<std::string>();
    }
    return "written before: " + names + "; the other " + core::counted(all - written.size(), "file") + " were not";
}

struct ImportArguments {
    std::vector<std::string> files;
    std::string out;
    std::vector<std::string> arrays;
    FieldOptions field;
};

int run_import(Shell& shell, const ImportArguments& options) {
    const Batch batch = find_files(options.files, "", options.field.zones);
    shell.show(batch.problems);
    const auto outputs = outputs_for(options.out, batch.files);
    check_outputs(outputs, batch.files);
    nlohmann::json written = nlohmann::json::array();
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const std::string& file = batch.files[i].path;
        try {
            postproc::ReadOptions read = options.field.read_options();
            read.zones = options.field.zones;
            read.arrays = options.arrays;
            const auto field = shell.read_field(file, read);
            shell.show(field.problems);
            show_missing_arrays(shell, field, options.arrays);
            show_new_folder(shell, outputs[i]);
            shell.show(postproc::write_vtk(field, outputs[i], shell.progress()));
            const postproc::FieldSummary summary = postproc::summarise(field);
            show_missing_values(shell, summary);
            nlohmann::json entry = summary;
            entry["out"] = outputs[i].string();
            written.push_back(std::move(entry));
        } catch (const core::Error&) {
            if (!written.empty()) {
                shell.warn(those_written(written, outputs.size()));
            }
            throw;
        }
        shell.print("wrote " + outputs[i].string());
    }
    if (shell.json) {
        shell.print_json(written.size() == 1 ? written.front() : nlohmann::json{{"files", written}});
    }
    return done;
}

}  // namespace

void add_import_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("import", "CFD exports as VTK files: SI units, canonical array names");
    auto options = std::make_shared<ImportArguments>();
    command->add_option("files", options->files, "CFD files, or patterns of names")->required();
    command->add_option("-o,--out", options->out, "what to write: .vtp surfaces, .vtu volumes, .vtm every zone a block")
        ->required();
    command->add_option("--arrays", options->arrays, "arrays to keep, by their canonical or own names")
        ->delimiter(',')
        ->transform(trimmed_name);
    options->field.add_to(*command);
    command->footer(
        "Examples:\n"
        "  underbody import body.csv --out body.vtp\n"
        "  underbody import case.cas.h5 --out case.vtm --zones 'hull,base'\n"
        "  underbody import 'run-*.csv' --out all.vtp      writes all-run-1.vtp, all-run-2.vtp ...\n"
        "  underbody import a/body.csv b/body.csv --out all.vtp      writes all-a-body.vtp, all-b-body.vtp");
    shell.on(command, [&shell, options] { return run_import(shell, *options); });
}

}  // namespace underbody::studio
