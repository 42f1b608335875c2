#include "studio/desktop/parallel_view.h"

#include <QEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/text.h"
#include "studio/desktop/qt_text.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {
constexpr int bottom = 22, side = 60;
}

ParallelView::ParallelView(QWidget* parent) : QWidget(parent) {
    setMouseTracking(true);
    setAccessibleName("Lines over all columns");
    setToolTip(
        "Drag along an axis to keep a range; click on the axis to take it away. Drag its title to move the "
        "axis.\nKeys: "
        "left and right choose an axis (with Ctrl they move it), up and down move the end of its range (with Shift the "
        "lower end), Delete takes it away.");
}

void ParallelView::say(const QString& text) {
    empty_ = text;
    update();
}

void ParallelView::show_axes(std::vector<Axis> axes) {
    const std::string chosen = chosen_ < axes_.size() ? axes_[chosen_].name : std::string();
    axes_ = std::move(axes);
    pointed_out_.reset();
    carried_ = pressed_ = -1;
    const auto same = std::find_if(axes_.begin(), axes_.end(), [&](const Axis& axis) { return axis.name == chosen; });
    chosen_ = same != axes_.end() ? static_cast<std::size_t>(same - axes_.begin())
                                  : std::min(chosen_, axes_.empty() ? 0 : axes_.size() - 1);
    setFocusPolicy(axes_.empty() ? Qt::NoFocus : Qt::StrongFocus);
    for (auto& axis : axes_) {
        axis.lower = INFINITY;
        axis.upper = -INFINITY;
        for (const double value : axis.values) {
            if (std::isfinite(value)) {
                axis.lower = std::min(axis.lower, value);
                axis.upper = std::max(axis.upper, value);
            }
        }
        if (!(axis.lower < axis.upper)) {
            axis.lower = std::isfinite(axis.lower) ? axis.lower - 1 : 0;
            axis.upper = axis.lower + 2;
        }
        axis.logarithmic = tables::spans_decades(axis.lower, axis.upper);
    }
    give_titles_room();
    pale_ = bright_ = {};
    update();
}

void ParallelView::show_brush(const std::map<std::string, std::array<double, 2>>& brush,
                              const std::vector<std::size_t>& kept, const std::vector<std::size_t>& marked) {
    brush_ = brush;
    kept_ = kept;
    marked_ = marked;
    bright_ = {};
    update();
}

void ParallelView::point_out(std::optional<std::size_t> row) {
    if (pointed_out_ != row) {
        pointed_out_ = row;
        update();
    }
}

double ParallelView::x_of(std::size_t axis) const {
    const double room = std::max(1, width() - 2 * side);
    return axes_.size() < 2 ? side + room / 2
                            : side + room * static_cast<double>(axis) / static_cast<double>(axes_.size() - 1);
}

double ParallelView::y_of(const Axis& axis, double value) const {
    const double share =
        axis.logarithmic ? std::log(std::max(value, 1e-3 * axis.lower) / axis.lower) / std::log(axis.upper / axis.lower)
                         : (value - axis.lower) / (axis.upper - axis.lower);
    return height() - bottom - (height() - head_ - bottom) * share;
}

double ParallelView::value_at(const Axis& axis, double y) const {
    const double share = (height() - bottom - y) / std::max(1, height() - head_ - bottom);
    const double inside = std::clamp(share, 0.0, 1.0);
    return axis.logarithmic ? axis.lower * std::pow(axis.upper / axis.lower, inside)
                            : axis.lower + inside * (axis.upper - axis.lower);
}

/// Of the rows, from axis to axis: as lines and no paths, which a software painter joins at every corner.
QVector<QLineF> ParallelView::lines_of(const std::vector<std::size_t>& rows) const {
    QVector<QLineF> lines;
    lines.reserve(static_cast<int>(rows.size() * axes_.size()));
    for (const std::size_t row : rows) {
        QPointF before;
        bool open = false;
        for (std::size_t i = 0; i < axes_.size(); ++i) {
            const double value = row < axes_[i].values.size() ? axes_[i].values[row] : NAN;
            const bool there = std::isfinite(value);
            const QPointF at = there ? QPointF(x_of(i), y_of(axes_[i], value)) : QPointF();
            if (there && open) {
                lines.append({before, at});
            }
            open = there;
            before = at;
        }
    }
    return lines;
}

