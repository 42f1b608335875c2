// The window: cases on the left, panels in the middle, problems below, progress in the status bar.
#pragma once

#include <QMainWindow>
#include <filesystem>
#include <vector>

#include "studio/desktop/session.h"

class QAction;
class QDockWidget;
class QLabel;
class QMenu;
class QProgressBar;
class QTabWidget;
class QToolButton;

namespace underbody::studio {

class Banner;
class BodyPanel;
class CasesTree;
class Jobs;
class Panel;
class ProblemList;

class MainWindow : public QMainWindow {
    Q_OBJECT
public:
    /// `remember`: window layout and recent studies are kept between starts.
    explicit MainWindow(bool remember);
    ~MainWindow() override;

    /// Opens a study folder in the background; what is wrong with it is shown, and the study that was open stays.
    void open_study(const std::filesystem::path& folder);
    [[nodiscard]] bool has_study() const { return session_ != nullptr; }
    [[nodiscard]] Jobs& jobs() { return *jobs_; }
    [[nodiscard]] const std::vector<Panel*>& panels() const { return panels_; }
    void show_panel(Panel* panel);
    /// The last error that was shown, for a start without anybody at the window.
    [[nodiscard]] QString last_error() const { return last_error_; }

protected:
    void closeEvent(QCloseEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;

private:
    void build_panels();
    void build_cases();
    void build_status();
    void build_file_menu();
    void build_study_menu();
    void build_view_menu();
    void build_help_menu();
    void show_session(const SessionPointer& session);
    void show_failure(const QString& what, const std::exception_ptr& error);
    void run_study();
    void reload();
    void open_report();
    void export_picture();
    void export_table();
    void guarded(const QString& what, const std::function<void()>& work);
    void remember_study(const QString& folder);
    void fill_recent();
    void show_about();
    [[nodiscard]] Panel* current() const;

    bool remember_;
    SessionPointer session_;
    QString last_error_;
    Jobs* jobs_ = nullptr;
    QTabWidget* tabs_ = nullptr;
    CasesTree* cases_ = nullptr;
    ProblemList* problems_ = nullptr;
    Banner* banner_ = nullptr;
    BodyPanel* body_ = nullptr;
    std::vector<Panel*> panels_;
    QDockWidget* cases_dock_ = nullptr;
    QDockWidget* problems_dock_ = nullptr;
    QProgressBar* bar_ = nullptr;
    QLabel* doing_ = nullptr;
    QToolButton* cancel_ = nullptr;
    QMenu* recent_ = nullptr;
    QAction* run_ = nullptr;
    QAction* reload_ = nullptr;
    QAction* report_ = nullptr;
    QAction* picture_ = nullptr;
    QAction* table_ = nullptr;
};

}  // namespace underbody::studio
