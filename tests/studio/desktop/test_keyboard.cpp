// Every workspace by keyboard alone: Tab comes to whatever can be done, and leaves it again.
#include <gtest/gtest.h>

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QAbstractSpinBox>
#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QHeaderView>
#include <QLineEdit>
#include <QMouseEvent>
#include <QSignalSpy>
#include <QSlider>
#include <QTabBar>
#include <QTableWidget>
#include <QTest>
#include <QToolBar>
#include <algorithm>
#include <set>

#include "studio/desktop/design_panel.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/region_panel.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

/// Something that people do things with, whatever its focus policy says. What a larger input is made of is not asked
/// for; nor are the bar of workspaces (F2 to F8) and the docks' buttons (F9, Ctrl+F9), which have keys of their own.
bool is_input(const QWidget& widget) {
    if (!widget.isVisible() || !widget.isEnabled()) {
        return false;
    }
    const QWidget* parent = widget.parentWidget();
    const auto within = [&](const char* of) { return parent != nullptr && parent->inherits(of); };
    if (within("QComboBox") || within("QAbstractSpinBox") || within("QLineEdit") || within("QTabBar") ||
        within("QToolBar") || within("QDockWidget") || within("QAbstractItemView") || within("QMenuBar") ||
        within("QStatusBar") || widget.inherits("QHeaderView")) {
        return false;
    }
    if (const auto* plot = qobject_cast<const PlotView*>(&widget)) {
        return plot->has_figure();
    }
    for (const char* kind : {"QSlider", "QLineEdit", "QAbstractButton", "QComboBox", "QAbstractItemView",
                             "QAbstractSpinBox", "QPlainTextEdit", "QTextEdit"}) {
        if (widget.inherits(kind)) {
            return true;
        }
    }
    return qobject_cast<const ParallelView*>(&widget) != nullptr;
}

std::string name_of(const QWidget* widget) {
    if (widget == nullptr) {
        return "nothing";
    }
    QString path;
    for (const QWidget* one = widget; one != nullptr && !one->isWindow(); one = one->parentWidget()) {
        path = one->metaObject()->className() + QString(one->objectName().isEmpty() ? "" : " ") + one->objectName() +
               (path.isEmpty() ? "" : " > ") + path;
    }
    const auto* button = qobject_cast<const QAbstractButton*>(widget);
    return (path + " '" + widget->accessibleName() + (button != nullptr ? button->text() : QString()) + "'")
        .toStdString();
}

/// Where the keyboard is, is seen: in the window, and with a ring about it.
void expect_seen(const QMainWindow& window, const QWidget& widget) {
    EXPECT_FALSE(widget.visibleRegion().isEmpty()) << name_of(&widget) << " has the keyboard and is not seen";
    const auto* ring = widget.findChild<QWidget*>("focus ring", Qt::FindDirectChildrenOnly);
    EXPECT_TRUE(ring != nullptr && ring->isVisible()) << name_of(&widget) << " has no ring";
    EXPECT_EQ(window.findChildren<QWidget*>("focus ring").size(), 1) << "one alone";
}

/// The widgets that Tab (or Shift+Tab) comes to until one comes again.
std::vector<QWidget*> walk(QMainWindow& window, Qt::KeyboardModifiers modifiers) {
    std::vector<QWidget*> way;
    std::set<QWidget*> seen;
    QApplication::setActiveWindow(&window);
    window.setFocus();
    for (int i = 0; i < 1000; ++i) {
        QTest::keyClick(QApplication::focusWidget() != nullptr ? QApplication::focusWidget() : &window,
                        modifiers == Qt::ShiftModifier ? Qt::Key_Backtab : Qt::Key_Tab, modifiers);
        QWidget* now = QApplication::focusWidget();
        if (now == nullptr || !seen.insert(now).second) {
            EXPECT_TRUE(now != nullptr && now == way.front())
                << "stuck at " << name_of(now) << " after " << way.size() << " steps";
            return way;
        }
        expect_seen(window, *now);
        way.push_back(now);
    }
    ADD_FAILURE() << "Tab comes round to no widget again";
    return way;
}

/// The study on the left, the workspace, or what stands below.
const QWidget* area_of(const QWidget* widget) {
    for (const QWidget* one = widget; one != nullptr; one = one->parentWidget()) {
        if (one->inherits("QDockWidget") || qobject_cast<const Panel*>(one) != nullptr) {
            return one;
        }
    }
    return nullptr;
}

