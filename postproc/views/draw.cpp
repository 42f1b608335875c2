// A scene as a PNG file: VTK draws the surfaces and lines, `draw_overlay.cpp` what is written beside them.
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkContourFilter.h>
#include <vtkDoubleArray.h>
#include <vtkLight.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <mutex>

#include "core/error.h"
#include "core/virtual_display.h"
#include "postproc/field/vector_math.h"
#include "postproc/views/colours.h"
#include "postproc/views/display_draws.h"
#include "postproc/views/draw_overlay.h"

namespace underbody::postproc {

namespace {

using Point = std::array<double, 3>;

Point unit(const Point& a) {
    const double size = std::sqrt(dot(a, a));
    return size > 0 ? Point{a[0] / size, a[1] / size, a[2] / size} : Point{0, 0, 1};
}

/// One display for the whole process: the user's, or one of our own.
class Display {
public:
    static Display& instance() {
        static Display display;
        return display;
    }
    void ensure() {
        const std::lock_guard lock(mutex_);
        if (own_ != nullptr || display_draws()) {
            return;
        }
        own_ = std::make_unique<core::VirtualDisplay>(1600, 1200);
        ::setenv("DISPLAY", own_->name().c_str(), 1);
    }
    void end() {
        const std::lock_guard lock(mutex_);
        if (own_ != nullptr) {
            ::unsetenv("DISPLAY");
            own_.reset();
        }
    }

private:
    std::mutex mutex_;
    std::unique_ptr<core::VirtualDisplay> own_;
};

/// Right, up and toward the eye, as a camera sees the axes.
struct ViewAxes {
    Point right, up, back;
    explicit ViewAxes(const Camera& camera) {
        back = unit({-camera.towards[0], -camera.towards[1], -camera.towards[2]});
        right = cross(camera.up, back);
        if (dot(right, right) < 1e-12) {  // looking along `up`
            right = cross(Point{1, 0, 0}, back);
            if (dot(right, right) < 1e-12) {
                right = {0, 1, 0};
            }
        }
        right = unit(right);
        up = cross(back, right);
    }
};

class Painter {
public:
    explicit Painter(const Scene& scene)
        : scene_(scene), axes_(scene.camera), layout_(scene), values_(range_of_values()) {
        range_ = drawn_range(scene.range.value_or(values_), scene.colours);
    }

    std::string paint() {
        window_->SetOffScreenRendering(1);
        window_->SetSize(scene_.width, scene_.height);
        window_->SetMultiSamples(8);
        window_->SetNumberOfLayers(2);
        if (window_->SupportsOpenGL() == 0) {
            throw core::SystemError(
                "display", "the display cannot draw (no OpenGL)", {},
                "install the Debian package libgl1-mesa-dri, or unset DISPLAY so that Xvfb is used");
        }
        const double right = layout_.width / scene_.width;
        const double low = layout_.bottom / scene_.height;
        main_->SetViewport(0, low, right, low + layout_.height / scene_.height);
        main_->SetBackground(1, 1, 1);
        main_->SetLayer(0);
        over_->SetLayer(1);
        over_->InteractiveOff();
        // The part of the window that the main renderer leaves must be white too.
        back_->SetBackground(1, 1, 1);
        back_->SetLayer(0);
        window_->AddRenderer(back_);
        window_->AddRenderer(main_);
        window_->AddRenderer(over_);
        make_colours();
        find_middle();
        for (const auto& surface : scene_.surfaces) {
            add(surface);
        }
        for (const auto& line : scene_.lines) {
            add(line);
        }
        place_camera();
        Overlay overlay(*over_, scene_, layout_);
        overlay.add_title();
        overlay.add_bar(range_, values_);
        overlay.add_scale(layout_.height / (2 * scale_));
        overlay.add_axes({axes_.right, axes_.up});
        return png();
    }

private:
    [[nodiscard]] std::pair<double, double> range_of_values() const {
        std::pair<double, double> range{std::numeric_limits<double>::infinity(),
                                        -std::numeric_limits<double>::infinity()};
        const auto widen = [&](const std::vector<double>& values) {
            for (const double v : values) {
                if (std::isfinite(v)) {
                    range.first = std::min(range.first, v);
                    range.second = std::max(range.second, v);
                }
            }
        };
        for (const auto& surface : scene_.surfaces) {
            widen(surface.values);
        }
        for (const auto& line : scene_.lines) {
            widen(line.values);
        }
        return range;
    }

