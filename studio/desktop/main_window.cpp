#include "studio/desktop/main_window.h"

#include <QApplication>
#include <QBoxLayout>
#include <QCloseEvent>
#include <QDesktopServices>
#include <QDockWidget>
#include <QFileDialog>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QProgressBar>
#include <QSettings>
#include <QStatusBar>
#include <QTabWidget>
#include <QToolButton>
#include <QUrl>

#include "core/error.h"
#include "studio/desktop/body_panel.h"
#include "studio/desktop/cases_panel.h"
#include "studio/desktop/catalogue.h"
#include "studio/desktop/discovery_panel.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/icon.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/pictures_panel.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/region_panel.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace fs = std::filesystem;

MainWindow::MainWindow(bool remember) : remember_(remember), jobs_(new Jobs(this)) {
    setWindowTitle("Underbody Studio");
    setWindowIcon(program_icon());
    setAcceptDrops(true);
    resize(1440, 900);
    build_panels();
    build_cases();
    build_status();
    build_file_menu();
    build_study_menu();
    build_view_menu();
    build_help_menu();
    connect(jobs_, &Jobs::failed, this, &MainWindow::show_failure);
    if (remember_) {
        QSettings settings;
        restoreGeometry(settings.value("geometry").toByteArray());
        restoreState(settings.value("layout").toByteArray());
        tabs_->setCurrentIndex(settings.value("panel", 0).toInt());
    }
    fill_recent();
    problems_->note("Ready. Open a study with Ctrl+O, or drop its folder on the window.");
}

// Jobs wind up before the widgets that their results would go to.
MainWindow::~MainWindow() { delete jobs_; }

void MainWindow::build_panels() {
    auto* middle = new QWidget;
    auto* column = new QVBoxLayout(middle);
    column->setContentsMargins(4, 4, 4, 0);
    banner_ = new Banner(middle);
    column->addWidget(banner_);
    tabs_ = new QTabWidget;
    tabs_->setDocumentMode(true);
    column->addWidget(tabs_, 1);
    setCentralWidget(middle);

    body_ = new BodyPanel(*jobs_, this);
    const std::vector<std::pair<Panel*, QString>> all = {{body_, "&Body"},
                                                         {new ForcePanel(*jobs_, this), "&Forces"},
                                                         {new RegionPanel(*jobs_, this), "St&ability"},
                                                         {new DiscoveryPanel(*jobs_, this), "&Discovery"},
                                                         {new PicturesPanel(*jobs_, this), "&Pictures"}};
    for (const auto& [panel, title] : all) {
        panels_.push_back(panel);
        tabs_->addTab(panel, title);
        connect(panel, &Panel::remark, this, [this](const QString& text) { statusBar()->showMessage(text); });
        connect(panel, &Panel::problem, this, [this](const core::Problem& found) { problems_->add(found); });
    }
    connect(tabs_, &QTabWidget::currentChanged, this, [this] { statusBar()->clearMessage(); });
}

void MainWindow::build_cases() {
    auto* holder = new QWidget;
    auto* column = new QVBoxLayout(holder);
    column->setContentsMargins(4, 4, 0, 0);
    auto* filter = new QLineEdit;
    filter->setPlaceholderText("Filter cases");
    filter->setClearButtonEnabled(true);
    column->addWidget(filter);
    cases_ = new CasesTree(holder);
    column->addWidget(cases_, 1);
    connect(filter, &QLineEdit::textChanged, cases_, &CasesTree::filter);
    connect(cases_, &CasesTree::chosen, this, [this](const cases::Case& chosen) {
        for (auto* panel : panels_) {
            panel->show_case(chosen);
        }
    });
    cases_dock_ = new QDockWidget("Cases", this);
    cases_dock_->setObjectName("cases_dock");
    cases_dock_->setWidget(holder);
    addDockWidget(Qt::LeftDockWidgetArea, cases_dock_);

    problems_ = new ProblemList(this);
    problems_dock_ = new QDockWidget("Problems", this);
    problems_dock_->setObjectName("problems_dock");
    problems_dock_->setWidget(problems_);
    addDockWidget(Qt::BottomDockWidgetArea, problems_dock_);
    resizeDocks({cases_dock_}, {490}, Qt::Horizontal);
    resizeDocks({problems_dock_}, {110}, Qt::Vertical);
    setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
}