/// Each area is gone through before the next one.
void expect_areas_together(const std::vector<QWidget*>& way) {
    std::set<const QWidget*> areas;
    std::size_t changes = 0;
    for (std::size_t i = 0; i < way.size(); ++i) {
        const auto *here = area_of(way[i]), *next = area_of(way[(i + 1) % way.size()]);
        areas.insert(here);
        changes += here != next ? 1 : 0;
    }
    std::string text;
    for (const auto* one : way) {
        text += "\n  " + name_of(one);
    }
    EXPECT_LE(changes, areas.size()) << "Tab jumps between the parts of the window:" << text;
}

TEST_F(Window, EveryInputIsReachedByTab) {
    open(computed_study());
    act("select case/ellipse-h5-p0 case/ellipse-h2-p0");
    for (const auto& workspace : workspace_names()) {
        SCOPED_TRACE(workspace);
        act("workspace " + workspace);
        settle(*window_);
        for (const auto modifiers : {Qt::KeyboardModifiers(Qt::NoModifier), Qt::KeyboardModifiers(Qt::ShiftModifier)}) {
            const std::vector<QWidget*> way = walk(*window_, modifiers);
            settle(*window_);
            EXPECT_GE(way.size(), 5U);
            expect_areas_together(way);
            for (auto* widget : window_->findChildren<QWidget*>()) {
                if (!is_input(*widget)) {
                    continue;
                }
                const QWidget* proxy = widget->focusProxy() != nullptr ? widget->focusProxy() : widget;
                EXPECT_TRUE(std::find(way.begin(), way.end(), proxy) != way.end())
                    << (modifiers == Qt::ShiftModifier ? "backwards: " : "") << name_of(widget)
                    << " is not come to (focus policy " << widget->focusPolicy() << ")";
            }
        }
        EXPECT_TRUE(window_->last_error().isEmpty()) << window_->last_error().toStdString();
    }
}

// What the mouse does on a plot, keys do too.
// A plot gives its picture and its numbers, rows of a table go into a spreadsheet.
// Of a list the mouse presses what is inside it, and the ring stayed.
TEST_F(Window, TheRingGoesWhenTheMouseIsUsed) {
    open(computed_study());
    auto* tree = window_->findChild<StudyTree*>();
    ASSERT_NE(tree, nullptr);
    tree->setFocus(Qt::TabFocusReason);
    QTest::keyClick(tree, Qt::Key_Tab);
    QTest::keyClick(QApplication::focusWidget(), Qt::Key_Backtab, Qt::ShiftModifier);
    auto* area = qobject_cast<QAbstractScrollArea*>(QApplication::focusWidget());
    ASSERT_NE(area, nullptr) << name_of(QApplication::focusWidget());
    expect_seen(*window_, *area);
    QTest::mouseClick(area->viewport(), Qt::LeftButton, Qt::NoModifier, area->viewport()->rect().center());
    const auto* ring = area->findChild<QWidget*>("focus ring", Qt::FindDirectChildrenOnly);
    EXPECT_TRUE(ring == nullptr || !ring->isVisible());
}

