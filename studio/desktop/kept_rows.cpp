#include "studio/desktop/kept_rows.h"

#include <QFont>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

bool KeptRows::show(const QString& first, std::vector<Column> columns, std::vector<std::size_t> rows, Said said) {
    const bool same = first == first_ && rows == rows_ &&
                      std::equal(columns.begin(), columns.end(), columns_.begin(), columns_.end(),
                                 [](const Column& a, const Column& b) { return a.values == b.values; });
    if (same) {
        said_ = std::move(said);
        Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, columnCount() - 1));
        return false;
    }
    beginResetModel();
    first_ = first;
    columns_ = std::move(columns);
    rows_ = std::move(rows);
    said_ = std::move(said);
    endResetModel();
    return true;
}

int KeptRows::rowCount(const QModelIndex& above) const { return above.isValid() ? 0 : static_cast<int>(rows_.size()); }

int KeptRows::columnCount(const QModelIndex& above) const {
    return above.isValid() || first_.isEmpty() ? 0 : static_cast<int>(columns_.size()) + 1;
}

QVariant KeptRows::data(const QModelIndex& index, int role) const {
    const std::size_t row = rows_.at(static_cast<std::size_t>(index.row()));
    if (index.column() > 0) {
        const Column& column = columns_.at(static_cast<std::size_t>(index.column()) - 1);
        const double value = column.to_shown(column.values->numbers[row]);
        return role == Qt::TextAlignmentRole ? QVariant(int(Qt::AlignRight | Qt::AlignVCenter))
               : role != Qt::DisplayRole     ? QVariant()
               : std::isfinite(value)        ? qt(core::format_number(value, 4))
                                             : QString("–");
    }
    if (role == Qt::DisplayRole) {
        return said_.name(row);
    }
    if (role == Qt::ToolTipRole) {
        const QString refused = said_.refused(row);
        return !refused.isEmpty() ? refused : said_.starred(row) ? QString("starred") : QString();
    }
    if (role == Qt::FontRole && said_.starred(row)) {
        QFont font;
        font.setBold(true);
        return font;
    }
    return {};
}

QVariant KeptRows::headerData(int section, Qt::Orientation orientation, int role) const {
    if (role != Qt::DisplayRole) {
        return {};
    }
    return orientation == Qt::Vertical ? QVariant(section + 1)
           : section == 0              ? QVariant(first_)
                                       : QVariant(columns_.at(static_cast<std::size_t>(section) - 1).title);
}

}  // namespace underbody::studio
