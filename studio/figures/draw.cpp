// core::Figure into a QCustomPlot.
#include <algorithm>
#include <cmath>
#include <map>

#include "studio/figures/colour_scale.h"
#include "studio/figures/elements.h"
#include "studio/figures/ranges.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

const QColor axis_colour(90, 90, 90);
const QColor text_colour(40, 40, 40);

/// Text as people write it: names of quantities without their underscores ("lift_force"; "C_L" stays).
QString words(const std::string& text) {
    // A name of a case or file ("ellipse_front-h3-p0") is none: it stands as it is written elsewhere.
    static const QRegularExpression key("(?<![\\w.-])[a-z]{2,}(_[a-z]{2,})+(?![\\w-])");
    QString said = QString::fromStdString(text);
    for (auto found = key.globalMatch(said); found.hasNext();) {
        const auto match = found.next();
        said.replace(match.capturedStart(), match.capturedLength(), match.captured().replace('_', ' '));
    }
    return said.replace("+-", "±");
}

QPen curve_pen(const core::FigureCurve& curve) {
    return {to_qt(curve.colour), curve.width, curve.dashed ? Qt::DashLine : Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin};
}

QCPScatterStyle scatter_style(const core::FigurePoints& points) {
    using Shape = core::FigurePoints::Shape;
    static const std::map<Shape, QCPScatterStyle::ScatterShape> shapes = {
        {Shape::disc, QCPScatterStyle::ssCircle},    {Shape::circle, QCPScatterStyle::ssCircle},
        {Shape::square, QCPScatterStyle::ssSquare},  {Shape::triangle, QCPScatterStyle::ssTriangle},
        {Shape::cross, QCPScatterStyle::ssCross},    {Shape::plus, QCPScatterStyle::ssPlus},
        {Shape::diamond, QCPScatterStyle::ssDiamond}};
    const QColor colour = to_qt(points.colour);
    const bool open = points.shape == Shape::circle;
    // A thin white rim keeps filled markers apart from curves of their own colour.
    const bool strokes = points.shape == Shape::cross || points.shape == Shape::plus || open;
    // Small or dense ones would rub each other out by it.
    const bool rim = points.size >= 5 && points.x.size() <= 400;
    const QPen pen = strokes ? QPen(colour, 1.8) : rim ? QPen(QColor(255, 255, 255), 0.8) : QPen(Qt::NoPen);
    const QBrush brush(open ? QColor(255, 255, 255) : colour);
    return {shapes.at(points.shape), pen, brush, points.size + (strokes ? 0 : 1)};
}

/// Builds one figure in one plot.
class Drawing {
public:
    Drawing(const core::Figure& figure, QCustomPlot& plot) : figure_(figure), plot_(plot) {}

    void run() {
        clear();
        set_axes();
        for (const auto& classes : figure_.classes) {
            add_classes(classes);
        }
        for (const auto& map : figure_.maps) {
            add_map(map);
        }
        for (const auto& band : figure_.bands) {
            add_band(band);
        }
        for (const auto& arrows : figure_.arrows) {
            new Element(plot_, [arrows](QCPPainter& p, QCPAxis& x, QCPAxis& y) { paint_arrows(p, x, y, arrows); });
        }
        add_bars();
        new Element(plot_,
                    [lines = figure_.lines](QCPPainter& p, QCPAxis& x, QCPAxis& y) { paint_lines(p, x, y, lines); });
        for (const auto& curve : figure_.curves) {
            add_curve(curve);
        }
        for (const auto& points : figure_.points) {
            add_points(points);
        }
        add_labels();
        add_header();
        if (figure_.equal_scales) {
            keep_scales_equal();
        }
    }

private:
    void clear() {
        plot_.disconnect(SIGNAL(afterLayout()));
        plot_.clearItems();
        plot_.clearPlottables();
        plot_.plotLayout()->clear();
        plot_.setAutoAddPlottableToLegend(false);
        plot_.setBackground(QBrush(Qt::white));
        plot_.setNoAntialiasingOnDrag(true);
        rect_ = new QCPAxisRect(&plot_, true);
        plot_.plotLayout()->addElement(1, 0, rect_);
        plot_.plotLayout()->setRowSpacing(4);
        plot_.plotLayout()->setColumnSpacing(14);
        plot_.xAxis = rect_->axis(QCPAxis::atBottom);
        plot_.yAxis = rect_->axis(QCPAxis::atLeft);
        plot_.xAxis2 = rect_->axis(QCPAxis::atTop);
        plot_.yAxis2 = rect_->axis(QCPAxis::atRight);
        rect_->setRangeDragAxes(plot_.xAxis, plot_.yAxis);
        rect_->setRangeZoomAxes(plot_.xAxis, plot_.yAxis);
        rect_->setMinimumMargins(QMargins(60, 6, 12, 10));
        for (auto* axis : rect_->axes()) {
            axis->setLayer("axes");
            axis->grid()->setLayer("grid");
        }
    }

