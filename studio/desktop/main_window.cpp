#include "studio/desktop/main_window.h"

#include <QActionGroup>
#include <QApplication>
#include <QBoxLayout>
#include <QBuffer>
#include <QCloseEvent>
#include <QDockWidget>
#include <QFileInfo>
#include <QFileSystemWatcher>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMessageBox>
#include <QMimeData>
#include <QProgressBar>
#include <QPushButton>
#include <QScreen>
#include <QSettings>
#include <QShortcut>
#include <QStackedWidget>
#include <QStandardPaths>
#include <QStatusBar>
#include <QTabWidget>
#include <QTimer>
#include <QToolBar>
#include <QToolButton>
#include <QUrl>
#include <algorithm>
#include <iterator>

#include "core/error.h"
#include "core/file.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/discovery_panel.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/first_page.h"
#include "studio/desktop/focus_ring.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/icon.h"
#include "studio/desktop/input_guard.h"
#include "studio/desktop/pictures_panel.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/region_panel.h"
#include "studio/desktop/rolled.h"
#include "studio/desktop/state/exports.h"
#include "studio/desktop/study_tree.h"
#include "studio/desktop/theme.h"

namespace underbody::studio {

namespace fs = std::filesystem;

namespace {

fs::path log_folder(bool remember) {
    return remember
               ? fs::path(QStandardPaths::writableLocation(QStandardPaths::AppLocalDataLocation).toStdString()) / "logs"
               : fs::path();
}

/// Something that another step of the study makes.
bool is_missing(const std::exception_ptr& error) {
    try {
        std::rethrow_exception(error);
    } catch (const core::InputError& known) {
        return known.kind() == "missing";
    } catch (...) {
        return false;
    }
}

}  // namespace

MainWindow::MainWindow(bool remember)
    : remember_(remember), jobs_(new Jobs(this)), desk_(new Desk(*jobs_, log_folder(remember), this)) {
    setWindowTitle("Underbody Studio");
    setWindowIcon(program_icon());
    setAcceptDrops(true);
    const QScreen* screen = QGuiApplication::primaryScreen();
    resize(first_size(screen != nullptr ? screen->availableSize() : QSize()));
    ask = [this](const QString& title, const QString& text, const QString& yes) {
        QMessageBox box(QMessageBox::Question, title, text, QMessageBox::Cancel, this);
        auto* button = box.addButton(yes, QMessageBox::AcceptRole);
        box.exec();
        return box.clickedButton() == button;
    };
    watcher_ = new QFileSystemWatcher(this);
    new InputGuard(this);
    new FocusRing(this);
    build_workspaces();
    build_tree();
    build_below();
    build_status();
    build_file_menu();
    build_edit_menu();
    build_study_menu();
    build_view_menu();
    build_help_menu();
    build_tool_bar();
    connect(jobs_, &Jobs::failed, this, [this](const QString& what, const std::exception_ptr& error) {
        if (what == "computing" || !desk_->computing() || !is_missing(error)) {  // what is on its way is not missing
            show_failure(what, error);
        }
    });
    connect(jobs_, &Jobs::succeeded, banner_, &QWidget::hide);
    connect(desk_, &Desk::refused, this, &MainWindow::show_failure);
    connect(desk_, &Desk::acted, banner_, &QWidget::hide);
    connect(desk_, &Desk::noted, this, [this](const QString& text) { problems_->note(text); });
    connect(desk_, &Desk::found, this, [this](const core::Problem& problem) { problems_->add(problem); });
    connect(desk_, &Desk::changed, this, &MainWindow::follow_state);
    connect(desk_, &Desk::session_changed, this, &MainWindow::follow_session);
    connect(desk_, &Desk::opened, this, &MainWindow::remember_study);
    if (remember_) {
        QSettings settings;
        restoreGeometry(settings.value("geometry").toByteArray());
        laid_out_ = restoreState(settings.value("layout").toByteArray());
        set_theme(settings.value("theme", "system").toString());
    }
    fill_recent();
    follow_state();
    follow_session();
    problems_->note("Ready. Open a study with Ctrl+O, or drop its folder on the window.");
}

QSize MainWindow::first_size(const QSize& available) {
    const QSize wanted(1440, 900), frame(8, 44);  // what a window manager puts around it
    return available.isEmpty() ? wanted : wanted.boundedTo(available - frame);
}

// Jobs end before the widgets that their results would go to.
MainWindow::~MainWindow() { delete jobs_; }

void MainWindow::build_workspaces() {
    auto* centre = new QWidget;
    auto* column = new QVBoxLayout(centre);
    column->setContentsMargins(4, 4, 4, 0);
    middle_ = new QStackedWidget;
    column->addWidget(new Rolled(middle_), 1);
    banner_ = new Banner(centre);  // over what is there
    connect(middle_, &QStackedWidget::currentChanged, this, [this](int current) {
        for (int i = 0; i < middle_->count(); ++i) {  // what is not seen needs no room
            const auto policy = i == current ? QSizePolicy::Preferred : QSizePolicy::Ignored;
            middle_->widget(i)->setSizePolicy(policy, policy);
        }
    });
    setCentralWidget(centre);
    first_ = new FirstPage(this);
    middle_->addWidget(first_);
    connect(first_, &FirstPage::chosen, this, [this](const QString& folder) { open_study(folder.toStdString()); });
    for (Panel* panel : std::initializer_list<Panel*>{new DesignPanel(*desk_, this), new ExplorePanel(*desk_, this),
                                                      new FieldsPanel(*desk_, this), new ForcePanel(*desk_, this),
                                                      new RegionPanel(*desk_, this), new DiscoveryPanel(*desk_, this),
                                                      new PicturesPanel(*desk_, this)}) {
        panels_.push_back(panel);
        middle_->addWidget(panel);
        if (auto* design = qobject_cast<DesignPanel*>(panel)) {
            connect(design, &DesignPanel::cfd_wanted, this, &MainWindow::ask_for_cfd);
        }
        if (auto* loop = qobject_cast<DiscoveryPanel*>(panel)) {
            connect(loop, &DiscoveryPanel::write_wanted, this, [this](const QString& measurement) {
                guarded("writing the found model", [&] { write_found_model(measurement.toStdString()); });
            });
        }
        connect(panel, &Panel::remark, this, [this](const QString& text) { statusBar()->showMessage(text); });
        connect(panel, &Panel::problem, this, [this](const core::Problem& found) { problems_->add(found); });
    }
}

void MainWindow::build_status() {
    doing_ = new QLabel;
    bar_ = new QProgressBar;
    bar_->setMaximumWidth(220);
    bar_->setRange(0, 1000);
    bar_->setTextVisible(false);
    bar_->setAccessibleName("Progress");
    cancel_ = new QToolButton;
    cancel_->setText("Cancel");
    cancel_->setToolTip("Cancel what is running in front (Esc); each job has its own button under Jobs");
    connect(cancel_, &QToolButton::clicked, this, &MainWindow::cancel_first);
    auto* escape = new QShortcut(QKeySequence(Qt::Key_Escape), this);
    escape->setEnabled(false);
    connect(escape, &QShortcut::activated, this, [this] {
        if (qobject_cast<QLineEdit*>(focusWidget()) != nullptr) {
            statusBar()->showMessage(
                "Esc cancels nothing while a field has the keyboard: leave it first, or press Cancel");
        } else {
            cancel_first();
        }
    });
    for (auto* widget : std::initializer_list<QWidget*>{doing_, bar_, cancel_}) {
        statusBar()->addPermanentWidget(widget);
        widget->hide();
    }
    connect(jobs_, &Jobs::progressed, this, [this, escape](double fraction, const QString& what) {
        const bool running = !what.isEmpty();
        escape->setEnabled(running);
        doing_->setText(what.size() > 80 ? what.left(79) + "…" : what);
        bar_->setValue(static_cast<int>(1000 * fraction));
        const auto count = jobs_->rows().size();
        below_->setTabText(2, count > 0 ? QString("Jobs (%1)").arg(count) : QString("Jobs"));
        for (auto* widget : std::initializer_list<QWidget*>{doing_, bar_, cancel_}) {
            widget->setVisible(running);
        }
    });
}

void MainWindow::cancel_first() {
    const auto rows = jobs_->rows();
    if (rows.empty()) {
        return;
    }
    jobs_->cancel(rows.front().id);
    const std::string what = rows.front().what.toStdString();
    statusBar()->showMessage("cancelled: " + rows.front().what, 4000);
    problems_->add({core::Problem::Severity::note,
                    "cancelled by hand: " + what + "; begun again, it goes on with what is done",
                    {}});
}

Panel* MainWindow::current() const {
    auto* panel = dynamic_cast<Panel*>(middle_->currentWidget());
    return panel != nullptr ? panel : panels_.front();
}

void MainWindow::follow_state() {
    const State& state = desk_->state();
    const auto& names = workspace_names();
    std::size_t at = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        at = names[i] == state.workspace ? i : at;
    }
    workspaces_->actions().at(static_cast<int>(at))->setChecked(true);
    const bool empty = !desk_->has_study() && state.files.empty();
    // A chosen picture is shown in Compare, where cases are looked at.
    const bool picture = names[at] == "compare" && !state.selected("picture").empty() &&
                         state.selection.size() == state.selected("picture").size();
    QWidget* wanted = empty ? static_cast<QWidget*>(first_) : picture ? panels_.back() : panels_[at];
    if (middle_->currentWidget() != wanted) {
        const bool begins = middle_->currentWidget() == first_;
        middle_->setCurrentWidget(wanted);
        statusBar()->clearMessage();
        QTimer::singleShot(0, this, [this, begins] {
            update();  // laid out anew, nothing of the old stays
            if (begins) {
                make_room();
            }
        });
    }
    const auto& history = desk_->history();
    const bool can_undo = history.position() > 0;
    const bool can_redo = history.position() < history.steps().size();
    undo_->setEnabled(can_undo);
    redo_->setEnabled(can_redo);
    undo_->setText(can_undo ? "&Undo " + qt(history.steps()[history.position() - 1].name) : QString("&Undo"));
    redo_->setText(can_redo ? "&Redo " + qt(history.steps()[history.position()].name) : QString("&Redo"));
}

