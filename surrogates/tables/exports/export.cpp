#include "surrogates/tables/exports/export.h"

#include <algorithm>

#include "core/error.h"
#include "core/file.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

struct Exporter {
    ExportFormat format;
    void (*write)(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
};

const std::vector<Exporter>& exporters() {
    static const std::vector<Exporter> all = {
        {{"c", ".h", "C99 header: no heap, no library, constant time; double or float"}, export_c},
        {{"csv", ".csv", "table with slopes and error that this program reads back exactly"}, export_csv},
        {{"json", ".json", "grid, Hermite data and error"}, export_json},
        {{"mat", ".mat", "MATLAB and Octave: .mat and a .m that looks it up"}, export_mat},
        {{"jsbsim", ".xml", "JSBSim functions with tables, fine enough for its linear interpolation"}, export_jsbsim},
        {{"fmu", ".fmu", "FMU 2.0, model exchange and co-simulation, Linux x86-64, source included"}, export_fmu},
    };
    return all;
}

/// A file that is there is replaced only if this program wrote it.
void check_path(const std::filesystem::path& path, bool overwrite) {
    std::error_code ignored;
    if (path.empty()) {
        throw core::UsageError("path", "an export needs a path to write to");
    }
    if (std::filesystem::is_directory(path, ignored)) {
        throw core::InputError("exists", "this is a folder, an export is a file", {path.string(), {}, {}, {}});
    }
    if (!overwrite && std::filesystem::exists(path, ignored)) {
        const core::MappedFile file(path);
        const std::string_view bytes = file.bytes();
        if (!bytes.empty() && bytes.find("Underbody") == std::string_view::npos) {
            throw core::InputError("exists", "the file is there and was not written by Underbody", {path.string(), {}, {}, {}},
                                   "choose another name, or say --overwrite");
        }
    }
}

}  // namespace

const std::vector<ExportFormat>& export_formats() {
    static const std::vector<ExportFormat> formats = [] {
        std::vector<ExportFormat> list;
        for (const auto& exporter : exporters()) {
            list.push_back(exporter.format);
        }
        return list;
    }();
    return formats;
}

ExportResult export_table(const ForceTable& table, const std::string& format, const std::filesystem::path& path, const ExportOptions& options,
                          core::Progress& progress) {
    const auto found = std::find_if(exporters().begin(), exporters().end(), [&](const Exporter& e) { return e.format.name == format; });
    if (found == exporters().end()) {
        std::vector<std::string> names;
        for (const auto& f : export_formats()) {
            names.push_back(f.name);
        }
        throw core::UsageError("format", "there is no export format '" + format + "'", {}, core::did_you_mean(format, names));
    }
    check_path(path, options.overwrite);
    progress.report(0, "export");
    const ExportGrid grid = export_grid(table, options, progress);
    ExportResult result;
    result.files.push_back(path);
    result.error = grid.thinning_error;
    for (const auto& axis : grid.axes) {
        result.grid.push_back(axis.points.size());
    }
    found->write(grid, path, result);
    progress.report(1, "export");
    return result;
}

}  // namespace underbody::tables
