// The parts of a figure that QCustomPlot does not have: header with key, bands, maps, arrows, labels that keep apart.
// Only for draw.cpp.
#pragma once

#include <qcustomplot.h>

#include <cmath>
#include <functional>
#include <vector>

#include "core/figure.h"

namespace underbody::studio {

inline QColor to_qt(const core::Colour& colour) { return QColor(colour.red, colour.green, colour.blue, colour.alpha); }

/// The one font of all pictures, in px so that a picture does not depend on a screen's resolution.
QFont figure_font(int pixel_size, bool bold = false);

/// One entry of the key above the plot.
struct KeyEntry {
    QString text;
    /// Draws the sample into a box of 26 x 12 px around the origin's right: x 0..26, y -6..6.
    std::function<void(QCPPainter&)> sample;
};

/// Title and key, above the plot and left-aligned with it; the key flows into as many lines as it needs.
/// The colour of words in a plot: `usual`, unless the plot has the property "ink" (a window in dark colours).
QColor ink_of(const QCustomPlot& plot, const QColor& usual);

class Header : public QCPLayoutElement {
public:
    Header(QCustomPlot& plot, QString title, std::vector<KeyEntry> entries);
    [[nodiscard]] QSize minimumOuterSizeHint() const override;
    [[nodiscard]] QSize maximumOuterSizeHint() const override;

protected:
    void draw(QCPPainter* painter) override;

private:
    /// Lays the header out for a width; paints it when there is a painter. Returns its height.
    int flow(int width, QCPPainter* painter, QPoint origin) const;
    [[nodiscard]] int left() const;
    QString title_;
    std::vector<KeyEntry> entries_;
};

/// Numbers with a real minus sign and no leftover of rounding at zero.
template <class Ticker>
class FineTicker : public Ticker {
protected:
    QString getTickLabel(double tick, const QLocale& locale, QChar format, int precision) override {
        QString label = Ticker::getTickLabel(std::abs(tick) < 1e-14 ? 0 : tick, locale, format, precision);
        if (label.startsWith('-')) {
            label[0] = QChar(0x2212);
        }
        return label;
    }
};

/// 1, 2, 5, 10, ... of a logarithmic axis under one and a half decades, which powers of ten alone leave with a single
/// number; more of them where it is less than one.
class DecadeTicker : public FineTicker<QCPAxisTicker> {
protected:
    QVector<double> createTickVector(double, const QCPRange& range) override;
    int getSubTickCount(double) override { return 0; }
};

/// Something painted inside the axes' box, clipped to it.
class Element : public QCPAbstractItem {
public:
    using Paint = std::function<void(QCPPainter&, QCPAxis& x, QCPAxis& y)>;
    Element(QCustomPlot& plot, Paint paint);
    double selectTest(const QPointF&, bool, QVariant*) const override { return -1; }

protected:
    void draw(QCPPainter* painter) override;

private:
    Paint paint_;
};

void paint_band(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const core::FigureBand& band);

/// An image whose pixels are the cells of a grid over a box of the axes (row 0 is the lowest y).
struct GridImage {
    QImage image;
    double x_lower = 0, x_upper = 0, y_lower = 0, y_upper = 0;
    bool x_by_ratio = false, y_by_ratio = false;
};
/// Cells are of equal width on the axes as they are drawn: of equal ratio on logarithmic ones.
GridImage class_image(const core::FigureClasses& classes, bool x_logarithmic, bool y_logarithmic);
/// `lower`, `upper`: the colour range in use.
GridImage map_image(const core::FigureMap& map, double lower, double upper);
void paint_grid(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const GridImage& grid);

void paint_arrows(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const core::FigureArrows& arrows);
void paint_lines(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const std::vector<core::FigureLine>& lines);

/// Texts of lines and notes, each where it covers least: markers, curves and one another are kept clear.
void paint_labels(QCPPainter& painter, QCPAxis& x, QCPAxis& y, const core::Figure& figure);

}  // namespace underbody::studio
