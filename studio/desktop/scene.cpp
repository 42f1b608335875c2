#include "studio/desktop/scene.h"

#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkAxesActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCaptionActor2D.h>
#include <vtkCellData.h>
#include <vtkCellPicker.h>
#include <vtkDataArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkLookupTable.h>
#include <vtkObjectFactory.h>
#include <vtkOrientationMarkerWidget.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkSphereSource.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>

#include <QBuffer>
#include <QImage>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QTimer>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "postproc/views/colours.h"
#include "studio/desktop/scene_parts.h"
#include "studio/figures/render.h"

namespace underbody::studio {

using postproc::Location;

bool Scene::possible() {
    static const bool yes = [] {
        QOpenGLContext context;
        context.setFormat(QVTKOpenGLNativeWidget::defaultFormat());
        if (!context.create()) {
            return false;
        }
        QOffscreenSurface surface;
        surface.setFormat(context.format());
        surface.create();
        return surface.isValid() && context.makeCurrent(&surface) && context.format().majorVersion() >= 3;
    }();
    return yes;
}

namespace {

std::array<double, 3> direction(const std::string& axis, std::array<double, 3> fallback) {
    if (axis.size() != 2 || axis[1] < 'x' || axis[1] > 'z') {
        return fallback;
    }
    std::array<double, 3> result{};
    result[static_cast<std::size_t>(axis[1] - 'x')] = axis[0] == '-' ? -1 : 1;
    return result;
}

/// Turns the view by the mouse alone: VTK's keys (w: wireframe, s: surface, e: exit, ...) are not ours.
class MouseStyle : public vtkInteractorStyleTrackballCamera {
public:
    static MouseStyle* New();
    void OnChar() override {}
    void OnKeyPress() override {}
    void OnKeyDown() override {}
};
vtkStandardNewMacro(MouseStyle);

vtkSmartPointer<vtkPolyDataMapper> new_mapper(vtkLookupTable* colours) {
    auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
    mapper->SetLookupTable(colours);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
    return mapper;
}

constexpr int samples = 4;  ///< a pixel, at rest

bool is_software(vtkGenericOpenGLRenderWindow& window) {
    static const bool yes = [&window] {
        const std::string about = window.ReportCapabilities();
        return about.find("llvmpipe") != std::string::npos || about.find("softpipe") != std::string::npos;
    }();
    return yes;
}

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

Scene::Scene(QWidget* parent) : parts_(std::make_unique<Parts>()) {
    Parts& p = *parts_;
    p.widget = new SceneWidget(parent);
    p.widget->setRenderWindow(p.window);
    p.window->AddRenderer(p.renderer);
    p.window->SetMultiSamples(samples);
    p.renderer->SetBackground(1, 1, 1);
    p.renderer->SetBackground2(0.88, 0.91, 0.94);
    p.renderer->GradientBackgroundOn();
    vtkNew<MouseStyle> style;
    p.window->GetInteractor()->SetInteractorStyle(style);
    p.dress_bar();
    p.dress_axes();
    p.scene = this;
    p.picker->SetTolerance(0.0005);
    p.picker->PickFromListOn();
    p.widget->installEventFilter(&p);
    p.hover.setSingleShot(true);
    p.hover.setInterval(40);
    QObject::connect(&p.hover, &QTimer::timeout, [&p] { p.hover_now(); });
    p.on_turn->SetClientData(&p);
    p.on_turn->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
        const auto& turned = static_cast<Parts*>(data)->scene->on_turn;
        if (turned) {
            turned();
        }
    });
    p.before_drawing->SetClientData(&p);
    p.before_drawing->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
        auto& parts = *static_cast<Parts*>(data);
        parts.soon.stop();  // drawn now, whoever asked
        parts.size_marker();
        parts.size_bar();
        parts.choose_drawn();
    });
    p.renderer->AddObserver(vtkCommand::StartEvent, p.before_drawing);
    p.renderer->SetBackgroundTexture(p.whole_drawn);
    p.whole_drawn->SetColorModeToDirectScalars();
    p.rest.setSingleShot(true);
    p.rest.setInterval(200);
    QObject::connect(&p.rest, &QTimer::timeout, [&p] { p.ask_for_whole(); });
    p.soon.setSingleShot(true);
    QObject::connect(&p.soon, &QTimer::timeout, [&p] { p.window->Render(); });
    p.dress_dot();
    // A software renderer draws four samples a pixel in four times the time: while the view is turned one is enough.
    p.on_hold->SetClientData(&p);
    p.on_hold->SetCallback([](vtkObject*, unsigned long event, void* data, void*) {
        auto& window = *static_cast<Parts*>(data)->window;
        if (is_software(window)) {
            window.SetMultiSamples(event == vtkCommand::StartInteractionEvent ? 0 : samples);
        }
    });
    style->AddObserver(vtkCommand::StartInteractionEvent, p.on_hold);
    style->AddObserver(vtkCommand::EndInteractionEvent, p.on_hold);
    style->AddObserver(vtkCommand::InteractionEvent, p.on_turn);
    p.window->GetInteractor()->AddObserver(vtkCommand::MouseWheelForwardEvent, p.on_turn);
    p.window->GetInteractor()->AddObserver(vtkCommand::MouseWheelBackwardEvent, p.on_turn);
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

