// Buffers become VTK arrays without a copy. Only for .cpp files: it brings VTK's headers.
#pragma once

#include <vtkCellArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkPoints.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>

#include <utility>

#include "postproc/field/field.h"
#include "postproc/importers/mesh/buffer.h"

namespace underbody::postproc {

/// VTK takes the memory over.
template <typename Array, typename T>
vtkSmartPointer<Array> given_to_vtk(Buffer<T>&& buffer, int components = 1) {
    using Value = typename Array::ValueType;
    static_assert(sizeof(Value) == sizeof(T));
    auto array = vtkSmartPointer<Array>::New();
    array->SetNumberOfComponents(components);
    const auto size = static_cast<vtkIdType>(buffer.size());
    array->SetArray(reinterpret_cast<Value*>(buffer.release()), size, 0, Array::VTK_DATA_ARRAY_FREE);
    return array;
}

/// Says which component of a tensor is which, in the order that VTK and ParaView expect: six are symmetric.
inline void name_tensor_components(vtkDataArray& array) {
    static constexpr const char* symmetric[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    static constexpr const char* full[] = {"XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"};
    const int components = array.GetNumberOfComponents();
    const bool wanted = (components == 6 || components == 9) && !array.HasAComponentName();
    for (int k = 0; wanted && k < components; ++k) {
        array.SetComponentName(k, components == 6 ? symmetric[k] : full[k]);
    }
}

inline vtkSmartPointer<vtkPoints> points_from(Buffer<double>&& coordinates) {
    auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetDataType(VTK_DOUBLE);
    points->SetData(given_to_vtk<vtkDoubleArray>(std::move(coordinates), 3));
    return points;
}

}  // namespace underbody::postproc
