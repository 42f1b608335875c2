// The 3D view: another body as a line around the one that is shown.
#include <vtkProperty.h>

#include <algorithm>

#include "core/figure.h"
#include "studio/desktop/scene_parts.h"

namespace underbody::studio {

/// Where its faces turn away from who looks, and the rims of its parts. In front of everything: what was larger is seen
/// beside the body, what was smaller on it.
void Scene::Parts::dress_rim() {
    rim->SetInputConnection(other->GetOutputPort());
    rim->SetEnableFeatureAngle(0);
    rim->BorderEdgesOn();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(rim->GetOutputPort());
    mapper->ScalarVisibilityOff();
    mapper->SetResolveCoincidentTopologyToPolygonOffset();
    mapper->SetRelativeCoincidentTopologyLineOffsetParameters(0, -66000);  // of a depth of 65000
    rim_actor->SetMapper(mapper);
    const auto colour = core::palette(1);
    rim_actor->GetProperty()->SetColor(colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
    rim_actor->GetProperty()->LightingOff();
    rim_actor->SetVisibility(false);
    rim_actor->SetPickable(false);
    renderer->AddActor(rim_actor);
}

bool Scene::outline(const std::shared_ptr<const Prepared>& shown) {
    Parts& p = *parts_;
    const bool on = p.rim_actor->GetVisibility() != 0;
    if (on == (shown != nullptr) && (!on || p.outlined == shown)) {
        return false;
    }
    if (shown && p.outlined != shown) {  // one that was shown before is still known: its edges take 14 ms to find
        p.outlined = shown;
        p.other->RemoveAllInputs();
        p.rim->SetCamera(p.renderer->GetActiveCamera());
        for (const auto& surface : shown->surfaces) {
            p.other->AddInputData(surface.stand_in ? surface.stand_in : surface.surface);
        }
    }
    p.rim_actor->GetProperty()->SetLineWidth(static_cast<float>(1.4 * p.widget->devicePixelRatioF()));
    p.rim_actor->SetVisibility(shown != nullptr);
    return true;
}

}  // namespace underbody::studio
