#include "studio/desktop/sliced_mapper.h"

#include <GL/gl.h>
#include <vtkActor.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLIndexBufferObject.h>
#include <vtkProperty.h>

#include <algorithm>

namespace underbody::studio {

vtkStandardNewMacro(SlicedMapper);

void SlicedMapper::RenderPieceDraw(vtkRenderer* renderer, vtkActor* actor) {
    bool faces_alone =
        actor->GetProperty()->GetRepresentation() == VTK_SURFACE && actor->GetProperty()->GetEdgeVisibility() == 0;
    for (int kind = PrimitiveStart; kind < PrimitiveEnd; ++kind) {
        faces_alone = faces_alone && (kind == PrimitiveTris || Primitives[kind].IBO->IndexCount == 0);
    }
    if (!faces_alone) {
        vtkOpenGLPolyDataMapper::RenderPieceDraw(renderer, actor);
        return;
    }
    constexpr std::size_t slice = 3 * 250000;  // corners
    vtkOpenGLHelper& faces = Primitives[PrimitiveTris];
    const std::size_t all = faces.IBO->IndexCount;
    const int first = PrimitiveIDOffset;
    for (std::size_t from = 0; from < all && !given_up(); from += slice) {
        PrimitiveIDOffset = first + static_cast<int>(from / 3);  // by which colours of faces are found
        UpdateShaders(faces, renderer, actor);
        faces.IBO->Bind();
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(std::min(slice, all - from)), GL_UNSIGNED_INT,
                       reinterpret_cast<const void*>(from * sizeof(unsigned int)));
        faces.IBO->Release();
        glFinish();
    }
    PrimitiveIDOffset = first + static_cast<int>(all / 3);
}

}  // namespace underbody::studio
