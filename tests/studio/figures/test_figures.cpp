// The pictures of core::Figure: one of each kind, drawn without a display and looked at by their pixels.
// With UNDERBODY_KEEP_PICTURES=FOLDER the sheet of demonstrations is written there, for people to look at.
#include <gtest/gtest.h>

#include <QBuffer>
#include <QImage>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "studio/figures/colour_scale.h"
#include "studio/figures/render.h"
#include "tests/support/support.h"

namespace underbody::studio {
namespace {

using core::Colour;
using core::Figure;
using core::palette;

QImage picture(const std::string& name, const Figure& figure, const PictureSize& size = {}) {
    const std::string bytes = render_png(figure, size);
    if (const char* folder = std::getenv("UNDERBODY_KEEP_PICTURES")) {
        core::write_file(std::filesystem::path(folder) / (name + ".png"), bytes);
        core::write_file(std::filesystem::path(folder) / (name + ".pdf"), render_pdf(figure, size));
    }
    QImage image =
        QImage::fromData(reinterpret_cast<const uchar*>(bytes.data()), static_cast<int>(bytes.size()), "PNG");
    EXPECT_EQ(image.width(), std::lround(size.width * size.scale));
    EXPECT_EQ(image.height(), std::lround(size.height * size.scale));
    return image;
}

/// Share of the pixels within `tolerance` of a colour on every channel.
double share(const QImage& image, const Colour& colour, int tolerance = 3) {
    qint64 count = 0;
    for (int y = 0; y < image.height(); ++y) {
        const auto* line = reinterpret_cast<const QRgb*>(image.constScanLine(y));
        for (int x = 0; x < image.width(); ++x) {
            count += std::abs(qRed(line[x]) - colour.red) <= tolerance &&
                             std::abs(qGreen(line[x]) - colour.green) <= tolerance &&
                             std::abs(qBlue(line[x]) - colour.blue) <= tolerance
                         ? 1
                         : 0;
        }
    }
    return static_cast<double>(count) / (static_cast<double>(image.width()) * image.height());
}

std::vector<double> steps(double from, double to, std::size_t count) {
    std::vector<double> result(count);
    for (std::size_t i = 0; i < count; ++i) {
        result[i] = from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1);
    }
    return result;
}

template <class Function>
std::vector<double> of(const std::vector<double>& x, Function function) {
    std::vector<double> result;
    for (const double value : x) {
        result.push_back(function(value));
    }
    return result;
}

Figure force_figure() {
    Figure figure;
    figure.title = "Lift force of EVIE over a moving ground, 0.5 m/s";
    figure.x = {"gap", "mm"};
    figure.y = {"lift force", "N"};
    const auto lift = [](double h) { return -0.6 * std::exp(-h / 4) + 0.25 * std::exp(-h / 1.2) + 0.02; };
    const auto x = steps(0.5, 20, 200);
    const auto y = of(x, lift);
    figure.bands.push_back({"95 % band", x, of(x, [&](double h) { return lift(h) - 0.02 - 0.05 / h; }),
                            of(x, [&](double h) { return lift(h) + 0.02 + 0.05 / h; })});
    figure.curves.push_back({"monotone cubic", x, y, palette(0)});
    const std::vector<double> h = {1, 1.5, 2, 3, 5, 10, 20};
    figure.points.push_back({"CFD", h, of(h, lift), std::vector<double>(h.size(), 0.025), palette(1)});
    figure.lines.push_back({false, -0.15, "net weight −0.15 N"});
    figure.points.push_back(
        {"stable equilibrium", {5.12}, {-0.15}, {}, palette(2), core::FigurePoints::Shape::disc, 11});
    figure.points.push_back(
        {"unstable equilibrium", {0.62}, {-0.15}, {}, palette(2), core::FigurePoints::Shape::circle, 11});
    figure.notes.push_back({5.12, -0.15, "5.1 mm, 1.3 Hz"});
    figure.notes.push_back({0.62, -0.15, "0.6 mm"});
    return figure;
}

Figure stability_figure() {
    Figure figure;
    figure.title = "Where each start ends: 60 s of heave";
    figure.x = {"gap", "mm"};
    figure.y = {"heave velocity", "mm/s"};
    core::FigureClasses map{240, 200, 0, 40, -100, 100, {}, {}, {}};
    map.names = {"settles at 5.1 mm (46 %)", "contact with the ground (33 %)", "escapes upward (21 %)"};
    map.colours = {Colour{146, 197, 222, 255}, Colour{244, 165, 130, 255}, Colour{230, 230, 200, 255}};
    for (std::size_t j = 0; j < map.rows; ++j) {
        for (std::size_t i = 0; i < map.columns; ++i) {
            const double gap = 40.0 * (static_cast<double>(i) + 0.5) / 240;
            const double speed = -100 + 200.0 * (static_cast<double>(j) + 0.5) / 200;
            map.index.push_back(speed < -12 * gap + 40 ? 1 : (speed > 90 - 3 * gap ? 2 : 0));
        }
    }
    figure.classes.push_back(map);
    core::FigureArrows arrows;
    for (double gap = 2; gap < 40; gap += 4) {
        for (double speed = -90; speed < 100; speed += 20) {
            arrows.x.push_back(gap);
            arrows.y.push_back(speed);
            arrows.dx.push_back(speed);
            arrows.dy.push_back(-8 * (gap - 5.1) - 0.5 * speed);
        }
    }
    figure.arrows.push_back(arrows);
    core::FigureCurve path{"trajectory from 20 mm, 60 mm/s", {}, {}, Colour{0, 0, 0, 255}, 1.8};
    for (double t = 0; t < 12; t += 0.02) {
        path.x.push_back(5.1 + 20 * std::exp(-0.3 * t) * std::cos(2 * t - 0.7));
        path.y.push_back(-60 * std::exp(-0.3 * t) * std::sin(2 * t - 0.9));
    }
    figure.curves.push_back(path);
    figure.points.push_back(
        {"equilibrium", {5.1}, {0}, {}, Colour{0, 0, 0, 255}, core::FigurePoints::Shape::diamond, 12});
    figure.notes.push_back({5.1, 0, "stable, 5.1 mm"});
    return figure;
}

Figure value_figure(bool is_diverging) {
    Figure figure;
    figure.title = is_diverging ? "Residual force" : "Pressure under the base";
    figure.x = {"x", "mm"};
    figure.y = {"y", "mm"};
    figure.equal_scales = true;
    core::FigureMap map{
        120, 80, -72, 72, -48, 48, {}, is_diverging ? "residual" : "pressure", is_diverging ? "N" : "Pa"};
    map.diverging = is_diverging;
    for (std::size_t j = 0; j < map.rows; ++j) {
        for (std::size_t i = 0; i < map.columns; ++i) {
            const double x = -72 + 144 * (static_cast<double>(i) + 0.5) / 120;
            const double y = -48 + 96 * (static_cast<double>(j) + 0.5) / 80;
            const double r = x * x / 5184 + y * y / 2304;
            map.values.push_back(r > 1          ? std::nan("")
                                 : is_diverging ? 0.02 * x / 72 + 0.01 * std::sin(y / 8)
                                                : -180 * (1 - r) + 20 * x / 72);
        }
    }
    figure.maps.push_back(map);
    return figure;
}

Figure bars_figure() {
    Figure figure;
    figure.title = "Error before and after the named effect, in standard deviations of the noise";
    figure.y = {"RMSE", "1"};
    figure.bars.push_back({"before", {"run 1", "run 2", "run 3"}, {10.8, 9.1, 12.0}, {1.1, 0.8, 1.5}, palette(1)});
    figure.bars.push_back({"after", {"run 1", "run 2", "run 3"}, {1.05, 0.98, 1.2}, {0.1, 0.1, 0.1}, palette(0)});
    figure.lines.push_back({false, 1, "noise"});
    return figure;
}

Figure log_figure() {
    Figure figure;
    figure.title = "Added mass against gap, and every shape of marker";
    figure.x = {"gap", "mm", 0, 0, true};
    figure.y = {"added mass", "kg", 0, 0, true};
    const auto x = steps(0.5, 500, 2000);
    figure.curves.push_back({"strip theory", x, of(x, [](double h) { return 1.7 + 60 / h; }), palette(0), 2, true});
    figure.curves.push_back({"steps", {0.5, 1, 5, 20, 100, 500}, {100, 50, 12, 4, 2, 1.8}, palette(5), 2, false, true});
    using Shape = core::FigurePoints::Shape;
    std::size_t k = 0;
    const std::vector<std::pair<Shape, std::string>> shapes = {
        {Shape::disc, "disc"},   {Shape::circle, "circle"}, {Shape::square, "square"},  {Shape::triangle, "triangle"},
        {Shape::cross, "cross"}, {Shape::plus, "plus"},     {Shape::diamond, "diamond"}};
    for (const auto& [shape, name] : shapes) {
        const double h = std::pow(10, -0.1 + 0.4 * static_cast<double>(k));
        figure.points.push_back({name, {h}, {2 * (1.7 + 60 / h)}, {0.3 * (1.7 + 60 / h)}, palette(k), shape, 9});
        ++k;
    }
    figure.lines.push_back({true, 5, "5 mm"});
    return figure;
}

TEST(Figures, ForceCurveShowsCurveBandPointsErrorsAndEquilibria) {
    const QImage image = picture("force", force_figure());
    EXPECT_GT(share(image, palette(0)), 0.001) << "curve";
    EXPECT_GT(share(image, palette(1)), 0.0005) << "points with error bars";
    EXPECT_GT(share(image, palette(2)), 0.0001) << "equilibria";
    EXPECT_GT(share(image, {204, 226, 239, 255}, 8), 0.01) << "band";
    EXPECT_GT(share(image, {255, 255, 255, 255}), 0.6) << "paper";
}

TEST(Figures, ClassMapFillsItsBoxWithItsColoursInTheirShares) {
    Figure figure = stability_figure();
    figure.arrows.clear();
    const QImage image = picture("stability-plain", figure);
    const auto& map = figure.classes[0];
    std::vector<double> parts(3, 0);
    for (const int index : map.index) {
        parts[static_cast<std::size_t>(index)] += 1.0 / static_cast<double>(map.index.size());
    }
    double sum = 0;
    std::vector<double> seen;
    for (const auto& colour : map.colours) {
        seen.push_back(share(image, colour));
        sum += seen.back();
    }
    EXPECT_GT(sum, 0.6) << "the map is most of the picture";
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(seen[k] / sum, parts[k], 0.02);
    }
    picture("stability", stability_figure());
}

