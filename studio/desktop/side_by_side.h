// Two views beside each other where there is room for both, else the one whose tab is chosen.
#pragma once

#include <QBoxLayout>
#include <QSignalBlocker>
#include <QTabBar>
#include <QWidget>

namespace underbody::studio {

class SideBySide : public QWidget {
public:
    /// `room`: px that both need; the titles are those of the tabs.
    SideBySide(QWidget* left, const QString& left_title, QWidget* right, const QString& right_title, int room)
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
        const bool both = width() >= room_;
        tabs_->setVisible(!both);
        left_->setVisible(both || tabs_->currentIndex() == 0);
        right_->setVisible(both || tabs_->currentIndex() == 1);
    }
    QWidget* left_;
    QWidget* right_;
    QTabBar* tabs_;
    int room_;
};

}  // namespace underbody::studio
