// A ring about whatever has the keyboard, while the keyboard is used: many kinds of views show nothing of their own.
#pragma once

#include <QPointer>
#include <QWidget>

namespace underbody::studio {

/// Watches the whole program for as long as it lives, dialogs too.
class FocusRing : public QObject {
public:
    explicit FocusRing(QObject* parent);
    /// Where the ring is now; nullptr: nowhere.
    [[nodiscard]] QWidget* around() const;

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void follow(QWidget* widget);
    QPointer<QWidget> ring_;  ///< child of what it is about
};

}  // namespace underbody::studio
