#include "studio/desktop/bottom_panels.h"

#include <QApplication>
#include <QBoxLayout>
#include <QClipboard>
#include <QFontDatabase>
#include <QLabel>
#include <QPlainTextEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QSignalBlocker>
#include <QTextCursor>
#include <QToolButton>

#include "studio/desktop/qt_text.h"

namespace underbody::studio {

namespace {

constexpr int most_lines = 5000;
constexpr int most_shown = 2000;  ///< characters of a line: thousands of chosen cases take a text 0.1 s to lay out

}  // namespace

CommandList::CommandList(Desk& desk, QWidget* parent) : QWidget(parent) {
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(4, 2, 4, 2);
    text_ = new QPlainTextEdit;
    text_->setReadOnly(true);
    text_->setMaximumBlockCount(most_lines);
    text_->setLineWrapMode(QPlainTextEdit::NoWrap);
    text_->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
    text_->setAccessibleName("Commands that were done");
    text_->setPlaceholderText(
        "What is done in the window stands here as lines that do it again, with the command of `underbody` beside "
        "them.");
    row->addWidget(text_, 1);
    auto* buttons = new QVBoxLayout;
    auto* copy = new QPushButton("Copy all");
    copy->setToolTip("Copies the lines as a script: underbody-studio --replay FILE");
    connect(copy, &QPushButton::clicked, this, [this] { QApplication::clipboard()->setText(script()); });
    buttons->addWidget(copy);
    buttons->addStretch(1);
    row->addLayout(buttons);
    connect(&desk, &Desk::acted, this, [this](const QString& line, const QString& command) {
        lines_.append(command.isEmpty() ? line : line + "\n    # " + command);
        if (lines_.size() > most_lines) {
            lines_.removeFirst();
        }
        const QString rest = line.size() > most_shown
                                 ? QString(" … (%1 more characters; Copy all has them)").arg(line.size() - most_shown)
                                 : "";
        text_->appendPlainText(line.left(most_shown) + rest +
                               (command.isEmpty() ? "" : "\n    # " + command.left(most_shown)));
        text_->moveCursor(QTextCursor::End);
        text_->moveCursor(QTextCursor::StartOfBlock);  // the beginning of a long line is what is seen
    });
}

QString CommandList::script() const { return lines_.join("\n") + "\n"; }

struct JobList::Shown : public QWidget {
    Shown(Jobs& jobs, int number) : id(number) {
        auto* row = new QHBoxLayout(this);
        row->setContentsMargins(0, 0, 0, 0);
        text = new QLabel;
        text->setMinimumWidth(320);
        row->addWidget(text, 1);
        bar = new QProgressBar;
        bar->setRange(0, 1000);
        bar->setMaximumWidth(260);
        row->addWidget(bar);
        auto* cancel = new QToolButton;
        cancel->setText("Cancel");
        row->addWidget(cancel);
        connect(cancel, &QToolButton::clicked, this, [&jobs, number] { jobs.cancel(number); });
    }
    int id;
    QLabel* text = nullptr;
    QProgressBar* bar = nullptr;
};

JobList::JobList(Jobs& jobs, QWidget* parent) : QWidget(parent), jobs_(jobs) {
    column_ = new QVBoxLayout(this);
    column_->setContentsMargins(8, 4, 8, 4);
    auto* none = new QLabel("Nothing runs.");
    none_ = none;
    column_->addWidget(none);
    column_->addStretch(1);
    connect(&jobs, &Jobs::changed, this, &JobList::draw_again);
}

void JobList::draw_again() {
    const auto rows = jobs_.rows();
    none_->setVisible(rows.empty());
    while (shown_.size() > rows.size()) {
        shown_.back()->deleteLater();
        shown_.pop_back();
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i < shown_.size() && shown_[i]->id != rows[i].id) {
            shown_[i]->deleteLater();
            shown_[i] = new Shown(jobs_, rows[i].id);
            column_->insertWidget(static_cast<int>(i), shown_[i]);
        } else if (i == shown_.size()) {
            shown_.push_back(new Shown(jobs_, rows[i].id));
            column_->insertWidget(static_cast<int>(i), shown_[i]);
        }
        shown_[i]->text->setText(
            QString("%1  %2  (%3 s)").arg(rows[i].what, rows[i].doing).arg(rows[i].seconds, 0, 'f', 1));
        shown_[i]->bar->setValue(static_cast<int>(1000 * rows[i].fraction));
        shown_[i]->bar->setAccessibleName(rows[i].what);
    }
}

HistoryList::HistoryList(Desk& desk, QWidget* parent) : QListWidget(parent), desk_(desk) {
    setObjectName("history");
    setAccessibleName("History");
    connect(&desk, &Desk::changed, this, &HistoryList::draw_again);
    connect(this, &QListWidget::currentRowChanged, this, [this](int row) {
        if (row >= 0) {
            desk_.go_to(static_cast<std::size_t>(row));
        }
    });
    draw_again();
}

void HistoryList::draw_again() {
    const QSignalBlocker quiet(this);
    const auto& steps = desk_.history().steps();
    while (count() > static_cast<int>(steps.size()) + 1) {
        delete takeItem(count() - 1);
    }
    while (count() < static_cast<int>(steps.size()) + 1) {
        addItem(count() == 0 ? QString("(start)") : QString());
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
        auto* row = item(static_cast<int>(i) + 1);
        row->setText(qt(steps[i].name));
        row->setToolTip(qt(steps[i].line.substr(0, most_shown)));
        row->setForeground(i < desk_.history().position() ? palette().text() : palette().placeholderText());
    }
    setCurrentRow(static_cast<int>(desk_.history().position()));
}

}  // namespace underbody::studio
