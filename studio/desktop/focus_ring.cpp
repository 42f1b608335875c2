#include "studio/desktop/focus_ring.h"

#include <QAbstractScrollArea>
#include <QApplication>
#include <QEvent>
#include <QPainter>

namespace underbody::studio {

namespace {

/// Lies over a widget, as large as it is, and leaves the mouse to it.
class Ring : public QWidget {
public:
    explicit Ring(QWidget* around) : QWidget(around) {
        setObjectName("focus ring");
        setAttribute(Qt::WA_TransparentForMouseEvents);
        setFocusPolicy(Qt::NoFocus);
        setGeometry(around->rect());
        raise();
        show();
    }

protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        painter.setPen(QPen(palette().highlight().color(), 2));
        painter.drawRect(rect().adjusted(1, 1, -1, -1));
    }
};

/// Lists and tables have the mouse in a widget of their own.
QWidget* pressed_in(QWidget* widget) {
    auto* area = qobject_cast<QAbstractScrollArea*>(widget);
    return area != nullptr ? area->viewport() : widget;
}

}  // namespace

FocusRing::FocusRing(QObject* parent) : QObject(parent) {
    connect(qApp, &QApplication::focusChanged, this, [this](QWidget*, QWidget* now) { follow(now); });
}

QWidget* FocusRing::around() const { return ring_ ? ring_->parentWidget() : nullptr; }

void FocusRing::follow(QWidget* widget) {
    if (QWidget* before = around()) {
        before->removeEventFilter(this);
        pressed_in(before)->removeEventFilter(this);
    }
    delete ring_;
    if (widget != nullptr && widget->window()->testAttribute(Qt::WA_KeyboardFocusChange)) {
        ring_ = new Ring(widget);
        widget->installEventFilter(this);
        pressed_in(widget)->installEventFilter(this);
    }
}

bool FocusRing::eventFilter(QObject* watched, QEvent* event) {
    if (ring_ && event->type() == QEvent::MouseButtonPress) {
        ring_->hide();  // the mouse is used
    } else if (ring_ && watched == ring_->parentWidget() && event->type() == QEvent::Resize) {
        ring_->resize(ring_->parentWidget()->size());
    }
    return QObject::eventFilter(watched, event);
}

}  // namespace underbody::studio
