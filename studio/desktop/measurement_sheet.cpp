#include "studio/desktop/measurement_sheet.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QCompleter>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPointer>
#include <QPushButton>
#include <QSignalBlocker>
#include <set>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/state/known_things.h"
#include "studio/desktop/state/measured.h"
#include "studio/desktop/unit_sheet.h"

namespace underbody::studio {

namespace fs = std::filesystem;

namespace {

struct Asked {
    const char* quantity;
    const char* title;
    const char* unit;
};
/// What a run in time is judged by, and what acts on it. "time" is the clock.
const std::vector<Asked> asked = {{"time", "time", "s"},
                                  {"gap", "gap", "m"},
                                  {"heave_velocity", "heave velocity", "m/s"},
                                  {"pitch", "pitch, nose up", "rad"},
                                  {"input_force", "input force, up", "N"},
                                  {"jet_voltage", "jet voltage", "V"},
                                  {"speed", "speed", "m/s"}};

std::string name_of_field(const cases::MeasuredField& field) {
    return field.message.empty() ? field.field : field.message + "/" + field.field;
}

QString told(const core::Error& error) {
    const std::string place = error.place().text();
    return qt((place.empty() ? "" : place + ": ") + error.message() +
              (error.hint().empty() ? "" : "; " + error.hint()));
}

}  // namespace

MeasurementSheet::MeasurementSheet(Desk& desk, const std::vector<fs::path>& dropped, QWidget* parent)
    : QDialog(parent), desk_(desk), dropped_(dropped) {
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle("Measurements into the study");
    setObjectName("measurement_sheet");
    build();
    desk_.jobs().start(slot("fields"), "looking at what was dropped",
                       [sheet = QPointer<MeasurementSheet>(this), dropped](core::Progress& progress) {
                           std::vector<cases::MeasuredField> fields;
                           QString wrong;
                           try {
                               const auto files = cases::measured_files(dropped);
                               fields = files.empty() ? fields : cases::measured_fields(files.front(), progress);
                           } catch (const core::InputError& error) {
                               wrong = told(error);
                           }
                           return [sheet, fields, wrong] {
                               if (sheet && wrong.isEmpty()) {
                                   sheet->known_ = true;
                                   sheet->show_fields(fields);
                                   sheet->look();
                               } else if (sheet) {
                                   sheet->say(wrong, {});
                               }
                           };
                       });
}

void MeasurementSheet::build() {
    auto* column = new QVBoxLayout(this);
    QString names;
    for (const auto& path : dropped_) {
        names += (names.isEmpty() ? "" : ", ") + qt(path.filename().string());
    }
    auto* title = new QLabel("<b>" + names.toHtmlEscaped() + "</b>");
    title->setWordWrap(true);
    column->addWidget(title);
    auto* form = new QFormLayout;
    build_head(*form);
    column->addLayout(form);
    about_ = new QLabel;
    about_->setWordWrap(true);
    column->addWidget(about_);
    mapping_ = new QWidget;
    auto* grid = new QGridLayout(mapping_);
    grid->setContentsMargins(0, 0, 0, 0);
    build_rows(*grid);
    column->addWidget(mapping_);
    said_ = new QLabel;
    said_->setWordWrap(true);
    said_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    command_ = new QLabel;
    command_->setWordWrap(true);
    command_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    column->addWidget(said_);
    column->addWidget(command_);
    column->addStretch(1);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    take_ = buttons->addButton("&Take in and judge", QDialogButtonBox::AcceptRole);
    take_->setEnabled(false);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::accepted, this, &MeasurementSheet::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &MeasurementSheet::reject);
    setMinimumWidth(620);
}

void MeasurementSheet::build_head(QFormLayout& form) {
    name_ = new QLineEdit(qt(dropped_.front().stem().string()));
    name_->setAccessibleName("Name of the measurement");
    form.addRow("&Name", name_);
    model_ = new QComboBox;
    model_->setEditable(true);
    model_->setInsertPolicy(QComboBox::NoInsert);
    model_->setAccessibleName("Model that it is judged by");
    model_->setToolTip(
        "The residual is what is measured less what this model says. Under report/models stand the vehicles of the "
        "stability maps with the study's force tables, as the last run wrote them");
    for (const auto& one : desk_.session().study.regions) {  // the vehicle with the study's own forces comes first
        const auto composed = desk_.session().folder / "report" / "models" / one.name / "model.toml";
        if (!one.forces.empty() && std::filesystem::exists(composed)) {
            model_->addItem(qt(composed.string()));
        }
    }
    std::set<std::string> models;
    for (const auto& one : desk_.session().study.measurements) {
        models.insert(one.model.string());
    }
    for (const auto& one : desk_.session().study.regions) {
        models.insert(one.model.string());
    }
    for (const auto& one : models) {
        model_->addItem(qt(one));
    }
    model_->lineEdit()->setPlaceholderText("model.toml");
    form.addRow("&Model", model_);
    connect(name_, &QLineEdit::textEdited, this, &MeasurementSheet::look);
    connect(model_, &QComboBox::editTextChanged, this, &MeasurementSheet::look);
}

