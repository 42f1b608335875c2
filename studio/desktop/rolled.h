// What is rolled in a window that is too small for it, and otherwise as large as its place.
#pragma once

#include <QEvent>
#include <QScrollArea>

namespace underbody::studio {

/// Holds one widget at its own size. Sentences that wrap make a layout ask for its best height as if it were its
/// least; this asks for the least alone.
class Held : public QWidget {
public:
    explicit Held(QWidget* all) : all_(all) { all->setParent(this); }
    [[nodiscard]] QSize sizeHint() const override { return all_->sizeHint(); }
    [[nodiscard]] QSize minimumSizeHint() const override { return all_->minimumSizeHint(); }

protected:
    void resizeEvent(QResizeEvent*) override { all_->resize(size()); }
    bool event(QEvent* event) override {
        if (event->type() == QEvent::LayoutRequest) {
            updateGeometry();  // what it asks for is another
        }
        return QWidget::event(event);
    }

private:
    QWidget* all_;
};

class Rolled : public QScrollArea {
public:
    explicit Rolled(QWidget* all) {
        setWidget(new Held(all));
        setWidgetResizable(true);
        setFrameShape(QFrame::NoFrame);
        setFocusPolicy(Qt::NoFocus);
    }
    /// Small enough for the smallest window.
    [[nodiscard]] QSize minimumSizeHint() const override {
        return widget()->minimumSizeHint().boundedTo(QSize(520, 230));
    }
};

}  // namespace underbody::studio
