// Measurements that were dropped become a [[measurement]] of the study: which field is which quantity and in which unit
// is asked where the file does not say, and the command that does the same stands below. Nothing is written before
// "Take in".
#pragma once

#include <QDialog>
#include <QStringListModel>
#include <filesystem>
#include <map>
#include <vector>

#include "cases/add_measurement.h"
#include "studio/desktop/desk.h"

class QComboBox;
class QFormLayout;
class QGridLayout;
class QLabel;
class QLineEdit;
class QPushButton;

namespace underbody::studio {

class MeasurementSheet : public QDialog {
    Q_OBJECT
public:
    MeasurementSheet(Desk& desk, const std::vector<std::filesystem::path>& dropped, QWidget* parent);

    [[nodiscard]] QLineEdit* name() const { return name_; }
    [[nodiscard]] QComboBox* model() const { return model_; }
    /// Where a quantity stands ("RFND/Dist", "rng_cm"; empty: nowhere, or under its own name), and its unit there.
    /// "time" is the clock.
    [[nodiscard]] QComboBox* field_of(const std::string& quantity) const { return rows_.at(quantity).field; }
    [[nodiscard]] QComboBox* unit_of(const std::string& quantity) const { return rows_.at(quantity).unit; }
    /// `underbody study add ... --data ...`
    [[nodiscard]] Words command() const;
    /// What is missing or wrong; empty: it can be taken in. As of the last look, which follows what is typed.
    [[nodiscard]] QString wrong() const { return wrong_; }

public Q_SLOTS:
    void accept() override;

Q_SIGNALS:
    void failed(const QString& what, std::exception_ptr error);

private:
    struct Row {
        QComboBox* field = nullptr;
        QComboBox* unit = nullptr;
    };
    [[nodiscard]] MeasuredRecord record() const;
    void build();
    void build_head(QFormLayout& form);
    void build_rows(QGridLayout& grid);
    /// What the first file holds, and what its names tell.
    void show_fields(const std::vector<cases::MeasuredField>& fields);
    void show_row(const std::string& quantity, const std::string& field, const std::string& unit);
    /// Reads the data as they would be taken, beside the window.
    void look();
    void say(const QString& wrong, const QString& said);
    [[nodiscard]] cases::NewMeasurement wanted() const;
    [[nodiscard]] std::vector<std::string> channels() const;
    [[nodiscard]] std::string clock() const;
    /// Of the jobs of this sheet alone.
    [[nodiscard]] QString slot(const char* what) const {
        return QString("measurement %1 %2").arg(reinterpret_cast<quintptr>(this)).arg(what);
    }

    Desk& desk_;
    std::vector<std::filesystem::path> dropped_;
    std::vector<cases::MeasuredField> fields_;
    QStringListModel names_;  ///< of the fields, for all rows
    std::map<std::string, Row> rows_;
    bool known_ = false;  ///< the fields are
    QString wrong_ = "looking at the data";
    QLineEdit* name_ = nullptr;
    QComboBox* model_ = nullptr;
    QWidget* mapping_ = nullptr;
    QLabel* about_ = nullptr;
    QLabel* said_ = nullptr;
    QLabel* command_ = nullptr;
    QPushButton* take_ = nullptr;
};

}  // namespace underbody::studio
