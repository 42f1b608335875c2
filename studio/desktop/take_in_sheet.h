// A folder of CFD files becomes cases of a study: the pattern with conditions that their names show, what the files do
// not say, and the command that does the same. Nothing is written before "Take in".
#pragma once

#include <QDialog>
#include <filesystem>
#include <vector>

#include "cases/add_cases.h"
#include "postproc/field/unstated_units.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/state/words.h"

class QComboBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QListWidget;
class QPushButton;
class QTableWidget;

namespace underbody::studio {

class TakeInSheet : public QDialog {
    Q_OBJECT
public:
    /// `study`: folder of the study that gets the cases, or of a new one.
    TakeInSheet(Jobs& jobs, std::filesystem::path study, const std::vector<std::filesystem::path>& dropped,
                QWidget* parent);

    [[nodiscard]] QLineEdit* pattern() const { return pattern_; }
    [[nodiscard]] QLineEdit* conditions() const { return conditions_; }
    [[nodiscard]] QTableWidget* files() const { return files_; }
    [[nodiscard]] QComboBox* half() const { return half_; }
    [[nodiscard]] const std::vector<QComboBox*>& units() const { return choices_; }
    /// The study with them, once they are taken in.
    [[nodiscard]] const cases::Study& taken_in() const { return taken_in_; }
    /// `underbody study add ...`
    [[nodiscard]] Words command() const;
    /// What is wrong with what stands there; empty: it can be taken in.
    [[nodiscard]] QString wrong() const;

public Q_SLOTS:
    /// Writes study.toml and tells `taken`.
    void accept() override;

Q_SIGNALS:
    void taken(const QString& study, const QString& command, int cases);
    void failed(const QString& what, std::exception_ptr error);

private:
    struct Found {
        std::vector<std::string> names;  ///< of CFD files, relative to the study
        std::string pattern;
        std::vector<std::string> zones;  ///< of the first that can be read
        std::vector<postproc::UnstatedUnit> units;
        QString remark;
    };
    static Found look(const std::filesystem::path& study, const std::vector<std::filesystem::path>& dropped,
                      core::Progress& progress);
    void build();
    void take(const Found& found);
    void follow();
    [[nodiscard]] cases::NewCases wanted() const;

    Jobs& jobs_;
    std::filesystem::path study_;
    std::vector<std::string> names_;
    std::vector<postproc::UnstatedUnit> unstated_;
    std::vector<QComboBox*> choices_;
    cases::Study taken_in_;
    QLineEdit* pattern_ = nullptr;
    QLineEdit* conditions_ = nullptr;
    QTableWidget* files_ = nullptr;
    QComboBox* half_ = nullptr;
    QListWidget* zones_ = nullptr;
    QFormLayout* form_ = nullptr;
    QLabel* said_ = nullptr;
    QLabel* command_ = nullptr;
    QPushButton* take_ = nullptr;
    bool looked_ = false;
};

}  // namespace underbody::studio
