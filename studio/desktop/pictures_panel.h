// Every picture that the study's store holds: views of cases, plots, comparisons.
#pragma once

#include <QPixmap>

#include "studio/desktop/panel.h"

class QLabel;
class QListWidget;
class QScrollArea;

namespace underbody::studio {

class PicturesPanel : public Panel {
    Q_OBJECT
public:
    PicturesPanel(Jobs& jobs, QWidget* parent);
    void show_session(const SessionPointer& session) override;
    /// The pictures of that case, when there are any.
    void show_case(const cases::Case& chosen) override;
    [[nodiscard]] bool has_picture() const override;
    void export_picture(const std::filesystem::path& path) override;
    void demonstrate() override;

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void choose();
    void fit();

    SessionPointer session_;
    QListWidget* list_ = nullptr;
    QScrollArea* area_ = nullptr;
    QLabel* picture_ = nullptr;
    QLabel* caption_ = nullptr;
    QPixmap whole_;
};

}  // namespace underbody::studio
