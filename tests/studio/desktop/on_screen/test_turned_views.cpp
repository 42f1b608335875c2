// Views that a hand turned, and what is drawn around a body.
#include <QWheelEvent>
#include <fstream>

#include "core/figure.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/fitted_picture.h"
#include "studio/desktop/scene.h"
#include "tests/studio/desktop/on_screen/screen_fixture.h"

namespace underbody::studio {
namespace {

class Turned : public OnScreen {
protected:
    void drag(const QPoint& by) {
        const QPoint middle = view()->rect().center();
        QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
        QTest::mouseMove(view(), middle + by);
        QTest::qWait(30);
        QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle + by);
        QTest::qWait(300);  // a hand rests
        settle(*window_);
    }
    QImage seen() {
        settle(*window_);
        QTest::qWait(50);
        return picture();
    }
};

// It was lost with the window, and by nothing to be had back.
TEST_F(Turned, ComparesViewIsKept) {
    open(computed_study());
    act("workspace compare");
    act("select case/ellipse-h5-p0");
    const QImage before = seen();
    QTest::mouseClick(view(), Qt::LeftButton, Qt::NoModifier, view()->rect().center());
    QTest::qWait(300);
    EXPECT_FALSE(window_->desk().state().fields.turned) << "a click turns nothing";
    act("fields probe=");
    drag({60, 25});
    ASSERT_TRUE(window_->desk().state().fields.turned);
    const QImage turned = seen();
    EXPECT_GT(difference(before, turned), 0.02);
    const auto pose = window_->desk().state().fields.turned;
    drag({-20, 10});
    EXPECT_NE(window_->desk().state().fields.turned, pose);
    window_->desk().undo();
    EXPECT_LT(difference(before, seen()), 0.002) << "both turns are one step";
    act("turn compare " + text_of(*pose));
    EXPECT_LT(difference(turned, seen(), 40), 0.002);
    act("workspace tables");
    settle(*window_);
    act("workspace compare");
    EXPECT_LT(difference(turned, seen(), 40), 0.002) << "after another workspace";
    const fs::path file = folder_.path() / "kept.ubs";
    window_->desk().save_session_file(file);
    act("fields camera=bottom");
    EXPECT_FALSE(window_->desk().state().fields.turned);
    EXPECT_GT(difference(turned, seen()), 0.02);
    window_->desk().open_session_file(file);
    EXPECT_LT(difference(turned, seen(), 40), 0.002) << "after the session was opened again";
    EXPECT_EQ(window_->desk().state().fields.turned, pose);
}

// They were seen from the camera that was named last, beside a body that a hand had turned.
TEST_F(Turned, DifferencesFollowTheHand) {
    open(computed_study());
    act("workspace compare");
    act("select case/ellipse-h5-p0 case/ellipse-h2-p0");
    act("fields camera=bottom difference=on");
    settle(*window_);
    const auto difference_seen = [&]() -> const FittedPicture* {
        for (const auto* widget : panel<FieldsPanel>().findChildren<QWidget*>()) {
            const auto* one = dynamic_cast<const FittedPicture*>(widget);
            if (one != nullptr && one->isVisible()) {
                return one;
            }
        }
        return nullptr;
    };
    ASSERT_NE(difference_seen(), nullptr);
    EXPECT_TRUE(difference_seen()->toolTip().contains("seen from below")) << difference_seen()->toolTip().toStdString();
    EXPECT_NEAR(difference_seen()->width(), view()->width(), 4) << "it had no room beside a surface";
    const QImage before = difference_seen()->image;
    drag({60, 25});
    ASSERT_TRUE(window_->desk().state().fields.turned);
    settle(*window_);
    EXPECT_TRUE(difference_seen()->toolTip().contains("turned by hand")) << difference_seen()->toolTip().toStdString();
    EXPECT_GT(difference(before.convertToFormat(QImage::Format_RGB32),
                         difference_seen()->image.convertToFormat(QImage::Format_RGB32)),
              0.02);
    window_->desk().undo();
    settle(*window_);
    EXPECT_TRUE(difference_seen()->toolTip().contains("seen from below")) << difference_seen()->toolTip().toStdString();
}

TEST_F(Turned, ASteppedWheelIsOneStepOfTheHistory) {
    open(computed_study());
    act("workspace compare");
    act("select case/ellipse-h5-p0");
    const QImage before = seen();
    const auto steps = window_->desk().history().position();
    for (int i = 0; i < 3; ++i) {
        const QPointF at = view()->rect().center();
        QWheelEvent wheel(at, view()->mapToGlobal(at.toPoint()), {}, {0, 120}, Qt::NoButton, Qt::NoModifier,
                          Qt::NoScrollPhase, false);
        QApplication::sendEvent(view(), &wheel);
    }
    QTest::qWait(300);
    EXPECT_GT(difference(before, seen()), 0.02);
    EXPECT_TRUE(window_->desk().state().fields.turned);
    EXPECT_EQ(window_->desk().history().position(), steps + 1);
}

// The press fell into the time in which a hand is waited for, and the turn before it was forgotten.
TEST_F(Turned, AClickSoonAfterATurnLosesNothing) {
    open(computed_study());
    const QPoint middle = view()->rect().center();
    QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
    QTest::mouseMove(view(), middle + QPoint(50, 20));
    QTest::qWait(30);
    QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle + QPoint(50, 20));
    QTest::qWait(20);
    QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
    QTest::qWait(250);
    EXPECT_FALSE(window_->desk().state().design.turned) << "still in a hand";
    QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle);
    QTest::qWait(300);
    EXPECT_TRUE(window_->desk().state().design.turned);
}

