#include "studio/desktop/theme.h"

#include <QApplication>
#include <QPainter>
#include <QPalette>
#include <QProxyStyle>
#include <QStyleFactory>
#include <QStyleOption>
#include <QToolTip>

namespace underbody::studio {

namespace {

QPalette palette_of(bool dark) {
    const QColor window = dark ? QColor(45, 47, 50) : QColor(239, 239, 239);
    const QColor base = dark ? QColor(30, 31, 33) : QColor(255, 255, 255);
    const QColor text = dark ? QColor(230, 230, 230) : QColor(0, 0, 0);
    const QColor pale = dark ? QColor(150, 152, 156) : QColor(110, 110, 110);
    const QColor button = dark ? QColor(58, 60, 64) : QColor(239, 239, 239);
    QPalette palette(button, window);
    palette.setColor(QPalette::Base, base);
    palette.setColor(QPalette::AlternateBase, dark ? QColor(37, 38, 41) : QColor(247, 247, 247));
    palette.setColor(QPalette::ToolTipBase, dark ? QColor(60, 62, 66) : QColor(255, 255, 220));
    palette.setColor(QPalette::Highlight, dark ? QColor(53, 122, 189) : QColor(48, 140, 198));
    palette.setColor(QPalette::HighlightedText, Qt::white);
    palette.setColor(QPalette::Link, dark ? QColor(110, 175, 240) : QColor(0, 0, 200));
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::ToolTipText}) {
        palette.setColor(role, text);
        palette.setColor(QPalette::Disabled, role, pale);
    }
    palette.setColor(QPalette::PlaceholderText, pale);
    return palette;
}

/// Fusion, whose boxes to tick have a frame darker than the window: in the dark it is not seen.
class Style : public QProxyStyle {
public:
    Style() : QProxyStyle(QStyleFactory::create("Fusion")) {}

    /// A click beside a slider's handle puts it there, as a drag does: by steps it was as many actions as steps.
    int styleHint(StyleHint hint, const QStyleOption* option, const QWidget* widget,
                  QStyleHintReturn* data) const override {
        return hint == SH_Slider_AbsoluteSetButtons ? int(Qt::LeftButton)
                                                    : QProxyStyle::styleHint(hint, option, widget, data);
    }

    void drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                       const QWidget* widget) const override {
        QProxyStyle::drawPrimitive(element, option, painter, widget);
        if (element == PE_IndicatorCheckBox || element == PE_IndicatorItemViewItemCheck) {
            painter->save();
            painter->setPen(option->palette.color(QPalette::PlaceholderText));
            painter->setBrush(Qt::NoBrush);
            painter->drawRect(option->rect.adjusted(0, 0, -1, -1));
            painter->restore();
        }
    }
};

}  // namespace

QStyle* window_style() { return new Style; }

const QStringList& theme_names() {
    static const QStringList names = {"system", "light", "dark"};
    return names;
}

void set_theme(const QString& name) {
    static const QPalette system = QApplication::palette();
    const QPalette palette = name == "light" ? palette_of(false) : name == "dark" ? palette_of(true) : system;
    QApplication::setPalette(palette);
    QToolTip::setPalette(palette);
}

}  // namespace underbody::studio
