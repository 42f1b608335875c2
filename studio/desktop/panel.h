// What the window knows of its panels.
#pragma once

#include <QWidget>
#include <filesystem>
#include <functional>

#include "studio/desktop/session.h"

namespace underbody::studio {

class Jobs;

class Panel : public QWidget {
    Q_OBJECT
public:
    Panel(Jobs& jobs, QWidget* parent) : QWidget(parent), jobs_(jobs) {}

    /// A study was opened or its results are newer.
    virtual void show_session(const SessionPointer& session) = 0;
    /// A case was chosen in the tree.
    virtual void show_case(const cases::Case&) {}
    /// File > Export picture: false when the panel has none.
    [[nodiscard]] virtual bool has_picture() const { return false; }
    virtual void export_picture(const std::filesystem::path&) {}
    /// File > Export table (CSV).
    [[nodiscard]] virtual bool has_table() const { return false; }
    virtual void export_table(const std::filesystem::path&) {}
    /// For --screenshot: does the one thing that shows what the panel is for (moves the slider, clicks a start).
    virtual void demonstrate() {}

Q_SIGNALS:
    /// For the status bar: what is under the mouse, what was just done.
    void remark(const QString& text);
    /// A finding for the list of problems.
    void problem(const core::Problem& problem);

protected:
    Jobs& jobs_;
};

}  // namespace underbody::studio
