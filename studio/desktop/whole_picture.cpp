#include "studio/desktop/whole_picture.h"

#include <malloc.h>
#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkShaderProperty.h>
#include <vtkUnsignedCharArray.h>

#include <QtConcurrent>
#include <algorithm>
#include <sstream>

#include "core/virtual_display.h"
#include "studio/desktop/sliced_mapper.h"

namespace underbody::studio {

namespace {

/// Lit from the side that is seen. By itself VTK asks which way round the corners of a face stand, and in a mirror they
/// stand the other way round.
void light_what_is_seen(vtkActor& actor) {
    actor.GetShaderProperty()->AddFragmentShaderReplacement(
        "//VTK::Normal::Impl", true,
        "//VTK::Normal::Impl\n  if (normalVCVSOutput.z < 0.0) { normalVCVSOutput = -normalVCVSOutput; }\n", false);
}

}  // namespace

void reflect(vtkActor& actor, const postproc::MirrorPlane& mirror) {
    std::array<double, 3> size = {1, 1, 1}, shift = {0, 0, 0};
    size[static_cast<std::size_t>(mirror.axis)] = -1;
    shift[static_cast<std::size_t>(mirror.axis)] = 2 * mirror.at.value_or(0);
    actor.SetScale(size.data());
    actor.SetPosition(shift.data());
    light_what_is_seen(actor);
}

std::string WholePicture::Wanted::key() const {
    std::ostringstream text;
    text.precision(12);
    const auto add = [&](const double* values, int count) {
        for (int i = 0; i < count; ++i) {
            text << values[i] << ' ';
        }
    };
    text << width << ' ' << height << ' ' << camera->GetParallelProjection() << ' ' << camera->GetParallelScale() << ' '
         << camera->GetViewAngle() << ' ';
    add(camera->GetPosition(), 3);
    add(camera->GetFocalPoint(), 3);
    add(camera->GetViewUp(), 3);
    add(camera->GetWindowCenter(), 2);
    add(ground.data(), 3);
    add(ground_above.data(), 3);
    add(colours->GetTableRange(), 2);
    add(colours->GetTableValue(0), 4);  // the two scales of colours differ at their end
    text << colours->GetVectorMode() << ' ' << colours->GetVectorComponent();
    for (const auto& surface : surfaces) {
        text << '\n'
             << static_cast<const void*>(surface.faces.Get()) << ' ' << surface.coloured_by << ' '
             << surface.scalar_mode << ' ' << surface.look->GetEdgeVisibility() << ' ' << surface.look->GetOpacity()
             << ' ' << surface.seen.axis << ' ' << surface.seen.at.value_or(0) << ' ';
        add(surface.look->GetColor(), 3);
    }
    return text.str();
}

/// Keeps what it drew: from another side only the picture is new, not what the surfaces are made of.
class WholePicture::Painter {
public:
    /// nullptr where there is none, or it was given up.
    vtkSmartPointer<vtkImageData> paint(const Wanted& wanted, const std::function<bool()>& given_up) {
        if (!window_) {
            window_ = vtkSmartPointer<vtkRenderWindow>::New();
            window_->SetOffScreenRendering(1);
            window_->AddRenderer(renderer_);
            renderer_->GradientBackgroundOn();
        }
        if (window_->SupportsOpenGL() == 0) {
            return nullptr;
        }
        window_->SetMultiSamples(wanted.by_software ? 0 : 4);
        renderer_->SetUseFXAA(wanted.by_software);
        window_->SetSize(wanted.width, wanted.height);
        auto below = wanted.ground, above = wanted.ground_above;
        renderer_->SetBackground(below.data());
        renderer_->SetBackground2(above.data());
        renderer_->SetActiveCamera(wanted.camera);
        std::vector<Drawn> drawn;
        for (const auto& surface : wanted.surfaces) {
            drawn.push_back(of(surface, wanted.colours, drawn));
        }
        // Only what is no longer wanted is taken out: VTK gives up all that the renderer holds of an actor with it.
        const auto has = [](const std::vector<Drawn>& all, const Drawn& one) {
            return std::any_of(all.begin(), all.end(), [&](const Drawn& other) { return other.actor == one.actor; });
        };
        for (const auto& one : drawn_) {
            if (!has(drawn, one)) {
                renderer_->RemoveActor(one.actor);
            }
        }
        for (const auto& one : drawn) {
            static_cast<SlicedMapper*>(one.actor->GetMapper())->given_up = given_up;
            renderer_->AddActor(one.actor);  // which it is once, however often it is added
        }
        drawn_ = std::move(drawn);
        renderer_->ResetCameraClippingRange();
        window_->Render();
        if (given_up()) {
            return nullptr;
        }
        auto image = vtkSmartPointer<vtkImageData>::New();
        vtkNew<vtkUnsignedCharArray> pixels;
        window_->GetPixelData(0, 0, wanted.width - 1, wanted.height - 1, 0, pixels);
        pixels->SetName("pixels");
        image->SetDimensions(wanted.width, wanted.height, 1);
        image->GetPointData()->SetScalars(pixels);
        return pixels->GetNumberOfTuples() > 0 ? image : nullptr;
    }

private:
    struct Drawn {
        vtkSmartPointer<vtkPolyData> faces;
        vtkSmartPointer<vtkActor> actor;
        bool mirrored = false;
        std::string coloured_by;
    };

