// A study of very many cases in the window, and the first page of an empty one.
#include <QLineEdit>
#include <QMouseEvent>
#include <QPlainTextEdit>
#include <QTest>
#include <QToolButton>
#include <cmath>
#include <fstream>

#include "core/text.h"
#include "studio/desktop/bottom_panels.h"
#include "studio/desktop/first_page.h"
#include "studio/desktop/parallel_view.h"
#include "tests/studio/desktop/heartbeat.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

/// A study of so many cases, none of them computed.
fs::path study_of(int cases, const fs::path& folder) {
    fs::create_directories(folder / "fields");
    for (int i = 0; i < cases; ++i) {
        std::ofstream(folder / "fields" / ("cube-h" + core::format_number(1 + 0.01 * i) + ".csv")) << "x\n";
    }
    core::write_file(
        folder / "study.toml",
        "title = \"Many\"\nsummary = \"Cubes.\"\norigin = \"made by a test\"\n\n[frame]\nforward = \"+x\"\n"
        "up = \"+z\"\n\n[[case]]\nfiles = \"fields/{variant}-h{gap:mm}.csv\"\nconditions = { speed = "
        "\"0.5 m/s\" }\n");
    return folder;
}

/// Processor time of the window's thread that typing a letter into the filter takes, and of sorting by lift.
struct Handled {
    double letter = 0, sort = 0;
    int left = 0;
};

Handled handled(MainWindow& window) {
    QLineEdit* filter = nullptr;
    for (auto* edit : window.findChildren<QLineEdit*>()) {
        filter = edit->accessibleName() == "Filter the study" ? edit : filter;
    }
    auto* tree = window.findChild<StudyTree*>();
    Handled result;
    QTest::keyClicks(filter, "h");
    double before = thread_time();
    QTest::keyClicks(filter, "5");
    QApplication::processEvents();
    result.letter = thread_time() - before;
    result.left = tree->count().section(' ', 0, 0).toInt();
    filter->clear();
    QApplication::processEvents();
    before = thread_time();
    tree->sortByColumn(StudyModel::gap, Qt::DescendingOrder);
    QApplication::processEvents();
    result.sort = thread_time() - before;
    tree->sortByColumn(StudyModel::name, Qt::AscendingOrder);
    return result;
}

// What the window's thread does grows with what is seen, and at most in proportion with what there is.
TEST_F(Window, TenThousandCasesDoNotStopTheWindow) {
    open(study_of(1000, folder_.path() / "thousand"));
    const Handled few = handled(*window_);
    const fs::path many = study_of(10000, folder_.path() / "many");
    Heartbeat heartbeat;
    open(many);
    EXPECT_EQ(window_->desk().session().study.cases.size(), 10000U);
    EXPECT_TRUE(window_->findChild<StudyTree*>()->count().contains("10000")) << "all are there";
    std::printf("longest gap on opening: %.0f ms of processor time\n", 1000 * heartbeat.longest());
    EXPECT_LT(heartbeat.longest(), 0.4) << "3.4 s once";
    const Handled all = handled(*window_);
    std::printf("a letter of the filter: %.1f ms (of 1,000: %.1f), sorting: %.1f (%.1f)\n", 1000 * all.letter,
                1000 * few.letter, 1000 * all.sort, 1000 * few.sort);
    EXPECT_EQ(all.left, 1100) << "5 to 5.99 and 50 to 59.99, in steps of 0.01";
    EXPECT_LT(all.letter, 0.15);
    EXPECT_LT(all.sort, 0.3);
}

// Ctrl+A in the tree chooses all of them, and Compare shows the first six.
TEST_F(Window, AllOfTenThousandCasesAreChosenAtOnce) {
    open(study_of(10000, folder_.path() / "many"));
    auto* tree = window_->findChild<StudyTree*>();
    for (const char* workspace : {"tables", "compare"}) {
        act(std::string("workspace ") + workspace);
        act("select");
        settle(*window_);
        tree->setFocus();
        const double before = thread_time();
        QTest::keyClick(tree, Qt::Key_A, Qt::ControlModifier);
        QApplication::processEvents();
        const double took = thread_time() - before;
        std::printf("all chosen in %s: %.0f ms of processor time\n", workspace, 1000 * took);
        EXPECT_EQ(window_->desk().state().selection.size(), 10000U);
        EXPECT_LT(took, 0.3) << "1.6 s in Compare, 0.6 s elsewhere before";
        settle(*window_);
    }
    // The list of commands shows the beginning of such a line and keeps the whole.
    const auto* commands = window_->findChild<CommandList*>();
    const auto* shown = commands->findChild<QPlainTextEdit*>();
    EXPECT_GT(commands->script().size(), 100000);
    EXPECT_LT(shown->toPlainText().size(), 20000);
    EXPECT_TRUE(shown->toPlainText().contains("more characters"));
}

