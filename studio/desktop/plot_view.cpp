#include "studio/desktop/plot_view.h"

#include <qcustomplot.h>

#include <QAction>
#include <QApplication>
#include <QBoxLayout>
#include <QClipboard>
#include <QKeyEvent>
#include <QPainter>
#include <QTimer>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

bool is_dark(const QPalette& palette) { return palette.color(QPalette::Base).lightness() < 128; }

/// The figure as it is drawn on dark ground: what is black on white is pale there, colours and bands stand out as they
/// do on white. On a map it lies on pale colours.
core::Figure on_dark(core::Figure figure) {
    const auto pale = [&](core::Colour& colour) {
        if (std::max({colour.red, colour.green, colour.blue}) < 80 && figure.classes.empty() && figure.maps.empty()) {
            colour = {225, 225, 225, colour.alpha};
        } else if (figure.classes.empty() && figure.maps.empty()) {
            for (auto* part : {&colour.red, &colour.green, &colour.blue}) {
                *part = static_cast<unsigned char>(*part + (255 - *part) / 4);
            }
        }
    };
    for (auto& curve : figure.curves) {
        pale(curve.colour);
    }
    for (auto& band : figure.bands) {
        pale(band.colour);
        band.colour.alpha = static_cast<unsigned char>(std::min(255, 2 * band.colour.alpha));
    }
    for (auto& points : figure.points) {
        pale(points.colour);
    }
    for (auto& line : figure.lines) {
        pale(line.colour);
    }
    return figure;
}

/// The window's own colours around a figure; exported pictures stay on white.
void dress(QCustomPlot& plot, const QPalette& palette) {
    if (!is_dark(palette)) {
        return;
    }
    const QColor text = palette.color(QPalette::Text);
    QColor pale = text;
    pale.setAlpha(60);
    plot.setBackground(palette.color(QPalette::Base));
    for (auto* rect : plot.axisRects()) {
        for (auto* axis : rect->axes()) {
            for (const auto& set : {&QCPAxis::setBasePen, &QCPAxis::setTickPen, &QCPAxis::setSubTickPen}) {
                (axis->*set)(QPen(text));
            }
            axis->setLabelColor(text);
            axis->setTickLabelColor(text);
            axis->grid()->setPen(QPen(pale, 0, Qt::DotLine));
        }
    }
}

/// Draws a figure in the colours of the window.
void draw_dressed(const core::Figure& figure, QCustomPlot& plot, const QPalette& palette) {
    const bool dark = is_dark(palette);
    plot.setProperty("ink", dark ? QVariant(palette.color(QPalette::Text)) : QVariant());
    draw(dark ? on_dark(figure) : figure, plot);
    dress(plot, palette);
}

/// Curves and points as a spreadsheet takes them.
QString numbers_of(const core::Figure& figure) {
    const auto title = [](const core::FigureAxis& axis) {
        return QString::fromStdString(axis_title(axis.label, axis.unit)).replace('_', ' ');
    };
    QString text = "series\t" + title(figure.x) + "\t" + title(figure.y) + "\n";
    const auto add = [&](const auto& series) {
        for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
            text += QString::fromStdString(series.name) + "\t" + QString::number(series.x[i], 'g', 9) + "\t" +
                    QString::number(series.y[i], 'g', 9) + "\n";
        }
    };
    for (const auto& curve : figure.curves) {
        add(curve);
    }
    for (const auto& points : figure.points) {
        add(points);
    }
    return text;
}

}  // namespace

/// Drawn while it is seen only, and of several each in a turn of the event loop of its own: 3 to 8 ms of processor.
class PlotView::Plot final : public QCustomPlot {
public:
    using QCustomPlot::QCustomPlot;
    void draw_soon() {
        stale_ = true;
        if (isVisible()) {
            wait_for_turn();
        }
    }
    void draw_now() {
        stale_ = false;
        replot(rpQueuedRefresh);
    }
    [[nodiscard]] bool stale() const { return stale_; }

protected:
    void resizeEvent(QResizeEvent* /*event*/) override {
        setViewport(rect());
        draw_soon();
    }
    void showEvent(QShowEvent* event) override {
        QCustomPlot::showEvent(event);
        if (stale_) {
            wait_for_turn();
        }
    }

private:
    static std::vector<QPointer<Plot>>& waiting() {
        static std::vector<QPointer<Plot>> plots;
        return plots;
    }
    void wait_for_turn() {
        if (waiting().empty()) {
            QTimer::singleShot(0, qApp, &Plot::draw_next);
        }
        if (std::find(waiting().begin(), waiting().end(), this) == waiting().end()) {
            waiting().emplace_back(this);
        }
    }
    static void draw_next() {
        bool drawn = false;
        while (!drawn && !waiting().empty()) {
            Plot* const next = waiting().front();
            waiting().erase(waiting().begin());
            drawn = next != nullptr && next->stale_ && next->isVisible();
            if (drawn) {
                next->draw_now();
            }
        }
        if (!waiting().empty()) {
            QTimer::singleShot(0, qApp, &Plot::draw_next);
        }
    }
    bool stale_ = false;
};

