#include "postproc/importers/sandboxed_read.h"

#include <fcntl.h>
#include <poll.h>
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
#include "core/inputs.h"

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
#ifdef UNDERBODY_ADDRESS_SANITIZER
    constexpr std::uintmax_t least = 20;
#else
    constexpr std::uintmax_t least = 5;
#endif
    const std::uintmax_t seconds = least + size / 2000000;
    set(RLIMIT_CPU, seconds);
    ::alarm(static_cast<unsigned int>(std::min<std::uintmax_t>(5 * seconds, 86400)));
#ifndef UNDERBODY_ADDRESS_SANITIZER
    // The sanitizer itself maps more than any limit.
    std::uintmax_t mapped = 0;
    if (std::FILE* own = std::fopen("/proc/self/statm", "r"); own != nullptr) {
        unsigned long long pages = 0;
        mapped =
            std::fscanf(own, "%llu", &pages) == 1 ? pages * static_cast<std::uintmax_t>(::sysconf(_SC_PAGESIZE)) : 0;
        std::fclose(own);
    }
    if (mapped > 0) {
        set(RLIMIT_AS, mapped + (std::uintmax_t{256} << 20) + most_inflated * size);
    }
#endif
}

void write_all(int pipe, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t some = ::write(pipe, text.data() + done, text.size() - done);
        if (some <= 0) {
            return;
        }
        done += static_cast<std::size_t>(some);
    }
}

/// What the child writes until it ends; ends it when the waiting is cancelled.
std::string read_all(int pipe, pid_t child, core::Progress& progress) {
    std::string text;
    char some[65536];
    for (;;) {
        if (progress.cancelled()) {
            ::kill(child, SIGKILL);
            return {};
        }
        pollfd wanted{pipe, POLLIN, 0};
        constexpr int milliseconds = 50;
        if (::poll(&wanted, 1, milliseconds) <= 0) {
            continue;
        }
        const ssize_t count = ::read(pipe, some, sizeof some);
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count <= 0) {
            return text;
        }
        text.append(some, static_cast<std::size_t>(count));
    }
}

/// What the child does, to its end.
[[noreturn]] void run_child(const int (&ends)[2], std::uintmax_t size, const std::function<std::string()>& read) {
    const core::InputScope unheard(nullptr);  // a lock that another thread of the parent held would stay locked here
    ::close(ends[0]);
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM, SIGXCPU}) {
        ::signal(signal, SIG_DFL);
    }
    ::signal(SIGINT, SIG_IGN);  // the parent decides whether to go on
    ::signal(SIGTERM, SIG_IGN);
    limit(size);
    std::freopen("/dev/null", "w", stderr);  // what a library says before it dies is of no use to anybody
    int code = 0;
    try {
        write_all(ends[1], read());
    } catch (const std::bad_alloc&) {
        code = 2;
    } catch (...) {
        code = 0;  // refused in words: the reading proper says them
    }
    ::_exit(code);
}

}  // namespace

std::string report_of_child(const std::filesystem::path& path, const std::function<std::string()>& read,
                            core::Progress& progress) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    int ends[2] = {-1, -1};
    const pid_t child = ::pipe2(ends, O_CLOEXEC) == 0 ? ::fork() : -1;
    if (child < 0) {
        ::close(ends[0]);
        ::close(ends[1]);
        throw core::SystemError("process", "cannot start a process to try the file in", {path.string(), {}, {}, {}});
    }
    if (child == 0) {
        run_child(ends, error ? 0 : size, read);
    }
    ::close(ends[1]);
    std::string report = read_all(ends[0], child, progress);
    ::close(ends[0]);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    progress.check();
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        return report;
    }
    const bool memory = WIFEXITED(status) && WEXITSTATUS(status) == 2;
    const bool time = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
        throw core::SystemError("process",
                                "the process that tries the file was ended by the system: is there memory left?",
                                {path.string(), {}, {}, {}});
    }
    throw core::InputError("format",
                           std::string("the reader ") + (memory ? "asks for more memory than the file can justify"
                                                         : time ? "takes more time than the file can justify"
                                                                : "crashes on it (tried in a process of its own)"),
                           {path.string(), {}, {}, {}}, "the file is cut short or damaged");
}

void try_in_child(const std::filesystem::path& path, const std::function<void()>& read, core::Progress& progress) {
    (void)report_of_child(
        path, [&] { return read(), std::string(); }, progress);
}

}  // namespace underbody::postproc
