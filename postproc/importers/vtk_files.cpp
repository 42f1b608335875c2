// Files that VTK reads right: its own, plain surfaces, OpenFOAM cases. Numbers and names are made canonical.
#include <vtkCellData.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataObjectTree.h>
#include <vtkDataObjectTreeIterator.h>
#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkGenericDataObjectReader.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkOBJReader.h>
#include <vtkOpenFOAMReader.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkSTLReader.h>
#include <vtkStringArray.h>
#include <vtkTecplotReader.h>
#include <vtkXMLGenericDataObjectReader.h>
#include <vtkXMLMultiBlockDataReader.h>

#include <algorithm>
#include <fstream>

#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/vtk_problems.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

/// x, y and z parts that stand alone become one array.
void join_components(Zone& zone, vtkDataSetAttributes& data, Location on) {
    std::vector<ArrayInfo> joined;
    std::vector<ArrayInfo> kept;
    for (auto& info : zone.arrays) {
        const auto part = info.on == on && info.components == 1 ? vector_component(info.name) : std::nullopt;
        vtkDataArray* values = part ? data.GetArray(info.name.c_str()) : nullptr;
        if (values == nullptr) {
            kept.push_back(std::move(info));
            continue;
        }
        vtkSmartPointer<vtkDataArray> whole = data.GetArray(part->vector.c_str());
        if (whole == nullptr) {
            whole = vtkSmartPointer<vtkDoubleArray>::New();
            whole->SetName(part->vector.c_str());
            whole->SetNumberOfComponents(3);
            whole->SetNumberOfTuples(values->GetNumberOfTuples());
            whole->Fill(0);
            data.AddArray(whole);
            joined.push_back(info);
            joined.back().name = part->vector;
            joined.back().components = 3;
        } else if (!joined.empty()) {
            joined.back().original_name += ", " + info.original_name;
        }
        for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
            whole->SetComponent(i, part->index, values->GetComponent(i, 0));
        }
        data.RemoveArray(info.name.c_str());
    }
    zone.arrays = std::move(kept);
    zone.arrays.insert(zone.arrays.end(), joined.begin(), joined.end());
}

/// Turns the arrays of one attribute set into canonical ones.
void add_arrays(Zone& zone, vtkDataSetAttributes& data, Location on, const ReadOptions& options) {
    std::vector<vtkSmartPointer<vtkDataArray>> arrays;
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
        if (vtkDataArray* array = data.GetArray(i); array != nullptr && array->GetName() != nullptr) {
            arrays.emplace_back(array);
        }
    }
    for (auto& array : arrays) {
        const std::string original = array->GetName();
        const CanonicalName canonical = canonical_name(original);
        data.RemoveArray(original.c_str());
        if (!options.arrays.empty() && !matches_any(options.arrays, original) &&
            !matches_any(options.arrays, canonical.name)) {
            continue;
        }
        ArrayInfo info{canonical.name, canonical.unit, original, "", on, array->GetNumberOfComponents()};
        for (const auto& [name, unit] : options.units) {
            if (name == original) {
                info.original_unit = unit;
                info.unit = core::si_unit(unit);
                const auto convert = core::conversion(unit, info.unit);
                for (vtkIdType t = 0; t < array->GetNumberOfTuples() && (convert.scale != 1 || convert.offset != 0);
                     ++t) {
                    for (int c = 0; c < array->GetNumberOfComponents(); ++c) {
                        array->SetComponent(t, c, convert(array->GetComponent(t, c)));
                    }
                }
                if (!canonical.unit.empty() && !core::same_dimension(info.unit, canonical.unit)) {
                    info.name = canonical.name == "pressure" && core::same_dimension(info.unit, "m^2/s^2")
                                    ? "kinematic_pressure"
                                    : original;
                }
            }
        }
        array->SetName(info.name.c_str());
        data.AddArray(array);
        zone.arrays.push_back(std::move(info));
    }
    join_components(zone, data, on);
}

