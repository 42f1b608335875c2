// A force table with its error, its points and its equilibria, which move with the net weight.
#pragma once

#include <memory>
#include <vector>

#include "studio/desktop/panel.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QSlider;
class QTableWidget;

namespace underbody::tables {
class ForceTable;
}

namespace underbody::studio {

class PlotView;

class ForcePanel : public Panel {
    Q_OBJECT
public:
    ForcePanel(Jobs& jobs, QWidget* parent);
    ~ForcePanel() override;

    void show_session(const SessionPointer& session) override;
    [[nodiscard]] bool has_picture() const override;
    void export_picture(const std::filesystem::path& path) override;
    [[nodiscard]] bool has_table() const override;
    void export_table(const std::filesystem::path& path) override;
    void demonstrate() override;

private:
    /// A slider for an axis that is not drawn.
    struct Held {
        std::string name;
        std::string unit;
        double lower = 0;
        double upper = 0;
        QSlider* slider = nullptr;
        QLabel* shown = nullptr;
        [[nodiscard]] double value() const;
    };
    void build();
    void build_controls(QFormLayout& form);
    void choose_table();
    void show_table();
    void fill_axes();
    void suggest_scale();
    void fill_held();
    void redraw();
    void list_equilibria();
    [[nodiscard]] std::string view_axis() const;

    SessionPointer session_;
    std::unique_ptr<tables::ForceTable> table_;
    cases::TableSpec spec_;
    QComboBox* choice_ = nullptr;
    QComboBox* view_ = nullptr;
    QCheckBox* logarithmic_ = nullptr;
    QSlider* weight_ = nullptr;
    QDoubleSpinBox* weight_box_ = nullptr;
    QDoubleSpinBox* mass_ = nullptr;
    QFormLayout* form_ = nullptr;
    QLabel* about_ = nullptr;
    PlotView* plot_ = nullptr;
    QTableWidget* list_ = nullptr;
    std::vector<Held> held_;
    QFormLayout* held_form_ = nullptr;
    double weight_range_ = 1;  ///< N, of the slider: from -range to +range
};

}  // namespace underbody::studio
