// Importer of Fluent's common fluids format (.msh.h5, .cas.h5, .dat.h5): finds which file is which, and its partner.
#include "postproc/importers/fluent/fluent_hdf5.h"

#include "core/inputs.h"
#include "core/text.h"
#include "postproc/importers/companion_file.h"
#include "postproc/importers/fluent/fluent_variables.h"
#include "postproc/importers/hdf5/hdf5_file.h"
#include "postproc/importers/importer.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8);

bool recognises(std::string_view head, const fs::path& path) {
    if (!head.starts_with(signature)) {
        return false;
    }
    try {
        const Hdf5File file(path);
        return file.has("/meshes/1") || file.has("/results/1");
    } catch (const core::InputError&) {
        // Cut short: who else writes such endings?
        const std::string name = core::lower_case(path.filename().string());
        return name.ends_with(".cas.h5") || name.ends_with(".dat.h5") || name.ends_with(".msh.h5");
    }
}

/// The files of a case and of its data, whichever of them was named.
struct CaseAndData {
    fs::path mesh, data;
    bool asked_for = false;  ///< the data: not only found beside the case
};

CaseAndData files_for(const fs::path& path, const ReadOptions& options) {
    const bool has_mesh = Hdf5File(path).has("/meshes/1");
    fs::path mesh_path = path;
    fs::path data_path = options.companion;
    const bool asked_for = !has_mesh || !options.companion.empty();
    if (has_mesh && data_path.empty()) {
        data_path = partner_by_name(path, {".cas.h5"}, {".dat.h5"}, false);
    }
    if (!has_mesh) {
        data_path = path;
        mesh_path =
            options.companion.empty() ? partner_by_name(path, {".dat.h5"}, {".cas.h5"}, true) : options.companion;
        if (mesh_path.empty()) {
            const std::string named = file_name_in(Hdf5File(path).text("/settings/Case File"));
            const fs::path beside = path.parent_path() / named;
            core::note_presence(beside);
            mesh_path = !named.empty() && fs::is_regular_file(beside) ? beside : fs::path();
        }
        if (mesh_path.empty()) {
            throw core::InputError("missing", "these are solution data without a mesh", {path.string(), {}, {}, {}},
                                   "name the case (.cas.h5) they belong to: option 'mesh FILE'");
        }
    }
    return {mesh_path, data_path, asked_for};
}

Field read(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const auto [mesh_path, data_path, asked_for] = files_for(path, options);
    if (!data_path.empty()) {
        // The data are tried in a process of its own: now, while there is little memory that it would have to share.
        try {
            Hdf5File early(data_path);
        } catch (const core::InputError&) {
            // said below, where it is known whether the data were asked for
        }
    }
    auto [mesh, settings] = read_hdf5_mesh(mesh_path, options, progress);
    if (!settings.variables.empty()) {
        mesh.length_unit = "m";
        mesh.length_unit_known = true;
    }
    core::Problems problems;
    std::vector<ValueBlock> values;
    bool with_data = false;
    if (!data_path.empty()) {
        progress.report(0.4, "reading " + data_path.filename().string());
        try {
            values = read_hdf5_data(data_path, mesh, options, settings, problems, progress);
            if (needs_pressure_of_cells(mesh, values, options)) {
                const ReadOptions again = for_pressure_of_cells(options);
                add_hdf5_cells(data_path, mesh, again, values, progress);
            }
            with_data = true;
        } catch (const core::InputError& error) {
            if (asked_for) {
                throw;
            }
            problems.push_back({core::Problem::Severity::error,
                                "the data beside this case are not used: " + error.message(), error.place()});
        }
    }
    Field field = field_from(std::move(mesh), std::move(values), options, progress);
    field.format = "Fluent HDF5";
    apply_settings(settings, with_data, field);
    if (with_data) {
        field.files.push_back(data_path.string());
    }
    field.problems.insert(field.problems.end(), problems.begin(), problems.end());
    return field;
}

}  // namespace

Importer fluent_hdf5_importer() { return {"Fluent HDF5", recognises, read}; }

}  // namespace underbody::postproc