PlotView::PlotView(QWidget* parent) : QWidget(parent) {
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(1, 1, 1, 1);  // where the frame of the keyboard is drawn
    plot_ = new Plot(this);
    plot_->setFocusPolicy(Qt::NoFocus);  // a click gives the keyboard to all of this
    column->addWidget(plot_);
    plot_->setInteractions(QCP::iRangeDrag | QCP::iRangeZoom);
    auto* picture = new QAction("Copy &picture", this);
    connect(picture, &QAction::triggered, this, [this] {
        plot_->draw_now();
        QApplication::clipboard()->setPixmap(plot_->grab());
    });
    auto* numbers = new QAction("Copy &numbers", this);
    connect(numbers, &QAction::triggered, this,
            [this] { QApplication::clipboard()->setText(shown_ ? numbers_of(figure_) : sentence_); });
    addActions({picture, numbers});
    setContextMenuPolicy(Qt::ActionsContextMenu);
    plot_->setMinimumSize(260, 200);
    plot_->setToolTip(
        "Wheel: zoom. Drag: move. Double click: show all. Right button: copy.\nKeys: arrows (with Shift finely), "
        "Enter, + and -, Home.");
    connect(plot_, &QCustomPlot::mouseMove, this, [this](QMouseEvent* event) {
        if (shown_ && plot_->axisRect() != nullptr && plot_->axisRect()->rect().contains(event->pos())) {
            say_place(plot_->xAxis->pixelToCoord(event->pos().x()), plot_->yAxis->pixelToCoord(event->pos().y()));
        }
    });
    connect(plot_, &QCustomPlot::mousePress, this, [this](QMouseEvent* event) { pressed_ = event->pos(); });
    connect(plot_, &QCustomPlot::mouseRelease, this, [this](QMouseEvent* event) {
        const bool still = (event->pos() - pressed_).manhattanLength() < 4;
        if (!still) {
            zoomed_ = true;
        } else if (shown_ && event->button() == Qt::LeftButton && plot_->axisRect()->rect().contains(event->pos())) {
            Q_EMIT clicked(plot_->xAxis->pixelToCoord(event->pos().x()), plot_->yAxis->pixelToCoord(event->pos().y()));
        }
    });
    connect(plot_, &QCustomPlot::mouseWheel, this, [this] { zoomed_ = true; });
    connect(plot_, &QCustomPlot::mouseDoubleClick, this, [this] { show_all(); });
}

void PlotView::say_place(double x, double y) {
    const auto part = [](const core::FigureAxis& axis, double value) {
        return QString("%1 %2 %3")
            .arg(QString::fromStdString(axis.label))
            .arg(value, 0, 'g', 4)
            .arg(QString::fromStdString(pretty_unit(axis.unit)));
    };
    Q_EMIT hovered(part(figure_.x, x) + "   " + part(figure_.y, y));
}

void PlotView::show_figure(const core::Figure& figure, bool keep_zoom) {
    const bool keep = keep_zoom && zoomed_ && shown_;
    if (shown_ && keep == zoomed_ && drawn_in_ == palette().cacheKey() && figure == figure_) {
        return;
    }
    drawn_in_ = palette().cacheKey();
    const QCPRange x = keep ? plot_->xAxis->range() : QCPRange();
    const QCPRange y = keep ? plot_->yAxis->range() : QCPRange();
    figure_ = figure;
    shown_ = true;
    setFocusPolicy(Qt::StrongFocus);
    setAccessibleName(
        QString::fromStdString(figure.title.empty() ? figure.y.label + " over " + figure.x.label : figure.title));
    draw_dressed(figure_, *plot_, palette());
    zoomed_ = keep;
    if (keep) {
        plot_->xAxis->setRange(x);
        plot_->yAxis->setRange(y);
    }
    draw_mark();
    plot_->draw_soon();
}

void PlotView::draw_mark() {
    if (!marked_ || !shown_) {
        return;
    }
    if (tracer_ == nullptr) {
        tracer_ = new QCPItemTracer(plot_);
        tracer_->position->setType(QCPItemPosition::ptAxisRectRatio);
        tracer_->setStyle(QCPItemTracer::tsCrosshair);
        tracer_->setPen(QPen(palette().highlight().color(), 1.2));
    }
    tracer_->position->setAxisRect(plot_->axisRect());
    tracer_->position->setCoords(mark_.x(), 1 - mark_.y());
}

namespace {

/// The value at a share of an axis: the box of a figure that was just drawn has no pixels yet.
double value_at(const QCPAxis& axis, double share) {
    const QCPRange range = axis.range();
    return axis.scaleType() == QCPAxis::stLogarithmic ? range.lower * std::pow(range.upper / range.lower, share)
                                                      : range.lower + share * range.size();
}

}  // namespace