void MainWindow::follow_session() {
    const bool study = desk_->has_study();
    setWindowTitle(study ? qt(desk_->session().study.title) + " · Underbody Studio" : QString("Underbody Studio"));
    for (auto* action : need_study_) {
        action->setEnabled(study);
    }
    watch_files();
    follow_state();
    say_what_is_stale();
}

void MainWindow::say_what_is_stale() {
    if (desk_->computing() || !desk_->has_study()) {
        return;
    }
    for (const auto& file : stale_exports(desk_->state(), desk_->session())) {
        problems_->add({core::Problem::Severity::warning,
                        "the exported file is stale: table '" + desk_->state().exports.at(file).table +
                            "', or what was found of its force, has changed since, or the file is gone",
                        {file, {}, {}, {}}},
                       "Study > Export again what is stale (Ctrl+Shift+R)");
    }
}

/// Says once when something that is shown has changed on disk.
void MainWindow::watch_files() {
    if (const auto old = watcher_->files(); !old.isEmpty()) {
        watcher_->removePaths(old);
    }
    watcher_->disconnect();
    if (!desk_->has_study()) {
        return;
    }
    QStringList files{qt((desk_->session().folder / "study.toml").string())};
    for (const auto& [name, file] : desk_->session().shape_files) {
        files << qt(file.string());
    }
    for (const auto& one : desk_->session().study.cases) {
        if (files.size() < 1000) {
            files << qt(one.file.string());
        }
    }
    watcher_->addPaths(files);
    connect(watcher_, &QFileSystemWatcher::fileChanged, this, [this](const QString& file) {
        banner_->show_note(file + " has changed on disk: F5 reads the study again");
    });
}

