// Compare: the surfaces of one to six cases side by side, with one camera, array, range and set of zones.
#pragma once

#include <memory>
#include <vector>

#include "core/inputs.h"
#include "postproc/field/field.h"
#include "postproc/loads/half_model.h"
#include "postproc/loads/loads.h"
#include "postproc/views/views.h"
#include "studio/desktop/panel.h"
#include "studio/desktop/scene.h"

class QBoxLayout;
class QCheckBox;
class QComboBox;
class QGridLayout;
class QLabel;
class QLineEdit;
class QListWidget;
class QPushButton;
class QStackedLayout;
class QToolButton;

namespace underbody::studio {

class CompareNumbers;
class FittedPicture;
class UnitSheet;
struct Sheet;

class FieldsPanel : public Panel {
    Q_OBJECT
public:
    FieldsPanel(Desk& desk, QWidget* parent);
    ~FieldsPanel() override;

    [[nodiscard]] bool has_picture() const override;
    [[nodiscard]] QStringList picture_endings() const override { return {".png", ".pdf", ".svg"}; }
    void export_picture(const std::filesystem::path& path) override;
    [[nodiscard]] bool has_table() const override;
    void export_table(const std::filesystem::path& path) override;
    /// How many cells show a field that is read.
    [[nodiscard]] std::size_t drawn() const;
    /// True while a stand-in is seen in the place of very many faces.
    [[nodiscard]] bool stands_in(std::size_t cell) const { return cells_.at(cell)->scene->stands_in(); }
    /// How many cells show a picture in the place of their surface: their difference to the first, a plane,
    /// streamlines.
    [[nodiscard]] std::size_t pictures() const;
    /// The sentence that a cell shows in the place of a picture.
    [[nodiscard]] QString said(std::size_t cell) const;
    /// What of the chosen is shown; empty: all that is chosen.
    [[nodiscard]] QString said_of_choice() const;
    /// Why the file of a cell was not read; empty: it was, or will be.
    [[nodiscard]] QString failed(std::size_t cell) const;
    /// The values at the place that is probed, a line a cell; empty: none is.
    [[nodiscard]] QString probed() const;
    /// Where what a file does not say is asked for.
    [[nodiscard]] UnitSheet& unit_sheet();
    [[nodiscard]] Sheet sheet() const;
    [[nodiscard]] QImage picture_to_copy() const override;
    [[nodiscard]] CompareNumbers* numbers() const { return numbers_; }
    /// Makes a zone of the file in that cell part of the body, or takes it out (an action); in each cell that has such
    /// a zone where there is no such cell.
    void mark_zone(std::size_t cell, const std::string& zone, bool body);
    /// Takes the model that looks like a half one as that (an action); nothing where none does.
    void take_half();

protected:
    void draw_again(bool session) override;

private:
    struct Source {
        std::string id;
        std::filesystem::path file;
        std::vector<std::string> zones;
        QString title;
        postproc::ReadOptions reading;
        std::string symmetry;
        std::optional<double> density;
        /// Differs where the file is another one, or is to be read otherwise.
        [[nodiscard]] std::string key() const;
    };
    struct Cell {
        QWidget* box = nullptr;
        QLabel* title = nullptr;
        std::unique_ptr<Scene> scene;
        FittedPicture* picture = nullptr;  ///< in place of the scene: a picture, or why there is none
        QString failed;                    ///< why the file was not read
        std::shared_ptr<const postproc::Field> field;
        std::shared_ptr<const postproc::LoadsResult> loads;
        std::string no_loads;  ///< why there are none
        Source source;
        core::FileStamp stamp;
        std::optional<postproc::LikelyHalf> half;  ///< what its boundaries say
        std::string shown;                         ///< whose surface it is, also while a newer one is read
        bool ready = false;
        bool reading = false;  ///< what is drawn is of what stood here before
        [[nodiscard]] QString mark() const { return reading ? "   (reading; still the picture before)" : ""; }
        QString empty;  ///< why nothing is seen
    };
    void build();
    void build_controls(QWidget& side);
    void add_view_choice(QBoxLayout& left);
    void add_colours(QBoxLayout& left);
    void add_switches(QBoxLayout& left);
    void add_cameras(QBoxLayout& left);
    void add_body(QBoxLayout& left);
    void follow_controls();
    [[nodiscard]] std::vector<Source> wanted() const;
    /// Where not the chosen cases are shown, or not all of them: what is.
    [[nodiscard]] QString said_of_choice(const std::vector<Source>& sources) const;
    /// Cases beside each other are titled by what tells them apart; returns what all have in common.
    [[nodiscard]] QString title_by_difference(std::vector<Source>& sources) const;
    [[nodiscard]] Source source_of(const cases::Case& one) const;
    [[nodiscard]] Source source_of(const std::filesystem::path& file) const;
    void lay_out(const std::vector<Source>& sources);
    void read(std::size_t cell);
    void warn_of_loads(std::size_t cell);
    void taken(std::size_t cell, const std::shared_ptr<const postproc::Field>& field,
               const std::shared_ptr<const Scene::Prepared>& prepared);
    [[nodiscard]] postproc::LoadsOptions loads_options(const Source& source) const;
    void show_numbers();
    [[nodiscard]] bool dark() const;
    void fill_controls();
    QWidget* build_time();
    void build_probe(QBoxLayout& column);
    void fill_time();
    /// The time that is shown and the one so many after it.
    void step_time(int by);
    void show_probe();
    void offer_half();
    void tint_bodies();
    [[nodiscard]] std::vector<bool> body_zones(const Cell& cell) const;
    void zone_menu(std::size_t cell, const std::string& zone, const QPoint& place);
    void picked(std::size_t cell, const Scene::Picked& found);
    void check_names();
    void recolour();
    /// As the state says, where it is not so already.
    void look();
    void keep_turn(const Scene::Pose& pose);
    [[nodiscard]] static std::string seen_from(const FieldView& view);
    void not_read(std::size_t cell, const QString& why);
    void ask_units();
    void show_pictures();
    [[nodiscard]] postproc::ViewOptions view_options(const Cell& cell) const;
    [[nodiscard]] std::function<void()> shown_later(const std::vector<std::size_t>& cells, std::vector<QImage> images,
                                                    std::vector<QString> said, const std::string& key);
    void draw_views(const std::vector<std::size_t>& cells, const std::string& name);
    void draw_differences(const std::vector<std::size_t>& cells, const std::string& array);
    [[nodiscard]] Cell* first_ready() const;

