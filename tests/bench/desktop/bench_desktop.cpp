// bench_desktop [STUDY] [--faces N] [--cases FOLDER] [--keep FILE.stl]: the figures of the window on a display of its
// own (Xvfb, software renderer) by the clock, for a quiet machine. STUDY: computed, as `underbody study run` leaves it
// (default cases/evie). N: faces of the large surface (default 5,000,000; 0: left out). FOLDER: a computed study of
// very many cases, as tests/bench/cases/bench_scaling.py makes them. FILE.stl: where the large surface is kept, which
// side_by_side.py opens and turns beside ParaView.
#include <malloc.h>

#include <QApplication>
#include <QElapsedTimer>
#include <QLineEdit>
#include <QMouseEvent>
#include <QScrollBar>
#include <QTest>
#include <algorithm>
#include <cstdio>

#include "core/file.h"
#include "core/virtual_display.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/scene_widget.h"
#include "studio/desktop/screenshots.h"
#include "studio/desktop/state/words.h"
#include "studio/desktop/study_tree.h"
#include "studio/desktop/theme.h"
#include "tests/bench/desktop/measuring.h"
#include "tests/support/many_faces.h"

namespace underbody::studio {
namespace {

namespace fs = std::filesystem;

class Bench {
public:
    Bench(MainWindow& window) : window_(window) {}

    void study(const fs::path& folder) {
        window_.open_study(folder);
        const double first = until([&] { return panel<DesignPanel>().has_drawn() || drawn() > 0; });
        say("opened, to the first picture", first, "600: 1.0 s from the start less 0.4 s to the window");
        say("  since the process was started", age(), "1000");
        settle(window_);
        say("  longest gap of the loop", beat_.take(), "100");
        QTest::qWait(1500);  // what is free is given back after a second of rest
        say_memory("the study", 200);
    }

    void actions() {
        Gap longest;
        std::string worst;
        for (const char* line :
             {"workspace explore", "brush gap=0:6mm", "brush", "workspace compare", "fields camera=bottom",
              "select case/ellipse-h5-p0 case/ellipse-h2-p0", "fields difference=on", "fields difference=off",
              "workspace tables", "table lift net_weight=0.25N", "workspace stability", "region glide start=5mm,5mm/s",
              "workspace loop", "workspace design", "set 'protrusion.height=1.5 mm'", "operation gap=8mm", "reset"}) {
            window_.desk().act(words_of(line));
            settle(window_);
            const Gap gap = beat_.take();
            std::printf("    %-50s %6.0f ms  (%.0f)\n", line, 1000 * gap.clock, 1000 * gap.processor);
            worst = gap.clock > longest.clock ? line : worst;
            longest = {std::max(longest.clock, gap.clock), std::max(longest.processor, gap.processor)};
        }
        say("longest gap of the loop, '" + worst + "'", longest, "50, 100 while jobs run");
        undone();
        settle(window_);
        beat_.take();
    }

    /// The last step undone and done again, to its pixels: medians.
    void undone() {
        std::vector<double> clock, used;
        for (int i = 0; i < 20; ++i) {
            const double before = thread_time();
            QElapsedTimer time;
            time.start();
            i % 2 == 0 ? window_.desk().undo() : window_.desk().redo();
            QApplication::processEvents();
            clock.push_back(1e-9 * static_cast<double>(time.nsecsElapsed()));
            used.push_back(thread_time() - before);
            settle(window_);
        }
        for (auto* times : {&clock, &used}) {
            std::sort(times->begin(), times->end());
        }
        say("undo, median of 20 with redo", Gap{clock[10], used[10]}, "50");
        std::printf("%-40s %8.0f ms\n", "  the longest", 1000 * clock.back());
    }

    /// A number is dragged for two seconds; a body counts when it is another one.
    void drag() {
        window_.desk().act({"workspace", "design"});
        settle(window_);
        auto& design = panel<DesignPanel>();
        const auto* before = design.shown().get();
        int bodies = 0, moves = 0;
        QElapsedTimer time;
        time.start();
        while (time.elapsed() < 2000) {
            const double height = 1 + 0.001 * static_cast<double>(time.elapsed() % 1000);
            window_.desk().act({"set", "protrusion.height=" + std::to_string(height) + " mm"}, "drag");
            ++moves;
            QApplication::processEvents();  // on a busy machine a move may take longer than its time
            until([&, next = moves * 16] { return time.elapsed() >= next || design.shown().get() != before; });
            bodies += design.shown().get() != before ? 1 : 0;
            before = design.shown().get();
        }
        std::printf("%-40s %8.1f /s    (goal 20)\n", "bodies while a number is dragged", bodies / 2.0);
        time.restart();
        window_.desk().end_gesture();
        const double rest = until([&] { return design.shown()->certificate.has_value(); });
        say("release to surface and certificate", rest, "300");
        settle(window_);
        say("  longest gap of the loop", beat_.take(), "100");
    }

