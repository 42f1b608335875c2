// A figure in the window: wheel zooms, drag moves, a double click shows all again, the mouse reads coordinates.
#pragma once

#include <QWidget>
#include <filesystem>
#include <functional>

#include "core/figure.h"

class QCustomPlot;

namespace underbody::studio {

class PlotView : public QWidget {
    Q_OBJECT
public:
    explicit PlotView(QWidget* parent);

    /// `keep_zoom`: the range that the user has zoomed to stays (the same kind of figure with new numbers).
    void show_figure(const core::Figure& figure, bool keep_zoom = false);
    void show_text(const QString& text);
    [[nodiscard]] bool has_figure() const { return shown_; }
    /// The least room that it asks for, px.
    void set_least(const QSize& size);
    /// As drawn in a file, by the ending.
    void write(const std::filesystem::path& path) const;

Q_SIGNALS:
    /// Coordinates under the mouse, in the axes' units, for the status bar.
    void hovered(const QString& text);
    /// A click (not a drag) inside the axes.
    void clicked(double x, double y);

protected:
    void changeEvent(QEvent* event) override;

private:
    void show_sentence();
    void show_all();
    QCustomPlot* plot_ = nullptr;
    core::Figure figure_;
    QString sentence_;
    bool shown_ = false;
    bool zoomed_ = false;
    QPoint pressed_;
};

}  // namespace underbody::studio
