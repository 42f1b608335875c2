#include "studio/figures/montage.h"

#include <QBuffer>
#include <QFontMetrics>
#include <QImage>
#include <QPainter>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "studio/figures/elements.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

constexpr int gap = 14;
constexpr int label_height = 22;

std::vector<QImage> decoded(const std::vector<Tile>& tiles) {
    std::vector<QImage> images;
    for (const auto& tile : tiles) {
        images.push_back(QImage::fromData(reinterpret_cast<const uchar*>(tile.png.data()),
                                          static_cast<int>(tile.png.size()), "PNG"));
        if (images.back().isNull() && !tile.png.empty()) {
            throw core::InputError("picture", "the picture of '" + tile.label + "' is no PNG");
        }
    }
    return images;
}

/// Columns that bring the sheet nearest to the shape of a page on its side.
int best_columns(std::size_t count, double tile_width, double tile_height) {
    int best = 1;
    double least = 1e300;
    for (int columns = 1; columns <= static_cast<int>(count); ++columns) {
        const double rows = std::ceil(static_cast<double>(count) / columns);
        const double away = std::abs(std::log(columns * tile_width / (rows * tile_height) / 1.4));
        if (away < least) {
            least = away;
            best = columns;
        }
    }
    return best;
}

}  // namespace

std::string montage_png(const std::vector<Tile>& tiles, const MontageOptions& options) {
    if (tiles.empty() || options.tile_width < 20 || !(options.scale > 0)) {
        throw core::InputError("size", "a sheet needs pictures, and tiles at least 20 px wide");
    }
    start_drawing();
    const std::vector<QImage> images = decoded(tiles);
    int tile_height = 20;
    for (const auto& image : images) {
        if (!image.isNull()) {
            tile_height =
                std::max(tile_height, static_cast<int>(std::lround(
                                          options.tile_width * static_cast<double>(image.height()) / image.width())));
        }
    }
    const int columns =
        std::min<int>(options.columns > 0 ? options.columns
                                          : best_columns(tiles.size(), options.tile_width, tile_height + label_height),
                      static_cast<int>(tiles.size()));
    const int rows = (static_cast<int>(tiles.size()) + columns - 1) / columns;
    const int top = options.title.empty() ? gap : 44;
    const QSizeF size(gap + columns * (options.tile_width + gap), top + rows * (tile_height + label_height + gap));
    if (size.width() * options.scale > 20000 || size.height() * options.scale > 20000) {
        throw core::InputError("size", "the sheet would be larger than 20000 pixels", {},
                               "make the tiles smaller or split the sheet");
    }
    QImage sheet((size * options.scale).toSize(), QImage::Format_RGB32);
    sheet.fill(Qt::white);
    QPainter painter(&sheet);
    painter.setRenderHints(QPainter::SmoothPixmapTransform | QPainter::Antialiasing);
    painter.scale(options.scale, options.scale);
    painter.setPen(QColor(25, 25, 25));
    painter.setFont(figure_font(18, true));
    painter.drawText(QRectF(gap, 10, size.width() - 2 * gap, 28), Qt::AlignLeft | Qt::AlignVCenter,
                     QString::fromStdString(options.title));
    const QFont font = figure_font(13);
    painter.setFont(font);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        const int column = static_cast<int>(i) % columns;
        const int row = static_cast<int>(i) / columns;
        const QRectF place(gap + column * (options.tile_width + gap), top + row * (tile_height + label_height + gap),
                           options.tile_width, tile_height);
        if (!images[i].isNull()) {
            const double height = options.tile_width * static_cast<double>(images[i].height()) / images[i].width();
            const QRectF target(place.left(), place.top() + (tile_height - height) / 2, place.width(), height);
            const QSize pixels = (target.size() * options.scale).toSize();
            painter.drawImage(target, images[i].scaled(pixels, Qt::IgnoreAspectRatio, Qt::SmoothTransformation));
        }
        painter.setPen(QColor(205, 205, 205));
        painter.setBrush(Qt::NoBrush);
        painter.drawRect(place);
        painter.setPen(QColor(40, 40, 40));
        const QString label = QFontMetrics(font).elidedText(QString::fromStdString(tiles[i].label), Qt::ElideMiddle,
                                                            options.tile_width - 4);
        painter.drawText(QRectF(place.left(), place.bottom() + 2, place.width(), label_height - 2), Qt::AlignCenter,
                         label);
    }
    painter.end();
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    sheet.save(&buffer, "PNG");
    return bytes.toStdString();
}

}  // namespace underbody::studio
