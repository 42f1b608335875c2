// Below the workspaces: the commands that were done, the jobs that run, the history.
#pragma once

#include <QListWidget>
#include <QWidget>

#include "studio/desktop/desk.h"

class QPlainTextEdit;
class QVBoxLayout;

namespace underbody::studio {

/// Every action as its line, with the command that does the same where there is one; copied as a script.
class CommandList : public QWidget {
    Q_OBJECT
public:
    CommandList(Desk& desk, QWidget* parent);
    /// The lines with commands as comments: for `underbody-studio --replay`.
    [[nodiscard]] QString script() const;

private:
    QPlainTextEdit* text_ = nullptr;
    QStringList lines_;
};

/// A row a job: what it does, how far it is, a button to cancel it.
class JobList : public QWidget {
    Q_OBJECT
public:
    JobList(Jobs& jobs, QWidget* parent);

private:
    void draw_again();
    Jobs& jobs_;
    QVBoxLayout* column_ = nullptr;
    QWidget* none_ = nullptr;
    struct Shown;
    std::vector<Shown*> shown_;
};

/// The steps by name; a click goes there.
class HistoryList : public QListWidget {
    Q_OBJECT
public:
    HistoryList(Desk& desk, QWidget* parent);

private:
    void draw_again();
    Desk& desk_;
};

}  // namespace underbody::studio
