// A surface of very many faces: opened without a stop, turned as fewer, drawn whole at rest.
#include <fstream>

#include "studio/desktop/fields_panel.h"
#include "tests/studio/desktop/on_screen/screen_fixture.h"
#include "tests/support/many_faces.h"

namespace underbody::studio {
namespace {

/// What is not the ground of the view, left of the bar of colours.
QImage silhouette(const QImage& seen) {
    QImage mask(seen.width() * 3 / 4, seen.height(), QImage::Format_Grayscale8);
    for (int y = 0; y < mask.height(); ++y) {
        const QRgb ground = seen.pixel(2, y / 2 * 2);
        for (int x = 0; x < mask.width(); ++x) {
            const QRgb p = seen.pixel(x, y);
            const int far = std::abs(qRed(p) - qRed(ground)) + std::abs(qGreen(p) - qGreen(ground)) +
                            std::abs(qBlue(p) - qBlue(ground));
            mask.scanLine(y)[x] = far > 24 ? 255 : 0;
        }
    }
    return mask;
}

/// True where every pixel of one silhouette has one of the other within `radius`.
bool within(const QImage& inner, const QImage& outer, int radius) {
    for (int y = radius; y < inner.height() - radius; ++y) {
        for (int x = radius; x < inner.width() - radius; ++x) {
            bool near = inner.constScanLine(y)[x] == 0;
            for (int v = -radius; !near && v <= radius; ++v) {
                for (int u = -radius; !near && u <= radius; ++u) {
                    near = outer.constScanLine(y + v)[x + u] != 0;
                }
            }
            if (!near) {
                return false;
            }
        }
    }
    return true;
}

/// MB.
double resident() {
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("VmRSS:")) {
            return std::stod(line.substr(6)) / 1024;
        }
    }
    return 0;
}

TEST_F(OnScreen, VeryManyFacesAreTurnedAsFewerAndDrawnWholeAtRest) {
    const fs::path file = folder_.path() / "many.stl";
    test::write_stl(file, 1000000);
    Heartbeat heartbeat;
    window_->take_files({file});
    auto& fields = panel<FieldsPanel>();
    QTRY_VERIFY_WITH_TIMEOUT(fields.drawn() == 1 || !window_->last_error().isEmpty(), 60000);
    ASSERT_EQ(fields.drawn(), 1U) << window_->last_error().toStdString();
    ASSERT_NE(view(), nullptr);
    QTest::qWait(50);  // the view is fitted in the next turns of the loop, later beside other work
    EXPECT_TRUE(fields.stands_in(0)) << "before the whole is drawn";
    const QImage fewer = picture();
    QTRY_VERIFY_WITH_TIMEOUT(!fields.stands_in(0), 60000);
    const QImage whole = picture();
    EXPECT_GT(difference(fewer, whole, 2), 0) << "another picture";
    EXPECT_LT(difference(fewer, whole, 60), 0.02) << "of the same";
    EXPECT_TRUE(within(silhouette(fewer), silhouette(whole), 2));
    EXPECT_TRUE(within(silhouette(whole), silhouette(fewer), 2));

    // Turned: the stand-in at once, and the whole again when the hand rests.
    const QPoint middle = view()->rect().center();
    QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
    QTest::mouseMove(view(), middle + QPoint(40, 20));
    QTest::qWait(20);
    EXPECT_TRUE(fields.stands_in(0));
    QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle + QPoint(40, 20));
    QTRY_VERIFY_WITH_TIMEOUT(!fields.stands_in(0), 60000);
    EXPECT_GT(difference(whole, picture()), 0.02);

    // What is drawn of them is kept, and made once: each turn took a tenth of the whole memory more.
    const double memory = resident();
    for (int i = 0; i < 4; ++i) {
        QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
        QTest::mouseMove(view(), middle + QPoint(10 + i, 20));
        QTest::qWait(20);
        QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle + QPoint(10 + i, 20));
        QTRY_VERIFY_WITH_TIMEOUT(!fields.stands_in(0), 60000);
    }
#ifndef __SANITIZE_ADDRESS__  // which keeps what is freed
    EXPECT_LT(resident() - memory, 30) << "MB";
#endif

    // A click finds its place, whatever is drawn.
    QTest::mouseClick(view(), Qt::LeftButton, Qt::NoModifier, middle);
    QTest::qWait(60);
    ASSERT_TRUE(window_->desk().state().fields.probe);
    settle(*window_);
    // The window's thread draws the stand-in alone (with a software renderer in a test that is hardly optimised).
    EXPECT_LT(heartbeat.longest(), 0.5);
    std::printf("longest gap of the window's thread: %.0f ms of processor time\n", 1000 * heartbeat.longest());
}

}  // namespace
}  // namespace underbody::studio
