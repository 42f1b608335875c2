// An X server without a screen (Xvfb), for pictures by OpenGL on machines without a display.
#pragma once

#include <string>

namespace underbody::core {

/// Starts Xvfb on a free display number (`-displayfd`) and ends it again. Nothing but its own process is touched.
class VirtualDisplay {
public:
    /// Throws core::SystemError (kind "display") with a hint when Xvfb is not installed or does not answer within 20 s.
    /// `glx` false: it cannot draw by OpenGL, as some displays of users cannot.
    explicit VirtualDisplay(int width = 1600, int height = 1200, bool glx = true);
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    /// ":17", for the environment variable DISPLAY.
    [[nodiscard]] const std::string& name() const { return name_; }

private:
    int process_ = -1;
    std::string name_;
};

/// True when $DISPLAY names an X server that takes connections (a socket is tried; nothing of X is loaded).
bool display_answers();

}  // namespace underbody::core
