// The study as a model of rows: what stands in each, and in which order.
#include <QFont>
#include <QGuiApplication>
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/natural_order.h"
#include "studio/desktop/pictures_panel.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/state/exports.h"
#include "studio/desktop/study_tree.h"

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

void StudyModel::mark_changed_shapes() {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const QModelIndex group = index(static_cast<int>(g), name, {});
        if (groups_[g].kind == "shape") {
            Q_EMIT dataChanged(index(0, name, group), index(rowCount(group) - 1, name, group));
        }
    }
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

}  // namespace underbody::studio
