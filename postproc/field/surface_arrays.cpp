#include "postproc/field/surface_arrays.h"

#include <vtkCellArray.h>
#include <vtkDataArrayRange.h>
#include <vtkDoubleArray.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>

namespace underbody::postproc {

namespace {

std::span<const Index> integers_of(vtkDataArray& array, std::vector<Index>& own) {
    const auto count = static_cast<std::size_t>(array.GetNumberOfValues());
    if (auto* exact = vtkArrayDownCast<vtkCellArray::ArrayType64>(&array)) {
        return {exact->GetPointer(0), count};
    }
    own.resize(count);
    if (auto* narrow = vtkArrayDownCast<vtkCellArray::ArrayType32>(&array)) {
        std::copy_n(narrow->GetPointer(0), count, own.begin());
    } else {
        for (std::size_t i = 0; i < count; ++i) {
            own[i] = static_cast<Index>(array.GetTuple1(static_cast<vtkIdType>(i)));
        }
    }
    return own;
}

}  // namespace

SurfaceArrays::SurfaceArrays(vtkPolyData& surface) {
    if (surface.GetPoints() != nullptr) {
        points_ = values_of(*surface.GetPoints()->GetData(), own_points_);
    }
    vtkCellArray* polys = surface.GetPolys();
    if (polys != nullptr && polys->GetNumberOfCells() > 0) {
        offsets_ = integers_of(*polys->GetOffsetsArray(), own_offsets_);
        connectivity_ = integers_of(*polys->GetConnectivityArray(), own_connectivity_);
    }
}

std::span<const double> values_of(vtkDataArray& array, std::vector<double>& own) {
    const auto count = static_cast<std::size_t>(array.GetNumberOfValues());
    if (auto* exact = vtkArrayDownCast<vtkDoubleArray>(&array)) {
        return {exact->GetPointer(0), count};
    }
    own.resize(count);
    const int components = array.GetNumberOfComponents();
    for (std::size_t i = 0; i < count; ++i) {
        own[i] = array.GetComponent(static_cast<vtkIdType>(i) / components, static_cast<int>(i) % components);
    }
    return own;
}

}  // namespace underbody::postproc
