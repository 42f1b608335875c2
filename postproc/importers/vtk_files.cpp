// Files that VTK reads right: its own, plain surfaces, Tecplot. Numbers and names are made canonical.
#include <vtkAppendFilter.h>
#include <vtkBoundingBox.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataObjectTree.h>
#include <vtkDataObjectTreeIterator.h>
#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkGenericDataObjectReader.h>
#include <vtkIdList.h>
#include <vtkIdTypeArray.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPointData.h>
#include <vtkSTLReader.h>
#include <vtkTecplotReader.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLGenericDataObjectReader.h>
#include <vtkXMLMultiBlockDataReader.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <functional>

#include "core/file.h"
#include "core/ply_file.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/trial.h"
#include "postproc/importers/variable_reading.h"
#include "postproc/importers/vtk_problems.h"
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

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
    throw core::InputError("format", what, {path.string(), {}, {}, {}}, "the file is cut short or damaged");
}

void check_cells(const fs::path& path, vtkCellArray* cells, vtkIdType points) {
    const vtkIdType entries = cells != nullptr ? cells->GetNumberOfConnectivityIds() : 0;
    vtkIdType before = 0;
    if (cells != nullptr && cells->GetOffsetsArray()->GetNumberOfTuples() != cells->GetNumberOfCells() + 1) {
        refuse(path, "a list of cells without its offsets");
    }
    for (vtkIdType i = 0; cells != nullptr && i <= cells->GetNumberOfCells(); ++i) {
        const auto offset = static_cast<vtkIdType>(cells->GetOffsetsArray()->GetComponent(i, 0));
        if (offset < before || offset > entries || (i == 0 && offset != 0)) {
            refuse(path, "cell " + std::to_string(i) + " lies outside the list of corners");
        }
        before = offset;
    }
    for (vtkIdType k = 0; k < entries; ++k) {
        const auto node = static_cast<vtkIdType>(cells->GetConnectivityArray()->GetComponent(k, 0));
        if (node < 0 || node >= points) {
            refuse(path, "a cell names point " + std::to_string(node) + " of " + std::to_string(points));
        }
    }
}

void check_arrays(const fs::path& path, vtkDataSetAttributes* data, vtkIdType items) {
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
        if (vtkAbstractArray* array = data->GetAbstractArray(i); array != nullptr && array->GetNumberOfTuples() != items) {
            refuse(path, std::string("array '") + (array->GetName() != nullptr ? array->GetName() : "") + "' has " +
                             std::to_string(array->GetNumberOfTuples()) + " values for " + std::to_string(items) + " places");
        }
    }
}

/// Each polyhedron's list of faces must lie within the stream, and name points that there are.
void check_polyhedra(const fs::path& path, vtkUnstructuredGrid& grid) {
    vtkIdTypeArray* faces = grid.GetFaces();
    vtkIdTypeArray* places = grid.GetFaceLocations();
    if (faces == nullptr || places == nullptr) {
        return;
    }
    const vtkIdType size = faces->GetNumberOfTuples();
    const auto at = [&](vtkIdType i) {
        if (i < 0 || i >= size) {
            refuse(path, "the faces of a polyhedron lie outside their list");
        }
        return faces->GetValue(i);
    };
    for (vtkIdType c = 0; c < places->GetNumberOfTuples(); ++c) {
        vtkIdType i = places->GetValue(c);
        if (i < 0) {
            continue;
        }
        for (vtkIdType count = at(i++); count > 0; --count) {
            for (vtkIdType corners = at(i++); corners > 0; --corners) {
                if (const vtkIdType node = at(i++); node < 0 || node >= grid.GetNumberOfPoints()) {
                    refuse(path, "a polyhedron names point " + std::to_string(node) + " of " +
                                     std::to_string(grid.GetNumberOfPoints()));
                }
            }
        }
    }
}

/// VTK takes indices and lengths as they come; wrong ones would crash whoever uses them.
void check_leaf(const fs::path& path, vtkDataSet& data) {
    const vtkIdType points = data.GetNumberOfPoints();
    if (auto* surface = vtkPolyData::SafeDownCast(&data)) {
        for (auto* cells : {surface->GetVerts(), surface->GetLines(), surface->GetPolys(), surface->GetStrips()}) {
            check_cells(path, cells, points);
        }
    } else if (auto* grid = vtkUnstructuredGrid::SafeDownCast(&data)) {
        if (points > 0 && grid->GetNumberOfCells() == 0) {
            refuse(path, "a grid of " + std::to_string(points) + " points without cells");
        }
        check_cells(path, grid->GetCells(), points);
        if (grid->GetCellTypesArray() != nullptr && grid->GetCellTypesArray()->GetNumberOfTuples() != grid->GetNumberOfCells()) {
            refuse(path, "its cells and their kinds differ in number");
        }
        check_polyhedra(path, *grid);
    }
    check_arrays(path, data.GetPointData(), points);
    check_arrays(path, data.GetCellData(), data.GetNumberOfCells());
}

