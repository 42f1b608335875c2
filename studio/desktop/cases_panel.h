// The cases of the study as a tree with their conditions, loads and status.
#pragma once

#include <QTreeWidget>

#include "studio/desktop/session.h"

namespace underbody::studio {

class CasesTree : public QTreeWidget {
    Q_OBJECT
public:
    explicit CasesTree(QWidget* parent);
    void show_session(const SessionPointer& session);
    /// Only cases whose name or conditions hold the text.
    void filter(const QString& text);

Q_SIGNALS:
    void chosen(const cases::Case& chosen);

private:
    SessionPointer session_;
};

}  // namespace underbody::studio
