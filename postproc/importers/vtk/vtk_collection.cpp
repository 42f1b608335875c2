// ParaView's collections: a list of VTK files with their times, several at one time where they are parts.
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "core/text.h"
#include "postproc/field/times.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/linked_files.h"
#include "postproc/importers/mesh/steps.h"
#include "postproc/importers/vtk/vtk_problems.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

struct Piece {
    double time = 0;
    std::string part, file;
};

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& hint = {}) {
    throw core::InputError("format", what, {path.string(), {}, {}, {}}, hint);
}

std::string attribute(vtkXMLDataElement& element, const char* name) {
    const char* text = element.GetAttribute(name);
    return text != nullptr ? text : "";
}

std::vector<Piece> pieces_in(const fs::path& path) {
    const std::string text = core::read_file(path);
    const VtkProblems problems;
    auto root = vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromString(text.c_str()));
    auto* list = root != nullptr ? root->FindNestedElementWithName("Collection") : nullptr;
    if (list == nullptr) {
        fail(path, "the collection cannot be read: " + problems.first(), "the file is cut short or damaged");
    }
    std::vector<Piece> pieces;
    for (int i = 0; i < list->GetNumberOfNestedElements(); ++i) {
        vtkXMLDataElement& element = *list->GetNestedElement(i);
        const std::string time = attribute(element, "timestep");
        const auto number = time.empty() ? std::optional(0.0) : core::parse_number(time);
        Piece piece{number.value_or(std::nan("")), attribute(element, "part"), attribute(element, "file")};
        if (!std::isfinite(piece.time) || piece.file.empty()) {
            fail(path, "entry " + std::to_string(i + 1) + " of the collection has " +
                           (piece.file.empty() ? std::string("no file") : "no time: timestep=\"" + time + "\""));
        }
        pieces.push_back(std::move(piece));
    }
    if (pieces.empty()) {
        fail(path, "the collection names no files");
    }
    return pieces;
}

/// One of VTK's own files, not another collection.
Field read_piece(const fs::path& collection, const std::string& name, const ReadOptions& options,
                 core::Progress& progress) {
    note_linked(collection, name);
    const fs::path path = collection.parent_path() / name;
    std::error_code none;
    if (!fs::is_regular_file(path, none)) {
        throw core::InputError("missing", "the file '" + name + "' of this collection is not there",
                               {collection.string(), {}, {}, {}});
    }
    const Importer* importer = importer_for(path);
    if (importer == nullptr || !importer->format.starts_with("VTK")) {
        fail(collection, "'" + name + "' is no file of VTK", "a collection lists .vtu, .vtp, .vtm, .vtk and the like");
    }
    return importer->read(path, options, progress);
}

/// The zones of a part, under names that are the same at all times.
void take_part(Field& field, Field&& part, const fs::path& path, const std::string& file, const std::string& prefix) {
    for (auto& zone : part.zones) {
        if (zone.name == fs::path(file).stem().string()) {
            zone.name = prefix.empty() ? path.stem().string() : prefix;
        } else if (!prefix.empty()) {
            zone.name.insert(0, prefix + "/");
        }
        zone.id = static_cast<int>(field.zones.size()) + 1;
        field.zones.push_back(std::move(zone));
    }
    field.problems.insert(field.problems.end(), part.problems.begin(), part.problems.end());
    field.files.push_back((path.parent_path() / file).string());
}

Field read(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const auto pieces = pieces_in(path);
    std::vector<double> times;
    for (const auto& piece : pieces) {
        times.push_back(piece.time);
    }
    std::vector<double> apart = times;
    std::sort(apart.begin(), apart.end());
    apart.erase(std::unique(apart.begin(), apart.end()), apart.end());
    const double time = options.time ? times[step_at(times, *options.time, path.string())] : apart.back();
    const auto parts = std::count(times.begin(), times.end(), time);
    ReadOptions of_all = options;
    of_all.zones.clear();  // their names are made here
    of_all.time.reset();
    Field field;
    for (const auto& piece : pieces) {
        if (piece.time != time) {
            continue;
        }
        Field part = read_piece(path, piece.file, of_all, progress);
        if (field.files.empty()) {
            field.files = {path.string()};
            field.dimension = part.dimension;
            field.writer = part.writer;
            field.density = part.density;
            field.pressure = part.pressure;
            field.metadata = part.metadata;
        }
        take_part(field, std::move(part), path, piece.file,
                  parts < 2 ? "" : "part " + (piece.part.empty() ? std::to_string(field.files.size()) : piece.part));
    }
    field.format = "ParaView collection";
    std::erase_if(field.zones, [&](const Zone& zone) { return !matches_any(options.zones, zone.name); });
    if (apart.size() > 1) {
        field.metadata.emplace_back("time", core::format_number(time));
        state_times(field, apart);
    }
    if (apart.size() > 1 && !options.time) {
        field.problems.push_back({core::Problem::Severity::note,
                                  "the last of " + std::to_string(apart.size()) + " time steps is read",
                                  {path.string(), {}, {}, {}}});
    }
    return field;
}

bool recognises(std::string_view head, const fs::path& /*path*/) {
    const std::size_t at = head.find("<VTKFile");
    const std::size_t end = at == std::string_view::npos ? at : head.find('>', at);
    return at < 1024 && head.substr(at, end - at).find("\"Collection\"") != std::string_view::npos;
}

}  // namespace

Importer paraview_collection_importer() { return {"ParaView collection", recognises, read}; }

}  // namespace underbody::postproc
