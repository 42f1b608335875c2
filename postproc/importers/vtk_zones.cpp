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
#include <vtkIdList.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>

#include "core/units.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/variable_reading.h"
#include "postproc/importers/vtk_sides.h"

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
        if (whole != nullptr && whole->GetNumberOfComponents() != 3) {
            kept.push_back(std::move(info));  // something else has the vector's name
            continue;
        }
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

/// Once a file, whatever the number of its zones.
void ask_for_unit(Field& field, const std::string& variable) {
    core::Problem problem = unit_is_asked_for(variable, {field.files.front(), {}, {}, {}});
    const bool known = std::any_of(field.problems.begin(), field.problems.end(), [&](const auto& p) { return p.message == problem.message; });
    if (!known) {
        field.problems.push_back(std::move(problem));
    }
}

/// Turns the arrays of one attribute set into canonical ones.
void add_arrays(Field& field, Zone& zone, vtkDataSetAttributes& data, Location on, const ReadOptions& options) {
    std::vector<vtkSmartPointer<vtkDataArray>> arrays;
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
        if (vtkDataArray* array = data.GetArray(i); array != nullptr && array->GetName() != nullptr) {
            arrays.emplace_back(array);
        }
    }
    for (auto& array : arrays) {
        const std::string original = array->GetName();
        const bool asked = unit_must_be_stated(original, options);
        const VariableReading reading = read_variable_name(asked ? unstated_name(original) : original, options, {});
        data.RemoveArray(original.c_str());
        if (asked) {
            ask_for_unit(field, original);
        }
        if (!options.arrays.empty() && !matches_any(options.arrays, original) && !matches_any(options.arrays, reading.name)) {
            continue;
        }
        ArrayInfo info{reading.name, reading.unit, original, reading.original_unit, on, array->GetNumberOfComponents()};
        for (vtkIdType t = 0; t < array->GetNumberOfTuples() && !reading.convert.is_identity(); ++t) {
            for (int c = 0; c < array->GetNumberOfComponents(); ++c) {
                array->SetComponent(t, c, reading.convert(array->GetComponent(t, c)));
            }
        }
        array->SetName(info.name.c_str());
        data.AddArray(array);
        zone.arrays.push_back(std::move(info));
    }
    join_components(zone, data, on);
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
    add_arrays(field, zone, *data->GetPointData(), Location::nodes, options);
    add_arrays(field, zone, *data->GetCellData(), zone.surface != nullptr ? Location::faces : Location::cells, options);
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
