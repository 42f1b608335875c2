// What the wheel, Tab, Ctrl+C on cells and dropped files do in the whole window. The wheel rolls the list that it is
// over: it changes a value only where the value has the keyboard. Tab leaves every input: tables and texts keep it for
// themselves otherwise. A file is the window's, wherever it falls.
#pragma once

#include <QObject>

namespace underbody::studio {

class InputGuard : public QObject {
public:
    /// Watches the whole program for as long as it lives.
    explicit InputGuard(QObject* parent);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
};

}  // namespace underbody::studio
