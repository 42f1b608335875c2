// Where the texts inside a plot go.
#include <algorithm>
#include <cmath>
#include <limits>

#include "studio/figures/elements.h"

namespace underbody::studio {

namespace {

/// What a text should not cover, with a price for each.
class Obstacles {
public:
    Obstacles(QCPAxis& x, QCPAxis& y, const core::Figure& figure) {
        for (const auto& points : figure.points) {
            for (std::size_t i = 0; i < std::min(points.x.size(), points.y.size()); ++i) {
                const QPointF at(x.coordToPixel(points.x[i]), y.coordToPixel(points.y[i]));
                boxes_.emplace_back(QRectF(at.x() - 5, at.y() - 5, 10, 10), 3.0);
            }
        }
        for (const auto& curve : figure.curves) {
            add_curve(x, y, curve);
        }
        for (const auto& line : figure.lines) {
            if (line.vertical) {
                verticals_.push_back(x.coordToPixel(line.at));
            } else {
                horizontals_.push_back(y.coordToPixel(line.at));
            }
        }
    }

    [[nodiscard]] double price(const QRectF& text) const {
        double sum = 0;
        for (const auto& [box, price] : boxes_) {
            const QRectF common = box.intersected(text);
            if (!common.isEmpty()) {
                sum += price * (1 + common.width() * common.height() / 50);
            }
        }
        for (const auto& at : dots_) {
            sum += text.contains(at) ? 0.5 : 0.0;
        }
        for (const double at : verticals_) {
            sum += at > text.left() && at < text.right() ? 2.0 : 0.0;
        }
        for (const double at : horizontals_) {
            sum += at > text.top() && at < text.bottom() ? 2.0 : 0.0;
        }
        return sum;
    }

    void add(const QRectF& text) { boxes_.emplace_back(text, 20.0); }

private:
    void add_curve(QCPAxis& x, QCPAxis& y, const core::FigureCurve& curve) {
        const std::size_t count = std::min(curve.x.size(), curve.y.size());
        const std::size_t step = std::max<std::size_t>(1, count / 400);
        QPointF last;
        for (std::size_t i = 0; i < count; i += step) {
            const QPointF at(x.coordToPixel(curve.x[i]), y.coordToPixel(curve.y[i]));
            // Dots every 8 px along the curve stand for it.
            const double length = i > 0 ? std::min(2000.0, std::hypot(at.x() - last.x(), at.y() - last.y())) : 0;
            for (double along = 8; along < length; along += 8) {
                dots_.push_back(last + (at - last) * (along / length));
            }
            dots_.push_back(at);
            last = at;
        }
    }

    std::vector<std::pair<QRectF, double>> boxes_;
    std::vector<QPointF> dots_;
    std::vector<double> verticals_;
    std::vector<double> horizontals_;
};

/// The cheapest of the candidates that lies inside the box.
QRectF place(const std::vector<QRectF>& candidates, const QRectF& box, Obstacles& obstacles) {
    QRectF best = candidates.front();
    double least = std::numeric_limits<double>::max();
    double preference = 0;
    for (const QRectF& candidate : candidates) {
        QRectF inside = candidate;
        inside.moveLeft(std::max(box.left() + 2, std::min(inside.left(), box.right() - inside.width() - 2)));
        inside.moveTop(std::max(box.top() + 2, std::min(inside.top(), box.bottom() - inside.height() - 2)));
        const double moved = std::hypot(inside.left() - candidate.left(), inside.top() - candidate.top());
        const double price = obstacles.price(inside) + 0.1 * moved + preference;
        preference += 0.05;
        if (price < least) {
            least = price;
            best = inside;
        }
    }
    obstacles.add(best);
    return best;
}

/// Text with a white rim, readable on every ground.
void write(QCPPainter& painter, const QRectF& box, const QString& text, const QColor& colour) {
    const bool light = colour.lightness() > 128;
    const QFontMetricsF metrics(painter.font());
    const QStringList lines = text.split('\n');
    double baseline = box.top() + 1 + metrics.ascent();
    for (const QString& line : lines) {
        const QPointF at(box.left() + 4, baseline);
        QPainterPath outline;
        outline.addText(at, painter.font(), line);
        painter.strokePath(outline, QPen(light ? QColor(20, 20, 20, 225) : QColor(255, 255, 255, 225), 4, Qt::SolidLine,
                                         Qt::RoundCap, Qt::RoundJoin));
        painter.setPen(colour);
        painter.drawText(at, line);
        baseline += metrics.lineSpacing();
    }
}

std::vector<QRectF> around(const QPointF& at, const QSizeF& size) {
    const double w = size.width();
    const double h = size.height();
    std::vector<QRectF> result;
    for (const double away : {8.0, 18.0, 30.0, 45.0, 60.0}) {
        const double d = away * 0.7;
        for (const QPointF& corner :
             {QPointF(d, -d - h), QPointF(d, d), QPointF(-d - w, -d - h), QPointF(-d - w, d), QPointF(away, -h / 2),
              QPointF(-away - w, -h / 2), QPointF(-w / 2, -away - h), QPointF(-w / 2, away)}) {
            result.emplace_back(at + corner, size);
        }
    }
    return result;
}

std::vector<QRectF> along_line(const core::FigureLine& line, const QRectF& box, double at, const QSizeF& size) {
    const double w = size.width();
    const double h = size.height();
    std::vector<QRectF> result;
    for (const double part : {0.02, 0.98, 0.2, 0.8, 0.5, 0.35, 0.65}) {
        if (line.vertical) {
            const double top = box.top() + part * (box.height() - h);
            result.emplace_back(at + 4, top, w, h);
            result.emplace_back(at - 4 - w, top, w, h);
        } else {
            const double left = box.right() - w - part * (box.width() - w);
            result.emplace_back(left, at - 3 - h, w, h);
            result.emplace_back(left, at + 3, w, h);
        }
    }
    return result;
}

}  // namespace

void paint_labels(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const core::Figure& figure) {
    const QFont font = figure_font(12);
    const QFontMetricsF metrics(font);
    painter.setFont(font);
    const QRectF box = x.axisRect()->rect();
    Obstacles obstacles(x, y, figure);
    const auto size_of = [&](const QString& text) {
        const QRectF bounds = metrics.boundingRect(QRectF(0, 0, 4000, 4000), Qt::AlignLeft, text);
        return QSizeF(bounds.width() + 8, bounds.height() + 2);
    };
    for (const auto& note : figure.notes) {
        const QPointF at(x.coordToPixel(note.x), y.coordToPixel(note.y));
        if (note.text.empty() || !box.adjusted(-1, -1, 1, 1).contains(at)) {
            continue;
        }
        const QString text = QString::fromStdString(note.text);
        write(painter, place(around(at, size_of(text)), box, obstacles), text,
              ink_of(*x.parentPlot(), QColor(20, 20, 20)));
    }
    for (const auto& line : figure.lines) {
        const double at = line.vertical ? x.coordToPixel(line.at) : y.coordToPixel(line.at);
        const bool seen = line.vertical ? at >= box.left() && at <= box.right() : at >= box.top() && at <= box.bottom();
        if (line.label.empty() || !seen) {
            continue;
        }
        const QString text = QString::fromStdString(line.label);
        write(painter, place(along_line(line, box, at, size_of(text)), box, obstacles), text,
              ink_of(*x.parentPlot(), to_qt(line.colour).darker(150)));
    }
}

}  // namespace underbody::studio
