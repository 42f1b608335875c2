// What the files of the 3D view share.
#pragma once

#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkAxesActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCellPicker.h>
#include <vtkDataArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkOrientationMarkerWidget.h>
#include <vtkPolyDataMapper.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkSmartPointer.h>
#include <vtkSphereSource.h>

#include <QTimer>
#include <vector>

#include "postproc/loads/mirror_plane.h"
#include "studio/desktop/scene.h"

namespace underbody::studio {

struct Scene::Parts : QObject {
    QVTKOpenGLNativeWidget* widget = nullptr;
    vtkNew<vtkGenericOpenGLRenderWindow> window;
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkScalarBarActor> bar;
    vtkNew<vtkLookupTable> colours;
    vtkNew<vtkAxesActor> axes;
    vtkNew<vtkOrientationMarkerWidget> marker;
    vtkNew<vtkCellPicker> picker;
    std::shared_ptr<const postproc::Field> field;
    struct Surface {
        std::size_t zone = 0;
        vtkSmartPointer<vtkPolyDataMapper> mapper;
        vtkSmartPointer<vtkActor> actor;
        vtkSmartPointer<vtkPolyDataMapper> mirrored_mapper;
        vtkSmartPointer<vtkActor> mirrored;
    };
    std::vector<Surface> surfaces;
    std::vector<bool> seen;
    Choice choice;
    bool mirrored = false;
    postproc::MirrorPlane mirror;  ///< of the prepared sides
    Scene* scene = nullptr;
    vtkNew<vtkCallbackCommand> on_turn;
    QTimer hover;
    QPoint pressed;
    std::vector<bool> tinted;
    vtkNew<vtkSphereSource> dot;
    vtkNew<vtkActor> dot_actor;

    QPoint mouse;
    /// Clicks and the mouse over the view: while it turns, VTK's style keeps all events of the mouse to itself.
    bool eventFilter(QObject* object, QEvent* event) override;
    void hover_now();
    [[nodiscard]] std::optional<Picked> picked_at(const QPoint& place);
    [[nodiscard]] const postproc::ArrayInfo* info(const Surface& surface) const {
        return field->zones[surface.zone].find(choice.name);
    }
};

/// The numbers of an array's chosen component (the size of a vector for -1).
double value_of(vtkDataArray& array, vtkIdType at, int component);
/// Of the surface; nullptr where it has none.
vtkDataArray* array_of(const postproc::Zone& zone, const postproc::ArrayInfo& info);

}  // namespace underbody::studio
