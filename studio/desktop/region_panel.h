// The stability map: computed beside the window, with any declared number of the model changed; a click shows the
// motion.
#pragma once

#include <memory>

#include "studio/desktop/panel.h"

class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QPushButton;
class QSpinBox;

namespace underbody::dynamics {
struct Model;
struct StabilityRegion;
struct Trajectory;
}  // namespace underbody::dynamics

namespace underbody::studio {

class PlotView;

class RegionPanel : public Panel {
    Q_OBJECT
public:
    RegionPanel(Jobs& jobs, QWidget* parent);
    ~RegionPanel() override;

    void show_session(const SessionPointer& session) override;
    [[nodiscard]] bool has_picture() const override;
    void export_picture(const std::filesystem::path& path) override;
    [[nodiscard]] bool has_table() const override;
    void export_table(const std::filesystem::path& path) override;
    void demonstrate() override;

private:
    void build();
    void build_controls(QFormLayout& form);
    void choose_region();
    void show_model();
    void choose_parameter();
    void compute();
    void show_region();
    void start_from(double x, double y);
    void show_trajectory();
    /// The model with what the panel changes.
    [[nodiscard]] dynamics::Model changed_model() const;

    SessionPointer session_;
    cases::RegionSpec spec_;
    std::shared_ptr<const dynamics::Model> model_;
    std::shared_ptr<const dynamics::StabilityRegion> region_;
    std::shared_ptr<const dynamics::Trajectory> trajectory_;
    std::vector<std::pair<std::string, double>> changes_;  ///< of declared parameters, SI
    QComboBox* choice_ = nullptr;
    QSpinBox* cells_ = nullptr;
    QDoubleSpinBox* duration_ = nullptr;
    QComboBox* parameter_ = nullptr;
    QDoubleSpinBox* value_ = nullptr;
    QLabel* changes_label_ = nullptr;
    QPushButton* compute_ = nullptr;
    QPushButton* reset_ = nullptr;
    QLabel* about_ = nullptr;
    PlotView* map_ = nullptr;
    PlotView* motion_ = nullptr;
};

}  // namespace underbody::studio