TEST(Figures, ValueMapsUseTheirColourScales) {
    const QImage pressure = picture("pressure", value_figure(false));
    EXPECT_GT(share(pressure, viridis(0.2), 12), 0.005);
    EXPECT_GT(share(pressure, viridis(0.9), 12), 0.005);
    const QImage residual = picture("residual", value_figure(true));
    EXPECT_GT(share(residual, diverging(0.1), 20), 0.003);
    EXPECT_GT(share(residual, diverging(0.9), 20), 0.003);
}

TEST(Figures, AFineLineHasNoSteps) {
    const auto line = [](std::size_t points) {
        Figure figure;
        core::FigureCurve curve;
        curve.x = steps(0, 1, points);
        for (const double x : curve.x) {
            curve.y.push_back(1 - 0.9 * x);
        }
        figure.curves.push_back(curve);
        return figure;
    };
    // A falling line of a few points a pixel looks like the same line between its ends.
    const QImage two = picture("line-2", line(2)), many = picture("line-6000", line(6000));
    qint64 different = 0;
    for (int y = 0; y < two.height(); ++y) {
        for (int x = 0; x < two.width(); ++x) {
            different += std::abs(qGray(two.pixel(x, y)) - qGray(many.pixel(x, y))) > 90 ? 1 : 0;
        }
    }
    EXPECT_LT(different, 100);
}