// The limits of a shape's numbers are asked for beside the window, however many cases stand around it.
TEST_F(Window, LimitsAreAskedForBesideTheWindow) {
    const fs::path study = study_of(10000, folder_.path() / "study");
    fs::create_directories(study / "shapes");
    fs::copy_file(test::source_folder() / "cases" / "evie" / "shapes" / "ellipse.toml",
                  study / "shapes" / "ellipse.toml");
    core::write_file(study / "study.toml", core::read_file(study / "study.toml") +
                                               "\n[[body]]\nname = \"ellipse\"\nshape = \"shapes/ellipse.toml\"\n");
    open(study);
    act("workspace design");
    settle(*window_);
    auto* fold = window_->findChild<QToolButton*>("fold protrusion");
    ASSERT_NE(fold, nullptr);
    double longest = 0;
    for (int i = 0; i < 2; ++i) {  // each asks for them anew: other rows, another shape
        const double before = thread_time();
        if (i % 2 == 0) {
            fold->click();
        } else {
            act("set 'body.length=" + std::to_string(195 + i) + " mm'");
        }
        longest = std::max(longest, thread_time() - before);
        Heartbeat heartbeat;
        settle(*window_);
        longest = std::max(longest, heartbeat.longest());
    }
    std::printf("limits of a shape beside 10,000 cases: the loop waits %.1f ms of processor time at most\n",
                1000 * longest);
    EXPECT_LT(longest, 0.05);
}

// Lines of all cases are drawn once: a range that is dragged moves over them, and the table writes what is seen of it.
TEST_F(Window, ARangeIsDraggedOverTenThousandLines) {
    ParallelView view(nullptr);
    view.resize(1200, 260);
    std::vector<ParallelView::Axis> axes;
    std::vector<std::size_t> all(10000);
    for (std::size_t k = 0; k < 9; ++k) {
        ParallelView::Axis axis{"c" + std::to_string(k), "c", 1, {}, 0, 1};
        for (std::size_t row = 0; row < all.size(); ++row) {
            all[row] = row;
            axis.values.push_back(std::sin(1.0 + static_cast<double>(row * (k + 1))));
        }
        axes.push_back(axis);
    }
    view.show_axes(axes);
    view.show_brush({}, all);
    view.show();
    settle(*window_);
    const int x = static_cast<int>(view.x_of(4));
    QTest::mousePress(&view, Qt::LeftButton, {}, {x, 150});
    const double before = thread_time();
    for (int i = 1; i <= 20; ++i) {
        QMouseEvent move(QEvent::MouseMove, QPointF(x, 150 + i), Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&view, &move);
        view.repaint();
    }
    const double each = (thread_time() - before) / 20;
    std::printf("a move over 10,000 lines of 9 columns: %.1f ms of processor time\n", 1000 * each);
    EXPECT_LT(each, 0.016) << "goal; the lines were drawn anew at each move";
}

// A small window is as small as it is asked to be: workspaces are scrolled, and the tree keeps room for names.
TEST_F(Window, ASmallWindowKeepsItsSize) {
    open(computed_study());
    window_->resize(800, 500);
    for (const auto& workspace : workspace_names()) {
        act("workspace " + workspace);
        settle(*window_);
        EXPECT_LE(window_->width(), 800) << workspace;
        EXPECT_LE(window_->height(), 500) << workspace;
    }
    EXPECT_GE(window_->findChild<StudyTree*>()->width(), 180);
}

// An empty window shows where to begin: the shipped study, what was open, and where to drop files.
TEST_F(Window, TheFirstPageSaysWhereToBegin) {
    auto* page = window_->findChild<FirstPage*>();
    ASSERT_TRUE(page != nullptr && page->isVisible());
    const fs::path known = computed_study();
    page->show_recent({QString::fromStdString(known.string()), "/nowhere/gone"},
                      QString::fromStdString(folder_.path().string()));
    std::map<QString, QToolButton*> buttons;
    for (auto* button : page->findChildren<QToolButton*>()) {
        buttons[button->toolTip()] = button;
    }
    ASSERT_EQ(buttons.size(), 3U) << "two recent ones and the shipped study";
    EXPECT_FALSE(buttons["/nowhere/gone"]->isEnabled());
    const QString shipped = shipped_study();
    ASSERT_FALSE(shipped.isEmpty());
    ASSERT_EQ(buttons.count(shipped), 1U);
    EXPECT_EQ(buttons[shipped]->text(), "The shipped study: EVIE");
    buttons[QString::fromStdString(known.string())]->click();
    settle(*window_);
    EXPECT_TRUE(window_->has_study());
    EXPECT_EQ(window_->desk().session().folder, known);
    EXPECT_FALSE(page->isVisible());
}

}  // namespace
}  // namespace underbody::studio
