// Every picture that the study's store holds: views of cases, plots, comparisons.
#pragma once

#include <QPixmap>

#include "studio/desktop/panel.h"

class QLabel;
class QListWidget;
class QScrollArea;

namespace underbody::studio {

/// What a stored picture shows, for people: "pressure on the underbody: ellipse-h5-p0".
QString picture_title(const cases::StudyResults& results, const std::string& key);

class PicturesPanel : public Panel {
    Q_OBJECT
public:
    PicturesPanel(Desk& desk, QWidget* parent);
    [[nodiscard]] bool has_picture() const override;
    [[nodiscard]] QStringList picture_endings() const override { return {".png"}; }
    void export_picture(const std::filesystem::path& path) override;

protected:
    void draw_again(bool session) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void choose();
    void fit();

    QListWidget* list_ = nullptr;
    QScrollArea* area_ = nullptr;
    QLabel* picture_ = nullptr;
    QLabel* caption_ = nullptr;
    QPixmap whole_;
};

}  // namespace underbody::studio
