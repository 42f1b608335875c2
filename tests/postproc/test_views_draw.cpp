// Pictures: that they are drawn at all, without a display, and that they show what they were given.
#include <gmock/gmock.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>

#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "core/file.h"
#include "postproc/views/colours.h"
#include "postproc/views/views.h"
#include "tests/support/support.h"

namespace underbody::postproc {
namespace {

/// A sphere whose value is its height.
Scene sphere() {
    DrawnSurface surface;
    constexpr int rings = 24;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j < 2 * rings; ++j) {
            const double theta = M_PI * i / rings;
            const double phi = M_PI * j / rings;
            surface.points.push_back(
                {0.1 * std::sin(theta) * std::cos(phi), 0.1 * std::sin(theta) * std::sin(phi), 0.1 * std::cos(theta)});
            surface.values.push_back(100 * std::cos(theta));
        }
    }
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < 2 * rings; ++j) {
            const int k = (j + 1) % (2 * rings);
            const int a = i * 2 * rings;
            const int b = a + 2 * rings;
            surface.triangles.push_back({a + j, b + j, b + k});
            surface.triangles.push_back({a + j, b + k, a + k});
        }
    }
    Scene scene;
    scene.surfaces.push_back(surface);
    scene.title = "pressure on a sphere";
    scene.subtitle = "radius 100 mm";
    scene.value_name = "pressure";
    scene.value_unit = "Pa";
    scene.width = 600;
    scene.height = 400;
    return scene;
}

TEST(Pictures, AreDrawnWithoutADisplay) {
    ::unsetenv("DISPLAY");
    end_drawing();
    const std::string png = draw_png(sphere());
    EXPECT_THAT(png, testing::StartsWith("\x89PNG"));
    EXPECT_GT(png.size(), 5000U);
    if (const char* folder = std::getenv("UNDERBODY_PICTURES")) {
        core::write_file(std::filesystem::path(folder) / "sphere.png", png);
    }
    Scene diverging = sphere();
    diverging.colours = ColourMap::diverging;
    const std::string other = draw_png(diverging);
    EXPECT_NE(other, png);
    if (const char* folder = std::getenv("UNDERBODY_PICTURES")) {
        core::write_file(std::filesystem::path(folder) / "sphere-diverging.png", other);
    }
    EXPECT_EQ(draw_png(sphere()), png);  // the same scene, the same bytes
}

namespace {

/// Mean difference of two pictures' colours, 0 to 255.
double apart(const std::string& a, const std::string& b) {
    const auto pixels = [](const std::string& png) {
        vtkNew<vtkPNGReader> reader;
        reader->SetMemoryBuffer(png.data());
        reader->SetMemoryBufferLength(static_cast<vtkIdType>(png.size()));
        reader->Update();
        return vtkSmartPointer<vtkImageData>(reader->GetOutput());
    };
    const auto first = pixels(a);
    const auto second = pixels(b);
    auto* x = first->GetPointData()->GetScalars();
    auto* y = second->GetPointData()->GetScalars();
    if (x->GetNumberOfValues() != y->GetNumberOfValues()) {
        return 255;
    }
    double sum = 0;
    for (vtkIdType i = 0; i < x->GetNumberOfTuples(); ++i) {
        for (int c = 0; c < 3; ++c) {
            sum += std::abs(x->GetComponent(i, c) - y->GetComponent(i, c));
        }
    }
    return sum / (3.0 * static_cast<double>(x->GetNumberOfTuples()));
}

}  // namespace

TEST(Pictures, LookTheSameHoweverFarFromTheOriginTheBodyLies) {
    const std::string here = draw_png(sphere());
    Scene scene = sphere();
    for (auto& point : scene.surfaces[0].points) {
        point = {point[0] + 4e5, point[1] - 3e5, point[2] + 50};
    }
    EXPECT_LT(apart(here, draw_png(scene)), 0.2);
    scene.surfaces[0].values.assign(scene.surfaces[0].values.size(), 0);  // the measure does see a difference
    scene.range = {-100, 100};
    EXPECT_GT(apart(here, draw_png(scene)), 5);
}

TEST(Pictures, SayWhatIsMissingWithoutXvfb) {
    ::unsetenv("DISPLAY");
    end_drawing();
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", "/nowhere", 1);
    try {
        draw_png(sphere());
        ADD_FAILURE() << "drawn without any display";
    } catch (const core::SystemError& error) {
        EXPECT_EQ(error.kind(), "display");
        EXPECT_THAT(error.hint(), testing::HasSubstr("xvfb"));
    }
    ::setenv("PATH", path.c_str(), 1);
}

TEST(ColourMaps, RunFromEndToEndAndAreCentred) {
    EXPECT_NEAR(colour_at(ColourMap::diverging, 0.5)[0], colour_at(ColourMap::diverging, 0.5)[2], 1e-9);
    EXPECT_GT(colour_at(ColourMap::diverging, 0)[2], 0.7);
    EXPECT_GT(colour_at(ColourMap::diverging, 1)[0], 0.7);
    double last = -1;
    for (int i = 0; i <= 100; ++i) {  // viridis grows lighter all along
        const auto c = colour_at(ColourMap::viridis, i / 100.0);
        const double light = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        EXPECT_GT(light, last);
        last = light;
    }
    EXPECT_EQ(drawn_range({-3, 1}, ColourMap::diverging), (std::pair<double, double>{-3, 3}));
    EXPECT_EQ(drawn_range({-3, 1}, ColourMap::viridis), (std::pair<double, double>{-3, 1}));
}

TEST(ColourMaps, TicksAreRound) {
    EXPECT_EQ(round_ticks(1, std::nextafter(1, 2), 6).size(), 1U);  // ended only with the memory
    EXPECT_EQ(drawn_range({1, std::nextafter(1, 2)}, ColourMap::viridis).first, 0.5);
    EXPECT_THAT(round_ticks(-3.2, 7.1, 5),
                testing::Pointwise(testing::DoubleNear(1e-12), std::vector<double>{-2, 0, 2, 4, 6}));
    EXPECT_EQ(round_below(0.037), 0.02);
    EXPECT_EQ(round_below(5.5), 5);
}

}  // namespace
}  // namespace underbody::postproc
