#include "studio/desktop/table_sheet.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>

#include "core/counted.h"
#include "core/error.h"
#include "core/text.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const auto& name : names) {
        text += (text.empty() ? "" : ",") + name;
    }
    return text;
}

}  // namespace

TableSheet::TableSheet(const cases::Study& study, QWidget* parent) : QDialog(parent), study_(study) {
    setObjectName("table_sheet");
    setWindowTitle("A table of forces");
    setAttribute(Qt::WA_DeleteOnClose);
    resize(620, 300);
    auto* column = new QVBoxLayout(this);
    auto* form = new QFormLayout;
    const auto row = [&](const QString& label, const QString& name, const QString& example) {
        auto* edit = new QLineEdit;
        edit->setAccessibleName(name);
        edit->setPlaceholderText(example);
        form->addRow(label, edit);
        return edit;
    };
    quantity_ = new QComboBox;
    quantity_->setAccessibleName("Force or moment");
    for (const auto& name : cases::table_quantities(study)) {
        quantity_->addItem(qt(name));
    }
    quantity_->setCurrentText("lift_force");
    form->addRow("&Force or moment", quantity_);
    held_ = row("&Cases with", "What its cases have", "all cases; such as variant=ellipse,pitch=0deg");
    axes_ = row("&Axes", "Axes", "what varies among its cases; such as gap,pitch");
    net_weight_ = row("Net &weight", "Net weight", "none; such as 0.3N: equilibria are found for it");
    name_ = row("&Name", "Name of the table", "the quantity in words");
    const cases::NewTable proposed = cases::proposed_table(study);
    held_->setText(qt(cases::text_of(proposed.where)));
    axes_->setText(qt(listed(proposed.axes)));
    column->addLayout(form);
    said_ = new QLabel;
    said_->setWordWrap(true);
    said_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    column->addWidget(said_, 1, Qt::AlignTop);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    make_ = buttons->addButton("&Make it and compute", QDialogButtonBox::AcceptRole);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::accepted, this, &TableSheet::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &TableSheet::reject);
    connect(quantity_, &QComboBox::currentTextChanged, this, &TableSheet::follow);
    for (auto* edit : {held_, axes_, net_weight_, name_}) {
        connect(edit, &QLineEdit::textChanged, this, &TableSheet::follow);
    }
    follow();
}

cases::NewTable TableSheet::wanted() const {
    const auto text = [](const QLineEdit* edit) { return edit->text().trimmed().toStdString(); };
    cases::NewTable table;
    table.quantity = quantity_->currentText().toStdString();
    table.name = text(name_);
    table.where = text(held_).empty() ? cases::Conditions() : cases::conditions_from(text(held_));
    table.net_weight = text(net_weight_);
    for (const auto& axis : axes_->text().split(',', Qt::SkipEmptyParts)) {
        table.axes.push_back(axis.trimmed().toStdString());
    }
    return table;
}

Words TableSheet::command() const {
    const cases::NewTable table = wanted();
    Words words = {"underbody", "study", "add", study_.folder().string(), "--table", table.quantity};
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) {
            words.insert(words.end(), {option, value});
        }
    };
    add("--where", cases::text_of(table.where));
    add("--axes", listed(table.axes));
    add("--net-weight", table.net_weight);
    add("--name", table.name);
    return words;
}

void TableSheet::follow() {
    try {
        const auto table = cases::plan_table(study_, wanted());
        wrong_.clear();
        said_->setText(qt("'" + table.name + "' of " + core::counted(table.cases, "case") + " over " +
                          listed(table.axes) + ":  " + line_of(command())));
    } catch (const core::Error& error) {
        wrong_ = qt(error.message() + (error.hint().empty() ? "" : " (" + error.hint() + ")"));
        said_->setText(wrong_);
    }
    make_->setEnabled(wrong_.isEmpty());
}

void TableSheet::accept() {
    try {
        const auto added = cases::with_new_table(study_.folder(), wanted());
        cases::write_added(added);
        Q_EMIT made(qt(added.planned.name), qt(line_of(command())));
        QDialog::accept();
    } catch (...) {
        Q_EMIT failed("making a table", std::current_exception());
    }
}

}  // namespace underbody::studio
