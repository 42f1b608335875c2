#include "studio/desktop/panel.h"

#include <QShowEvent>

#include "studio/desktop/qt_text.h"

namespace underbody::studio {

Panel::Panel(Desk& desk, QWidget* parent) : QWidget(parent), desk_(desk), jobs_(desk.jobs()) {
    connect(&desk, &Desk::changed, this, [this] { out_of_date(false); });
    connect(&desk, &Desk::session_changed, this, [this] { out_of_date(true); });
}

void Panel::out_of_date(bool session) {
    old_state_ = true;
    old_session_ = old_session_ || session;
    if (isVisible()) {
        const bool fresh = old_session_;
        old_state_ = old_session_ = false;
        draw_again(fresh);
    }
}

/// Another theme: colours that are not the style's own are drawn anew.
void Panel::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange) {
        out_of_date(false);
    }
}

std::vector<Panel::View> Panel::views() const {
    std::vector<View> all;
    for (const auto& view : workspace_views(objectName().toStdString())) {
        all.push_back({view.name, qt(view.title), shows(view.name)});
    }
    return all;
}

void Panel::choose_view(const std::string& name, bool shown) {
    const std::string workspace = objectName().toStdString();
    Words words = {"cells", workspace};
    for (const auto& view : workspace_views(workspace)) {
        if (view.name == name ? shown : shows(view.name)) {
            words.push_back(view.name);
        }
    }
    if (words.size() > 2) {  // without any name all would be shown
        desk_.act(words);
    }
}

QImage Panel::picture_to_copy() const { return const_cast<Panel*>(this)->grab().toImage(); }

void Panel::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    if (old_state_ || old_session_) {
        const bool fresh = old_session_;
        old_state_ = old_session_ = false;
        draw_again(fresh);
    }
}

}  // namespace underbody::studio
