// Parallel coordinates: one axis a column, one line a case, ranges dragged on the axes, axes dragged by their titles.
// By keyboard: left and right choose an axis, with Ctrl they move it; up and down move the upper end of its range, with
// Shift the lower one, Delete takes it away.
#pragma once

#include <QLineF>
#include <QPixmap>
#include <QVector>
#include <QWidget>
#include <array>
#include <map>
#include <optional>
#include <vector>

class QPainter;

namespace underbody::studio {

class ParallelView : public QWidget {
    Q_OBJECT
public:
    struct Axis {
        std::string name;
        QString title;
        double factor = 1;  ///< shown = factor * SI
        std::vector<double> values;
        double lower = 0, upper = 1;
        bool logarithmic = false;  ///< its values span decades
    };
    explicit ParallelView(QWidget* parent);
    void show_axes(std::vector<Axis> axes);
    /// `marked`: rows whose lines are drawn strong, whatever is kept.
    void show_brush(const std::map<std::string, std::array<double, 2>>& brush, const std::vector<std::size_t>& kept,
                    const std::vector<std::size_t>& marked = {});
    /// The line of a row, drawn over all others; none: none.
    void point_out(std::optional<std::size_t> row);
    /// As they stand, from the left.
    [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }
    [[nodiscard]] std::optional<std::size_t> pointed_out() const { return pointed_out_; }
    /// What stands there while there is nothing to show.
    void say(const QString& text);
    /// Room above the axes, px: of as many lines as the longest title takes.
    [[nodiscard]] int head() const { return head_; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {300, 150}; }

    /// Where an axis stands, px.
    [[nodiscard]] double x_of(std::size_t axis) const;

Q_SIGNALS:
    /// A range was dragged on an axis; lower == upper: cleared by a click.
    void brushed(const QString& column, double lower, double upper);
    /// An axis is to stand elsewhere: all of them from the left.
    void reordered(const QStringList& columns);

protected:
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void changeEvent(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

private:
    [[nodiscard]] double y_of(const Axis& axis, double value) const;
    [[nodiscard]] double value_at(const Axis& axis, double y) const;
    void move_end(bool upper, int by);
    void move_axis(std::size_t from, std::size_t to);
    void draw_axis(QPainter& painter, std::size_t axis, double x) const;
    /// The place among the axes that is nearest to x.
    [[nodiscard]] std::size_t place_at(double x) const;
    [[nodiscard]] std::array<double, 2> range_of(std::size_t axis) const;
    [[nodiscard]] QVector<QLineF> lines_of(const std::vector<std::size_t>& rows) const;
    void draw_layers();
    [[nodiscard]] static QString title_of(const Axis& axis);
    [[nodiscard]] double title_room() const;
    void give_titles_room();

    std::vector<Axis> axes_;
    std::map<std::string, std::array<double, 2>> brush_;
    std::vector<std::size_t> kept_, marked_;
    std::optional<std::size_t> pointed_out_;
    QPixmap pale_;    ///< all lines, drawn once they are not all kept
    QPixmap bright_;  ///< the kept ones
    QString empty_;
    int head_ = 60;  ///< px above the axes: titles and largest values
    int pressed_ = -1;
    std::size_t chosen_ = 0;  ///< axis that keys act on
    double from_ = 0, to_ = 0;
    int carried_ = -1;  ///< axis whose title is dragged
    double carried_x_ = 0;
};

}  // namespace underbody::studio
