#include "studio/desktop/unit_sheet.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <algorithm>

#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

QStringList usual_units(const std::string& unit) {
    for (const QStringList& kind :
         {QStringList{"m", "mm", "cm", "um", "inch", "foot"}, QStringList{"Pa", "kPa", "MPa", "bar", "mbar", "psi"},
          QStringList{"m/s", "mm/s", "cm/s", "km/h", "foot/s"}, QStringList{"N", "mN", "lbf"},
          QStringList{"s", "ms", "us", "ns"}, QStringList{"rad", "deg"}, QStringList{"V", "mV"}}) {
        if (core::is_unit(unit) && core::same_dimension(unit, kind.front().toStdString())) {
            return kind;
        }
    }
    return {qt(unit)};
}

QComboBox* unit_choice(const postproc::UnstatedUnit& unit, QWidget* parent) {
    auto* choice = new QComboBox(parent);
    choice->setEditable(true);
    choice->setInsertPolicy(QComboBox::NoInsert);
    choice->addItem(unit.needed ? QString() : qt(unit.unit) + " (taken)", unit.needed ? QString() : qt(unit.unit));
    for (const auto& one : usual_units(unit.unit)) {
        if (unit.needed || one != qt(unit.unit)) {
            choice->addItem(one, one);
        }
    }
    choice->lineEdit()->setPlaceholderText("choose, or type a unit");
    choice->setAccessibleName(unit.variable.empty() ? "Unit of the coordinates" : "Unit of " + qt(unit.variable));
    choice->setToolTip("The file does not say it; a wrong one makes all numbers wrong");
    return choice;
}

UnitSheet::UnitSheet(Desk& desk, QWidget* parent) : QDialog(parent), desk_(desk) {
    setWindowTitle("What the file does not say");
    setObjectName("unit_sheet");
    auto* column = new QVBoxLayout(this);
    about_ = new QLabel;
    about_->setWordWrap(true);
    column->addWidget(about_);
    form_ = new QFormLayout;
    column->addLayout(form_);
    auto* more = new QFormLayout;
    half_ = new QComboBox;
    half_->setAccessibleName("Half model");
    half_->addItem("as the study, else the whole body", "");
    half_->addItem("the whole body", "none");
    for (const char* axis : {"y", "x", "z"}) {
        half_->addItem(QString("half, its plane across %1").arg(axis), axis);
    }
    more->addRow("The body is", half_);
    zones_ = new QLineEdit;
    zones_->setAccessibleName("Zones of the body");
    zones_->setPlaceholderText("all walls; or names with commas, * and ?: hull*,base");
    more->addRow("Its zones", zones_);
    density_ = new QLineEdit;
    density_->setAccessibleName("Density");
    density_->setPlaceholderText("as the study or the file says; or 998 kg/m^3");
    density_->setToolTip("Of the water; needed for files that hold pressure over density (OpenFOAM)");
    connect(density_, &QLineEdit::textChanged, this, &UnitSheet::follow);
    more->addRow("Density", density_);
    column->addLayout(more);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    take_ = buttons->addButton("&Read it so", QDialogButtonBox::AcceptRole);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::accepted, this, &UnitSheet::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &UnitSheet::reject);
    connect(this, &QDialog::finished, this, [this] { files_.clear(); });
    setMinimumWidth(460);
}

void UnitSheet::ask(const std::filesystem::path& file, const std::vector<postproc::UnstatedUnit>& units) {
    const bool asked = std::find(files_.begin(), files_.end(), file) != files_.end();
    if (!isVisible() || !(units == units_)) {
        files_ = {file};
        units_ = units;
        lay_out();
    } else if (!asked) {
        files_.push_back(file);
    }
    QString names;
    for (const auto& one : files_) {
        names += (names.isEmpty() ? "" : ", ") + html(one.filename().string());
    }
    about_->setText("<b>" + names + "</b>" +
                    (units_.empty() ? "<br>All units are stated." : "<br>The units of these are not stated:"));
    follow();
    show();
    raise();
}

void UnitSheet::lay_out() {
    while (form_->rowCount() > 0) {
        form_->removeRow(0);
    }
    choices_.clear();
    for (const auto& unit : units_) {
        auto* choice = unit_choice(unit, this);
        form_->addRow(unit.variable.empty() ? QString("Coordinates") : qt(unit.variable), choice);
        connect(choice, &QComboBox::currentTextChanged, this, &UnitSheet::follow);
        choices_.push_back(choice);
    }
    const auto said = desk_.state().readings.find(files_.front().string());
    if (said == desk_.state().readings.end()) {
        return;
    }
    const FileReading& reading = said->second;
    for (std::size_t i = 0; i < units_.size(); ++i) {
        const auto unit = reading.units.find(units_[i].variable);
        choices_[i]->setCurrentText(units_[i].variable.empty()    ? qt(reading.length_unit)
                                    : unit != reading.units.end() ? qt(unit->second)
                                                                  : QString());
    }
    if (half_->findData(qt(reading.symmetry)) < 0) {
        half_->addItem("half, its plane at " + qt(reading.symmetry), qt(reading.symmetry));
    }
    half_->setCurrentIndex(half_->findData(qt(reading.symmetry)));
    density_->setText(reading.density ? qt(core::format_number(*reading.density) + " kg/m^3") : QString());
    QStringList zones;
    for (const auto& zone : reading.zones) {
        zones << qt(zone);
    }
    zones_->setText(zones.join(","));
}

Words UnitSheet::words() const {
    Words words = {"read"};
    for (const auto& file : files_) {
        words.push_back(file.string());
    }
    for (std::size_t i = 0; i < units_.size(); ++i) {
        const int at = choices_[i]->findText(choices_[i]->currentText());
        const std::string unit = at >= 0 ? choices_[i]->itemData(at).toString().toStdString()
                                         : choices_[i]->currentText().trimmed().toStdString();
        const std::string like = units_[i].variable.empty() ? "m" : units_[i].unit;
        if (unit.empty() || !core::is_unit(unit) || !core::same_dimension(unit, like)) {
            return {};
        }
        words.push_back((units_[i].variable.empty() ? "length_unit" : "unit." + units_[i].variable) + "=" + unit);
    }
    const std::string density = density_->text().trimmed().toStdString();
    if (!density.empty()) {
        try {
            static_cast<void>(core::parse_in(density, "kg/m^3"));
        } catch (const core::Error&) {
            return {};
        }
    }
    words.push_back("density=" + density);
    words.push_back("symmetry=" + half_->currentData().toString().toStdString());
    words.push_back("zones=" + zones_->text().trimmed().toStdString());
    return words;
}

void UnitSheet::follow() { take_->setEnabled(!words().empty()); }

void UnitSheet::accept() {
    if (const Words all = words(); !all.empty() && desk_.act(all)) {
        QDialog::accept();
    }
}

}  // namespace underbody::studio
