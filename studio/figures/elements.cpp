#include "studio/figures/elements.h"

#include <algorithm>
#include <cmath>

#include "core/no_limit.h"
#include "studio/figures/colour_scale.h"

namespace underbody::studio {

namespace {

constexpr int key_size = 13;
constexpr int sample_width = 26;
constexpr int key_line = 20;

}  // namespace

QFont figure_font(int pixel_size, bool bold) {
    QFont font("DejaVu Sans");
    font.setPixelSize(pixel_size);
    font.setBold(bold);
    return font;
}

QColor ink_of(const QCustomPlot& plot, const QColor& usual) {
    const auto ink = plot.property("ink").value<QColor>();
    return ink.isValid() ? ink : usual;
}

Header::Header(QCustomPlot& plot, QString title, std::vector<KeyEntry> entries)
    : QCPLayoutElement(&plot), title_(std::move(title)), entries_(std::move(entries)) {
    setAutoMargins(QCP::msNone);
    setMargins(QMargins(0, 0, 0, 0));
    setLayer("legend");
}

int Header::left() const {
    const auto* rect = parentPlot()->axisRect();
    return rect != nullptr ? rect->left() : 0;
}

QSize Header::minimumOuterSizeHint() const {
    // The left edge of the axes is not laid out yet when this is asked: the last one is near enough.
    return {0, flow(parentPlot()->viewport().width() - std::max(left(), 70) - 16, nullptr, {})};
}

QSize Header::maximumOuterSizeHint() const { return {QWIDGETSIZE_MAX, minimumOuterSizeHint().height()}; }

void Header::draw(QCPPainter* painter) {
    const int width = parentPlot()->viewport().width() - std::max(left(), 70) - 16;
    painter->setAntialiasing(true);
    flow(width, painter, QPoint(left(), rect().top()));
}

int Header::flow(int width, QCPPainter* painter, QPoint origin) const {
    int y = 8;
    if (!title_.isEmpty()) {
        const QFont font = figure_font(width < 500 ? 14 : 16, true);
        const QRect box = QFontMetrics(font).boundingRect(QRect(0, 0, width, 10000), Qt::TextWordWrap, title_);
        if (painter != nullptr) {
            painter->setFont(font);
            painter->setPen(ink_of(*parentPlot(), QColor(25, 25, 25)));
            painter->drawText(QRect(origin.x(), origin.y() + y, width, box.height()), Qt::TextWordWrap, title_);
        }
        y += box.height() + 6;
    }
    const QFont font = figure_font(key_size);
    const QFontMetrics metrics(font);
    int x = 0;
    for (const auto& entry : entries_) {
        const int room = sample_width + 7;
        const QString text = metrics.elidedText(entry.text, Qt::ElideMiddle, std::max(40, width - room));
        const int used = room + metrics.horizontalAdvance(text);
        if (x > 0 && x + used > width) {
            x = 0;
            y += key_line;
        }
        if (painter != nullptr) {
            painter->save();
            painter->translate(origin.x() + x, origin.y() + y + key_line / 2);
            entry.sample(*painter);
            painter->restore();
            painter->setFont(font);
            painter->setPen(ink_of(*parentPlot(), QColor(40, 40, 40)));
            painter->drawText(QRect(origin.x() + x + room, origin.y() + y, used - room + 4, key_line),
                              Qt::AlignVCenter | Qt::AlignLeft, text);
        }
        x += used + 20;
    }
    return entries_.empty() ? y : y + key_line + 4;
}

Element::Element(QCustomPlot& plot, Paint paint) : QCPAbstractItem(&plot), paint_(std::move(paint)) {
    setClipToAxisRect(true);
    setClipAxisRect(plot.axisRect());
    setSelectable(false);
}

void Element::draw(QCPPainter* painter) {
    QCPAxisRect* rect = clipAxisRect();
    if (rect == nullptr) {
        return;
    }
    painter->save();
    painter->setAntialiasing(true);
    paint_(*painter, *rect->axis(QCPAxis::atBottom), *rect->axis(QCPAxis::atLeft));
    painter->restore();
}

void paint_band(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const core::FigureBand& band) {
    painter.setPen(Qt::NoPen);
    painter.setBrush(to_qt(band.colour));
    const std::size_t count = std::min({band.x.size(), band.lower.size(), band.upper.size()});
    std::size_t begin = 0;
    while (begin < count) {  // one polygon for each run of finite points
        std::size_t end = begin;
        while (end < count && std::isfinite(band.x[end]) && std::isfinite(band.lower[end]) &&
               std::isfinite(band.upper[end])) {
            ++end;
        }
        QPolygonF polygon;
        for (std::size_t i = begin; i < end; ++i) {
            polygon << QPointF(x.coordToPixel(band.x[i]), y.coordToPixel(band.upper[i]));
        }
        for (std::size_t i = end; i-- > begin;) {
            polygon << QPointF(x.coordToPixel(band.x[i]), y.coordToPixel(band.lower[i]));
        }
        painter.drawPolygon(polygon);
        begin = end + 1;
    }
}

GridImage class_image(const core::FigureClasses& classes, bool x_logarithmic, bool y_logarithmic) {
    GridImage grid{{},
                   classes.x_lower,
                   classes.x_upper,
                   classes.y_lower,
                   classes.y_upper,
                   x_logarithmic && classes.x_lower > 0,
                   y_logarithmic && classes.y_lower > 0};
    if (classes.columns == 0 || classes.rows == 0 || classes.index.size() < classes.columns * classes.rows) {
        return grid;
    }
    grid.image = QImage(static_cast<int>(classes.columns), static_cast<int>(classes.rows), QImage::Format_ARGB32);
    for (std::size_t j = 0; j < classes.rows; ++j) {
        auto* line = reinterpret_cast<QRgb*>(grid.image.scanLine(static_cast<int>(classes.rows - 1 - j)));
        for (std::size_t i = 0; i < classes.columns; ++i) {
            const int index = classes.index[j * classes.columns + i];
            if (index < 0) {
                line[i] = 0;
                continue;
            }
            const auto k = static_cast<std::size_t>(index);
            line[i] = to_qt(k < classes.colours.size() ? classes.colours[k] : core::palette(k)).rgba();
        }
    }
    return grid;
}

GridImage map_image(const core::FigureMap& map, double lower, double upper) {
    GridImage grid{{}, map.x_lower, map.x_upper, map.y_lower, map.y_upper, map.x_by_ratio, map.y_by_ratio};
    if (map.columns == 0 || map.rows == 0 || map.values.size() < map.columns * map.rows) {
        return grid;
    }
    grid.image = QImage(static_cast<int>(map.columns), static_cast<int>(map.rows), QImage::Format_ARGB32);
    const double span = upper > lower ? upper - lower : 1;
    for (std::size_t j = 0; j < map.rows; ++j) {
        auto* line = reinterpret_cast<QRgb*>(grid.image.scanLine(static_cast<int>(map.rows - 1 - j)));
        for (std::size_t i = 0; i < map.columns; ++i) {
            const double value = map.values[j * map.columns + i];
            const double t = (value - lower) / span;
            line[i] = std::isnan(value) ? 0U : to_qt(map.diverging ? diverging(t) : viridis(t)).rgba();
        }
    }
    return grid;
}

namespace {

/// Cell of the grid for each pixel along one axis: for logarithmic axes, where cells of one width are not of one width
/// on the picture, and for cells of one ratio.
std::vector<int> cells_of_pixels(QCPAxis& axis, int first_pixel, int count, double lower, double upper, bool by_ratio,
                                 int cells, double step) {
    std::vector<int> result(static_cast<std::size_t>(count), -1);
    for (int p = 0; p < count; ++p) {
        const double x = axis.pixelToCoord(first_pixel + (p + 0.5) * step);
        const double at = by_ratio ? std::log(x / lower) / std::log(upper / lower) : (x - lower) / (upper - lower);
        if (at >= 0 && at < 1) {
            result[static_cast<std::size_t>(p)] = std::min(cells - 1, static_cast<int>(at * cells));
        }
    }
    return result;
}

void paint_warped(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const GridImage& grid) {
    const QRect box = x.axisRect()->rect();
    const int fine = 2;
    const int columns = box.width() * fine;
    const int rows = box.height() * fine;
    if (columns <= 0 || rows <= 0) {
        return;  // a window so small that title and axes leave no room
    }
    const auto across = cells_of_pixels(x, box.left(), columns, grid.x_lower, grid.x_upper, grid.x_by_ratio,
                                        grid.image.width(), 1.0 / fine);
    const auto down = cells_of_pixels(y, box.top(), rows, grid.y_lower, grid.y_upper, grid.y_by_ratio,
                                      grid.image.height(), 1.0 / fine);
    QImage warped(columns, rows, QImage::Format_ARGB32);
    warped.fill(Qt::transparent);
    for (int j = 0; j < rows; ++j) {
        const int row = down[static_cast<std::size_t>(j)];
        if (row < 0) {
            continue;
        }
        const auto* from = reinterpret_cast<const QRgb*>(grid.image.constScanLine(grid.image.height() - 1 - row));
        auto* to = reinterpret_cast<QRgb*>(warped.scanLine(j));
        for (int i = 0; i < columns; ++i) {
            const int column = across[static_cast<std::size_t>(i)];
            to[i] = column < 0 ? 0U : from[column];
        }
    }
    painter.drawImage(QRectF(box.left(), box.top(), box.width(), box.height()), warped);
}

}  // namespace

void paint_grid(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const GridImage& grid) {
    if (grid.image.isNull() || !(grid.x_upper > grid.x_lower) || !(grid.y_upper > grid.y_lower)) {
        return;
    }
    painter.setRenderHint(QPainter::SmoothPixmapTransform, false);
    painter.setRenderHint(QPainter::LosslessImageRendering, true);
    painter.setAntialiasing(false);
    if (x.scaleType() == QCPAxis::stLogarithmic || y.scaleType() == QCPAxis::stLogarithmic || grid.x_by_ratio ||
        grid.y_by_ratio) {
        paint_warped(painter, x, y, grid);
        return;
    }
    const QPointF top_left(x.coordToPixel(grid.x_lower), y.coordToPixel(grid.y_upper));
    const QPointF bottom_right(x.coordToPixel(grid.x_upper), y.coordToPixel(grid.y_lower));
    const QRectF target(top_left, bottom_right);
    // PDF viewers smear small images when they enlarge them: give them sharp cells.
    const int factor = std::max(1, static_cast<int>(600 / std::max(grid.image.width(), grid.image.height())));
    painter.drawImage(target, painter.modes().testFlag(QCPPainter::pmVectorized) && factor > 1
                                  ? grid.image.scaled(grid.image.width() * factor, grid.image.height() * factor)
                                  : grid.image);
}

void paint_arrows(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const core::FigureArrows& arrows) {
    constexpr double length = 15;
    constexpr double head = 4.5;
    painter.setPen(QPen(to_qt(arrows.colour), 1.2, Qt::SolidLine, Qt::RoundCap));
    painter.setBrush(to_qt(arrows.colour));
    const std::size_t count = std::min({arrows.x.size(), arrows.y.size(), arrows.dx.size(), arrows.dy.size()});
    const QRect box = x.axisRect()->rect();
    // Pixels for one unit of each axis, so that directions are right on the drawn picture.
    const double per_x = box.width() / core::never_zero(x.range().size());
    const double per_y = box.height() / core::never_zero(y.range().size());
    for (std::size_t i = 0; i < count; ++i) {
        const double right = arrows.dx[i] * per_x;
        const double up = arrows.dy[i] * per_y;
        const double size = std::hypot(right, up);
        if (!(size > 0) || !std::isfinite(size)) {
            continue;
        }
        const QPointF along(right / size, -up / size);
        const QPointF across(-along.y(), along.x());
        const QPointF middle(x.coordToPixel(arrows.x[i]), y.coordToPixel(arrows.y[i]));
        const QPointF tip = middle + along * (length / 2);
        painter.drawLine(middle - along * (length / 2), tip - along * head);
        painter.setPen(Qt::NoPen);
        painter.drawPolygon(QPolygonF() << tip << tip - along * head * 1.3 + across * head * 0.6
                                        << tip - along * head * 1.3 - across * head * 0.6);
        painter.setPen(QPen(to_qt(arrows.colour), 1.2, Qt::SolidLine, Qt::RoundCap));
    }
}

void paint_lines(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const std::vector<core::FigureLine>& lines) {
    const QRectF box = x.axisRect()->rect();
    for (const auto& line : lines) {
        painter.setPen(QPen(to_qt(line.colour), 1.4, line.dashed ? Qt::DashLine : Qt::SolidLine));
        if (line.vertical) {
            const double at = x.coordToPixel(line.at);
            painter.drawLine(QPointF(at, box.top()), QPointF(at, box.bottom()));
        } else {
            const double at = y.coordToPixel(line.at);
            painter.drawLine(QPointF(box.left(), at), QPointF(box.right(), at));
        }
    }
}

QVector<double> DecadeTicker::createTickVector(double, const QCPRange& range) {
    const QVector<double> parts =
        range.upper > 10 * range.lower ? QVector<double>{1, 2, 5} : QVector<double>{1, 1.5, 2, 3, 4, 5, 7};
    QVector<double> ticks;
    for (double decade = std::pow(10, std::floor(std::log10(range.lower))); decade <= range.upper; decade *= 10) {
        for (const double part : parts) {
            ticks << part * decade;
        }
    }
    return ticks;
}

}  // namespace underbody::studio
