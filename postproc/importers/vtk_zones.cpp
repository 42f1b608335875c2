#include "postproc/importers/vtk_zones.h"

#include <vtkAppendFilter.h>
#include <vtkBoundingBox.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataObjectTree.h>
#include <vtkDataObjectTreeIterator.h>
#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <map>

#include "core/units.h"
#include "postproc/importers/array_names.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/variable_reading.h"
#include "postproc/importers/vtk_sides.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

/// Once a file, whatever the number of its zones.
void ask_for_unit(Field& field, const std::string& variable) {
    core::Problem problem = unit_is_asked_for(variable, {field.files.front(), {}, {}, {}});
    const bool known = std::any_of(field.problems.begin(), field.problems.end(), [&](const auto& p) { return p.message == problem.message; });
    if (!known) {
        field.problems.push_back(std::move(problem));
    }
}

/// An array with what it becomes.
struct ReadArray {
    vtkSmartPointer<vtkDataArray> values;
    ArrayInfo info;
    core::Conversion convert;
};

void convert(vtkDataArray& values, const core::Conversion& conversion) {
    for (vtkIdType t = 0; t < values.GetNumberOfTuples() && !conversion.is_identity(); ++t) {
        for (int c = 0; c < values.GetNumberOfComponents(); ++c) {
            values.SetComponent(t, c, conversion(values.GetComponent(t, c)));
        }
    }
}

/// What `import` writes beside the arrays: "T [s]" for each, by the name.
using Units = std::map<std::string, std::string>;

Units units_in(vtkFieldData& data) {
    Units units;
    auto* lines = vtkStringArray::SafeDownCast(data.GetAbstractArray("units"));
    for (vtkIdType i = 0; lines != nullptr && i < lines->GetNumberOfValues(); ++i) {
        const std::string& line = lines->GetValue(i);
        if (const auto open = line.rfind(" ["); open != std::string::npos && line.back() == ']') {
            units[line.substr(0, open)] = line.substr(open + 2, line.size() - open - 3);
        }
    }
    return units;
}

/// Takes the named arrays out of an attribute set, and plans their names.
std::vector<ReadArray> taken_arrays(Field& field, vtkDataSetAttributes& data, Location on, const Units& units, const ReadOptions& options,
                                    std::vector<ArrayPlan>& plans) {
    std::vector<ReadArray> arrays;
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
        vtkDataArray* array = data.GetArray(i);
        if (array == nullptr || array->GetName() == nullptr) {
            continue;
        }
        const std::string original = array->GetName();
        const bool asked = unit_must_be_stated(original, options);
        if (asked) {
            ask_for_unit(field, original);
        }
        const core::Place place{field.files.front(), {}, {}, {}};
        const auto unit = units.find(original);
        const VariableReading reading = read_variable_name(asked ? unstated_name(original) : original, options, place, field.problems,
                                                           unit != units.end() ? unit->second : std::string());
        const int components = array->GetNumberOfComponents();
        const std::string name = components == 1 ? named_as_scalar({reading.name, reading.unit}).name : reading.name;
        plans.push_back({reading.own, name, components});
        arrays.push_back({array, {name, reading.unit, original, reading.original_unit, on, components}, reading.convert});
    }
    for (const auto& array : arrays) {
        data.RemoveArray(array.info.original_name.c_str());
    }
    return arrays;
}

/// Turns the arrays of one attribute set into canonical ones.
void add_arrays(Field& field, Zone& zone, vtkDataSetAttributes& data, Location on, const Units& units, int dimension, const ReadOptions& options) {
    const core::Place place{field.files.front(), {}, {}, {}};
    std::vector<ArrayPlan> plans;
    std::vector<ReadArray> arrays = taken_arrays(field, data, on, units, options, plans);
    settle_names(plans, place, field.problems);
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        if (!is_wanted(options, arrays[i].info.original_name, plans[i].name)) {
            plans[i].name.clear();
        }
    }
    join_components(plans, dimension, options, place, field.problems);
    std::map<std::string, std::size_t> vectors;  // places among the zone's
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        if (plans[i].name.empty()) {
            continue;
        }
        auto& [values, info, conversion] = arrays[i];
        info.name = plans[i].name;
        convert(*values, conversion);
        if (plans[i].component < 0) {
            values->SetName(info.name.c_str());
            data.AddArray(values);
            zone.arrays.push_back(std::move(info));
            continue;
        }
        vtkSmartPointer<vtkDataArray> whole = data.GetArray(info.name.c_str());
        const auto [found, is_new] = vectors.emplace(info.name, zone.arrays.size());
        if (is_new) {
            whole = vtkSmartPointer<vtkDoubleArray>::New();
            whole->SetName(info.name.c_str());
            whole->SetNumberOfComponents(3);
            whole->SetNumberOfTuples(values->GetNumberOfTuples());
            whole->Fill(0);
            data.AddArray(whole);
            info.components = 3;
            zone.arrays.push_back(std::move(info));
        } else {
            zone.arrays[found->second].original_name += ", " + info.original_name;
        }
        whole->CopyComponent(plans[i].component, values, 0);
    }
}

