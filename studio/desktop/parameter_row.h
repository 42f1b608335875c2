// A number with its unit as a field that shows what is computed with, and a row of name, slider, number and reset.
#pragma once

#include <QLineEdit>
#include <QString>
#include <QWidget>
#include <optional>
#include <string>

class QLabel;
class QSlider;
class QToolButton;

namespace underbody::studio {

/// Shows every digit that the number has (at most 12). Takes a text with any unit of its kind on Enter or when the
/// focus leaves; what does not parse turns red and is not taken. Up and down step by one in the second digit.
class NumberEdit : public QLineEdit {
    Q_OBJECT
public:
    /// `unit`: SI unit of the value; `shown`: the unit that people read ("mm"); "1": none.
    NumberEdit(const std::string& unit, const std::string& shown, QWidget* parent = nullptr);
    void show_number(std::optional<double> value);
    [[nodiscard]] std::optional<double> value() const { return value_; }
    /// The number in a text, SI. Throws core::InputError.
    [[nodiscard]] double parsed(const QString& text) const;
    [[nodiscard]] QString text_of(double value) const;

Q_SIGNALS:
    void entered(double value);

protected:
    bool event(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

private:
    void take();
    /// Frame, tip and the window's status line say why.
    void refuse(const QString& why);
    std::string unit_, shown_;
    std::optional<double> value_;
};

class ParameterRow : public QWidget {
    Q_OBJECT
public:
    ParameterRow(const QString& name, const QString& meaning, const std::string& unit, const std::string& shown,
                 QWidget* parent = nullptr);
    /// SI. `changed`: it differs from the file, so that it can be reset. The slider runs between the limits.
    void show_value(std::optional<double> value, double lower, double upper, bool changed);
    [[nodiscard]] QSlider* slider() const { return slider_; }
    [[nodiscard]] NumberEdit* number() const { return number_; }
    [[nodiscard]] bool dragging() const;

Q_SIGNALS:
    /// While the slider moves; all of one drag have the same gesture.
    void moved(double value, const QString& gesture);
    void released();
    void entered(double value);
    void reset();

private:
    QLabel* name_ = nullptr;
    QSlider* slider_ = nullptr;
    NumberEdit* number_ = nullptr;
    QToolButton* reset_ = nullptr;
    double lower_ = 0, upper_ = 1;
    int gesture_ = 0;
};

}  // namespace underbody::studio
