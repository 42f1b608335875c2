#include "core/file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/error.h"
#include "core/inputs.h"
#include "core/missing_file.h"
#include "core/own_files.h"

namespace underbody::core {

namespace fs = std::filesystem;

namespace {

std::string reason(int error) { return std::strerror(error); }

class Descriptor {
public:
    explicit Descriptor(int value) : value_(value) {}
    ~Descriptor() {
        if (value_ >= 0) {
            ::close(value_);
        }
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int get() const { return value_; }

private:
    int value_;
};

}  // namespace

std::string hint_for_missing(const fs::path& path) {
    std::error_code ignored;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        names.push_back(entry.path().filename().string());
        if (names.size() > 2000) {
            break;
        }
    }
    const std::string near = nearest_name(path.filename().string(), names);
    return near.empty() ? std::string() : "did you mean '" + near + "'?";
}

namespace {

/// A device, a pipe, or a link such as /dev/stdout to what a descriptor has open: never renamed over, which would put
/// a plain file in its place.
bool takes_a_stream(const fs::path& target) {
    std::error_code none;
    if (fs::is_symlink(fs::symlink_status(target, none))) {
        const std::string link = fs::read_symlink(target, none).string();
        if (link.starts_with("/proc/self/fd/") || target.parent_path() == "/proc/self/fd" ||
            target.parent_path() == "/dev/fd") {
            return true;
        }
    }
    const fs::file_type kind = fs::status(target, none).type();
    return kind == fs::file_type::character || kind == fs::file_type::block || kind == fs::file_type::fifo ||
           kind == fs::file_type::socket;
}

fs::path temporary_name(const fs::path& target) {
    static std::atomic<unsigned> counter{0};
    const std::string stem = "." + target.filename().string() + ".underbody-" + std::to_string(::getpid()) + "-" +
                             std::to_string(counter.fetch_add(1)) + target.extension().string();
    return (takes_a_stream(target) ? fs::temp_directory_path() : target.parent_path()) / stem;
}

void write_all(int descriptor, std::string_view bytes, const fs::path& path) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t step = ::write(descriptor, bytes.data() + done, bytes.size() - done);
        if (step < 0 && errno != EINTR) {
            throw SystemError("write", "cannot be written: " + reason(errno), {path.string(), {}, {}, {}});
        }
        done += static_cast<std::size_t>(std::max<ssize_t>(step, 0));
    }
}

void refuse_disk(const fs::path& path) {
    std::error_code none;
    const fs::file_type kind = fs::status(path, none).type();
    if (kind == fs::file_type::block || kind == fs::file_type::socket) {
        throw SystemError("write", kind == fs::file_type::block ? "is a disk, not a file" : "is a socket, not a file",
                          {path.string(), {}, {}, {}});
    }
}

void make_parent(const fs::path& path) {
    if (!path.has_parent_path()) {
        return;
    }
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) {
        throw SystemError("write", "the folder cannot be made: " + error.message(),
                          {path.parent_path().string(), {}, {}, {}});
    }
}

}  // namespace

MappedFile::MappedFile(const fs::path& path) : name_(path.string()) {
    note_content(path);
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.get() < 0) {
        const int error = errno;
        throw InputError("file", "cannot be opened: " + reason(error), {name_, {}, {}, {}},
                         error == ENOENT ? hint_for_missing(path) : std::string());
    }
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) {
        throw InputError("file", "cannot be read: " + reason(errno), {name_, {}, {}, {}});
    }
    if (!S_ISREG(status.st_mode)) {
        throw InputError("file", S_ISDIR(status.st_mode) ? "is a folder, not a file" : "is not a regular file",
                         {name_, {}, {}, {}});
    }
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ == 0) {
        return;
    }
    void* mapped = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.get(), 0);
    if (mapped == MAP_FAILED) {
        throw SystemError("file", "cannot be mapped: " + reason(errno), {name_, {}, {}, {}});
    }
    ::madvise(mapped, size_, MADV_SEQUENTIAL);
    data_ = static_cast<const char*>(mapped);
}

MappedFile::~MappedFile() {
    if (data_ != nullptr) {
        ::munmap(const_cast<char*>(data_), size_);
    }
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)), name_(std::move(other.name_)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(name_, other.name_);
    return *this;
}

std::string read_file(const fs::path& path) { return std::string(MappedFile(path).bytes()); }

void write_file(const fs::path& path, std::string_view bytes) {
    PendingFile pending(path);
    {
        const Descriptor file(::open(pending.path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
        if (file.get() < 0) {
            throw SystemError("write", "cannot be written: " + reason(errno), {path.string(), {}, {}, {}});
        }
        write_all(file.get(), bytes, path);
    }
    pending.commit();
}

PendingFile::PendingFile(fs::path target) : target_(std::move(target)), temporary_(temporary_name(target_)) {
    if (target_.filename().empty()) {
        throw SystemError("write", "is not a file name", {target_.string(), {}, {}, {}});
    }
    if (takes_a_stream(target_)) {
        refuse_disk(target_);
        return;
    }
    refuse_other_file(target_);
    make_parent(target_);
}

PendingFile::~PendingFile() {
    if (!committed_) {
        std::error_code ignored;
        fs::remove(temporary_, ignored);
    }
}

void PendingFile::commit() {
    if (takes_a_stream(target_)) {
        const Descriptor out(::open(target_.c_str(), O_WRONLY | O_CLOEXEC));
        if (out.get() < 0) {
            throw SystemError("write", "cannot be written: " + reason(errno), {target_.string(), {}, {}, {}});
        }
        std::ostringstream bytes;
        bytes << std::ifstream(temporary_, std::ios::binary).rdbuf();
        write_all(out.get(), bytes.view(), target_);
        return;  // not marked as committed: the temporary file goes
    }
    const Descriptor file(::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.get() < 0 || ::fsync(file.get()) != 0) {
        throw SystemError("write", "cannot be written: " + reason(errno), {target_.string(), {}, {}, {}});
    }
    mark_as_own(file.get());
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
        throw SystemError("write", "cannot be renamed into place: " + reason(errno), {target_.string(), {}, {}, {}});
    }
    committed_ = true;
}

TemporaryFolder::TemporaryFolder(const std::string& prefix) {
    std::string pattern = (fs::temp_directory_path() / (prefix + "-XXXXXX")).string();
    if (::mkdtemp(pattern.data()) == nullptr) {
        throw SystemError("write", "no temporary folder can be made: " + reason(errno), {pattern, {}, {}, {}});
    }
    path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

}  // namespace underbody::core
