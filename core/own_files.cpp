#include "core/own_files.h"

#include <sys/stat.h>
#include <sys/xattr.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <fstream>
#include <string>

#include "core/error.h"
#include "core/text.h"

namespace underbody::core {

namespace fs = std::filesystem;

namespace {

constexpr const char* attribute = "user.underbody";
std::atomic<bool> protecting{false};

std::string stamp_of(const struct stat& status) {
    return std::to_string(status.st_size) + " " + std::to_string(status.st_mtim.tv_sec) + "." +
           std::to_string(status.st_mtim.tv_nsec);
}

/// What a picture of that ending begins with; nothing for others.
std::string beginning_of(const fs::path& path) {
    const std::string ending = lower_case(path.extension().string());
    return ending == ".png" ? "\x89PNG" : ending == ".pdf" ? "%PDF" : "";
}

/// A report that was copied without its attributes still says what made it.
bool says_who_made_it(const fs::path& path) {
    std::string head(400, '\0');
    std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
    return head.find("<meta name=\"generator\" content=\"Underbody\">") != std::string::npos;
}

}  // namespace

bool may_replace(const fs::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) {
        return true;
    }
    std::array<char, 128> kept{};
    const ssize_t size = ::getxattr(path.c_str(), attribute, kept.data(), kept.size());
    if (size >= 0) {
        return std::string(kept.data(), static_cast<std::size_t>(size)) == stamp_of(status);
    }
    if (errno != ENOTSUP) {
        return lower_case(path.extension().string()) == ".html" && says_who_made_it(path);
    }
    const std::string wanted = beginning_of(path);
    std::string found(wanted.size(), '\0');
    std::ifstream(path, std::ios::binary).read(found.data(), static_cast<std::streamsize>(found.size()));
    return found == wanted;
}

void protect_other_files(bool on) { protecting = on; }

void refuse_other_file(const fs::path& path) {
    if (protecting && !may_replace(path)) {
        throw InputError("exists",
                         "the file is there already, and was not written by this program or was changed since",
                         {path.string(), {}, {}, {}}, "choose another name");
    }
}

ReplacingAllowed::ReplacingAllowed() : before_(protecting.exchange(false)) {}
ReplacingAllowed::~ReplacingAllowed() { protecting = before_; }

void mark_as_own(int descriptor) {
    struct stat status {};
    if (::fstat(descriptor, &status) == 0) {
        const std::string stamp = stamp_of(status);
        (void)::fsetxattr(descriptor, attribute, stamp.data(), stamp.size(), 0);  // not every file system can
    }
}

}  // namespace underbody::core
