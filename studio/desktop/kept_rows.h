// The rows that are kept in Explore, as a table: a cell is written when it is seen, however many rows there are.
#pragma once

#include <QAbstractTableModel>
#include <functional>
#include <vector>

#include "core/table.h"
#include "core/units.h"

namespace underbody::studio {

class KeptRows : public QAbstractTableModel {
    Q_OBJECT
public:
    struct Column {
        QString title;
        const core::Column* values = nullptr;
        core::Conversion to_shown;
    };
    /// What a row is called, why it could not be made ("": it could), whether it has a star.
    struct Said {
        std::function<QString(std::size_t)> name, refused;
        std::function<bool(std::size_t)> starred;
    };
    using QAbstractTableModel::QAbstractTableModel;

    /// `rows` of the columns, which stay until the next call; `first`: what the rows are ("case"). False when they are
    /// the same rows as before: what is selected and where it is rolled to stays.
    bool show(const QString& first, std::vector<Column> columns, std::vector<std::size_t> rows, Said said);

    [[nodiscard]] int rowCount(const QModelIndex& above = {}) const override;
    [[nodiscard]] int columnCount(const QModelIndex& above = {}) const override;
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

private:
    QString first_;
    std::vector<Column> columns_;
    std::vector<std::size_t> rows_;
    Said said_;
};

}  // namespace underbody::studio
