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
#include "studio/desktop/drawing_context.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/panel.h"

namespace underbody::studio {

/// Lets the window work until nothing runs beside it and it has drawn itself.
void settle(MainWindow& window) {
    if (auto& context = DrawingContext::instance(); context.state() == DrawingContext::State::coming) {
        context.wait();
    }
    QElapsedTimer waited;
    waited.start();
    int quiet = 0;
    while (quiet < 14 && waited.elapsed() < 120000) {
        QApplication::processEvents(QEventLoop::AllEvents, 50);
        quiet = window.jobs().busy() ? 0 : quiet + 1;
        QThread::msleep(15);
    }
}

namespace {

void save(QWidget& widget, const std::filesystem::path& file) {
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    widget.grab().save(&buffer, "PNG");
    core::write_file(file, bytes.toStdString());
    std::printf("%s\n", file.c_str());
}

/// The comparison as it is exported.
void save_sheets(MainWindow& window, const std::filesystem::path& folder) {
    for (Panel* panel : window.panels()) {
        if (panel->isVisible() && panel->has_picture()) {
            for (const auto& ending : panel->picture_endings()) {
                const auto file = folder / ("sheet" + ending.toStdString());
                panel->export_picture(file);
                std::printf("%s\n", file.c_str());
            }
        }
    }
}

/// For each workspace, what shows what it is for.
Words use_of(const MainWindow& window, const std::string& workspace) {
    const auto& study = const_cast<MainWindow&>(window).desk().session().study;
    if (workspace == "design") {
        return {"operation", "gap=10mm"};
    }
    if (workspace == "explore") {
        return {"brush", "gap=0:6mm"};
    }
    if (workspace == "compare") {
        return {"fields", "camera=bottom"};
    }
    if (workspace == "tables" && !study.tables.empty()) {
        const double weight = study.tables.front().net_weight.value_or(0);
        return {"table", study.tables.front().name, "net_weight=" + std::to_string(0.8 * weight) + "N"};
    }
    if (workspace == "stability" && !study.regions.empty()) {
        return {"region", study.regions.front().name, "start=5mm,5mm/s"};
    }
    return {};
}

}  // namespace

int take_screenshots(MainWindow& window, const std::filesystem::path& study, const std::filesystem::path& log,
                     const std::filesystem::path& folder) {
    window.show();
    settle(window);
    save(window, folder / "empty.png");
    if (!log.empty()) {
        window.desk().replay_log(log, study);
    } else if (std::filesystem::is_regular_file(study)) {
        window.take_files({study});
    } else {
        window.open_study(study);
    }
    settle(window);
    if (!window.last_error().isEmpty()) {
        std::fprintf(stderr, "underbody-studio: %s\n", window.last_error().toLocal8Bit().constData());
        save(window, folder / "window.png");
        return 3;
    }
    save(window, folder / "window.png");
    for (const auto& name : workspace_names()) {
        window.desk().act({"workspace", name});
        settle(window);
        save(window, folder / (name + ".png"));
        if (const Words use = use_of(window, name); !use.empty()) {
            window.desk().act(use);
            settle(window);
        }
        save(window, folder / (name + "-used.png"));
        if (name == "compare") {
            save_sheets(window, folder);
        }
    }
    show_effect_catalogue(&window);
    settle(window);
    if (auto* catalogue = window.findChild<QDialog*>("catalogue")) {
        save(*catalogue, folder / "effects.png");
        catalogue->close();
    }
    if (!window.last_error().isEmpty()) {
        std::fprintf(stderr, "underbody-studio: %s\n", window.last_error().toLocal8Bit().constData());
        return 1;
    }
    return 0;
}

}  // namespace underbody::studio
