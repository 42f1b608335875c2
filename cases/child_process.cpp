#include "cases/child_process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
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

}  // namespace

ChildProcess::ChildProcess(const std::string& program, const std::vector<std::string>& arguments, const fs::path& folder, const fs::path& log,
                           const std::vector<std::pair<std::string, std::string>>& environment) {
    // Everything that allocates is done before the fork: other threads may hold locks.
    std::vector<std::string> variables;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        variables.emplace_back(*entry);
    }
    for (const auto& [name, value] : environment) {
        std::erase_if(variables, [&, prefix = name + "="](const std::string& entry) { return entry.starts_with(prefix); });
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
        throw core::SystemError("write", std::string("cannot write: ") + std::strerror(errno), {log.string(), {}, {}, {}});
    }
    const pid_t child = ::fork();
    if (child == 0) {
        ::setpgid(0, 0);  // a Ctrl-C at the terminal is for us, who then end the whole group
        const int nowhere = ::open("/dev/null", O_RDONLY);
        ::dup2(nowhere, 0);
        ::dup2(out, 1);
        ::dup2(out, 2);
        if (::chdir(folder.c_str()) == 0) {
            ::execve(program.c_str(), argv.data(), envp.data());
        }
        ::_exit(127);
    }
    ::close(out);
    if (child < 0) {
        throw core::SystemError("process", std::string("cannot start '") + program + "': " + std::strerror(errno));
    }
    ::setpgid(child, child);  // also here: whoever comes first
    process_ = child;
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : process_(std::exchange(other.process_, -1)), code_(other.code_) {}

ChildProcess::~ChildProcess() {
    if (process_ > 0 && !code_) {
        stop();
    }
}

std::optional<int> ChildProcess::ended() {
    if (!code_ && process_ > 0) {
        int status = 0;
        if (::waitpid(process_, &status, WNOHANG) == process_) {
            code_ = code_of(status);
        }
    }
    return code_;
}

void ChildProcess::stop() {
    if (process_ <= 0 || ended()) {
        return;
    }
    ::kill(-process_, SIGTERM);
    for (int i = 0; i < 200 && !ended(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ::kill(-process_, SIGKILL);  // what is left of the group
    if (!code_) {
        int status = 0;
        ::waitpid(process_, &status, 0);
        code_ = code_of(status);
    }
}

}  // namespace underbody::cases
