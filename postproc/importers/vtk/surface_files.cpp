// Plain surfaces: STL and OBJ through VTK, PLY by our own reader.
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPointData.h>
#include <vtkSTLReader.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <limits>
#include <vector>

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
    std::string head(84, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
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

/// The size that a binary STL of so many triangles has.
std::uint64_t size_of_stl(std::uint64_t triangles) { return 84 + 50 * triangles; }

std::uint32_t triangles_of_stl(std::string_view head) {
    std::uint32_t triangles = 0;
    std::copy_n(head.data() + 80, 4, reinterpret_cast<char*>(&triangles));
    return triangles;
}

/// Numbers of places, each once: an open table of the bits of their coordinates.
class Places {
public:
    vtkIdType number(std::array<float, 3> at) {
        for (float& coordinate : at) {
            coordinate += 0.0F;  // -0 is 0
        }
        if (2 * all.size() >= table_.size()) {
            table_.assign(std::max<std::size_t>(1024, 4 * all.size()), free);
            for (std::size_t i = 0; i < all.size(); ++i) {
                table_[slot_of(all[i])] = static_cast<std::uint32_t>(i);
            }
        }
        std::uint32_t& known = table_[slot_of(at)];
        if (known == free) {
            known = static_cast<std::uint32_t>(all.size());
            all.push_back(at);
        }
        return known;
    }
    std::vector<std::array<float, 3>> all;

private:
    static constexpr std::uint32_t free = ~std::uint32_t{0};
    /// Where it stands, or may.
    [[nodiscard]] std::size_t slot_of(const std::array<float, 3>& at) const {
        std::uint64_t hash = 0;
        for (const float coordinate : at) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, &coordinate, sizeof bits);
            hash = (hash ^ bits) * 0x9E3779B97F4A7C15U;
            hash ^= hash >> 29U;
        }
        std::size_t slot = hash % table_.size();
        while (table_[slot] != free && std::memcmp(&all[table_[slot]], &at, sizeof at) != 0) {
            slot = slot + 1 < table_.size() ? slot + 1 : 0;
        }
        return slot;
    }
    std::vector<std::uint32_t> table_;
};

/// Its size says that all triangles are there, so that nothing can be wrong but numbers. VTK's reader takes twenty
/// times as long, twice: it must be tried on a file first.
vtkSmartPointer<vtkPolyData> binary_stl_surface(const fs::path& path, core::Progress& progress) {
    const core::MappedFile file(path);
    const std::string_view bytes = file.bytes();
    const std::uint32_t triangles = triangles_of_stl(bytes);
    if (triangles > std::numeric_limits<std::int32_t>::max() / 3) {
        throw core::InputError("format",
                               "it has " + std::to_string(triangles) + " triangles, more than can be numbered",
                               {path.string(), {}, {}, {}});
    }
    Places places;
    vtkNew<vtkCellArray> faces;
    faces->Use32BitStorage();
    faces->AllocateExact(triangles, std::int64_t{3} * triangles);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        if (i % 65536 == 0) {
            progress.check();
            progress.report(0.9 * i / triangles, "reading " + path.filename().string());
        }
        std::array<std::array<float, 3>, 3> corners;
        std::memcpy(&corners, bytes.data() + size_of_stl(i) + 12, sizeof corners);
        std::array<vtkIdType, 3> ids{};
        for (std::size_t k = 0; k < 3; ++k) {
            ids[k] = places.number(corners[k]);
        }
        if (ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0]) {
            faces->InsertNextCell(3, ids.data());
        }
    }
    vtkNew<vtkPoints> points;
    points->SetDataTypeToFloat();
    points->SetNumberOfPoints(static_cast<vtkIdType>(places.all.size()));
    if (!places.all.empty()) {
        std::memcpy(points->GetVoidPointer(0), places.all.data(), places.all.size() * sizeof places.all[0]);
    }
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    surface->SetPoints(points);
    surface->SetPolys(faces);
    return surface;
}

bool is_binary_stl(std::string_view head, const fs::path& path) {
    std::error_code error;
    return head.size() >= 84 && fs::file_size(path, error) == size_of_stl(triangles_of_stl(head));
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
    if (ending == ".stl" && is_binary_stl(head, path)) {
        return true;
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
    } else if (is_binary_stl(head_of(path), path)) {
        field = field_from_vtk(path, "surface (STL)", binary_stl_surface(path, progress), options, progress);
    } else {
        field = field_from_vtk(path, "surface (STL)", output_of<vtkSTLReader>(path, progress), options, progress);
    }
    return field;
}

}  // namespace

Importer surface_file_importer() { return {"surface (STL, PLY, OBJ)", is_surface, read_surface}; }

}  // namespace underbody::postproc
