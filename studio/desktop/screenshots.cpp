#include "studio/desktop/screenshots.h"

#include <QApplication>
#include <QBuffer>
#include <QDialog>
#include <QElapsedTimer>
#include <QPixmap>
#include <QThread>
#include <cstdio>

#include "core/error.h"
#include "core/file.h"
#include "studio/desktop/catalogue.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/panel.h"

namespace underbody::studio {

namespace {

/// Lets the window work until nothing runs beside it and it has drawn itself.
void settle(MainWindow& window) {
    QElapsedTimer waited;
    waited.start();
    int quiet = 0;
    while (quiet < 6 && waited.elapsed() < 120000) {
        QApplication::processEvents(QEventLoop::AllEvents, 50);
        quiet = window.jobs().busy() ? 0 : quiet + 1;
        QThread::msleep(15);
    }
}

void save(QWidget& widget, const std::filesystem::path& file) {
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    widget.grab().save(&buffer, "PNG");
    core::write_file(file, bytes.toStdString());
    std::printf("%s\n", file.c_str());
}

}  // namespace

int take_screenshots(MainWindow& window, const std::filesystem::path& study, const std::filesystem::path& folder) {
    window.show();
    settle(window);
    save(window, folder / "empty.png");
    window.open_study(study);
    settle(window);
    if (!window.has_study()) {
        std::fprintf(stderr, "underbody-studio: %s\n", window.last_error().toLocal8Bit().constData());
        save(window, folder / "window.png");
        return 3;
    }
    for (auto* panel : window.panels()) {
        window.show_panel(panel);
        settle(window);
        const std::string name = panel->objectName().toStdString();
        save(window, folder / (name + ".png"));
        panel->demonstrate();
        settle(window);
        save(window, folder / (name + "-used.png"));
    }
    show_effect_catalogue(&window);
    settle(window);
    if (auto* catalogue = window.findChild<QDialog*>("catalogue")) {
        save(*catalogue, folder / "effects.png");
        catalogue->close();
    }
    window.show_panel(window.panels().front());
    settle(window);
    save(window, folder / "window.png");
    if (!window.last_error().isEmpty()) {
        std::fprintf(stderr, "underbody-studio: %s\n", window.last_error().toLocal8Bit().constData());
        return 1;
    }
    return 0;
}

}  // namespace underbody::studio
