// The desktop, started for real on a display of its own (Xvfb), looked at by the pictures it takes of itself.
// With UNDERBODY_KEEP_PICTURES=FOLDER the pictures stay there, for people to look at.
#include <gtest/gtest.h>

#include <QImage>
#include <QRegularExpression>
#include <QStringList>
#include <QXmlStreamReader>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "core/file.h"
#include "core/virtual_display.h"
#include "tests/studio/desktop/few_gaps.h"
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
    const auto two = run_studio({"a.csv", "b.csv", "--screenshot", "x"});
    EXPECT_EQ(two.exit_code, 2);
    EXPECT_NE(two.errors.find("take one STUDY"), std::string::npos) << two.errors;
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

TEST(Desktop, ShowsAStudyInEveryWorkspace) {
    if (!has_xvfb()) {
        GTEST_SKIP() << "skipped: Xvfb is not installed";
    }
    const core::TemporaryFolder folder;
    test::make_few_gaps(folder.path() / "study");
    const auto computed = test::run_underbody({"study", "run", (folder.path() / "study").string()});
    ASSERT_EQ(computed.exit_code, 0) << computed.errors;

    const char* keep = std::getenv("UNDERBODY_KEEP_PICTURES");
    const fs::path shots = keep != nullptr ? fs::path(keep) / "desktop" : folder.path() / "shots";
    const auto run = run_studio(
        {(folder.path() / "study").string(), "--screenshot", shots.string(), "--width", "1200", "--height", "800"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;

    const QImage empty = picture(shots / "empty.png");
    for (const auto& name : {"design", "explore", "compare", "tables", "stability", "loop"}) {
        const QImage image = picture(shots / (std::string(name) + ".png"));
        EXPECT_EQ(image.width(), 1200);
        EXPECT_EQ(image.height(), 800);
        EXPECT_GT(difference(empty, image), 0.05) << name;
    }
    EXPECT_GT(colours(picture(shots / "compare.png")), 200U) << "pressure in colours";
    const auto fields = [&](const char* name) { return picture(shots / name).copy(600, 0, 600, 800); };
    EXPECT_GT(difference(fields("compare.png"), fields("compare-used.png")), 0.08) << "the underbody view";
    EXPECT_GT(difference(picture(shots / "tables.png"), picture(shots / "tables-used.png")), 0.0005)
        << "equilibria move";
    EXPECT_GT(difference(picture(shots / "stability.png"), picture(shots / "stability-used.png")), 0.01) << "a motion";
}

// Started as from a desktop, without --screenshot, which brings every view to the front once.
TEST(Desktop, StaysOpenOverTheComputedShippedStudy) {
    if (!has_xvfb()) {
        GTEST_SKIP() << "skipped: Xvfb is not installed";
    }
    const core::TemporaryFolder folder;
    const fs::path study = folder.path() / "evie";
    fs::copy(test::source_folder() / "cases" / "evie", study, fs::copy_options::recursive);
    fs::remove_all(study / ".underbody");
    const auto computed = test::run_underbody({"study", "run", study.string(), "--no-pictures"});
    ASSERT_EQ(computed.exit_code, 0) << computed.errors;
    const core::VirtualDisplay display(1440, 900);
    for (const std::string& named : {study.string(), std::string()}) {
        std::vector<std::string> arguments = {"15", (test::program_folder() / "underbody-studio").string()};
        if (!named.empty()) {
            arguments.push_back(named);
        }
        const auto run = test::run_program("timeout", arguments, {},
                                           {{"DISPLAY", display.name()},
                                            {"WAYLAND_DISPLAY", ""},
                                            {"QT_QPA_PLATFORM", ""},
                                            {"LIBGL_ALWAYS_SOFTWARE", "1"},
                                            {"HOME", folder.path().string()},
                                            {"XDG_CONFIG_HOME", (folder.path() / "config").string()},
                                            {"XDG_DATA_HOME", (folder.path() / "data").string()}});
        EXPECT_EQ(run.exit_code, 124) << "it ended by itself: " << run.errors;
        EXPECT_EQ(run.errors.find("underbody-studio:"), std::string::npos) << run.errors;
    }
}

// VTK ended the program. The window says what it cannot show, pictures are drawn on a display of their own.
TEST(Desktop, ADisplayWithoutOpenGLIsEnough) {
    if (!has_xvfb()) {
        GTEST_SKIP() << "skipped: Xvfb is not installed";
    }
    const core::TemporaryFolder folder;
    test::make_few_gaps(folder.path() / "study");
    const core::VirtualDisplay display(1440, 900, false);
    const std::map<std::string, std::string> there = {
        {"DISPLAY", display.name()}, {"WAYLAND_DISPLAY", ""}, {"HOME", folder.path().string()}};
    const auto computed = test::run_underbody({"study", "run", (folder.path() / "study").string()}, {}, there);
    EXPECT_EQ(computed.exit_code, 0) << computed.errors;
    core::write_file(folder.path() / "views.log",
                     "open " + (folder.path() / "study").string() + "\nselect case/ellipse-h5-p0\nworkspace compare\n");
    const auto run = test::run_program(
        (test::program_folder() / "underbody-studio").string(),
        {"--screenshot", (folder.path() / "pictures").string(), "--replay", (folder.path() / "views.log").string()}, {},
        there);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_TRUE(fs::exists(folder.path() / "pictures" / "compare.png"));
}

// J4: the second case less the first, in place of its field.
TEST(Desktop, ComparesByDifferences) {
    if (!has_xvfb()) {
        GTEST_SKIP() << "skipped: Xvfb is not installed";
    }
    const core::TemporaryFolder folder;
    test::make_few_gaps(folder.path() / "study");
    const std::string log = "open " + (folder.path() / "study").string() +
                            "\nselect case/ellipse-h5-p0 case/ellipse-h2-p0\nfields camera=bottom\n";
    core::write_file(folder.path() / "fields.log", log);
    core::write_file(folder.path() / "differences.log", log + "fields difference=on\n");
    for (const char* name : {"fields", "differences"}) {
        const auto run = run_studio({"--replay", (folder.path() / (std::string(name) + ".log")).string(),
                                     "--screenshot", (folder.path() / name).string()});
        ASSERT_EQ(run.exit_code, 0) << run.errors;
    }
    const QImage fields = picture(folder.path() / "fields" / "compare.png");
    const QImage differences = picture(folder.path() / "differences" / "compare.png");
    EXPECT_GT(difference(fields, differences), 0.03);
    EXPECT_GT(colours(differences), 200U);
}

// What a reader of the first report missed or stumbled over (README.md beside this file).
TEST(Report, HasWhatAReaderMissed) {
    const core::TemporaryFolder folder;
    test::make_few_gaps(folder.path());
    std::string text = core::read_file(folder.path() / "study.toml");
    text.insert(text.find("net_weight"), "relative_sigma = 0.05\n");
    core::write_file(folder.path() / "study.toml", text +
                                                       "\n[[picture]]\nname = \"level\"\nwhere = { gap = \"5mm\" }\n"
                                                       "views = [\"pressure-underbody\"]\n");
    const auto run = test::run_underbody(
        {"study", "run", folder.path().string(), "--report", (folder.path() / "out" / "index.html").string()});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const QString page = QString::fromStdString(core::read_file(folder.path() / "out" / "index.html"));
    const auto all = [&page](const char* pattern) {
        QStringList found;
        auto matches = QRegularExpression(pattern, QRegularExpression::DotMatchesEverythingOption).globalMatch(page);
        while (matches.hasNext()) {
            found << matches.next().captured(1);
        }
        return found;
    };
    const QStringList heads = all("<th[^>]*>(.*?)</th>");
    EXPECT_FALSE(heads.isEmpty());
    EXPECT_FALSE(heads.contains("")) << "each column has its heading";
    for (const char* head : {"kind", "variant", "gap (mm)", "lift (N)", "drag (N)", "± (N)"}) {
        EXPECT_TRUE(heads.contains(head)) << head << " in " << heads.join('|').toStdString();
    }
    const QStringList captions = all("<figcaption>(.*?)</figcaption>");
    EXPECT_EQ(captions.filter("ellipse-h5-p0").size(), 1) << captions.join('\n').toStdString();
    for (int i = 0; i < captions.size(); ++i) {
        EXPECT_EQ(captions.count(captions[i]), 1) << captions[i].toStdString();
    }
    EXPECT_TRUE(all("<summary>(.*?)</summary>").contains("How it was fitted"));
    for (const auto& facts : all("<div class=\"facts(.*?)</div></div>")) {
        const int count = facts.count("class=\"value\"");
        const int row = facts.startsWith(" of") ? facts.mid(3, 1).toInt() : count;
        EXPECT_TRUE(count <= row || count % row != 1) << count << " in rows of " << row;
    }
}

// What the entry of the menu says it opens is declared as a type of file, and the AppStream page names the same.
TEST(Desktop, ItsTypesOfFilesAreDeclared) {
    const fs::path folder = test::source_folder() / "studio" / "desktop";
    const auto words_of = [&](const char* file, const char* element, const char* attribute) {
        QXmlStreamReader xml(QByteArray::fromStdString(core::read_file(folder / file)));
        std::set<std::string> words;
        while (!xml.atEnd()) {
            xml.readNext();
            if (xml.isStartElement() && xml.name() == element) {
                words.insert(
                    (attribute == nullptr ? xml.readElementText() : xml.attributes().value(attribute).toString())
                        .toStdString());
            }
        }
        EXPECT_FALSE(xml.hasError()) << file << xml.errorString().toStdString();
        return words;
    };
    const auto declared = words_of("org.underbody.studio.mime.xml", "mime-type", "type");
    EXPECT_EQ(declared, words_of("org.underbody.studio.metainfo.xml", "mediatype", nullptr));
    const std::string entry = core::read_file(folder / "org.underbody.studio.desktop");
    for (const auto& type : declared) {
        EXPECT_NE(entry.find(type + ";"), std::string::npos) << type;
    }
}

TEST(Desktop, ReplaysALogWithoutAWindow) {
    const core::TemporaryFolder folder;
    test::make_few_gaps(folder.path() / "study");
    core::write_file(folder.path() / "done.log", "open " + (folder.path() / "study").string() +
                                                     "\nset 'protrusion.height=2 mm'  # a bump\nundo\nredo\n");
    const auto run = run_studio({"--replay", (folder.path() / "done.log").string()});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto document = nlohmann::json::parse(run.output);
    EXPECT_EQ(document["state"]["design"]["changes"]["ellipse"]["protrusion.height"], "2 mm");
    EXPECT_EQ(document["steps"], 2);
    EXPECT_EQ(run_studio({"--replay", (folder.path() / "done.log").string()}).output, run.output);

    // On a study that is named: the same, a step later; a wrong one is said and nothing is replayed.
    core::write_file(folder.path() / "lines.log", "set 'protrusion.height=2 mm'\nselect case/ellipse-h5-p0\n");
    const auto named =
        run_studio({(folder.path() / "study").string(), "--replay", (folder.path() / "lines.log").string()});
    ASSERT_EQ(named.exit_code, 0) << named.errors;
    EXPECT_EQ(nlohmann::json::parse(named.output)["state"]["study"], document["state"]["study"]);
    EXPECT_EQ(nlohmann::json::parse(named.output)["state"]["design"], document["state"]["design"]);
    core::write_file(folder.path() / "broken" / "study.toml", "title = \"x\"\n[[case]\n");
    core::write_file(folder.path() / "none.log", "workspace tables\n");
    for (const auto& [study, said] : std::map<std::string, std::string>{
             {"broken", "study.toml:2"}, {"studdy", "did you mean 'study'"}, {"study/fields", "no study.toml"}}) {
        const auto run_of_it =
            run_studio({(folder.path() / study).string(), "--replay", (folder.path() / "none.log").string()});
        EXPECT_EQ(run_of_it.exit_code, 3) << study;
        EXPECT_EQ(run_of_it.output, "") << study;
        EXPECT_NE(run_of_it.errors.find(said), std::string::npos) << run_of_it.errors;
    }
    // What is not there is not selected silently.
    core::write_file(folder.path() / "nothing.log", "workspace tables\nselect file/one\n");
    const auto nothing =
        run_studio({(folder.path() / "study").string(), "--replay", (folder.path() / "nothing.log").string()});
    EXPECT_EQ(nothing.exit_code, 3);
    EXPECT_NE(nothing.errors.find("nothing.log:2"), std::string::npos) << nothing.errors;

    core::write_file(folder.path() / "wrong.log", "workspace nowhere\n");
    const auto wrong = run_studio({"--replay", (folder.path() / "wrong.log").string()});
    EXPECT_EQ(wrong.exit_code, 3);
    EXPECT_NE(wrong.errors.find("wrong.log:1"), std::string::npos) << wrong.errors;
}

}  // namespace
}  // namespace underbody
