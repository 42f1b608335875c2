#include "cases/lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "core/error.h"
#include "core/hash.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

std::string host_name() {
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string content_of(int descriptor) {
    char text[1024];
    const ssize_t count = ::pread(descriptor, text, sizeof text, 0);
    return {text, count > 0 ? static_cast<std::size_t>(count) : 0};
}

std::string described(const std::string& content) {
    const auto json = nlohmann::json::parse(content, nullptr, false);
    if (!json.is_object()) {
        return "another process";
    }
    const auto text = [&](const char* key) {
        return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "?";
    };
    const auto process = json.contains("process") && json["process"].is_number_integer()
                             ? std::to_string(json["process"].get<long>())
                             : "?";
    return "process " + process + " on " + text("host") + ", since " + text("since") + " (" + text("what") + ")";
}

/// Is the open file still the one of that name? Its holder may have removed it meanwhile.
bool still_there(int descriptor, const fs::path& file) {
    struct stat open_one = {};
    struct stat named = {};
    return ::fstat(descriptor, &open_one) == 0 && ::stat(file.c_str(), &named) == 0 &&
           open_one.st_ino == named.st_ino && open_one.st_dev == named.st_dev;
}

/// A lock that this machine's kernel does not know: of a process elsewhere that was alive a short while ago.
bool held_elsewhere(int descriptor) {
    const auto json = nlohmann::json::parse(content_of(descriptor), nullptr, false);
    struct stat state = {};
    if (!json.is_object() || !json.contains("host") || json["host"] == host_name() ||
        ::fstat(descriptor, &state) != 0) {
        return false;
    }
    return std::time(nullptr) - state.st_mtime < Lock::stale_after;
}

/// Several times: somebody who only asks who holds it has it for a moment. Where the kernel knows no locks here, only
/// what the file says counts.
bool locked(int descriptor) {
    for (int i = 0; i < 5; ++i) {
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || (errno != EWOULDBLOCK && errno != EINTR)) {
            return true;
        }
        const timespec moment = {0, 5000000};
        ::nanosleep(&moment, nullptr);
    }
    return false;
}

}  // namespace

std::string now_text() {
    const std::time_t now = std::time(nullptr);
    std::tm parts = {};
    ::gmtime_r(&now, &parts);
    char text[64];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &parts);
    return text;
}

std::optional<Lock> Lock::take(const fs::path& file, const std::string& what, Among among) {
    std::error_code ignored;
    fs::create_directories(file.parent_path(), ignored);
    while (true) {
        const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (descriptor < 0) {
            throw core::SystemError("write", std::string("the lock cannot be made: ") + std::strerror(errno),
                                    {file.string(), {}, {}, {}});
        }
        if (!locked(descriptor) || (among == Among::machines && held_elsewhere(descriptor))) {
            ::close(descriptor);
            return {};
        }
        if (!still_there(descriptor, file)) {
            ::close(descriptor);
            continue;
        }
        const std::string text = nlohmann::json({{"host", host_name()},
                                                 {"process", static_cast<long>(::getpid())},
                                                 {"since", now_text()},
                                                 {"what", what}})
                                     .dump() +
                                 "\n";
        if (::ftruncate(descriptor, 0) != 0 ||
            ::pwrite(descriptor, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
            const int error = errno;
            ::unlink(file.c_str());
            ::close(descriptor);
            throw core::SystemError("write", std::string("the lock cannot be written: ") + std::strerror(error),
                                    {file.string(), {}, {}, {}});
        }
        return Lock(file, descriptor);
    }
}

Lock Lock::wait_for(const fs::path& file, const std::string& what, Among among, core::Progress& progress) {
    for (bool said = false;; said = true) {
        if (auto lock = take(file, what, among)) {
            return std::move(*lock);
        }
        if (!said) {
            progress.report(0, "waiting for " + holder(file).value_or("another process"));
        }
        progress.check();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
}

std::optional<std::string> Lock::holder(const fs::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0) {
        return {};
    }
    std::optional<std::string> who;
    const bool free = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
    if (!free || held_elsewhere(descriptor)) {
        who = described(content_of(descriptor));
    }
    ::close(descriptor);
    return who;
}

Lock::Lock(Lock&& other) noexcept : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

Lock& Lock::operator=(Lock&& other) noexcept {
    if (this != &other) {
        release();
        file_ = std::move(other.file_);
        descriptor_ = std::exchange(other.descriptor_, -1);
    }
    return *this;
}

Lock::~Lock() { release(); }

void Lock::touch() const { ::futimens(descriptor_, nullptr); }

void Lock::release() {
    if (descriptor_ < 0) {
        return;
    }
    if (still_there(descriptor_, file_)) {
        ::unlink(file_.c_str());
    }
    ::flock(descriptor_, LOCK_UN);
    ::close(std::exchange(descriptor_, -1));
}

std::optional<Lock> lock_of_result(const fs::path& store, const std::string& kind, const std::string& name,
                                   core::Progress& progress) {
    const std::string file = store.string() + "." + core::content_hash(kind + '\n' + name).substr(0, 16) + ".lock";
    try {
        return Lock::wait_for(file, kind + " '" + name + "'", Lock::Among::processes, progress);
    } catch (const core::SystemError&) {
        return {};
    }
}

}  // namespace underbody::cases
