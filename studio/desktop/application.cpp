#include "studio/desktop/application.h"

#include <cstdio>

#include "studio/desktop/problems_panel.h"

namespace underbody::studio {

namespace {

/// Somebody does something.
bool is_action(QEvent::Type type) {
    return type == QEvent::MouseButtonPress || type == QEvent::MouseButtonDblClick || type == QEvent::KeyPress ||
           type == QEvent::Wheel || type == QEvent::Drop || type == QEvent::Shortcut;
}

}  // namespace

bool Application::notify(QObject* receiver, QEvent* event) {
    if (is_action(event->type())) {
        told_.clear();
    }
    try {
        return QApplication::notify(receiver, event);
    } catch (...) {
        const std::exception_ptr error = std::current_exception();
        const std::string message = tell(error).problem.message;
        if (told_.insert(message).second) {
            std::fprintf(stderr, "underbody-studio: %s\n", message.c_str());
            if (failed) {
                failed(error);
            }
        }
        return false;
    }
}

}  // namespace underbody::studio
