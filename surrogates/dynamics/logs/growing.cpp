#include "surrogates/dynamics/logs/growing.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "core/counted.h"
#include "core/text.h"

namespace underbody::dynamics {

namespace {

constexpr int look_again = 100;    ///< ms: Ctrl-C is heard at least so often
constexpr int wait_for_more = 50;  ///< ms at the end of a file that grows
constexpr std::size_t longest_line = 1 << 20;

bool is_row(std::string_view line) {
    const std::string_view own = core::trimmed(line);
    return !own.empty() && !own.starts_with("#");
}

bool has_rows(std::string_view text) {
    const auto lines = core::split(text, '\n');
    return std::any_of(lines.begin(), lines.end(), is_row);
}

/// The line with its fields that are infinite or no number at all ("nan") left empty; with `text` also those that hold
/// something else ("-", half a number), but not within quotes, where a comma parts no fields, nor where no number is
/// left.
std::string numbers_alone(const std::string& line, bool text) {
    text = text && line.find('"') == std::string::npos;
    std::string out;
    std::size_t numbers = 0;
    for (const std::string_view cell : core::split(line, ',')) {
        const auto value = core::parse_number(core::trimmed(cell));
        out += (value ? std::isfinite(*value) : !text) ? std::string(cell) + "," : ",";
        numbers += value && std::isfinite(*value) ? 1 : 0;
    }
    if (text && numbers == 0) {
        return line;
    }
    out.pop_back();
    return line.ends_with('\n') && !out.ends_with('\n') ? out + "\n" : out;
}

/// Lines of a CSV file as they come.
class CsvStream {
public:
    CsvStream(const std::string& name, const std::function<std::unique_ptr<ChannelSink>(const core::Table&)>& sink_of,
              core::Problems& problems)
        : name_(name), sink_of_(sink_of), problems_(problems) {}

    void take(std::string rows) {
        take_header(rows);
        try {
            take_rows(rows);
        } catch (const core::InputError&) {
            for (std::size_t begin = 0; begin < rows.size();) {
                const std::size_t end = std::min(rows.find('\n', begin), rows.size() - 1) + 1;
                take_line(rows.substr(begin, end - begin));
                begin = end;
            }
        }
    }
    /// A line that is refused is an error.
    void take_whole(std::string rows) {
        take_header(rows);
        take_rows(rows);
    }
    [[nodiscard]] bool any() const { return sink_ != nullptr; }
    [[nodiscard]] std::int64_t next_line() const { return lines_ + 1; }
    /// What was passed over in all.
    void sum_up() const {
        if (bad_ + empty_ > said_) {
            problems_.push_back({core::Problem::Severity::warning,
                                 "in all " + core::counted(bad_, "line was", "lines were") +
                                     " passed over, and fields of " + core::counted(empty_, "line") +
                                     " were no finite numbers",
                                 core::Place{name_, {}, {}, {}}});
        }
    }

private:
    void take_header(std::string& rows) {
        while (header_.empty() && !rows.empty()) {
            const std::size_t end = std::min(rows.find('\n'), rows.size() - 1) + 1;
            const std::string line = rows.substr(0, end);
            rows.erase(0, end);
            ++lines_;
            if (is_row(line)) {
                header_ = line.ends_with('\n') ? line : line + "\n";
                header_line_ = lines_;
            }
        }
    }

    void take_rows(const std::string& rows) {
        if (!header_.empty() && has_rows(rows)) {
            good_ += send(rows);
            bad_in_a_row_ = 0;
        }
        lines_ += std::count(rows.begin(), rows.end(), '\n');
    }

    /// A log that was read well for a while is not given up for a line: its writer was interrupted, or a sensor failed.
    void take_line(const std::string& line) {
        constexpr std::size_t well = 20, most_in_a_row = 100;
        const std::string finite = numbers_alone(line, good_ >= well);
        const std::int64_t before = lines_;
        try {
            take_rows(finite);
            if (finite != line && is_row(line) && ++empty_ == 1) {
                say(before + 1, "a field that is no finite number is taken as no reading, here and from here on");
            }
        } catch (const core::InputError& error) {
            if (good_ < well || ++bad_in_a_row_ > most_in_a_row) {
                throw;
            }
            if (++bad_ <= most_said) {
                say(before + 1, "the line is passed over: " + error.message());
            }
            ++lines_;
        }
    }

    void say(std::int64_t line, const std::string& text) {
        ++said_;
        problems_.push_back({core::Problem::Severity::warning, text, core::Place{name_, line, {}, {}}});
    }

