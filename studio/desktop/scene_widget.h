// The widget of the 3D view.
#pragma once

#include <QVTKInteractorAdapter.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>

#include <QElapsedTimer>
#include <QImage>
#include <QTimer>
#include <QWidget>

namespace underbody::studio {

/// Shows what VTK drew last into `window`. Draws when it is seen and
/// the DrawingContext is ready; until then its ground stands there, and a sentence where there is no OpenGL.
class SceneWidget : public QWidget {
    Q_OBJECT

public:
    SceneWidget(vtkGenericOpenGLRenderWindow* window, QWidget* parent);
    ~SceneWidget() override;

    /// Now if it is seen, else when it is.
    void draw();
    /// What it shows, drawn now, after waiting for the context where it must. Of the window's pixels; empty without
    /// OpenGL.
    QImage picture();
    /// How many pictures were seen so far.
    [[nodiscard]] int pictures() const { return pictures_; }

protected:
    bool event(QEvent* event) override;
    void paintEvent(QPaintEvent* event) override;

private:
    void fit();
    bool draw_first();
    void draw_smoothly();
    void draw_now(int samples_a_pixel);
    void read();
    vtkSmartPointer<vtkGenericOpenGLRenderWindow> window_;
    QVTKInteractorAdapter adapter_;
    QTimer smooth_, later_;
    static inline QElapsedTimer others_;  ///< since a view drew
    static inline const SceneWidget* drew_last_ = nullptr;
    QImage image_;
    bool stale_ = true;  ///< something else is to be drawn
    bool served_ = false;
    bool seen_ = true;  ///< the newest picture
    int pictures_ = 0;
};

}  // namespace underbody::studio
