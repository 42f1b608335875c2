// The window: the study on the left, workspaces in the middle, commands, problems, jobs and history below.
#pragma once

#include <QMainWindow>
#include <filesystem>
#include <functional>
#include <vector>

#include "studio/desktop/desk.h"

class QActionGroup;
class QDockWidget;
class QFileSystemWatcher;
class QLabel;
class QMenu;
class QProgressBar;
class QStackedWidget;
class QTabWidget;
class QToolButton;

namespace underbody::tables {
class ForceTable;
}

namespace underbody::studio {

struct ExportRecord;
struct TableOfStudy;
class Banner;
class ExportDialog;
class FirstPage;
class MeasurementSheet;
class Panel;
class ProblemList;
class StudyTree;
class TableSheet;
class TakeInSheet;

class MainWindow : public QMainWindow {
    Q_OBJECT
public:
    /// `remember`: window layout, recent studies and the log of the session are kept between starts.
    explicit MainWindow(bool remember);
    /// What a new window is made as large as, on a screen that leaves it so much.
    [[nodiscard]] static QSize first_size(const QSize& available);
    ~MainWindow() override;

    /// Opens a study folder in the background; what is wrong with it is shown, and the study that was open stays.
    void open_study(const std::filesystem::path& folder) { desk_->open_study(folder); }
    [[nodiscard]] bool has_study() const { return desk_->has_study(); }
    [[nodiscard]] Desk& desk() { return *desk_; }
    [[nodiscard]] Jobs& jobs() { return *jobs_; }
    [[nodiscard]] const std::vector<Panel*>& panels() const { return panels_; }
    /// What was dropped or named on the command line, by its content: a study, sessions and logs, shapes, CFD files.
    void take_files(const std::vector<std::filesystem::path>& files);
    /// A sheet that makes cases of a study out of CFD files and folders of them; it deletes itself.
    TakeInSheet* take_in(const std::vector<std::filesystem::path>& files);
    /// A sheet that makes a table of forces of the study's cases; it deletes itself. Throws core::InputError when no
    /// study is open.
    TableSheet* make_table();
    /// A sheet that makes a measurement of the study out of data sets, logs and tables. Throws core::InputError when no
    /// study is open.
    MeasurementSheet* take_measurements(const std::vector<std::filesystem::path>& data);
    /// Asks whether to go on where a program that was not closed properly stopped.
    void offer_recovery();
    /// Says that something (`what`: the work that was asked for) failed, and why.
    void show_failure(const QString& what, const std::exception_ptr& error);
    /// The last error that was shown, for a start without anybody at the window.
    [[nodiscard]] QString last_error() const { return last_error_; }
    /// Writes to a path that somebody chose: adds the ending, asks before it replaces a file. False when it was not
    /// written.
    bool write_chosen(QString path, const QStringList& endings,
                      const std::function<void(const std::filesystem::path&)>& write);

    /// Where files are written: into the folder of the study, until another one was chosen.
    [[nodiscard]] QString write_folder() const;
    /// A force table for a controller, in a dialog of its own that deletes itself.
    ExportDialog* show_export(const std::shared_ptr<const tables::ForceTable>& table, const TableOfStudy& of);

    /// Adds the shape that Design shows to the study's sweep under a name; asks first, with the cost. False when it was
    /// not added. Throws core::Error.
    bool add_to_sweep(const std::string& name);

    /// Writes the shape that Design shows, with its changes, as a SHAPE.toml. Throws core::Error.
    void write_shown_shape(const std::filesystem::path& path);

    /// Writes the exported files again whose table has changed since, or that are gone; asks before it replaces what
    /// others have written.
    void export_stale();
    /// Writes each marked table into a folder, in the way of `how`; asks likewise. False when nothing is written.
    bool write_marked(const ExportRecord& how, const std::filesystem::path& folder);

    /// Copies the found model of a measurement into the study and names it there; asks first. False when it was not
    /// written. Throws core::Error.
    bool write_found_model(const std::string& measurement);

    /// Asks the person; replaced where nobody is there. Title, text, what "yes" does.
    std::function<bool(const QString& title, const QString& text, const QString& yes)> ask;

protected:
    void showEvent(QShowEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void closeEvent(QCloseEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;

private:
    [[nodiscard]] QSize needed() const;
    void make_room();
    /// Of a dock, px: what it gave away for the workspace, and what it kept.
    struct GivenRoom {
        int by = 0, left = 0;
    };
    GivenRoom tree_gave_, below_gave_;
    void build_workspaces();
    void build_tree();
    void build_below();
    void build_status();
    void cancel_first();
    void build_tool_bar();
    void build_file_menu();
    void build_edit_menu();
    void build_study_menu();
    void build_view_menu();
    void fill_views();
    void build_help_menu();
    QAction* add(QMenu* menu, const QString& text, const QString& key, const std::function<void()>& act);
    void follow_state();
    void follow_session();
    void watch_files();
    void take_in_what_is_shown();
    void compare_files(const std::vector<std::filesystem::path>& files, bool remembered);
    void forget_files_of(const cases::Study& study);
    void open_report();
    void export_picture();
    void export_table();
    void export_controller();
    struct EndedExports;
    bool write_exports(const std::vector<std::pair<std::string, ExportRecord>>& files);
    void show_exports(const EndedExports& ended, std::size_t of, const std::filesystem::path& study);
    bool keep_exports(const std::vector<std::pair<std::string, ExportRecord>>& files,
                      const std::filesystem::path& study);
    void ask_for_cfd();
    void say_what_is_stale();
    void save_session(bool elsewhere);
    void save_shape();
    [[nodiscard]] QString proposed_file(const QString& ending) const;
    [[nodiscard]] QString ask_path(const QString& title, const QString& name, const QString& filter);
    void copy_picture();
    void guarded(const QString& what, const std::function<void()>& work);
    void remember_study(const QString& folder);
    void fill_recent();
    void show_about();
    [[nodiscard]] Panel* current() const;
    [[nodiscard]] QString pictures_folder() const;

    bool remember_;
    bool laid_out_ = false;
    QString last_error_;
    QString session_file_;
    std::map<std::filesystem::path, QString> written_into_;  ///< by study: where a file was written last
    Jobs* jobs_ = nullptr;
    Desk* desk_ = nullptr;
    QStackedWidget* middle_ = nullptr;
    FirstPage* first_ = nullptr;
    StudyTree* tree_ = nullptr;
    ProblemList* problems_ = nullptr;
    Banner* banner_ = nullptr;
    std::vector<Panel*> panels_;
    QDockWidget* tree_dock_ = nullptr;
    QDockWidget* below_dock_ = nullptr;
    QTabWidget* below_ = nullptr;
    QFileSystemWatcher* watcher_ = nullptr;
    QProgressBar* bar_ = nullptr;
    QLabel* doing_ = nullptr;
    QToolButton* cancel_ = nullptr;
    QMenu* recent_ = nullptr;
    QMenu* views_ = nullptr;
    QActionGroup* workspaces_ = nullptr;
    QAction* undo_ = nullptr;
    QAction* redo_ = nullptr;
    std::vector<QAction*> need_study_;
};

}  // namespace underbody::studio
