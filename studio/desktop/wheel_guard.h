// The wheel rolls the list that it is over: it changes a value only where the value has the keyboard.
#pragma once

#include <QObject>

namespace underbody::studio {

class WheelGuard : public QObject {
public:
    /// Watches the whole program for as long as it lives.
    explicit WheelGuard(QObject* parent);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
};

}  // namespace underbody::studio
