#include "studio/desktop/cases_panel.h"

#include <QCollator>
#include <QHeaderView>
#include <cmath>
#include <map>

#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

namespace {

enum Column { name_column, gap_column, pitch_column, lift_column, drag_column, status_column, column_count };

/// Sorts numbers as numbers.
class Item : public QTreeWidgetItem {
public:
    using QTreeWidgetItem::QTreeWidgetItem;
    bool operator<(const QTreeWidgetItem& other) const override {
        const int column = treeWidget()->sortColumn();
        const QVariant mine = data(column, Qt::UserRole + 1);
        const QVariant others = other.data(column, Qt::UserRole + 1);
        if (mine.isValid() && others.isValid()) {
            return mine.toDouble() < others.toDouble();
        }
        static const QCollator natural = [] {
            QCollator collator(QLocale(QLocale::English));  // the C locale cannot
            collator.setNumericMode(true);                  // h2 before h10
            return collator;
        }();
        return natural.compare(text(column), other.text(column)) < 0;
    }
    void number(int column, double shown, int digits) {
        if (std::isfinite(shown)) {
            setText(column, QString::fromStdString(core::format_number(shown, digits)).replace('-', QChar(0x2212)));
            setData(column, Qt::UserRole + 1, shown);
            setTextAlignment(column, Qt::AlignRight | Qt::AlignVCenter);
        }
    }
};

/// What is known of the loads of a case; nullptr when nothing is.
const cases::CaseLoads* loads_of(const Session& session, std::size_t index) {
    const auto& all = session.results.case_loads;
    return index < all.size() && all[index].entry == index ? &all[index] : nullptr;
}

QString status_of(const cases::Case& one, const cases::CaseLoads* loads) {
    std::error_code code;
    if (!std::filesystem::exists(one.file, code)) {
        return "no file";
    }
    if (loads == nullptr || loads->state == cases::StepState::missing) {
        return "not run";
    }
    if (loads->values.empty()) {
        return qt(to_string(loads->state));
    }
    return loads->warnings.empty() ? "done" : "warning";
}

QString why(const cases::CaseLoads* loads) {
    QString text;
    if (loads != nullptr) {
        text = loads->error.empty() ? "" : "\n" + qt(loads->error);
        for (const auto& warning : loads->warnings) {
            text += "\n" + qt(warning.message);
        }
    }
    return text;
}

}  // namespace

CasesTree::CasesTree(QWidget* parent) : QTreeWidget(parent) {
    setObjectName("cases");
    setColumnCount(column_count);
    setHeaderLabels({"case", "gap\nmm", "pitch\n°", "lift\nN", "drag\nN", "status"});
    header()->setDefaultAlignment(Qt::AlignCenter);
    header()->setStretchLastSection(true);
    setIndentation(12);
    setUniformRowHeights(true);
    setAlternatingRowColors(true);
    setSortingEnabled(true);
    connect(this, &QTreeWidget::currentItemChanged, this, [this](QTreeWidgetItem* item) {
        const QVariant index = item != nullptr ? item->data(0, Qt::UserRole) : QVariant();
        if (session_ && index.isValid() && index.toULongLong() < session_->study.cases.size()) {
            Q_EMIT chosen(session_->study.cases[index.toULongLong()]);
        }
    });
}

void CasesTree::show_session(const SessionPointer& session) {
    const QString current = currentItem() != nullptr ? currentItem()->text(0) : QString();
    const bool blocked = blockSignals(true);
    setSortingEnabled(false);
    clear();
    session_ = session;
    std::map<std::string, Item*> groups;
    for (std::size_t i = 0; i < session->study.cases.size(); ++i) {
        const auto& one = session->study.cases[i];
        const std::string variant = one.conditions.text("variant").value_or("cases");
        Item*& group = groups[variant];
        if (group == nullptr) {
            group = new Item(this);
            group->setText(name_column, qt(variant));
            group->setExpanded(true);
            QFont bold = font();
            bold.setBold(true);
            group->setFont(name_column, bold);
        }
        auto* item = new Item(group);
        item->setText(name_column, qt(one.name));
        item->setData(name_column, Qt::UserRole, static_cast<qulonglong>(i));
        item->number(gap_column, one.conditions.number("gap").value_or(std::nan("")) * 1000, 5);
        item->number(pitch_column, core::convert(one.conditions.number("pitch").value_or(std::nan("")), "rad", "deg"),
                     4);
        const cases::CaseLoads* loads = loads_of(*session, i);
        item->number(lift_column, loads != nullptr ? loads->value("lift_force") : std::nan(""), 3);
        item->number(drag_column, loads != nullptr ? loads->value("drag_force") : std::nan(""), 3);
        const QString status = status_of(one, loads);
        item->setText(status_column, status);
        item->setToolTip(name_column, qt(one.conditions.label()) + "\n" + qt(one.file.string()) + why(loads));
        item->setToolTip(status_column, item->toolTip(name_column));
        if (status == "failed" || status == "no file") {
            item->setForeground(status_column, QColor(178, 40, 10));
        } else if (status == "not run" || status == "changed" || status == "warning") {
            item->setForeground(status_column, QColor(130, 130, 130));
        } else {
            item->setForeground(status_column, QColor(0, 112, 79));
        }
        if (item->text(0) == current) {
            setCurrentItem(item);
        }
    }
    for (const auto& [name, group] : groups) {
        group->setText(status_column, QString::number(group->childCount()));
        group->setTextAlignment(status_column, Qt::AlignRight);
    }
    setSortingEnabled(true);
    sortByColumn(name_column, Qt::AscendingOrder);
    resizeColumnToContents(name_column);
    header()->resizeSection(name_column, std::min(210, header()->sectionSize(name_column)));
    for (int column = gap_column; column < column_count; ++column) {
        header()->resizeSection(column, column < lift_column ? 44 : 56);
    }
    blockSignals(blocked);
}

void CasesTree::filter(const QString& text) {
    for (int i = 0; i < topLevelItemCount(); ++i) {
        QTreeWidgetItem* group = topLevelItem(i);
        bool any = false;
        for (int k = 0; k < group->childCount(); ++k) {
            QTreeWidgetItem* item = group->child(k);
            const bool fits = text.isEmpty() || item->text(0).contains(text, Qt::CaseInsensitive) ||
                              item->toolTip(0).contains(text, Qt::CaseInsensitive);
            item->setHidden(!fits);
            any = any || fits;
        }
        group->setHidden(!any);
    }
}

}  // namespace underbody::studio
