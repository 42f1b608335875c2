// The 3D view: what stands beside the body: ground, bar of colours, axes, the dot at a place.
#include <vtkCaptionActor2D.h>
#include <vtkProperty.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>

#include <algorithm>
#include <cmath>

#include "studio/desktop/scene_parts.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

void dress_text(vtkTextProperty& text, int size, bool dark = false) {
    text.SetFontFamilyToArial();
    const double grey = dark ? 0.88 : 0.15;
    text.SetColor(grey, grey, grey);
    text.SetFontSize(size);
    text.BoldOff();
    text.ItalicOff();
    text.ShadowOff();
}

}  // namespace

void Scene::Parts::dress_bar() {
    bar->SetLookupTable(colours);
    bar->SetNumberOfLabels(5);
    bar->SetUnconstrainedFontSize(true);
    bar->SetVerticalTitleSeparation(10);
    bar->SetHeight(0.62);
    bar->SetLabelFormat("%.3g");
    bar->SetMaximumNumberOfColors(256);
    dress_text(*bar->GetTitleTextProperty(), 15);
    dress_text(*bar->GetLabelTextProperty(), 13);
    bar->SetVisibility(false);
    renderer->AddActor2D(bar);
}

void Scene::Parts::dress_axes() {
    for (auto* caption :
         {axes->GetXAxisCaptionActor2D(), axes->GetYAxisCaptionActor2D(), axes->GetZAxisCaptionActor2D()}) {
        dress_text(*caption->GetCaptionTextProperty(), 14);
    }
    axes->SetXAxisLabelText("x");
    axes->SetYAxisLabelText("y");
    axes->SetZAxisLabelText("z");
    marker->SetOrientationMarker(axes);
    marker->SetInteractor(window->GetInteractor());
    marker->SetViewport(0, 0, 0.16, 0.2);
    marker->SetEnabled(1);
    marker->InteractiveOff();
}

void Scene::Parts::dress_dot() {
    vtkNew<vtkPolyDataMapper> dot_mapper;
    dot_mapper->SetInputConnection(dot->GetOutputPort());
    dot->SetThetaResolution(16);
    dot->SetPhiResolution(16);
    dot_actor->SetMapper(dot_mapper);
    dot_actor->GetProperty()->SetColor(0.9, 0.1, 0.6);
    dot_actor->SetUseBounds(false);
    dot_actor->SetVisibility(false);
    renderer->AddActor(dot_actor);
}

/// Its letters are read in a small view, too.
void Scene::Parts::size_marker() {
    const int* size = window->GetSize();
    const double least = 96 * widget->devicePixelRatioF();
    const double wide = std::clamp(least / std::max(1, size[0]), 0.16, 0.5);
    const double high = std::clamp(least / std::max(1, size[1]), 0.2, 0.5);
    const double* now = marker->GetViewport();
    if (now[2] != wide || now[3] != high) {
        marker->SetViewport(0, 0, wide, high);
    }
}

/// In a small view the full title would be cut: the name stands beside the views.
std::string Scene::Parts::title_bar() {
    const bool small = widget->width() < 520 || widget->height() < 260;
    std::string title = small ? pretty_unit(bar_unit) : axis_title(bar_label, bar_unit);
    if (9.0 * static_cast<double>(title.size()) > 0.14 * widget->width()) {  // over the bar there is room for a word
        std::replace(title.begin(), title.end(), ' ', '\n');
    }
    bar->SetTitle(title.c_str());
    bar->SetNumberOfLabels(small ? 3 : 5);  // odd: zero is one of them where the colours lie around it
    return title;
}

/// The bar stands as far from the edge as its longest number and its title ask for; both as the view is now.
void Scene::Parts::size_bar() {
    const double* range = colours->GetTableRange();
    const auto now = std::make_tuple(widget->width(), widget->height(), window->GetSize()[0], range[0], range[1],
                                     bar_label, bar_unit);
    if (now == bar_sized_for) {
        return;  // another camera alone: nothing to be measured
    }
    bar_sized_for = now;
    const std::string title = title_bar();
    const double wide = std::max(1, window->GetSize()[0]);
    const auto room_of = [this](vtkTextProperty& property, const std::string& text) {
        std::array<int, 4> box{};
        auto* renderer_of_text = vtkTextRenderer::GetInstance();
        const bool known = renderer_of_text != nullptr &&
                           renderer_of_text->GetBoundingBox(&property, text, box.data(), window->GetDPI());
        return known ? box[1] - box[0] + 1 : 9 * static_cast<int>(text.size());
    };
    const int labels = bar->GetNumberOfLabels();
    int numbers = 0;
    for (int i = 0; i < labels; ++i) {
        const double value = range[0] + (range[1] - range[0]) * i / std::max(1, labels - 1);
        numbers =
            std::max(numbers, room_of(*bar->GetLabelTextProperty(), QString::asprintf("%.3g", value).toStdString()));
    }
    const int words = room_of(*bar->GetTitleTextProperty(), title);
    constexpr int pads = 12;  // beside colours, numbers and edge
    const double thick = std::max(0.0275 * wide, 8.0 * widget->devicePixelRatioF());
    const double room =
        std::clamp(std::max({0.11 * wide, thick + numbers + pads, 1.0 * words + pads}), 1.0, 0.5 * wide);
    bar->SetWidth(room / wide);
    bar->SetBarRatio(thick / room);
    bar->SetPosition(std::min(0.875, 1 - room / wide), 0.2);
}

void Scene::set_ground(bool dark) {
    Parts& p = *parts_;
    p.renderer->SetBackground(dark ? 0.11 : 1, dark ? 0.12 : 1, dark ? 0.13 : 1);
    p.renderer->SetBackground2(dark ? 0.2 : 0.88, dark ? 0.22 : 0.91, dark ? 0.25 : 0.94);
    // In points: the widget gives the window the dots per inch of its screen.
    dress_text(*p.bar->GetTitleTextProperty(), 15, dark);
    dress_text(*p.bar->GetLabelTextProperty(), 13, dark);
    for (auto* caption :
         {p.axes->GetXAxisCaptionActor2D(), p.axes->GetYAxisCaptionActor2D(), p.axes->GetZAxisCaptionActor2D()}) {
        dress_text(*caption->GetCaptionTextProperty(), 14, dark);
    }
}

}  // namespace underbody::studio
