// Tables: a force table with its error, its points and its equilibria, which move with the net weight.
#pragma once

#include <memory>
#include <vector>

#include "studio/desktop/panel.h"

class QCheckBox;
class QComboBox;
class QFormLayout;
class QGridLayout;
class QLabel;
class QTableWidget;
class QTimer;

namespace underbody::core {
struct Figure;
}

namespace underbody::tables {
class ForceTable;
struct Equilibria;
struct EquilibriumOptions;
struct FigureOptions;
}  // namespace underbody::tables

namespace underbody::studio {

class ParameterRow;
class PlotView;

class ForcePanel : public Panel {
    Q_OBJECT
public:
    ForcePanel(Desk& desk, QWidget* parent);
    ~ForcePanel() override;

    [[nodiscard]] bool has_picture() const override;
    void export_picture(const std::filesystem::path& path) override;
    [[nodiscard]] bool has_table() const override;
    void export_table(const std::filesystem::path& path) override;
    /// The table that is shown; nullptr while there is none.
    [[nodiscard]] std::shared_ptr<const tables::ForceTable> table() const { return table_; }

    /// Name of the [[table]] that is shown.
    [[nodiscard]] const std::string& table_name() const { return spec_.name; }

    [[nodiscard]] std::vector<View> views() const override;
    void choose_view(const std::string& name, bool shown) override;
    /// Views of the table beside the first one, of which those that are not shown are hidden.
    [[nodiscard]] const std::vector<PlotView*>& beside() const { return beside_; }

protected:
    void draw_again(bool session) override;

private:
    struct Held {
        std::string name;
        ParameterRow* row = nullptr;
    };
    void build();
    void build_controls(QFormLayout& form);
    void act(const std::string& assignment, const QString& gesture = {});
    void choose_table(bool fresh);
    void fit(const cases::TableSpec& spec);
    void show_cases();
    void show_table();
    void fill_axes();
    void fill_held();
    void redraw();
    [[nodiscard]] core::Figure figure_of(const QStringList& view, tables::FigureOptions options) const;
    void show_beside();
    void hide_beside();
    void list_equilibria(tables::EquilibriumOptions options);
    void show_equilibria(const tables::Equilibria& found);
    [[nodiscard]] QStringList view() const;
    [[nodiscard]] const TableView& settings() const;
    [[nodiscard]] bool has_weight() const;
    [[nodiscard]] double net_weight() const;
    [[nodiscard]] double virtual_mass() const;
    [[nodiscard]] double held_value(const std::string& axis) const;
    void point_clicked(double x, double y);

    std::shared_ptr<const tables::ForceTable> table_;
    cases::TableSpec spec_;
    SessionPointer fitted_;  ///< what the table was fitted to
    QComboBox* choice_ = nullptr;
    QComboBox* view_ = nullptr;
    QCheckBox* logarithmic_ = nullptr;
    ParameterRow* weight_ = nullptr;
    ParameterRow* mass_ = nullptr;
    QLabel* about_ = nullptr;
    QLabel* reach_ = nullptr;
    QGridLayout* grid_ = nullptr;
    PlotView* plot_ = nullptr;
    std::vector<PlotView*> beside_;
    QTableWidget* list_ = nullptr;
    QTimer* at_rest_ = nullptr;  ///< runs out when no slider has moved for a while
    std::vector<Held> held_;
    QString held_for_;
    QFormLayout* held_form_ = nullptr;
    double weight_range_ = 1;  ///< N, of the slider: from -range to +range
};

}  // namespace underbody::studio