TEST(Figures, EqualScalesMakeCirclesRound) {
    Figure figure;
    figure.equal_scales = true;
    core::FigureBand disc{"", {}, {}, {}, Colour{200, 0, 0, 255}};
    for (const double x : steps(-1, 1, 801)) {
        disc.x.push_back(x);
        disc.upper.push_back(std::sqrt(std::max(0.0, 1 - x * x)));
        disc.lower.push_back(-disc.upper.back());
    }
    figure.bands.push_back(disc);
    const QImage image = picture("disc", figure);
    int left = image.width(), right = 0, top = image.height(), bottom = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            if (qRed(image.pixel(x, y)) > 190 && qGreen(image.pixel(x, y)) < 30) {
                left = std::min(left, x);
                right = std::max(right, x);
                top = std::min(top, y);
                bottom = std::max(bottom, y);
            }
        }
    }
    EXPECT_NEAR(static_cast<double>(right - left) / (bottom - top), 1.0, 0.01);
}

TEST(Figures, BarsStandInGroupsWithErrors) {
    const QImage image = picture("bars", bars_figure());
    EXPECT_GT(share(image, palette(1)), 0.1);
    EXPECT_GT(share(image, palette(0)), 0.01);
}

TEST(Figures, LogarithmicAxesAndMarkersOfEveryShape) {
    const QImage image = picture("log", log_figure());
    for (const std::size_t k : {0U, 1U, 2U, 3U, 4U, 5U}) {
        EXPECT_GT(share(image, palette(k)), 1e-5) << k;
    }
}

