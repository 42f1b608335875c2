#include "cases/case_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"

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
    return std::time(nullptr) - state.st_mtime < CaseLock::stale_after;
}

/// Several times: somebody who only asks who holds it has it for a moment.
bool locked(int descriptor) {
    for (int i = 0; i < 5; ++i) {
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
            return true;
        }
        const timespec moment = {0, 5000000};
        ::nanosleep(&moment, nullptr);
    }
    return false;
}

std::string now_text() {
    const std::time_t now = std::time(nullptr);
    std::tm parts = {};
    ::gmtime_r(&now, &parts);
    char text[64];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &parts);
    return text;
}

}  // namespace

std::optional<CaseLock> CaseLock::take(const fs::path& file, const std::string& what) {
    std::error_code ignored;
    fs::create_directories(file.parent_path(), ignored);
    while (true) {
        const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (descriptor < 0) {
            throw core::SystemError("write", std::string("the lock cannot be made: ") + std::strerror(errno),
                                    {file.string(), {}, {}, {}});
        }
        if (!locked(descriptor) || held_elsewhere(descriptor)) {
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
        return CaseLock(file, descriptor);
    }
}

std::optional<std::string> CaseLock::holder(const fs::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0) {
        return {};
    }
    std::optional<std::string> who;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 || held_elsewhere(descriptor)) {
        who = described(content_of(descriptor));
    }
    ::close(descriptor);
    return who;
}

CaseLock::CaseLock(CaseLock&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

CaseLock& CaseLock::operator=(CaseLock&& other) noexcept {
    if (this != &other) {
        release();
        file_ = std::move(other.file_);
        descriptor_ = std::exchange(other.descriptor_, -1);
    }
    return *this;
}

CaseLock::~CaseLock() { release(); }

void CaseLock::touch() const { ::futimens(descriptor_, nullptr); }

void CaseLock::release() {
    if (descriptor_ < 0) {
        return;
    }
    if (still_there(descriptor_, file_)) {
        ::unlink(file_.c_str());
    }
    ::flock(descriptor_, LOCK_UN);
    ::close(std::exchange(descriptor_, -1));
}

}  // namespace underbody::cases
