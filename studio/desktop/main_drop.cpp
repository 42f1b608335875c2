// What is dropped on the window, or named on its command line: content decides what becomes of it.
#include <algorithm>
#include <filesystem>

#include "cases/add_measurement.h"
#include "cases/study.h"
#include "core/error.h"
#include "geometry/body/body_shape.h"
#include "postproc/importers/importer.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/measurement_sheet.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/state/known_things.h"
#include "studio/desktop/table_sheet.h"
#include "studio/desktop/take_in_sheet.h"

namespace underbody::studio {

namespace fs = std::filesystem;

void MainWindow::take_files(const std::vector<fs::path>& files) {
    constexpr std::size_t most_compared = 6;
    std::vector<fs::path> folders, measured, fields;
    for (const fs::path& path : files) {
        guarded("opening " + qt(path.string()), [&] {
            const bool folder = fs::is_directory(path);
            if (path.filename() == "study.toml" || !fs::exists(path) || fs::exists(path / "study.toml")) {
                open_study(path);
            } else if (cases::holds_measurements(path) && postproc::importer_for(path) == nullptr) {
                measured.push_back(path);
            } else if (folder && postproc::importer_for(path) == nullptr) {
                folders.push_back(path);
            } else if (path.extension() == ".ubs") {
                desk_->open_session_file(path);
            } else if (path.extension() == ".toml") {
                static_cast<void>(geometry::read_shape(path));  // says what is wrong with it
                desk_->act({"add", "shape", path.string()});
                desk_->act({"shape", path.stem().string()});
                desk_->act({"workspace", "design"});
            } else {
                fields.push_back(path);
            }
        });
    }
    if (fields.size() > most_compared) {  // more than can stand beside each other: cases of a study
        folders.insert(folders.end(), fields.begin(), fields.end());
    } else {
        compare_files(fields, files.size() == 1);
    }
    if (!folders.empty()) {
        take_in(folders);
    }
    if (!measured.empty()) {
        guarded("taking measurements in", [&] { take_measurements(measured); });
    }
}

void MainWindow::compare_files(const std::vector<fs::path>& files, bool remembered) {
    Words words = {"select"};
    for (const fs::path& path : files) {
        guarded("opening " + qt(path.string()), [&] {
            if (desk_->act({"add", "field", path.string()})) {
                words.push_back("field/" + action::whole_path(path));
                if (remembered) {
                    remember_study(qt(action::whole_path(path)));
                }
            }
        });
    }
    if (words.size() > 1) {
        desk_->act(words);
        desk_->act({"workspace", "compare"});
    }
}

MeasurementSheet* MainWindow::take_measurements(const std::vector<fs::path>& measured) {
    if (!desk_->has_study()) {
        throw core::InputError("missing", "measurements are judged by a model of a study, and none is open", {},
                               "open the study first (Ctrl+O), then drop them");
    }
    auto* sheet = new MeasurementSheet(*desk_, measured, this);
    connect(sheet, &MeasurementSheet::failed, this, &MainWindow::show_failure);
    sheet->show();
    return sheet;
}

TakeInSheet* MainWindow::take_in(const std::vector<fs::path>& files) {
    // Beside the files a new study begins, unless they lie in the one that is open.
    fs::path folder = fs::absolute(files.front()).lexically_normal();
    folder = fs::is_directory(folder) ? folder : folder.parent_path();
    if (const fs::path open = desk_->session().folder; !open.empty()) {
        const auto below = folder.lexically_relative(open);
        folder = !below.empty() && *below.begin() != ".." ? open : folder;
    }
    auto* sheet = new TakeInSheet(*jobs_, folder, files, this);
    connect(sheet, &TakeInSheet::failed, this, &MainWindow::show_failure);
    connect(sheet, &TakeInSheet::taken, this, [this, sheet](const QString& study, const QString& command, int cases) {
        problems_->note(QString("Took in %1 cases. The same: ").arg(cases) + command);
        forget_files_of(sheet->taken_in());
        desk_->open_and_run(study.toStdString(), {{"workspace", "compare"}});
    });
    sheet->show();
    return sheet;
}

TableSheet* MainWindow::make_table() {
    if (!desk_->has_study()) {
        throw core::InputError("missing", "there is no study whose cases could make a table", {},
                               "open one, or drop CFD files on the window");
    }
    auto* sheet = new TableSheet(desk_->session().study, this);
    connect(sheet, &TableSheet::failed, this, &MainWindow::show_failure);
    connect(sheet, &TableSheet::made, this, [this](const QString& table, const QString& command) {
        problems_->note("Made the table '" + table + "'. The same: " + command);
        desk_->open_and_run(desk_->session().folder,
                            {{"workspace", "tables"}, {"select", "table/" + table.toStdString()}});
    });
    sheet->show();
    return sheet;
}

/// Files that are cases now no longer stand beside the study as files from outside.
void MainWindow::forget_files_of(const cases::Study& study) {
    Words words = {"remove"};
    for (const auto& entry : desk_->state().files) {
        const std::string path = entry.substr(entry.find(':') + 1);
        if (entry.starts_with("field:") && std::any_of(study.cases.begin(), study.cases.end(), [&](const auto& one) {
                return fs::absolute(one.file).lexically_normal() == fs::path(path);
            })) {
            words.push_back(path);
        }
    }
    if (words.size() > 1) {
        desk_->act(words);
    }
}

void MainWindow::take_in_what_is_shown() {
    std::vector<fs::path> files;
    for (const auto& entry : desk_->state().files) {
        if (entry.starts_with("field:")) {
            files.emplace_back(entry.substr(6));
        }
    }
    guarded("taking files in", [&] {
        if (files.empty()) {
            throw core::InputError("missing", "there are no files from outside a study", {},
                                   "drop CFD files or a folder of them on the window");
        }
        take_in(files);
    });
}

}  // namespace underbody::studio