    void make_colours() {
        constexpr int steps = 256;
        colours_->SetNumberOfTableValues(steps);
        colours_->SetRange(range_.first, range_.second);
        colours_->SetNanColor(0.75, 0.75, 0.75, 1);
        for (int i = 0; i < steps; ++i) {
            const auto c = colour_at(scene_.colours, i / (steps - 1.0));
            colours_->SetTableValue(i, c[0], c[1], c[2], 1);
        }
        colours_->Build();
    }

    static vtkSmartPointer<vtkPoints> points_of(const std::vector<Point>& from) {
        auto points = vtkSmartPointer<vtkPoints>::New();
        points->SetNumberOfPoints(static_cast<vtkIdType>(from.size()));
        for (std::size_t i = 0; i < from.size(); ++i) {
            points->SetPoint(static_cast<vtkIdType>(i), from[i].data());
        }
        return points;
    }

    static void give_values(vtkPolyData& data, const std::vector<double>& values) {
        if (values.size() != static_cast<std::size_t>(data.GetNumberOfPoints())) {
            return;
        }
        vtkNew<vtkDoubleArray> array;
        array->SetName("value");
        array->SetNumberOfTuples(data.GetNumberOfPoints());
        std::copy(values.begin(), values.end(), array->GetPointer(0));
        data.GetPointData()->SetScalars(array);
    }

    vtkSmartPointer<vtkActor> actor_for(vtkPolyData& data, bool coloured, const Point& colour) {
        vtkNew<vtkPolyDataMapper> mapper;
        mapper->SetInputData(&data);
        mapper->SetScalarVisibility(coloured ? 1 : 0);
        mapper->SetLookupTable(colours_);
        mapper->UseLookupTableScalarRangeOn();
        mapper->InterpolateScalarsBeforeMappingOn();
        auto actor = vtkSmartPointer<vtkActor>::New();
        actor->SetMapper(mapper);
        actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
        main_->AddActor(actor);
        return actor;
    }

    /// What draws has single precision: everything is drawn about the middle, however far from the origin it lies.
    void find_middle() {
        constexpr double far = std::numeric_limits<double>::infinity();
        Point lower = {far, far, far};
        Point upper = {-far, -far, -far};
        for_points([&](const Point& p) {
            for (std::size_t k = 0; k < 3; ++k) {
                lower[k] = std::min(lower[k], p[k]);
                upper[k] = std::max(upper[k], p[k]);
            }
        });
        for (std::size_t k = 0; k < 3; ++k) {
            middle_[k] = lower[k] <= upper[k] ? 0.5 * (lower[k] + upper[k]) : 0;
        }
    }

    [[nodiscard]] vtkSmartPointer<vtkPoints> about_middle(std::vector<Point> points) const {
        for (auto& p : points) {
            for (std::size_t k = 0; k < 3; ++k) {
                p[k] -= middle_[k];
            }
        }
        return points_of(points);
    }

