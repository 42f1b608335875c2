#include "postproc/importers/vtk/vtk_output.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataObjectTree.h>
#include <vtkDataObjectTreeIterator.h>
#include <vtkDataSet.h>
#include <vtkIdTypeArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

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
        if (vtkAbstractArray* array = data->GetAbstractArray(i);
            array != nullptr && array->GetNumberOfTuples() != items) {
            refuse(path, std::string("array '") + (array->GetName() != nullptr ? array->GetName() : "") + "' has " +
                             std::to_string(array->GetNumberOfTuples()) + " values for " + std::to_string(items) +
                             " places");
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
        if (grid->GetCellTypesArray() != nullptr &&
            grid->GetCellTypesArray()->GetNumberOfTuples() != grid->GetNumberOfCells()) {
            refuse(path, "its cells and their kinds differ in number");
        }
        check_polyhedra(path, *grid);
    }
    check_arrays(path, data.GetPointData(), points);
    check_arrays(path, data.GetCellData(), data.GetNumberOfCells());
}

}  // namespace

void check_leaves(const std::filesystem::path& path, vtkDataObject* object) {
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

}  // namespace underbody::postproc
