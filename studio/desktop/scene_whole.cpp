// The 3D view of very many faces: a stand-in is turned, and at rest the picture of all of them takes its place.
#include <vtkLookupTable.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <QApplication>
#include <algorithm>

#include "studio/desktop/drawing_context.h"
#include "studio/desktop/scene_parts.h"

namespace underbody::studio {

WholePicture::Wanted Scene::Parts::wanted_whole() const {
    WholePicture::Wanted wanted;
    wanted.camera = vtkSmartPointer<vtkCamera>::New();
    wanted.camera->DeepCopy(renderer->GetActiveCamera());
    wanted.colours = vtkSmartPointer<vtkLookupTable>::New();
    wanted.colours->DeepCopy(colours);
    renderer->GetBackground(wanted.ground.data());
    renderer->GetBackground2(wanted.ground_above.data());
    const int* size = window->GetSize();
    wanted.width = size[0];
    wanted.height = size[1];
    wanted.by_software = DrawingContext::instance().by_software();
    for (const auto& surface : surfaces) {
        if (!visible(surface)) {
            continue;
        }
        auto look = vtkSmartPointer<vtkProperty>::New();
        look->DeepCopy(surface.actor->GetProperty());
        const auto add = [&](vtkPolyDataMapper& mapper, const postproc::MirrorPlane& in) {
            const bool coloured = mapper.GetScalarVisibility() != 0 && mapper.GetArrayName() != nullptr;
            wanted.surfaces.push_back({surface.whole ? surface.whole.Get() : surface.mapper->GetInput(), look,
                                       coloured ? std::string(mapper.GetArrayName()) : std::string(),
                                       mapper.GetScalarMode(), in});
        };
        add(*surface.mapper, {});
        if (mirrored && mirror.is_half()) {
            add(*surface.mirrored_mapper, mirror);
        }
    }
    return wanted;
}

void Scene::Parts::show_actors(bool shown) {
    for (const auto& surface : surfaces) {
        surface.actor->SetVisibility(shown && visible(surface));
        surface.mirrored->SetVisibility(shown && visible(surface) && mirrored && mirror.is_half());
    }
}

void Scene::Parts::choose_drawn() {
    if (!whole) {
        return;
    }
    const std::string key = wanted_whole().key();
    const bool drawn = !whole_of.empty() && whole_of == key;
    renderer->SetTexturedBackground(drawn);
    show_actors(!drawn);
    if (!drawn) {
        rest.start();
    }
    if (asked_of != key) {  // another view by now
        whole->give_up();
        asked_of.clear();
    }
}

void Scene::Parts::ask_for_whole() {
    if (!whole || !widget->isVisible()) {
        return;
    }
    if (QApplication::mouseButtons() != Qt::NoButton) {  // held still within a turn
        rest.start();
        return;
    }
    const auto wanted = wanted_whole();
    if (whole->busy() && asked_of == wanted.key()) {
        return;
    }
    asked_of = wanted.key();
    whole->ask(wanted, [this, key = asked_of](const vtkSmartPointer<vtkImageData>& image) {
        if (image == nullptr) {
            return;  // the stand-in stays
        }
        whole_of = key;
        whole_drawn->SetInputData(image);
        widget->draw();
    });
}

bool Scene::stands_in() const { return parts_->whole != nullptr && parts_->renderer->GetTexturedBackground() == 0; }

std::optional<std::array<double, 6>> Scene::bounds() const {
    std::array<double, 6> box{};
    bool any = false;
    for (const auto& surface : parts_->surfaces) {
        if (!parts_->visible(surface)) {
            continue;
        }
        const bool both = parts_->mirrored && parts_->mirror.is_half();
        for (auto* actor : {surface.actor.Get(), both ? surface.mirrored.Get() : surface.actor.Get()}) {
            const double* own = actor->GetBounds();
            for (std::size_t i = 0; i < 6; i += 2) {
                box[i] = any ? std::min(box[i], own[i]) : own[i];
                box[i + 1] = any ? std::max(box[i + 1], own[i + 1]) : own[i + 1];
            }
            any = true;
        }
    }
    return any ? std::optional(box) : std::nullopt;
}

}  // namespace underbody::studio