void MainWindow::show_failure(const QString& what, const std::exception_ptr& error) {
    const Told told = tell(error);
    last_error_ = told.message + (told.hint.isEmpty() ? "" : " (" + told.hint + ")");
    banner_->show_error(what, told.message, told.hint);
    problems_->add(told.problem, told.hint);
}

void MainWindow::guarded(const QString& what, const std::function<void()>& work) {
    try {
        work();
    } catch (...) {
        show_failure(what, std::current_exception());
    }
}

QString MainWindow::pictures_folder() const {
    return QStandardPaths::writableLocation(QStandardPaths::CacheLocation) + "/pictures";
}

void MainWindow::remember_study(const QString& folder) {
    if (!remember_ || folder.isEmpty()) {
        return;
    }
    QSettings settings;
    QStringList recent = settings.value("recent").toStringList();
    recent.removeAll(folder);
    recent.prepend(folder);
    settings.setValue("recent", QStringList(recent.mid(0, 10)));
    fill_recent();
}

void MainWindow::fill_recent() {
    recent_->clear();
    QStringList folders;
    if (remember_) {
        folders = QSettings().value("recent").toStringList();
        for (const auto& folder : folders) {
            recent_->addAction(folder, this, [this, folder] { take_files({folder.toStdString()}); });
        }
    }
    recent_->setEnabled(!recent_->isEmpty());
    QStringList studies;  // single files stand in the menu alone
    std::copy_if(folders.begin(), folders.end(), std::back_inserter(studies),
                 [](const QString& one) { return !QFileInfo(one).isFile(); });
    first_->show_recent(studies, pictures_folder());
}

