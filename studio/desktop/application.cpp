#include "studio/desktop/application.h"

#include <cstdio>

#include "studio/desktop/problems_panel.h"

namespace underbody::studio {

bool Application::notify(QObject* receiver, QEvent* event) {
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
