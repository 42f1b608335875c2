#include "studio/desktop/export_dialog.h"

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QFileDialog>
#include <QFontDatabase>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QMessageBox>
#include <QPlainTextEdit>
#include <QPointer>
#include <QProcess>
#include <QPushButton>
#include <QSplitter>
#include <QTimer>
#include <algorithm>

#include "cases/export_files.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/problems_panel.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/state/words.h"

namespace underbody::studio {

namespace fs = std::filesystem;

namespace {

QString said_of(const std::exception_ptr& error) {
    const Told told = tell(error);
    return told.message + (told.hint.isEmpty() ? "" : "\n" + told.hint);
}

}  // namespace

ExportDialog::ExportDialog(Jobs& jobs, std::vector<std::shared_ptr<const tables::ForceTable>> all, QWidget* parent,
                           TableOfStudy of)
    : QDialog(parent), jobs_(jobs), all_(std::move(all)), of_(std::move(of)) {
    setObjectName("export");
    setAttribute(Qt::WA_DeleteOnClose);
    setWindowTitle("Export " + qt(all_.front()->quantity()).replace('_', ' ') + " for a controller");
    resize(1060, 660);
    soon_ = new QTimer(this);
    soon_->setSingleShot(true);
    soon_->setInterval(80);
    connect(soon_, &QTimer::timeout, this, &ExportDialog::refresh);
    build();
    refresh();
}

void ExportDialog::build() {
    auto* column = new QVBoxLayout(this);
    auto* halves = new QSplitter;
    column->addWidget(halves, 1);
    auto* left = new QWidget;
    auto* form = new QFormLayout(left);
    add_choices(*form);
    add_policies(*form);
    facts_ = new QLabel;
    facts_->setWordWrap(true);
    facts_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    form->addRow(facts_);
    proof_ = new QLabel;
    proof_->setWordWrap(true);
    form->addRow(proof_);
    error_ = new PlotView(this);
    error_->set_least(QSize(200, 220));
    form->addRow(error_);
    halves->addWidget(left);
    text_ = new QPlainTextEdit;
    text_->setReadOnly(true);
    text_->setLineWrapMode(QPlainTextEdit::NoWrap);
    text_->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
    text_->setAccessibleName("What would be written");
    halves->addWidget(text_);
    halves->setSizes({440, 620});
    command_ = new QLabel;
    command_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    command_->setWordWrap(true);
    column->addWidget(command_);
    add_buttons(*column);
    connect(format_, QOverload<int>::of(&QComboBox::currentIndexChanged), soon_, QOverload<>::of(&QTimer::start));
    connect(frame_, QOverload<int>::of(&QComboBox::currentIndexChanged), soon_, QOverload<>::of(&QTimer::start));
    connect(single_, &QCheckBox::toggled, soon_, QOverload<>::of(&QTimer::start));
    connect(name_, &QLineEdit::textEdited, soon_, QOverload<>::of(&QTimer::start));
    connect(max_error_, &QLineEdit::textEdited, soon_, QOverload<>::of(&QTimer::start));
}

void ExportDialog::add_choices(QFormLayout& form) {
    format_ = new QComboBox;
    for (const auto& format : tables::export_formats()) {
        format_->addItem(qt(format.name + ": " + format.description), qt(format.name));
    }
    format_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    form.addRow("&Format", format_);
    name_ = new QLineEdit(qt(of_.name.empty() ? all_.front()->quantity() : cases::export_name(of_.name)));
    form.addRow("&Name", name_);
    frame_ = new QComboBox;
    frame_->addItems({"up: lift positive up", "ned: body axes, z down"});
    form.addRow("F&rame", frame_);
    single_ = new QCheckBox("&float instead of double (C)");
    form.addRow(single_);
    max_error_ = new QLineEdit;
    max_error_->setObjectName("largest error");
    max_error_->setPlaceholderText("none: the full grid");
    form.addRow("&Error allowed, % of the range", max_error_);
}

void ExportDialog::add_policies(QFormLayout& form) {
    for (const auto& axis : all_.front()->axes()) {
        auto* policy = new QComboBox;
        for (const auto one :
             {tables::RangePolicy::clamp, tables::RangePolicy::refuse, tables::RangePolicy::extrapolate}) {
            policy->addItem(qt(tables::to_string(one) + ": " + tables::outside_words(one)), qt(tables::to_string(one)));
        }
        policy->setCurrentIndex(policy->findData(qt(tables::to_string(axis.range))));
        policy->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        form.addRow("Beyond the ends of " + qt(axis.name), policy);
        policies_.emplace_back(axis.name, policy);
        connect(policy, QOverload<int>::of(&QComboBox::currentIndexChanged), soon_, QOverload<>::of(&QTimer::start));
    }
}

void ExportDialog::add_buttons(QBoxLayout& column) {
    auto* buttons = new QHBoxLayout;
    prove_ = new QPushButton("&Prove");
    prove_->setToolTip("Compiles the C header with the compiler of this machine and compares it at 200 points");
    auto* write_button = new QPushButton("&Write …");
    write_button->setDefault(true);
    auto* close_button = new QPushButton("Close");
    buttons->addWidget(prove_);
    buttons->addStretch(1);
    buttons->addWidget(write_button);
    buttons->addWidget(close_button);
    column.addLayout(buttons);
    connect(prove_, &QPushButton::clicked, this, &ExportDialog::prove);
    connect(write_button, &QPushButton::clicked, this, &ExportDialog::choose_and_write);
    connect(close_button, &QPushButton::clicked, this, &QDialog::close);
}

std::string ExportDialog::format() const { return format_->currentData().toString().toStdString(); }

tables::ExportOptions ExportDialog::options() const {
    tables::ExportOptions options;
    options.name = name_->text().trimmed().toStdString();
    options.single_precision = single_->isChecked();
    options.frame = frame_->currentIndex() == 1 ? tables::Frame::ned : tables::Frame::up;
    if (as_fitted() && !of_.origin.empty()) {
        options.provenance = {of_.origin};
    }
    if (const std::string text = max_error_->text().trimmed().remove('%').toStdString(); !text.empty()) {
        const double percent = core::parse_in(text, "1");
        if (!(percent > 0 && percent < 100)) {
            throw core::UsageError("range", "the error allowed is a share between 0 and 100 %");
        }
        options.max_error = percent / 100;
    }
    return options;
}

namespace {

tables::RangePolicy chosen_in(const QComboBox& policy) {
    return *tables::range_policy(policy.currentData().toString().toStdString());
}

}  // namespace

bool ExportDialog::as_fitted() const {
    const auto& axes = all_.front()->axes();
    return std::equal(policies_.begin(), policies_.end(), axes.begin(), axes.end(),
                      [](const auto& chosen, const auto& axis) { return chosen_in(*chosen.second) == axis.range; });
}

tables::ForceTable ExportDialog::table() const {
    const auto& known = *all_.front();
    if (as_fitted()) {
        return known;
    }
    tables::FitOptions fit;
    for (const auto& [axis, policy] : policies_) {
        fit.range.named.emplace_back(axis, chosen_in(*policy));
        fit.axes.push_back(axis);
    }
    fit.kind = known.kind().find("aussian") != std::string::npos  ? tables::FitOptions::Kind::gaussian_process
               : known.kind().find("spline") != std::string::npos ? tables::FitOptions::Kind::spline
                                                                  : tables::FitOptions::Kind::interpolation;
    return tables::ForceTable::fit(known.points(), known.quantity(), fit);
}

void ExportDialog::refresh() {
    proof_->clear();
    prove_->setEnabled(format() == "c");
    format_->setToolTip(format_->currentText());  // longer than its place
    for (const auto& [axis, policy] : policies_) {
        policy->setToolTip(policy->currentText());
    }
    command_->clear();
    try {
        ask_preview(options(), table());
        command_->setText(command("FILE"));
    } catch (const core::Error& error) {
        jobs_.cancel("export preview");  // of what stood there before
        facts_->setText(qt(error.what()));
    }
}

namespace {

/// What would be written, and how far it is from the table.
struct Seen {
    QString facts, text;
    core::Figure error;
};

Seen seen_of(const tables::ForceTable& table, const std::string& kind, const tables::ExportOptions& wanted,
             core::Progress& progress) {
    const core::TemporaryFolder folder;
    std::string ending;
    for (const auto& one : tables::export_formats()) {
        ending = one.name == kind ? one.ending : ending;
    }
    const fs::path file = folder.path() / (wanted.name + ending);
    const auto result = tables::export_table(table, kind, file, wanted, progress);
    const std::string bytes = core::read_file(file);
    Seen seen;
    if (result.error > 0) {
        seen.error = tables::export_difference_figure(table, kind, wanted, progress);
    }
    seen.facts = "grid ";
    for (std::size_t i = 0; i < result.grid.size(); ++i) {
        seen.facts += (i > 0 ? " x " : "") + QString::number(result.grid[i]);
    }
    seen.facts += QString(" points; file %1 bytes").arg(bytes.size());
    seen.facts +=
        result.error > 0
            ? QString("; within %1 %2 of the table").arg(qt(core::format_number(result.error, 3)), qt(table.unit()))
            : QString("; equal to the table");
    for (const auto& remark : result.remarks) {
        seen.facts += "\n" + qt(remark.message);
    }
    const bool text = bytes.find('\0') == std::string::npos;
    seen.text = text ? qt(bytes.substr(0, 200000)) : QString("(a binary file)");
    return seen;
}

}  // namespace

void ExportDialog::ask_preview(const tables::ExportOptions& wanted, const tables::ForceTable& chosen) {
    jobs_.start(
        "export preview", "preview",
        [self = QPointer<ExportDialog>(this), wanted, chosen, kind = format()](core::Progress& progress) {
            Seen seen;
            try {
                seen = seen_of(chosen, kind, wanted, progress);
            } catch (const core::Cancelled&) {
                throw;
            } catch (const core::Error& error) {  // said in the dialog, not behind it
                seen.facts = qt(error.what());
            }
            return [self, seen] {
                if (self) {
                    self->facts_->setText(seen.facts);
                    self->error_->setVisible(!seen.error.curves.empty());
                    if (!seen.error.curves.empty()) {
                        self->error_->show_figure(seen.error);
                    }
                    self->text_->setPlainText(seen.text);
                }
            };
        },
        true);
}

QString ExportDialog::command(const QString& path) const {
    Words words = {"underbody",
                   "export",
                   of_.file.empty() ? "TABLE.csv" : of_.file,
                   "--quantity",
                   all_.front()->quantity(),
                   "--format",
                   format(),
                   "--out",
                   path.toStdString(),
                   "--name",
                   name_->text().toStdString()};
    if (frame_->currentIndex() == 1) {
        words.insert(words.end(), {"--frame", "ned"});
    }
    if (single_->isChecked()) {
        words.insert(words.end(), {"--number", "float"});
    }
    if (!max_error_->text().trimmed().isEmpty()) {
        words.insert(words.end(), {"--max-error", max_error_->text().trimmed().remove('%').toStdString() + "%"});
    }
    std::string range;
    for (const auto& [axis, box] : policies_) {
        range += (range.empty() ? "" : ",") + axis + "=" + box->currentData().toString().toStdString();
    }
    words.insert(words.end(), {"--range", range});
    return qt(of_.line(words));
}

void ExportDialog::write(const fs::path& path) {
    tables::ExportOptions wanted = options();
    wanted.overwrite = true;  // the person was asked
    tables::export_table(table(), format(), path, wanted);
    ExportRecord record;
    record.format = format();
    record.name = wanted.name;
    record.frame = frame_->currentIndex() == 1 ? "ned" : "up";
    record.number = wanted.single_precision ? "float" : "double";
    if (wanted.max_error > 0) {
        record.max_error = wanted.max_error;
    }
    for (const auto& [axis, box] : policies_) {
        record.range[axis] = box->currentData().toString().toStdString();
    }
    Q_EMIT exported(qt(path.string()), record);
    Q_EMIT written(command(qt(path.string())));
}

void ExportDialog::choose_and_write() {
    QString ending;
    for (const auto& one : tables::export_formats()) {
        ending = one.name == format() ? qt(one.ending) : ending;
    }
    QString path = QFileDialog::getSaveFileName(this, "Write", name_->text() + ending, "*" + ending, nullptr,
                                                QFileDialog::DontConfirmOverwrite);
    if (path.isEmpty()) {
        return;
    }
    path += path.endsWith(ending) ? QString() : ending;
    if (QFileInfo::exists(path) &&
        QMessageBox::question(this, "Replace", QFileInfo(path).fileName() + " is there already. Replace it?") !=
            QMessageBox::Yes) {
        return;
    }
    write_to(path);
}

void ExportDialog::write_to(const QString& path) {
    try {
        write(path.toStdString());
        proof_->setText("Wrote " + path);
    } catch (...) {
        proof_->setText("Not written: " + said_of(std::current_exception()));
        Q_EMIT failed("writing " + path, std::current_exception());
    }
}

QString ExportDialog::proof() const { return proof_->text(); }
QString ExportDialog::preview() const { return text_->toPlainText(); }

namespace {

struct Proof {
    QString sentence;
    bool equal = false;
};

bool has_run(const QString& folder, const QString& program, const QStringList& arguments, QString& said) {
    QProcess process;
    process.setWorkingDirectory(folder);
    process.setProcessChannelMode(QProcess::MergedChannels);
    process.start(program, arguments);
    const bool ended = process.waitForStarted() && process.waitForFinished(60000);
    said = QString::fromUtf8(process.readAll()).trimmed();
    return ended && process.exitStatus() == QProcess::NormalExit && process.exitCode() == 0;
}

Proof proof_of(const tables::ForceTable& table, const tables::ExportOptions& wanted, core::Progress& progress) {
    const core::TemporaryFolder folder;
    const QString place = qt(folder.path().string());
    const auto result = tables::export_table(table, "c", folder.path() / (wanted.name + ".h"), wanted, progress);
    const QString source = qt(result.files.back().filename().string());
    QString said;
    if (!has_run(place, "cc", {"-std=c99", "-O1", "-o", "proof", source, "-lm"}, said)) {
        return {"It could not be compiled: " + (said.isEmpty() ? QString("there is no C compiler (cc)") : said), false};
    }
    if (!has_run(place, place + "/proof", {}, said)) {
        return {"NOT equal: " + said, false};
    }
    return {"Compiled, run and equal: value, slope and error at 200 points, within the table and beyond.", true};
}

}  // namespace

void ExportDialog::prove() {
    try {
        tables::ExportOptions wanted = options();
        wanted.self_test = true;
        ask_proof(wanted, table());
    } catch (const core::Error& error) {  // said in the dialog, not behind it
        proof_->setText("Not proved: " + qt(error.what()));
        Q_EMIT proved(false);
    }
}

void ExportDialog::ask_proof(const tables::ExportOptions& wanted, const tables::ForceTable& chosen) {
    proof_->setText("compiling …");
    jobs_.start("export proof", "compiling and comparing",
                [self = QPointer<ExportDialog>(this), wanted, chosen](core::Progress& progress) {
                    Proof proof;
                    try {
                        proof = proof_of(chosen, wanted, progress);
                    } catch (const core::Cancelled&) {
                        throw;
                    } catch (const core::Error& error) {
                        proof.sentence = "Not proved: " + qt(error.what());
                    }
                    return [self, proof] {
                        if (self) {
                            self->proof_->setText(proof.sentence);
                            Q_EMIT self->proved(proof.equal);
                        }
                    };
                });
}

}  // namespace underbody::studio
