// Explore: the cases of the study, or the shapes between limits of some parameters, as lines over all columns, as
// points and as a table; a range on any column keeps those within it, everywhere.
#pragma once

#include <memory>

#include "core/table.h"
#include "geometry/body/variants.h"
#include "studio/desktop/panel.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QSplitter;
class QStackedWidget;
class QTableView;
class QVBoxLayout;

namespace underbody::studio {

class CasePictures;
class KeptRows;
class ParallelView;
class PlotView;
class SideBySide;
class ViewCell;

/// Shapes that were made, with what is known of each.
struct MadeShapes {
    geometry::VariantSet set;
    std::vector<geometry::MadeVariant> made;  ///< point into `set`
    core::Table table;
};

class ExplorePanel : public Panel {
    Q_OBJECT
public:
    ExplorePanel(Desk& desk, QWidget* parent);
    [[nodiscard]] bool has_picture() const override;
    void export_picture(const std::filesystem::path& path) override;
    [[nodiscard]] bool has_table() const override { return !kept_.empty(); }
    void export_table(const std::filesystem::path& path) override;
    /// Rows of what is explored that the brush leaves.
    [[nodiscard]] const std::vector<std::size_t>& kept() const { return kept_; }
    [[nodiscard]] const core::Table& rows() const;
    /// nullptr until they are made.
    [[nodiscard]] std::shared_ptr<const MadeShapes> shapes() const { return shapes_; }

protected:
    void draw_again(bool session) override;

private:
    void build_head(QVBoxLayout& column);
    void build_views(QVBoxLayout& column);
    void ask_shapes();
    void show_axes();
    void fill_table();
    void take_selection();
    void show_selection();
    /// Rows of the selected cases.
    [[nodiscard]] std::vector<std::size_t> marked() const;
    void draw_scatter();
    void draw_pictures();
    void show_count();
    void sort_kept();
    void show_cells();
    void type_brush();
    void type_vary();
    void add_parameter(const QString& name);
    void take_selected();
    [[nodiscard]] std::string name_of_row(std::size_t row) const;

    std::vector<std::size_t> kept_;
    std::shared_ptr<const MadeShapes> shapes_;
    std::string shapes_of_;  ///< what they are made of, or being made
    std::string axes_of_;
    std::string order_of_;    ///< that the axes are in
    std::string ranks_of_;    ///< as axes_of_
    std::vector<int> ranks_;  ///< of the rows, in the natural order of their names
    QComboBox* what_ = nullptr;
    QComboBox* parameter_ = nullptr;
    QLineEdit* vary_ = nullptr;
    QWidget* vary_row_ = nullptr;
    QLineEdit* brush_ = nullptr;
    QComboBox* x_ = nullptr;
    QComboBox* y_ = nullptr;
    QLabel* count_ = nullptr;
    QPushButton* take_ = nullptr;
    ParallelView* parallel_ = nullptr;
    QSplitter* lower_ = nullptr;
    ViewCell* lines_cell_ = nullptr;
    ViewCell* table_cell_ = nullptr;
    ViewCell* pictures_cell_ = nullptr;
    SideBySide* points_or_pictures_ = nullptr;
    PlotView* scatter_ = nullptr;
    QStackedWidget* pictures_ = nullptr;  ///< bodies, or cases
    PlotView* bodies_ = nullptr;
    CasePictures* cases_ = nullptr;
    QTableView* table_ = nullptr;
    KeptRows* table_rows_ = nullptr;
    bool quiet_ = false;  ///< what is selected comes from the state
};

}  // namespace underbody::studio
