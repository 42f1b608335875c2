#include "studio/desktop/plot_view.h"

#include <qcustomplot.h>

#include <QBoxLayout>
#include <algorithm>

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

}  // namespace

PlotView::PlotView(QWidget* parent) : QWidget(parent) {
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    plot_ = new QCustomPlot(this);
    column->addWidget(plot_);
    plot_->setInteractions(QCP::iRangeDrag | QCP::iRangeZoom);
    plot_->setMinimumSize(260, 200);
    plot_->setToolTip("Wheel: zoom. Drag: move. Double click: show all.");
    connect(plot_, &QCustomPlot::mouseMove, this, [this](QMouseEvent* event) {
        if (shown_ && plot_->axisRect() != nullptr && plot_->axisRect()->rect().contains(event->pos())) {
            const auto part = [](const core::FigureAxis& axis, double value) {
                return QString("%1 %2 %3")
                    .arg(QString::fromStdString(axis.label))
                    .arg(value, 0, 'g', 4)
                    .arg(QString::fromStdString(pretty_unit(axis.unit)));
            };
            Q_EMIT hovered(part(figure_.x, plot_->xAxis->pixelToCoord(event->pos().x())) + "   " +
                           part(figure_.y, plot_->yAxis->pixelToCoord(event->pos().y())));
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

void PlotView::show_figure(const core::Figure& figure, bool keep_zoom) {
    const bool keep = keep_zoom && zoomed_ && shown_;
    const QCPRange x = keep ? plot_->xAxis->range() : QCPRange();
    const QCPRange y = keep ? plot_->yAxis->range() : QCPRange();
    figure_ = figure;
    shown_ = true;
    draw_dressed(figure_, *plot_, palette());
    zoomed_ = keep;
    if (keep) {
        plot_->xAxis->setRange(x);
        plot_->yAxis->setRange(y);
    }
    plot_->replot(QCustomPlot::rpQueuedReplot);
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
    plot_->replot(QCustomPlot::rpQueuedReplot);
}

void PlotView::set_least(const QSize& size) { plot_->setMinimumSize(size); }

void PlotView::write(const std::filesystem::path& path) const { write_picture(figure_, path); }

void PlotView::show_all() {
    if (shown_) {
        zoomed_ = false;
        draw_dressed(figure_, *plot_, palette());
        plot_->replot(QCustomPlot::rpQueuedReplot);
    }
}

}  // namespace underbody::studio