void MainWindow::build_status() {
    doing_ = new QLabel;
    bar_ = new QProgressBar;
    bar_->setMaximumWidth(220);
    bar_->setRange(0, 1000);
    bar_->setTextVisible(false);
    cancel_ = new QToolButton;
    cancel_->setText("Cancel");
    cancel_->setShortcut(QKeySequence("Esc"));
    cancel_->setToolTip("Cancel what is running (Esc)");
    connect(cancel_, &QToolButton::clicked, this, [this] {
        jobs_->cancel();
        statusBar()->showMessage("cancelled", 4000);
    });
    for (auto* widget : std::initializer_list<QWidget*>{doing_, bar_, cancel_}) {
        statusBar()->addPermanentWidget(widget);
        widget->hide();
    }
    connect(jobs_, &Jobs::progressed, this, [this](double fraction, const QString& what) {
        const bool running = !what.isEmpty();
        doing_->setText(what.size() > 80 ? what.left(79) + "…" : what);
        bar_->setValue(static_cast<int>(1000 * fraction));
        for (auto* widget : std::initializer_list<QWidget*>{doing_, bar_, cancel_}) {
            widget->setVisible(running);
        }
    });
}

void MainWindow::build_file_menu() {
    auto* menu = menuBar()->addMenu("&File");
    menu->addAction(
        "&Open study …", this,
        [this] {
            const QString folder = QFileDialog::getExistingDirectory(this, "Folder of the study (it holds study.toml)");
            if (!folder.isEmpty()) {
                open_study(folder.toStdString());
            }
        },
        QKeySequence::Open);
    recent_ = menu->addMenu("Open &recent");
    menu->addAction("Open CFD &file …", this, [this] {
        const QString file = QFileDialog::getOpenFileName(this, "A CFD file of any format that Underbody reads");
        if (!file.isEmpty()) {
            show_panel(body_);
            body_->show_file(file.toStdString(), {}, QFileInfo(file).fileName());
        }
    });
    menu->addSeparator();
    picture_ = menu->addAction("Export &picture …", this, &MainWindow::export_picture, QKeySequence("Ctrl+E"));
    table_ = menu->addAction("Export &table …", this, &MainWindow::export_table, QKeySequence("Ctrl+Shift+E"));
    connect(menu, &QMenu::aboutToShow, this, [this] {
        picture_->setEnabled(current()->has_picture());
        table_->setEnabled(current()->has_table());
    });
    connect(menu, &QMenu::aboutToHide, this, [this] {  // shortcuts must work whatever the menu last saw
        picture_->setEnabled(true);
        table_->setEnabled(true);
    });
    menu->addSeparator();
    menu->addAction("&Quit", this, &QWidget::close, QKeySequence::Quit);
}

void MainWindow::build_study_menu() {
    auto* menu = menuBar()->addMenu("&Study");
    run_ = menu->addAction("&Compute what changed", this, &MainWindow::run_study, QKeySequence("Ctrl+R"));
    reload_ = menu->addAction("Re&load", this, &MainWindow::reload, QKeySequence::Refresh);
    report_ = menu->addAction("Open re&port", this, &MainWindow::open_report, QKeySequence("Ctrl+P"));
    for (auto* action : {run_, reload_, report_}) {
        action->setEnabled(false);
    }
}

void MainWindow::build_view_menu() {
    auto* menu = menuBar()->addMenu("&View");
    for (int i = 0; i < tabs_->count(); ++i) {
        menu->addAction(
            tabs_->tabText(i), this, [this, i] { tabs_->setCurrentIndex(i); },
            QKeySequence(QString("Ctrl+%1").arg(i + 1)));
    }
    menu->addSeparator();
    auto* cases = cases_dock_->toggleViewAction();
    cases->setShortcut(QKeySequence("F9"));
    menu->addAction(cases);
    auto* problems = problems_dock_->toggleViewAction();
    problems->setShortcut(QKeySequence("F8"));
    menu->addAction(problems);
}

void MainWindow::build_help_menu() {
    auto* menu = menuBar()->addMenu("&Help");
    menu->addAction(
        "&Effects …", this, [this] { show_effect_catalogue(this); }, QKeySequence::HelpContents);
    menu->addAction("&About", this, &MainWindow::show_about);
}

Panel* MainWindow::current() const { return panels_[static_cast<std::size_t>(std::max(0, tabs_->currentIndex()))]; }

void MainWindow::show_panel(Panel* panel) { tabs_->setCurrentWidget(panel); }

void MainWindow::open_study(const fs::path& folder) {
    const QString name = QString::fromStdString(folder.string());
    jobs_->start("study", "opening " + name, [this, folder, name](core::Progress&) {
        auto session = open_session(folder);
        return [this, session, name] {
            banner_->hide();
            show_session(session);
            remember_study(QString::fromStdString(fs::absolute(session->study.folder()).string()));
            problems_->note(QString("Opened %1: %2 cases").arg(name).arg(session->study.cases.size()));
            if (session->results.loads.rows() == 0) {
                problems_->note("Nothing of this study is computed yet: Study > Compute what changed (Ctrl+R).");
            }
        };
    });
}

