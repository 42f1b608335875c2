#include "studio/desktop/take_in_sheet.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPointer>
#include <QPushButton>
#include <QTableWidget>
#include <algorithm>

#include "cases/case_loads.h"
#include "cases/guess_pattern.h"
#include "core/error.h"
#include "core/name_pattern.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/importer.h"
#include "postproc/loads/half_model.h"
#include "postproc/loads/loads.h"
#include "studio/desktop/natural_order.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/unit_sheet.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_files = 5000;

/// CFD files among what was dropped, folders with what lies in them; an OpenFOAM case is one, and not looked into.
void gather(const fs::path& path, std::vector<fs::path>& found, core::Progress& progress) {
    progress.check();
    if (found.size() >= most_files || path.filename().string().starts_with('.')) {
        return;
    }
    const bool folder = fs::is_directory(path);
    if (postproc::importer_for(path) != nullptr) {
        found.push_back(path);
    } else if (folder) {
        std::vector<fs::path> inside;
        for (const auto& entry : fs::directory_iterator(path)) {
            inside.push_back(entry.path());
        }
        std::sort(inside.begin(), inside.end(),
                  [](const fs::path& a, const fs::path& b) { return natural_less(qt(a.string()), qt(b.string())); });
        for (const auto& one : inside) {
            gather(one, found, progress);
        }
    }
}

/// What makes its loads less than they seem, before it is taken in: half of a model, most of all.
QString warnings_of(const postproc::Field& field, const fs::path& study, const std::string& name,
                    core::Progress& progress) {
    QString text;
    try {
        postproc::LoadsOptions options;
        if (fs::exists(study / "study.toml")) {  // up, forward and symmetry are the study's
            options = cases::loads_options(cases::Study::open(study), {});
        }
        const auto loads = postproc::loads(field, options, progress);
        for (const auto& problem : loads.problems) {
            if (problem.severity == core::Problem::Severity::warning) {
                text += "\n" + qt(name + ": " + problem.message);
            }
        }
        text.replace(qt(postproc::half_model_advice(loads.cut_across)),
                     "a half model? then choose 'half, its plane across " + qt(loads.cut_across) + "' below");
    } catch (const core::Error&) {  // said when it is computed, with what the sheet was told
    }
    return text;
}

}  // namespace

TakeInSheet::TakeInSheet(Jobs& jobs, fs::path study, const std::vector<fs::path>& dropped, QWidget* parent)
    : QDialog(parent), jobs_(jobs), study_(fs::absolute(study / "x").lexically_normal().parent_path()) {
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle("Take CFD files into a study");
    setObjectName("take_in_sheet");
    build();
    resize(820, 620);
    jobs_.start("take in", "looking at what was dropped",
                [this, sheet = QPointer<TakeInSheet>(this), study = study_, dropped](core::Progress& progress) {
                    const auto found = look(study, dropped, progress);
                    return [sheet, found] {
                        if (sheet) {
                            sheet->take(found);
                        }
                    };
                });
}

void TakeInSheet::build() {
    auto* column = new QVBoxLayout(this);
    said_ = new QLabel("Looking at the files …");
    said_->setWordWrap(true);
    column->addWidget(said_);
    form_ = new QFormLayout;
    pattern_ = new QLineEdit;
    pattern_->setAccessibleName("Pattern of the names");
    pattern_->setToolTip("{gap:mm} takes a number in mm, {variant} a word, * anything; the rest stands as it is");
    form_->addRow("&Names", pattern_);
    conditions_ = new QLineEdit;
    conditions_->setAccessibleName("Conditions of all of them");
    conditions_->setPlaceholderText("what the names do not say, of all of them: speed=0.5m/s, mesh=fine");
    form_->addRow("&Conditions", conditions_);
    half_ = new QComboBox;
    half_->setAccessibleName("Half model");
    half_->addItem("whole, or as the study has it", "");
    for (const char* axis : {"y", "x", "z"}) {
        half_->addItem(QString("half, its plane across %1").arg(axis), axis);
    }
    form_->addRow("The &bodies are", half_);
    column->addLayout(form_);
    auto* row = new QHBoxLayout;
    files_ = new QTableWidget;
    files_->setAccessibleName("Files and their conditions");
    files_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    files_->verticalHeader()->hide();
    row->addWidget(files_, 4);
    auto* right = new QVBoxLayout;
    right->addWidget(new QLabel("Zones of the body (none ticked: all walls)"));
    zones_ = new QListWidget;
    zones_->setAccessibleName("Zones of the body");
    right->addWidget(zones_, 1);
    row->addLayout(right, 2);
    column->addLayout(row, 1);
    command_ = new QLabel;
    command_->setWordWrap(true);
    command_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    column->addWidget(command_);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    take_ = buttons->addButton("&Take in and compute", QDialogButtonBox::AcceptRole);
    take_->setEnabled(false);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::accepted, this, &TakeInSheet::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &TakeInSheet::reject);
    connect(pattern_, &QLineEdit::textChanged, this, &TakeInSheet::follow);
    connect(conditions_, &QLineEdit::textChanged, this, &TakeInSheet::follow);
    connect(half_, QOverload<int>::of(&QComboBox::activated), this, &TakeInSheet::follow);
    connect(zones_, &QListWidget::itemChanged, this, &TakeInSheet::follow);
}