    /// From a number that is changed to the body in its view, as a key on its slider changes it.
    void slider_to_pixels() {
        SceneWidget* view = nullptr;
        auto& design = panel<DesignPanel>();
        for (auto* one : design.findChildren<SceneWidget*>()) {
            view = one;
        }
        std::vector<double> shown, drawn, used;
        for (int i = 0; i < 30; ++i) {
            QTest::qWait(40);  // a key that is held repeats every 33 to 40 ms
            const auto* before = design.shown().get();
            const double before_it = thread_time();
            QElapsedTimer time;
            time.start();
            window_.desk().act({"set", "protrusion.height=" + std::to_string(1 + 0.01 * i) + " mm"}, "keys");
            until([&] { return design.shown().get() != before; });
            shown.push_back(1e-6 * static_cast<double>(time.nsecsElapsed()));
            const int seen = view->pictures();
            until([&] { return view->pictures() > seen; });
            drawn.push_back(1e-6 * static_cast<double>(time.nsecsElapsed()));
            used.push_back(1000 * (thread_time() - before_it));
        }
        window_.desk().end_gesture();
        for (auto* times : {&shown, &drawn, &used}) {
            std::sort(times->begin(), times->end());
        }
        const std::size_t middle = drawn.size() / 2;
        std::printf(
            "%-40s %8.1f ms    (goal 50; most %.0f; its body is made after %.1f; %.1f of the thread's processor)\n",
            "number to pixels, median", drawn[middle], drawn.back(), shown[middle], used[middle]);
        settle(window_);
        beat_.take();
    }

    void cancel() {
        window_.jobs().start("bench", "waiting", [](core::Progress& progress) -> std::function<void()> {
            for (;;) {
                progress.check();
                ::usleep(1000);
            }
        });
        QTest::qWait(100);
        window_.jobs().cancel();
        say("cancel to nothing running", until([&] { return !window_.jobs().busy(); }), "200");
    }

    void faces(int count, const fs::path& file) {
        test::write_stl(file, count);
        beat_.take();
        window_.take_files({file});
        auto& fields = panel<FieldsPanel>();
        say(std::to_string(count) + " faces to the first picture", until([&] { return fields.stands_in(0); }), "6000");
        SceneWidget* view = nullptr;
        for (auto* one : fields.findChildren<SceneWidget*>()) {
            view = one->isVisible() ? one : view;
        }
        say("  longest gap of the loop", beat_.take(), "100");
        say("  whole picture", until([&] { return !fields.stands_in(0); }), "3200: 200 of rest and 3000");
        say("  longest gap of the loop", beat_.take(), "100");
        turned(*view);
        say_memory("with them", 700);
        turned(*view);
        say_memory("after another turn", 700);
        while (window_.desk().state().selection == std::vector<std::string>{"field/" + file.string()}) {
            window_.desk().undo();
        }
        settle(window_);
    }

    void turned(SceneWidget& view) {
        auto& fields = panel<FieldsPanel>();
        const QPoint middle = view.rect().center();
        QTest::mousePress(&view, Qt::LeftButton, Qt::NoModifier, middle);
        const int before_turn = view.pictures();
        QElapsedTimer time;
        time.start();
        const double before = process_time();
        for (int move = 0; time.elapsed() < 3000; ++move) {
            QTest::mouseMove(&view, middle + QPoint(move % 200, move % 120));
            const int seen = view.pictures();
            until([&] { return view.pictures() > seen || time.elapsed() >= 3000; });
        }
        const int frames = view.pictures() - before_turn;
        std::printf("%-40s %8.1f /s    (goal 15; %.0f ms of processor each)\n", "  pictures while turning",
                    1000.0 * frames / static_cast<double>(time.elapsed()), 1000 * (process_time() - before) / frames);
        QTest::mouseRelease(&view, Qt::LeftButton, Qt::NoModifier, middle);
        say("  longest gap of the loop", beat_.take(), "100");
        say("  whole picture after the turn", until([&] { return !fields.stands_in(0); }), "3200");
    }

    void many_cases(const fs::path& folder) {
        auto& tree = *window_.findChild<StudyTree*>();
        beat_.take();
        window_.open_study(folder);
        say("many cases to the first row", until([&] {
                return window_.has_study() && window_.desk().session().folder == fs::absolute(folder) &&
                       tree.model()->rowCount() > 0 && tree.indexAt({4, 4}).isValid();
            }),
            "500");
        settle(window_);
        say("  longest gap of the loop", beat_.take(), "100");
        for (auto* edit : window_.findChildren<QLineEdit*>()) {
            if (edit->accessibleName() == "Filter the study") {
                QTest::keyClicks(edit, "v");
                QElapsedTimer time;
                time.start();
                QTest::keyClicks(edit, "1");
                QApplication::processEvents();
                say("  a letter of the filter", 1e-9 * static_cast<double>(time.nsecsElapsed()), "10");
                edit->clear();
            }
        }
        QElapsedTimer time;
        time.start();
        tree.sortByColumn(StudyModel::lift, Qt::DescendingOrder);
        QApplication::processEvents();
        say("  sorted by lift", 1e-9 * static_cast<double>(time.nsecsElapsed()), "30");
        beat_.take();
        scroll(tree);
        chosen(tree);
        explored();
        say_memory("with them", 250);
    }

