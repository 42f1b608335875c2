// The 3D view: from where it is seen, and how a hand turns it.
#include <vtkCamera.h>
#include <vtkInteractorObserver.h>
#include <vtkMatrix4x4.h>
#include <vtkRenderWindowInteractor.h>

#include <algorithm>
#include <cmath>

#include "studio/desktop/scene_parts.h"

namespace underbody::studio {

namespace {

std::array<double, 3> direction(const std::string& axis, std::array<double, 3> fallback) {
    if (axis.size() != 2 || axis[1] < 'x' || axis[1] > 'z') {
        return fallback;
    }
    std::array<double, 3> result{};
    result[static_cast<std::size_t>(axis[1] - 'x')] = axis[0] == '-' ? -1 : 1;
    return result;
}

constexpr double bar_room = 0.1;  ///< of half the width, for the colour bar on the right

/// How far the picture may be enlarged until one of the places leaves it.
double zoom_that_holds(vtkRenderer& renderer, const std::vector<std::array<double, 3>>& places) {
    constexpr double edge = 0.97;
    double zoom = 10;
    const double* to_view = renderer.GetActiveCamera()
                                ->GetCompositeProjectionTransformMatrix(renderer.GetTiledAspectRatio(), 0, 1)
                                ->GetData();
    for (const auto& [x, y, z] : places) {
        const std::array<double, 4> place = {x, y, z, 1};
        std::array<double, 4> at{};  // from -1 to 1 times the last one
        vtkMatrix4x4::MultiplyPoint(to_view, place.data(), at.data());
        zoom = std::min({zoom, (edge - bar_room) / std::max(1e-3, std::abs(at[0] / at[3])),
                         edge / std::max(1e-3, std::abs(at[1] / at[3]))});
    }
    return zoom;
}

std::vector<std::array<double, 3>> corners(const std::array<double, 6>& box) {
    std::vector<std::array<double, 3>> places;
    for (unsigned corner = 0; corner < 8; ++corner) {
        places.push_back({box[corner & 1U], box[2 + (corner >> 1U & 1U)], box[4 + (corner >> 2U)]});
    }
    return places;
}

}  // namespace

void Scene::share_camera(Scene& other) { parts_->renderer->SetActiveCamera(other.parts_->renderer->GetActiveCamera()); }

void Scene::look_from(const std::string& view, const std::string& forward, const std::string& up,
                      const std::optional<std::array<double, 6>>& box) {
    const auto f = direction(forward, {1, 0, 0});
    const auto u = direction(up, {0, 0, 1});
    // Starboard of someone who looks forward: f x u.
    const std::array<double, 3> s = {f[1] * u[2] - f[2] * u[1], f[2] * u[0] - f[0] * u[2], f[0] * u[1] - f[1] * u[0]};
    std::array<double, 3> from{};
    std::array<double, 3> top = u;
    for (std::size_t i = 0; i < 3; ++i) {
        if (view == "bottom") {
            from[i] = -u[i];
            top[i] = s[i];
        } else if (view == "top") {
            from[i] = u[i];
            top[i] = -s[i];
        } else if (view == "side") {
            from[i] = s[i];
        } else if (view == "front") {
            from[i] = f[i];
        } else {
            from[i] = 1.0 * f[i] + 0.8 * s[i] - 0.45 * u[i];
        }
    }
    vtkCamera* camera = parts_->renderer->GetActiveCamera();
    camera->SetFocalPoint(0, 0, 0);
    camera->SetPosition(from[0], from[1], from[2]);
    camera->SetViewUp(top[0], top[1], top[2]);
    camera->SetParallelProjection(view != "iso");
    camera->SetWindowCenter(0, 0);
    const double most = view == "iso" ? 1.2 : 1.15;  // a body fills less than the ball around it
    if (const auto all = box ? box : bounds()) {
        parts_->renderer->ResetCamera(all->data());
        const bool own = !box || box == bounds();  // else others are larger, of which the box is all that is known
        camera->Zoom(std::min(most, zoom_that_holds(*parts_->renderer, own ? parts_->some_places() : corners(*all))));
    } else {
        parts_->renderer->ResetCamera();
        camera->Zoom(most);
    }
    camera->SetWindowCenter(bar_room, 0);
}

std::vector<std::array<double, 3>> Scene::Parts::some_places() const {
    std::vector<std::array<double, 3>> places;
    for (const auto& surface : surfaces) {
        auto* points = visible(surface) ? surface.mapper->GetInput()->GetPoints() : nullptr;
        const vtkIdType count = points != nullptr ? points->GetNumberOfPoints() : 0;
        for (vtkIdType i = 0; i < count; i += std::max<vtkIdType>(1, count / 2000)) {
            places.emplace_back();
            points->GetPoint(i, places.back().data());
            if (mirrored && mirror.is_half()) {
                places.push_back(places.back());
                auto& across = places.back()[static_cast<std::size_t>(mirror.axis)];
                across = 2 * mirror.at.value_or(0) - across;
            }
        }
    }
    return places;
}

Scene::Pose Scene::pose() const {
    vtkCamera& camera = *parts_->renderer->GetActiveCamera();
    Pose pose{};
    camera.GetPosition(pose.data());
    camera.GetFocalPoint(&pose[3]);
    camera.GetViewUp(&pose[6]);
    pose[9] = camera.GetParallelScale();
    return pose;
}

void Scene::set_pose(const Pose& pose) {
    vtkCamera& camera = *parts_->renderer->GetActiveCamera();
    camera.SetPosition(pose.data());
    camera.SetFocalPoint(&pose[3]);
    camera.SetViewUp(&pose[6]);
    camera.SetParallelScale(pose[9]);
    parts_->renderer->ResetCameraClippingRange();
}

bool Scene::in_hand() const { return parts_->holding || parts_->turned.isActive(); }

/// Who follows while the view is turned is told of each step; who keeps it, when the hand rests: a wheel turns it step
/// by step.
void Scene::Parts::follow_hand() {
    auto* interactor = window->GetInteractor();
    auto* style = interactor->GetInteractorStyle();
    on_ask->SetClientData(this);
    on_ask->SetCallback(
        [](vtkObject*, unsigned long, void* data, void*) { static_cast<Parts*>(data)->scene->render(); });
    interactor->AddObserver(vtkCommand::RenderEvent, on_ask);
    on_turn->SetClientData(this);
    on_turn->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
        const auto& listener = static_cast<Parts*>(data)->scene->on_turn;
        if (listener) {
            listener();
        }
    });
    on_hold->SetClientData(this);
    on_hold->SetCallback([](vtkObject*, unsigned long event, void* data, void*) {
        auto& parts = *static_cast<Parts*>(data);
        parts.holding = event == vtkCommand::StartInteractionEvent;
        if (!parts.holding && parts.scene->pose() != parts.held) {  // not of a click
            parts.turned.start();
        } else if (parts.holding && !parts.turned.isActive()) {  // else of a turn that nobody was told of yet
            parts.held = parts.scene->pose();
        }
    });
    style->AddObserver(vtkCommand::StartInteractionEvent, on_hold);
    style->AddObserver(vtkCommand::EndInteractionEvent, on_hold);
    style->AddObserver(vtkCommand::InteractionEvent, on_turn);
    interactor->AddObserver(vtkCommand::MouseWheelForwardEvent, on_turn);
    interactor->AddObserver(vtkCommand::MouseWheelBackwardEvent, on_turn);
    turned.setSingleShot(true);
    turned.setInterval(150);
    QObject::connect(&turned, &QTimer::timeout, [this] {
        if (holding) {
            turned.start();
        } else if (scene->on_turned) {
            scene->on_turned(scene->pose());
        }
    });
}

}  // namespace underbody::studio