TEST(Figures, LongTitlesAndManyNamesWrapInsteadOfLeaving) {
    Figure figure = force_figure();
    figure.title =
        "A title that is far too long for a picture of this width and therefore goes on a second line of text";
    for (std::size_t k = 0; k < 7; ++k) {
        figure.curves.push_back(
            {"curve number " + std::to_string(k), {1, 20}, {0.01 * static_cast<double>(k), 0}, palette(k)});
    }
    const QImage image = picture("crowded", figure, {480, 420, 2});
    const QRgb paper = image.pixel(0, 0);
    for (int x = 0; x < image.width(); ++x) {
        for (const int y : {0, 1, image.height() - 2, image.height() - 1}) {
            ASSERT_EQ(image.pixel(x, y), paper) << "ink at the upper or lower rim, x " << x;
        }
    }
    for (int y = 0; y < image.height(); ++y) {
        for (const int x : {0, 1, image.width() - 2, image.width() - 1}) {
            ASSERT_EQ(image.pixel(x, y), paper) << "ink at the left or right rim, y " << y;
        }
    }
}

TEST(Figures, CellsOfOneRatioAreDrawnWhereCellsOfOneWidthWouldLie) {
    Figure by_ratio;
    by_ratio.x = {"gap", "mm"};
    by_ratio.x.logarithmic = true;
    by_ratio.maps.push_back({2, 1, 1, 100, 0, 1, {1, 2}, "lift", "N"});
    Figure by_width = by_ratio;
    by_ratio.maps[0].x_by_ratio = true;
    // From 1 to 100 in cells of 0.1; the two cells of one ratio meet at 10.
    by_width.maps[0].columns = 990;
    by_width.maps[0].values.assign(990, 2);
    std::fill_n(by_width.maps[0].values.begin(), 90, 1.0);
    EXPECT_EQ(render_png(by_ratio), render_png(by_width));
    by_ratio.maps[0].x_by_ratio = false;
    EXPECT_NE(render_png(by_ratio), render_png(by_width)) << "two cells of one width meet at 50.5";
}

