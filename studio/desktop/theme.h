// Light and dark: one palette for widgets, plots and 3D; what is exported stays on white.
#pragma once

#include <QString>
#include <QStringList>

class QStyle;

namespace underbody::studio {

/// "system" (the desktop's own), "light", "dark".
const QStringList& theme_names();
/// Sets the palette of the whole program; another name than those above counts as "system".
void set_theme(const QString& name);
/// How the widgets are drawn; the application takes it over.
QStyle* window_style();

}  // namespace underbody::studio
