// The desktop, started for real on a display of its own (Xvfb), looked at by the pictures it takes of itself.
// With UNDERBODY_KEEP_PICTURES=FOLDER the pictures stay there, for people to look at.
#include <gtest/gtest.h>

#include <QImage>
#include <cstdlib>
#include <set>

#include "core/file.h"
#include "tests/support/support.h"

namespace underbody {
namespace {

namespace fs = std::filesystem;

test::ProgramRun run_studio(const std::vector<std::string>& arguments,
                            const std::map<std::string, std::string>& environment = {}) {
    std::map<std::string, std::string> all = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}, {"LIBGL_ALWAYS_SOFTWARE", "1"}};
    all.insert(environment.begin(), environment.end());
    return test::run_program((test::program_folder() / "underbody-studio").string(), arguments, {}, all);
}

bool has_xvfb() { return std::system("command -v Xvfb > /dev/null 2>&1") == 0; }

/// A study of a few cases of the shipped one, small enough to be computed in a test.
void make_study(const fs::path& folder) {
    const fs::path shipped = test::source_folder() / "cases" / "evie";
    fs::create_directories(folder / "fields");
    for (const char* gap : {"2", "3", "5", "10", "20"}) {
        const std::string name = std::string("ellipse-h") + gap + "-p0.csv";
        fs::copy_file(shipped / "fields" / name, folder / "fields" / name);
    }
    fs::copy_file(shipped / "glide.toml", folder / "glide.toml");
    core::write_file(folder / "study.toml", R"(title = "A few gaps"
summary = "Five cases of the shipped study."
origin = "see cases/evie/ORIGIN.md"

[frame]
forward = "+x"
up = "+z"
symmetry = "y"

[reference]
length = "203.2 mm"
width = "152 mm"
height = "145 mm"
density = "998 kg/m^3"

[[case]]
files = "fields/{variant}-h{gap:mm}-p{pitch:deg}.csv"
conditions = { speed = "0.5 m/s" }

[[table]]
name = "lift"
quantity = "lift_force"
axes = ["gap"]
where = { variant = "ellipse", pitch = 0, speed = "0.5 m/s" }
net_weight = "0.30 N"
virtual_mass = "3.954 kg"

[[region]]
name = "glide"
model = "glide.toml"
forces = ["lift"]
axes = "gap=2mm:20mm,heave_velocity=-0.06:0.06"
for = "20 s"
columns = 40
rows = 40
)");
}

QImage picture(const fs::path& file) {
    QImage image(QString::fromStdString(file.string()));
    EXPECT_FALSE(image.isNull()) << file;
    return image.convertToFormat(QImage::Format_RGB32);
}

/// How many colours (of 32 steps a channel) a picture has: a blank or half-drawn window has few.
std::size_t colours(const QImage& image) {
    std::set<int> seen;
    for (int y = 0; y < image.height(); y += 2) {
        for (int x = 0; x < image.width(); x += 2) {
            const QRgb pixel = image.pixel(x, y);
            seen.insert((qRed(pixel) >> 3) << 10 | (qGreen(pixel) >> 3) << 5 | qBlue(pixel) >> 3);
        }
    }
    return seen.size();
}

double difference(const QImage& a, const QImage& b) {
    int count = 0;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
            count += a.pixel(x, y) != b.pixel(x, y) ? 1 : 0;
        }
    }
    return static_cast<double>(count) / (static_cast<double>(a.width()) * a.height());
}

TEST(Desktop, TeachesItsUseAndItsKeys) {
    const auto run = run_studio({"--help"});
    EXPECT_EQ(run.exit_code, 0);
    for (const char* word : {"--screenshot", "Examples", "Ctrl+O", "F1", "Exit codes"}) {
        EXPECT_NE(run.output.find(word), std::string::npos) << word;
    }
    EXPECT_EQ(run_studio({"--version"}).exit_code, 0);
    EXPECT_EQ(run_studio({"--nonsense"}).exit_code, 2);
    EXPECT_EQ(run_studio({"--screenshot", "x"}).exit_code, 2) << "pictures of what?";
}

TEST(Desktop, SaysThatThereIsNoDisplayInsteadOfAborting) {
    for (const char* display : {"", ":7654", "nonsense"}) {
        const auto run = run_studio({}, {{"DISPLAY", display}, {"QT_QPA_PLATFORM", ""}});
        EXPECT_EQ(run.exit_code, 3) << display;
        EXPECT_NE(run.errors.find("no display"), std::string::npos) << run.errors;
        EXPECT_NE(run.errors.find("--screenshot"), std::string::npos) << run.errors;
    }
}

TEST(Desktop, AWrongFolderIsAMessageInTheWindow) {
    if (!has_xvfb()) {
        GTEST_SKIP() << "skipped: Xvfb is not installed";
    }
    const core::TemporaryFolder folder;
    core::write_file(folder.path() / "broken" / "study.toml", "title = \"x\"\n[[case]\n");
    for (const std::string name : {"missing", "broken", "."}) {
        const auto run =
            run_studio({(folder.path() / name).string(), "--screenshot", (folder.path() / "shots").string()});
        EXPECT_EQ(run.exit_code, 3) << name << run.errors;
        EXPECT_NE(run.errors.find("study.toml"), std::string::npos) << run.errors;
        EXPECT_GT(colours(picture(folder.path() / "shots" / "window.png")), 10U);
    }
}

TEST(Desktop, ShowsAStudyInEveryPanel) {
    if (!has_xvfb()) {
        GTEST_SKIP() << "skipped: Xvfb is not installed";
    }
    const core::TemporaryFolder folder;
    make_study(folder.path() / "study");
    const auto computed = test::run_underbody({"study", "run", (folder.path() / "study").string()});
    ASSERT_EQ(computed.exit_code, 0) << computed.errors;

    const char* keep = std::getenv("UNDERBODY_KEEP_PICTURES");
    const fs::path shots = keep != nullptr ? fs::path(keep) / "desktop" : folder.path() / "shots";
    const auto run = run_studio(
        {(folder.path() / "study").string(), "--screenshot", shots.string(), "--width", "1200", "--height", "800"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;

    const QImage empty = picture(shots / "empty.png");
    for (const char* name : {"body", "forces", "stability", "discovery", "pictures"}) {
        const QImage image = picture(shots / (std::string(name) + ".png"));
        EXPECT_EQ(image.width(), 1200);
        EXPECT_EQ(image.height(), 800);
        EXPECT_GT(difference(empty, image), 0.05) << name;
    }
    EXPECT_GT(colours(picture(shots / "body.png")), 200U) << "pressure in colours";
    EXPECT_GT(difference(picture(shots / "body.png"), picture(shots / "body-used.png")), 0.05) << "the underbody view";
    EXPECT_GT(difference(picture(shots / "forces.png"), picture(shots / "forces-used.png")), 0.0005)
        << "equilibria move";
    EXPECT_GT(difference(picture(shots / "stability.png"), picture(shots / "stability-used.png")), 0.01) << "a motion";
}

}  // namespace
}  // namespace underbody
