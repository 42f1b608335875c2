// What a file from outside the study does not say: units, half or whole body, its zones. Asked, never guessed.
#pragma once

#include <QDialog>
#include <filesystem>
#include <vector>

#include "postproc/field/unstated_units.h"
#include "studio/desktop/desk.h"

class QComboBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QPushButton;

namespace underbody::studio {

/// What people write for a quantity of this unit: the dimension's usual ones, else the unit itself.
QStringList usual_units(const std::string& unit);
/// Units of one kind to choose from, with a first line that chooses nothing where one is needed.
QComboBox* unit_choice(const postproc::UnstatedUnit& unit, QWidget* parent);

class UnitSheet : public QDialog {
    Q_OBJECT
public:
    UnitSheet(Desk& desk, QWidget* parent);
    /// Shows the sheet, not modal. A file that lacks the same as those that are asked for already is asked for with
    /// them.
    void ask(const std::filesystem::path& file, const std::vector<postproc::UnstatedUnit>& units);
    [[nodiscard]] const std::vector<std::filesystem::path>& files() const { return files_; }
    /// What is chosen as the action's words; empty while something needed is not chosen.
    [[nodiscard]] Words words() const;

public Q_SLOTS:
    void accept() override;

private:
    void lay_out();
    void follow();

    Desk& desk_;
    std::vector<std::filesystem::path> files_;
    std::vector<postproc::UnstatedUnit> units_;
    std::vector<QComboBox*> choices_;
    QFormLayout* form_ = nullptr;
    QLabel* about_ = nullptr;
    QComboBox* half_ = nullptr;
    QLineEdit* zones_ = nullptr;
    QLineEdit* density_ = nullptr;
    QPushButton* take_ = nullptr;
};

}  // namespace underbody::studio
