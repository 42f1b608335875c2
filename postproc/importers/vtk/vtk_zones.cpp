#include "postproc/importers/vtk/vtk_zones.h"

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
#include "postproc/importers/importer.h"
#include "postproc/importers/mesh/array_names.h"
#include "postproc/importers/mesh/variable_reading.h"
#include "postproc/importers/mesh/vtk_arrays.h"
#include "postproc/importers/vtk/vtk_described.h"
#include "postproc/importers/vtk/vtk_sides.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

/// Once a file, whatever the number of its zones.
void ask_for_unit(Field& field, const std::string& variable) {
    core::Problem problem = unit_is_asked_for(variable, {field.files.front(), {}, {}, {}});
    const bool known = std::any_of(field.problems.begin(), field.problems.end(),
                                   [&](const auto& p) { return p.message == problem.message; });
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

Units units_in(vtkDataSet& set) {
    Units units;
    if (const auto description = description_in(set)) {
        for (const auto& described : description->zones) {
            for (const auto& info : described.zone.arrays) {
                units[info.name] = info.unit;
            }
        }
    }
    auto* lines = vtkStringArray::SafeDownCast(set.GetFieldData()->GetAbstractArray("units"));
    for (vtkIdType i = 0; lines != nullptr && i < lines->GetNumberOfValues(); ++i) {
        const std::string& line = lines->GetValue(i);
        if (const auto open = line.rfind(" ["); open != std::string::npos && line.back() == ']') {
            units[line.substr(0, open)] = line.substr(open + 2, line.size() - open - 3);
        }
    }
    return units;
}

/// Takes the named arrays out of an attribute set, and plans their names.
std::vector<ReadArray> taken_arrays(Field& field, vtkDataSetAttributes& data, Location on, const Units& units,
                                    const ReadOptions& options, std::vector<ArrayPlan>& plans) {
    std::vector<ReadArray> arrays;
    std::vector<std::string> written;
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
        vtkDataArray* array = data.GetArray(i);
        if (array == nullptr || array->GetName() == nullptr) {
            continue;
        }
        const std::string original = name_in_file(array->GetName());
        const bool asked = unit_must_be_stated(original, options);
        if (asked) {
            ask_for_unit(field, original);
        }
        const core::Place place{field.files.front(), {}, {}, {}};
        const auto unit = units.find(original);
        const VariableReading reading =
            read_variable_name(asked ? unstated_name(original) : original, options, place, field.problems,
                               unit != units.end() ? unit->second : std::string());
        const int components = array->GetNumberOfComponents();
        const std::string name = components == 1 ? named_as_scalar({reading.name, reading.unit}).name : reading.name;
        plans.push_back({reading.own, name, components});
        written.emplace_back(array->GetName());
        arrays.push_back(
            {array, {name, reading.unit, original, reading.original_unit, on, components}, reading.convert});
    }
    for (const auto& name : written) {
        data.RemoveArray(name.c_str());
    }
    return arrays;
}

