#include "cases/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>
#include <thread>

#include "core/error.h"
#include "core/text.h"

extern char** environ;

namespace underbody::cases {

namespace fs = std::filesystem;

std::optional<fs::path> find_program(const std::string& program) {
    const char* path = std::getenv("PATH");
    for (const auto folder : core::split(path == nullptr ? "" : path, ':')) {
        const fs::path file = fs::path(folder) / program;
        if (!folder.empty() && ::access(file.c_str(), X_OK) == 0 && !fs::is_directory(file)) {
            return file;
        }
    }
    return std::nullopt;
}

namespace {

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

// What follows up to the constructor runs between fork and exec: calls that are safe there, and no allocation.

struct Prepared {
    const char* program;
    const char* folder;
    char* const* argv;
    char* const* envp;
    int nowhere;  ///< /dev/null
    int log;
    std::array<int, 2> keep;
};

[[noreturn]] void become_child(const Prepared& what) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // the guard itself may be killed
    if (::getppid() == 1) {
        ::_exit(127);
    }
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGCHLD}) {
        std::signal(number, SIG_DFL);
    }
    sigset_t none;
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::dup2(what.nowhere, 0);
    ::dup2(what.log, 1);
    ::dup2(what.log, 2);
    for (const int kept : what.keep) {
        if (kept >= 0) {
            ::fcntl(kept, F_SETFD, 0);
        }
    }
    if (::chdir(what.folder) == 0) {
        ::execve(what.program, what.argv, what.envp);
    }
    ::_exit(127);
}

void sleep_milliseconds(long count) {
    const timespec time = {count / 1000, count % 1000 * 1000000};
    ::nanosleep(&time, nullptr);
}

constexpr int polite_wait = 2000;  ///< ms between the request to end and the end by force

/// Nobody is left to fetch the results: ends the group, this process with it.
[[noreturn]] void end_group() {
    ::kill(0, SIGTERM);
    for (int waited = 0; waited < polite_wait; waited += 20) {
        while (::waitpid(-1, nullptr, WNOHANG) > 0) {
        }
        if (::waitpid(-1, nullptr, WNOHANG) < 0) {
            break;  // none left of its own; what those started may be there still
        }
        sleep_milliseconds(20);
    }
    ::kill(0, SIGKILL);
    ::_exit(137);
}

/// Closes everything but these descriptors: pipes of other children, whose ends we must not hold, above all.
void close_others(const std::array<int, 5>& wanted) {
    const int most = *std::max_element(wanted.begin(), wanted.end());
    for (int number = 0; number <= most; ++number) {
        if (std::find(wanted.begin(), wanted.end(), number) == wanted.end()) {
            ::close(number);
        }
    }
    ::close_range(static_cast<unsigned>(most + 1), ~0U, 0);
}

/// Leads the group: starts the child, waits for its end or for ours.
[[noreturn]] void guard(const Prepared& what, int pipe_end) {
    ::setpgid(0, 0);  // a Ctrl-C at the terminal is for us, who then end the whole group
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
        std::signal(number, SIG_IGN);
    }
    std::signal(SIGCHLD, SIG_DFL);
    close_others({what.nowhere, what.log, what.keep[0], what.keep[1], pipe_end});
    const pid_t child = ::fork();
    if (child == 0) {
        ::close(pipe_end);
        become_child(what);
    }
    if (child < 0) {
        ::_exit(127);
    }
    ::close(what.log);
    while (true) {
        int status = 0;
        if (::waitpid(child, &status, WNOHANG) == child) {
            ::_exit(code_of(status));
        }
        pollfd watched = {pipe_end, POLLIN, 0};
        if (::poll(&watched, 1, 20) > 0) {
            end_group();
        }
    }
}

}  // namespace