void check_leaves(const fs::path& path, vtkDataObject* object) {
    if (auto* tree = vtkDataObjectTree::SafeDownCast(object)) {
        auto walk = vtkSmartPointer<vtkDataObjectTreeIterator>::New();
        walk->SetDataSet(tree);
        for (walk->InitTraversal(); !walk->IsDoneWithTraversal(); walk->GoToNextItem()) {
            check_leaves(path, walk->GetCurrentDataObject());
        }
    } else if (auto* data = vtkDataSet::SafeDownCast(object)) {
        check_leaf(path, *data);
    }
}

/// `prepare` makes a reader ready, file name included; it is called for the trial and for the reading proper.
template <typename Reader, typename Prepare>
vtkSmartPointer<vtkDataObject> output_of(const fs::path& path, Prepare&& prepare) {
    try_in_child(path, [&] {
        auto reader = vtkSmartPointer<Reader>::New();
        const VtkProblems problems;
        prepare(*reader);
        reader->Update();
        check_leaves(path, reader->GetOutputDataObject(0));
    });
    auto reader = vtkSmartPointer<Reader>::New();
    const VtkProblems problems;
    prepare(*reader);
    reader->Update();
    if (problems.any() || reader->GetErrorCode() != vtkErrorCode::NoError) {
        throw core::InputError("format", "VTK cannot read it: " + problems.first(), {path.string(), {}, {}, {}},
                               "the file is cut short or damaged");
    }
    check_leaves(path, reader->GetOutputDataObject(0));
    return reader->GetOutputDataObject(0);
}