TEST(Figures, NothingToDrawAndNonsenseAreDrawnWithoutComplaint) {
    const double nan = std::nan("");
    Figure figure;
    picture("empty", figure);
    figure.x = {"x", "m", 1, -1, true};
    figure.y.logarithmic = true;
    figure.curves.push_back({"nothing", {nan, 1, 2, -1}, {1, nan, -3}, palette(0)});
    figure.points.push_back({"one", {3}, {0}, {nan, 2}, {}});
    figure.bands.push_back({"band", {nan}, {1, 2}, {}});
    figure.notes.push_back({nan, 1, "lost"});
    figure.lines.push_back({true, -5, "left of a logarithmic axis"});
    figure.maps.push_back({3, 3, 0, 0, 0, 0, {1, 2}, "short", "m"});
    figure.classes.push_back({2, 2, 0, 1, 0, 1, {0, 7, -1, 1}, {"a"}, {}});
    figure.arrows.push_back({{1, 2}, {1}, {0}, {0}});
    picture("nonsense", figure);
    const double infinity = std::numeric_limits<double>::infinity();
    Figure flat;
    flat.curves.push_back({"flat", {0, 1, infinity}, {5, 5, 5}, palette(0)});
    picture("flat", flat);
}

TEST(Figures, TheSameFigureGivesTheSameBytesFromAnyThread) {
    const std::string png = render_png(stability_figure());
    const std::string pdf = render_pdf(stability_figure());
    EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
    EXPECT_EQ(render_pdf(stability_figure()), pdf);
    std::vector<std::string> others(3);
    std::vector<std::thread> threads;
    for (auto& other : others) {
        threads.emplace_back([&other] { other = render_png(stability_figure()); });
    }
    for (auto& thread : threads) {
        thread.join();
    }
    for (const auto& other : others) {
        EXPECT_EQ(other, png);
    }
}

TEST(Figures, PicturesLeaveTheLocaleOfNumbersAlone) {
    render_png(force_figure());
    EXPECT_STREQ(std::setlocale(LC_NUMERIC, nullptr), "C");
}

TEST(FiguresDeathTest, AMachineWithoutFontconfigStillGetsText) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    // In a process of its own, because Qt asks for fonts once.
    EXPECT_EXIT(
        {
            ::setenv("FONTCONFIG_FILE", "/dev/null", 1);
            int code = 1;
            try {
                Figure figure;
                figure.title = "text";
                const std::string with = render_png(figure);
                figure.title = "";
                code = with.size() > render_png(figure).size() + 300 ? 0 : 2;
            } catch (const core::SystemError& error) {  // no DejaVu here: the error says what to install
                code = std::string(error.what()).find("fonts-dejavu-core") != std::string::npos ? 0 : 3;
            }
            std::_Exit(code);
        },
        testing::ExitedWithCode(0), "");
}

TEST(Figures, WrongSizesAndEndingsAreRefused) {
    EXPECT_THROW(render_png({}, {0, 100, 1}), core::InputError);
    EXPECT_THROW(render_png({}, {900, 560, 1000}), core::InputError);
    const core::TemporaryFolder folder;
    EXPECT_THROW(write_picture({}, folder.path() / "x.jpg"), core::UsageError);
    write_picture(bars_figure(), folder.path() / "x.pdf");
    EXPECT_GT(std::filesystem::file_size(folder.path() / "x.pdf"), 2000U);
}

