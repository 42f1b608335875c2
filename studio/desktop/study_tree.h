// The study as a tree: shapes, cases with conditions, loads and status, tables, regions, measurements, pictures. What
// is selected in it is the state's selection.
#pragma once

#include <QAbstractItemModel>
#include <QSortFilterProxyModel>
#include <QTreeView>
#include <vector>

#include "studio/desktop/desk.h"

namespace underbody::studio {

/// Two levels: kinds and things. 10,000 cases are no more than a vector of indices; text is made when it is seen.
class StudyModel : public QAbstractItemModel {
    Q_OBJECT
public:
    enum Column { name, gap, pitch, speed, lift, drag, status, column_count };
    enum Role { id_role = Qt::UserRole, sort_role };

    StudyModel(Desk& desk, QObject* parent);
    void read();
    /// Other shapes are changed than before: what stands there is the same.
    void mark_changed_shapes();
    /// "case/ellipse-h5-p0" -> its place; invalid when it is not there.
    [[nodiscard]] QModelIndex find(const std::string& id) const;

    [[nodiscard]] QModelIndex index(int row, int column, const QModelIndex& parent) const override;
    [[nodiscard]] QModelIndex parent(const QModelIndex& child) const override;
    [[nodiscard]] int rowCount(const QModelIndex& parent) const override;
    [[nodiscard]] int columnCount(const QModelIndex&) const override { return column_count; }
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

private:
    struct Group {
        std::string kind;
        QString title;
        std::vector<std::string> names;
        std::vector<QString> titles;  ///< of pictures
        std::vector<int> ranks;       ///< of what is shown, in its natural order
    };
    [[nodiscard]] QString text(const Group& group, std::size_t row) const;
    [[nodiscard]] QVariant cell(const Group& group, std::size_t row, int column, int role) const;
    [[nodiscard]] double number(std::size_t entry, int column) const;

    Desk& desk_;
    SessionPointer session_;
    std::vector<Group> groups_;
    std::vector<std::pair<std::string, QModelIndex>> places_;
};

/// Sorts numbers as numbers and names in their natural order (h2 before h10).
class StudyFilter : public QSortFilterProxyModel {
    Q_OBJECT
public:
    using QSortFilterProxyModel::QSortFilterProxyModel;

protected:
    [[nodiscard]] bool lessThan(const QModelIndex& left, const QModelIndex& right) const override;
};

class StudyTree : public QTreeView {
    Q_OBJECT
public:
    StudyTree(Desk& desk, QWidget* parent);
    /// Only things whose name or conditions hold the text.
    void filter(const QString& text);
    /// How many cases the filter leaves, and of how many: "11 of 48 cases".
    [[nodiscard]] QString count() const;
    /// Selects the next (1) or previous (-1) case.
    void step(int by);

Q_SIGNALS:
    void counted(const QString& text);

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    /// What of the state the rows show.
    struct Look {
        std::set<std::string> stars;
        std::vector<std::string> files;
        std::vector<std::string> shapes;
        std::vector<std::string> changed;  ///< shapes
        bool operator==(const Look&) const = default;
    };
    [[nodiscard]] Look look() const;
    void read_again();
    void give_names_room();
    static QItemSelection ranges_of(std::vector<QModelIndex> rows);
    void show_selection();
    void take_selection();

    Desk& desk_;
    StudyModel* model_ = nullptr;
    StudyFilter* proxy_ = nullptr;
    SessionPointer shown_;
    SessionPointer measured_;  ///< whose names' width is known
    int widest_ = 0;           ///< px
    Look look_;
    bool quiet_ = false;
};

}  // namespace underbody::studio
