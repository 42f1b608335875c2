#include "postproc/importers/unknown_content.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <vector>

#include "core/text.h"
#include "postproc/importers/byte_stream.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/reports/reports.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

std::string head_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string head(std::size_t{1} << 16, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    return head;
}

struct Known {
    std::string_view begins;
    std::string_view means;
};

constexpr std::array known = {
    Known{"version https://git-lfs",
          "a pointer of Git LFS in place of the file, which was never fetched: git lfs pull"},
    Known{"$MeshFormat", "a mesh of Gmsh: save it as CGNS (gmsh FILE -save -format cgns)"},
    Known{"\xFF\xFE", "text in UTF-16: save it as UTF-8 (\"CSV UTF-8\")"},
    Known{"\xFE\xFF", "text in UTF-16: save it as UTF-8 (\"CSV UTF-8\")"},
    Known{"#!TDV", "a binary Tecplot file: save it as ASCII"},
    Known{"PK\x03\x04",
          "a packed archive (an Excel sheet, a Workbench project): unpack it, or save the sheet as CSV UTF-8"},
    Known{"%PDF", "a PDF"},
    Known{"CDF", "netCDF (Exodus): save it as VTK in ParaView"},
    Known{"((", "a boundary profile of Fluent: it is no surface; export the surface as ASCII, CGNS or EnSight"},
    Known{"<?xml", "XML of another kind than VTK's"},
};

/// A list of files over time, as foamToVTK and ParaView write it.
bool is_series(std::string_view text) { return text.find("file-series-version") != std::string_view::npos; }

std::string of_text(std::string_view text) {
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const Known& kind) { return text.starts_with(kind.begins); });
    if (found != known.end()) {
        return std::string(found->means);
    }
    if (is_series(text)) {
        return "a list of files over time: give one of the files that it names";
    }
    if (text.starts_with("FORMAT") &&
        core::lower_case(text.substr(0, 400)).find("master_server") != std::string::npos) {
        return "the list of an EnSight export in several parts (.sos): give one of the .case files that it names";
    }
    const bool ensight = core::lower_case(text.substr(0, 400)).find("node id") != std::string::npos;
    return ensight ? "a geometry of EnSight: give the .case (.encas) that names it" : "";
}

/// The folder of an OpenFOAM case to which a folder, a .foam file or a controlDict belongs; empty: to none.
fs::path foam_case_of(const fs::path& path) {
    std::error_code error;
    const fs::path whole = fs::absolute(path).lexically_normal();
    for (const fs::path& folder : {whole, whole.parent_path(), whole.parent_path().parent_path()}) {
        if (fs::is_regular_file(folder / "system" / "controlDict", error)) {
            return folder;
        }
    }
    return {};
}

std::string without_mesh(const fs::path& path) {
    const fs::path folder = foam_case_of(path);
    std::error_code error;
    const bool whole = folder.empty() || fs::is_directory(folder / "constant" / "polyMesh", error);
    return whole ? ""
                 : "an OpenFOAM case without a mesh: there is no constant/polyMesh in it (make the mesh, blockMesh for "
                   "instance, or copy that folder too)";
}

/// A folder of files that can be read one by one, or of nothing that can.
std::string of_files(const fs::path& path) {
    std::vector<std::string> readable;
    std::size_t others = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(path, error)) {
        const Importer* importer = entry.is_regular_file(error) ? importer_for(entry.path()) : nullptr;
        if (importer != nullptr) {
            readable.push_back(entry.path().filename().string() + " (" + importer->format + ")");
        } else {
            ++others;
        }
    }
    if (readable.empty()) {
        return "a folder, and none of the " + std::to_string(others) +
               (others == 1 ? " entry in it is" : " entries in it is") + " a file of a known format";
    }
    std::sort(readable.begin(), readable.end());
    std::string names;
    constexpr std::size_t most = 5;
    for (std::size_t i = 0; i < std::min(most, readable.size()); ++i) {
        names += (i == 0 ? "" : ", ") + readable[i];
    }
    return "a folder of files: " + names +
           (readable.size() > most ? " and " + std::to_string(readable.size() - most) + " more" : "") +
           "; name one of them, or several by a pattern in quotes, such as \"" + (path / "*").string() + "\"";
}

std::string of_folder(const fs::path& path) {
    std::error_code error;
    if (fs::is_empty(path, error) && !error) {
        return "an empty folder";
    }
    std::vector<std::string> regions;
    for (const auto& entry : fs::directory_iterator(path / "constant", error)) {
        if (fs::is_directory(entry.path() / "polyMesh", error)) {
            regions.push_back(entry.path().filename().string());
        }
    }
    std::sort(regions.begin(), regions.end());
    if (!regions.empty()) {
        std::string names;
        for (const auto& region : regions) {
            names += (names.empty() ? "" : ", ") + region;
        }
        return "an OpenFOAM case of the regions " + names + ", which are not read: write them with foamToVTK -region " +
               regions.front();
    }
    for (const auto& entry : fs::directory_iterator(path, error)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("processors") && entry.is_directory(error)) {
            return "an OpenFOAM case with the files of all processors in one (" + name +
                   "): put it together with reconstructPar";
        }
    }
    const std::string foam = without_mesh(path);
    return foam.empty() ? of_files(path) : foam;
}

}  // namespace

bool has_lone_returns(const fs::path& path) {
    const std::string head = head_of(path);
    return head.find('\r') != std::string::npos && head.find('\n') == std::string::npos &&
           std::all_of(head.begin(), head.end(), [](unsigned char c) {  // of a text
               return c >= ' ' || c == '\t' || c == '\r' || c == '\f';
           });
}

std::string what_it_is(const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
        return of_folder(path);
    }
    const std::string head = head_of(path);
    const bool of_a_case =
        path.extension() == ".foam" || path.extension() == ".OpenFOAM" || path.filename() == "controlDict";
    if (const std::string mesh = of_a_case ? without_mesh(path) : std::string(); !mesh.empty()) {
        return mesh;
    }
    if (head.starts_with("\x1F\x8B")) {
        const std::string inside = of_text(inflated_head(head));
        return "gzip: unpack it (gunzip -k " + path.filename().string() + ")" +
               (inside.empty() ? "" : "; inside is " + inside);
    }
    if (const std::string text = of_text(head); !text.empty()) {
        return text;
    }
    if (report_kinds(path).any()) {
        return "a report of the solver, no field: its summary is shown by 'info', and loads are compared with it as a "
               "report or a monitor";
    }
    return has_lone_returns(path)
               ? "text whose lines end in carriage returns alone: make them line feeds (tr '\\r' '\\n' < FILE > NEW)"
               : "";
}

}  // namespace underbody::postproc
