// The stability map: computed beside the window, with any declared number of the model changed; a click shows the
// motion.
#pragma once

#include <map>
#include <memory>

#include "core/units.h"
#include "studio/desktop/panel.h"

class QCheckBox;
class QComboBox;
class QFormLayout;
class QGridLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QSpinBox;

namespace underbody::core {
struct Figure;
}

namespace underbody::dynamics {
struct Model;
struct PitchTrajectory;
struct ProbabilityMap;
struct RegionOptions;
struct RegionSweep;
struct StabilityRegion;
struct Trajectory;
}  // namespace underbody::dynamics

namespace underbody::studio {

class NumberEdit;
class PlotView;
struct KnownAlongGap;

class RegionPanel : public Panel {
    Q_OBJECT
public:
    RegionPanel(Desk& desk, QWidget* parent);
    ~RegionPanel() override;

    [[nodiscard]] bool has_picture() const override;
    void export_picture(const std::filesystem::path& path) override;
    [[nodiscard]] bool has_table() const override;
    void export_table(const std::filesystem::path& path) override;
    /// The motion in heave and pitch that is shown, of a map over one of pitch's axes.
    [[nodiscard]] std::shared_ptr<const dynamics::PitchTrajectory> pitch_trajectory() const {
        return pitch_trajectory_;
    }
    /// The motion that is shown; nullptr while there is none.
    [[nodiscard]] std::shared_ptr<const dynamics::Trajectory> trajectory() const { return trajectory_; }
    [[nodiscard]] std::shared_ptr<const dynamics::StabilityRegion> region() const { return region_; }
    [[nodiscard]] std::shared_ptr<const dynamics::ProbabilityMap> probability() const { return probability_; }
    [[nodiscard]] std::shared_ptr<const dynamics::RegionSweep> sweep() const { return sweep_; }
    /// What the sensors can know along the gap.
    [[nodiscard]] std::shared_ptr<const KnownAlongGap> known() const { return known_; }
    [[nodiscard]] std::vector<View> views() const override;
    void choose_view(const std::string& name, bool shown) override;

protected:
    void draw_again(bool session) override;

private:
    void build();
    void build_controls(QFormLayout& form);
    void act(const std::string& assignment);
    void say(const QString& text);
    void read_model();
    void fill_parameters();
    void show_parameter();
    /// The maps that are shown, the first that of the controls.
    [[nodiscard]] std::vector<std::string> kinds() const;
    PlotView& map(const std::string& kind);
    void place_maps();
    void say_about(const std::string& kind, const QString& text);
    void compute();
    void forget(const std::string& kind);
    void compute_map(const dynamics::RegionOptions& options);
    void compute_probability(const dynamics::RegionOptions& options);
    void compute_sweep(const dynamics::RegionOptions& options);
    void compute_estimator();
    void show_known();
    void compute_motion();
    void compute_pitch_motion();
    /// Heave with pitch: an axis of the map is pitch or its rate.
    [[nodiscard]] bool pitches() const;
    void close_loop(dynamics::RegionOptions& options) const;
    /// A map that failed or was cancelled is not waited for.
    void say_when_nothing(const std::string& kind);
    void fill_kinds();
    /// With the scale of the gap that the state wants.
    void show_map(const std::string& kind, core::Figure figure);
    /// Whether motions of the map that is shown can be drawn: a map of ends with the gap among its axes.
    [[nodiscard]] bool has_motions() const;
    void show_region();
    void start_from(double x, double y);
    void show_trajectory();
    [[nodiscard]] const RegionView& settings() const;
    [[nodiscard]] double duration() const { return settings().duration.value_or(spec_.duration); }
    /// The model with what the state changes.
    [[nodiscard]] dynamics::Model changed_model() const;
    /// What the map, and what the motion was computed of: another one, another computation.
    [[nodiscard]] std::vector<core::NamedRange> axes() const;
    [[nodiscard]] bool by_ratio() const;
    [[nodiscard]] std::string map_key(const std::string& kind) const;
    [[nodiscard]] std::string motion_key() const;

    cases::RegionSpec spec_;
    SessionPointer read_;  ///< what the model was read of
    std::shared_ptr<const dynamics::Model> model_;
    std::shared_ptr<const dynamics::StabilityRegion> region_;
    std::shared_ptr<const dynamics::ProbabilityMap> probability_;
    std::shared_ptr<const dynamics::RegionSweep> sweep_;
    std::shared_ptr<const KnownAlongGap> known_;
    std::shared_ptr<const dynamics::Trajectory> trajectory_;
    std::shared_ptr<const dynamics::PitchTrajectory> pitch_trajectory_;
    std::map<std::string, std::string> map_of_;  ///< kind -> what its map is, or will be, made of
    std::map<std::string, QString> about_of_;    ///< kind -> what is said of its map
    std::string motion_of_;
    QComboBox* choice_ = nullptr;
    QSpinBox* cells_ = nullptr;
    NumberEdit* duration_ = nullptr;
    QComboBox* show_ = nullptr;
    QLineEdit* axes_ = nullptr;
    QCheckBox* logarithmic_ = nullptr;
    QLineEdit* feedback_ = nullptr;
    QLineEdit* sweep_text_ = nullptr;
    NumberEdit* gap_noise_ = nullptr;
    NumberEdit* velocity_noise_ = nullptr;
    NumberEdit* drag_error_ = nullptr;
    QWidget* sensors_ = nullptr;
    QComboBox* parameter_ = nullptr;
    NumberEdit* value_ = nullptr;
    QFormLayout* form_ = nullptr;
    QLabel* changes_label_ = nullptr;
    QPushButton* reset_ = nullptr;
    QLabel* about_ = nullptr;
    QWidget* map_cells_ = nullptr;
    QGridLayout* grid_ = nullptr;
    std::map<std::string, PlotView*> maps_;  ///< of each kind that was shown
    PlotView* motion_ = nullptr;
};

}  // namespace underbody::studio
