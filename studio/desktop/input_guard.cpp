#include "studio/desktop/input_guard.h"

#include <QAbstractItemView>
#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QDropEvent>
#include <QEvent>
#include <QKeyEvent>
#include <QLineEdit>
#include <QMainWindow>
#include <QMimeData>
#include <QPlainTextEdit>
#include <QScrollBar>
#include <QTextEdit>
#include <algorithm>
#include <utility>

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

/// Several cells as a spreadsheet takes them, with the titles of their columns; one cell is copied by the view itself.
bool copy_cells(const QAbstractItemView& view) {
    QModelIndexList chosen =
        view.selectionModel() != nullptr ? view.selectionModel()->selectedIndexes() : QModelIndexList();
    if (chosen.size() < 2) {
        return false;
    }
    std::stable_sort(chosen.begin(), chosen.end(), [](const QModelIndex& a, const QModelIndex& b) {
        return a.parent() == b.parent() && std::pair(a.row(), a.column()) < std::pair(b.row(), b.column());
    });
    QStringList rows, cells, titles;
    for (int i = 0; i < chosen.size(); ++i) {
        const QModelIndex& one = chosen[i];
        cells << one.data().toString().replace('\n', ' ');
        if (rows.isEmpty()) {
            titles << view.model()->headerData(one.column(), Qt::Horizontal).toString().replace('\n', ' ');
        }
        if (i + 1 == chosen.size() || chosen[i + 1].row() != one.row() || chosen[i + 1].parent() != one.parent()) {
            rows << cells.join('\t');
            cells.clear();
        }
    }
    rows.prepend(titles.join('\t'));
    QApplication::clipboard()->setText(rows.join('\n') + '\n');
    return true;
}

/// Files on their way to anything but the window: a field would take their names for words.
bool is_file_on(const QObject* watched, const QEvent* event) {
    if (event->type() != QEvent::DragEnter && event->type() != QEvent::DragMove && event->type() != QEvent::Drop) {
        return false;
    }
    const auto* widget = qobject_cast<const QWidget*>(watched);
    return widget != nullptr && !widget->isWindow() && qobject_cast<const QMainWindow*>(widget->window()) != nullptr &&
           static_cast<const QDropEvent*>(event)->mimeData()->hasUrls();
}

/// A field in which nothing was typed has nothing of its own to undo: the key is the window's.
bool is_undo_of_window(const QObject* watched, QEvent* event) {
    const auto* field = qobject_cast<const QLineEdit*>(watched);
    if (event->type() != QEvent::ShortcutOverride || field == nullptr || field->isModified()) {
        return false;
    }
    const auto* key = static_cast<const QKeyEvent*>(event);
    return key->matches(QKeySequence::Undo) || key->matches(QKeySequence::Redo);
}

}  // namespace

InputGuard::InputGuard(QObject* parent) : QObject(parent) { qApp->installEventFilter(this); }

bool InputGuard::eventFilter(QObject* watched, QEvent* event) {
    if (is_undo_of_window(watched, event)) {
        event->ignore();
        return true;
    }
    if (event->type() == QEvent::KeyPress) {
        const auto* view = qobject_cast<QAbstractItemView*>(watched);
        return view != nullptr && static_cast<QKeyEvent*>(event)->matches(QKeySequence::Copy) && copy_cells(*view);
    }
    if (is_file_on(watched, event)) {
        event->ignore();  // what holds it is asked next, and at last the window
        return true;
    }
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