Scene::~Scene() {
    parts_->hover.stop();
    parts_->rest.stop();
    parts_->soon.stop();
    parts_->renderer->RemoveObserver(parts_->before_drawing);
    parts_->widget->removeEventFilter(parts_.get());
    parts_->window->GetInteractor()->RemoveObserver(parts_->on_turn);
}

QWidget* Scene::widget() const { return parts_->widget; }

const postproc::Field* Scene::field() const { return parts_->field.get(); }

void Scene::show(std::shared_ptr<const Prepared> prepared, bool refit) {
    Parts& p = *parts_;
    for (const auto& surface : p.surfaces) {
        p.renderer->RemoveActor(surface.actor);
        p.renderer->RemoveActor(surface.mirrored);
    }
    p.surfaces.clear();
    p.picker->RemoveAllLocators();
    p.picker->InitializePickList();
    p.tinted.clear();
    p.field = prepared->field;
    p.mirror = prepared->mirror;
    p.seen.assign(p.field->zones.size(), true);
    for (const auto& ready : prepared->surfaces) {
        Parts::Surface surface;
        surface.zone = ready.zone;
        surface.whole = ready.stand_in ? ready.surface : nullptr;
        surface.mapper = new_mapper(p.colours);
        surface.mapper->SetInputData(ready.stand_in ? ready.stand_in : ready.surface);
        surface.mirrored_mapper = new_mapper(p.colours);
        surface.mirrored_mapper->SetInputData(surface.mapper->GetInput());
        surface.actor = vtkSmartPointer<vtkActor>::New();
        surface.actor->SetMapper(surface.mapper);
        surface.actor->GetProperty()->SetColor(0.72, 0.76, 0.8);
        surface.actor->GetProperty()->SetAmbient(0.62);
        surface.actor->GetProperty()->SetDiffuse(0.42);
        surface.mirrored = vtkSmartPointer<vtkActor>::New();
        surface.mirrored->SetMapper(surface.mirrored_mapper);
        surface.mirrored->SetProperty(surface.actor->GetProperty());
        surface.mirrored->SetVisibility(false);
        if (p.mirror.is_half()) {
            reflect(*surface.mirrored, p.mirror);
        }
        p.renderer->AddActor(surface.actor);
        p.renderer->AddActor(surface.mirrored);
        p.picker->AddPickList(surface.actor);
        p.picker->AddPickList(surface.mirrored);
        if (ready.locator) {
            p.picker->AddLocator(ready.locator);  // of both sides
        }
        p.surfaces.push_back(std::move(surface));
    }
    mirror(p.mirrored);
    p.whole.reset();
    p.whole_of.clear();
    if (std::any_of(p.surfaces.begin(), p.surfaces.end(), [](const auto& one) { return one.whole != nullptr; })) {
        p.whole = std::make_unique<WholePicture>();
    }
    p.renderer->SetTexturedBackground(false);
    if (const auto box = refit ? bounds() : std::nullopt) {
        p.renderer->ResetCamera(box->data());
    }
}

