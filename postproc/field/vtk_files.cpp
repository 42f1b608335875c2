#include "postproc/field/vtk_files.h"

#include <vtkAppendFilter.h>
#include <vtkAppendPolyData.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkInformation.h>
#include <vtkInformationStringKey.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "postproc/field/vtk_description.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

/// A zone on its way into a file with others: its data may be changed, the zone's own not.
struct Joined {
    const Zone* zone = nullptr;
    vtkSmartPointer<vtkDataSet> data;
    int mark = 0;
};

Joined joined_from(const Zone& zone, vtkDataSet& data) {
    Joined joined{&zone, vtk::TakeSmartPointer(data.NewInstance()), zone.id};
    joined.data->ShallowCopy(&data);
    return joined;
}

std::vector<DescribedZone> described(const std::vector<Joined>& parts) {
    std::vector<DescribedZone> zones;
    for (const auto& part : parts) {
        DescribedZone one;
        one.zone = *part.zone;
        one.zone.surface = nullptr;
        one.zone.volume = nullptr;
        one.mark = part.mark;
        one.surface = part.zone->volume == nullptr;
        one.points = part.data->GetNumberOfPoints();
        one.cells = part.data->GetNumberOfCells();
        zones.push_back(std::move(one));
    }
    return zones;
}

/// For people: where the data come from, what the arrays are in, which number is which zone.
void describe_in_words(vtkDataObject& data, const Field& field, const std::vector<Joined>& parts) {
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
    for (const auto& part : parts) {
        names->InsertNextValue(std::to_string(part.mark) + " " + part.zone->name);
        for (const auto& info : part.zone->arrays) {
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

/// What VTK and ParaView know as the unit of an array.
void label_units(vtkDataSet& data, const std::vector<Joined>& parts) {
    for (const auto& part : parts) {
        for (const auto& info : part.zone->arrays) {
            for (vtkDataSetAttributes* attributes : {static_cast<vtkDataSetAttributes*>(data.GetPointData()),
                                                     static_cast<vtkDataSetAttributes*>(data.GetCellData())}) {
                if (vtkDataArray* array = attributes->GetArray(info.name.c_str());
                    array != nullptr && !info.unit.empty()) {
                    array->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), info.unit.c_str());
                }
            }
        }
    }
}

/// Units and origin travel with the data: for people, and for ourselves. Other programs' readers of unstructured grids
/// know numbers alone, and would refuse the file for a string.
void describe(vtkDataSet& data, const Field& field, const std::vector<Joined>& parts) {
    const bool numbers_alone = vtkUnstructuredGrid::SafeDownCast(&data) != nullptr;
    if (!numbers_alone) {
        describe_in_words(data, field, parts);
    }
    label_units(data, parts);
    describe_in(data, field, described(parts), numbers_alone);
}

/// Numbers its zones in its cells: by their ids, unless two have the same.
void mark_zones(std::vector<Joined>& parts) {
    std::set<int> ids;
    for (const auto& part : parts) {
        ids.insert(part.mark);
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (ids.size() < parts.size()) {
            parts[i].mark = static_cast<int>(i) + 1;
        }
        vtkNew<vtkIntArray> marks;
        marks->SetName(mark_name);
        marks->SetNumberOfTuples(parts[i].data->GetNumberOfCells());
        marks->Fill(parts[i].mark);
        parts[i].data->GetCellData()->AddArray(marks);
    }
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

void note_lost_arrays(const std::vector<Joined>& parts, vtkDataSet& joined, core::Problems& problems) {
    std::vector<std::string> told;
    for (const auto& part : parts) {
        for (const auto& info : part.zone->arrays) {
            const bool kept = joined.GetPointData()->HasArray(info.name.c_str()) != 0 ||
                              joined.GetCellData()->HasArray(info.name.c_str()) != 0;
            if (!kept && std::find(told.begin(), told.end(), info.name) == told.end()) {
                told.push_back(info.name);
                problems.push_back(
                    {core::Problem::Severity::warning,
                     "array '" + info.name + "' is left out: it is not of one kind in all zones (a .vtm keeps it)",
                     {}});
            }
        }
    }
}

/// What joins data sets keeps only arrays that all have: those that a zone lacks are not-a-number there.
void fill_up(std::vector<Joined>& parts, bool on_nodes, core::Problems& problems) {
    const auto data_of = [&](const Joined& part) {
        return on_nodes ? static_cast<vtkDataSetAttributes*>(part.data->GetPointData())
                        : static_cast<vtkDataSetAttributes*>(part.data->GetCellData());
    };
    std::map<std::string, vtkSmartPointer<vtkDataArray>> known;
    for (const auto& part : parts) {
        for (const auto& info : part.zone->arrays) {
            vtkDataArray* array = data_of(part)->GetArray(info.name.c_str());
            if (array != nullptr && (array->GetDataType() == VTK_DOUBLE || array->GetDataType() == VTK_FLOAT)) {
                known.try_emplace(info.name, array);
            }
        }
    }
    for (const auto& [name, like] : known) {
        std::string without;
        for (auto& part : parts) {
            if (data_of(part)->HasArray(name.c_str()) != 0) {
                continue;
            }
            auto nothing = vtk::TakeSmartPointer(like->NewInstance());
            nothing->SetName(name.c_str());
            nothing->SetNumberOfComponents(like->GetNumberOfComponents());
            nothing->SetNumberOfTuples(on_nodes ? part.data->GetNumberOfPoints() : part.data->GetNumberOfCells());
            nothing->Fill(std::nan(""));
            data_of(part)->AddArray(nothing);
            without += (without.empty() ? "'" : ", '") + part.zone->name + "'";
        }
        if (!without.empty()) {
            problems.push_back({core::Problem::Severity::note,
                                "array '" + name + "' is not-a-number on zones that do not have it (" + without + ")",
                                {}});
        }
    }
}

/// Joins the parts and writes them.
template <typename Append, typename Writer>
core::Problems write_joined(const Field& field, std::vector<Joined>& parts, const fs::path& path) {
    core::Problems problems;
    mark_zones(parts);
    fill_up(parts, true, problems);
    fill_up(parts, false, problems);
    vtkNew<Append> append;
    for (const auto& part : parts) {
        append->AddInputDataObject(part.data);
    }
    append->Update();
    describe(*append->GetOutput(), field, parts);
    note_lost_arrays(parts, *append->GetOutput(), problems);
    write_whole<Writer>(*append->GetOutput(), path);
    return problems;
}

/// Who wants surfaces hardly misses the volumes; the other way round the loads would be gone.
void note_lost_zones(const Field& field, const std::vector<Joined>& parts, core::Problem::Severity severity,
                     const std::string& ending, core::Problems& problems) {
    std::string names;
    for (const auto& zone : field.zones) {
        const bool kept =
            std::any_of(parts.begin(), parts.end(), [&](const Joined& part) { return part.zone == &zone; });
        names += kept ? "" : (names.empty() ? "'" : ", '") + zone.name + "'";
    }
    if (!names.empty()) {
        problems.push_back(
            {severity, "left out: " + names + ", which a " + ending + " does not take (a .vtm takes every zone)", {}});
    }
}

core::Problems write_surfaces(const Field& field, const fs::path& path) {
    std::vector<Joined> parts;
    for (const auto& zone : field.zones) {
        if (zone.surface != nullptr && zone.surface->GetNumberOfPoints() > 0) {
            parts.push_back(joined_from(zone, *zone.surface));
        }
    }
    if (parts.empty()) {
        throw core::InputError("zone", "the file holds no surfaces, lines or points for a .vtp",
                               {field.files.front(), {}, {}, {}}, "volumes go into a .vtu or .vtm");
    }
    auto problems = write_joined<vtkAppendPolyData, vtkXMLPolyDataWriter>(field, parts, path);
    note_lost_zones(field, parts, core::Problem::Severity::note, ".vtp", problems);
    return problems;
}

core::Problems write_volumes(const Field& field, const fs::path& path) {
    std::vector<Joined> parts;
    const bool volumes =
        std::any_of(field.zones.begin(), field.zones.end(), [](const Zone& z) { return z.volume != nullptr; });
    for (const auto& zone : field.zones) {
        vtkDataSet* data = zone.volume != nullptr ? static_cast<vtkDataSet*>(zone.volume) : zone.surface.Get();
        if (data != nullptr && data->GetNumberOfPoints() > 0 && (!volumes || zone.volume != nullptr)) {
            parts.push_back(joined_from(zone, *data));
        }
    }
    if (parts.empty()) {
        throw core::InputError("zone", "the file holds no points in space", {field.files.front(), {}, {}, {}});
    }
    auto problems = write_joined<vtkAppendFilter, vtkXMLUnstructuredGridWriter>(field, parts, path);
    note_lost_zones(field, parts, core::Problem::Severity::warning, volumes ? ".vtu with volumes" : ".vtu", problems);
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
    std::string index =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" "
        "byte_order=\"LittleEndian\">\n  <vtkMultiBlockDataSet>\n";
    for (std::size_t i = 0; i < field.zones.size(); ++i) {
        progress.check();
        const Zone& zone = field.zones[i];
        const std::string name = file_name(zone, i);
        vtkDataSet* data = zone.volume != nullptr ? static_cast<vtkDataSet*>(zone.volume) : zone.surface.Get();
        if (data != nullptr) {
            const Joined part = joined_from(zone, *data);
            describe(*part.data, field, {part});
            if (zone.volume != nullptr) {
                write_whole<vtkXMLUnstructuredGridWriter>(*part.data, folder / name);
            } else {
                write_whole<vtkXMLPolyDataWriter>(*part.data, folder / name);
            }
        }
        index += "    <DataSet index=\"" + std::to_string(i) + "\" name=\"" + core::escape_html(zone.name) +
                 "\" file=\"" + core::escape_html((folder.filename() / name).string()) + "\"/>\n";
    }
    core::write_file(path, index + "  </vtkMultiBlockDataSet>\n</VTKFile>\n");
    return {};
}

}  // namespace

void check_vtk_ending(const fs::path& path) {
    const std::string ending = core::lower_case(path.extension().string());
    if (ending != ".vtp" && ending != ".vtu" && ending != ".vtm") {
        throw core::UsageError("usage", "'" + ending + "' is no ending that is written", {path.string(), {}, {}, {}},
                               "write to a .vtu, .vtp or .vtm");
    }
}

core::Problems write_vtk(const Field& field, const fs::path& path, core::Progress& progress) {
    check_vtk_ending(path);
    const std::string ending = core::lower_case(path.extension().string());
    return ending == ".vtp"   ? write_surfaces(field, path)
           : ending == ".vtu" ? write_volumes(field, path)
                              : write_blocks(field, path, progress);
}

}  // namespace underbody::postproc
