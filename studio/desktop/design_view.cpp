// Design: the 3D view, as a hand turned it, with the body before as a line around the one of now.
#include <QToolButton>

#include "studio/desktop/design_panel.h"
#include "studio/desktop/side_by_side.h"
#include "studio/desktop/state/action_parts.h"

namespace underbody::studio {

void DesignPanel::build_view_tools() {
    outline_ = new QToolButton;
    outline_->setText("Before");
    outline_->setAccessibleName("Outline of the body before");
    outline_->setToolTip("The body before as a line around the one of now (Ctrl+D makes this one the body before)");
    outline_->setCheckable(true);
    fit_ = new QToolButton;
    fit_->setText("Fit");
    fit_->setAccessibleName("Fit the body");
    fit_->setToolTip("As it was before it was turned by hand: obliquely from below, all of it");
    for (auto* tool : {outline_, fit_}) {
        body_cell_->add_tool(tool);
    }
    connect(outline_, &QToolButton::clicked, this, [this](bool on) { desk_.act({"outline", on ? "on" : "off"}); });
    connect(fit_, &QToolButton::clicked, this, [this] { desk_.act({"turn", "design"}); });
}

void DesignPanel::keep_turns() {
    scene_->on_turned = [this](const Scene::Pose& pose) {
        seen_from_ = action::pose_from(text_of(pose));
        desk_.act({"turn", "design", text_of(pose)});
    };
}

void DesignPanel::show_view(bool other_body) {
    const DesignView& design = state().design;
    outline_->setChecked(design.outline);
    fit_->setEnabled(design.turned.has_value());
    if (!scene_ || !shown_) {
        return;
    }
    bool other = scene_->outline(design.outline && before_ ? before_->drawn : nullptr) || other_body;
    if (design.turned != seen_from_) {
        seen_from_ = design.turned;
        other = true;
        fit_view();  // its projection, too
        if (design.turned) {
            scene_->set_pose(*design.turned);
        }
    }
    if (other) {
        scene_->render();
    }
}

}  // namespace underbody::studio
