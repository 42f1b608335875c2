#include "studio/desktop/drawing_context.h"

#include <GL/gl.h>
#include <vtkActor.h>
#include <vtkAxesActor.h>
#include <vtkCallbackCommand.h>
#include <vtkElevationFilter.h>
#include <vtkImageData.h>
#include <vtkImageMapper.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkTexturedActor2D.h>

#include <QCoreApplication>
#include <QtConcurrent>
#include <cstring>
#include <string_view>

#include "postproc/views/display_draws.h"
// The headers of X define words of everyday use: last.
#include <vtkXOpenGLRenderWindow.h>

namespace underbody::studio {

namespace {

void draw_in(vtkRenderWindow& holder, vtkGenericOpenGLRenderWindow& window) {
    vtkNew<vtkCallbackCommand> asked;
    asked->SetClientData(&holder);
    asked->SetCallback([](vtkObject*, unsigned long event, void* data, void* answer) {
        auto& context = *static_cast<vtkRenderWindow*>(data);
        if (event == vtkCommand::WindowMakeCurrentEvent) {
            context.MakeCurrent();
        } else if (event == vtkCommand::WindowIsCurrentEvent) {
            *static_cast<bool*>(answer) = context.IsCurrent();
        } else {
            *static_cast<int*>(answer) = 1;
        }
    });
    for (const auto event : {vtkCommand::WindowMakeCurrentEvent, vtkCommand::WindowIsCurrentEvent,
                             vtkCommand::WindowIsDirectEvent, vtkCommand::WindowSupportsOpenGLEvent}) {
        window.AddObserver(event, asked);
    }
    window.SetOwnContext(0);
    window.SetFrameBlitModeToNoBlit();  // nobody sees the holder: pictures are read
    window.SetReadyForRendering(true);
}

/// What the first view would wait for: programs of a lit surface with colours, of axes without, of what lies flat on
/// the picture as letters do, of the ground, samples and their mean. No letters: VTK's are for one thread at a time.
void draw_something(vtkRenderWindow& holder) {
    vtkNew<vtkGenericOpenGLRenderWindow> window;
    draw_in(holder, *window);
    window->SetSize(64, 64);
    vtkNew<vtkSphereSource> ball;
    vtkNew<vtkElevationFilter> colours;
    colours->SetInputConnection(ball->GetOutputPort());
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(colours->GetOutputPort());
    mapper->InterpolateScalarsBeforeMappingOn();
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    vtkNew<vtkAxesActor> axes;
    axes->AxisLabelsOff();
    vtkNew<vtkImageData> pixels;
    pixels->SetDimensions(2, 2, 1);
    pixels->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
    std::memset(pixels->GetScalarPointer(), 0, 16);
    vtkNew<vtkImageMapper> flat_mapper;
    flat_mapper->SetInputData(pixels);
    flat_mapper->RenderToRectangleOn();
    vtkNew<vtkTexturedActor2D> flat;
    flat->SetMapper(flat_mapper);
    vtkNew<vtkRenderer> renderer;
    renderer->GradientBackgroundOn();
    renderer->AddActor(actor);
    renderer->AddActor(axes);
    renderer->AddActor2D(flat);
    window->AddRenderer(renderer);
    for (const int samples : {0, 4}) {
        window->SetMultiSamples(samples);
        window->Render();
    }
    window->Finalize();
}

DrawingContext::Made make() {
    if (!postproc::display_draws()) {
        return {};
    }
    DrawingContext::Made made;
    vtkNew<vtkXOpenGLRenderWindow> holder;
    holder->SetOffScreenRendering(1);
    holder->SetSize(16, 16);
    if (holder->SupportsOpenGL() == 0) {
        return {};
    }
    holder->Initialize();
    holder->MakeCurrent();
    if (const auto* name = reinterpret_cast<const char*>(::glGetString(GL_RENDERER))) {
        const std::string_view renderer(name);
        made.by_software =
            renderer.find("llvmpipe") != std::string_view::npos || renderer.find("softpipe") != std::string_view::npos;
    }
    draw_something(*holder);
    holder->ReleaseCurrent();  // a context belongs to one thread at a time
    made.holder = holder;
    return made;
}

}  // namespace

DrawingContext::DrawingContext() {
    thread_.setMaxThreadCount(1);
    QObject::connect(&coming_, &QFutureWatcher<Made>::finished, this, [this] { take(); });
    qAddPostRoutine(&DrawingContext::end);
}

/// Never destroyed: VTK's own statics may be gone before it.
DrawingContext& DrawingContext::instance() {
    static auto* context = new DrawingContext;
    return *context;
}

/// With the application: nobody draws any more, and no thread may be in OpenGL while the program ends.
void DrawingContext::end() {
    DrawingContext& context = instance();
    context.thread_.waitForDone();
    context.take();
    context.made_ = {};
    context.state_ = State::impossible;
}

void DrawingContext::begin() {
    if (state_ == State::not_begun) {
        state_ = State::coming;
        coming_.setFuture(QtConcurrent::run(&thread_, make));
    }
}

void DrawingContext::wait() {
    begin();
    coming_.waitForFinished();
    take();
}

void DrawingContext::take() {
    if (state_ == State::coming) {
        made_ = coming_.result();
        state_ = made_.holder != nullptr ? State::ready : State::impossible;
        Q_EMIT known();
    }
}

void DrawingContext::when_known(QObject* receiver, const std::function<void()>& told) {
    if (state_ == State::ready || state_ == State::impossible) {
        told();
    } else {
        connect(this, &DrawingContext::known, receiver, told);
    }
}

void DrawingContext::serve(vtkGenericOpenGLRenderWindow& window) {
    if (made_.holder != nullptr) {
        draw_in(*made_.holder, window);
    }
}

}  // namespace underbody::studio