void add_zone(Field& field, const std::string& name, vtkDataObject* object, const ReadOptions& options) {
    auto* data = vtkDataSet::SafeDownCast(object);
    if (data == nullptr || data->GetNumberOfPoints() == 0) {
        return;
    }
    Zone zone;
    zone.name = name;
    zone.id = static_cast<int>(field.zones.size()) + 1;
    zone.normals_into_fluid = false;
    if (auto* surface = vtkPolyData::SafeDownCast(data)) {
        zone.surface = vtkSmartPointer<vtkPolyData>::New();
        zone.surface->ShallowCopy(surface);
    } else if (auto* grid = vtkUnstructuredGrid::SafeDownCast(data)) {
        zone.volume = vtkSmartPointer<vtkUnstructuredGrid>::New();
        zone.volume->ShallowCopy(grid);
        zone.kind = ZoneKind::fluid;
    } else {
        field.problems.push_back({core::Problem::Severity::warning,
                                  "zone " + name + " is a " + data->GetClassName() + ", which is not read",
                                  {field.files.front(), {}, {}, {}}});
        return;
    }
    if (!matches_any(options.zones, name) || (zone.volume != nullptr && options.surfaces_only)) {
        return;
    }
    add_arrays(zone, *data->GetPointData(), Location::nodes, options);
    vtkDataSet* own =
        zone.surface != nullptr ? static_cast<vtkDataSet*>(zone.surface) : static_cast<vtkDataSet*>(zone.volume);
    own->GetPointData()->ShallowCopy(data->GetPointData());
    add_arrays(zone, *data->GetCellData(), zone.surface != nullptr ? Location::faces : Location::cells, options);
    own->GetCellData()->ShallowCopy(data->GetCellData());
    if (!options.length_unit.empty()) {
        const double scale = core::conversion(options.length_unit, "m").scale;
        auto* points = vtkPointSet::SafeDownCast(own)->GetPoints()->GetData();
        for (vtkIdType i = 0; i < points->GetNumberOfTuples() && scale != 1; ++i) {
            for (int k = 0; k < 3; ++k) {
                points->SetComponent(i, k, scale * points->GetComponent(i, k));
            }
        }
    }
    field.zones.push_back(std::move(zone));
}

/// All leaves of a tree, named after the path to them.
void add_tree(Field& field, const std::string& path, vtkDataObject* object, const ReadOptions& options) {
    auto* tree = vtkDataObjectTree::SafeDownCast(object);
    if (tree == nullptr) {
        add_zone(field, path, object, options);
        return;
    }
    auto walk = vtkSmartPointer<vtkDataObjectTreeIterator>::New();
    walk->SetDataSet(tree);
    walk->TraverseSubTreeOff();
    walk->VisitOnlyLeavesOff();
    int index = 0;
    for (walk->InitTraversal(); !walk->IsDoneWithTraversal(); walk->GoToNextItem(), ++index) {
        const char* own =
            walk->HasCurrentMetaData() != 0 ? walk->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME()) : nullptr;
        const std::string name = own != nullptr ? own : std::to_string(index);
        add_tree(field, path.empty() ? name : path + "/" + name, walk->GetCurrentDataObject(), options);
    }
}

template <typename Reader>
vtkSmartPointer<vtkDataObject> output_of(Reader& reader, const fs::path& path) {
    VtkProblems problems(reader);
    reader.SetFileName(path.c_str());
    reader.Update();
    if (problems.any() || reader.GetErrorCode() != vtkErrorCode::NoError) {
        throw core::InputError("format", "VTK cannot read it: " + problems.first(), {path.string(), {}, {}, {}},
                               "the file is cut short or damaged");
    }
    return reader.GetOutputDataObject(0);
}

Field field_for(const fs::path& path, const std::string& format) {
    Field field;
    field.format = format;
    field.files = {path.string()};
    return field;
}

Field read_one(const fs::path& path, const std::string& format, vtkDataObject* object, const ReadOptions& options) {
    Field field = field_for(path, format);
    add_tree(field, vtkDataObjectTree::SafeDownCast(object) != nullptr ? "" : path.stem().string(), object, options);
    if (field.zones.empty() && options.zones.empty() && !options.surfaces_only) {
        throw core::InputError("format", "there are no points in this file", {path.string(), {}, {}, {}});
    }
    field.problems.push_back({core::Problem::Severity::note,
                              "the file states no units; SI is taken unless stated otherwise",
                              {path.string(), {}, {}, {}}});
    return field;
}

