#include "postproc/views/draw_overlay.h"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "postproc/views/colours.h"

namespace underbody::postproc {

namespace {

// In units.
constexpr double bar_space = 196;
constexpr double title_space = 108;
constexpr double scale_space = 60;
constexpr double axes_space = 170;
constexpr double title_size = 36;
constexpr double number_size = 25;

bool has_bar(const Scene& scene) { return !scene.value_name.empty(); }
bool has_scale(const Scene& scene) { return scene.scale_bar && scene.camera.parallel; }

}  // namespace

PictureLayout::PictureLayout(const Scene& scene)
    : unit(scene.text_size * std::min(scene.height / 800.0, scene.width / 1100.0)) {
    bottom = has_scale(scene) ? scale_space * unit : 0;
    width = scene.width - (has_bar(scene) ? bar_space * unit : 0);
    height = scene.height - bottom - (scene.title.empty() ? 0 : title_space * unit);
}

void Overlay::text(const std::string& words, double x, double y, double size, bool bold, double grey, int align) {
    vtkNew<vtkTextActor> actor;
    actor->SetInput(words.c_str());
    actor->SetPosition(x, y);
    auto* property = actor->GetTextProperty();
    property->SetFontFamilyToArial();
    property->SetFontSize(std::max(6, static_cast<int>(std::lround(size * layout_.unit))));
    property->SetBold(bold ? 1 : 0);
    property->SetColor(grey, grey, grey);
    property->SetJustification(align < 0 ? VTK_TEXT_LEFT : align > 0 ? VTK_TEXT_RIGHT : VTK_TEXT_CENTERED);
    property->SetVerticalJustificationToCentered();
    renderer_.AddViewProp(actor);
}

void Overlay::shapes(const std::vector<Vector>& points, const std::vector<Polygon>& polygons,
                     const std::vector<Polygon>& lines, const std::vector<Vector>& colours, double width) {
    vtkNew<vtkPoints> places;
    for (const auto& p : points) {
        places->InsertNextPoint(p.data());
    }
    vtkNew<vtkUnsignedCharArray> rgb;
    rgb->SetNumberOfComponents(3);
    vtkNew<vtkCellArray> line_cells;
    vtkNew<vtkCellArray> polygon_cells;
    for (const auto& line : lines) {
        line_cells->InsertNextCell(static_cast<vtkIdType>(line.size()), line.data());
    }
    for (const auto& polygon : polygons) {
        polygon_cells->InsertNextCell(static_cast<vtkIdType>(polygon.size()), polygon.data());
    }
    for (const auto& c : colours) {
        rgb->InsertNextTuple3(255 * c[0], 255 * c[1], 255 * c[2]);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(places);
    data->SetLines(line_cells);
    data->SetPolys(polygon_cells);
    data->GetCellData()->SetScalars(rgb);
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(data);
    vtkNew<vtkActor2D> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetLineWidth(static_cast<float>(std::max(1.0, width * layout_.unit)));
    renderer_.AddViewProp(actor);
}

void Overlay::add_title() {
    if (scene_.title.empty()) {
        return;
    }
    // Long names are written smaller rather than cut off: a letter is about 0.6 of its height wide.
    const double room = scene_.width / layout_.unit - 48;
    const auto fitting = [&](const std::string& words, double size) {
        return std::min(size, room / (0.6 * static_cast<double>(std::max<std::size_t>(1, words.size()))));
    };
    text(scene_.title, 24 * layout_.unit, scene_.height - 34 * layout_.unit, fitting(scene_.title, title_size), true,
         0.1, -1);
    text(scene_.subtitle, 24 * layout_.unit, scene_.height - 78 * layout_.unit, fitting(scene_.subtitle, number_size),
         false, 0.35, -1);
}

void Overlay::add_bar(std::pair<double, double> range, std::pair<double, double> values) {
    if (!has_bar(scene_)) {
        return;
    }
    const double unit = layout_.unit;
    const double left = scene_.width - (bar_space - 30) * unit;
    const double wide = 30 * unit;
    const double bottom = (scene_.axes ? axes_space : 96) * unit;
    const double top = scene_.height - (title_space + 76) * unit;
    constexpr int steps = 128;
    std::vector<Vector> points;
    std::vector<Polygon> polygons;
    std::vector<Vector> colours;
    const auto add = [&](const std::vector<Vector>& corners, double share) {
        Polygon polygon;
        for (const auto& corner : corners) {
            polygon.push_back(static_cast<long long>(points.size()));
            points.push_back(corner);
        }
        polygons.push_back(std::move(polygon));
        colours.push_back(colour_at(scene_.colours, share));
    };
    for (int i = 0; i < steps; ++i) {
        const double y0 = bottom + (top - bottom) * i / steps;
        const double y1 = bottom + (top - bottom) * (i + 1) / steps;
        add({{left, y0, 0}, {left + wide, y0, 0}, {left + wide, y1, 0}, {left, y1, 0}}, (i + 0.5) / steps);
    }
    std::vector<Vector> frame = {{left, bottom, 0}, {left + wide, bottom, 0}, {left + wide, top, 0}, {left, top, 0}};
    Polygon outline = {0, 1};
    const double slack = 1e-6 * (range.second - range.first);
    const double point = 18 * unit;
    if (values.second > range.second + slack) {
        add({{left, top, 0}, {left + wide, top, 0}, {left + wide / 2, top + point, 0}}, 1);
        frame.push_back({left + wide / 2, top + point, 0});
        outline.insert(outline.end(), {2, static_cast<long long>(frame.size()) - 1, 3, 0});
    } else {
        outline.insert(outline.end(), {2, 3, 0});
    }
    std::vector<Polygon> lines = {outline};
    if (values.first < range.first - slack) {
        add({{left, bottom, 0}, {left + wide, bottom, 0}, {left + wide / 2, bottom - point, 0}}, 0);
        frame.push_back({left + wide / 2, bottom - point, 0});
        lines.push_back({0, static_cast<long long>(frame.size()) - 1, 1});
    }
    shapes(points, polygons, {}, colours, 1);
    std::vector<Vector> greys(lines.size(), {0.3, 0.3, 0.3});
    // As many as have room for their numbers.
    const int ticks = std::clamp(static_cast<int>((top - bottom) / (1.5 * number_size * unit)), 2, 6);
    for (const double tick : round_ticks(range.first, range.second, ticks)) {
        const double y = bottom + (top - bottom) * (tick - range.first) / (range.second - range.first);
        const auto first = static_cast<long long>(frame.size());
        frame.insert(frame.end(), {{left + wide, y, 0}, {left + wide + 8 * unit, y, 0}});
        lines.push_back({first, first + 1});
        greys.push_back({0.3, 0.3, 0.3});
        const bool zero = std::abs(tick) < 1e-12 * (range.second - range.first);
        text(core::format_number(zero ? 0.0 : tick, 5), left + wide + 14 * unit, y, number_size, false, 0.15, -1);
    }
    shapes(frame, {}, lines, greys, 1.2);
    const double right = scene_.width - 16 * unit;
    text(scene_.value_name, right, top + 62 * unit, number_size, true, 0.15, 1);
    if (!scene_.value_unit.empty() && scene_.value_unit != "1") {
        text("[" + scene_.value_unit + "]", right, top + 32 * unit, number_size, false, 0.15, 1);
    }
}

void Overlay::add_scale(double pixels_per_metre) {
    if (!has_scale(scene_)) {
        return;
    }
    const double unit = layout_.unit;
    const double length = round_below(0.24 * layout_.width / pixels_per_metre);
    const double pixels = length * pixels_per_metre;
    const double x = 28 * unit;
    const double y = 30 * unit;
    const double tick = 7 * unit;
    const Vector black = {0.1, 0.1, 0.1};
    shapes({{x, y, 0},
            {x + pixels, y, 0},
            {x, y - tick, 0},
            {x, y + tick, 0},
            {x + pixels, y - tick, 0},
            {x + pixels, y + tick, 0}},
           {}, {{0, 1}, {2, 3}, {4, 5}}, {black, black, black}, 2.5);
    const std::string label = length < 0.9995e-3 ? core::format_number(length * 1e6, 3) + " um"
                              : length < 0.9995  ? core::format_number(length * 1e3, 3) + " mm"
                              : length < 999.5   ? core::format_number(length, 3) + " m"
                                                 : core::format_number(length * 1e-3, 3) + " km";
    text(label, x + pixels + 14 * unit, y, number_size, false, 0.1, -1);
}

void Overlay::add_axes(const ScreenAxes& axes) {
    if (!scene_.axes) {
        return;
    }
    const double unit = layout_.unit;
    const double x = scene_.width - (has_bar(scene_) ? 0.5 * bar_space : 88) * unit;
    const double y = 80 * unit;
    const double length = 46 * unit;
    std::vector<Vector> points = {{x, y, 0}};
    std::vector<Polygon> lines;
    std::vector<Vector> colours;
    static constexpr std::array<std::array<double, 3>, 3> tints = {
        {{0.80, 0.20, 0.20}, {0.10, 0.55, 0.25}, {0.15, 0.35, 0.80}}};
    for (std::size_t k = 0; k < 3; ++k) {
        const double dx = axes.right[k];
        const double dy = axes.up[k];
        const double seen = std::hypot(dx, dy);
        if (seen < 0.12) {
            continue;  // it looks at the viewer
        }
        points.push_back({x + length * dx, y + length * dy, 0});
        lines.push_back({0, static_cast<long long>(points.size()) - 1});
        colours.push_back(tints[k]);
        const double reach = length + 16 * unit / seen;
        text(scene_.axis_names[k], x + reach * dx, y + reach * dy, 22, false, 0.2, 0);
    }
    shapes(points, {}, lines, colours, 2.6);
}

}  // namespace underbody::postproc