    void set_axes() {
        for (auto* axis : {plot_.xAxis2, plot_.yAxis2}) {
            axis->setVisible(true);
            axis->setTicks(false);
            axis->setTickLabels(false);
            axis->setBasePen(QPen(QColor(205, 205, 205)));
        }
        const AxisRange x = x_range(figure_);
        const AxisRange y = y_range(figure_);
        set_axis(*plot_.xAxis, figure_.x, x);
        set_axis(*plot_.yAxis, figure_.y, y);
        if (!figure_.bars.empty()) {
            set_bar_axis();
        }
        const bool filled = !figure_.classes.empty() || !figure_.maps.empty();
        plot_.xAxis->grid()->setVisible(!filled && figure_.bars.empty());
        plot_.yAxis->grid()->setVisible(!filled);
    }

    static void style_axis(QCPAxis& axis) {
        axis.setTickLabelFont(figure_font(12));
        axis.setTickLabelColor(text_colour);
        axis.setLabelFont(figure_font(13));
        axis.setLabelColor(text_colour);
        axis.setBasePen(QPen(axis_colour));
        axis.setTickPen(QPen(axis_colour));
        axis.setSubTickPen(QPen(axis_colour));
        axis.setTickLength(0, 5);
        axis.setSubTickLength(0, 3);
        axis.setNumberFormat("gbc");
        axis.setNumberPrecision(6);
    }

    static void set_axis(QCPAxis& axis, const core::FigureAxis& wanted, const AxisRange& range) {
        style_axis(axis);
        axis.setLabel(words(axis_title(wanted.label, wanted.unit)));
        axis.setLabelPadding(6);
        if (wanted.logarithmic) {
            axis.setScaleType(QCPAxis::stLogarithmic);
            // Under one and a half decades the powers of ten alone leave an axis with a single number.
            if (range.upper / range.lower > 30) {
                axis.setTicker(QSharedPointer<QCPAxisTicker>(new FineTicker<QCPAxisTickerLog>));
            } else {
                axis.setTicker(QSharedPointer<QCPAxisTicker>(new DecadeTicker));
            }
            axis.setNumberPrecision(4);
        } else {
            axis.setTicker(QSharedPointer<QCPAxisTicker>(new FineTicker<QCPAxisTicker>));
        }
        axis.ticker()->setTickCount(6);
        axis.setRange(range.lower, range.upper);
        axis.grid()->setPen(QPen(QColor(228, 228, 228)));
        axis.grid()->setZeroLinePen(QPen(QColor(150, 150, 150)));
    }