bool is_xml(std::string_view head, const fs::path& /*path*/) {
    const std::size_t at = head.find("<VTKFile");
    return at != std::string_view::npos && at < 1024;
}
Field read_xml(const fs::path& path, const ReadOptions& options, core::Progress& /*progress*/) {
    if (core::lower_case(path.extension().string()) == ".vtm") {
        auto reader = vtkSmartPointer<vtkXMLMultiBlockDataReader>::New();
        return read_one(path, "VTK XML", output_of(*reader, path), options);
    }
    auto reader = vtkSmartPointer<vtkXMLGenericDataObjectReader>::New();
    return read_one(path, "VTK XML", output_of(*reader, path), options);
}

bool is_legacy(std::string_view head, const fs::path& /*path*/) { return head.starts_with("# vtk DataFile"); }
Field read_legacy(const fs::path& path, const ReadOptions& options, core::Progress& /*progress*/) {
    auto reader = vtkSmartPointer<vtkGenericDataObjectReader>::New();
    reader->ReadAllScalarsOn();
    reader->ReadAllVectorsOn();
    reader->ReadAllFieldsOn();
    return read_one(path, "VTK legacy", output_of(*reader, path), options);
}

bool is_surface(std::string_view head, const fs::path& path) {
    const std::string ending = core::lower_case(path.extension().string());
    if (head.starts_with("ply\n") || head.starts_with("ply\r\n")) {
        return true;
    }
    if (head.starts_with("solid") && head.find("facet") != std::string_view::npos) {
        return true;
    }
    // A binary STL has nothing but its size to know it by: 84 bytes and 50 for each triangle.
    if (ending == ".stl" && head.size() >= 84) {
        std::error_code error;
        std::uint32_t triangles = 0;
        std::copy_n(head.data() + 80, 4, reinterpret_cast<char*>(&triangles));
        return fs::file_size(path, error) == 84 + std::uint64_t{50} * triangles;
    }
    return ending == ".obj" && (head.find("\nv ") != std::string_view::npos || head.starts_with("v "));
}
Field read_surface(const fs::path& path, const ReadOptions& options, core::Progress& /*progress*/) {
    const std::string ending = core::lower_case(path.extension().string());
    Field field;
    if (ending == ".ply") {
        auto reader = vtkSmartPointer<vtkPLYReader>::New();
        field = read_one(path, "surface (PLY)", output_of(*reader, path), options);
    } else if (ending == ".obj") {
        auto reader = vtkSmartPointer<vtkOBJReader>::New();
        field = read_one(path, "surface (OBJ)", output_of(*reader, path), options);
    } else {
        auto reader = vtkSmartPointer<vtkSTLReader>::New();
        field = read_one(path, "surface (STL)", output_of(*reader, path), options);
    }
    return field;
}

bool is_tecplot(std::string_view head, const fs::path& /*path*/) {
    std::string text(core::trimmed(head.substr(0, 2000)));
    while (!text.empty() && text.front() == '#') {
        text.erase(0, std::min(text.find('\n'), text.size() - 1) + 1);
    }
    text = core::lower_case(text);
    return (text.starts_with("title") || text.starts_with("variables")) &&
           text.find("variables") != std::string::npos && text.find('=') != std::string::npos;
}
Field read_tecplot(const fs::path& path, const ReadOptions& options, core::Progress& /*progress*/) {
    auto reader = vtkSmartPointer<vtkTecplotReader>::New();
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    for (int i = 0; i < reader->GetNumberOfDataArrays(); ++i) {
        reader->SetDataArrayStatus(reader->GetDataArrayName(i), 1);
    }
    return read_one(path, "Tecplot ASCII", output_of(*reader, path), options);
}

/// A folder with constant/polyMesh, or the .foam or controlDict file that stands for one.
fs::path foam_folder(const fs::path& path) {
    for (const fs::path& folder : {path, path.parent_path(), path.parent_path().parent_path()}) {
        std::error_code error;
        if (fs::is_directory(folder / "constant" / "polyMesh", error)) {
            return folder;
        }
    }
    return {};
}
bool is_foam(std::string_view head, const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
        return foam_folder(path) == path;
    }
    const std::string name = path.filename().string();
    return (path.extension() == ".foam" ||
            (name == "controlDict" && head.find("FoamFile") != std::string_view::npos)) &&
           !foam_folder(path).empty();
}

