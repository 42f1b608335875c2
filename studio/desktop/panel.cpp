#include "studio/desktop/panel.h"

#include <QShowEvent>

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
