#include "tests/cases/system_calls.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <mutex>

namespace underbody::test {

namespace {

std::mutex mutex;
std::string watched;         // NOLINT: these live as long as the process
std::set<std::string> seen;  // NOLINT
std::atomic<bool> watching{false};
std::atomic<long> failing_from{0};
std::atomic<long> calls_made{0};

void look(const char* path, int flags) {
    if (!watching || path == nullptr || (flags & O_ACCMODE) != O_RDONLY || (flags & O_DIRECTORY) != 0) {
        return;
    }
    char resolved[PATH_MAX];
    if (::realpath(path, resolved) == nullptr) {
        return;
    }
    const std::lock_guard lock(mutex);
    if (std::string(resolved).starts_with(watched)) {
        seen.insert(resolved);
    }
}

bool fails() {
    const long from = failing_from;
    return from > 0 && ++calls_made >= from;
}

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

OpenedFiles::OpenedFiles(const std::string& folder) {
    char resolved[PATH_MAX];
    const std::lock_guard lock(mutex);
    watched = ::realpath(folder.c_str(), resolved) != nullptr ? resolved : folder;
    seen.clear();
    watching = true;
}
OpenedFiles::~OpenedFiles() { watching = false; }
std::set<std::string> OpenedFiles::paths() const {
    const std::lock_guard lock(mutex);
    return seen;
}

FailingWrites::FailingWrites(long at) {
    calls_made = 0;
    failing_from = at;
}
FailingWrites::~FailingWrites() { failing_from = 0; }
long FailingWrites::calls() { return calls_made; }

}  // namespace underbody::test

// What the libraries find before the C library's own.
extern "C" {

#define UNDERBODY_OPEN(name)                                                                 \
    int name(const char* path, int flags, ...) {                                             \
        va_list more;                                                                        \
        va_start(more, flags);                                                               \
        const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0; \
        va_end(more);                                                                        \
        underbody::test::look(path, flags);                                                  \
        if ((flags & O_CREAT) != 0 && underbody::test::fails()) {                            \
            errno = ENOSPC;                                                                  \
            return -1;                                                                       \
        }                                                                                    \
        static auto* const real = underbody::test::next<int(const char*, int, ...)>(#name);  \
        return real(path, flags, mode);                                                      \
    }
UNDERBODY_OPEN(open)
UNDERBODY_OPEN(open64)
#undef UNDERBODY_OPEN

#define UNDERBODY_FOPEN(name)                                                                    \
    FILE* name(const char* path, const char* mode) {                                             \
        underbody::test::look(path, mode[0] == 'r' && mode[1] != '+' ? O_RDONLY : O_WRONLY);     \
        static auto* const real = underbody::test::next<FILE*(const char*, const char*)>(#name); \
        return real(path, mode);                                                                 \
    }
UNDERBODY_FOPEN(fopen)
UNDERBODY_FOPEN(fopen64)
#undef UNDERBODY_FOPEN

#define UNDERBODY_FAILING(result, name, parameters, exception, arguments)          \
    result name parameters exception {                                             \
        if (underbody::test::fails()) {                                            \
            errno = ENOSPC;                                                        \
            return -1;                                                             \
        }                                                                          \
        static auto* const real = underbody::test::next<result parameters>(#name); \
        return real arguments;                                                     \
    }
UNDERBODY_FAILING(ssize_t, pwrite, (int file, const void* bytes, size_t size, off_t at), , (file, bytes, size, at))
UNDERBODY_FAILING(ssize_t, pwrite64, (int file, const void* bytes, size_t size, off64_t at), , (file, bytes, size, at))
UNDERBODY_FAILING(int, fsync, (int file), , (file))
UNDERBODY_FAILING(int, fdatasync, (int file), , (file))
UNDERBODY_FAILING(int, ftruncate, (int file, off_t size), noexcept, (file, size))
UNDERBODY_FAILING(int, ftruncate64, (int file, off64_t size), noexcept, (file, size))
UNDERBODY_FAILING(int, rename, (const char* from, const char* to), noexcept, (from, to))
#undef UNDERBODY_FAILING

ssize_t write(int file, const void* bytes, size_t size) {
    if (file > 2 && underbody::test::fails()) {  // what the test says gets through
        errno = ENOSPC;
        return -1;
    }
    static auto* const real = underbody::test::next<ssize_t(int, const void*, size_t)>("write");
    return real(file, bytes, size);
}
}