    void add(const DrawnSurface& surface) {
        vtkNew<vtkPolyData> data;
        data->SetPoints(about_middle(surface.points));
        vtkNew<vtkCellArray> cells;
        for (const auto& triangle : surface.triangles) {
            cells->InsertNextCell({static_cast<vtkIdType>(triangle[0]), static_cast<vtkIdType>(triangle[1]),
                                   static_cast<vtkIdType>(triangle[2])});
        }
        data->SetPolys(cells);
        give_values(*data, surface.values);
        vtkSmartPointer<vtkPolyData> drawn = data;
        if (surface.smooth) {
            vtkNew<vtkPolyDataNormals> normals;
            normals->SetInputData(data);
            normals->SetFeatureAngle(30);
            normals->ConsistencyOff();
            normals->SplittingOn();
            normals->Update();
            drawn = normals->GetOutput();
        }
        auto actor = actor_for(*drawn, !surface.values.empty(), surface.colour);
        if (surface.contours > 0) {  // lines of equal value lie on top
            actor->GetMapper()->SetResolveCoincidentTopologyToPolygonOffset();
            actor->GetMapper()->SetRelativeCoincidentTopologyPolygonOffsetParameters(2, 2);
        }
        auto* property = actor->GetProperty();
        property->SetOpacity(surface.opacity);
        // Values are read off the colours: shading may hint at the shape but not change them.
        property->SetAmbient(surface.values.empty() ? 0.35 : 0.80);
        property->SetDiffuse(surface.values.empty() ? 0.65 : 0.20);
        property->SetSpecular(surface.values.empty() ? 0.04 : 0.0);
        property->SetSpecularPower(30);
        if (surface.edges) {
            property->EdgeVisibilityOn();
            property->SetEdgeColor(0.35, 0.35, 0.35);
            property->SetLineWidth(0.5F);
        }
        if (!surface.smooth) {
            property->LightingOff();
        }
        if (surface.contours > 0 && !surface.values.empty()) {
            add_contours(*data, surface.contours);
        }
    }

    void add_contours(vtkPolyData& data, int count) {
        vtkNew<vtkContourFilter> contours;
        contours->SetInputData(&data);
        int i = 0;
        for (const double tick : round_ticks(range_.first, range_.second, count)) {
            const bool zero = std::abs(tick) < 1e-9 * (range_.second - range_.first);
            if (scene_.colours != ColourMap::diverging || !zero) {  // where nothing differs the line of zero is noise
                contours->SetValue(i++, tick);
            }
        }
        contours->Update();
        vtkNew<vtkPolyDataMapper> mapper;
        mapper->SetInputData(contours->GetOutput());
        mapper->ScalarVisibilityOff();
        mapper->SetRelativeCoincidentTopologyLineOffsetParameters(-2, -2);
        mapper->SetResolveCoincidentTopologyToPolygonOffset();
        vtkNew<vtkActor> actor;
        actor->SetMapper(mapper);
        actor->GetProperty()->SetColor(0.12, 0.12, 0.12);
        actor->GetProperty()->SetOpacity(0.45);
        actor->GetProperty()->SetLineWidth(1.0F);
        actor->GetProperty()->LightingOff();
        main_->AddActor(actor);
    }

    void add(const DrawnLine& line) {
        vtkNew<vtkPolyData> data;
        data->SetPoints(about_middle(line.points));
        vtkNew<vtkCellArray> cells;
        cells->InsertNextCell(static_cast<int>(line.points.size()));
        for (std::size_t i = 0; i < line.points.size(); ++i) {
            cells->InsertCellPoint(static_cast<vtkIdType>(i));
        }
        data->SetLines(cells);
        give_values(*data, line.values);
        auto actor = actor_for(*data, !line.values.empty(), line.colour);
        actor->GetProperty()->LightingOff();
        actor->GetProperty()->SetLineWidth(static_cast<float>(std::max(1.0, line.width * layout_.unit)));
        actor->GetProperty()->RenderLinesAsTubesOff();
    }

    /// What must be in the picture: the corners of the given box, or every point.
    template <typename Act>
    void for_points(Act&& act) const {
        if (scene_.camera.box) {
            const auto& b = *scene_.camera.box;
            for (std::size_t corner = 0; corner < 8; ++corner) {
                act(Point{b[corner & 1], b[2 + ((corner >> 1) & 1)], b[4 + ((corner >> 2) & 1)]});
            }
            return;
        }
        for (const auto& surface : scene_.surfaces) {
            std::for_each(surface.points.begin(), surface.points.end(), act);
        }
        for (const auto& line : scene_.lines) {
            std::for_each(line.points.begin(), line.points.end(), act);
        }
    }

