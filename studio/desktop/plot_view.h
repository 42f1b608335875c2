// A figure in the window: wheel zooms, drag moves, a double click shows all again, the mouse reads coordinates. By
// keyboard: arrows move a mark that reads them, Enter is a click there, + and - zoom about it, Home shows all.
#pragma once

#include <QPointer>
#include <QWidget>
#include <filesystem>

#include "core/figure.h"

class QCPItemTracer;

namespace underbody::studio {

class PlotView : public QWidget {
    Q_OBJECT
public:
    explicit PlotView(QWidget* parent);

    /// `keep_zoom`: the range that the user has zoomed to stays (the same kind of figure with new numbers).
    void show_figure(const core::Figure& figure, bool keep_zoom = false);
    void show_text(const QString& text);
    [[nodiscard]] bool has_figure() const { return shown_; }
    [[nodiscard]] const core::Figure& figure() const { return figure_; }
    /// False while it is still to be drawn.
    [[nodiscard]] bool drawn() const;
    /// What stands in the place of a figure.
    [[nodiscard]] QString sentence() const { return shown_ ? QString() : sentence_; }
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
    void keyPressEvent(QKeyEvent* event) override;
    void focusInEvent(QFocusEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void paintEvent(QPaintEvent* event) override;

private:
    void show_sentence();
    void say_place(double x, double y);
    void move_mark(double right, double up);
    void zoom(double factor);
    /// Anew with every figure, which takes all items away.
    void draw_mark();
    void show_all();
    class Plot;
    Plot* plot_ = nullptr;
    core::Figure figure_;
    QString sentence_;
    bool shown_ = false;
    qint64 drawn_in_ = 0;  ///< the colours of the window that it was drawn in
    bool zoomed_ = false;
    QPoint pressed_;
    QPointF mark_{0.5, 0.5};  ///< share of the axes' box, from its lower left corner
    bool marked_ = false;
    QPointer<QCPItemTracer> tracer_;
};

}  // namespace underbody::studio
