#include "studio/desktop/parameter_row.h"

#include <QApplication>
#include <QBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QStatusTipEvent>
#include <QToolButton>
#include <QToolTip>
#include <cmath>

#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {
constexpr int steps = 1000;
}

NumberEdit::NumberEdit(const std::string& unit, const std::string& shown, QWidget* parent)
    : QLineEdit(parent), unit_(unit.empty() ? "1" : unit), shown_(shown.empty() ? unit_ : shown) {
    setAlignment(Qt::AlignRight);
    connect(this, &QLineEdit::editingFinished, this, &NumberEdit::take);
    connect(this, &QLineEdit::textEdited, this, [this] { setStyleSheet({}); });
}

QString NumberEdit::text_of(double value) const {
    const double number = core::convert(value, unit_, shown_);
    // Twelve digits hide the rounding of the conversion and no digit that anybody typed. Numbers that follow from
    // others have them all; seven fit the field, and the tip has the rest.
    const std::string all = core::format_number(number, 12);
    QString text = qt(all.size() > 10 ? core::format_number(number, 7) : all);
    return shown_ == "1" ? text : text + " " + qt(pretty_unit(shown_));
}

void NumberEdit::show_number(std::optional<double> value) {
    value_ = value;
    if (hasFocus() && isModified()) {
        return;  // what is being typed stays, and the tip that says why it is refused
    }
    setText(value ? text_of(*value) : QString());
    setModified(false);
    setStyleSheet({});
    if (value) {
        setToolTip(
            qt(core::format_number(core::convert(*value, unit_, shown_), 15) + " " + (shown_ == "1" ? "" : shown_)));
    }
}

double NumberEdit::parsed(const QString& text) const {
    if (value_ && text == text_of(*value_)) {
        return *value_;  // to the last digit, also those that are not shown
    }
    QString plain = text.trimmed();
    // Units as people write them, back to how files write them.
    plain.replace(QChar(0x2212), "-").replace(QChar(0xb0) + QString("C"), "degC").replace(QChar(0xb0), "deg");
    plain.replace(QChar(0xb2), "^2").replace(QChar(0xb3), "^3").replace(QChar(0xb7), " ");
    if (const auto number = core::parse_number(plain.toStdString())) {
        return core::convert(*number, shown_, unit_);  // a bare number is in the unit that stands there
    }
    return core::parse_in(plain.toStdString(), unit_);
}

void NumberEdit::take() {
    if (!isModified()) {
        return;
    }
    try {
        const double value = parsed(text());
        setModified(false);
        setStyleSheet({});
        Q_EMIT entered(value);
    } catch (const core::Error& error) {
        refuse(qt(error.what()));
    }
}

void NumberEdit::refuse(const QString& why) {
    setStyleSheet("QLineEdit { border: 2px solid #d55e00; }");
    setToolTip(why);
    QToolTip::showText(mapToGlobal(rect().bottomLeft()), why, this);
    QStatusTipEvent told(why);
    QApplication::sendEvent(this, &told);  // up to the window, whose status line shows it
}

bool NumberEdit::event(QEvent* event) {
    const bool asked = event->type() == QEvent::ShortcutOverride;
    if (asked && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape && isModified()) {
        event->accept();  // it takes back what was typed
        return true;
    }
    return QLineEdit::event(event);
}

void NumberEdit::keyPressEvent(QKeyEvent* event) {
    const int by = event->key() == Qt::Key_Up ? 1 : event->key() == Qt::Key_Down ? -1 : 0;
    if (by != 0 && value_) {
        const double shown = core::convert(*value_, unit_, shown_);
        const double step = shown == 0 ? 0.1 : std::pow(10, std::floor(std::log10(std::abs(shown))) - 1);
        Q_EMIT entered(core::convert(shown + by * step, shown_, unit_));
        return;
    }
    if (event->key() == Qt::Key_Escape && isModified()) {
        setModified(false);
        show_number(value_);
        return;
    }
    QLineEdit::keyPressEvent(event);
}

namespace {

/// What moves while the button is down is one gesture, from where it went down.
class GestureSlider : public QSlider {
public:
    using QSlider::QSlider;

protected:
    void mousePressEvent(QMouseEvent* event) override {
        setSliderDown(event->button() == Qt::LeftButton && minimum() < maximum());
        QSlider::mousePressEvent(event);
    }
};

}  // namespace

ParameterRow::ParameterRow(const QString& name, const QString& meaning, const std::string& unit,
                           const std::string& shown, QWidget* parent)
    : QWidget(parent) {
    setObjectName(name);
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    name_ = new QLabel(name.section('.', -1).replace('_', ' '));
    name_->setMinimumWidth(86);
    name_->setToolTip(meaning.isEmpty() ? name : name + ": " + meaning);
    slider_ = new GestureSlider(Qt::Horizontal);
    slider_->setRange(0, steps);
    slider_->setMinimumWidth(90);
    slider_->setAccessibleName(name);
    number_ = new NumberEdit(unit, shown);
    number_->setFixedWidth(104);
    number_->setAccessibleName(name);
    reset_ = new QToolButton;
    reset_->setText(QChar(0x21ba));
    reset_->setAutoRaise(true);
    reset_->setToolTip("Back to the file's value");
    reset_->setAccessibleName("Reset " + name);
    row->addWidget(name_);
    row->addWidget(slider_, 1);
    row->addWidget(number_);
    row->addWidget(reset_);
    connect(slider_, &QSlider::sliderPressed, this, [this] { ++gesture_; });
    connect(slider_, &QSlider::sliderReleased, this, &ParameterRow::released);
    connect(slider_, &QSlider::valueChanged, this, [this](int step) {
        const bool drag = slider_->isSliderDown();
        gesture_ += drag ? 0 : 1;
        const double value = lower_ + (upper_ - lower_) * step / steps;
        Q_EMIT moved(core::parse_number(core::format_number(value, 4)).value_or(value),
                     objectName() + QString::number(gesture_));
        if (!drag) {
            Q_EMIT released();
        }
    });
    connect(number_, &NumberEdit::entered, this, &ParameterRow::entered);
    connect(reset_, &QToolButton::clicked, this, &ParameterRow::reset);
}

void ParameterRow::show_value(std::optional<double> value, double lower, double upper, bool changed) {
    lower_ = lower;
    upper_ = upper > lower ? upper : lower + 1;
    number_->show_number(value);
    reset_->setEnabled(changed);
    slider_->setEnabled(upper > lower);  // what cannot move is seen not to
    QFont font = name_->font();
    font.setBold(changed);
    name_->setFont(font);
    if (!slider_->isSliderDown()) {
        const QSignalBlocker quiet(slider_);
        const double share = (value.value_or(lower_) - lower_) / (upper_ - lower_);
        slider_->setValue(static_cast<int>(std::lround(std::min(1.0, std::max(0.0, share)) * steps)));
    }
}

bool ParameterRow::dragging() const { return slider_->isSliderDown(); }

}  // namespace underbody::studio