void PlotView::move_mark(double right, double up) {
    if (marked_) {  // the first key shows where it stands
        mark_ = {std::clamp(mark_.x() + right, 0.0, 1.0), std::clamp(mark_.y() + up, 0.0, 1.0)};
    }
    marked_ = true;
    draw_mark();
    plot_->draw_soon();
    say_place(value_at(*plot_->xAxis, mark_.x()), value_at(*plot_->yAxis, mark_.y()));
}

void PlotView::zoom(double factor) {
    plot_->xAxis->scaleRange(factor, value_at(*plot_->xAxis, mark_.x()));
    plot_->yAxis->scaleRange(factor, value_at(*plot_->yAxis, mark_.y()));
    zoomed_ = true;
    plot_->draw_soon();
}

void PlotView::keyPressEvent(QKeyEvent* event) {
    if (!shown_ || (event->modifiers() & (Qt::ControlModifier | Qt::AltModifier)) != 0) {
        QWidget::keyPressEvent(event);
        return;
    }
    const double step = (event->modifiers() & Qt::ShiftModifier) != 0 ? 0.002 : 0.02;
    switch (event->key()) {
        case Qt::Key_Left:
            return move_mark(-step, 0);
        case Qt::Key_Right:
            return move_mark(step, 0);
        case Qt::Key_Up:
            return move_mark(0, step);
        case Qt::Key_Down:
            return move_mark(0, -step);
        case Qt::Key_Plus:
        case Qt::Key_Equal:
            return zoom(0.8);
        case Qt::Key_Minus:
            return zoom(1 / 0.8);
        case Qt::Key_Home:
            return show_all();
        case Qt::Key_Return:
        case Qt::Key_Enter:
            if (marked_) {
                Q_EMIT clicked(value_at(*plot_->xAxis, mark_.x()), value_at(*plot_->yAxis, mark_.y()));
            }
            return;
        default:
            QWidget::keyPressEvent(event);
    }
}

void PlotView::focusInEvent(QFocusEvent* event) {
    QWidget::focusInEvent(event);
    update();
}

/// The mark is the keyboard's: it goes with it.
void PlotView::focusOutEvent(QFocusEvent* event) {
    QWidget::focusOutEvent(event);
    if (std::exchange(marked_, false) && tracer_ != nullptr) {
        plot_->removeItem(tracer_);
        plot_->draw_soon();
    }
    update();
}

void PlotView::paintEvent(QPaintEvent*) {
    if (hasFocus()) {
        QPainter painter(this);
        painter.setPen(palette().highlight().color());
        painter.drawRect(rect().adjusted(0, 0, -1, -1));
    }
}

namespace {

/// Plots wrap no text: a sentence is cut into lines that fit a small one.
QString in_lines(const QString& text) {
    constexpr int longest = 44;
    QString all;
    int used = 0;
    for (const QString& word : text.split(' ')) {
        const bool next_line = used > 0 && used + 1 + word.size() > longest;
        all += used == 0 ? word : (next_line ? '\n' : ' ') + word;
        used = next_line ? word.size() : used + (used == 0 ? 0 : 1) + word.size();
    }
    return all;
}

}  // namespace

void PlotView::show_text(const QString& text) {
    sentence_ = text;
    setFocusPolicy(Qt::NoFocus);  // there is nothing to do here
    setAccessibleName(text);
    show_sentence();
}

/// Another theme.
void PlotView::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && plot_ != nullptr) {
        plot_->setBackground(palette().color(QPalette::Base));
        if (shown_) {
            show_figure(core::Figure(figure_), true);
        } else {
            show_sentence();
        }
    }
}

void PlotView::show_sentence() {
    core::Figure empty;
    draw_dressed(empty, *plot_, palette());
    shown_ = false;
    for (auto* axis : plot_->axisRect()->axes()) {
        axis->setVisible(false);
        axis->grid()->setVisible(false);
    }
    auto* label = new QCPItemText(plot_);
    label->position->setType(QCPItemPosition::ptAxisRectRatio);
    label->position->setCoords(0.5, 0.5);
    label->setTextAlignment(Qt::AlignCenter);
    label->setText(in_lines(sentence_));
    label->setColor(palette().color(QPalette::PlaceholderText));
    plot_->draw_soon();
}

bool PlotView::drawn() const { return !plot_->stale(); }

void PlotView::set_least(const QSize& size) { plot_->setMinimumSize(size); }

void PlotView::write(const std::filesystem::path& path) const { write_picture(figure_, path); }

void PlotView::show_all() {
    if (shown_) {
        zoomed_ = false;
        draw_dressed(figure_, *plot_, palette());
        draw_mark();
        plot_->draw_soon();
    }
}

}  // namespace underbody::studio
