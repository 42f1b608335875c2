// The 3D view: a field made ready for drawing, in a job.
#include <vtkNew.h>
#include <vtkReverseSense.h>
#include <vtkTransform.h>
#include <vtkTransformPolyDataFilter.h>

#include "postproc/views/stand_in.h"
#include "studio/desktop/scene_parts.h"

namespace underbody::studio {

namespace {

/// More faces than these are turned as fewer, and drawn whole beside the window's thread.
constexpr vtkIdType many_faces = 250000;
constexpr std::size_t fewer_faces = 100000;

/// The surface seen in a mirror (through the origin where no place was stated), its faces turned so that they still
/// look outward.
vtkSmartPointer<vtkPolyData> in_mirror(vtkPolyData* surface, const postproc::MirrorPlane& mirror) {
    std::array<double, 3> size = {1, 1, 1}, shift = {0, 0, 0};
    size[static_cast<std::size_t>(mirror.axis)] = -1;
    shift[static_cast<std::size_t>(mirror.axis)] = 2 * mirror.at.value_or(0);
    vtkNew<vtkTransform> transform;
    transform->Translate(shift.data());
    transform->Scale(size.data());
    vtkNew<vtkTransformPolyDataFilter> filter;
    filter->SetInputData(surface);
    filter->SetTransform(transform);
    vtkNew<vtkReverseSense> reverse;
    reverse->SetInputConnection(filter->GetOutputPort());
    reverse->ReverseCellsOn();
    reverse->ReverseNormalsOff();
    reverse->Update();
    return reverse->GetOutput();
}

bool has_faces(const postproc::Zone& zone) { return zone.surface && zone.surface->GetNumberOfCells() > 0; }

/// Side of the cubes of the stand-ins; 0 where all faces can be turned.
double size_of_stand_ins(const postproc::Field& field) {
    std::vector<vtkPolyData*> all;
    vtkIdType faces = 0;
    for (const auto& zone : field.zones) {
        if (has_faces(zone)) {
            all.push_back(zone.surface);
            faces += zone.surface->GetNumberOfPolys();
        }
    }
    return faces > many_faces ? postproc::stand_in_size(all, fewer_faces) : 0;
}

}  // namespace

std::shared_ptr<const Scene::Prepared> Scene::prepare(std::shared_ptr<const postproc::Field> field,
                                                      const std::string& mirror, core::Progress& progress) {
    auto prepared = std::make_shared<Prepared>();
    prepared->field = std::move(field);
    prepared->mirror = postproc::mirror_plane_from(mirror);
    const double size = size_of_stand_ins(*prepared->field);
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
        const auto mirrored = [&](vtkPolyData* of) {
            return prepared->mirror.is_half() ? in_mirror(of, prepared->mirror) : nullptr;
        };
        surface.mirrored = mirrored(surface.surface);
        if (size > 0) {
            surface.stand_in = postproc::with_normals(*postproc::stand_in(*zone.surface, size, progress));
            surface.stand_in_mirrored = mirrored(surface.stand_in);
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
