// Views of a workspace: each in a cell with a thin title, from which it is hidden; two beside each other where there is
// room for both, else the one whose tab is chosen.
#pragma once

#include <QBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QTabBar>
#include <QTimer>
#include <QToolButton>
#include <QWidget>
#include <functional>

#include "studio/desktop/panel.h"

namespace underbody::studio {

class ViewCell : public QWidget {
public:
    ViewCell(Panel& panel, const std::string& name, const QString& title, QWidget* view)
        : head_(new QWidget), title_(new QLabel(title)), hide_(new QToolButton) {
        auto* column = new QVBoxLayout(this);
        column->setContentsMargins(0, 0, 0, 0);
        column->setSpacing(0);
        auto* row = new QHBoxLayout(head_);
        row->setContentsMargins(4, 0, 0, 0);
        row->addWidget(title_, 1);
        row->addWidget(hide_);
        title_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
        hide_->setText("×");
        hide_->setAutoRaise(true);
        hide_->setFocusPolicy(Qt::TabFocus);
        hide_->setAccessibleName("Hide " + title);
        hide_->setToolTip("Hides this view; View > Views in this workspace shows it again");
        connect(hide_, &QToolButton::clicked, &panel, [&panel, name] { panel.choose_view(name, false); });
        column->addWidget(head_);
        column->addWidget(view, 1);
    }
    void set_title(const QString& title) {
        title_->setText(title);
        title_->setToolTip(title);  // it may be longer than its place
    }
    /// Beside the title.
    void add_tool(QToolButton* tool) {
        tool->setAutoRaise(true);
        tool->setFocusPolicy(Qt::TabFocus);
        static_cast<QBoxLayout*>(head_->layout())->insertWidget(head_->layout()->count() - 1, tool);
    }
    void show_head(bool shown) { head_->setVisible(shown); }
    /// Called after it has come to be seen.
    std::function<void()> on_show;

protected:
    void showEvent(QShowEvent* event) override {
        QWidget::showEvent(event);
        if (on_show) {
            QTimer::singleShot(0, this, on_show);
        }
    }

private:
    QWidget* head_;
    QLabel* title_;
    QToolButton* hide_;
};

class SideBySide : public QWidget {
public:
    /// `room`: px that both need; the titles are those of the tabs.
    SideBySide(ViewCell* left, const QString& left_title, ViewCell* right, const QString& right_title, int room)
        : left_(left), right_(right), tabs_(new QTabBar), room_(room) {
        auto* column = new QVBoxLayout(this);
        column->setContentsMargins(0, 0, 0, 0);
        column->setSpacing(0);
        tabs_->setDrawBase(false);
        tabs_->setExpanding(false);
        tabs_->setAccessibleName(left_title + " or " + right_title);
        tabs_->addTab(left_title);
        tabs_->addTab(right_title);
        column->addWidget(tabs_);
        auto* row = new QHBoxLayout;
        row->setSpacing(6);
        row->addWidget(left_, 1);
        row->addWidget(right_, 1);
        column->addLayout(row, 1);
        connect(tabs_, &QTabBar::currentChanged, this, [this] { place(); });
        place();
    }
    [[nodiscard]] QTabBar* tabs() const { return tabs_; }
    /// Of one of them under its tab: both beside each other make no window wider.
    [[nodiscard]] QSize minimumSizeHint() const override {
        const QSize one = left_->minimumSizeHint().expandedTo(right_->minimumSizeHint());
        return {one.width(), one.height() + tabs_->sizeHint().height()};
    }
    /// Which of them are to be seen at all.
    void want(bool left, bool right) {
        want_left_ = left;
        want_right_ = right;
        setVisible(left || right);
        place();
    }
    /// Without the tabs' signal.
    void show_right(bool right) {
        const QSignalBlocker quiet(tabs_);
        tabs_->setCurrentIndex(right ? 1 : 0);
        place();
    }

protected:
    void resizeEvent(QResizeEvent*) override { place(); }

private:
    void place() {
        const bool tabs = want_left_ && want_right_ && width() < room_;
        tabs_->setVisible(tabs);
        left_->show_head(!tabs);
        right_->show_head(!tabs);
        left_->setVisible(want_left_ && (!tabs || tabs_->currentIndex() == 0));
        right_->setVisible(want_right_ && (!tabs || tabs_->currentIndex() == 1));
    }
    ViewCell* left_;
    ViewCell* right_;
    QTabBar* tabs_;
    int room_;
    bool want_left_ = true, want_right_ = true;
};

}  // namespace underbody::studio
