#include "postproc/importers/vtk/vtk_sides.h"

#include <vtkCellArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>

#include <algorithm>

#include "postproc/importers/mesh/face_orientation.h"

namespace underbody::postproc {

namespace {

Buffer<double> points_of(vtkPointSet& data) {
    Buffer<double> points(static_cast<std::size_t>(3 * data.GetNumberOfPoints()));
    for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) {
        data.GetPoint(i, points.data() + 3 * i);
    }
    return points;
}

ElementPart part_of(vtkUnstructuredGrid& grid) {
    ElementPart part;
    part.points = points_of(grid);
    vtkNew<vtkIdList> nodes;
    for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
        const auto type = static_cast<unsigned char>(grid.GetCellType(c));
        grid.GetCellPoints(c, nodes);
        const std::vector<std::int64_t> corners(nodes->begin(), nodes->end());
        part.add(type, corners.data(), corners.size());
        if (type == VTK_POLYHEDRON) {
            grid.GetFaceStream(c, nodes);
            part.polyhedra.insert(part.polyhedra.end(), nodes->begin(), nodes->end());
        }
    }
    return part;
}

/// Only of polygons: what else a surface may hold has no side.
ElementPart part_of(vtkPolyData& surface) {
    ElementPart part;
    part.points = points_of(surface);
    vtkNew<vtkIdList> nodes;
    for (vtkIdType c = 0; c < surface.GetNumberOfPolys(); ++c) {
        surface.GetPolys()->GetCellAtId(c, nodes);
        const std::vector<std::int64_t> corners(nodes->begin(), nodes->end());
        part.add(VTK_POLYGON, corners.data(), corners.size());
    }
    return part;
}

vtkSmartPointer<vtkCellArray> polygons_of(const ElementPart& part) {
    auto cells = vtkSmartPointer<vtkCellArray>::New();
    for (std::size_t i = 0; i < part.elements(); ++i) {
        const std::vector<vtkIdType> corners(part.nodes.begin() + part.offsets[i],
                                             part.nodes.begin() + part.offsets[i + 1]);
        cells->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    }
    return cells;
}

}  // namespace

void settle_sides(Field& field, core::Progress& progress) {
    const bool any_volume =
        field.dimension == 3 &&
        std::any_of(field.zones.begin(), field.zones.end(), [](const Zone& zone) { return zone.volume != nullptr; });
    if (!any_volume) {
        return;  // nothing says where the fluid is
    }
    std::vector<Zone*> zones;
    std::vector<ElementPart> faces;
    for (auto& zone : field.zones) {
        const bool open = zone.surface != nullptr && !zone.normals_into_fluid && zone.surface->GetNumberOfPolys() > 0;
        if (open && zone.surface->GetNumberOfPolys() == zone.surface->GetNumberOfCells()) {
            zones.push_back(&zone);
            faces.push_back(part_of(*zone.surface));
        }
    }
    std::vector<ElementPart> cells;
    for (const auto& zone : field.zones) {
        if (zone.volume != nullptr && field.dimension == 3 && !zones.empty()) {
            cells.push_back(part_of(*zone.volume));
        }
    }
    std::vector<ElementPart*> surfaces;
    for (auto& part : faces) {
        surfaces.push_back(&part);
    }
    std::vector<const ElementPart*> volumes;
    for (const auto& part : cells) {
        volumes.push_back(&part);
    }
    const auto turned = turn_into_one_volume(surfaces, volumes, progress);
    for (std::size_t z = 0; z < zones.size(); ++z) {
        if (turned[z]) {
            zones[z]->surface->SetPolys(polygons_of(faces[z]));
            zones[z]->surface->Modified();
            zones[z]->normals_into_fluid = true;
        }
    }
}

}  // namespace underbody::postproc
