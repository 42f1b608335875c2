#include "postproc/importers/byte_stream.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/inputs.h"

namespace underbody::postproc {

namespace {

constexpr std::size_t largest_window_size = std::size_t{4} << 20;
constexpr std::uint64_t largest_ratio = 1032;  // of deflate

bool is_gzip(std::string_view head) { return head.size() >= 2 && head[0] == '\x1f' && head[1] == '\x8b'; }

/// A file descriptor that closes itself.
class Descriptor {
public:
    explicit Descriptor(const std::filesystem::path& path) : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (fd_ < 0) {
            throw core::InputError("file", std::string("cannot open: ") + std::strerror(errno),
                                   {path.string(), {}, {}, {}});
        }
        ::posix_fadvise(fd_, 0, 0, POSIX_FADV_SEQUENTIAL);
    }
    ~Descriptor() { ::close(fd_); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    std::size_t read(char* target, std::size_t count, const std::string& name) const {
        for (;;) {
            const ssize_t got = ::read(fd_, target, count);
            if (got >= 0) {
                return static_cast<std::size_t>(got);
            }
            if (errno != EINTR) {
                throw core::SystemError("file", std::string("cannot read: ") + std::strerror(errno),
                                        {name, {}, {}, {}});
            }
        }
    }
    std::uint64_t skip(std::uint64_t count) const {
        return ::lseek(fd_, static_cast<off_t>(count), SEEK_CUR) < 0 ? 0 : count;
    }

private:
    int fd_;
};

}  // namespace

/// Where bytes come from.
struct ByteStream::Source {
    virtual ~Source() = default;
    /// Up to `count` bytes; 0 at the end.
    virtual std::size_t read(char* target, std::size_t count) = 0;
    virtual std::uint64_t skip(std::uint64_t /*count*/) { return 0; }
    [[nodiscard]] virtual std::uint64_t most_left() const = 0;
    [[nodiscard]] virtual bool compressed() const { return false; }
};

namespace {

/// A plain file.
template <typename Base>
class PlainSource final : public Base {
public:
    PlainSource(const std::filesystem::path& path, std::uint64_t size)
        : name_(path.string()), file_(path), left_(size) {}
    std::size_t read(char* target, std::size_t count) override {
        const std::size_t got = file_.read(target, count, name_);
        left_ = got == 0 ? 0 : left_ - std::min<std::uint64_t>(left_, got);
        return got;
    }
    std::uint64_t skip(std::uint64_t count) override {
        count = std::min(count, left_);
        const std::uint64_t done = file_.skip(count);
        left_ -= done;
        return done;
    }
    [[nodiscard]] std::uint64_t most_left() const override { return left_; }

private:
    std::string name_;
    Descriptor file_;
    std::uint64_t left_;
};

/// Inflates on its own thread, a few blocks ahead of the reader.
template <typename Base>
class GzipSource final : public Base {
public:
    GzipSource(const std::filesystem::path& path, std::uint64_t size) : name_(path.string()), file_(path), size_(size) {
        worker_ = std::thread([this] { work(); });
    }
    ~GzipSource() override {
        {
            const std::lock_guard lock(mutex_);
            stop_ = true;
        }
        wake_.notify_all();
        worker_.join();
    }

    std::size_t read(char* target, std::size_t count) override {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [this] { return !blocks_.empty() || done_; });
        if (blocks_.empty()) {
            if (failure_) {
                std::rethrow_exception(failure_);
            }
            return 0;
        }
        auto& front = blocks_.front();
        const std::size_t got = std::min(count, front.size() - taken_);
        std::memcpy(target, front.data() + taken_, got);
        taken_ += got;
        delivered_ += got;
        if (taken_ == front.size()) {
            blocks_.pop_front();
            taken_ = 0;
            wake_.notify_all();
        }
        return got;
    }
    [[nodiscard]] std::uint64_t most_left() const override {
        const std::uint64_t most = size_ * largest_ratio;
        return most - std::min(most, delivered_);
    }
    [[nodiscard]] bool compressed() const override { return true; }

private:
    static constexpr std::size_t block_size = std::size_t{1} << 20;
    static constexpr std::size_t blocks_ahead = 4;