    void place_camera() {
        constexpr double far = std::numeric_limits<double>::infinity();
        std::array<double, 6> seen = {far, -far, far, -far, far, -far};  // along right, up, back
        for_points([&](const Point& p) {
            const Point from = {p[0] - middle_[0], p[1] - middle_[1], p[2] - middle_[2]};
            const Point q = {dot(from, axes_.right), dot(from, axes_.up), dot(from, axes_.back)};
            for (std::size_t k = 0; k < 3; ++k) {
                seen[2 * k] = std::min(seen[2 * k], q[k]);
                seen[2 * k + 1] = std::max(seen[2 * k + 1], q[k]);
            }
        });
        if (!(seen[0] <= seen[1])) {
            seen = {-1, 1, -1, 1, -1, 1};
        }
        const auto middle = [&](std::size_t k) { return 0.5 * (seen[2 * k] + seen[2 * k + 1]); };
        const auto half = [&](std::size_t k) { return 0.5 * (seen[2 * k + 1] - seen[2 * k]); };
        Point centre{};
        for (std::size_t i = 0; i < 3; ++i) {
            centre[i] = middle(0) * axes_.right[i] + middle(1) * axes_.up[i] + middle(2) * axes_.back[i];
        }
        constexpr double margin = 1.06;
        scale_ = margin * std::max({half(1), half(0) * layout_.height / layout_.width, 1e-12}) / scene_.camera.zoom;
        const double distance =
            scene_.camera.parallel ? 4 * (half(2) + scale_) : scale_ / std::tan(15 * std::atan(1.0) / 45) + half(2);
        auto* camera = main_->GetActiveCamera();
        camera->SetFocalPoint(centre.data());
        camera->SetPosition(centre[0] + distance * axes_.back[0], centre[1] + distance * axes_.back[1],
                            centre[2] + distance * axes_.back[2]);
        camera->SetViewUp(axes_.up.data());
        camera->SetParallelProjection(scene_.camera.parallel ? 1 : 0);
        camera->SetParallelScale(scale_);
        camera->SetViewAngle(30);
        main_->ResetCameraClippingRange();
    }

    std::string png() {
        window_->Render();
        vtkNew<vtkWindowToImageFilter> grab;
        grab->SetInput(window_);
        grab->SetInputBufferTypeToRGB();
        grab->ReadFrontBufferOff();
        grab->ShouldRerenderOff();
        vtkNew<vtkPNGWriter> writer;
        writer->SetInputConnection(grab->GetOutputPort());
        writer->WriteToMemoryOn();
        writer->SetCompressionLevel(6);
        writer->Write();
        vtkUnsignedCharArray* bytes = writer->GetResult();
        if (bytes == nullptr || bytes->GetNumberOfValues() == 0) {
            throw core::SystemError("display", "the picture could not be drawn");
        }
        return {reinterpret_cast<const char*>(bytes->GetPointer(0)),
                static_cast<std::size_t>(bytes->GetNumberOfValues())};
    }

    const Scene& scene_;
    ViewAxes axes_;
    PictureLayout layout_;
    std::pair<double, double> values_;  ///< of all that is drawn
    std::pair<double, double> range_;   ///< of the colours
    double scale_ = 1;                  ///< half the height of the scene, m
    Point middle_{};                    ///< of what is drawn
    vtkNew<vtkRenderWindow> window_;
    vtkNew<vtkRenderer> back_;
    vtkNew<vtkRenderer> main_;
    vtkNew<vtkRenderer> over_;
    vtkNew<vtkLookupTable> colours_;
};

}  // namespace

std::string draw_png(const Scene& scene) {
    if (scene.width < 64 || scene.height < 64 || scene.width > 8192 || scene.height > 8192) {
        throw core::UsageError("usage", "a picture has 64 to 8192 pixels a side");
    }
    static std::mutex one_at_a_time;  // OpenGL contexts and their threads
    const std::lock_guard lock(one_at_a_time);
    Display::instance().ensure();
    return Painter(scene).paint();
}

void end_drawing() { Display::instance().end(); }

}  // namespace underbody::postproc
