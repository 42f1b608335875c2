// underbody import FILE... --out FILE.vtp: CFD exports as VTK files.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "postproc/summary.h"
#include "postproc/vtk_files.h"
#include "studio/cli/commands.h"
#include "studio/cli/field_options.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

namespace fs = std::filesystem;

/// Several inputs go into several outputs: OUT-NAME.ending.
fs::path output_for(const std::string& out, const std::string& file, bool several) {
    if (!several) {
        return out;
    }
    const fs::path path(out);
    return path.parent_path() / (path.stem().string() + "-" + fs::path(file).stem().string() + path.extension().string());
}

}  // namespace

void add_import_command(CLI::App& app, Shell& shell) {
    auto* command = app.add_subcommand("import", "CFD exports as VTK files: SI units, canonical array names");
    struct Options {
        std::vector<std::string> files;
        std::string out;
        std::vector<std::string> arrays;
        FieldOptions field;
    };
    auto options = std::make_shared<Options>();
    command->add_option("files", options->files, "CFD files, or patterns of names")->required();
    command->add_option("-o,--out", options->out, "what to write: .vtp surfaces, .vtu volumes, .vtm every zone a block")->required();
    command->add_option("--arrays", options->arrays, "arrays to keep, by their canonical or own names")
        ->delimiter(',')
        ->transform(trimmed_name);
    options->field.add_to(*command);
    command->footer(
        "Examples:\n"
        "  underbody import body.csv --out body.vtp\n"
        "  underbody import case.cas.h5 --out case.vtm --zones 'hull,base'\n"
        "  underbody import 'run-*.csv' --out all.vtp      writes all-run-1.vtp, all-run-2.vtp ...");
    shell.on(command, [&shell, options] {
        const Batch batch = find_files(options->files, "");
        shell.show(batch.problems);
        nlohmann::json written = nlohmann::json::array();
        for (const auto& file : batch.files) {
            postproc::ReadOptions read = options->field.read_options();
            read.zones = options->field.zones;
            read.arrays = options->arrays;
            const auto field = postproc::read_field(file.path, read, shell.progress());
            shell.show(field.problems);
            const fs::path out = output_for(options->out, file.path, batch.files.size() > 1);
            shell.show(postproc::write_vtk(field, out, shell.progress()));
            nlohmann::json entry = postproc::summarise(field);
            entry["out"] = out.string();
            written.push_back(std::move(entry));
            shell.print("wrote " + out.string());
        }
        if (shell.json) {
            shell.print_json(written.size() == 1 ? written.front() : nlohmann::json{{"files", written}});
        }
        return static_cast<int>(done);
    });
}

}  // namespace underbody::studio
