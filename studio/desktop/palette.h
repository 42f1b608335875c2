// Ctrl+K: everything that can be done, found by typing; F1: the keys.
#pragma once

#include <QAction>
#include <QDialog>
#include <QList>

#include "studio/desktop/desk.h"

namespace underbody::studio {

/// A dialog with a line: menu actions, things of the study (chosen when taken) and typed action lines.
void show_palette(QWidget* parent, Desk& desk, const QList<QAction*>& actions);

/// All keys of the window, out of its actions.
void show_keys(QWidget* parent, const QList<QAction*>& actions);

}  // namespace underbody::studio