namespace {

/// Of lines between the same pixels one.
QVector<QLineF> each_once(const QVector<QLineF>& lines, int height) {
    std::map<int, std::vector<bool>> drawn;  // by the axis where they begin: from which pixel to which
    QVector<QLineF> rest;
    for (const QLineF& line : lines) {
        auto& seen = drawn[qRound(line.x1())];
        seen.resize(static_cast<std::size_t>(height) * static_cast<std::size_t>(height));
        const int from = std::clamp(qRound(line.y1()), 0, height - 1),
                  to = std::clamp(qRound(line.y2()), 0, height - 1);
        const auto at =
            static_cast<std::size_t>(from) * static_cast<std::size_t>(height) + static_cast<std::size_t>(to);
        if (!seen[at]) {
            seen[at] = true;
            rest.append(line);
        }
    }
    return rest;
}

}  // namespace

/// All lines, where not all are kept, and the kept ones, each drawn once: a range that is dragged moves over them.
void ParallelView::draw_layers() {
    const auto begin = [this](QPixmap& layer) {
        layer = QPixmap(size() * devicePixelRatioF());
        layer.setDevicePixelRatio(devicePixelRatioF());
        layer.fill(Qt::transparent);
    };
    const std::size_t rows = axes_.front().values.size();
    constexpr std::size_t few = 2000;  // of more no single one is seen
    const auto add = [&](QPainter& painter, const std::vector<std::size_t>& of, QColor colour, double width) {
        if (of.size() < few) {
            painter.setPen(QPen(colour, width));
            painter.drawLines(lines_of(of));
            return;
        }
        colour.setAlpha(254);  // Qt takes ten times as long for thin lines that nothing shines through
        painter.setPen(QPen(colour, 1));
        painter.drawLines(each_once(lines_of(of), std::max(1, height())));
    };
    if (kept_.size() < rows && pale_.size() != size() * devicePixelRatioF()) {
        begin(pale_);
        QPainter painter(&pale_);
        QColor colour = palette().text().color();
        colour.setAlpha(40);
        painter.setPen(colour);
        std::vector<std::size_t> all(rows);
        std::iota(all.begin(), all.end(), std::size_t(0));
        painter.drawLines(rows < few ? lines_of(all) : each_once(lines_of(all), std::max(1, height())));
    }
    if (bright_.size() != size() * devicePixelRatioF()) {
        begin(bright_);
        QPainter painter(&bright_);
        painter.setRenderHint(QPainter::Antialiasing, kept_.size() < few);
        add(painter, kept_, palette().highlight().color(), 1.4);
        add(painter, marked_, palette().text().color(), 2.4);
    }
}

void ParallelView::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.fillRect(rect(), palette().base());
    if (axes_.empty()) {
        painter.setPen(palette().placeholderText().color());
        painter.drawText(rect(), Qt::AlignCenter, empty_);
        return;
    }
    draw_layers();
    if (kept_.size() < axes_.front().values.size()) {
        painter.drawPixmap(0, 0, pale_);
    }
    painter.drawPixmap(0, 0, bright_);
    painter.setRenderHint(QPainter::Antialiasing, kept_.size() < 2000);
    if (pointed_out_) {
        const QVector<QLineF> line = lines_of({*pointed_out_});
        painter.setPen(QPen(palette().base().color(), 6));  // seen between many others
        painter.drawLines(line);
        painter.setPen(QPen(palette().text().color(), 3));
        painter.drawLines(line);
    }
    for (std::size_t i = 0; i < axes_.size(); ++i) {
        if (carried_ == static_cast<int>(i)) {
            painter.setOpacity(0.35);
        }
        draw_axis(painter, i, x_of(i));
        painter.setOpacity(1);
    }
    if (carried_ >= 0) {
        draw_axis(painter, static_cast<std::size_t>(carried_), carried_x_);
        painter.setPen(QPen(palette().highlight().color(), 3));
        const double x = x_of(place_at(carried_x_));
        painter.drawLine(QPointF(x - 12, head_ - 2), QPointF(x + 12, head_ - 2));
    }
}

