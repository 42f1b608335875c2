// The menus, the tool bar and what their actions do.
#include <QActionGroup>
#include <QApplication>
#include <QBoxLayout>
#include <QDesktopServices>
#include <QDockWidget>
#include <QFileDialog>
#include <QFileInfo>
#include <QInputDialog>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QSettings>
#include <QStackedWidget>
#include <QTabWidget>
#include <QToolBar>
#include <QToolButton>
#include <QUrl>
#include <algorithm>

#include "cases/accept.h"
#include "cases/ask_cfd.h"
#include "core/error.h"
#include "geometry/body/body_shape.h"
#include "studio/desktop/catalogue.h"
#include "studio/desktop/main_window.h"
#include "studio/desktop/palette.h"
#include "studio/desktop/panel.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/study_tree.h"
#include "studio/desktop/theme.h"

namespace underbody::studio {

namespace fs = std::filesystem;

QAction* MainWindow::add(QMenu* menu, const QString& text, const QString& key, const std::function<void()>& act) {
    auto* action = menu->addAction(text, this, [act] { act(); });
    if (!key.isEmpty()) {
        action->setShortcut(QKeySequence(key));
    }
    action->setToolTip(QString(text).remove('&') + (key.isEmpty() ? "" : " (" + key + ")"));
    addAction(action);
    return action;
}

void MainWindow::build_file_menu() {
    auto* menu = menuBar()->addMenu("&File");
    add(menu, "&Open study or folder …", "Ctrl+O", [this] {
        const QString folder = QFileDialog::getExistingDirectory(
            this, "A study (it holds study.toml), or a folder of CFD or measurements");
        if (!folder.isEmpty()) {
            take_files({folder.toStdString()});
        }
    });
    recent_ = menu->addMenu("Open &recent");
    add(menu, "Open &files …", "Ctrl+Shift+O", [this] {
        std::vector<fs::path> files;
        for (const auto& file : QFileDialog::getOpenFileNames(
                 this, "CFD files of any format that Underbody reads, SHAPE.toml, sessions (.ubs)")) {
            files.emplace_back(file.toStdString());
        }
        take_files(files);
    });
    add(menu, "Ta&ke files into a study …", "", [this] { take_in_what_is_shown(); });
    menu->addSeparator();
    add(menu, "&Save session", "Ctrl+S", [this] { save_session(false); });
    add(menu, "Save session &as …", "Ctrl+Shift+S", [this] { save_session(true); });
    add(menu, "Save s&hape as …", "", [this] { save_shape(); });
    add(menu, "&Locate what has moved …", "", [this] {
        const QString folder = QFileDialog::getExistingDirectory(this, "Where is the study now?");
        if (!folder.isEmpty()) {
            desk_->act({"locate", desk_->state().study, folder.toStdString()});
        }
    });
    menu->addSeparator();
    add(menu, "Export &picture …", "F12", [this] { export_picture(); });
    add(menu, "Export &table …", "Ctrl+Shift+E", [this] { export_table(); });
    add(menu, "Export for a &controller …", "Ctrl+E", [this] { export_controller(); });
    menu->addSeparator();
    add(menu, "&Quit", "Ctrl+Q", [this] { close(); });
}

void MainWindow::build_edit_menu() {
    auto* menu = menuBar()->addMenu("&Edit");
    undo_ = add(menu, "&Undo", "Ctrl+Z", [this] { desk_->undo(); });
    redo_ = add(menu, "&Redo", "Ctrl+Shift+Z", [this] { desk_->redo(); });
    menu->addSeparator();
    add(menu, "&Copy picture", "Ctrl+Shift+C", [this] { copy_picture(); });
    add(menu, "&Star or unstar what is selected", "Ctrl+B", [this] {
        for (const auto& id : desk_->state().selection) {
            desk_->act({desk_->state().stars.contains(id) ? "unstar" : "star", id});
        }
    });
    menu->addSeparator();
    add(menu, "&Find a command, a case, a parameter …", "Ctrl+K", [this] { show_palette(this, *desk_, actions()); });
}

void MainWindow::build_study_menu() {
    auto* menu = menuBar()->addMenu("&Study");
    need_study_.push_back(add(menu, "&Compute what changed", "Ctrl+R", [this] { desk_->run_study(); }));
    need_study_.push_back(add(menu, "Re&load", "F5", [this] { desk_->reload(); }));
    need_study_.push_back(add(menu, "&Export again what is stale", "Ctrl+Shift+R", [this] { export_stale(); }));
    need_study_.push_back(add(menu, "Open re&port", "Ctrl+P", [this] { open_report(); }));
    menu->addSeparator();
    need_study_.push_back(add(menu, "&Make a table of forces …", "Ctrl+T",
                              [this] { guarded("making a table", [this] { make_table(); }); }));
    menu->addSeparator();
    need_study_.push_back(add(menu, "&Next case", "Ctrl+PgDown", [this] { tree_->step(1); }));
    need_study_.push_back(add(menu, "Pre&vious case", "Ctrl+PgUp", [this] { tree_->step(-1); }));
    menu->addSeparator();
    need_study_.push_back(add(menu, "&Ask for CFD of this shape …", "", [this] { ask_for_cfd(); }));
    add(menu, "Compare &results with those of now", "Ctrl+D", [this] { desk_->act({"pin"}); });
}

void MainWindow::build_view_menu() {
    auto* menu = menuBar()->addMenu("&View");
    workspaces_ = new QActionGroup(this);
    const std::vector<std::pair<QString, QString>> titles = {{"&Design", "F2"},    {"E&xplore", "F3"},
                                                             {"&Compare", "F4"},   {"&Tables", "F6"},
                                                             {"&Stability", "F7"}, {"&Loop", "F8"}};
    for (std::size_t i = 0; i < titles.size(); ++i) {
        auto* action = add(menu, titles[i].first, titles[i].second, [this, i] {
            desk_->act({"workspace", workspace_names()[i]});
        });
        action->setCheckable(true);
        workspaces_->addAction(action);
    }
    views_ = menu->addMenu("&Views in this workspace");
    views_->setObjectName("views");
    connect(views_, &QMenu::aboutToShow, this, &MainWindow::fill_views);
    menu->addSeparator();
    const auto toggle = [&](QDockWidget* dock, const QString& text, const QString& key) {
        auto* action = dock->toggleViewAction();
        action->setText(text);
        action->setShortcut(QKeySequence(key));
        menu->addAction(action);
        addAction(action);
    };
    toggle(tree_dock_, "St&udy on the left", "F9");
    toggle(below_dock_, "C&ommands, problems, jobs, history", "Ctrl+F9");
    const QStringList tabs = {"Show co&mmands", "Show &problems", "Show &jobs", "Show &history"};
    for (int i = 0; i < tabs.size(); ++i) {
        add(menu, tabs[i], QString("Ctrl+%1").arg(i + 1), [this, i] {
            below_dock_->show();
            below_->setCurrentIndex(i);
        });
    }
    auto* themes = menu->addMenu("&Colours");
    auto* theme_group = new QActionGroup(this);
    for (const auto& name : theme_names()) {
        auto* action = add(themes,
                           name == "system"  ? "As the d&esktop"
                           : name == "light" ? "L&ight"
                                             : "Da&rk",
                           "", [this, name] {
                               set_theme(name);
                               if (remember_) {
                                   QSettings().setValue("theme", name);
                               }
                           });
        action->setCheckable(true);
        action->setChecked(remember_ ? QSettings().value("theme", "system").toString() == name : name == "system");
        theme_group->addAction(action);
    }
    auto* full = add(menu, "&Full screen", "F11", [this] { setWindowState(windowState() ^ Qt::WindowFullScreen); });
    full->setCheckable(true);
}

/// What may be chosen is another in each workspace.
void MainWindow::fill_views() {
    views_->clear();
    Panel* panel = current();
    const auto all = panel->views();
    const auto shown = std::count_if(all.begin(), all.end(), [](const Panel::View& view) { return view.shown; });
    for (const auto& view : all) {
        auto* action =
            views_->addAction(view.title, panel, [panel, view] { panel->choose_view(view.name, !view.shown); });
        action->setCheckable(true);
        action->setChecked(view.shown);
        action->setEnabled(!view.shown || shown > 1);
    }
}

void MainWindow::build_help_menu() {
    auto* menu = menuBar()->addMenu("&Help");
    add(menu, "&Keys", "F1", [this] { show_keys(this, actions()); });
    add(menu, "&Effects that a model may lack …", "Shift+F1", [this] { show_effect_catalogue(this); });
    add(menu, "&About", "", [this] { show_about(); });
}

void MainWindow::build_tool_bar() {
    auto* bar = addToolBar("Workspaces");
    bar->setObjectName("workspaces_bar");
    bar->setMovable(false);
    bar->setToolButtonStyle(Qt::ToolButtonTextOnly);
    auto* back = bar->addAction("↶", undo_, &QAction::trigger);
    auto* forth = bar->addAction("↷", redo_, &QAction::trigger);
    const auto follow = [](QAction* mine, QAction* menu) {
        connect(menu, &QAction::changed, mine, [mine, menu] {
            mine->setEnabled(menu->isEnabled());
            mine->setToolTip(menu->text().remove('&') + " (" + menu->shortcut().toString() + ")");
        });
    };
    follow(back, undo_);
    follow(forth, redo_);
    bar->addSeparator();
    bar->addActions(workspaces_->actions());
    bar->addSeparator();
    auto* views = new QToolButton;
    views->setText("Views");
    views->setToolTip("Which views stand in this workspace, from one to six (Alt+V, V)");
    views->setMenu(views_);
    views->setPopupMode(QToolButton::InstantPopup);
    bar->addWidget(views);
}

void MainWindow::ask_for_cfd() {
    guarded("asking for CFD", [&] {
        const std::string shape = shown_shape(desk_->state(), desk_->session());
        if (!desk_->has_study() || shape.empty()) {
            throw core::InputError("missing", "there is no study or no shape to ask for");
        }
        const auto& bodies = desk_->session().study.bodies;
        const bool known =
            std::any_of(bodies.begin(), bodies.end(), [&](const auto& one) { return one.name == shape; });
        const QString name = QInputDialog::getText(this, "CFD of this shape", "Name of the new body in the study",
                                                   QLineEdit::Normal, qt(shape) + (known ? "-2" : ""));
        if (!name.isEmpty()) {
            add_to_sweep(name.toStdString());
        }
    });
}

bool MainWindow::add_to_sweep(const std::string& name) {
    const State& state = desk_->state();
    const std::string of = shown_shape(state, desk_->session());
    const auto asked = cases::ask_for_cfd(desk_->session().study, shape_of(state, desk_->session(), of), name,
                                          state.design.gap, state.design.speed);
    if (!ask("CFD of " + qt(name),
             "Adds " + qt(asked.shape_file.filename().string()) +
                 " and a [[body]] to the study and its [sweep]: " + qt(asked.cost()) + ". Nothing is solved yet.",
             "Add it")) {
        return false;
    }
    cases::write_asked(desk_->session().study, asked);
    Words shape = shape_command(state, desk_->session(), of);
    shape.insert(shape.end(), {"--as", name + ".toml"});
    problems_->note("Added. The same: " + qt(line_of(shape)) + "; " +
                    qt(line_of({"underbody", "sweep", state.study, "--add", name + ".toml"})) +
                    "; solve: " + qt(line_of({"underbody", "sweep", state.study})));
    desk_->reload();
    return true;
}

bool MainWindow::write_found_model(const std::string& measurement) {
    const SessionPointer session = desk_->session().declared ? desk_->session().declared : desk_->session_pointer();
    const auto accepted = cases::accept_model(session->study, session->results, measurement);
    QStringList users;
    for (const auto& user : accepted.users) {
        users << qt(user);
    }
    if (!ask("Write into the study",
             qt(accepted.sentence) + "\n\nWrites " + qt(accepted.model.string()) + " and makes it the model of " +
                 users.join(", ") +
                 ". The old model stays where it is. Undo does not take this back: a line of study.toml does.",
             "Write it")) {
        return false;
    }
    cases::write_accepted(session->study, accepted);
    problems_->note("Written. The same: " +
                    qt(line_of({"underbody", "study", "accept", desk_->state().study, measurement})));
    if (desk_->state().accepted.contains(measurement)) {
        desk_->act({"unaccept", measurement});
    }
    desk_->reload();
    return true;
}

void MainWindow::open_report() {
    const Session& session = desk_->session();
    fs::path report = session.results.report;
    if (report.empty()) {
        report = session.folder / "report" / "index.html";
    }
    guarded("opening the report", [&] {
        if (!fs::exists(report)) {
            throw core::InputError("missing", "there is no report at " + report.string(), {},
                                   "make it: Study > Compute what changed (Ctrl+R)");
        }
        QDesktopServices::openUrl(QUrl::fromLocalFile(qt(fs::absolute(report).string())));
    });
}

void MainWindow::show_about() {
    QMessageBox::about(this, "Underbody Studio",
                       "<h3>Underbody Studio " UNDERBODY_VERSION
                       "</h3><p>CFD post-processing and ground-effect design.</p>"
                       "<p>Free software under the GNU General Public License, version 3 or later.</p>"
                       "<p>What it shows, the libraries and the command <tt>underbody</tt> return too.</p>");
}

}  // namespace underbody::studio