void MeasurementSheet::build_rows(QGridLayout& grid) {
    int column = 0;
    for (const char* heading : {"quantity", "field of the file", "its unit"}) {
        grid.addWidget(new QLabel("<b>" + QString(heading) + "</b>"), 0, column++);
    }
    grid.setColumnStretch(1, 1);
    int line = 1;
    for (const auto& one : asked) {
        Row row;
        row.field = new QComboBox;
        row.field->setEditable(true);
        row.field->setInsertPolicy(QComboBox::NoInsert);
        row.field->setModel(&names_);
        row.field->completer()->setFilterMode(Qt::MatchContains);
        row.field->completer()->setCompletionMode(QCompleter::PopupCompletion);
        row.field->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        row.field->setAccessibleName("Field that is the " + QString(one.title));
        row.unit = new QComboBox;
        row.unit->setEditable(true);
        row.unit->setInsertPolicy(QComboBox::NoInsert);
        row.unit->setAccessibleName("Unit of the " + QString(one.title));
        row.unit->addItem("");
        row.unit->addItems(usual_units(one.unit));
        row.unit->lineEdit()->setPlaceholderText("unit");
        auto* label = new QLabel(one.title);
        label->setBuddy(row.field);
        grid.addWidget(label, line, 0);
        grid.addWidget(row.field, line, 1);
        grid.addWidget(row.unit, line, 2);
        ++line;
        rows_[one.quantity] = row;
        connect(row.field, &QComboBox::editTextChanged, this, [this, quantity = std::string(one.quantity)] {
            const QString text = field_of(quantity)->currentText().trimmed();
            for (const auto& field : fields_) {
                if (qt(name_of_field(field)) == text && !field.unit.empty()) {  // the file says it
                    const QSignalBlocker quiet(unit_of(quantity));
                    unit_of(quantity)->setEditText("");
                    unit_of(quantity)->lineEdit()->setPlaceholderText(qt(field.unit) + ", as the file says");
                }
            }
            look();
        });
        connect(row.unit, &QComboBox::editTextChanged, this, &MeasurementSheet::look);
    }
}

void MeasurementSheet::show_row(const std::string& quantity, const std::string& field, const std::string& unit) {
    const Row& row = rows_.at(quantity);
    const QSignalBlocker quiet(row.field), quiet_unit(row.unit);
    row.field->setCurrentIndex(-1);
    row.field->setEditText(qt(field));
    row.unit->setEditText(qt(unit));
}

void MeasurementSheet::show_fields(const std::vector<cases::MeasuredField>& fields) {
    fields_ = fields;
    mapping_->setVisible(!fields.empty());
    const bool log = !fields.empty() && !fields.front().message.empty();
    about_->setText(fields.empty() ? QString("A data set: its dataset.toml says which field is which quantity.")
                    : log          ? QString("A log: say where the gap stands, and what else acts. Empty: not in it.")
                                   : QString("Empty: the column of the quantity's own name, where there is one."));
    QStringList names;
    std::set<std::string> own;
    for (const auto& field : fields) {
        names << qt(name_of_field(field));
        own.insert(name_of_field(field));
    }
    names_.setStringList(names);
    for (const auto& [quantity, row] : rows_) {
        row.field->lineEdit()->setPlaceholderText(quantity == "time" && log ? QString("the log's own time")
                                                  : own.contains(quantity)  ? QString("the column ") + qt(quantity)
                                                                            : QString("none"));
        show_row(quantity, "", "");
        for (const auto& field : fields) {
            if (name_of_field(field) == quantity && !field.unit.empty()) {
                row.unit->lineEdit()->setPlaceholderText(qt(field.unit) + ", as the file says");
            }
        }
    }
    for (const auto& channel : cases::guessed_channels(fields)) {
        show_row(channel.quantity, name_of_field({channel.message, channel.field, {}}), channel.unit);
    }
    const std::string clock = cases::guessed_clock(fields);
    const auto colon = clock.rfind(':');
    show_row("time", clock.substr(0, colon), colon == std::string::npos ? "" : clock.substr(colon + 1));
}