std::array<double, 2> ParallelView::range_of(std::size_t axis) const {
    if (pressed_ == static_cast<int>(axis)) {
        return {std::min(from_, to_), std::max(from_, to_)};
    }
    const auto at = brush_.find(axes_[axis].name);
    return at != brush_.end() ? at->second : std::array<double, 2>{NAN, NAN};
}

void ParallelView::draw_axis(QPainter& painter, std::size_t index, double x) const {
    const Axis& axis = axes_[index];
    const bool strong = (hasFocus() && index == chosen_) || carried_ == static_cast<int>(index);
    painter.setPen(strong ? QPen(palette().highlight().color(), 3) : QPen(palette().text().color(), 1));
    painter.drawLine(QPointF(x, head_), QPointF(x, height() - bottom));
    painter.setPen(QPen(palette().text().color(), 1));
    const double room = title_room();
    painter.drawText(QRectF(x - room / 2, 2, room, head_ - 26), Qt::AlignHCenter | Qt::AlignBottom | Qt::TextWordWrap,
                     title_of(axis));
    const auto text = [&](double value) { return qt(core::format_number(axis.factor * value, 4)); };
    painter.drawText(QRectF(x - 60, head_ - 22, 120, 18), Qt::AlignCenter, text(axis.upper));
    painter.drawText(QRectF(x - 60, height() - bottom + 2, 120, 18), Qt::AlignCenter, text(axis.lower));
    const std::array<double, 2> range = range_of(index);
    if (std::isnan(range[0])) {
        return;
    }
    const QRectF box(QPointF(x - 7, y_of(axis, std::min(range[1], axis.upper))),
                     QPointF(x + 7, y_of(axis, std::max(range[0], axis.lower))));
    QColor fill = palette().highlight().color();
    fill.setAlpha(90);
    painter.fillRect(box, fill);
    painter.drawRect(box);
    // The two numbers stand apart, however narrow the range.
    const double apart = std::max(0.0, fontMetrics().height() - box.height()) / 2;
    painter.drawText(QPointF(x + 10, box.top() + 4 - apart), text(range[1]));
    painter.drawText(QPointF(x + 10, box.bottom() + 4 + apart), text(range[0]));
}

void ParallelView::resizeEvent(QResizeEvent*) {
    pale_ = bright_ = {};
    give_titles_room();
}

QString ParallelView::title_of(const Axis& axis) { return QString(axis.title).replace('_', ' ').replace('.', ' '); }

double ParallelView::title_room() const { return axes_.size() < 2 ? 140 : std::min(140.0, x_of(1) - x_of(0) - 4); }

/// As many lines as the longest title takes between its neighbours.
void ParallelView::give_titles_room() {
    int lines = fontMetrics().height();
    for (const auto& axis : axes_) {
        const QRect room(0, 0, static_cast<int>(title_room()), 1000);
        lines = std::max(
            lines, fontMetrics().boundingRect(room, Qt::AlignHCenter | Qt::TextWordWrap, title_of(axis)).height());
    }
    head_ = std::min(lines + 28, std::max(60, height() / 2));
}

void ParallelView::changeEvent(QEvent* event) {
    if (event->type() == QEvent::PaletteChange) {
        pale_ = bright_ = {};
        update();
    }
    QWidget::changeEvent(event);
}

void ParallelView::move_end(bool upper, int by) {
    const Axis& axis = axes_[chosen_];
    const auto known = brush_.find(axis.name);
    std::array<double, 2> range = known == brush_.end() ? std::array<double, 2>{axis.lower, axis.upper} : known->second;
    double& end = range[upper ? 1 : 0];
    constexpr double step = 0.05;  // of the axis
    end = value_at(axis, y_of(axis, end) - by * step * std::max(1, height() - head_ - bottom));
    if (range[0] < range[1]) {
        Q_EMIT brushed(qt(axis.name), range[0], range[1]);
    }
}