    void set_bar_axis() {
        QSharedPointer<QCPAxisTickerText> ticker(new QCPAxisTickerText);
        const auto labels = bar_labels(figure_);
        const QFontMetrics metrics(figure_font(12));
        int widest = 0;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            ticker->addTick(static_cast<double>(i + 1), words(labels[i]));
            widest = std::max(widest, metrics.horizontalAdvance(words(labels[i])));
        }
        const int width = plot_.viewport().width() > 100 ? plot_.viewport().width() : 900;
        if (widest + 8 > (width - 90) / std::max<int>(1, static_cast<int>(labels.size()))) {
            plot_.xAxis->setTickLabelRotation(-35);
        }
        plot_.xAxis->setTicker(ticker);
        plot_.xAxis->setTickLength(0, 0);
        plot_.xAxis->setSubTicks(false);
    }

    void add_classes(const core::FigureClasses& classes) {
        new Element(plot_, [grid = class_image(classes, figure_.x.logarithmic, figure_.y.logarithmic)](
                               QCPPainter& p, QCPAxis& x, QCPAxis& y) { paint_grid(p, x, y, grid); });
        for (std::size_t i = 0; i < classes.names.size(); ++i) {
            const QColor colour = to_qt(i < classes.colours.size() ? classes.colours[i] : core::palette(i));
            swatch(classes.names[i], colour, QColor(110, 110, 110));
        }
    }

    void add_map(const core::FigureMap& map) {
        const AxisRange range = colour_range(map);
        new Element(plot_, [grid = map_image(map, range.lower, range.upper)](QCPPainter& p, QCPAxis& x, QCPAxis& y) {
            paint_grid(p, x, y, grid);
        });
        auto* scale = new QCPColorScale(&plot_);
        plot_.plotLayout()->addElement(1, plot_.plotLayout()->columnCount(), scale);
        scale->setType(QCPAxis::atRight);
        QCPColorGradient gradient;
        gradient.clearColorStops();
        gradient.setLevelCount(256);
        for (int i = 0; i <= 32; ++i) {
            gradient.setColorStopAt(i / 32.0, to_qt(map.diverging ? diverging(i / 32.0) : viridis(i / 32.0)));
        }
        scale->setGradient(gradient);
        scale->setDataRange(QCPRange(range.lower, range.upper));
        scale->setBarWidth(16);
        scale->setRangeDrag(false);
        scale->setRangeZoom(false);
        scale->setLabel(words(axis_title(map.label, map.unit)));
        style_axis(*scale->axis());
        scale->axis()->setTicker(QSharedPointer<QCPAxisTicker>(new FineTicker<QCPAxisTicker>));
        scale->axis()->setSubTicks(false);
        auto* group = new QCPMarginGroup(&plot_);
        rect_->setMarginGroup(QCP::msBottom | QCP::msTop, group);
        scale->setMarginGroup(QCP::msBottom | QCP::msTop, group);
    }

    void add_band(const core::FigureBand& band) {
        new Element(plot_, [band](QCPPainter& p, QCPAxis& x, QCPAxis& y) { paint_band(p, x, y, band); });
        swatch(band.name, to_qt(band.colour), Qt::transparent);
    }

    void add_curve(const core::FigureCurve& curve) {
        const std::size_t count = std::min(curve.x.size(), curve.y.size());
        const QVector<double> x(curve.x.begin(), curve.x.begin() + static_cast<std::ptrdiff_t>(count));
        const QVector<double> y(curve.y.begin(), curve.y.begin() + static_cast<std::ptrdiff_t>(count));
        const QPen pen = curve_pen(curve);
        // Graphs thin out long series as they draw, but want rising x; trajectories in a phase plane do not rise.
        if (curve.steps || std::is_sorted(x.begin(), x.end())) {
            auto* graph = new QCPGraph(plot_.xAxis, plot_.yAxis);
            graph->setData(x, y, true);
            graph->setPen(pen);
            graph->setLineStyle(curve.steps ? QCPGraph::lsStepLeft : QCPGraph::lsLine);
            graph->setAdaptiveSampling(count > 20000);  // it draws several points of one pixel as a step
        } else {
            auto* path = new QCPCurve(plot_.xAxis, plot_.yAxis);
            path->setData(x, y);
            path->setPen(pen);
        }
        key(curve.name, [pen](QCPPainter& p) {
            p.setPen(pen);
            p.drawLine(QPointF(1, 0), QPointF(25, 0));
        });
    }

    void add_points(const core::FigurePoints& points) {
        const std::size_t count = std::min(points.x.size(), points.y.size());
        auto* graph = new QCPGraph(plot_.xAxis, plot_.yAxis);
        // Sorted by x with their errors, because error bars go by index.
        std::vector<std::size_t> order(count);
        for (std::size_t i = 0; i < count; ++i) {
            order[i] = i;
        }
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return points.x[a] < points.x[b]; });
        QVector<double> x, y, error;
        for (const std::size_t i : order) {
            x << points.x[i];
            y << points.y[i];
            error << (i < points.y_error.size() && std::isfinite(points.y_error[i]) ? points.y_error[i] : 0);
        }
        const QCPScatterStyle style = scatter_style(points);
        if (std::any_of(error.begin(), error.end(), [](double e) { return e > 0; })) {
            auto* bars = new QCPErrorBars(plot_.xAxis, plot_.yAxis);
            bars->setDataPlottable(graph);
            bars->setData(error);
            bars->setPen(QPen(to_qt(points.colour), 1.3));
            bars->setWhiskerWidth(6);
            bars->setSymbolGap(0);
        }
        graph->setData(x, y, true);
        graph->setLineStyle(QCPGraph::lsNone);
        graph->setScatterStyle(style);
        graph->setAdaptiveSampling(count > 20000);
        graph->setPen(QPen(to_qt(points.colour)));
        graph->setLayer(marker_layer());
        key(points.name, [style](QCPPainter& p) {
            style.applyTo(&p, QPen());
            style.drawShape(&p, QPointF(13, 0));
        });
    }

    /// Above the curves, below the axes: so that error bars, drawn by another plottable, never cross a marker.
    QCPLayer* marker_layer() {
        if (plot_.layer("markers") == nullptr) {
            plot_.addLayer("markers", plot_.layer("main"), QCustomPlot::limAbove);
        }
        return plot_.layer("markers");
    }

    void add_bars() {
        if (figure_.bars.empty()) {
            return;
        }
        const auto labels = bar_labels(figure_);
        const double width = 0.72 / static_cast<double>(figure_.bars.size());
        for (std::size_t k = 0; k < figure_.bars.size(); ++k) {
            const auto& bars = figure_.bars[k];
            auto* plottable = new QCPBars(plot_.xAxis, plot_.yAxis);
            QVector<double> at, values, errors;
            for (std::size_t i = 0; i < std::min(bars.labels.size(), bars.values.size()); ++i) {
                const auto place = std::find(labels.begin(), labels.end(), bars.labels[i]) - labels.begin() + 1;
                at << static_cast<double>(place) + (static_cast<double>(k) + 0.5) * width - 0.36;
                values << bars.values[i];
                errors << (i < bars.errors.size() && std::isfinite(bars.errors[i]) ? bars.errors[i] : 0);
            }
            const double base = figure_.y.logarithmic ? plot_.yAxis->range().lower : 0;
            QVector<double> heights = values;  // a bar ends its value above its base
            for (double& height : heights) {
                height -= base;
            }
            plottable->setData(at, heights);
            plottable->setBaseValue(base);
            plottable->setWidth(width * 0.94);
            plottable->setPen(Qt::NoPen);
            plottable->setBrush(to_qt(bars.colour));
            if (std::any_of(errors.begin(), errors.end(), [](double e) { return e > 0; })) {
                add_bar_errors(at, values, errors);
            }
            swatch(bars.name, to_qt(bars.colour), Qt::transparent);
        }
    }

    void add_bar_errors(const QVector<double>& at, const QVector<double>& values, const QVector<double>& errors) {
        auto* graph = new QCPGraph(plot_.xAxis, plot_.yAxis);
        graph->setLineStyle(QCPGraph::lsNone);
        graph->setData(at, values);
        auto* marks = new QCPErrorBars(plot_.xAxis, plot_.yAxis);
        marks->setDataPlottable(graph);
        marks->setData(errors);
        marks->setPen(QPen(QColor(30, 30, 30), 1.3));
        marks->setWhiskerWidth(8);
        marks->setSymbolGap(0);
    }

    void add_labels() {
        if (figure_.notes.empty() && figure_.lines.empty()) {
            return;
        }
        auto* labels = new Element(
            plot_, [figure = figure_](QCPPainter& p, QCPAxis& x, QCPAxis& y) { paint_labels(p, x, y, figure); });
        labels->setLayer(marker_layer());
    }

    void add_header() {
        auto* header =
            new Header(plot_, words(figure_.title), figure_.legend ? std::move(entries_) : std::vector<KeyEntry>{});
        plot_.plotLayout()->addElement(0, 0, header);
        plot_.plotLayout()->setRowStretchFactor(0, 0.0001);
    }

    void key(const std::string& name, std::function<void(QCPPainter&)> sample) {
        if (name.empty()) {
            return;
        }
        const QString text = words(name);
        const auto same =
            std::find_if(entries_.begin(), entries_.end(), [&](const KeyEntry& e) { return e.text == text; });
        if (same == entries_.end()) {
            entries_.push_back({text, std::move(sample)});
            return;
        }
        // A curve, its band and its points under one name share one entry.
        same->sample = [first = same->sample, second = std::move(sample)](QCPPainter& p) {
            first(p);
            second(p);
        };
    }

    void swatch(const std::string& name, const QColor& fill, const QColor& rim) {
        key(name, [fill, rim](QCPPainter& p) {
            p.setPen(rim == Qt::transparent ? QPen(Qt::NoPen) : QPen(rim, 0.8));
            p.setBrush(fill);
            p.drawRoundedRect(QRectF(2, -6, 22, 12), 2, 2);
        });
    }

    /// One unit is as long on x as on y: the range of the roomier axis grows when the box is known. Another box
    /// begins from the figure's own ranges again, unless they were moved by hand.
    void keep_scales_equal() {
        QCustomPlot* plot = &plot_;
        struct Ranges {
            QCPRange x, y;
        };
        const Ranges own{plot->xAxis->range(), plot->yAxis->range()};
        QObject::connect(plot, &QCustomPlot::afterLayout, rect_, [plot, own, last = own, by_hand = false]() mutable {
            const QRect box = plot->axisRect()->rect();
            QCPAxis& x = *plot->xAxis;
            QCPAxis& y = *plot->yAxis;
            by_hand = by_hand || x.range() != last.x || y.range() != last.y;
            if (!by_hand) {
                x.setRange(own.x);
                y.setRange(own.y);
            }
            const double per_x = x.range().size() / std::max(1, box.width());
            const double per_y = y.range().size() / std::max(1, box.height());
            if (per_x > per_y * 1.001) {
                y.setRange(y.range().center(), per_x * box.height(), Qt::AlignCenter);
            } else if (per_y > per_x * 1.001) {
                x.setRange(x.range().center(), per_y * box.width(), Qt::AlignCenter);
            }
            if (x.range() != last.x || y.range() != last.y) {
                plot->replot(QCustomPlot::rpQueuedReplot);  // its ticks are laid out before its ranges are known
            }
            last = {x.range(), y.range()};
        });
    }

    const core::Figure& figure_;
    QCustomPlot& plot_;
    QCPAxisRect* rect_ = nullptr;
    std::vector<KeyEntry> entries_;
};

}  // namespace

void draw(const core::Figure& figure, QCustomPlot& plot) { Drawing(figure, plot).run(); }

}  // namespace underbody::studio
