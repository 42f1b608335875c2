// The real window with its 3D views on an X server without a screen (Xvfb).
#pragma once

#include <QTest>

#include "core/virtual_display.h"
#include "studio/desktop/scene_widget.h"
#include "tests/studio/desktop/heartbeat.h"
#include "tests/studio/desktop/window_fixture.h"

namespace underbody::studio {

inline bool has_xvfb() { return std::system("command -v Xvfb > /dev/null 2>&1") == 0; }

inline void use_own_display() {
    static const core::VirtualDisplay display(1400, 1000);
    ::setenv("DISPLAY", display.name().c_str(), 1);
    ::setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    ::setenv("QT_QPA_PLATFORM", "xcb", 1);
    ::setenv("QT_XCB_GL_INTEGRATION", "none", 1);  // as underbody-studio
}

/// Before any window is made.
inline const bool on_own_display = (choose_platform = use_own_display, true);

class OnScreen : public Window {
protected:
    void SetUp() override {
        ASSERT_TRUE(on_own_display);
        ASSERT_TRUE(QTest::qWaitForWindowExposed(window_.get(), 20000));
        QApplication::setActiveWindow(window_.get());  // nobody manages windows here
        settle(*window_);
    }
    /// The 3D view of a cell that is seen.
    SceneWidget* view(int cell = 0) {
        QList<SceneWidget*> seen;
        for (auto* one : window_->findChildren<SceneWidget*>()) {
            if (one->isVisible()) {
                seen.append(one);
            }
        }
        return cell < seen.size() ? seen[cell] : nullptr;
    }
    QImage picture(int cell = 0) { return view(cell)->picture().convertToFormat(QImage::Format_RGB32); }
};

/// Share of the pixels that differ by more than `step` of 255 in a colour.
inline double difference(const QImage& a, const QImage& b, int step = 8) {
    if (a.size() != b.size()) {
        return 1;
    }
    int count = 0;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
            const QRgb p = a.pixel(x, y), q = b.pixel(x, y);
            count += std::abs(qRed(p) - qRed(q)) > step || std::abs(qGreen(p) - qGreen(q)) > step ||
                             std::abs(qBlue(p) - qBlue(q)) > step
                         ? 1
                         : 0;
        }
    }
    return static_cast<double>(count) / (static_cast<double>(a.width()) * a.height());
}

}  // namespace underbody::studio