ChildProcess::ChildProcess(const std::string& program, const std::vector<std::string>& arguments,
                           const fs::path& folder, const fs::path& log,
                           const std::vector<std::pair<std::string, std::string>>& environment,
                           std::array<int, 2> keep) {
    // Everything that allocates is done before the fork: other threads may hold locks.
    std::vector<std::string> variables;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        variables.emplace_back(*entry);
    }
    for (const auto& [name, value] : environment) {
        std::erase_if(variables,
                      [&, prefix = name + "="](const std::string& entry) { return entry.starts_with(prefix); });
        variables.push_back(name + "=" + value);
    }
    std::vector<std::string> words = {program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const auto pointers = [](std::vector<std::string>& texts) {
        std::vector<char*> result;
        for (auto& text : texts) {
            result.push_back(text.data());
        }
        result.push_back(nullptr);
        return result;
    };
    const auto argv = pointers(words);
    const auto envp = pointers(variables);
    const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (out < 0) {
        throw core::SystemError("write", std::string("cannot write: ") + std::strerror(errno),
                                {log.string(), {}, {}, {}});
    }
    const int nowhere = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    int ends[2] = {-1, -1};
    const bool piped = ::pipe2(ends, O_CLOEXEC) == 0;
    const pid_t child = piped ? ::fork() : -1;
    if (child == 0) {
        guard({program.c_str(), folder.c_str(), argv.data(), envp.data(), nowhere, out, keep}, ends[0]);
    }
    const int error = errno;
    for (const int number : {out, nowhere, ends[0]}) {
        if (number >= 0) {
            ::close(number);
        }
    }
    if (child < 0) {
        if (piped) {
            ::close(ends[1]);
        }
        throw core::SystemError("process", std::string("cannot start '") + program + "': " + std::strerror(error));
    }
    ::setpgid(child, child);  // also here: whoever comes first
    process_ = child;
    pipe_ = ends[1];
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)), pipe_(std::exchange(other.pipe_, -1)), code_(other.code_) {}

ChildProcess::~ChildProcess() {
    if (process_ > 0 && !code_) {
        stop();
    }
    if (pipe_ >= 0) {
        ::close(pipe_);
    }
}

std::optional<int> ChildProcess::ended() {
    if (code_ || process_ <= 0) {
        return code_;
    }
    siginfo_t seen = {};
    if (::waitid(P_PID, static_cast<id_t>(process_), &seen, WEXITED | WNOHANG | WNOWAIT) != 0 ||
        seen.si_pid != process_) {
        return {};
    }
    ::kill(-process_,
           SIGKILL);  // what the child left behind; the number is the group's as long as we have not fetched it
    int status = 0;
    ::waitpid(process_, &status, 0);
    code_ = code_of(status);
    return code_;
}

ChildProcess::Use ChildProcess::use() const {
    Use result;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
        const auto process = core::parse_integer(entry.path().filename().string());
        std::ifstream file(process ? entry.path() / "stat" : std::filesystem::path());
        std::string line;
        if (!process || !std::getline(file, line)) {
            continue;
        }
        // "pid (name) state parent group ...", where the name may hold anything; times are the 14th to 17th.
        std::istringstream words(line.substr(std::min(line.size(), line.rfind(')') + 1)));
        std::string state, skipped;
        long parent = 0, group = 0, ticks = 0;
        words >> state >> parent >> group;
        if (group != process_) {
            continue;
        }
        for (int i = 6; i <= 13; ++i) {
            words >> skipped;
        }
        for (int i = 14; i <= 17 && words >> ticks; ++i) {
            result.processor_seconds += static_cast<double>(ticks) / static_cast<double>(::sysconf(_SC_CLK_TCK));
        }
        result.stopped = result.stopped || state == "T" || state == "t";
    }
    return result;
}

void ChildProcess::stop() {
    if (process_ <= 0 || ended()) {
        return;
    }
    ::kill(-process_, SIGTERM);
    for (int waited = 0; waited < polite_wait && !ended(); waited += 10) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (!code_) {
        ::kill(-process_, SIGKILL);
        int status = 0;
        ::waitpid(process_, &status, 0);
        code_ = code_of(status);
    }
}

}  // namespace underbody::cases
