// Plain surfaces: STL and OBJ through VTK, PLY by our own reader.
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPointData.h>
#include <vtkSTLReader.h>

#include <algorithm>
#include <fstream>

#include "core/file.h"
#include "core/ply_file.h"
#include "core/text.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/vtk/vtk_output.h"
#include "postproc/importers/vtk/vtk_zones.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

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
        field = field_from_vtk(path, "surface (PLY)", ply_surface(path), options, progress);
    } else if (ending == ".obj") {
        field = field_from_vtk(path, "surface (OBJ)", output_of<vtkOBJReader>(path, progress), options, progress);
    } else {
        field = field_from_vtk(path, "surface (STL)", output_of<vtkSTLReader>(path, progress), options, progress);
    }
    return field;
}

}  // namespace

Importer surface_file_importer() { return {"surface (STL, PLY, OBJ)", is_surface, read_surface}; }

}  // namespace underbody::postproc
