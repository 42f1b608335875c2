// The widget of the 3D view, and how it draws first.
#include <vtkProp.h>
#include <vtkPropCollection.h>
#include <vtkRendererCollection.h>

#include <QOpenGLContext>
#include <QOpenGLFunctions>

#include "studio/desktop/scene_parts.h"

namespace underbody::studio {

void SceneWidget::initializeGL() {
    step_ = Step::colour;
    QVTKOpenGLNativeWidget::initializeGL();
}

void SceneWidget::paintGL() {
    switch (step_) {
        case Step::colour:
            paint_colour();
            return go_on(Step::ground);
        case Step::ground:
            paint_ground();
            return go_on(Step::everything);
        case Step::everything:
            QVTKOpenGLNativeWidget::paintGL();
            drawn_ = true;
    }
}

void SceneWidget::go_on(Step next) {
    QTimer::singleShot(0, this, [this, next] {
        step_ = std::max(step_, next);
        if (step_ == Step::everything) {
            renderWindow()->Render();
        } else {
            update();
        }
    });
}

void SceneWidget::paint_colour() {
    std::array<double, 3> colour{1, 1, 1};
    if (auto* renderer = renderWindow()->GetRenderers()->GetFirstRenderer()) {
        renderer->GetBackground(colour.data());
    }
    auto* gl = context()->functions();
    gl->glClearColor(static_cast<float>(colour[0]), static_cast<float>(colour[1]), static_cast<float>(colour[2]), 1);
    gl->glClear(GL_COLOR_BUFFER_BIT);
}

void SceneWidget::paint_ground() {
    auto* renderers = renderWindow()->GetRenderers();
    std::vector<vtkProp*> hidden;
    for (int i = 0; i < renderers->GetNumberOfItems(); ++i) {
        auto* props = static_cast<vtkRenderer*>(renderers->GetItemAsObject(i))->GetViewProps();
        for (int k = 0; k < props->GetNumberOfItems(); ++k) {
            auto* prop = static_cast<vtkProp*>(props->GetItemAsObject(k));
            if (prop->GetVisibility() != 0) {
                prop->VisibilityOff();
                hidden.push_back(prop);
            }
        }
    }
    QVTKOpenGLNativeWidget::paintGL();
    for (auto* prop : hidden) {
        prop->VisibilityOn();
    }
}

}  // namespace underbody::studio
