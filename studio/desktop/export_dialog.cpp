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
#include <QProgressBar>
#include <QPushButton>
#include <QSplitter>
#include <QTimer>
#include <algorithm>
#include <memory>
#include <optional>

#include "cases/export_files.h"
#include "cases/prove_export.h"
#include "core/error.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/export_preview.h"
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

ExportDialog::ExportDialog(Jobs& jobs, std::shared_ptr<const tables::ForceTable> table, QWidget* parent,
                           TableOfStudy of, Make make)
    : QDialog(parent), jobs_(jobs), table_(std::move(table)), of_(std::move(of)), make_(std::move(make)) {
    if (!make_) {
        make_ = [known = table_](const auto& range, core::Progress&) { return refitted(*known, range); };
    }
    setObjectName("export");
    setAttribute(Qt::WA_DeleteOnClose);
    const QString found = of_.found.empty() ? QString() : " with " + qt(of_.found).replace('_', ' ');
    setWindowTitle("Export " + qt(table_->quantity()).replace('_', ' ') + found + " for a controller");
    resize(1060, 660);
    connect(this, &QDialog::finished, this, [this] {
        closed_ = true;
        jobs_.cancel(slot("preview"));
        jobs_.cancel(slot("proof"));
        soon_->stop();
    });
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
    proving_ = new QProgressBar;
    proving_->setRange(0, 1000);
    proving_->setAccessibleName("How far the proof is");
    proving_->hide();
    form->addRow(proving_);
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
    name_ = new QLineEdit(qt(of_.name.empty() ? table_->quantity() : cases::export_name(of_.name)));
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
    for (const auto& axis : table_->axes()) {
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
    prove_->setToolTip(
        "Compiles the C header with the compiler of this machine and compares it at 10,000 points, as\n"
        "underbody export ... --prove does");
    write_all_ = new QPushButton;
    set_marked({});
    auto* write_button = new QPushButton("&Write …");
    write_button->setDefault(true);
    auto* close_button = new QPushButton("Close");
    buttons->addWidget(prove_);
    buttons->addStretch(1);
    buttons->addWidget(write_all_);
    buttons->addWidget(write_button);
    buttons->addWidget(close_button);
    column.addLayout(buttons);
    connect(prove_, &QPushButton::clicked, this,
            [this] { jobs_.busy(slot("proof")) ? jobs_.cancel(slot("proof")) : prove(); });
    connect(&jobs_, &Jobs::changed, this, &ExportDialog::show_proof_running);
    connect(write_all_, &QPushButton::clicked, this, [this] {
        try {
            Q_EMIT all_wanted(record());
        } catch (const core::Error& error) {
            proof_->setText("Not written: " + qt(error.what()));
        }
    });
    connect(write_button, &QPushButton::clicked, this, &ExportDialog::choose_and_write);
    connect(close_button, &QPushButton::clicked, this, &QDialog::close);
}

/// Two dialogs may be open: neither stops the work of the other.
QString ExportDialog::slot(const char* work) const {
    return QString("export %1 %2").arg(work).arg(reinterpret_cast<quintptr>(this));
}

std::string ExportDialog::format() const { return format_->currentData().toString().toStdString(); }

tables::ExportOptions ExportDialog::options() const {
    tables::ExportOptions options;
    options.name = name_->text().trimmed().toStdString();
    options.single_precision = single_->isChecked();
    options.frame = frame_->currentIndex() == 1 ? tables::Frame::ned : tables::Frame::up;
    if (!of_.found.empty()) {
        options.provenance = {of_.found_line()};
    } else if (as_fitted() && !of_.origin.empty()) {
        options.provenance = {of_.origin};
    }
    if (const std::string text = max_error_->text().trimmed().toStdString(); !text.empty()) {
        // A bare number is per cent, as the row says; "5 percent" says it itself.
        const bool bare = core::parse_quantity(text).unit.empty();
        const double share = core::parse_in(text, "1") / (bare ? 100 : 1);
        if (!(share > 0 && share < 1)) {
            throw core::UsageError("range", "the error allowed is a share between 0 and 100 %");
        }
        options.max_error = share;
    }
    return options;
}

namespace {

tables::RangePolicy chosen_in(const QComboBox& policy) {
    return *tables::range_policy(policy.currentData().toString().toStdString());
}

}  // namespace

bool ExportDialog::as_fitted() const {
    const auto& axes = table_->axes();
    return std::equal(policies_.begin(), policies_.end(), axes.begin(), axes.end(),
                      [](const auto& chosen, const auto& axis) { return chosen_in(*chosen.second) == axis.range; });
}

std::map<std::string, std::string> ExportDialog::range() const {
    std::map<std::string, std::string> range;
    if (!as_fitted()) {
        for (const auto& [axis, policy] : policies_) {
            range[axis] = policy->currentData().toString().toStdString();
        }
    }
    return range;
}

ExportRecord ExportDialog::record() const {
    const tables::ExportOptions wanted = options();
    ExportRecord record;
    record.table = of_.name;
    record.format = format();
    record.name = wanted.name;
    record.frame = wanted.frame == tables::Frame::ned ? "ned" : "up";
    record.number = wanted.single_precision ? "float" : "double";
    if (wanted.max_error > 0) {
        record.max_error = wanted.max_error;
    }
    for (const auto& [axis, policy] : policies_) {
        record.range[axis] = policy->currentData().toString().toStdString();
    }
    return record;
}

void ExportDialog::set_marked(const QStringList& tables) {
    write_all_->setText(tables.isEmpty() ? QString("Write all marked …")
                                         : QString("Write &all %1 marked …").arg(tables.size()));
    write_all_->setEnabled(!tables.isEmpty());
    write_all_->setToolTip(tables.isEmpty() ? QString("Marked are tables that are selected in the tree (Ctrl+click) or "
                                                      "have a star (Ctrl+B)")
                                            : "Writes into one folder, as this one is: " + tables.join(", "));
}

void ExportDialog::refresh() {
    jobs_.cancel(slot("proof"));  // of what stood there before
    proof_->setText(writing_ > 0 ? "writing …" : "");
    prove_->setEnabled(format() == "c");
    format_->setToolTip(format_->currentText());  // longer than its place
    for (const auto& [axis, policy] : policies_) {
        policy->setToolTip(policy->currentText());
    }
    command_->clear();
    try {
        ask_preview(options());
        command_->setText(command("FILE"));
    } catch (const core::Error& error) {
        jobs_.cancel(slot("preview"));  // of what stood there before
        facts_->setText(qt(error.what()));
    }
}

void ExportDialog::ask_preview(const tables::ExportOptions& wanted) {
    jobs_.start(
        slot("preview"), "preview",
        [self = QPointer<ExportDialog>(this), wanted, make = make_, range = range(),
         kind = format()](core::Progress& progress) {
            ExportPreview seen;
            try {
                seen = preview_of(make(range, progress), kind, wanted, progress);
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
    return qt(of_.line(of_.command(table_->quantity(), path.toStdString(), record())));
}

/// How the writing of a file ended; neither is there where it was stopped.
struct ExportDialog::Ended {
    std::optional<ExportRecord> done;
    std::exception_ptr error;
};

void ExportDialog::write(const fs::path& path) {
    tables::ExportOptions wanted = options();
    wanted.overwrite = true;  // the person was asked
    proof_->setText("writing …");
    ++writing_;
    setAttribute(Qt::WA_DeleteOnClose, false);  // what is written is told, also when the dialog is closed meanwhile
    const auto ended = std::make_shared<Ended>();
    jobs_.start(
        slot("write") + " " + qt(path.string()), "writing " + qt(path.filename().string()),
        [ended, wanted, path, record = record(), make = make_,
         range = range()](core::Progress& progress) -> std::function<void()> {
            try {
                ExportRecord done = record;
                tables::export_table(make(range, progress), record.format, path, wanted, progress);
                done.written = core::content_hash(core::read_file(path));
                ended->done = done;
                return [] {};
            } catch (const core::Cancelled&) {
                throw;
            } catch (...) {  // said in the dialog, not behind it
                ended->error = std::current_exception();
                return {};
            }
        },
        false,
        [self = QPointer<ExportDialog>(this), ended, path = qt(path.string()), line = command(qt(path.string()))] {
            if (self) {
                self->show_written(path, *ended, line);
            }
        });
}

void ExportDialog::show_written(const QString& path, const Ended& ended, const QString& line) {
    --writing_;
    if (ended.done) {
        proof_->setText("Wrote " + path);
        Q_EMIT exported(path, *ended.done);
        Q_EMIT written(path, line);
    } else if (ended.error) {
        proof_->setText("Not written: " + said_of(ended.error));
        Q_EMIT failed("writing " + path, ended.error);
    } else {
        proof_->setText("Not written: stopped");
    }
    if (writing_ == 0) {
        setAttribute(Qt::WA_DeleteOnClose);
        if (closed_) {
            deleteLater();
        }
    }
}

void ExportDialog::choose_and_write() {
    QString ending;
    for (const auto& one : tables::export_formats()) {
        ending = one.name == format() ? qt(one.ending) : ending;
    }
    QString path =
        QFileDialog::getSaveFileName(this, "Write", (folder_.isEmpty() ? "" : folder_ + "/") + name_->text() + ending,
                                     "*" + ending, nullptr, QFileDialog::DontConfirmOverwrite);
    if (path.isEmpty()) {
        return;
    }
    path += path.endsWith(ending) ? QString() : ending;
    folder_ = QFileInfo(path).absolutePath();
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
    } catch (...) {
        proof_->setText("Not written: " + said_of(std::current_exception()));
        Q_EMIT failed("writing " + path, std::current_exception());
    }
}

QString ExportDialog::proof() const { return proof_->text(); }
QString ExportDialog::preview() const { return text_->toPlainText(); }

void ExportDialog::prove() {
    try {
        ask_proof(options());
    } catch (const core::Error& error) {  // said in the dialog, not behind it
        proof_->setText("Not proved: " + qt(error.what()));
        Q_EMIT proved(false);
    }
}

void ExportDialog::ask_proof(const tables::ExportOptions& wanted) {
    proof_->setText("Not proved: stopped");  // until it is
    jobs_.start(slot("proof"), "proving " + qt(wanted.name) + ".h",
                [self = QPointer<ExportDialog>(this), wanted, make = make_, range = range()](core::Progress& progress) {
                    cases::Proof proof;
                    try {
                        proof = cases::prove_export({make(range, progress)}, wanted, progress);
                    } catch (const core::Cancelled&) {
                        throw;
                    } catch (const core::Error& error) {
                        proof.sentence = "Not proved: " + std::string(error.what());
                    }
                    return [self, proof] {
                        if (self) {
                            self->proof_->setText(qt(proof.sentence));
                            Q_EMIT self->proved(proof.equal);
                        }
                    };
                });
    show_proof_running();
}

/// While it runs the button stops it.
void ExportDialog::show_proof_running() {
    const bool running = jobs_.busy(slot("proof"));
    prove_->setText(running ? "Sto&p proving" : "&Prove");
    proving_->setVisible(running);
    proof_->setVisible(!running);
    for (const auto& row : jobs_.rows()) {
        if (row.slot == slot("proof")) {
            proving_->setFormat(row.doing.isEmpty() ? "proving …" : row.doing + " …");
            proving_->setValue(static_cast<int>(1000 * row.fraction));
        }
    }
}

}  // namespace underbody::studio
