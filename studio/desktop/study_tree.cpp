#include "studio/desktop/study_tree.h"

#include <QFont>
#include <QGuiApplication>
#include <QHeaderView>
#include <QScrollBar>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/natural_order.h"
#include "studio/desktop/pictures_panel.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/state/exports.h"

namespace underbody::studio {

namespace {

/// What is known of the loads of a case; nullptr when nothing is.
const cases::CaseLoads* loads_of(const Session& session, std::size_t index) {
    const auto& all = session.results.case_loads;
    return index < all.size() && all[index].entry == index ? &all[index] : nullptr;
}

QString status_of(const cases::CaseLoads* loads) {
    if (loads == nullptr || loads->state == cases::StepState::missing) {
        return "not run";
    }
    if (loads->values.empty()) {
        return qt(to_string(loads->state));
    }
    return loads->warnings.empty() ? "done" : "warning";
}

QString tip(const Session& session, std::size_t index) {
    const auto& one = session.study.cases[index];
    QStringList lines{qt(one.conditions.label()), qt(one.file.string())};
    if (const auto* loads = loads_of(session, index)) {
        if (!loads->error.empty()) {
            lines << qt(loads->error);
        }
        for (const auto& warning : loads->warnings) {
            lines << qt(warning.message);
        }
    }
    for (auto& line : lines) {
        line = "<p>" + line.toHtmlEscaped() + "</p>";  // text with marks is broken into lines
    }
    return lines.join("");
}

/// Of what went wrong, told from what is well on light ground and on dark.
QVariant ink_of(const QString& status) {
    const bool dark = QGuiApplication::palette().color(QPalette::Base).lightness() < 128;
    return status == "failed"    ? QColor(dark ? "#ff8a65" : "#b3261e")
           : status == "warning" ? QColor(dark ? "#ffb74d" : "#8a5300")
                                 : QVariant();
}

constexpr quintptr top = ~quintptr(0);

}  // namespace

StudyModel::StudyModel(Desk& desk, QObject* parent) : QAbstractItemModel(parent), desk_(desk) {}

void StudyModel::read() {
    beginResetModel();
    session_ = desk_.session_pointer();
    const auto& study = session_->study;
    groups_.clear();
    const auto add = [&](const char* kind, const char* title, auto&& things, auto&& name_of_thing) {
        Group group{kind, title, {}, {}, {}};
        for (const auto& thing : things) {
            group.names.push_back(name_of_thing(thing));
        }
        if (!group.names.empty()) {
            groups_.push_back(std::move(group));
        }
    };
    const auto named = [](const auto& thing) { return thing.name; };
    add("shape", "Shapes", shape_names(desk_.state(), *session_), [](const std::string& text) { return text; });
    add("case", "Cases", study.cases, named);
    add("table", "Tables", study.tables, named);
    add("region", "Stability", study.regions, named);
    add("measurement", "Measurements", study.measurements, named);
    add("picture", "Pictures", session_->results.pictures, [](const auto& one) { return one.first; });
    if (!groups_.empty() && groups_.back().kind == "picture") {
        for (const auto& key : groups_.back().names) {
            groups_.back().titles.push_back(picture_title(session_->results, key));
        }
    }
    add("field", "Files", desk_.state().files, [](const std::string& entry) {
        return entry.starts_with("field:") ? entry.substr(6) : entry.substr(entry.find(':') + 1);
    });
    add("export", "Exports", desk_.state().exports, [](const auto& one) { return one.first; });
    if (!groups_.empty() && groups_.back().kind == "export") {
        for (const auto& file : groups_.back().names) {
            const auto& record = desk_.state().exports.at(file);
            const auto found = state_of(*session_, file, record);
            groups_.back().titles.push_back(qt(file).section('/', -1) + ", of " + qt(record.table) +
                                            (found == ExportState::stale     ? "  –  STALE"
                                             : found == ExportState::missing ? "  –  GONE"
                                                                             : ""));
        }
    }
    for (Group& group : groups_) {
        std::vector<QString> texts;
        for (std::size_t row = 0; row < group.names.size(); ++row) {
            texts.push_back(text(group, row));
        }
        group.ranks = natural_ranks(texts);
    }
    endResetModel();
    places_.clear();
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const QModelIndex group = index(static_cast<int>(g), 0, {});
        for (std::size_t i = 0; i < groups_[g].names.size(); ++i) {
            places_.emplace_back(groups_[g].kind + "/" + groups_[g].names[i], index(static_cast<int>(i), 0, group));
        }
    }
    std::sort(places_.begin(), places_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

QModelIndex StudyModel::find(const std::string& id) const {
    const auto at = std::lower_bound(places_.begin(), places_.end(), id,
                                     [](const auto& place, const std::string& wanted) { return place.first < wanted; });
    return at != places_.end() && at->first == id ? at->second : QModelIndex();
}

QModelIndex StudyModel::index(int row, int column, const QModelIndex& above) const {
    if (row < 0 || column < 0 || column >= column_count || row >= rowCount(above)) {
        return {};
    }
    return above.isValid() ? createIndex(row, column, static_cast<quintptr>(above.row()))
                           : createIndex(row, column, top);
}

QModelIndex StudyModel::parent(const QModelIndex& child) const {
    return !child.isValid() || child.internalId() == top ? QModelIndex()
                                                         : createIndex(static_cast<int>(child.internalId()), 0, top);
}

int StudyModel::rowCount(const QModelIndex& above) const {
    if (!above.isValid()) {
        return static_cast<int>(groups_.size());
    }
    return above.internalId() == top && above.column() == 0
               ? static_cast<int>(groups_[static_cast<std::size_t>(above.row())].names.size())
               : 0;
}

double StudyModel::number(std::size_t entry, int column) const {
    const auto& conditions = session_->study.cases[entry].conditions;
    const auto* loads = loads_of(*session_, entry);
    const double none = std::nan("");
    switch (column) {
        case gap:
            return 1000 * conditions.number("gap").value_or(none);
        case pitch:
            return core::convert(conditions.number("pitch").value_or(none), "rad", "deg");
        case speed:
            return conditions.number("speed").value_or(none);
        case lift:
            return loads != nullptr ? loads->value("lift_force") : none;
        case drag:
            return loads != nullptr ? loads->value("drag_force") : none;
        default:
            return none;
    }
}

/// What is written of a thing, without its marks.
QString StudyModel::text(const Group& group, std::size_t row) const {
    return group.kind == "picture" || group.kind == "export" ? group.titles.at(row)
           : group.kind == "field"                           ? qt(group.names[row]).section('/', -1)
                                                             : qt(group.names[row]);
}

QVariant StudyModel::cell(const Group& group, std::size_t row, int column, int role) const {
    if (column == name && role == sort_role) {
        return group.ranks[row];
    }
    const std::string id = group.kind + "/" + group.names[row];
    if (role == id_role) {
        return qt(id);
    }
    if (column == name) {
        if (role == Qt::DisplayRole) {
            const bool changed = group.kind == "shape" && desk_.state().design.changes.contains(group.names[row]);
            return (desk_.state().stars.contains(id) ? QString("★ ") : QString()) + text(group, row) +
                   (changed ? " *" : "");
        }
        if (role == Qt::ToolTipRole) {
            return group.kind == "case" ? tip(*session_, row) : qt(group.names[row]);
        }
        return {};
    }
    if (group.kind != "case") {
        return {};
    }
    if (column == status) {
        return role == Qt::ForegroundRole                     ? ink_of(status_of(loads_of(*session_, row)))
               : role == Qt::DisplayRole || role == sort_role ? status_of(loads_of(*session_, row))
               : role == Qt::ToolTipRole                      ? tip(*session_, row)
                                                              : QVariant();
    }
    const double value = number(row, column);
    if (role == Qt::TextAlignmentRole) {
        return int(Qt::AlignRight | Qt::AlignVCenter);
    }
    if (!std::isfinite(value)) {
        return {};
    }
    if (role == sort_role) {
        return value;
    }
    return role == Qt::DisplayRole ? qt(core::format_number(value, column < lift ? 5 : 3)).replace('-', QChar(0x2212))
                                   : QVariant();
}

QVariant StudyModel::data(const QModelIndex& index, int role) const {
    if (!index.isValid()) {
        return {};
    }
    if (index.internalId() != top) {
        return cell(groups_[index.internalId()], static_cast<std::size_t>(index.row()), index.column(), role);
    }
    const Group& group = groups_[static_cast<std::size_t>(index.row())];
    if (role == Qt::FontRole) {
        QFont bold;
        bold.setBold(true);
        return bold;
    }
    if (role == sort_role) {
        return index.row();
    }
    return role == Qt::DisplayRole && index.column() == name
               ? QString("%1 (%2)").arg(group.title).arg(group.names.size())
               : QVariant();
}

QVariant StudyModel::headerData(int section, Qt::Orientation orientation, int role) const {
    static const QStringList titles = {"study", "gap\nmm", "pitch\n°", "speed\nm/s", "lift\nN", "drag\nN", "status"};
    return orientation == Qt::Horizontal && role == Qt::DisplayRole ? titles.value(section) : QVariant();
}

bool StudyFilter::lessThan(const QModelIndex& left, const QModelIndex& right) const {
    const QVariant mine = left.data(StudyModel::sort_role);
    const QVariant others = right.data(StudyModel::sort_role);
    if (!left.parent().isValid()) {  // kinds stay in their order
        const bool ascending = sortOrder() == Qt::AscendingOrder;
        return ascending ? left.row() < right.row() : left.row() > right.row();
    }
    if (mine.type() == QVariant::Int && others.type() == QVariant::Int) {
        return mine.toInt() < others.toInt();
    }
    if (mine.type() == QVariant::Double && others.type() == QVariant::Double) {
        return mine.toDouble() < others.toDouble();
    }
    return natural_less(mine.toString(), others.toString());
}

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
        if (look() != look_) {
            read_again();
        } else {
            show_selection();
        }
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
    Look look{state.stars, state.files, {}};
    for (const auto& [file, record] : state.exports) {
        look.shapes.push_back(file + "\n" + record.made_of);
    }
    for (const auto& [name, changes] : state.design.changes) {
        look.shapes.push_back("*" + name);
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
    std::sort(rows.begin(), rows.end(), [](const QModelIndex& a, const QModelIndex& b) {
        return std::pair(a.parent().row(), a.row()) < std::pair(b.parent().row(), b.row());
    });
    QItemSelection ranges;
    for (std::size_t i = 0, next = 0; i < rows.size(); i = next) {
        for (next = i + 1; next < rows.size() && rows[next].parent() == rows[i].parent() &&
                           rows[next].row() == rows[next - 1].row() + 1;) {
            ++next;
        }
        const QModelIndex& last = rows[next - 1];
        ranges.append(QItemSelectionRange(rows[i], last.sibling(last.row(), StudyModel::column_count - 1)));
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
    for (const auto& index : selectionModel()->selectedRows()) {
        if (index.parent().isValid()) {
            words.push_back(index.data(StudyModel::id_role).toString().toStdString());
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
