#include "postproc/field/field.h"

#include <vtkCellData.h>
#include <vtkPointData.h>

#include <algorithm>
#include <fstream>

#include "core/inputs.h"
#include "core/utf8.h"
#include "postproc/importers/import_context.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/options_used.h"
#include "postproc/importers/unknown_content.h"

namespace underbody::postproc {

namespace fs = std::filesystem;

std::string to_string(ZoneKind kind) {
    switch (kind) {
        case ZoneKind::wall:
            return "wall";
        case ZoneKind::inlet:
            return "inlet";
        case ZoneKind::outlet:
            return "outlet";
        case ZoneKind::symmetry:
            return "symmetry";
        case ZoneKind::periodic:
            return "periodic";
        case ZoneKind::interface:
            return "interface";
        case ZoneKind::interior:
            return "interior";
        case ZoneKind::farfield:
            return "farfield";
        case ZoneKind::fluid:
            return "fluid";
        case ZoneKind::solid:
            return "solid";
        case ZoneKind::line:
            return "line";
        case ZoneKind::points:
            return "points";
        case ZoneKind::other:
            return "other";
        case ZoneKind::unknown:
            break;
    }
    return "unknown";
}

std::string to_string(Location location) {
    switch (location) {
        case Location::nodes:
            return "nodes";
        case Location::faces:
            return "faces";
        case Location::cells:
            break;
    }
    return "cells";
}

const ArrayInfo* Zone::find(const std::string& array) const {
    for (const auto& info : arrays) {
        if (info.name == array) {
            return &info;
        }
    }
    return nullptr;
}

const Zone* Field::find(const std::string& zone) const {
    for (const auto& candidate : zones) {
        if (candidate.name == zone) {
            return &candidate;
        }
    }
    return nullptr;
}

namespace {

std::string head_of(const fs::path& path) {
    constexpr std::size_t most = 64 * 1024;
    std::ifstream file(path, std::ios::binary);
    std::string head(most, '\0');
    file.read(head.data(), static_cast<std::streamsize>(most));
    head.resize(static_cast<std::size_t>(file.gcount()));
    return head;
}

std::string known_formats() {
    std::string text;
    for (const auto& importer : importers()) {
        text += (text.empty() ? "" : ", ") + importer.format;
    }
    return text;
}

/// Names go into JSON, XML and figures, which take nothing else.
void make_names_utf8(Field& field) {
    const auto rename = [](vtkDataSetAttributes& data, const std::string& from, const std::string& to) {
        if (vtkAbstractArray* array = data.GetAbstractArray(from.c_str()); array != nullptr) {
            array->SetName(to.c_str());
        }
    };
    for (auto& zone : field.zones) {
        zone.name = core::as_utf8(zone.name);
        zone.original_kind = core::as_utf8(zone.original_kind);
        for (auto& info : zone.arrays) {
            const std::string name = core::as_utf8(info.name);
            for (vtkDataSet* data : {static_cast<vtkDataSet*>(zone.surface), static_cast<vtkDataSet*>(zone.volume)}) {
                if (data != nullptr && name != info.name) {
                    rename(*data->GetPointData(), info.name, name);
                    rename(*data->GetCellData(), info.name, name);
                }
            }
            info.name = name;
            info.original_name = core::as_utf8(info.original_name);
            info.original_unit = core::as_utf8(info.original_unit);
        }
    }
    field.writer = core::as_utf8(field.writer);
    for (auto& [key, value] : field.metadata) {
        key = core::as_utf8(key);
        value = core::as_utf8(value);
    }
    for (auto& problem : field.problems) {
        problem.message = core::as_utf8(problem.message);
    }
}

}  // namespace

const Importer* importer_for(const fs::path& path) {
    const bool folder = fs::is_directory(path);
    const std::string head = folder ? std::string() : head_of(path);
    for (const auto& importer : importers()) {
        if (importer.recognises(head, path)) {
            return &importer;
        }
    }
    return nullptr;
}

void require_readable(const fs::path& path, const fs::file_status& status, const core::Place& place) {
    std::error_code error;
    if (!fs::exists(status)) {
        std::vector<std::string> names;
        const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
        for (const auto& entry : fs::directory_iterator(folder, error)) {
            names.push_back(entry.path().filename().string());
        }
        const std::string near = core::nearest_name(path.filename().string(), names);
        throw core::InputError("file", "there is no such file", place,
                               near.empty() ? "" : "did you mean '" + near + "'?");
    }
    if (fs::is_regular_file(status)) {
        if (!std::ifstream(path, std::ios::binary)) {
            throw core::InputError("file", "the file cannot be read", place, "check its permissions");
        }
    }
}

Field read_field(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const core::Place place{path.string(), {}, {}, {}};
    core::note_content(path);
    std::error_code error;
    const auto status = fs::status(path, error);
    require_readable(path, status, place);
    const Importer* importer = importer_for(path);
    if (importer == nullptr) {
        const std::string known = what_it_is(path);
        if (known.empty() && fs::is_regular_file(status) && fs::file_size(path, error) == 0) {
            throw core::InputError("format", "the file is empty",
                                   place);  // an empty NAME.foam stands for the case around it
        }
        throw core::InputError("format", "unrecognised file format: no importer knows this content", place,
                               known.empty() ? "known formats: " + known_formats() : "it looks like " + known);
    }
    progress.report(0, "reading " + path.filename().string());
    refuse_useless_options(importer->format, options, place);
    ReadOptions asking = options;
    asking.asked_units = std::make_shared<AskedUnits>();
    const auto read = [&] {
        try {
            return telling([&] { return importer->read(path, asking, progress); },
                           [&] { return "the format, " + importer->format + ", nothing else yet"; });
        } catch (const core::InputError&) {
            if (fs::is_regular_file(status) && has_lone_returns(path)) {
                throw core::InputError("format", "its lines end in carriage returns alone", place,
                                       "make them line feeds: tr '\\r' '\\n' < FILE > NEW");
            }
            throw;
        }
    };
    Field field = read();
    check_options_used(field, asking, place);
    // The file that the user named stands first, whichever of a pair that is.
    const auto own = std::find_if(field.files.begin(), field.files.end(),
                                  [&](const std::string& file) { return fs::equivalent(file, path, error); });
    if (own != field.files.end()) {
        std::rotate(field.files.begin(), own, own + 1);
    }
    make_names_utf8(field);
    const auto is_time = [](const auto& entry) { return entry.first == "time"; };
    if (options.time && std::none_of(field.metadata.begin(), field.metadata.end(), is_time)) {
        field.problems.push_back(
            {core::Problem::Severity::warning, "the file states no times: the time asked for chose nothing", place});
    }
    progress.report(1, "read " + path.filename().string());
    return field;
}

}  // namespace underbody::postproc