void MainWindow::show_session(const SessionPointer& session) {
    session_ = session;
    setWindowTitle(QString::fromStdString(session->study.title) + " · Underbody Studio");
    for (auto* action : {run_, reload_, report_}) {
        action->setEnabled(true);
    }
    for (const auto& step : session->results.steps) {
        if (!step.error.empty()) {
            problems_->add({core::Problem::Severity::error, step.kind + " '" + step.name + "': " + step.error, {}});
        }
    }
    cases_->show_session(session);
    for (auto* panel : panels_) {
        guarded("showing the study", [&] { panel->show_session(session); });
    }
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

void MainWindow::run_study() {
    if (!session_) {
        return;
    }
    jobs_->start("study", "computing", [this, session = session_](core::Progress& progress) {
        cases::RunOptions options;
        options.renderer = [](const core::Figure& figure) { return render_png(figure); };
        auto study = cases::Study::open(session->study.folder());
        auto results = cases::run_study(study, options, progress);
        auto newer = std::make_shared<const Session>(Session{std::move(study), std::move(results)});
        return [this, newer] {
            banner_->hide();
            show_session(newer);
            problems_->note(QString("Computed %1 steps, reused %2, failed %3")
                                .arg(newer->results.computed)
                                .arg(newer->results.reused)
                                .arg(newer->results.failed));
        };
    });
}

void MainWindow::reload() {
    if (session_) {
        open_study(session_->study.folder());
    }
}

void MainWindow::open_report() {
    fs::path report = session_->results.report;
    if (report.empty()) {
        report = session_->study.folder() / "report" / "index.html";
    }
    guarded("opening the report", [&] {
        if (!fs::exists(report)) {
            throw core::InputError("missing", "there is no report at " + report.string(), {},
                                   "make it: Study > Compute what changed (Ctrl+R)");
        }
        QDesktopServices::openUrl(QUrl::fromLocalFile(QString::fromStdString(fs::absolute(report).string())));
    });
}

void MainWindow::export_picture() {
    guarded("exporting a picture", [&] {
        if (!current()->has_picture()) {
            throw core::InputError("missing", "this panel shows no picture yet");
        }
        QString file = QFileDialog::getSaveFileName(this, "Export picture", {}, "Pictures (*.png *.pdf)");
        if (!file.isEmpty()) {
            file += QFileInfo(file).suffix().isEmpty() ? ".png" : "";
            current()->export_picture(file.toStdString());
            problems_->note("Wrote " + file);
        }
    });
}

void MainWindow::export_table() {
    guarded("exporting a table", [&] {
        if (!current()->has_table()) {
            throw core::InputError("missing", "this panel shows no table yet");
        }
        QString file = QFileDialog::getSaveFileName(this, "Export table", {}, "Tables (*.csv)");
        if (!file.isEmpty()) {
            file += QFileInfo(file).suffix().isEmpty() ? ".csv" : "";
            current()->export_table(file.toStdString());
            problems_->note("Wrote " + file);
        }
    });
}

void MainWindow::remember_study(const QString& folder) {
    if (!remember_) {
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
    if (remember_) {
        for (const auto& folder : QSettings().value("recent").toStringList()) {
            recent_->addAction(folder, this, [this, folder] { open_study(folder.toStdString()); });
        }
    }
    recent_->setEnabled(!recent_->isEmpty());
}

void MainWindow::show_about() {
    QMessageBox::about(this, "Underbody Studio",
                       "<h3>Underbody Studio " UNDERBODY_VERSION
                       "</h3><p>CFD post-processing and ground-effect design.</p>"
                       "<p>Free software under the GNU General Public License, version 3 or later.</p>"
                       "<p>What it shows, the libraries and the command <tt>underbody</tt> return too.</p>");
}

void MainWindow::closeEvent(QCloseEvent* event) {
    if (remember_) {
        QSettings settings;
        settings.setValue("geometry", saveGeometry());
        settings.setValue("layout", saveState());
        settings.setValue("panel", tabs_->currentIndex());
    }
    jobs_->cancel();
    event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    if (event->mimeData()->hasUrls()) {
        event->acceptProposedAction();
    }
}

void MainWindow::dropEvent(QDropEvent* event) {
    const auto urls = event->mimeData()->urls();
    if (urls.isEmpty()) {
        return;
    }
    const fs::path path = urls.front().toLocalFile().toStdString();
    if (fs::is_directory(path) || path.filename() == "study.toml") {
        open_study(path);
    } else {
        show_panel(body_);
        body_->show_file(path, {}, QString::fromStdString(path.filename().string()));
    }
}

}  // namespace underbody::studio
