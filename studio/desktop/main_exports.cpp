// What the window writes: sessions, shapes, pictures, tables, files for controllers.
#include <QApplication>
#include <QClipboard>
#include <QDateTime>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <algorithm>

#include "cases/export_files.h"
#include "core/error.h"
#include "core/file.h"
#include "geometry/body/body_shape.h"
#include "studio/desktop/export_dialog.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/panel.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/state/exports.h"

namespace underbody::studio {

namespace fs = std::filesystem;

bool MainWindow::write_chosen(QString path, const QStringList& endings,
                              const std::function<void(const fs::path&)>& write) {
    if (path.isEmpty()) {
        return false;
    }
    bool fits = endings.isEmpty();
    for (const auto& ending : endings) {
        fits = fits || path.endsWith(ending, Qt::CaseInsensitive);
    }
    path += fits ? QString() : endings.front();
    const QFileInfo file(path);
    if (file.exists() &&
        !ask("Replace",
             file.fileName() + " is there already, of " + file.lastModified().toString("yyyy-MM-dd HH:mm") + ".",
             "Replace it")) {
        return false;
    }
    bool written = false;
    guarded("writing " + file.fileName(), [&] {
        write(path.toStdString());
        written_into_[desk_->session().folder] = file.absolutePath();
        problems_->note("Wrote " + path);
        written = true;
    });
    return written;
}

QString MainWindow::write_folder() const {
    const auto known = written_into_.find(desk_->session().folder);
    return known != written_into_.end() ? known->second
           : desk_->has_study()         ? qt(desk_->session().folder.string())
                                        : QDir::currentPath();
}

/// The dialog does not ask: `write_chosen` does, when the ending is known.
QString MainWindow::ask_path(const QString& title, const QString& name, const QString& filter) {
    return QFileDialog::getSaveFileName(this, title, write_folder() + "/" + name, filter, nullptr,
                                        QFileDialog::DontConfirmOverwrite);
}

QString MainWindow::proposed_file(const QString& ending) const {
    return qt(proposed_name(desk_->state(), desk_->session())) + ending;
}

void MainWindow::save_session(bool elsewhere) {
    const QString path =
        elsewhere || session_file_.isEmpty()
            ? ask_path("Save session", QFileInfo(qt(desk_->state().study)).fileName() + ".ubs", "Sessions (*.ubs)")
            : session_file_;
    const auto write = [&](const fs::path& file) {
        desk_->save_session_file(file);
        session_file_ = qt(file.string());
    };
    if (path == session_file_ && !path.isEmpty()) {
        guarded("saving the session", [&] { write(path.toStdString()); });
    } else {
        write_chosen(path, {".ubs"}, write);
    }
}

void MainWindow::save_shape() {
    guarded("saving the shape", [&] {
        const std::string shown = shown_shape(desk_->state(), desk_->session());
        if (shown.empty()) {
            throw core::InputError("missing", "there is no shape to save");
        }
        write_chosen(ask_path("Save shape", qt(shown) + ".toml", "Shapes (*.toml)"), {".toml"},
                     [&](const fs::path& path) { write_shown_shape(path); });
    });
}

void MainWindow::write_shown_shape(const fs::path& path) {
    const std::string shown = shown_shape(desk_->state(), desk_->session());
    auto shape = shape_of(desk_->state(), desk_->session(), shown);
    shape.name = path.stem().string();
    core::write_file(path, geometry::write_shape(shape));
    Words line = shape_command(desk_->state(), desk_->session(), shown);
    line.insert(line.end(), {"--as", path.string()});
    problems_->note("The same: " + qt(line_of(line)));
}

void MainWindow::export_picture() {
    guarded("exporting a picture", [&] {
        if (!current()->has_picture()) {
            throw core::InputError("missing", "this workspace shows no picture yet");
        }
        const QStringList endings = current()->picture_endings();
        QString filter = "Pictures (";
        for (const auto& ending : endings) {
            filter += "*" + ending + " ";
        }
        write_chosen(ask_path("Export picture", proposed_file(endings.front()), filter.trimmed() + ")"), endings,
                     [&](const fs::path& path) { current()->export_picture(path); });
    });
}

void MainWindow::export_table() {
    guarded("exporting a table", [&] {
        if (!current()->has_table()) {
            throw core::InputError("missing", "this workspace shows no table yet");
        }
        write_chosen(ask_path("Export table", proposed_file(".csv"), "Tables (*.csv)"), {".csv"},
                     [&](const fs::path& path) { current()->export_table(path); });
    });
}

void MainWindow::export_controller() {
    guarded("exporting for a controller", [&] {
        for (auto* panel : panels_) {
            if (auto* forces = dynamic_cast<ForcePanel*>(panel); forces != nullptr && forces->table()) {
                const TableOfStudy of = table_of_study(desk_->session(), forces->table_name());
                if (of.found.empty()) {
                    show_export(forces->table(), of);
                    return;
                }
                // The force of the model that was found takes a while to be sampled.
                jobs_->start("export table", "the force with " + qt(of.found),
                             [this, of, session = desk_->session_pointer()](core::Progress& progress) {
                                 auto table = std::make_shared<const tables::ForceTable>(
                                     exported_table(*session, of.name, {}, progress));
                                 return [this, of, table] { show_export(table, of); };
                             });
                return;
            }
        }
        throw core::InputError("missing", "no force table is shown yet", {}, "choose one in Tables (F6)");
    });
}

ExportDialog* MainWindow::show_export(const std::shared_ptr<const tables::ForceTable>& table, const TableOfStudy& of) {
    auto* dialog = new ExportDialog(
        *jobs_, table, this, of,
        of.found.empty()
            ? ExportDialog::Make()
            : [session = desk_->session_pointer(), name = of.name, table](const auto& range, core::Progress& progress) {
                  return range.empty() ? *table : exported_table(*session, name, range, progress);
              });
    const auto mark = [this, dialog] {
        QStringList names;
        for (const auto& name : marked_tables(desk_->state(), desk_->session())) {
            names << qt(name);
        }
        dialog->set_marked(names);
    };
    mark();
    connect(desk_, &Desk::changed, dialog, mark);
    dialog->set_folder(write_folder());
    connect(dialog, &ExportDialog::written, this, [this](const QString& path, const QString& command) {
        problems_->note("Wrote " + path + ". The same: " + command);
    });
    const std::string made_of =
        table_digest(desk_->session(), of.name);  // of what is written, whatever changes meanwhile
    connect(dialog, &ExportDialog::exported, this,
            [this, made_of, study = desk_->session().folder](const QString& path, ExportRecord record) {
                written_into_[study] = QFileInfo(path).absolutePath();
                if (!record.table.empty()) {
                    record.made_of = made_of;
                    keep_exports({{path.toStdString(), record}}, study);
                }
            });
    connect(dialog, &ExportDialog::failed, this, &MainWindow::show_failure);
    connect(dialog, &ExportDialog::all_wanted, this, [this](const ExportRecord& how) {
        const QString folder =
            QFileDialog::getExistingDirectory(this, "Folder that all marked tables are written into", write_folder());
        if (!folder.isEmpty()) {
            written_into_[desk_->session().folder] = folder;
            write_marked(how, folder.toStdString());
        }
    });
    dialog->show();
    return dialog;
}

bool MainWindow::write_marked(const ExportRecord& how, const fs::path& folder) {
    ExportedFiles files;
    for (const auto& name : marked_tables(desk_->state(), desk_->session())) {
        ExportRecord record = how;
        record.table = name;
        record.name = cases::export_name(name);
        record.made_of.clear();
        const auto& axes = desk_->session().study.find_table(name)->axes;
        std::erase_if(record.range, [&](const auto& policy) {
            return std::find(axes.begin(), axes.end(), policy.first) == axes.end();
        });
        files.emplace_back((fs::absolute(folder) / cases::export_file(name, how.format)).lexically_normal().string(),
                           record);
    }
    if (files.empty()) {
        problems_->note("No table is marked: select some in the tree (Ctrl+click), or give them a star (Ctrl+B).");
        return false;
    }
    return write_exports(files);
}

void MainWindow::export_stale() {
    ExportedFiles files;
    for (const auto& file : stale_exports(desk_->state(), desk_->session())) {
        files.emplace_back(file, desk_->state().exports.at(file));
    }
    if (files.empty()) {
        problems_->note("No exported file is stale.");
        return;
    }
    write_exports(files);
}

/// Of several files that are written by one job.
struct MainWindow::EndedExports {
    ExportedFiles done;
    std::vector<std::pair<std::string, std::exception_ptr>> failed;
};

/// All in one job and one step of the history; what others have written is not replaced unasked.
bool MainWindow::write_exports(const ExportedFiles& files) {
    std::vector<std::string> paths;
    for (const auto& [file, record] : files) {
        paths.push_back(file);
    }
    QStringList foreign;
    for (const auto& file : foreign_files(desk_->state(), paths)) {
        foreign << QFileInfo(qt(file)).fileName();
    }
    if (!foreign.isEmpty() &&
        !ask("Replace",
             foreign.join(", ") + (foreign.size() > 1 ? " are" : " is") +
                 " there already, and not as this window wrote " + (foreign.size() > 1 ? "them." : "it."),
             foreign.size() > 1 ? "Replace them" : "Replace it")) {
        return false;
    }
    const auto ended = std::make_shared<EndedExports>();
    jobs_->start(
        "export again", QString("writing %1 exports").arg(files.size()),
        [ended, files, session = desk_->session_pointer()](core::Progress& progress) -> std::function<void()> {
            for (const auto& [file, record] : files) {
                progress.report(
                    static_cast<double>(ended->done.size() + ended->failed.size()) / static_cast<double>(files.size()),
                    file);
                progress.check();
                try {
                    ended->done.emplace_back(file, export_again(*session, file, record, progress));
                } catch (const core::Cancelled&) {
                    throw;
                } catch (...) {  // the others are written
                    ended->failed.emplace_back(file, std::current_exception());
                }
            }
            return ended->failed.empty() ? std::function<void()>([] {}) : nullptr;
        },
        false, [this, ended, of = files.size(), study = desk_->session().folder] { show_exports(*ended, of, study); });
    return true;
}

/// What was written is kept, whatever became of the others.
void MainWindow::show_exports(const EndedExports& ended, std::size_t of, const fs::path& study) {
    const std::size_t written = ended.done.size();
    const QString count =
        written == of ? QString("Wrote %1 exports.").arg(of) : QString("Wrote %1 of %2 exports.").arg(written).arg(of);
    if (written > 0 && keep_exports(ended.done, study)) {
        const auto& step = desk_->history().steps().at(desk_->history().position() - 1);
        problems_->note(count + " The same: " + qt(step.command));
    } else {
        problems_->note(count);
    }
    for (const auto& [file, error] : ended.failed) {
        show_failure("writing " + QFileInfo(qt(file)).fileName(), error);
    }
}

/// As a step of the history, where the study is still open that they are of.
bool MainWindow::keep_exports(const ExportedFiles& files, const fs::path& study) {
    if (desk_->session().folder != study) {
        problems_->note("What was written is of " + qt(study.string()) +
                        ", which is no longer open: it is not among its exports.");
        return false;
    }
    return desk_->act(words_of_exports(files));
}

void MainWindow::copy_picture() { QApplication::clipboard()->setImage(current()->picture_to_copy()); }

}  // namespace underbody::studio
