#include "studio/desktop/scene_widget.h"

#include <GL/gl.h>
#include <QVTKInteractor.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLState.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>

#include <QElapsedTimer>
#include <QEvent>
#include <QPainter>
#include <array>
#include <chrono>
#include <cmath>

#include "studio/desktop/drawing_context.h"

namespace underbody::studio {

namespace {

constexpr int samples = 4;  ///< a pixel, of the smooth picture
constexpr std::chrono::milliseconds rest{120},
    between{10};                                   ///< before a smooth picture, and between those of two views
constexpr std::chrono::nanoseconds turn{1000000};  ///< in which a second view belongs to the same turn of the loop
constexpr int points_per_inch = 72;                ///< as Qt's widgets of VTK: letters are given in pixels

QColor colour(const double* of) { return QColor::fromRgbF(of[0], of[1], of[2]); }

}  // namespace

SceneWidget::SceneWidget(vtkGenericOpenGLRenderWindow* window, QWidget* parent) : QWidget(parent), window_(window) {
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
    setAttribute(Qt::WA_OpaquePaintEvent);
    window_->SetReadyForRendering(false);
    vtkNew<QVTKInteractor> interactor;
    interactor->SetRenderWindow(window_);
    interactor->Initialize();
    interactor->EnableRenderOff();  // whoever turns the view asks for the next picture by its event
    vtkNew<vtkInteractorStyleTrackballCamera> style;
    interactor->SetInteractorStyle(style);
    smooth_.setSingleShot(true);
    connect(&smooth_, &QTimer::timeout, this, &SceneWidget::draw_smoothly);
    later_.setSingleShot(true);
    connect(&later_, &QTimer::timeout, this, [this] {
        if (stale_) {
            draw();
        }
    });
    auto& context = DrawingContext::instance();
    context.begin();
    context.when_known(this, [this] { update(); });
}

SceneWidget::~SceneWidget() {
    if (served_) {
        window_->MakeCurrent();
        window_->Finalize();
        window_->SetReadyForRendering(false);
    }
}

void SceneWidget::draw() {
    stale_ = true;
    if (isVisible() && draw_first()) {
        update();
    }
}

QImage SceneWidget::picture() {
    DrawingContext::instance().wait();
    draw_now(samples);
    return image_;
}

/// Several samples a pixel take a software renderer three times as long (30 ms for 620 x 400 points, of 10): there the
/// first picture of anything has one, and the smooth one follows at rest.
/// Where another view drew in this turn of the event loop, this one waits for the next: false.
bool SceneWidget::draw_first() {
    if (others_.isValid() && drew_last_ != this && others_.nsecsElapsed() < turn.count()) {
        later_.start(0);
        return false;
    }
    const bool twice = DrawingContext::instance().by_software();
    draw_now(twice ? 0 : samples);
    drew_last_ = this;
    others_.start();
    if (twice) {
        smooth_.start(rest);
    }
    return true;
}

/// Of several views each in a turn of the event loop of its own.
void SceneWidget::draw_smoothly() {
    static QElapsedTimer last;
    if (last.isValid() && last.elapsed() < between.count()) {
        smooth_.start(between);
        return;
    }
    if (isVisible()) {
        draw_now(samples);
        last.start();
        update();
    }
}

/// To the widget's pixels.
void SceneWidget::fit() {
    const double ratio = devicePixelRatioF();
    auto* interactor = window_->GetInteractor();
    adapter_.SetDevicePixelRatio(static_cast<float>(ratio), interactor);
    window_->SetDPI(static_cast<int>(std::lround(points_per_inch * ratio)));
    interactor->UpdateSize(static_cast<int>(std::lround(width() * ratio)),
                           static_cast<int>(std::lround(height() * ratio)));
}

void SceneWidget::draw_now(int samples_a_pixel) {
    auto& context = DrawingContext::instance();
    if (context.state() != DrawingContext::State::ready || width() < 1 || height() < 1) {
        return;
    }
    if (!served_) {
        context.serve(*window_);
        served_ = true;
    }
    fit();
    window_->SetMultiSamples(samples_a_pixel);
    window_->MakeCurrent();
    // Another view drew in the same context since.
    window_->GetState()->Reset();
    window_->Render();
    read();
    stale_ = false;
    seen_ = false;
}

void SceneWidget::read() {
    const int* size = window_->GetSize();
    QImage upside_down(size[0], size[1], QImage::Format_RGB32);
    vtkOpenGLState* state = window_->GetState();
    state->PushReadFramebufferBinding();
    window_->GetDisplayFramebuffer()->Bind(GL_READ_FRAMEBUFFER);
    window_->GetDisplayFramebuffer()->ActivateReadBuffer(0);
    ::glPixelStorei(GL_PACK_ALIGNMENT, 4);
    ::glReadPixels(0, 0, size[0], size[1], GL_BGRA, GL_UNSIGNED_BYTE, upside_down.bits());
    state->PopReadFramebufferBinding();
    image_ = upside_down.mirrored();
    image_.setDevicePixelRatio(devicePixelRatioF());
}

/// Keys are the window's: VTK's own (w: wireframe, s: surface, e: exit, ...) are not ours.
bool SceneWidget::event(QEvent* event) {
    const auto type = event->type();
    if (type != QEvent::KeyPress && type != QEvent::KeyRelease) {
        adapter_.ProcessEvent(event, window_->GetInteractor());
    }
    if (type == QEvent::Resize) {
        fit();
        stale_ = true;
    }
    return QWidget::event(event);
}

void SceneWidget::paintEvent(QPaintEvent* /*event*/) {
    if (stale_ || image_.devicePixelRatioF() != devicePixelRatioF()) {
        draw_first();
    }
    QPainter painter(this);
    if (!image_.isNull()) {
        painter.drawImage(0, 0, image_);
        pictures_ += seen_ ? 0 : 1;
        seen_ = true;
        return;
    }
    auto* renderer = window_->GetRenderers()->GetFirstRenderer();
    QLinearGradient ground(0, 0, 0, height());
    if (renderer != nullptr) {
        ground.setColorAt(0, colour(renderer->GetBackground2()));
        ground.setColorAt(1, colour(renderer->GetBackground()));
    }
    painter.fillRect(rect(), ground);
    if (DrawingContext::instance().state() == DrawingContext::State::impossible) {
        painter.setPen(palette().color(QPalette::Text));
        painter.drawText(rect().adjusted(12, 12, -12, -12), Qt::AlignCenter | Qt::TextWordWrap,
                         "The 3D view needs OpenGL 3.2, which this display does not offer; numbers and the pictures of "
                         "Show do not. On a server, start the program under Xvfb with the package libgl1-mesa-dri "
                         "installed.");
    }
}

}  // namespace underbody::studio