TakeInSheet::Found TakeInSheet::look(const fs::path& study, const std::vector<fs::path>& dropped,
                                     core::Progress& progress) {
    std::vector<fs::path> files;
    for (const auto& path : dropped) {
        gather(fs::absolute(path).lexically_normal(), files, progress);
    }
    std::sort(files.begin(), files.end(),
              [](const fs::path& a, const fs::path& b) { return natural_less(qt(a.string()), qt(b.string())); });
    Found found;
    for (const auto& file : files) {
        found.names.push_back(file.lexically_relative(study).generic_string());
    }
    const auto guessed = cases::guess_pattern(found.names);
    found.pattern = guessed.pattern;
    if (files.empty()) {
        found.remark = "No file that Underbody can read lies there.";
    }
    for (const auto& name : guessed.fitting) {
        try {
            postproc::ReadOptions reading;
            reading.surfaces_only = true;
            found.units = postproc::unstated_units(study / name, reading, progress);
            for (const auto& unit : found.units) {
                if (unit.variable.empty()) {
                    reading.length_unit = unit.unit;
                } else {
                    reading.units.emplace_back(unit.variable, unit.unit);
                }
            }
            const auto field = postproc::read_field(study / name, reading, progress);
            for (const auto& zone : field.zones) {
                if (zone.surface && zone.surface->GetNumberOfCells() > 0) {
                    found.zones.push_back(zone.name);
                }
            }
            found.remark += warnings_of(field, study, name, progress);
            return found;
        } catch (const core::InputError& error) {
            found.remark += (found.remark.isEmpty() ? "" : "\n") + qt(name + " cannot be read: " + error.message());
        }
    }
    return found;
}

void TakeInSheet::take(const Found& found) {
    names_ = found.names;
    unstated_ = found.units;
    looked_ = true;
    for (const auto& unit : unstated_) {
        auto* choice = unit_choice(unit, this);
        form_->addRow(unit.variable.empty() ? QString("Unit of lengths") : "Unit of " + qt(unit.variable), choice);
        connect(choice, &QComboBox::currentTextChanged, this, &TakeInSheet::follow);
        choices_.push_back(choice);
    }
    for (const auto& zone : found.zones) {
        auto* item = new QListWidgetItem(qt(zone), zones_);
        item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsUserCheckable | Qt::ItemIsSelectable);
        item->setCheckState(Qt::Unchecked);
    }
    said_->setText(found.remark.isEmpty() ? QString("%1 CFD files").arg(names_.size())
                                          : QString("%1 CFD files. ").arg(names_.size()) + found.remark);
    pattern_->setText(qt(found.pattern));
    follow();
}

cases::NewCases TakeInSheet::wanted() const {
    cases::NewCases cases;
    cases.files = pattern_->text().trimmed().toStdString();
    cases.symmetry = half_->currentData().toString().toStdString();
    const std::string conditions = conditions_->text().toStdString();  // what is split are views of it
    for (const auto part : core::split(conditions, ',')) {
        const std::string text(core::trimmed(part));
        const auto equal = text.find('=');
        if (text.empty()) {
            continue;
        }
        if (equal == std::string::npos || equal == 0) {
            throw core::UsageError("parse", "'" + text + "' is not of the form name=value", {}, "speed=0.5m/s");
        }
        cases.conditions.emplace_back(core::trimmed(std::string_view(text).substr(0, equal)),
                                      core::trimmed(std::string_view(text).substr(equal + 1)));
    }
    for (int i = 0; i < zones_->count(); ++i) {
        if (zones_->item(i)->checkState() == Qt::Checked) {
            cases.zones.push_back(zones_->item(i)->text().toStdString());
        }
    }
    for (std::size_t i = 0; i < unstated_.size(); ++i) {
        const int at = choices_[i]->findText(choices_[i]->currentText());
        const std::string unit = at >= 0 ? choices_[i]->itemData(at).toString().toStdString()
                                         : choices_[i]->currentText().trimmed().toStdString();
        const std::string& variable = unstated_[i].variable;
        if (unit.empty() && unstated_[i].needed) {
            throw core::UsageError("missing",
                                   "the files do not say the unit of " +
                                       (variable.empty() ? std::string("lengths") : "'" + variable + "'"),
                                   {}, "choose it above");
        }
        if (variable.empty()) {
            cases.length_unit = !unstated_[i].needed && unit == "m" ? "" : unit;
        } else {
            cases.units.emplace_back(variable, unit);
        }
    }
    return cases;
}