void MainWindow::offer_recovery() {
    const auto logs = left_over_logs(log_folder(remember_));
    if (!logs.empty() && ask("Restore the session",
                             "The program was not closed properly the last time. The session can be restored from its "
                             "log, up to where it stopped.",
                             "Restore")) {
        desk_->replay_log(logs.front(), {}, true);
        return;  // the log stays until the next start: its lines stand in the new one by then
    }
    for (const auto& log : logs) {
        std::error_code none;
        fs::remove(log, none);
    }
}

void MainWindow::closeEvent(QCloseEvent* event) {
    if (desk_->computing() &&
        !ask("Computing",
             "The study is being computed. What is done already is stored and is not computed again; the rest is done "
             "the next time.",
             "Stop and close")) {
        event->ignore();
        return;
    }
    if (remember_) {
        desk_->end_gesture();
        desk_->keep_session();
        QSettings settings;
        settings.setValue("geometry", saveGeometry());
        settings.setValue("layout", saveState());
        if (desk_->has_study()) {
            core::write_file(
                FirstPage::picture_of(pictures_folder(), qt(desk_->session().folder.string())).toStdString(), [this] {
                    QByteArray bytes;
                    QBuffer buffer(&bytes);
                    buffer.open(QIODevice::WriteOnly);
                    middle_->grab()
                        .scaled(400, 250, Qt::KeepAspectRatio, Qt::SmoothTransformation)
                        .save(&buffer, "PNG");
                    return bytes.toStdString();
                }());
        }
    }
    jobs_->cancel();
    event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    if (event->mimeData()->hasUrls()) {
        event->setDropAction(Qt::CopyAction);  // whatever was proposed: who is told of a move deletes the file
        event->accept();
    }
}

void MainWindow::dropEvent(QDropEvent* event) {
    std::vector<fs::path> files;
    for (const auto& url : event->mimeData()->urls()) {
        if (url.isLocalFile()) {
            files.emplace_back(url.toLocalFile().toStdString());
        }
    }
    event->setDropAction(Qt::CopyAction);
    event->accept();
    guarded("taking what was dropped", [&] {
        if (files.empty()) {
            throw core::InputError("missing", "what was dropped is no file of this computer", {},
                                   "save it first, then drop the file");
        }
        take_files(files);
    });
}

}  // namespace underbody::studio
