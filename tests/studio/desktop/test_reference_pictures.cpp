// Every workspace in light and dark, at one and two times scale, against pictures that people have looked at. They are
// made without any font: all text is gone, and its widgets are as large on every machine. What is left is compared at a
// size at which no edge counts: root mean square of 0.04 of the full range, F3D's limit for its own pictures.
// UNDERBODY_WRITE_PICTURES=1 writes the pictures instead: look at every one of them then.
#include <gtest/gtest.h>

#include <QImage>
#include <cmath>
#include <cstdlib>

#include "core/file.h"
#include "tests/studio/desktop/few_gaps.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;

constexpr double allowed = 0.02;  ///< the same machine differs by 0.0003, another workspace by 0.037 and more
const QSize compared(256, 160);
const std::vector<std::string> workspaces = {"design", "explore", "compare", "tables", "stability", "loop"};

QImage small(const fs::path& file) {
    const QImage image(QString::fromStdString(file.string()));
    return image.isNull() ? image
                          : image.scaled(compared, Qt::IgnoreAspectRatio, Qt::SmoothTransformation)
                                .convertToFormat(QImage::Format_RGB32);
}

/// Root mean square of the difference of the colours, of 1.
double difference(const QImage& a, const QImage& b) {
    double sum = 0;
    for (int y = 0; y < compared.height(); ++y) {
        for (int x = 0; x < compared.width(); ++x) {
            const QRgb p = a.pixel(x, y), q = b.pixel(x, y);
            for (const int step : {qRed(p) - qRed(q), qGreen(p) - qGreen(q), qBlue(p) - qBlue(q)}) {
                sum += step * step / (255.0 * 255.0);
            }
        }
    }
    return std::sqrt(sum / (3.0 * compared.width() * compared.height()));
}

fs::path reference(const std::string& workspace, const std::string& theme, const std::string& scale) {
    return test::data_folder() / "desktop" / (workspace + "-" + theme + "-" + scale + "x.png");
}

/// A computed study of five cases; the same for all.
const fs::path& study() {
    static const core::TemporaryFolder folder;
    static const fs::path made = [] {
        test::make_few_gaps(folder.path() / "study");
        const auto run = test::run_underbody({"study", "run", (folder.path() / "study").string(), "--no-pictures"});
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        return folder.path() / "study";
    }();
    return made;
}

struct Look {
    std::string theme, scale;
    friend void PrintTo(const Look& look, std::ostream* out) { *out << look.theme << ' ' << look.scale << 'x'; }
};

class ReferencePictures : public ::testing::TestWithParam<Look> {};

TEST_P(ReferencePictures, OfEveryWorkspace) {
    if (std::system("command -v Xvfb > /dev/null 2>&1") != 0) {
        GTEST_SKIP() << "skipped: Xvfb is not installed";
    }
    const auto [theme, scale] = GetParam();
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "fonts.conf",
                     "<?xml version=\"1.0\"?><!DOCTYPE fontconfig SYSTEM \"fonts.dtd\"><fontconfig></fontconfig>");
    const auto run = test::run_program((test::program_folder() / "underbody-studio").string(),
                                       {study().string(), "--screenshot", (folder.path() / "shots").string(), "--theme",
                                        theme, "--width", "1280", "--height", "800"},
                                       {},
                                       {{"DISPLAY", ""},
                                        {"WAYLAND_DISPLAY", ""},
                                        {"LIBGL_ALWAYS_SOFTWARE", "1"},
                                        {"QT_SCALE_FACTOR", scale},
                                        {"FONTCONFIG_FILE", (folder.path() / "fonts.conf").string()}});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    for (const auto& workspace : workspaces) {
        const fs::path shot = folder.path() / "shots" / (workspace + ".png");
        const QImage image = small(shot);
        ASSERT_FALSE(image.isNull()) << shot;
        EXPECT_EQ(QImage(QString::fromStdString(shot.string())).width(), 1280 * std::stoi(scale));
        if (std::getenv("UNDERBODY_WRITE_PICTURES") != nullptr) {
            fs::create_directories(test::data_folder() / "desktop");
            image.save(QString::fromStdString(reference(workspace, theme, scale).string()));
            continue;
        }
        const QImage known = small(reference(workspace, theme, scale));
        ASSERT_FALSE(known.isNull()) << reference(workspace, theme, scale);
        EXPECT_LE(difference(image, known), allowed) << workspace << " " << theme << " " << scale << "x";
        // Another theme, or another workspace, is not taken for this one.
        const std::string other = theme == "dark" ? "light" : "dark";
        const auto apart = [&](const fs::path& reference) {
            const QImage that = small(reference);
            EXPECT_FALSE(that.isNull()) << reference;
            return that.isNull() ? 0 : difference(image, that);
        };
        EXPECT_GT(apart(reference(workspace, other, scale)), 4 * allowed);
        for (const auto& another : workspaces) {
            EXPECT_TRUE(another == workspace || apart(reference(another, theme, scale)) > allowed)
                << workspace << " passes for " << another;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, ReferencePictures,
                         ::testing::Values(Look{"light", "1"}, Look{"light", "2"}, Look{"dark", "1"},
                                           Look{"dark", "2"}));

}  // namespace
}  // namespace underbody