// A view in a tab that nobody looks at is as small as its layout lets it.
TEST(Figures, AreDrawnHoweverSmall) {
    core::Random random(20261124);
    for (Figure figure : {force_figure(), stability_figure(), bars_figure(), log_figure(), value_figure(false)}) {
        for (int i = 0; i < 40; ++i) {
            const PictureSize size{static_cast<int>(1 + 200 * random.uniform()),
                                   static_cast<int>(1 + 200 * random.uniform()), 1};
            figure.x.logarithmic = i % 2 == 1;
            const std::string png = render_png(figure, size);
            EXPECT_EQ(png.substr(1, 3), "PNG") << size.width << " x " << size.height;
        }
    }
}

TEST(Figures, UnitsReadAsPeopleWriteThem) {
    EXPECT_EQ(pretty_unit("N s^2/m^2"), "N s²/m²");
    EXPECT_EQ(pretty_unit("kg m^-1 s^-1"), "kg m⁻¹ s⁻¹");
    EXPECT_EQ(axis_title("temperature", "degC"), "temperature (°C)");
    EXPECT_EQ(axis_title("pitch", "deg"), "pitch (°)");
    EXPECT_EQ(axis_title("C_L", "1"), "C_L");
    EXPECT_EQ(axis_title("", "mm"), "mm");
}

TEST(Figures, APictureIsDrawnFastEnoughForAReport) {
    render_png(stability_figure());
    const double start = test::processor_seconds();
    render_png(stability_figure());
    const double seconds = test::processor_seconds() - start;
    RecordProperty("seconds", std::to_string(seconds));
    EXPECT_LT(seconds, 1.5);
}

// A plot whose figure stays the same is not drawn again: every part tells two figures apart.
TEST(SameFigure, KnowsEveryPart) {
    using core::Figure;
    Figure figure;
    figure.title = "lift";
    figure.curves.push_back({"a", {1, 2}, {3, 4}, {1, 2, 3}, 2, false, false});
    figure.bands.push_back({"b", {1, 2}, {0, 0}, {1, 1}});
    figure.points.push_back({"c", {1}, {2}, {}, {}});
    figure.lines.push_back({true, 1, "gap"});
    figure.notes.push_back({1, 2, "here"});
    figure.classes.push_back({1, 1, 0, 1, 0, 1, {0}, {"held"}, {{9, 9, 9}}});
    figure.maps.push_back({1, 1, 0, 1, 0, 1, {5}});
    figure.arrows.push_back({{1}, {1}, {1}, {1}});
    figure.bars.push_back({"d", {"x"}, {1}, {0}});
    EXPECT_TRUE(figure == Figure(figure));
    const std::vector<void (*)(Figure&)> changes = {[](Figure& f) { f.title = "drag"; },
                                                    [](Figure& f) { f.x.upper = 1; },
                                                    [](Figure& f) { f.y.logarithmic = true; },
                                                    [](Figure& f) { f.curves[0].y[1] = 5; },
                                                    [](Figure& f) { f.curves[0].colour.red = 0; },
                                                    [](Figure& f) { f.curves.push_back(f.curves[0]); },
                                                    [](Figure& f) { f.bands[0].upper[0] = 2; },
                                                    [](Figure& f) { f.points[0].y_error = {1}; },
                                                    [](Figure& f) { f.lines[0].at = 2; },
                                                    [](Figure& f) { f.notes[0].text = "there"; },
                                                    [](Figure& f) { f.classes[0].colours[0].blue = 0; },
                                                    [](Figure& f) { f.classes[0].index[0] = 1; },
                                                    [](Figure& f) { f.maps[0].values[0] = 6; },
                                                    [](Figure& f) { f.arrows[0].dx[0] = 2; },
                                                    [](Figure& f) { f.bars[0].errors[0] = 1; },
                                                    [](Figure& f) { f.equal_scales = true; },
                                                    [](Figure& f) { f.legend = false; }};
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Figure other = figure;
        changes[i](other);
        EXPECT_FALSE(figure == other) << i;
    }
    figure.maps[0].values[0] = std::nan("");
    EXPECT_FALSE(figure == Figure(figure)) << "a hole in a map: drawn again";
}

}  // namespace
}  // namespace underbody::studio