    [[noreturn]] void fail(const std::string& what, std::uint64_t inflated) const {
        throw core::InputError("format", what + " (after " + std::to_string(inflated) + " inflated bytes)",
                               {name_, {}, {}, {}}, "copy the file again, in binary mode");
    }

    /// False: the reader has gone.
    bool deliver(std::vector<char>&& block) {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [this] { return stop_ || blocks_.size() < blocks_ahead; });
        if (stop_) {
            return false;
        }
        if (!block.empty()) {
            blocks_.push_back(std::move(block));
        }
        lock.unlock();
        wake_.notify_all();
        return true;
    }

    void work() {
        z_stream zip{};
        ::inflateInit2(&zip, 15 + 16);
        try {
            inflate_all(zip);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
        }
        ::inflateEnd(&zip);
        {
            const std::lock_guard lock(mutex_);
            done_ = true;
        }
        wake_.notify_all();
    }

    /// More compressed bytes into the window; false at the end of the file.
    bool feed(z_stream& zip, std::vector<char>& input) {
        if (zip.avail_in == 0) {
            const std::size_t got = file_.read(input.data(), input.size(), name_);
            zip.next_in = reinterpret_cast<Bytef*>(input.data());
            zip.avail_in = static_cast<uInt>(got);
        }
        return zip.avail_in > 0;
    }

    void inflate_all(z_stream& zip) {
        std::vector<char> input(std::size_t{1} << 17);
        std::uint64_t total = 0;
        bool member_open = true;
        for (bool more = true; more;) {
            std::vector<char> block(block_size);
            zip.next_out = reinterpret_cast<Bytef*>(block.data());
            zip.avail_out = static_cast<uInt>(block.size());
            while (zip.avail_out > 0 && more) {
                more = step(zip, input, member_open);
            }
            block.resize(block.size() - zip.avail_out);
            total += block.size();
            if (!deliver(std::move(block))) {
                return;
            }
        }
        if (!ending_.empty()) {
            fail(ending_, total);
        }
    }

    /// Inflates what there is; false at the end, with `ending_` telling what was wrong with it.
    bool step(z_stream& zip, std::vector<char>& input, bool& member_open) {
        if (!feed(zip, input)) {
            ending_ = member_open ? "the gzip file is cut short" : "";
            return false;
        }
        if (!member_open) {
            if (*zip.next_in != 0x1f) {
                return false;  // padding after the last member, as gzip itself ignores it
            }
            ::inflateReset(&zip);
            member_open = true;
        }
        const int result = ::inflate(&zip, Z_NO_FLUSH);
        if (result == Z_STREAM_END) {
            member_open = false;
        } else if (result != Z_OK && result != Z_BUF_ERROR) {
            ending_ = std::string("the gzip file is damaged: ") + (zip.msg != nullptr ? zip.msg : "bad data");
            return false;
        }
        return true;
    }

    std::string name_;
    Descriptor file_;
    std::uint64_t size_;
    std::string ending_;
    std::thread worker_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::vector<char>> blocks_;
    std::size_t taken_ = 0;
    std::uint64_t delivered_ = 0;
    bool done_ = false;
    bool stop_ = false;
    std::exception_ptr failure_;
};

}  // namespace

ByteStream::ByteStream(const std::filesystem::path& path) : name_(path.string()) {
    core::note_content(path);
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(path, error);
    if (error) {
        throw core::InputError("file", "cannot read: " + error.message(), {name_, {}, {}, {}});
    }
    char head[2] = {};
    const std::size_t got = Descriptor(path).read(head, 2, name_);
    if (is_gzip({head, got})) {
        source_ = std::make_unique<GzipSource<Source>>(path, size);
    } else {
        source_ = std::make_unique<PlainSource<Source>>(path, size);
        window_size_ = static_cast<std::size_t>(std::clamp<std::uint64_t>(size, 64, largest_window_size));
    }
    window_.reset(new char[window_size_]);
    base_ = here_ = end_ = window_.get();
}

