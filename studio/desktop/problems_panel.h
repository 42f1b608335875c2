// What was found and what went wrong, with time, place and hint; and the banner over the panels for the latest error.
#pragma once

#include <QFrame>
#include <QTreeWidget>
#include <exception>

#include "core/error.h"

class QLabel;
class QTimer;

namespace underbody::studio {

class ProblemList : public QTreeWidget {
    Q_OBJECT
public:
    explicit ProblemList(QWidget* parent);
    /// What is found, about something: what stands there already is not added again, it gets the time of the last.
    void add(const core::Problem& problem, const QString& hint = {});
    /// What has happened: as often as it did.
    void note(const QString& text);
    /// Tab-separated text of all lines, for reports of defects.
    [[nodiscard]] QString text() const;

Q_SIGNALS:
    /// Errors and warnings in the list.
    void counted(int count);

private:
    void append(core::Problem::Severity severity, const QString& message, const QString& place, const QString& hint);
    void hide_note(QTreeWidgetItem& item);
    QAction* without_notes_ = nullptr;
    int count_ = 0;
};

/// A message with its hint over the lower end of its parent, until it is closed or something succeeds. It lies over
/// what is there, so that nothing moves, and lets a click that is on its way fall through.
class Banner : public QFrame {
    Q_OBJECT
public:
    explicit Banner(QWidget* parent);
    void show_error(const QString& what, const QString& message, const QString& hint);
    void show_note(const QString& text);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void appear(const QString& text);
    void lay();
    QLabel* text_ = nullptr;
    QTimer* taken_ = nullptr;  ///< runs out when clicks are its own
};

/// Message and hint of any exception.
struct Told {
    QString message;
    QString hint;
    core::Problem problem;
};
Told tell(const std::exception_ptr& error);

}  // namespace underbody::studio