std::vector<std::string> MeasurementSheet::channels() const {
    std::vector<std::string> channels;
    for (const auto& one : asked) {
        std::string field = field_of(one.quantity)->currentText().trimmed().toStdString();
        const std::string unit = unit_of(one.quantity)->currentText().trimmed().toStdString();
        const bool own = std::any_of(fields_.begin(), fields_.end(), [&](const cases::MeasuredField& known) {
            return known.message.empty() && known.field == one.quantity;
        });
        if (field.empty() && !unit.empty() && own) {
            field = one.quantity;  // the unit that was chosen is of the column of that name
        }
        if (!field.empty() && std::string(one.quantity) != "time") {
            channels.push_back(std::string(one.quantity) + "=" + field + (unit.empty() ? "" : ":" + unit));
        }
    }
    return channels;
}

std::string MeasurementSheet::clock() const {
    const std::string field = field_of("time")->currentText().trimmed().toStdString();
    const std::string unit = unit_of("time")->currentText().trimmed().toStdString();
    return field + (field.empty() || unit.empty() ? "" : ":" + unit);
}

cases::NewMeasurement MeasurementSheet::wanted() const {
    cases::NewMeasurement wanted;
    wanted.name = name_->text().trimmed().toStdString();
    wanted.data = dropped_;
    wanted.model = model_->currentText().trimmed().toStdString();
    for (const auto& one : asked) {
        const std::string field = field_of(one.quantity)->currentText().trimmed().toStdString();
        const std::string unit = unit_of(one.quantity)->currentText().trimmed().toStdString();
        for (const auto& known : fields_) {
            if (name_of_field(known) == field && known.unit.empty() && unit.empty()) {
                throw core::InputError("unit", "the file does not say the unit of " + field + ", the " + one.title, {},
                                       "choose it");
            }
        }
        if (!unit.empty() && !(core::is_unit(unit) && core::same_dimension(unit, one.unit))) {
            throw core::InputError("unit", "'" + unit + "' is no unit of the " + one.title, {},
                                   usual_units(one.unit).join(", ").toStdString());
        }
    }
    for (const auto& text : channels()) {
        wanted.channels.push_back(cases::measured_channel(text));
    }
    const std::string when = clock();
    const auto colon = when.rfind(':');
    wanted.clock = when.substr(0, colon);
    wanted.clock_unit = colon == std::string::npos ? "" : when.substr(colon + 1);
    return wanted;
}

void MeasurementSheet::say(const QString& wrong, const QString& said) {
    wrong_ = wrong;
    take_->setEnabled(wrong.isEmpty());
    said_->setText(wrong.isEmpty() ? said : wrong);
    command_->setText(wrong.isEmpty() ? "<tt>" + qt(line_of(command())).toHtmlEscaped() + "</tt>" : QString());
}

void MeasurementSheet::look() {
    take_->setEnabled(false);
    if (!known_) {
        return;  // it is looked at when the fields are known
    }
    cases::NewMeasurement all;
    try {
        all = wanted();
    } catch (const core::Error& error) {
        desk_.jobs().cancel(slot("look"));
        say(told(error), {});
        return;
    }
    desk_.jobs().start(
        slot("look"), "reading measurements",
        [sheet = QPointer<MeasurementSheet>(this), folder = desk_.session().folder, all](core::Progress&) {
            QString wrong, said;
            try {
                said = qt(cases::with_new_measurement(folder, all).said);
            } catch (const core::Error& error) {
                wrong = told(error);
            }
            return [sheet, wrong, said] {
                if (sheet) {
                    sheet->say(wrong, said);
                }
            };
        });
}

MeasuredRecord MeasurementSheet::record() const {
    MeasuredRecord record;
    record.model = action::whole_path(model_->currentText().trimmed().toStdString());
    for (const auto& path : dropped_) {
        record.data.push_back(action::whole_path(path));
    }
    record.channels = channels();
    record.clock = clock();
    return record;
}

Words MeasurementSheet::command() const {
    return command_of_measurement(desk_.session().folder, name_->text().trimmed().toStdString(), record());
}

/// The action writes it: here is found whether it can be.
void MeasurementSheet::accept() {
    try {
        const auto all = wanted();
        static_cast<void>(cases::with_new_measurement(desk_.session().folder, all));
        if (desk_.act(words_of_measurement(all.name, record()))) {
            QDialog::accept();
        }
    } catch (...) {
        Q_EMIT failed("taking measurements in", std::current_exception());
    }
}

}  // namespace underbody::studio
