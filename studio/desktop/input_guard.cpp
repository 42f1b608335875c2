#include "studio/desktop/input_guard.h"

#include <QAbstractItemView>
#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QComboBox>
#include <QEvent>
#include <QPlainTextEdit>
#include <QScrollBar>
#include <QTextEdit>

namespace underbody::studio {

namespace {

void let_tab_leave(QObject* watched) {
    if (auto* rows = qobject_cast<QAbstractItemView*>(watched)) {
        rows->setTabKeyNavigation(false);
    } else if (auto* text = qobject_cast<QTextEdit*>(watched)) {
        text->setTabChangesFocus(true);
    } else if (auto* plain = qobject_cast<QPlainTextEdit*>(watched)) {
        plain->setTabChangesFocus(true);
    }
}

}  // namespace

InputGuard::InputGuard(QObject* parent) : QObject(parent) { qApp->installEventFilter(this); }

bool InputGuard::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() != QEvent::Wheel && event->type() != QEvent::Polish) {
        return false;
    }
    if (event->type() == QEvent::Polish) {
        let_tab_leave(watched);
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
