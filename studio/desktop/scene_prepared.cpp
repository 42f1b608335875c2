// The 3D view: a field made ready for drawing, in a job.
#include "postproc/views/stand_in.h"
#include "studio/desktop/scene_parts.h"

namespace underbody::studio {

namespace {

/// More faces than these are turned as fewer, and drawn whole beside the window's thread.
constexpr vtkIdType many_faces = 250000;
constexpr std::size_t fewer_faces = 50000;  ///< that are seen, both sides of a half model together

bool has_faces(const postproc::Zone& zone) { return zone.surface && zone.surface->GetNumberOfCells() > 0; }

/// Side of the cubes of the stand-ins; 0 where all faces can be turned.
double size_of_stand_ins(const postproc::Field& field, bool half) {
    std::vector<vtkPolyData*> all;
    vtkIdType faces = 0;
    for (const auto& zone : field.zones) {
        if (has_faces(zone)) {
            all.push_back(zone.surface);
            faces += zone.surface->GetNumberOfPolys();
        }
    }
    return faces > many_faces ? postproc::stand_in_size(all, half ? fewer_faces / 2 : fewer_faces) : 0;
}

}  // namespace

std::shared_ptr<const Scene::Prepared> Scene::prepare(std::shared_ptr<const postproc::Field> field,
                                                      const std::string& mirror, core::Progress& progress) {
    auto prepared = std::make_shared<Prepared>();
    prepared->field = std::move(field);
    prepared->mirror = postproc::mirror_plane_from(mirror);
    const double size = size_of_stand_ins(*prepared->field, prepared->mirror.is_half());
    for (std::size_t i = 0; i < prepared->field->zones.size(); ++i) {
        const auto& zone = prepared->field->zones[i];
        if (!has_faces(zone)) {
            continue;
        }
        progress.check();
        Prepared::Surface surface;
        surface.zone = i;
        // Points and faces keep their numbers, so that a click finds its value.
        surface.surface = postproc::with_normals(*zone.surface);
        if (size > 0) {
            surface.stand_in = postproc::with_normals(*postproc::stand_in(*zone.surface, size, progress));
        }
        if (auto* clicked = surface.stand_in ? surface.stand_in.Get() : surface.surface.Get();
            clicked->GetNumberOfCells() > 50000) {
            progress.check();
            surface.locator = vtkSmartPointer<vtkStaticCellLocator>::New();
            surface.locator->SetDataSet(clicked);
            surface.locator->BuildLocator();
        }
        prepared->surfaces.push_back(std::move(surface));
    }
    return prepared;
}

}  // namespace underbody::studio