/// "dimensions [0 2 -2 0 0 0 0];" of a field file of the last time step.
std::string foam_dimensions(const fs::path& file) {
    std::ifstream in(file);
    std::string line;
    for (int lines = 0; lines < 60 && std::getline(in, line); ++lines) {
        if (core::trimmed(line).starts_with("dimensions")) {
            const std::size_t open = line.find('[');
            const std::size_t close = line.find(']');
            if (open != std::string::npos && close != std::string::npos && close > open) {
                return std::string(core::trimmed(line.substr(open + 1, close - open - 1)));
            }
        }
    }
    return {};
}

Field read_foam(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const fs::path folder = foam_folder(path);
    const fs::path control = folder / "system" / "controlDict";
    if (!fs::is_regular_file(control)) {
        throw core::InputError("missing", "the case has no system/controlDict", {folder.string(), {}, {}, {}});
    }
    auto reader = vtkSmartPointer<vtkOpenFOAMReader>::New();
    VtkProblems problems(*reader);
    reader->SetFileName(control.c_str());
    reader->UpdateInformation();
    reader->EnableAllPatchArrays();
    reader->EnableAllCellArrays();
    reader->EnableAllPointArrays();
    reader->CreateCellToPointOff();
    double last = 0;
    if (vtkDoubleArray* times = reader->GetTimeValues(); times != nullptr && times->GetNumberOfTuples() > 0) {
        last = times->GetValue(times->GetNumberOfTuples() - 1);
        reader->UpdateTimeStep(last);
    }
    progress.check();
    reader->Update();
    if (problems.any()) {
        throw core::InputError("format", "VTK cannot read the case: " + problems.first(),
                               {folder.string(), {}, {}, {}});
    }
    ReadOptions with_units = options;
    const fs::path step = folder / core::format_number(last);
    if (foam_dimensions(step / "p") == "0 2 -2 0 0 0 0") {
        with_units.units.emplace_back("p", "m^2/s^2");
    }
    Field field = field_for(folder, "OpenFOAM");
    add_tree(field, "", reader->GetOutput(), with_units);
    field.metadata.emplace_back("time", core::format_number(last));
    for (auto& zone : field.zones) {
        const std::size_t slash = zone.name.find_last_of('/');
        zone.name = slash == std::string::npos ? zone.name : zone.name.substr(slash + 1);
    }
    // patch types: wall, patch, symmetryPlane ...
    std::ifstream boundary(folder / "constant" / "polyMesh" / "boundary");
    std::string word;
    std::string before;
    std::string patch;
    while (boundary >> word) {
        if (word == "{") {
            patch = before;
        } else if (before == "type") {
            const std::string type = word.substr(0, word.find(';'));
            for (auto& zone : field.zones) {
                if (zone.name == patch && zone.surface != nullptr) {
                    zone.original_kind = type;
                    zone.kind = type == "wall"                 ? ZoneKind::wall
                                : type.starts_with("symmetry") ? ZoneKind::symmetry
                                : type.starts_with("cyclic")   ? ZoneKind::periodic
                                                               : ZoneKind::unknown;
                }
            }
        }
        before = word;
    }
    field.problems.push_back({core::Problem::Severity::note,
                              "patch normals of OpenFOAM point out of the fluid; they are given as stored",
                              {folder.string(), {}, {}, {}}});
    return field;
}

}  // namespace

Importer vtk_xml_importer() { return {"VTK XML", is_xml, read_xml}; }
Importer vtk_legacy_importer() { return {"VTK legacy", is_legacy, read_legacy}; }
Importer surface_file_importer() { return {"surface (STL, PLY, OBJ)", is_surface, read_surface}; }
Importer tecplot_importer() { return {"Tecplot ASCII", is_tecplot, read_tecplot}; }
Importer openfoam_importer() { return {"OpenFOAM", is_foam, read_foam}; }

}  // namespace underbody::postproc