/// VTK's cells along the axes number their corners row by row; everybody else goes round them.
void go_round_corners(vtkUnstructuredGrid& grid) {
    if (grid.GetCellTypesArray() == nullptr || grid.GetNumberOfCells() == 0) {
        return;
    }
    bool any = false;
    for (vtkIdType c = 0; c < grid.GetNumberOfCells() && !any; ++c) {
        any = grid.GetCellType(c) == VTK_VOXEL || grid.GetCellType(c) == VTK_PIXEL;
    }
    if (!any) {
        return;
    }
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkUnsignedCharArray> types;
    vtkNew<vtkIdList> nodes;
    for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
        int type = grid.GetCellType(c);
        grid.GetCellPoints(c, nodes);
        if (type == VTK_VOXEL || type == VTK_PIXEL) {
            for (vtkIdType first = 0; first < nodes->GetNumberOfIds(); first += 4) {
                const vtkIdType third = nodes->GetId(first + 2);
                nodes->SetId(first + 2, nodes->GetId(first + 3));
                nodes->SetId(first + 3, third);
            }
            type = type == VTK_VOXEL ? VTK_HEXAHEDRON : VTK_QUAD;
        }
        cells->InsertNextCell(nodes);
        types->InsertNextValue(static_cast<unsigned char>(type));
    }
    grid.SetCells(types, cells, grid.GetFaceLocations(), grid.GetFaces());
}

/// Grids may hold faces too: 0 empty or of points and lines, 2 faces alone, 3 anything else.
int dimension_of(vtkDataSet& data) {
    int most = 0;
    for (vtkIdType c = 0; c < data.GetNumberOfCells() && most < 3; ++c) {
        switch (data.GetCellType(c)) {
            case VTK_TRIANGLE:
            case VTK_QUAD:
            case VTK_PIXEL:
            case VTK_POLYGON:
                most = most == 0 && c > 0 ? 3 : 2;  // faces mixed with lines stay a grid
                break;
            case VTK_EMPTY_CELL:
            case VTK_VERTEX:
            case VTK_POLY_VERTEX:
            case VTK_LINE:
            case VTK_POLY_LINE:
                most = most == 2 ? 3 : most;
                break;
            default:
                most = 3;
        }
    }
    return most;
}

/// What the grids of a file are, all together.
struct Extent {
    bool solid = false;  ///< some have cells with a volume
    vtkBoundingBox faces;
};

void measure(vtkDataObject* object, Extent& extent) {
    if (auto* tree = vtkDataObjectTree::SafeDownCast(object)) {
        auto walk = vtkSmartPointer<vtkDataObjectTreeIterator>::New();
        walk->SetDataSet(tree);
        for (walk->InitTraversal(); !walk->IsDoneWithTraversal(); walk->GoToNextItem()) {
            measure(walk->GetCurrentDataObject(), extent);
        }
    } else if (auto* data = vtkDataSet::SafeDownCast(object); data != nullptr && vtkPolyData::SafeDownCast(data) == nullptr &&
                                                              data->GetNumberOfPoints() > 0) {
        const int dimension = dimension_of(*data);
        extent.solid = extent.solid || dimension == 3;
        if (dimension == 2) {
            extent.faces.AddBounds(data->GetBounds());
        }
    }
}

/// Grids of faces are surfaces, unless they all lie in one plane and are a plane flow.
bool grids_are_surfaces(vtkDataObject* object) {
    Extent extent;
    measure(object, extent);
    if (!extent.faces.IsValid()) {
        return false;
    }
    const double size = extent.faces.GetDiagonalLength();
    return extent.solid || std::min({extent.faces.GetLength(0), extent.faces.GetLength(1), extent.faces.GetLength(2)}) > 1e-9 * size;
}

vtkSmartPointer<vtkPolyData> surface_of(vtkUnstructuredGrid& grid) {
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    surface->SetPoints(grid.GetPoints());
    surface->SetPolys(grid.GetCells());
    return surface;
}

/// A copy that may be changed: without cells that another process's share holds too, strips as triangles, grids of any
/// kind cell by cell.
vtkSmartPointer<vtkDataSet> own_copy(vtkDataSet& data) {
    vtkSmartPointer<vtkDataSet> copy;
    if (auto* surface = vtkPolyData::SafeDownCast(&data)) {
        auto polygons = vtkSmartPointer<vtkPolyData>::New();
        polygons->ShallowCopy(surface);
        polygons->RemoveGhostCells();
        if (polygons->GetNumberOfStrips() > 0) {
            vtkNew<vtkTriangleFilter> triangles;
            triangles->SetInputData(polygons);
            triangles->Update();
            polygons->ShallowCopy(triangles->GetOutput());
        }
        copy = polygons;
    } else {
        auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
        if (auto* cells = vtkUnstructuredGrid::SafeDownCast(&data)) {
            grid->ShallowCopy(cells);
        } else {
            vtkNew<vtkAppendFilter> append;
            append->AddInputData(&data);
            append->Update();
            grid->ShallowCopy(append->GetOutput());
        }
        grid->RemoveGhostCells();
        go_round_corners(*grid);
        copy = grid;
    }
    copy->GetPointData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
    copy->GetCellData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
    return copy;
}

