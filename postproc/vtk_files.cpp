#include "postproc/vtk_files.h"

#include <vtkAppendFilter.h>
#include <vtkAppendPolyData.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>

#include "core/file.h"
#include "core/text.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

/// Units and origin travel with the data.
void describe(vtkDataObject& data, const Field& field, const std::vector<const Zone*>& zones) {
    vtkNew<vtkStringArray> origin;
    origin->SetName("origin");
    for (const auto& file : field.files) {
        origin->InsertNextValue(fs::path(file).filename().string() + " (" + field.format + ")");
    }
    vtkNew<vtkStringArray> units;
    units->SetName("units");
    std::vector<std::string> seen;
    vtkNew<vtkStringArray> names;
    names->SetName("zone_names");
    for (const Zone* zone : zones) {
        names->InsertNextValue(std::to_string(zone->id) + " " + zone->name);
        for (const auto& info : zone->arrays) {
            if (std::find(seen.begin(), seen.end(), info.name) == seen.end()) {
                seen.push_back(info.name);
                units->InsertNextValue(info.name + " [" + info.unit + "]");
            }
        }
    }
    data.GetFieldData()->AddArray(origin);
    data.GetFieldData()->AddArray(units);
    data.GetFieldData()->AddArray(names);
}

void mark_zone(vtkDataSet& data, int id) {
    vtkNew<vtkIntArray> zone;
    zone->SetName("zone");
    zone->SetNumberOfTuples(data.GetNumberOfCells());
    zone->Fill(id);
    data.GetCellData()->AddArray(zone);
}

template <typename Writer, typename Data>
void write_whole(Data& data, const fs::path& path) {
    core::PendingFile pending(path);
    vtkNew<Writer> writer;
    writer->SetFileName(pending.path().c_str());
    writer->SetInputData(&data);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    if (writer->Write() == 0 || writer->GetErrorCode() != 0) {
        throw core::SystemError("write", "the file cannot be written (is the disk full?)", {path.string(), {}, {}, {}});
    }
    pending.commit();
}

void note_lost_arrays(const std::vector<const Zone*>& zones, vtkDataSet& joined, core::Problems& problems) {
    std::vector<std::string> told;
    for (const Zone* zone : zones) {
        for (const auto& info : zone->arrays) {
            const bool kept = joined.GetPointData()->HasArray(info.name.c_str()) != 0 || joined.GetCellData()->HasArray(info.name.c_str()) != 0;
            if (!kept && std::find(told.begin(), told.end(), info.name) == told.end()) {
                told.push_back(info.name);
                problems.push_back({core::Problem::Severity::warning, "array '" + info.name + "' is left out: not every zone has it (a .vtm keeps it)", {}});
            }
        }
    }
}

core::Problems write_surfaces(const Field& field, const fs::path& path) {
    vtkNew<vtkAppendPolyData> append;
    std::vector<const Zone*> zones;
    for (const auto& zone : field.zones) {
        if (zone.surface != nullptr && zone.surface->GetNumberOfPoints() > 0) {
            vtkNew<vtkPolyData> copy;
            copy->ShallowCopy(zone.surface);
            mark_zone(*copy, zone.id);
            append->AddInputData(copy);
            zones.push_back(&zone);
        }
    }
    if (zones.empty()) {
        throw core::InputError("zone", "the file holds no surfaces, lines or points for a .vtp", {field.files.front(), {}, {}, {}}, "volumes go into a .vtu or .vtm");
    }
    append->Update();
    describe(*append->GetOutput(), field, zones);
    core::Problems problems;
    note_lost_arrays(zones, *append->GetOutput(), problems);
    write_whole<vtkXMLPolyDataWriter>(*append->GetOutput(), path);
    return problems;
}

core::Problems write_volumes(const Field& field, const fs::path& path) {
    vtkNew<vtkAppendFilter> append;
    std::vector<const Zone*> zones;
    const bool volumes = std::any_of(field.zones.begin(), field.zones.end(), [](const Zone& z) { return z.volume != nullptr; });
    for (const auto& zone : field.zones) {
        vtkDataSet* data = zone.volume != nullptr ? static_cast<vtkDataSet*>(zone.volume) : zone.surface.Get();
        if (data == nullptr || data->GetNumberOfPoints() == 0 || (volumes && zone.volume == nullptr)) {
            continue;
        }
        vtkSmartPointer<vtkDataSet> copy = vtk::TakeSmartPointer(data->NewInstance());
        copy->ShallowCopy(data);
        mark_zone(*copy, zone.id);
        append->AddInputData(copy);
        zones.push_back(&zone);
    }
    if (zones.empty()) {
        throw core::InputError("zone", "the file holds no points in space", {field.files.front(), {}, {}, {}});
    }
    append->Update();
    describe(*append->GetOutput(), field, zones);
    core::Problems problems;
    note_lost_arrays(zones, *append->GetOutput(), problems);
    write_whole<vtkXMLUnstructuredGridWriter>(*append->GetOutput(), path);
    return problems;
}

/// A file name of its own for each zone, whatever signs its name has.
std::string file_name(const Zone& zone, std::size_t index) {
    std::string name = std::to_string(index) + "-";
    for (const char c : zone.name) {
        name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '_';
    }
    return name.substr(0, 80) + (zone.volume != nullptr ? ".vtu" : ".vtp");
}

core::Problems write_blocks(const Field& field, const fs::path& path, core::Progress& progress) {
    const fs::path folder = fs::path(path).replace_extension("");
    std::string index = "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <vtkMultiBlockDataSet>\n";
    for (std::size_t i = 0; i < field.zones.size(); ++i) {
        progress.check();
        const Zone& zone = field.zones[i];
        const std::string name = file_name(zone, i);
        if (zone.volume != nullptr) {
            vtkNew<vtkUnstructuredGrid> copy;
            copy->ShallowCopy(zone.volume);
            describe(*copy, field, {&zone});
            write_whole<vtkXMLUnstructuredGridWriter>(*copy, folder / name);
        } else if (zone.surface != nullptr) {
            vtkNew<vtkPolyData> copy;
            copy->ShallowCopy(zone.surface);
            describe(*copy, field, {&zone});
            write_whole<vtkXMLPolyDataWriter>(*copy, folder / name);
        }
        index += "    <DataSet index=\"" + std::to_string(i) + "\" name=\"" + core::escape_html(zone.name) + "\" file=\"" +
                 core::escape_html((folder.filename() / name).string()) + "\"/>\n";
    }
    core::write_file(path, index + "  </vtkMultiBlockDataSet>\n</VTKFile>\n");
    return {};
}

}  // namespace

core::Problems write_vtk(const Field& field, const fs::path& path, core::Progress& progress) {
    const std::string ending = core::lower_case(path.extension().string());
    if (ending == ".vtp") {
        return write_surfaces(field, path);
    }
    if (ending == ".vtu") {
        return write_volumes(field, path);
    }
    if (ending == ".vtm") {
        return write_blocks(field, path, progress);
    }
    throw core::UsageError("usage", "'" + ending + "' is no ending that is written", {path.string(), {}, {}, {}}, "write to a .vtu, .vtp or .vtm");
}

}  // namespace underbody::postproc