    std::size_t send(const std::string& rows) {
        try {
            const core::Table table = core::read_csv(header_ + rows, name_);
            const bool first = sink_ == nullptr;
            std::unique_ptr<ChannelSink> made = first ? sink_of_(table) : nullptr;
            ChannelSink& sink = first ? *made : *sink_;
            send_csv(table, sink.channels(), first, sink);
            if (first) {
                sink_ = std::move(made);  // only now: rows that are refused are sent once more line by line
            }
            return table.rows();
        } catch (const core::InputError& error) {
            core::Place place = error.place();
            if (place.line && place.file == name_) {
                place.line = *place.line == 1 ? header_line_ : *place.line - 1 + lines_;
            }
            throw core::InputError(error.kind(), error.message(), place, error.hint());
        }
    }
    const std::string& name_;
    const std::function<std::unique_ptr<ChannelSink>(const core::Table&)>& sink_of_;
    core::Problems& problems_;
    static constexpr std::size_t most_said = 3;
    std::size_t good_ = 0, bad_ = 0, bad_in_a_row_ = 0, empty_ = 0, said_ = 0;
    std::string header_;
    std::unique_ptr<ChannelSink> sink_;
    std::int64_t lines_ = 0, header_line_ = 0;
};

}  // namespace

GrowingStream::GrowingStream(const std::string& path, bool follow, core::Progress& progress)
    : path_(path),
      descriptor_(path == "-" ? 0 : ::open(path.c_str(), O_RDONLY | O_CLOEXEC)),
      follow_(follow && path != "-"),
      progress_(progress) {
    const auto refuse = [&](const std::string& why) {
        throw core::InputError("missing", "this log cannot be opened: " + why, {path, {}, {}, {}});
    };
    if (descriptor_ < 0) {
        refuse(std::strerror(errno));
    }
    struct stat about {};
    if (::fstat(descriptor_, &about) == 0) {
        if (S_ISDIR(about.st_mode)) {
            ::close(descriptor_);
            refuse("it is a folder");
        }
        live_ = follow_ || !S_ISREG(about.st_mode);
    }
}

GrowingStream::~GrowingStream() {
    if (descriptor_ > 0) {
        ::close(descriptor_);
    }
}

void GrowingStream::check_same_file() const {
    struct stat own {
    }, named{};
    const bool known = ::fstat(descriptor_, &own) == 0 && S_ISREG(own.st_mode);
    if (known && own.st_size < ::lseek(descriptor_, 0, SEEK_CUR)) {
        throw core::InputError("damaged", "the log became shorter while it was read", {path_, {}, {}, {}},
                               "it was begun anew: start the watch anew as well");
    }
    if (known && ::stat(path_.c_str(), &named) == 0 && named.st_ino != own.st_ino) {
        throw core::InputError("missing", "another file has taken the place of the log", {path_, {}, {}, {}},
                               "the logger began a new file: start the watch anew on it");
    }
}

std::size_t GrowingStream::read(char* into, std::size_t most) {
    if (!first_.empty()) {
        const std::size_t count = std::min(most, first_.size());
        std::copy_n(first_.begin(), count, into);
        first_.erase(0, count);
        return count;
    }
    for (;;) {
        progress_.check();
        pollfd ready{descriptor_, POLLIN, 0};
        if (::poll(&ready, 1, look_again) == 0) {
            continue;
        }
        const ssize_t got = ::read(descriptor_, into, most);
        if (got > 0) {
            return static_cast<std::size_t>(got);
        }
        if (got < 0 && errno != EINTR) {
            throw core::SystemError("read", std::string("the log cannot be read: ") + std::strerror(errno));
        }
        if (got == 0 && !follow_) {
            return 0;
        }
        if (got == 0) {
            check_same_file();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(wait_for_more));
    }
}

std::string GrowingStream::first(std::size_t least) {
    std::string all;
    char block[4096];
    while (all.size() < least) {
        const std::size_t got = read(block, sizeof block);
        if (got == 0) {
            break;
        }
        all.append(block, got);
    }
    first_ = all;
    return all;
}

void read_csv_stream(ByteStream& stream, const std::string& name,
                     const std::function<std::unique_ptr<ChannelSink>(const core::Table& first_rows)>& sink_of,
                     core::Problems& problems) {
    CsvStream csv(name, sink_of, problems);
    std::string text;
    std::vector<char> block(1 << 16);
    while (const std::size_t got = stream.read(block.data(), block.size())) {
        const std::size_t end = std::string_view(block.data(), got).rfind('\n');
        const std::size_t whole = end == std::string_view::npos ? 0 : text.size() + end + 1;
        text.append(block.data(), got);
        if (whole == 0 && text.size() > longest_line) {
            throw core::InputError("format", "a line of more than a megabyte: this is no CSV file", {name, {}, {}, {}});
        }
        if (whole > 0) {  // a last line without its end is still being written
            csv.take(text.substr(0, whole));
            text.erase(0, whole);
        }
    }
    if (is_row(text)) {
        const std::int64_t line = csv.next_line();
        const bool first = !csv.any();
        try {
            csv.take_whole(text);
        } catch (const core::InputError& error) {
            if (first) {
                throw;
            }
            problems.push_back({core::Problem::Severity::warning,
                                "the last line has no end and is left out: " + error.message(),
                                core::Place{name, line, {}, {}}});
        }
    }
    csv.sum_up();
    if (!csv.any()) {
        throw core::InputError("missing", "the log has no rows", {name, {}, {}, {}},
                               "a line with the names of the columns, then one line for each reading");
    }
}

}  // namespace underbody::dynamics
