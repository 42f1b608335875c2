#include "studio/desktop/icon.h"

#include <QPainter>
#include <QPainterPath>
#include <QPixmap>

namespace underbody::studio {

QIcon program_icon() {
    QIcon icon;
    for (const int size : {16, 32, 48, 64, 128, 256}) {
        QPixmap pixmap(size, size);
        pixmap.fill(Qt::transparent);
        QPainter painter(&pixmap);
        painter.setRenderHint(QPainter::Antialiasing);
        painter.scale(size / 64.0, size / 64.0);
        painter.setPen(Qt::NoPen);
        painter.setBrush(QColor(0, 97, 156));
        painter.drawRoundedRect(QRectF(0, 0, 64, 64), 12, 12);
        // The same shapes as in org.underbody.studio.svg.
        painter.setBrush(QColor(140, 205, 245));
        for (int i = 0; i < 3; ++i) {
            painter.drawRoundedRect(QRectF(12 + 4 * i, 43 + 3.4 * i, 40 - 8 * i, 1.8), 0.9, 0.9);
        }
        painter.setBrush(Qt::white);
        QPainterPath body(QPointF(13, 38));
        body.cubicTo(7, 30, 14, 15, 32, 15);
        body.cubicTo(50, 15, 57, 30, 51, 38);
        body.closeSubpath();
        painter.drawPath(body);
        painter.setBrush(QColor(255, 178, 50));
        painter.drawRect(QRectF(6, 53, 52, 3.4));
        painter.end();
        icon.addPixmap(pixmap);
    }
    return icon;
}

}  // namespace underbody::studio