    /// Through all rows by the wheel's pages.
    void scroll(StudyTree& tree) {
        auto* bar = tree.verticalScrollBar();
        for (int i = 0; i <= 40; ++i) {
            bar->setValue(bar->maximum() * i / 40);
            QApplication::processEvents();
        }
        say("  scrolled through, longest gap", beat_.take(), "100");
    }

    /// One row by the mouse, then all by Ctrl+A.
    void chosen(StudyTree& tree) {
        window_.desk().act({"workspace", "compare"});
        settle(window_);
        beat_.take();
        tree.verticalScrollBar()->setValue(300);
        QTest::mouseClick(tree.viewport(), Qt::LeftButton, {}, {60, 100});
        settle(window_);
        say("  a case chosen, longest gap", beat_.take(), "100");
        for (const char* workspace : {"compare", "tables"}) {
            window_.desk().act({"workspace", workspace});
            settle(window_);
            beat_.take();
            tree.setFocus();
            QTest::keyClick(&tree, Qt::Key_A, Qt::ControlModifier);
            settle(window_);
            say("  all chosen in " + std::string(workspace) + ", longest gap", beat_.take(), "100");
            window_.desk().undo();
            settle(window_);
            beat_.take();
        }
    }

    /// The lines of all cases: the first sight, a range dragged by the mouse and let go, one typed.
    void explored() {
        window_.desk().act({"workspace", "explore"});
        settle(window_);
        say("  Explore's first sight, longest gap", beat_.take(), "100");
        auto& lines = *window_.findChild<ParallelView*>();
        const int x = static_cast<int>(lines.x_of(0));
        QTest::mousePress(&lines, Qt::LeftButton, {}, {x, lines.height() / 2});
        for (int i = 0; i < 20; ++i) {
            const QPointF at(x, lines.height() / 2 + 2 * i);
            QMouseEvent move(QEvent::MouseMove, at, Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
            QApplication::sendEvent(&lines, &move);
            QApplication::processEvents();
        }
        say("  a range dragged, longest gap", beat_.take(), "50");
        QTest::mouseRelease(&lines, Qt::LeftButton, {}, {x, lines.height() / 2 + 40});
        settle(window_);
        say("  and let go, longest gap", beat_.take(), "100");
        if (window_.desk().state().explore.brush.empty()) {
            throw std::runtime_error("no range was kept");
        }
        window_.desk().act({"brush"});
        settle(window_);
        say("  and taken away, longest gap", beat_.take(), "100");
    }

    void empty() { say_memory("empty", 110); }

private:
    template <class Panel>
    Panel& panel() {
        return *window_.findChild<Panel*>();
    }
    std::size_t drawn() { return panel<FieldsPanel>().drawn(); }

    MainWindow& window_;
    ClockBeat beat_;
};

int run(int argc, char** argv) {
    fs::path study = fs::path(UNDERBODY_SOURCE_FOLDER) / "cases" / "evie", cases;
    fs::path kept;
    int faces = 5000000;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--faces" && i + 1 < argc) {
            faces = std::stoi(argv[++i]);
        } else if (word == "--cases" && i + 1 < argc) {
            cases = argv[++i];
        } else if (word == "--keep" && i + 1 < argc) {
            kept = argv[++i];
        } else {
            study = word;
        }
    }
    const double before_display = age();
    const core::VirtualDisplay display(1600, 1000);
    ::setenv("DISPLAY", display.name().c_str(), 1);
    ::setenv("QT_QPA_PLATFORM", "xcb", 1);
    ::setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    ::mallopt(M_ARENA_MAX, 2);  // as underbody-studio
    ::mallopt(M_MMAP_THRESHOLD, 128 * 1024);
    const double display_took = age() - before_display;
    ::setenv("QT_XCB_GL_INTEGRATION", "none", 1);
    QApplication application(argc, argv);
    std::setlocale(LC_NUMERIC, "C");
    QLocale::setDefault(QLocale::c());
    QApplication::setStyle(window_style());
    set_theme("light");
    MainWindow window(false);
    window.ask = [](const QString&, const QString&, const QString&) { return true; };
    window.resize(1280, 800);
    Bench bench(window);
    window.show();
    (void)QTest::qWaitForWindowExposed(&window, 20000);
    say("start to the window", age() - display_took, "400");
    settle(window);
    bench.empty();
    bench.study(study);
    bench.actions();
    bench.drag();
    bench.slider_to_pixels();
    bench.cancel();
    const core::TemporaryFolder scratch;
    if (faces > 0) {
        bench.faces(faces, kept.empty() ? scratch.path() / "many.stl" : kept);
    }
    if (!cases.empty()) {
        bench.many_cases(cases);
    }
    return 0;
}

}  // namespace
}  // namespace underbody::studio

int main(int argc, char** argv) {
    try {
        return underbody::studio::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_desktop: %s\n", error.what());
        return 1;
    }
}