/// Turns the arrays of one attribute set into canonical ones.
void add_arrays(Field& field, Zone& zone, vtkDataSetAttributes& data, Location on, const Units& units, int dimension,
                const ReadOptions& options) {
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
            name_tensor_components(*values);
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
    if (auto* surface = vtkPolyData::SafeDownCast(&data)) {  // asked for a type, it would note that of every face
        const bool others = surface->GetNumberOfVerts() + surface->GetNumberOfLines() > 0;
        const bool faces = surface->GetNumberOfPolys() > 0;
        return surface->GetNumberOfStrips() > 0 || (faces && others) ? 3 : faces ? 2 : 0;
    }
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
    } else if (auto* data = vtkDataSet::SafeDownCast(object);
               data != nullptr && vtkPolyData::SafeDownCast(data) == nullptr && data->GetNumberOfPoints() > 0) {
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
    return extent.solid ||
           std::min({extent.faces.GetLength(0), extent.faces.GetLength(1), extent.faces.GetLength(2)}) > 1e-9 * size;
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

void scale_to_metres(vtkPointSet& data, const ReadOptions& options) {
    const double scale = options.length_unit.empty() ? 1 : core::conversion(options.length_unit, "m").scale;
    auto* points = data.GetPoints()->GetData();
    for (vtkIdType i = 0; i < points->GetNumberOfTuples() && scale != 1; ++i) {
        for (int k = 0; k < 3; ++k) {
            points->SetComponent(i, k, scale * points->GetComponent(i, k));
        }
    }
}

/// What the descriptions of a file's parts say of the whole, where they agree.
class Origin {
public:
    void add(const Field& described) {
        const auto pressure = std::pair(described.pressure.kind, described.pressure.operating_pressure);
        if (!first_) {
            first_ = described;
            return;
        }
        alike_ = alike_ && described.dimension == first_->dimension && described.density == first_->density &&
                 pressure == std::pair(first_->pressure.kind, first_->pressure.operating_pressure);
    }
    void add_unknown() { unknown_ = true; }
    [[nodiscard]] bool is_known() const { return first_.has_value() && !unknown_; }

    void put_into(Field& field) const {
        if (!is_known()) {
            return;
        }
        if (!alike_) {
            field.problems.push_back({core::Problem::Severity::warning,
                                      "its blocks come from files of different pressure reference, density or "
                                      "dimension: none of these is taken up",
                                      {field.files.front(), {}, {}, {}}});
            return;
        }
        field.writer = first_->writer;
        field.dimension = first_->dimension;
        field.pressure = first_->pressure;
        field.density = first_->density;
        field.metadata = first_->metadata;
        std::erase_if(field.metadata, [](const auto& entry) { return entry.first == "length unit"; });
        field.metadata.emplace_back("length unit", "m");
        if (first_->format != field.format) {
            field.metadata.emplace_back("imported from", first_->format);
        }
    }

private:
    std::optional<Field> first_;
    bool alike_ = true;
    bool unknown_ = false;
};

/// Takes out the arrays of which the file says what they are, and away those that only other zones have.
std::vector<std::pair<vtkSmartPointer<vtkDataArray>, ArrayInfo>> take_described(const std::vector<ArrayInfo>& described,
                                                                                const Description& description,
                                                                                vtkDataSetAttributes& data, Location on,
                                                                                const ReadOptions& options) {
    // A surface may hold values of the cells beside its faces.
    const auto here = [&](const ArrayInfo& info) { return (info.on == Location::nodes) == (on == Location::nodes); };
    std::vector<std::pair<vtkSmartPointer<vtkDataArray>, ArrayInfo>> known;
    for (const auto& info : described) {
        vtkSmartPointer<vtkDataArray> values = data.GetArray(info.name.c_str());
        const bool as_it_was = here(info) && values != nullptr && values->GetNumberOfComponents() == info.components;
        // What the caller knows better, and what nobody knew, is read like that of any file.
        if (!as_it_was || name_in_file(info.name) != info.name || is_unit_stated(options, info.name)) {
            continue;
        }
        data.RemoveArray(info.name.c_str());
        if (is_wanted(options, info.original_name, info.name)) {
            known.emplace_back(values, info);
        }
    }
    for (const auto& other : description.zones) {
        for (const auto& info : other.zone.arrays) {
            const bool own = std::any_of(described.begin(), described.end(),
                                         [&](const ArrayInfo& i) { return i.name == info.name && here(i); });
            if (!own && here(info)) {
                data.RemoveArray(info.name.c_str());
            }
        }
    }
    return known;
}

/// The zones of a data set that we wrote: their kinds, sides and units stand in it.
void add_described_zones(Field& field, const std::string& name, vtkDataSet& data, const Description& description,
                         const ReadOptions& options) {
    const Units units = units_in(data);
    auto parts = parts_of(data, description);
    for (auto& part : parts) {
        Zone zone = std::move(part.zone);
        const std::vector<ArrayInfo> described = std::move(zone.arrays);
        zone.arrays.clear();
        zone.normals_into_fluid = zone.normals_into_fluid && part.as_written;
        if (field.find(zone.name) != nullptr) {
            zone.name = name.empty() || parts.size() > 1 ? name + "/" + zone.name : name;
        }
        zone.surface = vtkPolyData::SafeDownCast(part.data);
        zone.volume = vtkUnstructuredGrid::SafeDownCast(part.data);
        for (const Location on : {Location::nodes, zone.surface != nullptr ? Location::faces : Location::cells}) {
            vtkDataSetAttributes* attributes = on == Location::nodes
                                                   ? static_cast<vtkDataSetAttributes*>(part.data->GetPointData())
                                                   : part.data->GetCellData();
            const auto known = take_described(described, description, *attributes, on, options);
            add_arrays(field, zone, *attributes, on, units, description.field.dimension, options);
            for (const auto& [values, info] : known) {
                attributes->AddArray(values);
                zone.arrays.push_back(info);
            }
        }
        // Who looks for an array by its name takes the first one.
        const auto place = [&](const ArrayInfo& info) {
            return std::find_if(
                       described.begin(), described.end(),
                       [&](const ArrayInfo& other) { return other.name == info.name && other.on == info.on; }) -
                   described.begin();
        };
        std::stable_sort(zone.arrays.begin(), zone.arrays.end(),
                         [&](const ArrayInfo& a, const ArrayInfo& b) { return place(a) < place(b); });
        field.zones.push_back(std::move(zone));
    }
}

void add_zone(Field& field, Origin& origin, const std::string& name, vtkDataObject* object, bool faces_are_surfaces,
              const ReadOptions& options) {
    auto* read = vtkDataSet::SafeDownCast(object);
    if (read == nullptr || read->GetNumberOfPoints() == 0) {
        return;
    }
    const vtkSmartPointer<vtkDataSet> data = own_copy(*read);
    if (const auto description = description_in(*read)) {
        const std::size_t before = field.zones.size();
        add_described_zones(field, name, *data, *description, options);
        if (field.zones.size() > before) {
            origin.add(description->field);
            return;
        }
        field.problems.push_back({core::Problem::Severity::warning,
                                  "it had " + std::to_string(description->zones.size()) +
                                      " zones, but its cells no longer say which they are of: they are read as one",
                                  {field.files.front(), {}, {}, {}}});
    }
    origin.add_unknown();
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
    const Units units = units_in(*read);
    add_arrays(field, zone, *data->GetPointData(), Location::nodes, units, dimension, options);
    add_arrays(field, zone, *data->GetCellData(), zone.surface != nullptr ? Location::faces : Location::cells, units,
               dimension, options);
    vtkPointSet* own =
        zone.surface != nullptr ? static_cast<vtkPointSet*>(zone.surface) : static_cast<vtkPointSet*>(zone.volume);
    if (own != data) {
        own->GetPointData()->ShallowCopy(data->GetPointData());
        own->GetCellData()->ShallowCopy(data->GetCellData());
    }
    scale_to_metres(*own, options);
    field.zones.push_back(std::move(zone));
}

/// All leaves of a tree, named after the path to them.
void add_tree(Field& field, Origin& origin, const std::string& path, vtkDataObject* object, bool faces_are_surfaces,
              const ReadOptions& options) {
    auto* tree = vtkDataObjectTree::SafeDownCast(object);
    if (tree == nullptr) {
        add_zone(field, origin, path, object, faces_are_surfaces, options);
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
        add_tree(field, origin, path.empty() ? name : path + "/" + name, walk->GetCurrentDataObject(),
                 faces_are_surfaces, options);
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
    field.problems.push_back(
        {core::Problem::Severity::note, "the file states no units; SI is taken unless stated otherwise", place});
    if (options.length_unit.empty()) {
        field.metadata.emplace_back("length unit", "not stated, taken as m");
    }
    const bool plane = std::any_of(field.zones.begin(), field.zones.end(), [](const Zone& zone) {
        return zone.volume != nullptr && dimension_of(*zone.volume) == 2;
    });
    if (plane) {
        field.problems.push_back({core::Problem::Severity::warning,
                                  "its faces lie in one plane: they are taken for a two-dimensional flow, no surface "
                                  "(a flat surface is one in VTP, STL, PLY)",
                                  place});
    }
}

}  // namespace

Field field_from_vtk(const std::filesystem::path& path, const std::string& format, vtkDataObject* object,
                     const ReadOptions& options, core::Progress& progress) {
    Field field = field_for(path, format);
    Origin origin;
    add_tree(field, origin, vtkDataObjectTree::SafeDownCast(object) != nullptr ? "" : path.stem().string(), object,
             grids_are_surfaces(object), options);
    origin.put_into(field);
    settle_sides(field, progress);
    std::erase_if(field.zones, [&](const Zone& zone) { return !matches_any(options.zones, zone.name); });
    if (!origin.is_known()) {
        note_units(field, options);
    }
    std::erase_if(field.zones, [&](const Zone& zone) { return zone.volume != nullptr && options.surfaces_only; });
    if (field.zones.empty() && options.zones.empty() && !options.surfaces_only) {
        throw core::InputError("format", "there are no points in this file", {path.string(), {}, {}, {}});
    }
    return field;
}

}  // namespace underbody::postproc
