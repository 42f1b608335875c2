#include "studio/desktop/compare_sheet.h"

#include <QBuffer>
#include <QFontMetricsF>
#include <QPageSize>
#include <QPainter>
#include <QPdfWriter>
#include <algorithm>

#include "core/error.h"
#include "core/file.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

namespace {

constexpr double margin = 14;
constexpr double line = 22;

/// One thing on the sheet: a picture, or words on one line (left of or right up to `place`'s edge).
struct Item {
    QRectF place;
    QString text;
    QImage image;
    bool bold = false;
    bool right = false;
};

struct Layout {
    QSizeF size;
    std::vector<Item> items;
};

QFont font_of(bool bold) {
    QFont font("DejaVu Sans");
    font.setPixelSize(13);
    font.setBold(bold);
    return font;
}

/// A text in lines that fit a width.
QStringList in_lines(const QString& text, double width, bool bold) {
    const QFontMetricsF metrics(font_of(bold));
    QStringList lines;
    for (const auto& word : text.split(' ')) {
        const QString longer = lines.isEmpty() ? word : lines.back() + " " + word;
        if (lines.isEmpty() || metrics.horizontalAdvance(longer) > width) {
            lines << word;
        } else {
            lines.back() = longer;
        }
    }
    return lines;
}

/// Adds a text at the left, from `y` on; gives the end of it.
double add_text(Layout& layout, const QString& text, double x, double y, double width, bool bold) {
    for (const auto& words : in_lines(text, width, bold)) {
        layout.items.push_back({QRectF(x, y, width, line), words, {}, bold, false});
        y += line;
    }
    return y;
}

double add_table(Layout& layout, const Sheet& sheet, double y) {
    const auto& rows = sheet.rows;
    const auto bold = [&](std::size_t row, int column) {
        return row == 0 || column == 0 || sheet.bold.count({row, column}) > 0;
    };
    std::vector<double> widths;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        for (int column = 0; column < rows[row].size(); ++column) {
            const auto at = static_cast<std::size_t>(column);
            widths.resize(std::max(widths.size(), at + 1), 0);
            const double words = QFontMetricsF(font_of(bold(row, column))).horizontalAdvance(rows[row][column]);
            widths[at] = std::max(widths[at], words + 18);
        }
    }
    for (std::size_t row = 0; row < rows.size(); ++row) {
        double x = margin;
        for (int column = 0; column < rows[row].size(); ++column) {
            const double width = widths[static_cast<std::size_t>(column)];
            layout.items.push_back(
                {QRectF(x, y, width - 8, line), rows[row][column], {}, bold(row, column), column > 0});
            x += width;
        }
        layout.size.setWidth(std::max(layout.size.width(), x + margin));
        y += line;
    }
    return y;
}

Layout laid_out(const Sheet& sheet) {
    const int columns = sheet_columns(sheet.cells.size());
    constexpr double cell_width = 520;
    Layout layout;
    layout.size = QSizeF(2 * margin + columns * cell_width, 0);
    const double width = layout.size.width() - 2 * margin;
    double y = add_text(layout, sheet.title, margin, margin, width, true);
    y = add_text(layout, sheet.about, margin, y, width, false) + 6;
    for (std::size_t i = 0; i < sheet.cells.size(); i += static_cast<std::size_t>(columns)) {
        double below = y;
        const std::size_t end = std::min(sheet.cells.size(), i + static_cast<std::size_t>(columns));
        for (std::size_t k = i; k < end; ++k) {
            const auto& [title, image] = sheet.cells[k];
            const double x = margin + static_cast<double>(k - i) * cell_width;
            const double top = add_text(layout, title, x, y, cell_width - 10, true);
            const QSizeF size = QSizeF(image.size()).scaled(cell_width - 10, 2000, Qt::KeepAspectRatio);
            layout.items.push_back({QRectF(QPointF(x, top), size), {}, image, false, false});
            below = std::max(below, top + size.height() + 8);
        }
        y = below;
    }
    y = add_table(layout, sheet, y + 4);
    layout.size.setHeight(y + margin);
    return layout;
}

