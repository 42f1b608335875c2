// The OpenGL context that all 3D views of the window are drawn in.
#pragma once

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkSmartPointer.h>

#include <QFutureWatcher>
#include <QObject>
#include <QThreadPool>
#include <functional>

namespace underbody::studio {

/// One for all: a software renderer compiles its programs anew for each context (60 ms and more, half a second where
/// its cache on disk is empty). It is made on a thread of its own, which draws something, so that the window's thread
/// does not wait for that either; from then on it belongs to the window's thread. VTK makes it, not Qt: without a 3D
/// view the window holds no OpenGL (70 MB of a software renderer).
class DrawingContext : public QObject {
    Q_OBJECT

public:
    /// Of the program. Only on the window's thread, as all that follows.
    static DrawingContext& instance();

    /// Begins to make it, once; returns at once.
    void begin();
    /// Waits until it is known whether there is one. Begins if nobody did.
    void wait();
    enum class State { not_begun, coming, ready, impossible };
    [[nodiscard]] State state() const { return state_; }
    /// True where the processor draws, which takes three times as long for four samples a pixel.
    [[nodiscard]] bool by_software() const { return made_.by_software; }
    /// Called once the state is `ready` or `impossible`: at once where it is, else unless `receiver` is gone by then.
    void when_known(QObject* receiver, const std::function<void()>& told);

    /// `window` draws in this context from now on; nothing happens unless it is ready.
    void serve(vtkGenericOpenGLRenderWindow& window);

    /// What VTK's window with the context is, and what draws in it.
    struct Made {
        vtkSmartPointer<vtkRenderWindow> holder;  ///< none where this display has no OpenGL 3.2
        bool by_software = false;
    };

Q_SIGNALS:
    void known();

private:
    DrawingContext();
    void take();
    static void end();

    QThreadPool thread_;
    QFutureWatcher<Made> coming_;
    Made made_;
    State state_ = State::not_begun;
};

}  // namespace underbody::studio
