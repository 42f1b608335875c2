// What stands beside the workspaces and below them, and how the window shares its room between them.
#include <QBoxLayout>
#include <QDockWidget>
#include <QLabel>
#include <QLineEdit>
#include <QResizeEvent>
#include <QStyle>
#include <QTabWidget>
#include <QTimer>
#include <algorithm>
#include <cstdlib>

#include "studio/desktop/bottom_panels.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/panel.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/study_tree.h"

namespace underbody::studio {

namespace {

constexpr int least_tree = 220;  ///< px: names of cases are read
constexpr int most_below = 150;  ///< px, of what stands below where a workspace lacks room

}  // namespace

void MainWindow::build_tree() {
    auto* holder = new QWidget;
    auto* column = new QVBoxLayout(holder);
    column->setContentsMargins(4, 4, 0, 0);
    auto* filter = new QLineEdit;
    filter->setPlaceholderText("Filter the study");
    filter->setAccessibleName("Filter the study");
    filter->setClearButtonEnabled(true);
    column->addWidget(filter);
    tree_ = new StudyTree(*desk_, holder);
    column->addWidget(tree_, 1);
    auto* count = new QLabel;
    column->addWidget(count);
    connect(filter, &QLineEdit::textChanged, tree_, &StudyTree::filter);
    connect(tree_, &StudyTree::counted, count, &QLabel::setText);
    tree_dock_ = new QDockWidget("Study", this);
    tree_dock_->setObjectName("study_dock");
    tree_dock_->setWidget(holder);
    holder->setMinimumWidth(190);
    addDockWidget(Qt::LeftDockWidgetArea, tree_dock_);
    setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
}

void MainWindow::build_below() {
    below_ = new QTabWidget;
    below_->setDocumentMode(true);
    below_->setTabPosition(QTabWidget::South);
    problems_ = new ProblemList(this);
    below_->addTab(new CommandList(*desk_, this), "Commands");
    below_->addTab(problems_, "Problems");
    below_->addTab(new JobList(*jobs_, this), "Jobs");
    below_->addTab(new HistoryList(*desk_, this), "History");
    below_->setCurrentWidget(problems_);
    connect(problems_, &ProblemList::counted, this, [this](int count) {
        below_->setTabText(1, count > 0 ? QString("Problems (%1)").arg(count) : QString("Problems"));
    });
    below_dock_ = new QDockWidget("Commands, problems, jobs, history", this);
    below_dock_->setObjectName("below_dock");
    below_dock_->setWidget(below_);
    addDockWidget(Qt::BottomDockWidgetArea, below_dock_);
}

/// The tree has all its columns where the workspaces leave them room; what stands below has a few lines.
void MainWindow::showEvent(QShowEvent* event) {
    QMainWindow::showEvent(event);
    if (!laid_out_) {
        laid_out_ = true;
        const QSize left = size() - needed();
        resizeDocks({tree_dock_}, {std::clamp(left.width() - 16, least_tree, 490)}, Qt::Horizontal);
        resizeDocks({below_dock_}, {std::clamp(left.height() - 110, 84, most_below)}, Qt::Vertical);
    }
    QTimer::singleShot(0, this, &MainWindow::make_room);
}

void MainWindow::resizeEvent(QResizeEvent* event) {
    QMainWindow::resizeEvent(event);
    if (isVisible()) {
        QTimer::singleShot(0, this, &MainWindow::make_room);
    }
}

/// Of the workspace that needs most, with the bar that rolls it up and down.
QSize MainWindow::needed() const {
    QSize most;
    for (const auto* panel : panels_) {
        most = most.expandedTo(panel->minimumSizeHint());
    }
    return most + QSize(style()->pixelMetric(QStyle::PM_ScrollBarExtent, nullptr, this), 0);
}

/// The tree gives way before a workspace is rolled sideways, what stands below before it is rolled up and down.
void MainWindow::make_room() {
    const QMargins around = centralWidget()->layout()->contentsMargins();
    const QSize lack = needed().grownBy(around) - centralWidget()->size();
    // What was given is taken back where there is room again, unless somebody has moved the edge meanwhile.
    const auto give = [this](QDockWidget* dock, GivenRoom& given, int size, int by, int least, Qt::Orientation along) {
        if (!dock->isVisible() || dock->isFloating()) {
            return;
        }
        constexpr int same = 8;  // px
        if (given.by > 0 && std::abs(size - given.left) > same) {
            given = {};
        }
        const int now = by > 0 ? std::max(std::min(size, least), size - by) : size + std::min(given.by, -by);
        if (now != size) {
            given = {given.by + size - now, now};
            resizeDocks({dock}, {now}, along);
        }
    };
    give(tree_dock_, tree_gave_, tree_dock_->width(), lack.width(), least_tree, Qt::Horizontal);
    give(below_dock_, below_gave_, below_dock_->height(), lack.height(), most_below, Qt::Vertical);
}

}  // namespace underbody::studio
