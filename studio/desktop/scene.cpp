#include "studio/desktop/scene.h"

#include <vtkProperty.h>
#include <vtkRenderWindowInteractor.h>

#include <QBuffer>
#include <QImage>
#include <QTimer>
#include <algorithm>
#include <utility>

#include "studio/desktop/scene_parts.h"

namespace underbody::studio {

namespace {

vtkSmartPointer<vtkPolyDataMapper> new_mapper(vtkLookupTable* colours) {
    auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
    mapper->SetLookupTable(colours);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
    return mapper;
}

}  // namespace

Scene::Scene(QWidget* parent) : parts_(std::make_unique<Parts>()) {
    Parts& p = *parts_;
    p.widget = new SceneWidget(p.window, parent);
    p.window->AddRenderer(p.renderer);
    p.renderer->SetBackground(1, 1, 1);
    p.renderer->SetBackground2(0.88, 0.91, 0.94);
    p.renderer->GradientBackgroundOn();
    p.dress_bar();
    p.dress_axes();
    p.scene = this;
    p.follow_hand();
    p.picker->SetTolerance(0.0005);
    p.picker->PickFromListOn();
    p.widget->installEventFilter(&p);
    p.hover.setSingleShot(true);
    p.hover.setInterval(40);
    QObject::connect(&p.hover, &QTimer::timeout, [&p] { p.hover_now(); });
    p.before_drawing->SetClientData(&p);
    p.before_drawing->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
        auto& parts = *static_cast<Parts*>(data);
        parts.soon.stop();  // drawn now, whoever asked
        parts.size_marker();
        parts.size_bar();
        parts.choose_drawn();
    });
    p.renderer->AddObserver(vtkCommand::StartEvent, p.before_drawing);
    p.renderer->SetBackgroundTexture(p.whole_drawn);
    p.whole_drawn->SetColorModeToDirectScalars();
    p.rest.setSingleShot(true);
    p.rest.setInterval(200);
    QObject::connect(&p.rest, &QTimer::timeout, [&p] { p.ask_for_whole(); });
    p.soon.setSingleShot(true);
    QObject::connect(&p.soon, &QTimer::timeout, [&p] { p.widget->draw(); });
    p.dress_dot();
    p.dress_rim();
}

Scene::~Scene() {
    parts_->hover.stop();
    parts_->turned.stop();
    parts_->rest.stop();
    parts_->soon.stop();
    parts_->renderer->RemoveObserver(parts_->before_drawing);
    parts_->widget->removeEventFilter(parts_.get());
    parts_->window->GetInteractor()->RemoveObserver(parts_->on_turn);
    parts_->window->GetInteractor()->RemoveObserver(parts_->on_ask);
}

QWidget* Scene::widget() const { return parts_->widget; }

const postproc::Field* Scene::field() const { return parts_->field.get(); }

Scene::Parts::Surface Scene::Parts::new_surface() {
    Surface surface;
    surface.mapper = new_mapper(colours);
    surface.mirrored_mapper = new_mapper(colours);
    surface.actor = vtkSmartPointer<vtkActor>::New();
    surface.actor->SetMapper(surface.mapper);
    surface.actor->GetProperty()->SetAmbient(0.62);
    surface.actor->GetProperty()->SetDiffuse(0.42);
    surface.mirrored = vtkSmartPointer<vtkActor>::New();
    surface.mirrored->SetMapper(surface.mirrored_mapper);
    surface.mirrored->SetProperty(surface.actor->GetProperty());
    if (mirror.is_half()) {
        reflect(*surface.mirrored, mirror);
    }
    renderer->AddActor(surface.actor);
    renderer->AddActor(surface.mirrored);
    return surface;
}

/// The actors of the surfaces before are used again where there is no mirror: what was compiled for them stays.
void Scene::show(std::shared_ptr<const Prepared> prepared, bool refit) {
    Parts& p = *parts_;
    auto before = std::exchange(p.surfaces, {});
    const bool again = !p.mirror.is_half() && !prepared->mirror.is_half();
    for (std::size_t i = again ? prepared->surfaces.size() : 0; i < before.size(); ++i) {
        p.renderer->RemoveActor(before[i].actor);
        p.renderer->RemoveActor(before[i].mirrored);
    }
    p.picker->RemoveAllLocators();
    p.picker->InitializePickList();
    p.tinted.clear();
    p.field = prepared->field;
    p.mirror = prepared->mirror;
    p.seen.assign(p.field->zones.size(), true);
    for (const auto& ready : prepared->surfaces) {
        const std::size_t at = p.surfaces.size();
        p.surfaces.push_back(again && at < before.size() ? before[at] : p.new_surface());
        Parts::Surface& surface = p.surfaces.back();
        surface.zone = ready.zone;
        surface.whole = ready.stand_in ? ready.surface : nullptr;
        surface.mapper->SetInputData(ready.stand_in ? ready.stand_in : ready.surface);
        surface.mirrored_mapper->SetInputData(surface.mapper->GetInput());
        surface.actor->GetProperty()->SetColor(0.72, 0.76, 0.8);
        surface.actor->GetProperty()->SetOpacity(1);
        surface.actor->SetVisibility(true);
        surface.mirrored->SetVisibility(false);
        p.picker->AddPickList(surface.actor);
        p.picker->AddPickList(surface.mirrored);
        if (ready.locator) {
            p.picker->AddLocator(ready.locator);  // of both sides
        }
    }
    show_edges(p.edges);
    mirror(p.mirrored);
    p.whole.reset();
    p.whole_of.clear();
    if (std::any_of(p.surfaces.begin(), p.surfaces.end(), [](const auto& one) { return one.whole != nullptr; })) {
        p.whole = std::make_unique<WholePicture>();
    }
    p.renderer->SetTexturedBackground(false);
    if (const auto box = refit ? bounds() : std::nullopt) {
        p.renderer->ResetCamera(box->data());
    }
}

void Scene::set_visible(const std::vector<bool>& zones) {
    parts_->seen = zones;
    for (const auto& surface : parts_->surfaces) {
        const bool seen = surface.zone < zones.size() && zones[surface.zone];
        surface.actor->SetVisibility(seen);
        surface.mirrored->SetVisibility(seen && parts_->mirrored && parts_->mirror.is_half());
    }
}

bool Scene::visible(std::size_t zone) const { return zone < parts_->seen.size() && parts_->seen[zone]; }

void Scene::show_edges(bool edges) {
    parts_->edges = edges;
    for (const auto& surface : parts_->surfaces) {
        surface.actor->GetProperty()->SetEdgeVisibility(edges);
        surface.actor->GetProperty()->SetEdgeColor(0.25, 0.25, 0.25);
        surface.actor->GetProperty()->SetLineWidth(0.6F);
    }
}

void Scene::mirror(bool on) {
    parts_->mirrored = on;
    for (auto& surface : parts_->surfaces) {
        surface.mirrored->SetVisibility(on && parts_->mirror.is_half() && visible(surface.zone));
    }
}

void Scene::render() { parts_->soon.start(0); }

bool Scene::has_drawn() const { return parts_->widget->pictures() > 0; }

std::string Scene::png() {
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    parts_->widget->picture().save(&buffer, "PNG");
    return bytes.toStdString();
}

}  // namespace underbody::studio