std::size_t ParallelView::place_at(double x) const {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < axes_.size(); ++i) {
        nearest = std::abs(x_of(i) - x) < std::abs(x_of(nearest) - x) ? i : nearest;
    }
    return nearest;
}

void ParallelView::move_axis(std::size_t from, std::size_t to) {
    if (from == to) {
        return;
    }
    QStringList names;
    for (const auto& axis : axes_) {
        names << qt(axis.name);
    }
    names.move(static_cast<int>(from), static_cast<int>(to));
    chosen_ = from;  // follows its axis when they are shown
    Q_EMIT reordered(names);
}

void ParallelView::keyPressEvent(QKeyEvent* event) {
    const bool shift = (event->modifiers() & Qt::ShiftModifier) != 0;
    const bool control = (event->modifiers() & Qt::ControlModifier) != 0;
    const bool sideways = event->key() == Qt::Key_Left || event->key() == Qt::Key_Right;
    const bool own = !axes_.empty() && (event->modifiers() & Qt::AltModifier) == 0 && (!control || sideways);
    const int key = own ? event->key() : 0;
    if (control && key == Qt::Key_Left) {
        move_axis(chosen_, chosen_ - (chosen_ > 0 ? 1 : 0));
    } else if (control && key == Qt::Key_Right) {
        move_axis(chosen_, std::min(chosen_ + 1, axes_.size() - 1));
    } else if (key == Qt::Key_Left || key == Qt::Key_Right) {
        chosen_ = key == Qt::Key_Right ? std::min(chosen_ + 1, axes_.size() - 1) : chosen_ - (chosen_ > 0 ? 1 : 0);
        update();
    } else if (key == Qt::Key_Up || key == Qt::Key_Down) {
        move_end(!shift, key == Qt::Key_Up ? 1 : -1);
    } else if (key == Qt::Key_Delete || key == Qt::Key_Backspace) {
        Q_EMIT brushed(qt(axes_[chosen_].name), 0, 0);
    } else {
        QWidget::keyPressEvent(event);
    }
}

void ParallelView::mousePressEvent(QMouseEvent* event) {
    pressed_ = carried_ = -1;
    if (axes_.empty() || event->button() != Qt::LeftButton) {
        return;
    }
    const std::size_t nearest = place_at(event->pos().x());
    const double off = std::abs(event->pos().x() - x_of(nearest));
    if (event->pos().y() < head_ - 22 && off < title_room() / 2) {  // on its title
        carried_ = static_cast<int>(nearest);
        carried_x_ = event->pos().x();
        chosen_ = nearest;
    } else if (off < 14) {
        pressed_ = static_cast<int>(nearest);
        from_ = to_ = value_at(axes_[nearest], event->pos().y());
    }
    update();
}

void ParallelView::mouseMoveEvent(QMouseEvent* event) {
    const bool held = (event->buttons() & Qt::LeftButton) != 0;
    if (pressed_ >= 0 && held) {
        to_ = value_at(axes_[static_cast<std::size_t>(pressed_)], event->pos().y());
        update();
    } else if (carried_ >= 0 && held) {
        carried_x_ = event->pos().x();
        update();
    } else if (!axes_.empty()) {
        const double off = std::abs(event->pos().x() - x_of(place_at(event->pos().x())));
        const bool title = event->pos().y() < head_ - 22 && off < title_room() / 2;
        setCursor(title ? Qt::OpenHandCursor : Qt::ArrowCursor);
    }
}

void ParallelView::mouseReleaseEvent(QMouseEvent*) {
    if (carried_ >= 0) {
        const auto from = static_cast<std::size_t>(carried_);
        carried_ = -1;
        update();
        move_axis(from, place_at(carried_x_));
        return;
    }
    if (pressed_ < 0) {
        return;
    }
    const Axis& axis = axes_[static_cast<std::size_t>(pressed_)];
    pressed_ = -1;
    const bool click = std::abs(y_of(axis, from_) - y_of(axis, to_)) < 4;
    const double low = std::min(from_, to_);
    Q_EMIT brushed(qt(axis.name), low, click ? low : std::max(from_, to_));
    update();
}

}  // namespace underbody::studio
