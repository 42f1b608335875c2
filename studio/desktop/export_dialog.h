// A force table for a controller: every format, with the file, its size and its error before it is written, and a
// proof.
#pragma once

#include <QDialog>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "studio/desktop/jobs.h"
#include "studio/desktop/state/exports.h"
#include "surrogates/tables/exports/export.h"

class QBoxLayout;
class QCheckBox;
class QComboBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QPlainTextEdit;
class QProgressBar;
class QPushButton;
class QTimer;

namespace underbody::studio {

class PlotView;

class ExportDialog : public QDialog {
    Q_OBJECT
public:
    /// The table with other policies beyond its ends (axis -> policy; none: its own). Runs in a job.
    using Make = std::function<tables::ForceTable(const std::map<std::string, std::string>& range, core::Progress&)>;
    /// `of`: the table of the study that it is. `make`: how it is made; not said: fitted again to its points.
    ExportDialog(Jobs& jobs, std::shared_ptr<const tables::ForceTable> table, QWidget* parent, TableOfStudy of = {},
                 Make make = {});
    /// The command that writes the same.
    [[nodiscard]] QString command(const QString& path) const;
    /// Writes in a job, which goes on when the dialog is closed; throws core::Error where the choices are wrong.
    void write(const std::filesystem::path& path);
    /// As the button does: what stands in the way is said in the dialog.
    void write_to(const QString& path);
    /// Compiles what is written for C and compares it; the sentence that says how that went is in `proof`.
    void prove();
    [[nodiscard]] QString proof() const;
    [[nodiscard]] QString preview() const;
    [[nodiscard]] const PlotView* error() const { return error_; }
    /// Tables of the study that *Write all marked* writes as this one is.
    void set_marked(const QStringList& tables);
    /// Where *Write* begins to ask; from then on where it wrote.
    void set_folder(const QString& folder) { folder_ = folder; }
    /// What is chosen. Throws core::Error.
    [[nodiscard]] ExportRecord record() const;

Q_SIGNALS:
    void written(const QString& path, const QString& command);
    /// What was written, and how; its table and digest are not known here.
    void exported(const QString& path, const ExportRecord& record);
    void failed(const QString& what, std::exception_ptr error);
    /// All marked tables are to be written as this one.
    void all_wanted(const ExportRecord& how);
    void proved(bool equal);

private:
    struct Ended;
    void build();
    void add_choices(QFormLayout& form);
    void add_policies(QFormLayout& form);
    void add_buttons(QBoxLayout& column);
    void refresh();
    void ask_preview(const tables::ExportOptions& wanted);
    void ask_proof(const tables::ExportOptions& wanted);
    void show_proof_running();
    void show_written(const QString& path, const Ended& ended, const QString& line);
    /// Of the jobs of this dialog alone.
    [[nodiscard]] QString slot(const char* work) const;
    void choose_and_write();
    [[nodiscard]] std::string format() const;
    [[nodiscard]] tables::ExportOptions options() const;
    /// The policies beyond its ends are those of the table.
    [[nodiscard]] bool as_fitted() const;
    /// The chosen policies beyond its ends; none: its own.
    [[nodiscard]] std::map<std::string, std::string> range() const;

    Jobs& jobs_;
    std::shared_ptr<const tables::ForceTable> table_;
    TableOfStudy of_;
    Make make_;
    QComboBox* format_ = nullptr;
    QLineEdit* name_ = nullptr;
    QComboBox* frame_ = nullptr;
    QCheckBox* single_ = nullptr;
    QLineEdit* max_error_ = nullptr;
    std::vector<std::pair<std::string, QComboBox*>> policies_;
    QPlainTextEdit* text_ = nullptr;
    QLabel* facts_ = nullptr;
    QLabel* proof_ = nullptr;
    PlotView* error_ = nullptr;  ///< along the table's first axis; hidden where the file equals the table
    QPushButton* prove_ = nullptr;
    QPushButton* write_all_ = nullptr;
    QProgressBar* proving_ = nullptr;
    QLabel* command_ = nullptr;
    QTimer* soon_ = nullptr;
    QString folder_;
    int writing_ = 0;  ///< files that are being written
    bool closed_ = false;
};

}  // namespace underbody::studio
