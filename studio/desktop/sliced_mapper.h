// Very many faces drawn in slices.
#pragma once

#include <vtkOpenGLPolyDataMapper.h>

#include <functional>

namespace underbody::studio {

/// Draws a slice of the faces after the other, each when the one before is done: a software renderer sorts all that it
/// is given before it draws any of it (200 bytes a face), and between two slices the drawing can be given up.
class SlicedMapper : public vtkOpenGLPolyDataMapper {
public:
    static SlicedMapper* New();
    vtkTypeMacro(SlicedMapper, vtkOpenGLPolyDataMapper);

    /// Asked after each slice: true gives the rest up.
    std::function<bool()> given_up = [] { return false; };

    void RenderPieceDraw(vtkRenderer* renderer, vtkActor* actor) override;
};

}  // namespace underbody::studio