    /// `drawn`: what the picture has already: a side and its mirrored one are made of the same.
    Drawn of(const Wanted::Surface& surface, vtkLookupTable* colours, const std::vector<Drawn>& drawn) const {
        Drawn made{surface.faces, nullptr, surface.seen.is_half(), surface.coloured_by};
        for (const auto& known : drawn_) {
            const bool same = known.faces == made.faces && known.mirrored == made.mirrored;
            made.actor = same && known.coloured_by == made.coloured_by ? known.actor : made.actor;
        }
        if (!made.actor) {
            made.actor = vtkSmartPointer<vtkActor>::New();
            if (made.mirrored) {
                reflect(*made.actor, surface.seen);
            } else {
                light_what_is_seen(*made.actor);  // the two sides share a mapper, and with it a program
            }
        }
        for (const auto& other : drawn) {
            if (other.faces == made.faces && other.coloured_by == surface.coloured_by) {
                made.actor->SetMapper(other.actor->GetMapper());
            }
        }
        if (made.actor->GetMapper() == nullptr) {
            // Of its own: what VTK notes in a surface that it draws, it does not note in one that is clicked on.
            vtkNew<vtkPolyData> own;
            own->ShallowCopy(surface.faces);
            vtkNew<SlicedMapper> mapper;
            mapper->SetInputData(own);
            mapper->UseLookupTableScalarRangeOn();
            mapper->InterpolateScalarsBeforeMappingOn();
            made.actor->SetMapper(mapper);
        }
        auto* mapper = made.actor->GetMapper();
        mapper->SetLookupTable(colours);
        mapper->SetScalarVisibility(!surface.coloured_by.empty());
        if (!surface.coloured_by.empty()) {
            mapper->SetScalarMode(surface.scalar_mode);
            mapper->SelectColorArray(surface.coloured_by.c_str());
        }
        made.actor->SetProperty(surface.look);
        return made;
    }

    vtkSmartPointer<vtkRenderWindow> window_;
    vtkNew<vtkRenderer> renderer_;
    std::vector<Drawn> drawn_;
};

WholePicture::WholePicture() : painter_(std::make_shared<Painter>()), newest_(std::make_shared<std::atomic<int>>(0)) {
    thread_.setMaxThreadCount(1);
    thread_.setExpiryTimeout(-1);
}

WholePicture::~WholePicture() {
    ++*newest_;
    QtConcurrent::run(&thread_, [painter = std::move(painter_)]() mutable { painter.reset(); });
    thread_.waitForDone();
}

void WholePicture::ask(const Wanted& wanted, std::function<void(vtkSmartPointer<vtkImageData>)> done) {
    const int mine = ++asked_;
    *newest_ = mine;
    ++busy_;
    QtConcurrent::run(&thread_, [this, mine, wanted, done = std::move(done), newest = newest_, painter = painter_] {
        vtkSmartPointer<vtkImageData> image;
        const auto given_up = [newest, mine] { return *newest != mine; };
        if (!given_up() && core::display_answers()) {
            image = painter->paint(wanted, given_up);
        }
        const bool wanted_still = !given_up();
        QMetaObject::invokeMethod(
            this,
            [this, image, done, wanted_still] {
                --busy_;
                if (wanted_still) {
                    done(image);
                }
            },
            Qt::QueuedConnection);
        if (image != nullptr) {
            ::malloc_trim(0);  // a software renderer sorts all faces into small pieces of memory, which are free now
        }
    });
}

}  // namespace underbody::studio