void Scene::set_visible(const std::vector<bool>& zones) {
    parts_->seen = zones;
    for (const auto& surface : parts_->surfaces) {
        const bool seen = surface.zone < zones.size() && zones[surface.zone];
        surface.actor->SetVisibility(seen);
        surface.mirrored->SetVisibility(seen && parts_->mirrored && parts_->mirror.is_half());
    }
}

bool Scene::visible(std::size_t zone) const { return zone < parts_->seen.size() && parts_->seen[zone]; }

std::vector<Scene::Choice> Scene::choices() const {
    std::vector<Choice> result;
    const auto add = [&](Choice choice) {
        if (std::none_of(result.begin(), result.end(), [&](const Choice& c) { return c.label == choice.label; })) {
            result.push_back(std::move(choice));
        }
    };
    for (const auto& surface : parts_->surfaces) {
        for (const auto& info : parts_->field->zones[surface.zone].arrays) {
            if (array_of(parts_->field->zones[surface.zone], info) == nullptr) {
                continue;
            }
            std::string words = info.name;
            std::replace(words.begin(), words.end(), '_', ' ');
            add({info.name, -1, words, info.unit});
            for (int c = 0; info.components == 3 && c < 3; ++c) {
                add({info.name, c, words + " " + "xyz"[c], info.unit});
            }
        }
    }
    return result;
}

std::optional<std::array<double, 2>> Scene::range_of(const Choice& choice, bool whole_range) const {
    const Parts& p = *parts_;
    std::vector<double> values;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const auto& surface : p.surfaces) {
        const auto* info = choice.name.empty() ? nullptr : p.field->zones[surface.zone].find(choice.name);
        vtkDataArray* array =
            info != nullptr && visible(surface.zone) ? array_of(p.field->zones[surface.zone], *info) : nullptr;
        const vtkIdType count = array != nullptr ? array->GetNumberOfTuples() : 0;
        // Of a large surface every n-th value is enough to know its hundredths.
        const vtkIdType step = whole_range ? 1 : std::max<vtkIdType>(1, count / 50000);
        for (vtkIdType i = 0; i < count; i += step) {
            const double value = value_of(*array, i, choice.component);
            if (!std::isfinite(value)) {
                continue;
            }
            lowest = std::min(lowest, value);
            highest = std::max(highest, value);
            if (!whole_range) {
                values.push_back(value);
            }
        }
    }
    if (!(lowest <= highest)) {
        return {};
    }
    if (whole_range) {
        return std::array<double, 2>{lowest, highest};
    }
    const std::size_t cut = values.size() / 100;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(cut), values.end());
    lowest = values[cut];
    std::nth_element(values.begin(), values.end() - 1 - static_cast<std::ptrdiff_t>(cut), values.end());
    return std::array<double, 2>{lowest, values[values.size() - 1 - cut]};
}

