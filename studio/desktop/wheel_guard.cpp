#include "studio/desktop/wheel_guard.h"

#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QComboBox>
#include <QEvent>
#include <QScrollBar>

namespace underbody::studio {

WheelGuard::WheelGuard(QObject* parent) : QObject(parent) { qApp->installEventFilter(this); }

bool WheelGuard::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() != QEvent::Wheel && event->type() != QEvent::Polish) {
        return false;
    }
    const bool value =
        qobject_cast<QComboBox*>(watched) != nullptr || qobject_cast<QAbstractSpinBox*>(watched) != nullptr ||
        (qobject_cast<QAbstractSlider*>(watched) != nullptr && qobject_cast<QScrollBar*>(watched) == nullptr);
    auto* input = value ? static_cast<QWidget*>(watched) : nullptr;
    if (input == nullptr) {
        return false;
    }
    if (event->type() == QEvent::Polish) {
        if (input->focusPolicy() == Qt::WheelFocus) {  // it would take the keyboard first, and then the value
            input->setFocusPolicy(Qt::StrongFocus);
        }
        return false;
    }
    if (input->hasFocus()) {
        return false;
    }
    event->ignore();  // what holds it rolls instead
    return true;
}

}  // namespace underbody::studio