void paint(const Layout& layout, QPainter& painter) {
    painter.setRenderHint(QPainter::SmoothPixmapTransform);
    painter.setPen(Qt::black);
    for (const auto& item : layout.items) {
        if (!item.image.isNull()) {
            painter.drawImage(item.place, item.image);
            continue;
        }
        painter.setFont(font_of(item.bold));
        painter.drawText(item.place, (item.right ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter, item.text);
    }
}

QByteArray png_of(const QImage& image) {
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    if (!image.save(&buffer, "PNG")) {
        throw core::SystemError("memory", "the picture could not be encoded");
    }
    return bytes;
}

QByteArray pdf_of(const Sheet& sheet) {
    const Layout layout = laid_out(sheet);
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    {
        QPdfWriter writer(&buffer);
        writer.setCreator("Underbody");
        writer.setTitle(sheet.title);
        constexpr int resolution = 600;
        writer.setResolution(resolution);
        const QSizeF millimetres = layout.size * 25.4 / 96;
        writer.setPageSize(QPageSize(millimetres, QPageSize::Millimeter, {}, QPageSize::ExactMatch));
        writer.setPageMargins(QMarginsF(0, 0, 0, 0));
        QPainter painter;
        if (!painter.begin(&writer)) {
            throw core::SystemError("memory", "the PDF could not be written");
        }
        painter.scale(resolution / 96.0, resolution / 96.0);
        paint(layout, painter);
    }
    return bytes;
}

QByteArray svg_of(const Sheet& sheet) {
    const Layout layout = laid_out(sheet);
    const auto number = [](double value) { return QString::number(value, 'f', 1); };
    QString text = QString(
                       "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
                       "xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"%1\" height=\"%2\" "
                       "viewBox=\"0 0 %1 %2\" font-family=\"DejaVu Sans, sans-serif\" font-size=\"13\">\n"
                       "<title>%3</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n")
                       .arg(number(layout.size.width()), number(layout.size.height()), sheet.title.toHtmlEscaped());
    for (const auto& item : layout.items) {
        if (!item.image.isNull()) {
            text += QString("<image x=\"%1\" y=\"%2\" width=\"%3\" height=\"%4\" xlink:href=\"data:image/png;base64,")
                        .arg(number(item.place.x()), number(item.place.y()), number(item.place.width()),
                             number(item.place.height())) +
                    QString::fromLatin1(png_of(item.image).toBase64()) + "\"/>\n";
        } else if (!item.text.isEmpty()) {
            text += QString("<text x=\"%1\" y=\"%2\"%3%4>")
                        .arg(number(item.right ? item.place.right() : item.place.left()),
                             number(item.place.center().y() + 4.5), item.bold ? " font-weight=\"bold\"" : "",
                             item.right ? " text-anchor=\"end\"" : "") +
                    item.text.toHtmlEscaped() + "</text>\n";
        }
    }
    return (text + "</svg>\n").toUtf8();
}

}  // namespace

int sheet_columns(std::size_t count) { return count <= 1 ? 1 : count <= 4 ? 2 : 3; }

QImage draw_sheet(const Sheet& sheet) {
    const Layout layout = laid_out(sheet);
    constexpr double sharp = 2;
    QImage image((layout.size * sharp).toSize(), QImage::Format_RGB32);
    image.fill(Qt::white);
    image.setText("Title", sheet.title);
    image.setText("Description", sheet.about);
    QPainter painter(&image);
    painter.scale(sharp, sharp);
    paint(layout, painter);
    return image;
}

void write_sheet(const Sheet& sheet, const std::filesystem::path& path) {
    const std::string ending = path.extension().string();
    if (ending != ".png" && ending != ".pdf" && ending != ".svg") {
        throw core::UsageError("format", "the sheet cannot be written as '" + path.string() + "'", {},
                               "the ending must be .png, .pdf or .svg");
    }
    const QByteArray bytes = ending == ".png"   ? png_of(draw_sheet(sheet))
                             : ending == ".pdf" ? pdf_of(sheet)
                                                : svg_of(sheet);
    core::write_file(path, bytes.toStdString());
}

}  // namespace underbody::studio