void Scene::colour_by(const Choice& choice, std::array<double, 2> range) {
    Parts& p = *parts_;
    p.choice = choice;
    bool any = false;
    for (auto& surface : p.surfaces) {
        const auto* info = choice.name.empty() ? nullptr : p.info(surface);
        vtkDataArray* array = info != nullptr ? array_of(p.field->zones[surface.zone], *info) : nullptr;
        // The component along the mirror has the other sign behind it: better plain than wrong.
        const bool across = choice.component >= 0 && p.mirror.axis == choice.component;
        surface.mapper->SetScalarVisibility(array != nullptr && p.tinted.empty());
        surface.mirrored_mapper->SetScalarVisibility(array != nullptr && !across && p.tinted.empty());
        if (array == nullptr) {
            continue;
        }
        any = any || visible(surface.zone);
        for (const auto& mapper : {surface.mapper, surface.mirrored_mapper}) {
            if (info->on == Location::nodes) {
                mapper->SetScalarModeToUsePointFieldData();
            } else {
                mapper->SetScalarModeToUseCellFieldData();
            }
            mapper->SelectColorArray(info->name.c_str());
        }
    }
    auto [lower, upper] = range;
    const bool both_signs = is_around_zero(range);
    if (both_signs) {
        upper = std::max(-lower, upper);
        lower = -upper;
    }
    p.colours->SetNumberOfTableValues(256);
    for (int i = 0; i < 256; ++i) {
        // Those of the pictures and of the report.
        const auto c =
            postproc::colour_at(both_signs ? postproc::ColourMap::diverging : postproc::ColourMap::viridis, i / 255.0);
        p.colours->SetTableValue(i, c[0], c[1], c[2]);
    }
    p.colours->SetTableRange(lower, upper > lower ? upper : lower + 1);
    if (choice.component >= 0) {
        p.colours->SetVectorModeToComponent();
        p.colours->SetVectorComponent(choice.component);
    } else {
        p.colours->SetVectorModeToMagnitude();
    }
    p.bar_label = choice.label;
    p.bar_unit = choice.unit;
    p.bar->SetVisibility(any && p.tinted.empty());
}

void Scene::show_edges(bool edges) {
    for (const auto& surface : parts_->surfaces) {
        surface.actor->GetProperty()->SetEdgeVisibility(edges);
        surface.actor->GetProperty()->SetEdgeColor(0.25, 0.25, 0.25);
        surface.actor->GetProperty()->SetLineWidth(0.6F);
    }
}

void Scene::mirror(bool on) {
    parts_->mirrored = on;
    for (auto& surface : parts_->surfaces) {
        surface.mirrored->SetVisibility(on && parts_->mirror.is_half() && visible(surface.zone));
    }
}

void Scene::share_camera(Scene& other) { parts_->renderer->SetActiveCamera(other.parts_->renderer->GetActiveCamera()); }

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

void Scene::look_from(const std::string& view, const std::string& forward, const std::string& up,
                      const std::optional<std::array<double, 6>>& box) {
    const auto f = direction(forward, {1, 0, 0});
    const auto u = direction(up, {0, 0, 1});
    // Starboard of someone who looks forward: f x u.
    const std::array<double, 3> s = {f[1] * u[2] - f[2] * u[1], f[2] * u[0] - f[0] * u[2], f[0] * u[1] - f[1] * u[0]};
    std::array<double, 3> from{};
    std::array<double, 3> top = u;
    for (std::size_t i = 0; i < 3; ++i) {
        if (view == "bottom") {
            from[i] = -u[i];
            top[i] = s[i];
        } else if (view == "top") {
            from[i] = u[i];
            top[i] = -s[i];
        } else if (view == "side") {
            from[i] = s[i];
        } else if (view == "front") {
            from[i] = f[i];
        } else {
            from[i] = 1.0 * f[i] + 0.8 * s[i] - 0.45 * u[i];
        }
    }
    vtkCamera* camera = parts_->renderer->GetActiveCamera();
    camera->SetFocalPoint(0, 0, 0);
    camera->SetPosition(from[0], from[1], from[2]);
    camera->SetViewUp(top[0], top[1], top[2]);
    camera->SetParallelProjection(view != "iso");
    if (const auto all = box ? box : bounds()) {
        parts_->renderer->ResetCamera(all->data());
    } else {
        parts_->renderer->ResetCamera();
    }
    camera->Zoom(view == "iso" ? 1.2 : 1.15);
    camera->SetWindowCenter(0.1, 0);  // room for the colour bar on the right
}

void Scene::render() {
    if (possible() && parts_->widget->draws_everything()) {
        parts_->soon.start(0);
    }
}

bool Scene::has_drawn() const { return parts_->widget->has_drawn(); }

std::string Scene::png() {
    parts_->widget->draw_at_once();
    if (possible()) {
        parts_->window->Render();
    }
    const QImage image = parts_->widget->grabFramebuffer();
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    image.save(&buffer, "PNG");
    return bytes.toStdString();
}

}  // namespace underbody::studio
