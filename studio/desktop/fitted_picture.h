// A picture as large as its room allows, or a sentence in its place.
#pragma once

#include <QImage>
#include <QPainter>
#include <QWidget>

namespace underbody::studio {

class FittedPicture : public QWidget {
public:
    using QWidget::QWidget;
    [[nodiscard]] QString text() const { return text_; }
    void show_text(const QString& text) {
        image = {};
        text_ = text;
        update();
    }
    void show_image(const QImage& drawn) {
        image = drawn;
        update();
    }
    QImage image;

protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        if (image.isNull()) {
            painter.drawText(rect().adjusted(12, 12, -12, -12), Qt::AlignCenter | Qt::TextWordWrap, text_);
            return;
        }
        painter.setRenderHint(QPainter::SmoothPixmapTransform);
        QRect room(QPoint(0, 0), image.size().scaled(size(), Qt::KeepAspectRatio));
        room.moveCenter(rect().center());
        painter.drawImage(room, image);
    }

private:
    QString text_;
};

}  // namespace underbody::studio
