// What the files of the 3D view share.
#pragma once

#include <vtkActor.h>
#include <vtkAppendPolyData.h>
#include <vtkAxesActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCellPicker.h>
#include <vtkDataArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkOrientationMarkerWidget.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataSilhouette.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkSmartPointer.h>
#include <vtkSphereSource.h>
#include <vtkStaticCellLocator.h>
#include <vtkTexture.h>

#include <QTimer>
#include <tuple>
#include <vector>

#include "postproc/loads/mirror_plane.h"
#include "studio/desktop/scene.h"
#include "studio/desktop/scene_widget.h"
#include "studio/desktop/whole_picture.h"

namespace underbody::studio {

struct Scene::Prepared {
    std::shared_ptr<const postproc::Field> field;
    postproc::MirrorPlane mirror;
    struct Surface {
        std::size_t zone = 0;
        vtkSmartPointer<vtkPolyData> surface;
        vtkSmartPointer<vtkPolyData> stand_in;          ///< of many faces: what is turned
        vtkSmartPointer<vtkStaticCellLocator> locator;  ///< of many faces: a click need not go through all
    };
    std::vector<Surface> surfaces;
};

struct Scene::Parts : QObject {
    SceneWidget* widget = nullptr;
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
        vtkSmartPointer<vtkPolyData> whole;  ///< of many faces, for which the mappers draw a stand-in
    };
    std::vector<Surface> surfaces;
    std::vector<bool> seen;
    Choice choice;
    bool mirrored = false, edges = false;
    postproc::MirrorPlane mirror;  ///< of the prepared sides
    Scene* scene = nullptr;
    vtkNew<vtkCallbackCommand> on_turn, on_hold, on_ask;
    QTimer hover, turned;
    Pose held{};  ///< as it was when a hand took hold of it
    bool holding = false;
    void follow_hand();
    /// Of what is seen, both sides of a half model: at most some thousands.
    [[nodiscard]] std::vector<std::array<double, 3>> some_places() const;
    QPoint pressed;
    vtkNew<vtkAppendPolyData> other;  ///< all of another body
    vtkNew<vtkPolyDataSilhouette> rim;
    vtkNew<vtkActor> rim_actor;
    std::shared_ptr<const Prepared> outlined;
    std::vector<bool> tinted;
    vtkNew<vtkSphereSource> dot;
    vtkNew<vtkActor> dot_actor;

    std::unique_ptr<WholePicture> whole;  ///< none where all faces are turned
    vtkNew<vtkTexture> whole_drawn;
    vtkNew<vtkCallbackCommand> before_drawing;
    QTimer rest, soon;
    std::string whole_of, asked_of;  ///< what the picture of all faces shows; what was asked for last

    /// Shows the picture of all faces where it is that of what is seen; else the stand-in, and asks for it at rest.
    void choose_drawn();
    void dress_bar();
    void dress_axes();
    void dress_dot();
    void dress_rim();
    Surface new_surface();
    void size_marker();
    void size_bar();
    std::string bar_label, bar_unit;  ///< of what is coloured
    std::string title_bar();
    /// Size of the view and its pixels across, ends of the colours, what they are of.
    std::tuple<int, int, int, double, double, std::string, std::string> bar_sized_for;
    void ask_for_whole();
    /// Of the zones that are seen.
    void show_actors(bool shown);
    [[nodiscard]] bool visible(const Surface& surface) const {
        return surface.zone < seen.size() && seen[surface.zone];
    }
    [[nodiscard]] WholePicture::Wanted wanted_whole() const;

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
vtkDataArray* array_of(vtkPolyData& surface, const postproc::ArrayInfo& info);
vtkDataArray* array_of(const postproc::Zone& zone, const postproc::ArrayInfo& info);

}  // namespace underbody::studio
