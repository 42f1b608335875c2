// Importer of legacy Fluent cases, meshes and data: finds which file is which, and its partner.
#include <algorithm>
#include <fstream>
#include <iterator>

#include "postproc/importers/companion_file.h"
#include "postproc/importers/fluent/fluent_legacy.h"
#include "postproc/importers/fluent/fluent_variables.h"
#include "postproc/importers/importer.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

bool is_blank(char c) { return static_cast<unsigned char>(c) <= ' '; }

/// "(0 ", "(13(", "(1 ...": an opening bracket, a small decimal number, and then a blank, a quote or a bracket.
bool begins_with_section(std::string_view head) {
    std::size_t i = head.starts_with("\xEF\xBB\xBF") ? 3 : 0;  // what some editors put in front
    while (i < head.size() && is_blank(head[i])) {
        ++i;
    }
    if (i >= head.size() || head[i] != '(') {
        return false;
    }
    std::size_t digits = 0;
    for (++i; i < head.size() && head[i] >= '0' && head[i] <= '9'; ++i) {
        ++digits;
    }
    return digits > 0 && digits < 5 && i < head.size() && (is_blank(head[i]) || head[i] == '"' || head[i] == '(');
}

std::string head_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string head(64 * 1024, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    return inflated_head(head);
}

bool recognises(std::string_view head, const fs::path& /*path*/) { return begins_with_section(inflated_head(head)); }

/// Data state the size of their grid and have no nodes of their own.
bool is_data(const fs::path& path) {
    const std::string head = head_of(path);
    const std::size_t size =
        std::min({head.find("(33 ("), head.find("(33("), head.find("(300 ("), head.find("300 (1 ")});
    const std::size_t mesh = std::min({head.find("(10 ("), head.find("(10("), head.find("(12 ("), head.find("(13 ("),
                                       head.find("(13("), head.find("(37 (\n")});
    return size != std::string::npos && size < mesh;
}

struct Files {
    fs::path mesh;
    fs::path data;  ///< empty: none
    bool data_asked_for = false;
};

Files files_of(const fs::path& path, const ReadOptions& options) {
    if (is_data(path)) {
        fs::path mesh = options.companion;
        if (mesh.empty()) {
            mesh = partner_by_name(path, {".dat", ".dat.gz"}, {".cas", ".cas.gz"}, true);
        }
        if (mesh.empty()) {
            throw core::InputError("missing", "these are solution data without a mesh", {path.string(), {}, {}, {}},
                                   "name the case (.cas) they belong to: option 'mesh FILE'");
        }
        return {mesh, path, true};
    }
    if (!options.companion.empty()) {
        return {path, options.companion, true};
    }
    return {path, partner_by_name(path, {".cas", ".cas.gz"}, {".dat", ".dat.gz"}, false), false};
}

Field read(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const Files files = files_of(path, options);
    progress.report(0, "reading " + files.mesh.filename().string());
    LegacyMesh legacy;
    {
        ByteStream stream(files.mesh);
        legacy = read_legacy_mesh(stream, options.surfaces_only, progress);
    }
    core::Problems problems;
    std::vector<ValueBlock> values;
    bool with_data = false;
    if (!files.data.empty()) {
        progress.report(0.4, "reading " + files.data.filename().string());
        try {
            ByteStream stream(files.data);
            values = read_legacy_data(stream, legacy.mesh, options, legacy.settings, problems, progress);
            if (needs_pressure_of_cells(legacy.mesh, values, options)) {
                FluentSettings known;
                core::Problems told;
                const ReadOptions again = for_pressure_of_cells(options);
                ByteStream once_more(files.data);
                auto cells = read_legacy_data(once_more, legacy.mesh, again, known, told, progress);
                std::erase_if(cells, [](const ValueBlock& block) { return !block.on_cells; });
                std::move(cells.begin(), cells.end(), std::back_inserter(values));
            }
            with_data = true;
        } catch (const core::InputError& error) {
            if (files.data_asked_for) {
                throw;
            }
            values.clear();
            problems.push_back({core::Problem::Severity::error,
                                "the data beside this case are not used: " + std::string(error.message()),
                                error.place()});
        }
    }
    Field field = field_from(std::move(legacy.mesh), std::move(values), options, progress);
    field.format = "Fluent legacy";
    apply_settings(legacy.settings, with_data, field);
    if (with_data) {
        field.files.push_back(files.data.string());
    }
    field.problems.insert(field.problems.end(), problems.begin(), problems.end());
    return field;
}

}  // namespace

Importer fluent_legacy_importer() { return {"Fluent legacy", recognises, read}; }

}  // namespace underbody::postproc
