// underbody-studio: the desktop.
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <QFile>
#include <QLibraryInfo>
#include <clocale>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/file.h"
#include "core/virtual_display.h"
#include "studio/desktop/application.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/screenshots.h"
#include "studio/desktop/state/action_log.h"
#include "studio/desktop/theme.h"

namespace {

struct Options {
    std::vector<std::string> files;  ///< the study, or what else is opened
    std::string study;               ///< the first of them
    std::string screenshots;
    std::string log;
    std::string theme;
    std::optional<int> width, height;  ///< none: as it was left, the first time as large as the screen lets it
    /// Of pictures without a word on it.
    [[nodiscard]] QSize pictured() const { return {width.value_or(1440), height.value_or(900)}; }
};

/// -1: go on; else the exit code.
int parse(int argc, char** argv, Options& options) {
    CLI::App app{
        "Underbody Studio: designs bodies, compares cases and makes force tables of a study: shapes whose numbers are\n"
        "moved, fields side by side, force tables with their equilibria, stability maps, and what measurements say "
        "the\n"
        "model lacks.",
        "underbody-studio"};
    app.set_version_flag("--version", UNDERBODY_VERSION);
    app.add_option(
        "STUDY", options.files,
        "folder of a study (it holds study.toml), a session (.ubs), a SHAPE.toml, or CFD files and folders of "
        "them; more with Ctrl+Shift+O");
    app.add_option("--screenshot", options.screenshots,
                   "load the study, visit each workspace, save pictures of the window into this folder, and end")
        ->type_name("FOLDER");
    app.add_option("--replay", options.log,
                   "carry out the lines of a log (Commands > Copy all) without a window, on STUDY where one is named, "
                   "print the state that comes of it as JSON, and end; with --screenshot: in a window, and save "
                   "pictures of it")
        ->type_name("FILE");
    app.add_option("--theme", options.theme, "light, dark, or system: the desktop's own (default: as the last time)")
        ->check(CLI::IsMember({"light", "dark", "system"}));
    app.add_option("--width", options.width,
                   "of the window, px (default: as it was left; the first time what the screen has room for)")
        ->check(CLI::Range(600, 8000));
    app.add_option("--height", options.height, "of the window, px")->check(CLI::Range(400, 8000));
    app.footer(
        "Examples:\n"
        "  underbody-studio cases/evie                      open the shipped study\n"
        "  underbody-studio cases/evie --screenshot shots   pictures of every panel, without a display if need be\n"
        "  underbody-studio --replay done.log > state.json\n"
        "Keys: F1 all keys, Ctrl+K find a command, F2 Design, F3 Explore, F4 Compare, F6 Tables, F7 Stability, F8 "
        "Loop,\n"
        "Ctrl+O open, Ctrl+Shift+O open files, Ctrl+R compute what changed, F5 reload, Ctrl+Z undo, Ctrl+Shift+Z "
        "redo,\n"
        "Ctrl+S save session, Ctrl+E export for a controller, F12 export picture, U T S R O views of the body, Esc "
        "cancel.\n"
        "Exit codes: 0 done, 1 defect of the program, 2 wrong use, 3 wrong input or no display.");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    options.study = options.files.empty() ? std::string() : options.files.front();
    if (options.files.size() > 1 && !(options.screenshots.empty() && options.log.empty())) {
        std::fprintf(stderr, "underbody-studio: --screenshot and --replay take one STUDY\n");
        return 2;
    }
    if (!options.screenshots.empty() && options.study.empty() && options.log.empty()) {
        std::fprintf(stderr, "underbody-studio: --screenshot needs a STUDY or --replay FILE\n");
        return 2;
    }
    return -1;
}

/// A Wayland session that this Qt can open a window on.
bool has_wayland() {
    const QString plugins = QLibraryInfo::location(QLibraryInfo::PluginsPath) + "/platforms/";
    return !qEnvironmentVariableIsEmpty("WAYLAND_DISPLAY") &&
           (QFile::exists(plugins + "libqwayland-generic.so") || QFile::exists(plugins + "libqwayland-egl.so"));
}

/// Qt aborts without a display: find out before. A picture needs none of the user's: it gets one of its own.
std::unique_ptr<underbody::core::VirtualDisplay> need_display(const Options& options) {
    using namespace underbody;
    if (core::display_answers() || (options.screenshots.empty() && has_wayland())) {
        return nullptr;
    }
    if (options.screenshots.empty()) {
        throw core::SystemError("display", "there is no display to open a window on", {},
                                "log in to a desktop, use ssh -X, or take pictures with --screenshot FOLDER");
    }
    auto display =
        std::make_unique<core::VirtualDisplay>(options.pictured().width() + 80, options.pictured().height() + 80);
    ::setenv("DISPLAY", display->name().c_str(), 1);
    return display;
}

/// The state that the lines of a log lead to, on stdout.
int replay_without_window(const Options& options) {
    using namespace underbody::studio;
    History history;
    SessionPointer session = open_session({});
    const auto load = [&](const State& state) { return load_session(state, session); };
    if (!options.study.empty()) {
        start_with(options.study, history, session, load);
    }
    replay(underbody::core::read_file(options.log), options.log, history, session, load);
    // What was left out of the study on opening it changes what the state is of.
    for (const auto& problem : session->problems) {
        std::fprintf(stderr, "underbody-studio: %s\n", problem.message.c_str());
    }
    const nlohmann::json document = {
        {"state", *history.state()}, {"hash", state_hash(*history.state())}, {"steps", history.position()}};
    std::printf("%s\n", document.dump(2).c_str());
    return 0;
}

int run(int argc, char** argv) {
    using namespace underbody::studio;
    Options options;
    if (const int code = parse(argc, argv, options); code >= 0) {
        return code;
    }
    if (!options.log.empty() && options.screenshots.empty()) {
        return replay_without_window(options);
    }
    ::mallopt(M_ARENA_MAX, 2);                // of its own for every thread each would keep what it once held
    ::mallopt(M_MMAP_THRESHOLD, 128 * 1024);  // what is large goes back at once, however large others were
    const auto display = need_display(options);
    if (!options.screenshots.empty()) {
        ::setenv("QT_QPA_PLATFORM", "xcb", 1);  // 3D needs an X server, also where tests ask for `offscreen`
    }
    QApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
    QApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
    ::setenv("QT_XCB_GL_INTEGRATION", "none",
             0);  // the 3D views have VTK's: Qt need not load one with its first window
    Application application(argc, argv);
    // Qt takes the user's locale over; numbers in files must not change with it.
    std::setlocale(LC_NUMERIC, "C");
    QLocale::setDefault(QLocale::c());
    QApplication::setOrganizationName("Underbody");
    QApplication::setApplicationName("studio");
    QApplication::setStyle(window_style());
    set_theme("system");
    MainWindow window(options.screenshots.empty());
    application.failed = [&window](const std::exception_ptr& error) { window.show_failure("the window", error); };
    if (!options.theme.empty()) {
        set_theme(QString::fromStdString(options.theme));
    }
    if (options.width || options.height) {
        window.resize(options.width.value_or(window.width()), options.height.value_or(window.height()));
    }
    if (!options.screenshots.empty()) {
        window.resize(options.pictured());
        return take_screenshots(window, options.study, options.log, options.screenshots);
    }
    window.show();
    window.offer_recovery();
    if (!options.files.empty()) {
        window.take_files({options.files.begin(), options.files.end()});
    }
    return QApplication::exec();
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const underbody::core::Error& error) {
        std::fprintf(stderr, "underbody-studio: %s\n", error.what());
        return 3;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "underbody-studio: defect of the program: %s\n", error.what());
        return 1;
    }
}
