// The body and what acts on it, in 3D.
#pragma once

#include <memory>

#include "studio/desktop/panel.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QListWidget;
class QStackedLayout;

namespace underbody::studio {

class Scene;

class BodyPanel : public Panel {
    Q_OBJECT
public:
    BodyPanel(Jobs& jobs, QWidget* parent);
    ~BodyPanel() override;

    void show_session(const SessionPointer& session) override;
    void show_case(const cases::Case& chosen) override;
    /// Any CFD file, also one outside the study.
    void show_file(const std::filesystem::path& file, const std::vector<std::string>& zones, const QString& title);
    [[nodiscard]] bool has_picture() const override;
    void export_picture(const std::filesystem::path& path) override;
    void demonstrate() override;

    /// "bottom", "top", "side", "front", "iso"
    void look_from(const QString& view);

private:
    void build();
    void fill_zones();
    void fill_arrays();
    void recolour();
    [[nodiscard]] bool can_draw() const;

    SessionPointer session_;
    std::unique_ptr<Scene> scene_;  ///< null when the machine has no OpenGL
    QLabel* title_ = nullptr;
    QLabel* empty_ = nullptr;
    QListWidget* zones_ = nullptr;
    QComboBox* array_ = nullptr;
    QCheckBox* whole_range_ = nullptr;
    QCheckBox* edges_ = nullptr;
    QCheckBox* mirror_ = nullptr;
    QStackedLayout* stack_ = nullptr;
    std::vector<std::string> wanted_zones_;
    QString kept_array_ = "pressure";
    bool first_ = true;
};

}  // namespace underbody::studio