template <typename Reader>
vtkSmartPointer<vtkDataObject> output_of(const fs::path& path) {
    return output_of<Reader>(path, [&](Reader& reader) { reader.SetFileName(path.c_str()); });
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

Field read_one(const fs::path& path, const std::string& format, vtkDataObject* object, const ReadOptions& options, core::Progress& progress) {
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

bool is_xml(std::string_view head, const fs::path& /*path*/) {
    const std::size_t at = head.find("<VTKFile");
    return at != std::string_view::npos && at < 1024;
}
Field read_xml(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    if (core::lower_case(path.extension().string()) == ".vtm") {
        return read_one(path, "VTK XML", output_of<vtkXMLMultiBlockDataReader>(path), options, progress);
    }
    return read_one(path, "VTK XML", output_of<vtkXMLGenericDataObjectReader>(path), options, progress);
}

bool is_legacy(std::string_view head, const fs::path& /*path*/) { return head.starts_with("# vtk DataFile"); }
Field read_legacy(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const auto prepare = [&](vtkGenericDataObjectReader& reader) {
        reader.SetFileName(path.c_str());
        reader.ReadAllScalarsOn();
        reader.ReadAllVectorsOn();
        reader.ReadAllFieldsOn();
    };
    return read_one(path, "VTK legacy", output_of<vtkGenericDataObjectReader>(path, prepare), options, progress);
}

/// The first bytes: content decides, an ending may lie.
std::string head_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string head(16, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    return head;
}

/// Points, faces and whatever numbers these carry. VTK's own reader writes past its memory on damaged files and leaves
/// values on points and faces out.
vtkSmartPointer<vtkPolyData> ply_surface(const fs::path& path) {
    const core::MappedFile file(path);
    const core::PlyFile ply = core::read_ply(file.bytes(), file.name());
    const auto [x, y, z] = core::ply_points(ply, file.name());
    const core::PlyProperty* corners = core::ply_corners(ply, file.name());
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(static_cast<vtkIdType>(x.size()));
    for (std::size_t i = 0; i < x.size(); ++i) {
        points->SetPoint(static_cast<vtkIdType>(i), x[i], y[i], z[i]);
    }
    surface->SetPoints(points);
    const auto add_numbers = [](const core::PlyElement& element, vtkDataSetAttributes& data) {
        for (const auto& property : element.properties) {
            if (property.list || property.name == "x" || property.name == "y" || property.name == "z") {
                continue;
            }
            vtkNew<vtkDoubleArray> values;
            values->SetName(property.name.c_str());
            values->SetNumberOfTuples(static_cast<vtkIdType>(property.values.size()));
            std::copy(property.values.begin(), property.values.end(), values->GetPointer(0));
            data.AddArray(values);
        }
    };
    add_numbers(*ply.find("vertex"), *surface->GetPointData());
    vtkNew<vtkCellArray> faces;
    if (corners != nullptr) {
        for (std::size_t i = 0; i + 1 < corners->list_begin.size(); ++i) {
            faces->InsertNextCell(static_cast<int>(corners->list_begin[i + 1] - corners->list_begin[i]));
            for (std::size_t k = corners->list_begin[i]; k < corners->list_begin[i + 1]; ++k) {
                faces->InsertCellPoint(static_cast<vtkIdType>(corners->values[k]));
            }
        }
        add_numbers(*ply.find("face"), *surface->GetCellData());
    }
    surface->SetPolys(faces);
    return surface;
}

bool is_surface(std::string_view head, const fs::path& path) {
    const std::string ending = core::lower_case(path.extension().string());
    if (head.starts_with("ply\n") || head.starts_with("ply\r\n")) {
        return true;
    }
    if (core::lower_case(head.substr(0, 5)) == "solid" && core::lower_case(head).find("facet") != std::string::npos) {
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
Field read_surface(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const std::string ending = core::lower_case(path.extension().string());
    Field field;
    if (head_of(path).starts_with("ply")) {
        field = read_one(path, "surface (PLY)", ply_surface(path), options, progress);
    } else if (ending == ".obj") {
        field = read_one(path, "surface (OBJ)", output_of<vtkOBJReader>(path), options, progress);
    } else {
        field = read_one(path, "surface (STL)", output_of<vtkSTLReader>(path), options, progress);
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
/// Coordinates that VTK's reader does not know by their names would all be 0; what else it does not know it takes for
/// numbers of the wrong meaning.
void check_tecplot(const fs::path& path) {
    const core::MappedFile file(path);
    const std::string_view text = file.bytes();
    const auto refuse_at = [&](std::size_t at, const std::string& what) {
        throw core::InputError("format", what, {file.name(), 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'), {}, {}},
                               "write the file without them, or as CGNS or VTK");
    };
    for (std::size_t at = text.find('*'); at != std::string_view::npos; at = text.find('*', at + 1)) {
        if (at > 0 && at + 1 < text.size() && std::isdigit(static_cast<unsigned char>(text[at - 1])) != 0 &&
            std::string_view("0123456789.+-").find(text[at + 1]) != std::string_view::npos) {
            refuse_at(at, "repeat counts (98*7.5) in Tecplot files are not read");
        }
    }
    const auto upper = [](char c) { return std::toupper(static_cast<unsigned char>(c)); };
    for (const std::string_view word : {"VARSHARELIST", "CONNECTIVITYSHAREZONE"}) {
        const std::boyer_moore_horspool_searcher searcher(word.begin(), word.end(), upper, [&](char x, char y) { return upper(x) == upper(y); });
        if (const auto* const found = std::search(text.begin(), text.end(), searcher); found != text.end()) {
            refuse_at(static_cast<std::size_t>(found - text.begin()), "what zones of a Tecplot file share (" + std::string(word) + ") is not read");
        }
    }
}

/// A variable that is a coordinate by its name ("X [ m ]") and that the reader took for something else.
void check_coordinates(const fs::path& path, const std::vector<std::string>& variables) {
    for (const auto& variable : variables) {
        const std::string name = core::lower_case(core::trimmed(std::string_view(variable).substr(0, variable.find_first_of("[("))));
        if (name == "x" || name == "y" || name == "z" || name.starts_with("coordinate")) {
            throw core::InputError("format", "the variable '" + variable + "' is a coordinate by its name, which the reader wants bare", {path.string(), {}, {}, {}},
                                   "call the coordinates \"X\", \"Y\", \"Z\" in the line of VARIABLES");
        }
    }
}

Field read_tecplot(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    check_tecplot(path);
    std::vector<std::string> variables;
    const auto prepare = [&](vtkTecplotReader& reader) {
        reader.SetFileName(path.c_str());
        reader.UpdateInformation();
        variables.clear();
        for (int i = 0; i < reader.GetNumberOfDataArrays(); ++i) {
            reader.SetDataArrayStatus(reader.GetDataArrayName(i), 1);
            variables.emplace_back(reader.GetDataArrayName(i));
        }
    };
    const auto object = output_of<vtkTecplotReader>(path, prepare);
    check_coordinates(path, variables);
    return read_one(path, "Tecplot ASCII", object, options, progress);
}

}  // namespace

Importer vtk_xml_importer() { return {"VTK XML", is_xml, read_xml}; }
Importer vtk_legacy_importer() { return {"VTK legacy", is_legacy, read_legacy}; }
Importer surface_file_importer() { return {"surface (STL, PLY, OBJ)", is_surface, read_surface}; }
Importer tecplot_importer() { return {"Tecplot ASCII", is_tecplot, read_tecplot}; }

}  // namespace underbody::postproc
