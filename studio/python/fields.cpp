// Fields and zones, their arrays as NumPy arrays that share VTK's memory.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>

#include <sstream>

#include "geometry/mesh/surface_mesh.h"
#include "studio/cli/field_options.h"
#include "studio/python/call.h"
#include "studio/python/docstrings.h"
#include "studio/python/module.h"

namespace underbody::python {

namespace {

using postproc::Field;
using postproc::Zone;

/// A zone keeps its field alive by what both share: the data sets of VTK.
struct ZoneHandle {
    Zone zone;
};

vtkDataSet* data_of(const Zone& zone) {
    return zone.volume != nullptr ? static_cast<vtkDataSet*>(zone.volume.Get())
                                  : static_cast<vtkDataSet*>(zone.surface.Get());
}

/// Keeps a VTK array as long as NumPy looks at its memory.
py::capsule owner(vtkObjectBase* array) {
    array->Register(nullptr);
    return {array, [](void* object) { static_cast<vtkObjectBase*>(object)->UnRegister(nullptr); }};
}

py::dtype dtype_of(int vtk_type) {
    switch (vtk_type) {
        case VTK_FLOAT:
            return py::dtype::of<float>();
        case VTK_DOUBLE:
            return py::dtype::of<double>();
        case VTK_UNSIGNED_CHAR:
            return py::dtype::of<unsigned char>();
        case VTK_INT:
            return py::dtype::of<int>();
        case VTK_LONG:
        case VTK_LONG_LONG:
        case VTK_ID_TYPE:
            return py::dtype::of<std::int64_t>();
        default:
            return py::dtype::of<double>();
    }
}

bool shares(vtkDataArray* array) {
    switch (array->GetDataType()) {
        case VTK_FLOAT:
        case VTK_DOUBLE:
        case VTK_UNSIGNED_CHAR:
        case VTK_INT:
        case VTK_LONG:
        case VTK_LONG_LONG:
        case VTK_ID_TYPE:
            return array->HasStandardMemoryLayout();
        default:
            return false;
    }
}

/// (n) or (n, components), read only. Arrays of a layout that NumPy cannot look at are copied.
py::array numpy_of(vtkDataArray* given) {
    vtkSmartPointer<vtkDataArray> array = given;
    if (!shares(array)) {
        array = vtkSmartPointer<vtkDoubleArray>::New();
        array->DeepCopy(given);
    }
    const py::ssize_t size = array->GetDataTypeSize();
    const py::ssize_t components = array->GetNumberOfComponents();
    const py::ssize_t count = array->GetNumberOfTuples();
    std::vector<py::ssize_t> shape{count}, strides{size * components};
    if (components > 1) {
        shape.push_back(components);
        strides.push_back(size);
    }
    py::array result(dtype_of(array->GetDataType()), shape, strides, array->GetVoidPointer(0), owner(array));
    result.attr("setflags")(py::arg("write") = false);
    return result;
}

vtkDataArray* find_array(const Zone& zone, const std::string& name) {
    vtkDataSet* data = data_of(zone);
    if (data == nullptr) {
        return nullptr;
    }
    auto* array = data->GetCellData()->GetArray(name.c_str());
    return array != nullptr ? array : data->GetPointData()->GetArray(name.c_str());
}

py::array array_of(const Zone& zone, const std::string& name) {
    if (auto* array = find_array(zone, name)) {
        return numpy_of(array);
    }
    std::vector<std::string> known;
    for (const auto& info : zone.arrays) {
        known.push_back(info.name);
    }
    throw core::UsageError("name", "the zone '" + zone.name + "' has no array '" + name + "'", {},
                           core::did_you_mean(name, known));
}

py::array points_of(const Zone& zone) {
    auto* points = vtkPointSet::SafeDownCast(data_of(zone));
    if (points == nullptr || points->GetPoints() == nullptr) {
        return py::array_t<double>(std::vector<py::ssize_t>{0, 3});
    }
    return numpy_of(points->GetPoints()->GetData());
}

/// The faces of a surface (its polygons), the cells of a volume.
vtkCellArray* cells_of(const Zone& zone) {
    if (zone.volume != nullptr) {
        return zone.volume->GetCells();
    }
    if (zone.surface == nullptr) {
        return nullptr;
    }
    return zone.surface->GetNumberOfPolys() > 0   ? zone.surface->GetPolys()
           : zone.surface->GetNumberOfLines() > 0 ? zone.surface->GetLines()
                                                  : zone.surface->GetVerts();
}

py::object vtk_object(vtkObjectBase* object) {
    if (object == nullptr) {
        return py::none();
    }
    std::ostringstream address;
    address << "Addr=" << static_cast<void*>(object);
    const py::object type = py::module_::import("vtkmodules.vtkCommonDataModel").attr(object->GetClassName());
    return type(address.str());
}

std::string text_of(const core::Problem& problem) {
    const std::string where = problem.place.text();
    return where.empty() ? problem.message : where + ": " + problem.message;
}

Field read(const std::string& path, const std::vector<std::string>& zones, const std::vector<std::string>& arrays,
           const studio::FieldOptions& options, bool surfaces_only, const py::object& progress) {
    Call call(progress);
    Field field;
    call.run(call.progress(), [&] {
        postproc::ReadOptions read = options.read_options();
        read.zones = zones;
        read.arrays = arrays;
        read.surfaces_only = surfaces_only;
        field = postproc::read_field(path, read, call.progress());
    });
    return field;
}

void add_zone(py::module_& module) {
    py::class_<postproc::ArrayInfo>(module, "ArrayInfo", docs::ArrayInfo)
        .def_readonly("name", &postproc::ArrayInfo::name, docs::ArrayInfo_name)
        .def_readonly("unit", &postproc::ArrayInfo::unit, docs::ArrayInfo_unit)
        .def_readonly("original_name", &postproc::ArrayInfo::original_name, docs::ArrayInfo_original_name)
        .def_readonly("original_unit", &postproc::ArrayInfo::original_unit, docs::ArrayInfo_original_unit)
        .def_property_readonly(
            "on", [](const postproc::ArrayInfo& info) { return to_string(info.on); },
            "'points', 'faces' or 'cells': where its values are.")
        .def_readonly("components", &postproc::ArrayInfo::components, docs::ArrayInfo_components);
    py::class_<ZoneHandle>(module, "Zone", docs::Zone)
        .def_property_readonly(
            "name", [](const ZoneHandle& z) { return z.zone.name; }, "As the file calls it.")
        .def_property_readonly(
            "id", [](const ZoneHandle& z) { return z.zone.id; }, "The file's number of it; 0 where it has none.")
        .def_property_readonly(
            "kind", [](const ZoneHandle& z) { return to_string(z.zone.kind); },
            "'wall', 'symmetry', 'fluid', ..., 'unknown'.")
        .def_property_readonly(
            "original_kind", [](const ZoneHandle& z) { return z.zone.original_kind; }, docs::Zone_original_kind)
        .def_property_readonly(
            "arrays", [](const ZoneHandle& z) { return z.zone.arrays; }, "What arrays it has, and what they are.")
        .def_property_readonly(
            "points", [](const ZoneHandle& z) { return points_of(z.zone); },
            "Coordinates of the points, m, (n, 3), without a copy.")
        .def_property_readonly(
            "offsets",
            [](const ZoneHandle& z) -> py::object {
                auto* cells = cells_of(z.zone);
                return cells == nullptr ? py::object(py::none()) : py::object(numpy_of(cells->GetOffsetsArray()));
            },
            "Where the points of each face or cell begin in `connectivity`, one more than there are faces.")
        .def_property_readonly(
            "connectivity",
            [](const ZoneHandle& z) -> py::object {
                auto* cells = cells_of(z.zone);
                return cells == nullptr ? py::object(py::none()) : py::object(numpy_of(cells->GetConnectivityArray()));
            },
            "Point numbers of the faces or cells, one after the other.")
        .def_property_readonly(
            "cell_types",
            [](const ZoneHandle& z) -> py::object {
                return z.zone.volume == nullptr ? py::object(py::none())
                                                : py::object(numpy_of(z.zone.volume->GetCellTypesArray()));
            },
            "VTK's cell types of a volume; None of a surface.")
        .def_property_readonly(
            "vtk", [](const ZoneHandle& z) { return vtk_object(data_of(z.zone)); },
            "The same data as an object of vtkmodules (vtkPolyData or vtkUnstructuredGrid), without a copy.")
        .def(
            "__getitem__", [](const ZoneHandle& z, const std::string& name) { return array_of(z.zone, name); },
            "An array by its canonical name, SI, (n) or (n, components), read only, without a copy.")
        .def("__contains__",
             [](const ZoneHandle& z, const std::string& name) { return find_array(z.zone, name) != nullptr; })
        .def("__repr__", [](const ZoneHandle& z) {
            auto* data = data_of(z.zone);
            return "<Zone '" + z.zone.name + "' (" + to_string(z.zone.kind) + "), " +
                   std::to_string(data == nullptr ? 0 : data->GetNumberOfCells()) + " cells>";
        });
}

/// Arrays that look into a mesh, which lives as long as they do.
template <typename T>
py::array view(const T* first, std::size_t rows, py::handle owner) {
    py::array_t<T> result({static_cast<py::ssize_t>(rows), py::ssize_t{3}}, first, owner);
    result.attr("setflags")(py::arg("write") = false);
    return result;
}

void add_surface(py::module_& module) {
    static_assert(sizeof(geometry::Vec3) == 3 * sizeof(double) &&
                  sizeof(geometry::Triangle) == 3 * sizeof(std::int32_t));
    py::class_<geometry::SurfaceMesh>(module, "Surface", docs::SurfaceMesh)
        .def_property_readonly(
            "points",
            [](const py::object& self) {
                const auto& points = self.cast<const geometry::SurfaceMesh&>().points;
                return view(points.empty() ? nullptr : &points.front().x, points.size(), self);
            },
            "m, (n, 3), without a copy.")
        .def_property_readonly(
            "triangles",
            [](const py::object& self) {
                const auto& triangles = self.cast<const geometry::SurfaceMesh&>().triangles;
                return view(triangles.empty() ? nullptr : triangles.front().data(), triangles.size(), self);
            },
            "Point numbers, (n, 3), counter-clockwise seen from the water, without a copy.")
        .def_property_readonly(
            "patch",
            [](const py::object& self) {
                const auto& patch = self.cast<const geometry::SurfaceMesh&>().patch;
                py::array_t<std::int32_t> result(static_cast<py::ssize_t>(patch.size()), patch.data(), self);
                result.attr("setflags")(py::arg("write") = false);
                return result;
            },
            "Index into `patch_names`, one for each triangle.")
        .def_property_readonly(
            "patch_names", [](const geometry::SurfaceMesh& s) { return s.patch_names; }, "Names of the patches.");
}

}  // namespace

void add_fields(py::module_& module) {
    add_zone(module);
    add_surface(module);
    py::class_<Field>(module, "Field", docs::Field)
        .def_readonly("files", &Field::files, docs::Field_files)
        .def_readonly("format", &Field::format, docs::Field_format)
        .def_readonly("writer", &Field::writer, docs::Field_writer)
        .def_readonly("dimension", &Field::dimension)
        .def_readonly("density", &Field::density, docs::Field_density)
        .def_property_readonly("metadata", [](const Field& field) { return field.metadata; })
        .def_property_readonly("zones",
                               [](const Field& field) {
                                   std::vector<ZoneHandle> zones;
                                   for (const Zone& zone : field.zones) {
                                       zones.push_back({zone});
                                   }
                                   return zones;
                               })
        .def_property_readonly("problems", [](const Field& field) {
            std::vector<std::pair<int, std::string>> all;
            for (const auto& problem : field.problems) {
                all.emplace_back(static_cast<int>(problem.severity), text_of(problem));
            }
            return all;
        });
    module.def("read", [](const std::string& path, const std::vector<std::string>& zones,
                          const std::vector<std::string>& arrays, const std::string& length_unit,
                          const std::vector<std::string>& units, const std::string& mesh, const std::string& time,
                          const std::string& base, bool surfaces_only, const py::object& progress) {
        studio::FieldOptions options;
        options.length_unit = length_unit;
        options.units = units;
        options.mesh = mesh;
        options.time = time;
        options.base = base;
        return read(path, zones, arrays, options, surfaces_only, progress);
    });
}

}  // namespace underbody::python
