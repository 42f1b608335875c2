// Under the cells of Compare: forces with their errors, what each zone carries, the running integral along the body,
// and the tables that the cases are points of, laid over each other.
#pragma once

#include <QTabWidget>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/figure.h"
#include "core/table.h"
#include "postproc/loads/loads.h"
#include "studio/desktop/desk.h"
#include "surrogates/tables/analysis/compare.h"

class QComboBox;
class QLabel;
class QTableWidget;

namespace underbody::studio {

class PlotView;

/// One case or file that is compared.
struct ComparedCase {
    std::string id;  ///< "case/NAME", "field/PATH"
    std::string name;
    std::shared_ptr<const postproc::LoadsResult> loads;  ///< nullptr: not known, or not yet
    std::string why;                                     ///< then
};

class CompareNumbers : public QTabWidget {
    Q_OBJECT
public:
    CompareNumbers(Desk& desk, QWidget* parent);
    void show_cases(std::vector<ComparedCase> cases, bool differences);
    /// The forces as they are shown, for a sheet: a row of titles, then one a case.
    [[nodiscard]] std::vector<QStringList> rows() const;
    /// Row and column, of `rows`, of the differences that are more than twice their joint standard deviation.
    [[nodiscard]] std::set<std::pair<std::size_t, int>> beyond() const;
    [[nodiscard]] core::Table table() const;
    [[nodiscard]] bool has_table() const { return !cases_.empty(); }
    /// The tab in front is a plot, not rows of numbers.
    [[nodiscard]] bool shows_curves() const { return currentIndex() > 1; }
    [[nodiscard]] QTableWidget* forces() const { return forces_; }
    [[nodiscard]] QTableWidget* zones() const { return zones_; }
    [[nodiscard]] PlotView* along() const { return along_; }

Q_SIGNALS:
    void remark(const QString& text);

private:
    struct Compared {
        tables::Comparison comparison;
        core::Figure figure;
    };
    void fill_forces();
    void fill_zones();
    void draw_along();
    void ask_tables();
    [[nodiscard]] std::vector<const cases::TableSpec*> tables_of_cases() const;
    [[nodiscard]] double value(const ComparedCase& one, const std::string& quantity) const;

    Desk& desk_;
    std::vector<ComparedCase> cases_;
    std::map<std::string, std::map<std::string, double>> errors_;  ///< quantity -> case -> standard deviation
    SessionPointer errors_of_;
    bool differences_ = false;
    std::string tables_of_;
    QTableWidget* forces_ = nullptr;
    QTableWidget* zones_ = nullptr;
    QComboBox* along_what_ = nullptr;
    PlotView* along_ = nullptr;
    PlotView* tables_ = nullptr;
    QLabel* tables_said_ = nullptr;
};

}  // namespace underbody::studio