QString TakeInSheet::wrong() const {
    if (!looked_) {
        return "looking at the files";
    }
    try {
        const auto added = cases::with_new_cases(study_, wanted());
        return {};
    } catch (const core::Error& error) {
        return qt(error.message() + (error.hint().empty() ? "" : "; " + error.hint()));
    }
}

Words TakeInSheet::command() const {
    Words line = {"underbody", "study", "add", study_.string(), "--files", pattern_->text().trimmed().toStdString()};
    try {
        const auto cases = wanted();
        for (const auto& [name, value] : cases.conditions) {
            line.insert(line.end(), {"--condition", name + "=" + value});
        }
        if (!cases.symmetry.empty()) {
            line.insert(line.end(), {"--symmetry", cases.symmetry});
        }
        std::string zones;
        for (const auto& zone : cases.zones) {
            zones += (zones.empty() ? "" : ",") + zone;
        }
        if (!zones.empty()) {
            line.insert(line.end(), {"--zones", zones});
        }
        if (!cases.length_unit.empty()) {
            line.insert(line.end(), {"--length-unit", cases.length_unit});
        }
        for (const auto& [variable, unit] : cases.units) {
            line.insert(line.end(), {"--unit", variable + "=" + unit});
        }
    } catch (const core::Error&) {  // said under the table
    }
    return line;
}

/// The files beside what their names say, as it will be.
void TakeInSheet::follow() {
    if (!looked_) {
        return;
    }
    std::vector<std::pair<std::string, std::string>> columns;  // condition, shown unit; "": a word
    std::vector<std::optional<core::NamePattern::Match>> matches(names_.size());
    try {
        const core::NamePattern pattern(pattern_->text().trimmed().toStdString());
        for (const auto& part : pattern.parts()) {
            if (part.kind == core::NamePattern::Part::Kind::number ||
                part.kind == core::NamePattern::Part::Kind::text) {
                columns.emplace_back(part.value, part.unit);
            }
        }
        for (std::size_t i = 0; i < names_.size(); ++i) {
            matches[i] = pattern.match(names_[i]);
        }
    } catch (const core::Error&) {  // said below
    }
    files_->setRowCount(static_cast<int>(names_.size()));
    files_->setColumnCount(static_cast<int>(columns.size()) + 1);
    QStringList titles{"file"};
    for (const auto& [name, unit] : columns) {
        titles << qt(name) + (unit.empty() ? "" : " (" + qt(pretty_unit(unit)) + ")");
    }
    files_->setHorizontalHeaderLabels(titles);
    int fitting = 0;
    for (std::size_t i = 0; i < names_.size(); ++i) {
        const int row = static_cast<int>(i);
        auto* name = new QTableWidgetItem(qt(names_[i]));
        files_->setItem(row, 0, name);
        fitting += matches[i] ? 1 : 0;
        name->setToolTip(matches[i] ? QString() : QString("left out: the pattern does not fit this name"));
        for (std::size_t c = 0; c < columns.size(); ++c) {
            QString text = matches[i] ? QString() : QString("left out");
            if (matches[i]) {
                for (const auto& [known, value] : matches[i]->numbers) {
                    if (known == columns[c].first) {
                        const auto scale = core::conversion(columns[c].second, core::si_unit(columns[c].second));
                        text = qt(core::format_number((value - scale.offset) / scale.scale, 8));
                    }
                }
                for (const auto& [known, value] : matches[i]->texts) {
                    text = known == columns[c].first ? qt(value) : text;
                }
            }
            auto* item = new QTableWidgetItem(text);
            item->setForeground(palette().color(matches[i] ? QPalette::Active : QPalette::Disabled, QPalette::Text));
            files_->setItem(row, static_cast<int>(c) + 1, item);
        }
    }
    files_->resizeColumnsToContents();
    const QString wrong_now = wrong();
    take_->setEnabled(wrong_now.isEmpty());
    command_->setText(wrong_now.isEmpty()
                          ? QString("%1 of %2 files:  ").arg(fitting).arg(names_.size()) + qt(line_of(command()))
                          : wrong_now);
}

void TakeInSheet::accept() {
    try {
        const auto added = cases::with_new_cases(study_, wanted());
        cases::write_added(added);
        taken_in_ = added.study;
        Q_EMIT taken(qt(study_.string()), qt(line_of(command())), static_cast<int>(added.count));
        QDialog::accept();
    } catch (...) {
        Q_EMIT failed("taking files in", std::current_exception());
    }
}

}  // namespace underbody::studio
