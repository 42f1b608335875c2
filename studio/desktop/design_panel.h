// Design: a shape with its numbers; the body, its section and what is known of its forces follow while they move.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "cases/known_lift.h"
#include "cases/study.h"
#include "studio/desktop/live_body.h"
#include "studio/desktop/panel.h"

class QComboBox;
class QLabel;
class QScrollArea;
class QSplitter;
class QTableWidget;
class QTimer;
class QToolButton;
class QVBoxLayout;

namespace underbody::dynamics {
struct StabilityRegion;
}

namespace underbody::tables {
class ForceTable;
}

namespace underbody::studio {

class ParameterRow;
class PlotView;
class SideBySide;
class ViewCell;

/// The stability map of a shape.
struct ShapeMap {
    std::shared_ptr<const dynamics::StabilityRegion> region;  ///< nullptr: there is none
    std::string vehicle;                                      ///< whose it is, in words
    std::string why;                                          ///< there is none
};

class DesignPanel : public Panel {
    Q_OBJECT
public:
    DesignPanel(Desk& desk, QWidget* parent);
    ~DesignPanel() override;

    [[nodiscard]] bool has_picture() const override { return shown_ != nullptr; }
    void export_picture(const std::filesystem::path& path) override;
    /// What is shown: the body of the state once `settled`.
    [[nodiscard]] std::shared_ptr<const LiveBody> shown() const { return shown_; }
    /// True once the body stands in its view.
    [[nodiscard]] bool has_drawn() const { return scene_ && scene_->has_drawn(); }
    [[nodiscard]] QTableWidget* card() const { return card_; }
    /// What the lift that is drawn rests on.
    [[nodiscard]] const cases::KnownLift& lift() const { return lift_; }
    /// The map that is shown; nullptr while there is none.
    [[nodiscard]] std::shared_ptr<const ShapeMap> map() const { return map_; }
    [[nodiscard]] const PlotView* map_plot() const { return map_plot_; }

Q_SIGNALS:
    /// CFD of the shape that is shown is asked for.
    void cfd_wanted();

protected:
    void draw_again(bool session) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void build();
    void build_side(QVBoxLayout& side);
    void make_scene();
    void fill_rows(const std::string& name, const geometry::BodyShape& shape);
    void make_rows();
    struct Group {
        std::string part;
        QToolButton* head = nullptr;
        QWidget* rows = nullptr;
        std::optional<bool> chosen;  ///< by hand
    };
    void show_group(const Group& group);
    /// Its rows are folded away where the shape has no such part, until somebody unfolds them.
    QVBoxLayout& add_group(const std::string& part);
    void add_words(const std::string& part, QVBoxLayout& column);
    void show_groups();
    /// Unfolds the part of a number and gives it the keyboard.
    void find_row(const QString& parameter);
    [[nodiscard]] std::set<std::string> open_groups() const;
    void ask_ranges();
    void connect_row(ParameterRow* row, const std::string& verb, const std::string& key, const std::string& unit);
    void ask_move();
    void ask_rest();
    void ask_added_mass(const std::shared_ptr<const LiveBody>& body, const std::string& key);
    void take(const std::shared_ptr<const LiveBody>& body, const std::string& key);
    void show_body(const std::shared_ptr<const LiveBody>& body);
    void fit_view();
    void build_view_tools();
    void keep_turns();
    void show_view(bool other_body);
    void draw_section();
    void show_card();
    [[nodiscard]] std::vector<std::array<QString, 2>> lift_rows() const;
    void show_lift();
    void learn();
    void fit_lift();
    void draw_lift();
    /// N, of the table that the lift rests on, as it was last set in Tables.
    [[nodiscard]] std::optional<double> net_weight() const;
    void show_map();
    void ask_map();
    void draw_map();
    /// Why there can be no map; empty when there can.
    [[nodiscard]] QString no_map() const;
    [[nodiscard]] std::string region_name() const;
    [[nodiscard]] std::string map_key() const;
    void make_before();
    [[nodiscard]] std::string key_of(const geometry::BodyShape& shape) const;
    [[nodiscard]] geometry::Placement placement() const;
    [[nodiscard]] bool dragging() const;

    struct Known {
        std::string key;
        std::shared_ptr<const LiveBody> body;
    };
    [[nodiscard]] std::shared_ptr<const LiveBody> remembered(const std::string& key) const;

    geometry::BodyShape shape_;
    std::string key_;   ///< of what the state wants
    std::string name_;  ///< of the shape that the rows are of
    std::shared_ptr<const LiveBody> shown_, before_;
    std::deque<Known> cache_;                              ///< whole bodies, newest first
    std::map<std::string, std::array<double, 2>> ranges_;  ///< that the sliders run over
    std::string ranges_of_;
    bool moving_ = false, move_again_ = false;
    std::string rest_of_;  ///< key of the body that "design rest" makes
    QTimer* rest_ = nullptr;
    cases::KnownLift lift_;
    std::vector<cases::NamedShape> named_;  ///< the study's shapes, and whether its cases are of them
    SessionPointer named_of_;
    std::shared_ptr<const cases::LearnedLoads> surrogate_;
    std::string no_surrogate_;  ///< why the study's search gives none
    SessionPointer learned_;    ///< that the surrogate is of
    std::shared_ptr<const tables::ForceTable> table_;
    std::string table_of_;
    SessionPointer fitted_;
    std::shared_ptr<const ShapeMap> map_;
    std::string map_of_;     ///< what the map is, or will be, made of
    SessionPointer mapped_;  ///< likewise
    QTimer* map_rest_ = nullptr;

    std::unique_ptr<Scene> scene_;  ///< none before the first body
    QVBoxLayout* body_place_ = nullptr;
    bool fitted_view_ = false;           ///< to a whole body
    std::optional<ViewPose> seen_from_;  ///< what of the state the view shows
    QToolButton* outline_ = nullptr;
    QToolButton* fit_ = nullptr;
    QComboBox* choice_ = nullptr;
    std::vector<Group> groups_;
    std::vector<std::pair<std::string, ParameterRow*>> rows_;
    std::vector<std::pair<std::string, QComboBox*>> words_;
    ParameterRow* gap_ = nullptr;
    ParameterRow* pitch_ = nullptr;
    ParameterRow* speed_ = nullptr;
    QTableWidget* card_ = nullptr;
    QLabel* state_label_ = nullptr;
    QLabel* lift_label_ = nullptr;
    QLabel* map_label_ = nullptr;
    PlotView* section_ = nullptr;
    QSplitter* upper_ = nullptr;
    ViewCell* body_cell_ = nullptr;
    ViewCell* section_cell_ = nullptr;
    SideBySide* lift_or_map_ = nullptr;
    PlotView* lift_plot_ = nullptr;
    PlotView* map_plot_ = nullptr;
    QVBoxLayout* parameter_column_ = nullptr;
    QScrollArea* parameter_area_ = nullptr;
};

}  // namespace underbody::studio
