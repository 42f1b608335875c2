// All faces of a surface that has too many for the window's thread, drawn on a thread of its own.
#pragma once

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkImageData.h>
#include <vtkLookupTable.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkSmartPointer.h>

#include <QObject>
#include <QThreadPool>
#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "postproc/loads/mirror_plane.h"

namespace underbody::studio {

/// Makes an actor show its surface as a mirror shows it, its faces lit from the side that is seen. Nothing of the
/// surface is copied.
void reflect(vtkActor& actor, const postproc::MirrorPlane& mirror);

class WholePicture : public QObject {
public:
    /// What is to be seen. Nothing of it changes once it was asked for.
    struct Wanted {
        struct Surface {
            vtkSmartPointer<vtkPolyData> faces;
            vtkSmartPointer<vtkProperty> look;
            std::string coloured_by;     ///< an array's name; empty: plain
            int scalar_mode = 0;         ///< of VTK's mapper: on points or faces
            postproc::MirrorPlane seen;  ///< in this mirror; none: as it is
        };
        std::vector<Surface> surfaces;
        vtkSmartPointer<vtkCamera> camera;
        vtkSmartPointer<vtkLookupTable> colours;
        std::array<double, 3> ground{}, ground_above{};
        int width = 0, height = 0;
        bool by_software = false;  ///< one sample a pixel, its edges smoothed in the picture

        /// The same for pictures that are the same.
        [[nodiscard]] std::string key() const;
    };

    WholePicture();
    ~WholePicture() override;

    /// Draws it unless something else is asked for until its turn comes; `done` is called on the window's thread, with
    /// nullptr where this display cannot draw beside a window.
    void ask(const Wanted& wanted, std::function<void(vtkSmartPointer<vtkImageData>)> done);
    /// Nothing that was asked for is wanted any more: what is being drawn is given up at its next slice.
    void give_up() { *newest_ = ++asked_; }
    /// Being drawn, or about to.
    [[nodiscard]] bool busy() const { return busy_ > 0; }

private:
    class Painter;
    std::shared_ptr<Painter> painter_;  ///< lives and dies on the thread of the pool: OpenGL contexts belong to one
    QThreadPool thread_;
    int busy_ = 0;
    int asked_ = 0;
    std::shared_ptr<std::atomic<int>> newest_;
};

}  // namespace underbody::studio
