#include "postproc/importers/trial.h"

#include <poll.h>
#include <sys/syscall.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <new>
#include <string>

#include "core/error.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define UNDERBODY_ADDRESS_SANITIZER
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define UNDERBODY_ADDRESS_SANITIZER
#endif

namespace underbody::postproc {

namespace {

constexpr std::uintmax_t most_inflated = 64;  ///< bytes of memory for a byte of a file, compressed ones with them

void limit([[maybe_unused]] std::uintmax_t size) {
    const auto set = [](int what, std::uintmax_t soft) {
        rlimit limits{};
        if (::getrlimit(what, &limits) == 0) {
            limits.rlim_cur = std::min<rlim_t>(soft, limits.rlim_max);
            ::setrlimit(what, &limits);
        }
    };
    set(RLIMIT_CORE, 0);
    const std::uintmax_t seconds = 20 + size / 2000000;
    set(RLIMIT_CPU, seconds);
    ::alarm(static_cast<unsigned int>(std::min<std::uintmax_t>(5 * seconds, 86400)));
#ifndef UNDERBODY_ADDRESS_SANITIZER
    // The sanitizer itself maps more than any limit.
    std::uintmax_t mapped = 0;
    if (std::FILE* own = std::fopen("/proc/self/statm", "r"); own != nullptr) {
        unsigned long long pages = 0;
        mapped = std::fscanf(own, "%llu", &pages) == 1 ? pages * static_cast<std::uintmax_t>(::sysconf(_SC_PAGESIZE)) : 0;
        std::fclose(own);
    }
    if (mapped > 0) {
        set(RLIMIT_AS, mapped + (std::uintmax_t{256} << 20) + most_inflated * size);
    }
#endif
}

/// Waits for the child; ends it when the waiting is cancelled. The status that waitpid gives.
int wait_for(pid_t child, core::Progress& progress) {
    int status = 0;
    const int handle = static_cast<int>(::syscall(SYS_pidfd_open, child, 0));
    while (handle >= 0 && !progress.cancelled()) {
        pollfd wanted{handle, POLLIN, 0};
        constexpr int milliseconds = 50;
        if (::poll(&wanted, 1, milliseconds) > 0) {
            break;
        }
    }
    if (handle >= 0) {
        ::close(handle);
    }
    if (progress.cancelled()) {
        ::kill(child, SIGKILL);
    }
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

}  // namespace

void try_in_child(const std::filesystem::path& path, const std::function<void()>& read, core::Progress& progress) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    const pid_t child = ::fork();
    if (child < 0) {
        throw core::SystemError("process", "cannot start a process to try the file in", {path.string(), {}, {}, {}});
    }
    if (child == 0) {
        for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM, SIGXCPU}) {
            ::signal(signal, SIG_DFL);
        }
        ::signal(SIGINT, SIG_IGN);  // the parent decides whether to go on
        ::signal(SIGTERM, SIG_IGN);
        limit(error ? 0 : size);
        std::freopen("/dev/null", "w", stderr);  // what a library says before it dies is of no use to anybody
        int code = 0;
        try {
            read();
        } catch (const std::bad_alloc&) {
            code = 2;
        } catch (...) {
            code = 0;  // refused in words: the reading proper says them
        }
        ::_exit(code);
    }
    const int status = wait_for(child, progress);
    progress.check();
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        return;
    }
    const bool memory = WIFEXITED(status) && WEXITSTATUS(status) == 2;
    const bool time = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
        throw core::SystemError("process", "the process that tries the file was ended by the system: is there memory left?", {path.string(), {}, {}, {}});
    }
    throw core::InputError("format",
                           std::string("the reader ") +
                               (memory ? "asks for more memory than the file can justify"
                                : time ? "takes more time than the file can justify"
                                       : "crashes on it (tried in a process of its own)"),
                           {path.string(), {}, {}, {}}, "the file is cut short or damaged");
}

}  // namespace underbody::postproc
