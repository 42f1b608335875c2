#include "studio/desktop/study_tree.h"

#include <QHeaderView>
#include <QScrollBar>
#include <algorithm>
#include <tuple>
#include <utility>

#include "studio/desktop/qt_text.h"

namespace underbody::studio {

StudyTree::StudyTree(Desk& desk, QWidget* parent)
    : QTreeView(parent), desk_(desk), model_(new StudyModel(desk, this)), proxy_(new StudyFilter(this)) {
    setObjectName("study");
    setAccessibleName("Study: shapes, cases, tables, stability maps, measurements");
    proxy_->setSourceModel(model_);
    proxy_->setRecursiveFilteringEnabled(true);
    proxy_->setFilterCaseSensitivity(Qt::CaseInsensitive);
    proxy_->setFilterKeyColumn(0);
    setModel(proxy_);
    setUniformRowHeights(true);
    setAlternatingRowColors(true);
    setSelectionMode(QAbstractItemView::ExtendedSelection);
    setSortingEnabled(true);
    setIndentation(12);
    sortByColumn(StudyModel::name, Qt::AscendingOrder);
    header()->setDefaultAlignment(Qt::AlignCenter);
    header()->setMinimumSectionSize(30);
    setTextElideMode(Qt::ElideMiddle);  // names of cases differ at their end
    header()->setStretchLastSection(false);
    const QFontMetrics metrics(font());
    for (int column = StudyModel::gap; column < StudyModel::column_count; ++column) {
        const QString widest = column == StudyModel::status  ? "changed."
                               : column == StudyModel::speed ? "speed"
                               : column < StudyModel::lift   ? "-100"
                                                             : "-0.01234";
        header()->resizeSection(column, std::max(metrics.horizontalAdvance(widest), 28) + 8);
    }
    connect(selectionModel(), &QItemSelectionModel::selectionChanged, this, [this] { take_selection(); });
    connect(&desk, &Desk::session_changed, this, &StudyTree::read_again);
    connect(&desk, &Desk::changed, this, [this] {
        const auto changed = std::exchange(look_.changed, look().changed);
        if (look() != look_) {
            read_again();
            return;
        }
        if (changed != look_.changed) {
            model_->mark_changed_shapes();
        }
        show_selection();
    });
}

/// The names of cases are read first: they get their width, and the last columns are scrolled to where there is no
/// room.
void StudyTree::give_names_room() {
    constexpr int most = 220;
    constexpr std::size_t looked_at = 200;  // the longest of thousands: each takes microseconds
    if (measured_ != desk_.session_pointer()) {
        measured_ = desk_.session_pointer();
        const QFontMetrics metrics(font());
        widest_ = metrics.horizontalAdvance("Study");
        std::vector<const std::string*> names;
        for (const auto& one : measured_->study.cases) {
            names.push_back(&one.name);
        }
        const auto end = names.begin() + static_cast<std::ptrdiff_t>(std::min(looked_at, names.size()));
        std::partial_sort(names.begin(), end, names.end(),
                          [](const auto* a, const auto* b) { return a->size() > b->size(); });
        for (auto name = names.begin(); name != end; ++name) {
            widest_ = std::max(widest_, metrics.horizontalAdvance(qt(**name)));
        }
    }
    int others = 0;
    for (int column = StudyModel::gap; column < StudyModel::column_count; ++column) {
        others += header()->sectionSize(column);
    }
    const int wanted = std::min(widest_, most) + 2 * indentation() + 12;
    header()->resizeSection(StudyModel::name, std::max(wanted, viewport()->width() - others));
}

void StudyTree::resizeEvent(QResizeEvent* event) {
    QTreeView::resizeEvent(event);
    give_names_room();
}

StudyTree::Look StudyTree::look() const {
    const studio::State& state = desk_.state();
    Look look{state.stars, state.files, {}, {}};
    for (const auto& [file, record] : state.exports) {
        look.shapes.push_back(file + "\n" + record.made_of);
    }
    for (const auto& [name, changes] : state.design.changes) {
        look.changed.push_back(name);
    }
    for (const auto& [name, variant] : state.design.variants) {
        look.shapes.push_back(name);
    }
    return look;
}

void StudyTree::read_again() {
    quiet_ = true;
    std::set<QString> closed;
    for (int row = 0; row < proxy_->rowCount(); ++row) {
        if (!isExpanded(proxy_->index(row, 0))) {
            closed.insert(proxy_->index(row, 0).data().toString().section(' ', 0, 0));
        }
    }
    const bool other = shown_ == nullptr || shown_->folder != desk_.session().folder;
    const int scrolled = verticalScrollBar()->value();
    model_->read();
    look_ = look();
    for (int row = 0; row < proxy_->rowCount(); ++row) {
        const QString title = proxy_->index(row, 0).data().toString().section(' ', 0, 0);
        const QModelIndex group = proxy_->index(row, 0);
        setFirstColumnSpanned(row, {}, true);
        for (int i = 0; title != "Cases" && i < proxy_->rowCount(group); ++i) {  // their names are all that they have
            setFirstColumnSpanned(i, group, true);
        }
        setExpanded(proxy_->index(row, 0), other ? title != "Pictures" : closed.count(title) == 0);
    }
    shown_ = desk_.session_pointer();
    give_names_room();
    show_selection();
    if (!other) {
        verticalScrollBar()->setValue(scrolled);
    }
    quiet_ = false;
    Q_EMIT counted(count());
}

/// Rows that follow one another are one range: Qt compares every range with every other, a minute for ten thousand.
QItemSelection StudyTree::ranges_of(std::vector<QModelIndex> rows) {
    std::vector<std::tuple<int, int, const QModelIndex*>> order;  // of group and row: a parent takes a proxy a while
    for (const QModelIndex& row : rows) {
        order.emplace_back(row.parent().row(), row.row(), &row);
    }
    std::sort(order.begin(), order.end());
    QItemSelection ranges;
    for (std::size_t i = 0, next = 0; i < order.size(); i = next) {
        const auto [group, first, begin] = order[i];
        for (next = i + 1; next < order.size() && std::get<0>(order[next]) == group &&
                           std::get<1>(order[next]) == first + static_cast<int>(next - i);) {
            ++next;
        }
        const QModelIndex& last = *std::get<2>(order[next - 1]);
        ranges.append(QItemSelectionRange(*begin, last.sibling(last.row(), StudyModel::column_count - 1)));
    }
    return ranges;
}

void StudyTree::show_selection() {
    std::vector<QModelIndex> rows;
    for (const auto& id : desk_.state().selection) {
        if (const QModelIndex at = proxy_->mapFromSource(model_->find(id)); at.isValid()) {
            rows.push_back(at);
        }
    }
    const QModelIndex first = rows.empty() ? QModelIndex() : rows.front();
    const QItemSelection wanted = ranges_of(std::move(rows));
    if (wanted != selectionModel()->selection()) {
        const bool was = std::exchange(quiet_, true);
        selectionModel()->select(wanted, QItemSelectionModel::ClearAndSelect);
        if (first.isValid() && !selectionModel()->isSelected(currentIndex())) {
            selectionModel()->setCurrentIndex(first, QItemSelectionModel::NoUpdate);
            scrollTo(first);
        }
        quiet_ = was;
    }
}

void StudyTree::take_selection() {
    if (quiet_) {
        return;
    }
    Words words = {"select"};
    for (const auto& range : selectionModel()->selection()) {  // of whole rows
        for (int row = range.top(); range.parent().isValid() && row <= range.bottom(); ++row) {
            words.push_back(model()->index(row, 0, range.parent()).data(StudyModel::id_role).toString().toStdString());
        }
    }
    desk_.act(words);
}

void StudyTree::filter(const QString& text) {
    const bool was = std::exchange(quiet_, true);
    proxy_->setFilterFixedString(text);
    show_selection();
    quiet_ = was;
    Q_EMIT counted(count());
}

QString StudyTree::count() const {
    for (int row = 0; row < proxy_->rowCount(); ++row) {
        const QModelIndex group = proxy_->index(row, 0);
        if (group.data().toString().startsWith("Cases")) {
            return QString("%1 of %2 cases").arg(proxy_->rowCount(group)).arg(desk_.session().study.cases.size());
        }
    }
    return desk_.session().study.cases.empty() ? QString()
                                               : QString("0 of %1 cases").arg(desk_.session().study.cases.size());
}

void StudyTree::step(int by) {
    QModelIndex at;
    for (const auto& id : desk_.state().selection) {
        at = id.starts_with("case/") ? proxy_->mapFromSource(model_->find(id)) : at;
    }
    if (!at.isValid()) {
        const auto& cases = desk_.session().study.cases;
        at = cases.empty() ? QModelIndex() : proxy_->mapFromSource(model_->find("case/" + cases.front().name));
        by = 0;
    }
    const QModelIndex next = at.isValid() ? at.sibling(at.row() + by, 0) : at;
    if (next.isValid()) {
        desk_.act({"select", next.data(StudyModel::id_role).toString().toStdString()});
        scrollTo(next);
    }
}

}  // namespace underbody::studio
