#include "core/virtual_display.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "core/error.h"

namespace underbody::core {

namespace {

constexpr const char* hint = "install the Debian packages xvfb and libgl1-mesa-dri, or set DISPLAY";

/// Ends a child of ours and waits for it; harder after two seconds.
void end(pid_t child) {
    ::kill(child, SIGTERM);
    for (int i = 0; i < 200; ++i) {
        if (::waitpid(child, nullptr, WNOHANG) != 0) {
            return;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
}

/// Runs between fork and exec: only calls that are safe there.
[[noreturn]] void become_server(int report, char* const* argv, bool main_thread, pid_t parent) {
    if (main_thread) {
        // Should the program be killed, its server goes too. (The signal follows the thread, hence only the main one.)
        ::prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (::getppid() != parent) {
            ::_exit(1);
        }
    }
    ::setpgid(0, 0);  // a Ctrl-C at the terminal is for the program
    const int nowhere = ::open("/dev/null", O_RDWR);
    ::dup2(nowhere, 0);
    ::dup2(nowhere, 1);
    ::dup2(nowhere, 2);
    ::dup2(report, 3);
    ::execvp(argv[0], argv);
    ::_exit(127);
}

/// The line that the server writes when it is up; empty when it ended or took too long.
std::string answer(int from) {
    std::string text;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < deadline) {
        pollfd wait{from, POLLIN, 0};
        if (::poll(&wait, 1, 200) <= 0) {
            continue;
        }
        std::array<char, 64> buffer{};
        const ssize_t count = ::read(from, buffer.data(), buffer.size());
        if (count <= 0) {
            return {};
        }
        text.append(buffer.data(), static_cast<std::size_t>(count));
        if (text.find('\n') != std::string::npos) {
            return text.substr(0, text.find('\n'));
        }
    }
    return {};
}

}  // namespace

VirtualDisplay::VirtualDisplay(int width, int height, bool glx) {
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) {
        throw SystemError("display", std::string("no pipe: ") + std::strerror(errno));
    }
    std::vector<std::string> words = {
        "Xvfb",      "-displayfd", "3",
        "-screen",   "0",          std::to_string(width) + "x" + std::to_string(height) + "x24",
        "-nolisten", "tcp",        glx ? "+extension" : "-extension",
        "GLX",       "-noreset"};
    std::vector<char*> argv;
    for (auto& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    const bool main_thread = ::getpid() == ::gettid();
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {
        become_server(pipe[1], argv.data(), main_thread, parent);
    }
    ::close(pipe[1]);
    const std::string number = process_ > 0 ? answer(pipe[0]) : std::string();
    ::close(pipe[0]);
    if (number.empty()) {
        if (process_ > 0) {
            end(process_);
        }
        throw SystemError("display", "there is no display, and Xvfb could not be started", {}, hint);
    }
    name_ = ":" + number;
}

VirtualDisplay::~VirtualDisplay() {
    if (process_ > 0) {
        end(process_);
    }
}

bool display_answers() {
    const char* set = std::getenv("DISPLAY");
    if (set == nullptr || *set == '\0') {
        return false;
    }
    const std::string display = set;
    const std::size_t colon = display.rfind(':');
    if (colon == std::string::npos) {
        return false;
    }
    if (colon > 0 && display.compare(0, colon, "unix") != 0) {
        return true;  // over the network (ssh -X): the toolkit finds out
    }
    const int number = std::atoi(display.c_str() + colon + 1);
    const std::string path = "/tmp/.X11-unix/X" + std::to_string(number);
    for (const bool abstract : {false, true}) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path + (abstract ? 1 : 0), path.data(), path.size());
        const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size() + 1);
        const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const bool good = socket >= 0 && ::connect(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0;
        ::close(socket);
        if (good) {
            return true;
        }
    }
    return false;
}

}  // namespace underbody::core
