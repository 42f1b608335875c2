#include "core/file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
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

fs::path temporary_name(const fs::path& target) {
    static std::atomic<unsigned> counter{0};
    const std::string stem = "." + target.filename().string() + ".underbody-" + std::to_string(::getpid()) + "-" +
                             std::to_string(counter.fetch_add(1)) + target.extension().string();
    return target.parent_path() / stem;
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
        std::size_t done = 0;
        while (done < bytes.size()) {
            const ssize_t step = ::write(file.get(), bytes.data() + done, bytes.size() - done);
            if (step < 0) {
                if (errno == EINTR) {
                    continue;
                }
                throw SystemError("write", "cannot be written: " + reason(errno), {path.string(), {}, {}, {}});
            }
            done += static_cast<std::size_t>(step);
        }
    }
    pending.commit();
}

PendingFile::PendingFile(fs::path target) : target_(std::move(target)), temporary_(temporary_name(target_)) {
    if (target_.filename().empty()) {
        throw SystemError("write", "is not a file name", {target_.string(), {}, {}, {}});
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
