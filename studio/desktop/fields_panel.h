// Compare: the surfaces of one to six cases side by side, with one camera, array, range and set of zones.
#pragma once

#include <memory>
#include <vector>

#include "core/inputs.h"
#include "postproc/loads/loads.h"
#include "studio/desktop/panel.h"
#include "studio/desktop/scene.h"

class QCheckBox;
class QComboBox;
class QGridLayout;
class QLabel;
class QLineEdit;
class QListWidget;
class QStackedLayout;

namespace underbody::studio {

class CompareNumbers;
class FittedPicture;
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
    /// How many cells show their difference to the first.
    [[nodiscard]] std::size_t differences() const;
    [[nodiscard]] Sheet sheet() const;
    [[nodiscard]] QImage picture_to_copy() const override;
    [[nodiscard]] CompareNumbers* numbers() const { return numbers_; }

protected:
    void draw_again(bool session) override;

private:
    struct Source {
        std::string id;
        std::filesystem::path file;
        std::vector<std::string> zones;
        QString title;
    };
    struct Cell {
        QWidget* box = nullptr;
        QLabel* title = nullptr;
        std::unique_ptr<Scene> scene;
        FittedPicture* difference = nullptr;  ///< in place of the scene
        std::shared_ptr<const postproc::Field> field;
        std::shared_ptr<const postproc::LoadsResult> loads;
        std::string no_loads;  ///< why there are none
        Source source;
        core::FileStamp stamp;
        bool ready = false;
        QString empty;  ///< why nothing is seen
    };
    void build();
    void build_controls(QWidget& side);
    [[nodiscard]] std::vector<Source> wanted() const;
    [[nodiscard]] Source source_of(const cases::Case& one) const;
    void lay_out(const std::vector<Source>& sources);
    void read(std::size_t cell);
    void taken(std::size_t cell, const std::shared_ptr<const postproc::Field>& field,
               const std::shared_ptr<const Scene::Prepared>& prepared);
    [[nodiscard]] postproc::LoadsOptions loads_options(const Source& source) const;
    void show_numbers();
    [[nodiscard]] bool dark() const;
    void fill_controls();
    void recolour();
    void look_from(const std::string& camera);
    void show_differences();
    void draw_differences(const std::vector<std::size_t>& cells, const std::string& array);
    [[nodiscard]] Cell* first_ready() const;

    std::vector<std::unique_ptr<Cell>> cells_;
    std::string camera_;  ///< that the cells are seen from
    QGridLayout* grid_ = nullptr;
    QStackedLayout* stack_ = nullptr;
    QLabel* empty_ = nullptr;
    QListWidget* zones_ = nullptr;
    QComboBox* array_ = nullptr;
    QLineEdit* range_ = nullptr;
    QLabel* range_shown_ = nullptr;
    QCheckBox* whole_range_ = nullptr;
    QCheckBox* edges_ = nullptr;
    QCheckBox* mirror_ = nullptr;
    QCheckBox* difference_ = nullptr;
    std::string differences_of_;  ///< what is drawn as differences, or being drawn
    CompareNumbers* numbers_ = nullptr;
    QString unit_;  ///< of the colours
};

}  // namespace underbody::studio