/// A plane flow, or points and lines at one z, which may be a part of one: vectors may have no z.
bool is_plane(const Zone& zone) {
    if (zone.volume != nullptr) {
        return dimension_of(*zone.volume) == 2;
    }
    vtkBoundingBox box(zone.surface->GetBounds());
    return dimension_of(*zone.surface) == 0 && box.IsValid() && box.GetLength(2) == 0;
}

void add_zone(Field& field, const std::string& name, vtkDataObject* object, bool faces_are_surfaces, const ReadOptions& options) {
    auto* read = vtkDataSet::SafeDownCast(object);
    if (read == nullptr || read->GetNumberOfPoints() == 0) {
        return;
    }
    const vtkSmartPointer<vtkDataSet> data = own_copy(*read);
    Zone zone;
    zone.name = name;
    zone.id = static_cast<int>(field.zones.size()) + 1;
    zone.normals_into_fluid = false;
    zone.surface = vtkPolyData::SafeDownCast(data);
    zone.volume = vtkUnstructuredGrid::SafeDownCast(data);
    if (zone.volume != nullptr && faces_are_surfaces && dimension_of(*zone.volume) == 2) {
        zone.surface = surface_of(*zone.volume);
        zone.volume = nullptr;
    }
    zone.kind = zone.volume != nullptr ? ZoneKind::fluid : ZoneKind::unknown;
    const int dimension = is_plane(zone) ? 2 : 3;
    const Units units = units_in(*read->GetFieldData());
    add_arrays(field, zone, *data->GetPointData(), Location::nodes, units, dimension, options);
    add_arrays(field, zone, *data->GetCellData(), zone.surface != nullptr ? Location::faces : Location::cells, units, dimension, options);
    vtkPointSet* own = zone.surface != nullptr ? static_cast<vtkPointSet*>(zone.surface) : static_cast<vtkPointSet*>(zone.volume);
    if (own != data) {
        own->GetPointData()->ShallowCopy(data->GetPointData());
        own->GetCellData()->ShallowCopy(data->GetCellData());
    }
    if (!options.length_unit.empty()) {
        const double scale = core::conversion(options.length_unit, "m").scale;
        auto* points = own->GetPoints()->GetData();
        for (vtkIdType i = 0; i < points->GetNumberOfTuples() && scale != 1; ++i) {
            for (int k = 0; k < 3; ++k) {
                points->SetComponent(i, k, scale * points->GetComponent(i, k));
            }
        }
    }
    field.zones.push_back(std::move(zone));
}

/// All leaves of a tree, named after the path to them.
void add_tree(Field& field, const std::string& path, vtkDataObject* object, bool faces_are_surfaces, const ReadOptions& options) {
    auto* tree = vtkDataObjectTree::SafeDownCast(object);
    if (tree == nullptr) {
        add_zone(field, path, object, faces_are_surfaces, options);
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
        add_tree(field, path.empty() ? name : path + "/" + name, walk->GetCurrentDataObject(), faces_are_surfaces, options);
    }
}

Field field_for(const fs::path& path, const std::string& format) {
    Field field;
    field.format = format;
    field.files = {path.string()};
    return field;
}

/// What the file does not say, and what is made of it.
void note_units(Field& field, const ReadOptions& options) {
    const core::Place place{field.files.front(), {}, {}, {}};
    field.problems.push_back({core::Problem::Severity::note,
                              "the file states no units; SI is taken unless stated otherwise",
                              place});
    if (options.length_unit.empty()) {
        field.metadata.emplace_back("length unit", "not stated, taken as m");
    }
    const bool plane = std::any_of(field.zones.begin(), field.zones.end(), [](const Zone& zone) { return zone.volume != nullptr && dimension_of(*zone.volume) == 2; });
    if (plane) {
        field.problems.push_back({core::Problem::Severity::warning,
                                  "its faces lie in one plane: they are taken for a two-dimensional flow, no surface (a flat surface is one in VTP, STL, PLY)",
                                  place});
    }
}

}  // namespace

Field field_from_vtk(const std::filesystem::path& path, const std::string& format, vtkDataObject* object, const ReadOptions& options, core::Progress& progress) {
    Field field = field_for(path, format);
    add_tree(field, vtkDataObjectTree::SafeDownCast(object) != nullptr ? "" : path.stem().string(), object,
             grids_are_surfaces(object), options);
    settle_sides(field, progress);
    std::erase_if(field.zones, [&](const Zone& zone) { return !matches_any(options.zones, zone.name); });
    note_units(field, options);
    std::erase_if(field.zones, [&](const Zone& zone) { return zone.volume != nullptr && options.surfaces_only; });
    if (field.zones.empty() && options.zones.empty() && !options.surfaces_only) {
        throw core::InputError("format", "there are no points in this file", {path.string(), {}, {}, {}});
    }
    return field;
}

}  // namespace underbody::postproc
