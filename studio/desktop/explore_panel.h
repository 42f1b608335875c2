// Explore: the cases as points and as a table; a range on any column keeps those within it, everywhere.
#pragma once

#include "studio/desktop/panel.h"

class QComboBox;
class QLabel;
class QTableWidget;

namespace underbody::studio {

class ParallelView;
class PlotView;

class ExplorePanel : public Panel {
    Q_OBJECT
public:
    ExplorePanel(Desk& desk, QWidget* parent);
    [[nodiscard]] bool has_picture() const override;
    void export_picture(const std::filesystem::path& path) override;
    [[nodiscard]] bool has_table() const override { return !kept_.empty(); }
    void export_table(const std::filesystem::path& path) override;
    /// Rows of the loads that the brush leaves.
    [[nodiscard]] const std::vector<std::size_t>& kept() const { return kept_; }

protected:
    void draw_again(bool session) override;

private:
    void fill_table();
    void draw_scatter();
    std::vector<std::size_t> kept_;
    QComboBox* x_ = nullptr;
    QComboBox* y_ = nullptr;
    QLabel* count_ = nullptr;
    ParallelView* parallel_ = nullptr;
    PlotView* scatter_ = nullptr;
    QTableWidget* table_ = nullptr;
};

}  // namespace underbody::studio