ByteStream::ByteStream(std::string_view bytes, std::string name)
    : name_(std::move(name)), base_(bytes.data()), here_(bytes.data()), end_(bytes.data() + bytes.size()) {}

ByteStream::~ByteStream() = default;

bool ByteStream::refill(std::size_t count) {
    if (!source_) {
        return false;
    }
    count = std::min(count, largest_window);
    const auto kept = static_cast<std::size_t>(end_ - here_);
    window_start_ += static_cast<std::uint64_t>(here_ - base_);
    std::memmove(window_.get(), here_, kept);
    here_ = base_;
    end_ = base_ + kept;
    while (static_cast<std::size_t>(end_ - here_) < window_size_) {
        char* target = window_.get() + (end_ - base_);
        const std::size_t got = source_->read(target, window_size_ - static_cast<std::size_t>(end_ - base_));
        end_ += got;
        if (got == 0 || static_cast<std::size_t>(end_ - here_) >= std::max(count, window_size_ / 2)) {
            break;
        }
    }
    return static_cast<std::size_t>(end_ - here_) >= count;
}

void ByteStream::read(void* target, std::size_t count) {
    auto* out = static_cast<char*>(target);
    const std::size_t first = std::min(count, static_cast<std::size_t>(end_ - here_));
    if (first > 0) {
        std::memcpy(out, here_, first);
    }
    here_ += first;
    out += first;
    count -= first;
    // Long bodies go straight to where they are wanted.
    while (count > window_size_ && source_) {
        const std::size_t got = source_->read(out, count);
        if (got == 0) {
            throw core::InputError("format", "the file ends too early", place());
        }
        window_start_ += static_cast<std::uint64_t>(here_ - base_) + got;
        here_ = end_ = base_;
        out += got;
        count -= got;
    }
    while (count > 0) {
        if (!ensure(1)) {
            throw core::InputError("format", "the file ends too early", place());
        }
        const std::size_t part = std::min(count, static_cast<std::size_t>(end_ - here_));
        std::memcpy(out, here_, part);
        here_ += part;
        out += part;
        count -= part;
    }
}

void ByteStream::skip(std::uint64_t count) {
    const std::uint64_t first = std::min<std::uint64_t>(count, static_cast<std::uint64_t>(end_ - here_));
    here_ += first;
    count -= first;
    if (count > window_size_ && source_) {
        const std::uint64_t done = source_->skip(count);
        window_start_ += static_cast<std::uint64_t>(here_ - base_) + done;
        here_ = end_ = base_;
        count -= done;
    }
    while (count > 0) {
        if (!ensure(1)) {
            throw core::InputError("format", "the file ends too early", place());
        }
        const std::uint64_t part = std::min<std::uint64_t>(count, static_cast<std::uint64_t>(end_ - here_));
        here_ += part;
        count -= part;
    }
}

std::uint64_t ByteStream::most_left() const {
    return static_cast<std::uint64_t>(end_ - here_) + (source_ ? source_->most_left() : 0);
}

bool ByteStream::compressed() const { return source_ && source_->compressed(); }

core::Place ByteStream::place() const { return {name_, {}, {}, static_cast<std::int64_t>(position())}; }

std::string inflated_head(std::string_view head) {
    if (!is_gzip(head)) {
        return std::string(head);
    }
    z_stream zip{};
    if (::inflateInit2(&zip, 15 + 16) != Z_OK) {
        return {};
    }
    std::string out(64 * 1024, '\0');
    zip.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(head.data()));
    zip.avail_in = static_cast<uInt>(head.size());
    zip.next_out = reinterpret_cast<Bytef*>(out.data());
    zip.avail_out = static_cast<uInt>(out.size());
    ::inflate(&zip, Z_SYNC_FLUSH);
    out.resize(out.size() - zip.avail_out);
    ::inflateEnd(&zip);
    return out;
}

}  // namespace underbody::postproc