// A press alone counted as a turn, after which the body was no longer fitted to its place.
TEST_F(Turned, AClickIsNoTurn) {
    open(computed_study());
    QTest::mouseClick(view(), Qt::LeftButton, Qt::NoModifier, view()->rect().center());
    QTest::qWait(300);
    ASSERT_FALSE(window_->desk().state().design.turned);
    window_->resize(window_->width() - 200, window_->height() - 100);
    const QImage resized = seen();
    act("turn design " + text_of(Scene::Pose{1, 1, 1, 0, 0, 0, 0, 0, 1, 0.1}));
    act("turn design");
    EXPECT_LT(difference(resized, seen(), 40), 0.01) << "fitted, as by the command";
}

TEST_F(Turned, DesignsViewIsKept) {
    open(computed_study());
    const QImage before = seen();
    drag({50, -30});
    ASSERT_TRUE(window_->desk().state().design.turned);
    const QImage turned = seen();
    EXPECT_GT(difference(before, turned), 0.02);
    const fs::path file = folder_.path() / "kept.ubs";
    window_->desk().save_session_file(file);
    act("turn design");
    EXPECT_LT(difference(before, seen(), 40), 0.01) << "fitted again";
    window_->desk().open_session_file(file);
    EXPECT_LT(difference(turned, seen(), 40), 0.01);
    window_->resize(window_->width() - 40, window_->height());
    settle(*window_);
    EXPECT_TRUE(window_->desk().state().design.turned) << "another size of the window turns nothing";
}

/// Pixels of the colour that the body before has.
int outlined(const QImage& seen) {
    const auto colour = core::palette(1);
    int count = 0;
    for (int y = 0; y < seen.height(); ++y) {
        for (int x = 0; x < seen.width(); ++x) {
            const QRgb p = seen.pixel(x, y);
            count +=
                std::abs(qRed(p) - colour.red) + std::abs(qGreen(p) - colour.green) + std::abs(qBlue(p) - colour.blue) <
                        60
                    ? 1
                    : 0;
        }
    }
    return count;
}

TEST_F(Turned, TheBodyBeforeIsALineAroundTheOneOfNow) {
    open(computed_study());
    EXPECT_EQ(outlined(seen()), 0) << "nothing is changed";
    act("set 'body.length=260 mm'");
    const int line = outlined(seen());
    EXPECT_GT(line, 150);
    drag({30, 0});
    EXPECT_GT(outlined(seen()), 100) << "turned, too";
    act("outline off");
    EXPECT_EQ(outlined(seen()), 0);
    act("outline on");
    EXPECT_GT(outlined(seen()), 100);
    act("reset");
    EXPECT_EQ(outlined(seen()), 0);
}

// A cube fills the ball around it: its upper corners were cut off.
TEST_F(Turned, AllOfAnyBodyIsSeen) {
    const fs::path file = folder_.path() / "cube.stl";
    std::ofstream text(file);
    text << "solid cube\n";
    const auto corner = [&](unsigned at) {
        text << "vertex " << (at & 1U) << " " << (at >> 1U & 1U) << " " << (at >> 2U) << "\n";
    };
    for (const auto& face : std::vector<std::array<unsigned, 4>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
        for (const auto& [b, c] : {std::pair{1, 2}, {2, 3}}) {
            text << "facet normal 0 0 0\nouter loop\n";
            corner(face[0]);
            corner(face[static_cast<std::size_t>(b)]);
            corner(face[static_cast<std::size_t>(c)]);
            text << "endloop\nendfacet\n";
        }
    }
    text << "endsolid cube\n";
    text.close();
    window_->take_files({file});
    for (const char* camera : {"iso", "bottom", "side", "front"}) {
        act(std::string("fields camera=") + camera);
        const QImage whole = seen();
        const QRgb top = whole.pixel(2, 0), bottom = whole.pixel(2, whole.height() - 1);
        int cut = 0;
        for (int x = 0; x < whole.width(); ++x) {
            cut += whole.pixel(x, 0) != top || whole.pixel(x, whole.height() - 1) != bottom ? 1 : 0;
        }
        EXPECT_EQ(cut, 0) << camera;
    }
}

}  // namespace
}  // namespace underbody::studio
