#include "cases/claim.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

#include "core/hash.h"

namespace underbody::cases {

namespace {

/// A place in the lock file for each result; two results that share one by chance wait for each other.
off_t place_of(const std::string& kind, const std::string& name) {
    constexpr std::size_t digits = 12;
    return static_cast<off_t>(std::stoll(core::content_hash(kind + '\n' + name).substr(0, digits), nullptr, 16));
}

}  // namespace

Claim::Claim(const std::filesystem::path& store, const std::string& kind, const std::string& name,
             core::Progress& progress) {
    const std::string lock_file = store.string() + ".lock";
    file_ = ::open(lock_file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) {
        return;
    }
    struct flock wanted {};
    wanted.l_type = F_WRLCK;
    wanted.l_whence = SEEK_SET;
    wanted.l_start = place_of(kind, name);
    wanted.l_len = 1;
    while (::fcntl(file_, F_OFD_SETLK, &wanted) != 0) {
        if (errno != EAGAIN && errno != EACCES && errno != EINTR) {
            return;  // no locks here
        }
        if (!waited_) {
            progress.report(0, "waiting for another run of this study, which makes " + kind + " '" + name + "'");
        }
        waited_ = true;
        progress.check();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
}

Claim::~Claim() {
    if (file_ >= 0) {
        ::close(file_);
    }
}

}  // namespace underbody::cases