    std::vector<std::unique_ptr<Cell>> cells_;
    std::string camera_;    ///< that the cells are seen from, or as they are turned
    bool by_hand_ = false;  ///< what is drawn was turned by hand: the state follows it, not it the state
    FieldView checked_;     ///< whose names of arrays and zones were looked for in the files
    QGridLayout* grid_ = nullptr;
    QStackedLayout* stack_ = nullptr;
    QWidget* fields_ = nullptr;
    QLabel* empty_ = nullptr;
    QLabel* choice_said_ = nullptr;
    QListWidget* zones_ = nullptr;
    QComboBox* array_ = nullptr;
    QLineEdit* range_ = nullptr;
    QLabel* range_shown_ = nullptr;
    QToolButton* keep_range_ = nullptr;
    std::optional<std::array<double, 2>> range_now_;  ///< of the colours, given or of what is seen
    QCheckBox* whole_range_ = nullptr;
    QCheckBox* edges_ = nullptr;
    QCheckBox* mirror_ = nullptr;
    QCheckBox* difference_ = nullptr;
    std::string pictures_of_;  ///< what is drawn as pictures, or being drawn
    UnitSheet* unit_sheet_ = nullptr;
    QComboBox* view_ = nullptr;
    QWidget* time_row_ = nullptr;
    QComboBox* time_ = nullptr;
    std::vector<double> times_;  ///< of the files that are shown, s
    QPushButton* body_mode_ = nullptr;
    QPushButton* half_offer_ = nullptr;
    QWidget* probe_row_ = nullptr;
    QLabel* probe_ = nullptr;
    std::string probe_of_;  ///< what stands there, or is being looked up
    QPushButton* units_ = nullptr;
    CompareNumbers* numbers_ = nullptr;
    QString unit_;    ///< of the colours
    QString shared_;  ///< conditions that all cases beside each other have
};

}  // namespace underbody::studio
