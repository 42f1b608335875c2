// What measurements say about the model: residual, verdict, error before and after, as the study's store holds them.
#pragma once

#include <QColor>
#include <QImage>
#include <utility>
#include <vector>

#include "studio/desktop/panel.h"

class QComboBox;
class QPushButton;
class QTextBrowser;

namespace underbody::studio {

class DiscoveryPanel : public Panel {
    Q_OBJECT
public:
    DiscoveryPanel(Desk& desk, QWidget* parent);
    [[nodiscard]] bool has_picture() const override;
    [[nodiscard]] QStringList picture_endings() const override { return {".png"}; }
    void export_picture(const std::filesystem::path& path) override;
    /// The catalogue of effects, in a window of its own.
    void show_catalogue();

    [[nodiscard]] const QTextBrowser* page() const { return page_; }

Q_SIGNALS:
    /// The found model of this measurement is to be written into the study.
    void write_wanted(const QString& measurement);

protected:
    void draw_again(bool session) override;
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    /// What pictures are of, and the page that they are fitted to.
    struct Fitted {
        SessionPointer session;
        std::string name;
        int pixels = 0;  ///< across
        QColor ground;
        bool operator==(const Fitted&) const = default;
    };
    void show_measurement();
    QString pictures_of(const std::string& name);
    Fitted fitted_;
    std::vector<std::pair<QString, QImage>> images_;  ///< address in the page, and picture
    std::string shown_;                               ///< the measurement whose page it is
    int drawn_for_ = 0;                               ///< width of the page that its pictures are fitted to, px
    QComboBox* choice_ = nullptr;
    QPushButton* accept_ = nullptr;
    QPushButton* write_ = nullptr;
    QTextBrowser* page_ = nullptr;
};

/// The verdict of a `discovery.json` (interfaces, section 6) as HTML. Keys that are missing are left out.
QString discovery_page(const std::string& json);

}  // namespace underbody::studio
