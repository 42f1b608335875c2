// The message over the workspaces: it moves nothing and takes no click that was meant for what it covers.
#include <gtest/gtest.h>

#include <QLabel>
#include <QTest>

#include "studio/desktop/explore_panel.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {
namespace {

TEST_F(Window, AnErrorMovesNothing) {
    open(computed_study());
    for (const auto& workspace : workspace_names()) {
        SCOPED_TRACE(workspace);
        act("workspace " + workspace);
        settle(*window_);
        std::vector<std::pair<QWidget*, QRect>> before;
        for (auto* panel : window_->panels()) {
            for (auto* widget : panel->isVisible() ? panel->findChildren<QWidget*>() : QList<QWidget*>()) {
                if (widget->isVisible()) {
                    before.emplace_back(widget, QRect(widget->mapTo(window_.get(), QPoint()), widget->size()));
                }
            }
        }
        ASSERT_GE(before.size(), 5U);
        EXPECT_FALSE(act("brush nonsense=1"));
        auto* banner = window_->findChild<Banner*>();
        ASSERT_TRUE(banner->isVisible());
        QTest::qWait(20);
        for (const auto& [widget, place] : before) {
            EXPECT_EQ(QRect(widget->mapTo(window_.get(), QPoint()), widget->size()), place)
                << widget->metaObject()->className();
        }
        EXPECT_TRUE(banner->findChild<QLabel*>("said")->text().contains("nonsense"));
        EXPECT_TRUE(banner->parentWidget()->rect().contains(banner->geometry()));
        banner->hide();
    }
}

// A click that is on its way when it appears goes where it was aimed.
TEST_F(Window, AClickInFlightFallsThroughTheMessage) {
    open(computed_study());
    act("workspace explore");
    settle(*window_);
    auto* banner = window_->findChild<Banner*>();
    EXPECT_FALSE(act("brush nonsense=1"));
    ASSERT_TRUE(banner->isVisible());
    const QPoint place = banner->mapTo(window_.get(), banner->rect().center());
    const auto on_banner = [&] {
        const QWidget* hit = window_->childAt(place);
        return hit == banner || banner->isAncestorOf(hit);
    };
    EXPECT_FALSE(on_banner()) << "what is below it gets the click";
    QTest::qWait(700);
    EXPECT_TRUE(on_banner()) << "it can be read, copied and closed";
    window_->resize(1000, 700);
    QTest::qWait(20);
    EXPECT_TRUE(banner->parentWidget()->rect().contains(banner->geometry())) << "it stays in the window";
    EXPECT_TRUE(act("brush gap=2mm:5mm"));
    EXPECT_FALSE(banner->isVisible()) << "until something succeeds";
}

}  // namespace
}  // namespace underbody::studio
