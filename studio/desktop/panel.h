// What the window knows of its panels: each is drawn from the state and the session alone.
#pragma once

#include <QImage>
#include <QWidget>
#include <filesystem>
#include <functional>

#include "studio/desktop/desk.h"

namespace underbody::studio {

class Panel : public QWidget {
    Q_OBJECT
public:
    Panel(Desk& desk, QWidget* parent);

    /// A view that has a cell in the workspace, or may have one.
    struct View {
        std::string name;
        QString title;
        bool shown = true;
    };
    /// What may be chosen, in the order of the cells.
    [[nodiscard]] virtual std::vector<View> views() const;
    /// Shows or hides one; the last one stays.
    virtual void choose_view(const std::string& name, bool shown);

    /// File > Export picture: false when the panel has none. `picture_endings`: ".png", ".pdf".
    [[nodiscard]] virtual bool has_picture() const { return false; }
    [[nodiscard]] virtual QStringList picture_endings() const { return {".png", ".pdf"}; }
    virtual void export_picture(const std::filesystem::path&) {}
    /// Edit > Copy picture; by default what is seen of the panel.
    [[nodiscard]] virtual QImage picture_to_copy() const;
    /// File > Export table (CSV).
    [[nodiscard]] virtual bool has_table() const { return false; }
    virtual void export_table(const std::filesystem::path&) {}

Q_SIGNALS:
    /// For the status bar: what is under the mouse, what was just done.
    void remark(const QString& text);
    /// A finding for the list of problems.
    void problem(const core::Problem& problem);

protected:
    /// Draws everything again. `session`: what is open is new, not only the state. Called when the panel is seen only.
    virtual void draw_again(bool session) = 0;
    void showEvent(QShowEvent* event) override;
    void changeEvent(QEvent* event) override;

    [[nodiscard]] bool shows(const std::string& view) const { return state().shows(objectName().toStdString(), view); }
    [[nodiscard]] const State& state() const { return desk_.state(); }
    [[nodiscard]] const Session& session() const { return desk_.session(); }
    Desk& desk_;
    Jobs& jobs_;

private:
    void out_of_date(bool session);
    bool old_state_ = true;
    bool old_session_ = true;
};

}  // namespace underbody::studio