TEST_F(Window, EveryPlotAndTableIsCopied) {
    open(computed_study());
    act("workspace tables");
    settle(*window_);
    PlotView* plot = nullptr;
    for (auto* one : window_->findChildren<PlotView*>()) {
        plot = one->isVisible() && one->has_figure() ? one : plot;
    }
    ASSERT_NE(plot, nullptr);
    ASSERT_EQ(plot->actions().size(), 2);
    plot->actions()[1]->trigger();
    const QStringList lines = QApplication::clipboard()->text().split('\n');
    ASSERT_GT(lines.size(), 100);
    EXPECT_EQ(lines[0].toStdString(), "series\tgap (mm)\tlift force (N)");
    EXPECT_EQ(lines[1].split('\t').size(), 3);
    plot->actions()[0]->trigger();
    EXPECT_FALSE(QApplication::clipboard()->image().isNull());
    act("workspace design");
    settle(*window_);
    auto* card = panel<DesignPanel>().card();
    card->selectionModel()->select(card->model()->index(1, 0),  // whatever key was pressed last
                                   QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
    QTest::keySequence(card, QKeySequence::Copy);
    const QStringList rows = QApplication::clipboard()->text().split('\n', Qt::SkipEmptyParts);
    ASSERT_EQ(rows.size(), 2) << QApplication::clipboard()->text().toStdString();
    EXPECT_EQ(rows[0].toStdString(), "result\tnow\tbefore");
    EXPECT_TRUE(rows[1].startsWith("stable gaps\t")) << rows[1].toStdString();
}

TEST_F(Window, AStartIsChosenByKeyboard) {
    open(computed_study());
    act("workspace stability");
    act("region glide cells=20");
    settle(*window_);
    auto& stability = panel<RegionPanel>();
    PlotView* map = nullptr;
    for (auto* plot : stability.findChildren<PlotView*>()) {
        map = plot->has_figure() && !plot->figure().classes.empty() ? plot : map;
    }
    ASSERT_NE(map, nullptr);
    QSignalSpy said(map, &PlotView::hovered);
    map->setFocus();
    QTest::keyClick(map, Qt::Key_Right);
    QTest::keyClick(map, Qt::Key_Right);
    EXPECT_EQ(said.count(), 2) << "where the mark stands is said as under the mouse";
    QTest::keyClick(map, Qt::Key_Return);
    const auto start = window_->desk().state().regions.at("glide").start;
    ASSERT_TRUE(start);
    EXPECT_NEAR((*start)[1], 0, 1e-9) << "in the middle between -60 and 60 mm/s";
    EXPECT_GT((*start)[0], 0.002);
    settle(*window_);
    EXPECT_TRUE(stability.trajectory());
    window_->desk().undo();
    EXPECT_FALSE(window_->desk().state().regions.at("glide").start);
}

TEST_F(Window, ARangeIsKeptByKeyboard) {
    open(computed_study());
    act("workspace explore");
    settle(*window_);
    auto& explore = panel<ExplorePanel>();
    auto* lines = explore.findChild<ParallelView*>();
    ASSERT_EQ(explore.kept().size(), 5U);
    lines->setFocus();
    QTest::keyClick(lines, Qt::Key_Down);
    ASSERT_EQ(window_->desk().state().explore.brush.size(), 1U);
    EXPECT_EQ(explore.kept().size(), 4U) << "the largest is out";
    QTest::keyClick(lines, Qt::Key_Up, Qt::ShiftModifier);
    EXPECT_EQ(explore.kept().size(), 3U) << "and the smallest";
    QTest::keyClick(lines, Qt::Key_Delete);
    EXPECT_TRUE(window_->desk().state().explore.brush.empty());
    EXPECT_EQ(explore.kept().size(), 5U);
}

// Axes are moved by Ctrl with an arrow, and by dragging their titles.
TEST_F(Window, AxesOfTheLinesAreReordered) {
    open(computed_study());
    act("workspace explore");
    settle(*window_);
    auto* lines = panel<ExplorePanel>().findChild<ParallelView*>();
    const auto order = [&] { return window_->desk().state().explore.order; };
    const auto names = [&] {
        std::vector<std::string> all;
        for (const auto& axis : lines->axes()) {
            all.push_back(axis.name);
        }
        return all;
    };
    const std::vector<std::string> first = names();
    ASSERT_GE(first.size(), 3U);
    lines->setFocus();
    QTest::keyClick(lines, Qt::Key_Right, Qt::ControlModifier);
    ASSERT_EQ(order().size(), first.size());
    EXPECT_EQ(names(), order());
    EXPECT_EQ(names()[0], first[1]);
    EXPECT_EQ(names()[1], first[0]);
    QTest::keyClick(lines, Qt::Key_Down);
    EXPECT_TRUE(window_->desk().state().explore.brush.contains(first[0])) << "keys stay with the axis that was moved";
    window_->desk().undo();
    window_->desk().undo();
    EXPECT_EQ(names(), first);
    window_->desk().redo();
    EXPECT_EQ(names()[1], first[0]);
    window_->desk().undo();
    const auto at = [&](std::size_t axis) { return QPoint(static_cast<int>(lines->x_of(axis)), 10); };
    QTest::mousePress(lines, Qt::LeftButton, {}, at(0));
    QMouseEvent move(QEvent::MouseMove, at(2), Qt::LeftButton, Qt::LeftButton, {});
    QApplication::sendEvent(lines, &move);
    EXPECT_FALSE(lines->grab().isNull());
    QTest::mouseRelease(lines, Qt::LeftButton, {}, at(2));
    std::vector<std::string> wanted = first;
    std::rotate(wanted.begin(), wanted.begin() + 1, wanted.begin() + 3);
    EXPECT_EQ(names(), wanted);
    EXPECT_EQ(window_->desk().history().steps().back().name, "order of the axes");
    EXPECT_TRUE(window_->desk().state().explore.brush.empty()) << "a title is no range";
    act("order");
    EXPECT_EQ(names(), first);
}

}  // namespace
}  // namespace underbody::studio
