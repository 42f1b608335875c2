// The 3D view: what is under the mouse, and what is marked.
#include <vtkCellData.h>
#include <vtkPointData.h>
#include <vtkProperty.h>

#include <QApplication>
#include <QMouseEvent>
#include <cmath>

#include "studio/desktop/scene_parts.h"
#include "studio/figures/render.h"

namespace underbody::studio {

using postproc::Location;

double value_of(vtkDataArray& array, vtkIdType at, int component) {
    if (component >= 0) {
        return array.GetComponent(at, component);
    }
    if (array.GetNumberOfComponents() == 1) {
        return array.GetComponent(at, 0);
    }
    double sum = 0;
    for (int c = 0; c < array.GetNumberOfComponents(); ++c) {
        sum += array.GetComponent(at, c) * array.GetComponent(at, c);
    }
    return std::sqrt(sum);
}

vtkDataArray* array_of(vtkPolyData& surface, const postproc::ArrayInfo& info) {
    return info.on == Location::nodes ? surface.GetPointData()->GetArray(info.name.c_str())
                                      : surface.GetCellData()->GetArray(info.name.c_str());
}

vtkDataArray* array_of(const postproc::Zone& zone, const postproc::ArrayInfo& info) {
    return zone.surface ? array_of(*zone.surface, info) : nullptr;
}

/// A click is a press and a release at one place: between others the view was turned.
bool Scene::Parts::eventFilter(QObject* object, QEvent* event) {
    const auto type = event->type();
    if (type == QEvent::MouseButtonPress || type == QEvent::MouseButtonRelease || type == QEvent::MouseMove) {
        const auto* moved = static_cast<const QMouseEvent*>(event);
        mouse = moved->pos();
        if (type == QEvent::MouseButtonPress) {
            pressed = mouse;
        } else if (type == QEvent::MouseMove && moved->buttons() == Qt::NoButton && !hover.isActive()) {
            hover.start();
        }
        const auto& told = moved->button() == Qt::RightButton ? scene->on_menu : scene->on_pick;
        const bool click = type == QEvent::MouseButtonRelease && (mouse - pressed).manhattanLength() <= 3 &&
                           (moved->button() == Qt::LeftButton || moved->button() == Qt::RightButton);
        if (click && told) {
            QTimer::singleShot(0, widget, [this, &told, place = mouse] {  // the style ends its turn first
                if (const auto found = picked_at(place)) {
                    told(*found);
                }
            });
        }
    }
    return QObject::eventFilter(object, event);
}

void Scene::Parts::hover_now() {
    if (scene->on_hover && QApplication::mouseButtons() == Qt::NoButton) {
        if (const auto found = picked_at(mouse)) {
            scene->on_hover(*found);
        }
    }
}

std::optional<Scene::Picked> Scene::pick(const QPoint& place) const { return parts_->picked_at(place); }

std::optional<Scene::Picked> Scene::Parts::picked_at(const QPoint& place) {
    const double ratio = widget->devicePixelRatioF();
    show_actors(true);  // also under the picture of all faces, where the next drawing hides them again
    if (!field || picker->Pick(place.x() * ratio, (widget->height() - 1 - place.y()) * ratio, 0, renderer) == 0) {
        return {};
    }
    for (const auto& surface : surfaces) {
        if (picker->GetActor() != surface.actor && picker->GetActor() != surface.mirrored) {
            continue;
        }
        const auto& zone = field->zones[surface.zone];
        Picked found;
        found.zone = zone.name;
        picker->GetPickPosition(found.at.data());
        if (picker->GetActor() == surface.mirrored) {
            const auto axis = static_cast<std::size_t>(mirror.axis);
            found.at[axis] = 2 * mirror.at.value_or(0) - found.at[axis];
        }
        found.text = QString("%1: x %2, y %3, z %4 mm").arg(QString::fromStdString(zone.name));
        for (const double coordinate : found.at) {
            found.text = found.text.arg(1000 * coordinate, 0, 'f', 2);
        }
        const auto* array_info = info(surface);
        vtkDataArray* array = array_info != nullptr ? array_of(*surface.mapper->GetInput(), *array_info) : nullptr;
        const vtkIdType index =
            array_info != nullptr && array_info->on == Location::nodes ? picker->GetPointId() : picker->GetCellId();
        if (array != nullptr && index >= 0 && index < array->GetNumberOfTuples()) {
            found.text +=
                QString("  ·  %1 %2%3 %4")
                    .arg(QString::fromStdString(choice.label))
                    .arg(QString(surface.whole ? "about " : ""))  // a mean of faces that the stand-in has one for
                    .arg(value_of(*array, index, choice.component), 0, 'g', 5)
                    .arg(QString::fromStdString(pretty_unit(choice.unit)));
        }
        return found;
    }
    return {};
}

void Scene::mark(const std::optional<std::array<double, 3>>& at) {
    Parts& p = *parts_;
    p.dot_actor->SetVisibility(at.has_value());
    const auto box = at ? bounds() : std::nullopt;
    if (box) {
        const double size = std::hypot((*box)[1] - (*box)[0], (*box)[3] - (*box)[2], (*box)[5] - (*box)[4]);
        p.dot->SetCenter(at->data());
        p.dot->SetRadius(0.008 * size);
    }
}

void Scene::tint(const std::vector<bool>& body) {
    Parts& p = *parts_;
    if (p.tinted == body) {
        return;
    }
    p.tinted = body;
    for (const auto& surface : p.surfaces) {
        const bool plain = body.empty();
        const bool is = !plain && surface.zone < body.size() && body[surface.zone];
        surface.actor->GetProperty()->SetColor(plain ? 0.72
                                               : is  ? 0.95
                                                     : 0.55,
                                               plain ? 0.76
                                               : is  ? 0.55
                                                     : 0.65,
                                               plain ? 0.8
                                               : is  ? 0.1
                                                     : 0.8);
        surface.actor->GetProperty()->SetOpacity(plain || is ? 1 : 0.35);
    }
}

}  // namespace underbody::studio
