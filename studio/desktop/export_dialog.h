// A force table for a controller: every format, with the file, its size and its error before it is written, and a
// proof.
#pragma once

#include <QDialog>
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
class QPushButton;
class QTimer;

namespace underbody::studio {

class PlotView;

class ExportDialog : public QDialog {
    Q_OBJECT
public:
    /// `of`: the table of the study that the first one is.
    ExportDialog(Jobs& jobs, std::vector<std::shared_ptr<const tables::ForceTable>> all, QWidget* parent,
                 TableOfStudy of = {});
    /// The command that writes the same.
    [[nodiscard]] QString command(const QString& path) const;
    /// Writes; throws core::Error.
    void write(const std::filesystem::path& path);
    /// As the button does: what stands in the way is said in the dialog.
    void write_to(const QString& path);
    /// Compiles what is written for C and compares it; the sentence that says how that went is in `proof`.
    void prove();
    [[nodiscard]] QString proof() const;
    [[nodiscard]] QString preview() const;
    [[nodiscard]] const PlotView* error() const { return error_; }

Q_SIGNALS:
    void written(const QString& command);
    /// What was written, and how; its table and digest are not known here.
    void exported(const QString& path, const ExportRecord& record);
    void failed(const QString& what, std::exception_ptr error);
    void proved(bool equal);

private:
    void build();
    void add_choices(QFormLayout& form);
    void add_policies(QFormLayout& form);
    void add_buttons(QBoxLayout& column);
    void refresh();
    void ask_preview(const tables::ExportOptions& wanted, const tables::ForceTable& chosen);
    void ask_proof(const tables::ExportOptions& wanted, const tables::ForceTable& chosen);
    void choose_and_write();
    [[nodiscard]] std::string format() const;
    [[nodiscard]] tables::ExportOptions options() const;
    /// The policies beyond its ends are those of the table.
    [[nodiscard]] bool as_fitted() const;
    /// The table with the chosen policies beyond its ends.
    [[nodiscard]] tables::ForceTable table() const;

    Jobs& jobs_;
    std::vector<std::shared_ptr<const tables::ForceTable>> all_;
    TableOfStudy of_;
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
    QLabel* command_ = nullptr;
    QTimer* soon_ = nullptr;
};

}  // namespace underbody::studio
