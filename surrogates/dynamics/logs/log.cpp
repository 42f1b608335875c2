#include "surrogates/dynamics/logs/log.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "core/counted.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/dynamics/logs/log_bytes.h"

namespace underbody::dynamics {

namespace fs = std::filesystem;

std::string_view LogBytes::peek(std::size_t count) {
    constexpr std::size_t block = 1 << 16;
    while (end_ - begin_ < count && !ended_) {
        progress_.check();
        if (begin_ > 0 && (begin_ == end_ || begin_ >= block)) {
            std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
            end_ -= begin_;
            begin_ = 0;
        }
        if (buffer_.size() < end_ + block) {
            buffer_.resize(end_ + block);
        }
        const std::size_t got = stream_.read(buffer_.data() + end_, block);
        ended_ = got == 0;
        end_ += got;
    }
    return {buffer_.data() + begin_, std::min(count, end_ - begin_)};
}

void LogBytes::skip(std::size_t count) {
    while (count > 0) {
        const std::size_t there = peek(std::min<std::size_t>(count, 1 << 16)).size();
        const std::size_t now = std::min(count, there);
        if (now == 0) {
            return;
        }
        begin_ += now;
        offset_ += static_cast<std::int64_t>(now);
        count -= now;
    }
}

void DamageReport::tell(const std::string& file, double last, core::Problems& problems) const {
    const std::string upto = "up to " + core::format_number(last, 6) + " s of the log";
    if (places_ > 0) {
        problems.push_back({core::Problem::Severity::warning,
                            "damaged in " + std::to_string(places_) + (places_ == 1 ? " place: " : " places: ") +
                                core::counted(bytes_, "byte") + " from byte " + std::to_string(first_) + " on " +
                                (bytes_ == 1 ? "fits no message and was" : "fit no message and were") +
                                " skipped; the rest was read " + upto,
                            core::Place{file, {}, {}, first_}});
    }
    if (cut_at_ >= 0) {
        problems.push_back({core::Problem::Severity::warning,
                            "the log ends within " + cut_what_ + ": its last " + std::to_string(cut_left_) +
                                (cut_left_ == 1 ? " byte was" : " bytes were") + " left, all before them was read, " +
                                upto,
                            core::Place{file, {}, {}, cut_at_}});
    }
}

void count_unread(std::vector<UnreadMessages>& all, const std::string& name, const std::string& type,
                  const std::string& reason) {
    for (UnreadMessages& one : all) {
        if (one.name == name && one.reason == reason) {
            ++one.count;
            return;
        }
    }
    all.push_back({name, type, reason, 1});
}

std::string known_unit(std::string_view stated) {
    std::string unit(core::trimmed(stated));
    // ArduPilot writes m/s/s; UDUNITS reads it as it stands.
    if (unit == "deg/s" || unit == "rad/s" || unit == "degC" || unit == "deg") {
        return unit;
    }
    if (unit == "degheading" || unit == "deglatitude" || unit == "deglongitude") {
        return "deg";  // ArduPilot says what kind of angle it is
    }
    return !unit.empty() && unit.find(' ') == std::string::npos && core::is_unit(unit) ? unit : std::string();
}

namespace {

constexpr std::string_view mcap_magic{"\x89MCAP0\r\n", 8};
constexpr std::string_view ulog_magic{"ULog\x01\x12\x35", 7};
constexpr std::string_view sqlite_magic{"SQLite format 3\0", 16};

class FileStream : public ByteStream {
public:
    explicit FileStream(const fs::path& path) : file_(std::fopen(path.c_str(), "rb")) {
        if (file_ == nullptr) {
            throw core::InputError("missing", std::string("this log cannot be opened: ") + std::strerror(errno),
                                   {path.string(), {}, {}, {}});
        }
    }
    ~FileStream() override { std::fclose(file_); }
    FileStream(const FileStream&) = delete;
    FileStream& operator=(const FileStream&) = delete;
    std::size_t read(char* into, std::size_t most) override { return std::fread(into, 1, most, file_); }

private:
    std::FILE* file_;
};

/// The .db3 and .mcap files of a bag's folder, by name.
std::vector<fs::path> bag_files(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string ending = entry.path().extension().string();
        if ((ending == ".db3" || ending == ".mcap") && entry.is_regular_file(ignored)) {
            files.push_back(entry.path());
        }
    }
    // bag_2 comes before bag_10
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
        return std::pair(a.string().size(), a.string()) < std::pair(b.string().size(), b.string());
    });
    return files;
}

[[noreturn]] void no_log(const std::string& name) {
    throw core::InputError("format", "this is no vehicle's log that can be read", {name, {}, {}, {}},
                           "PX4 ULog (.ulg), ArduPilot DataFlash (.bin, .log) and ROS 2 bags (.db3, .mcap) can; a "
                           "compressed one must be unpacked first (zstd -d, gunzip)");
}

/// The files of one bag as one log: series of the same name are one series, on one clock.
class JoinedSink : public LogSink {
public:
    explicit JoinedSink(LogSink& to) : to_(to) {}
    void next_file(double shift) {
        shift_ = shift;
        here_.clear();
    }
    bool begin(std::size_t series, const LogSeries& description) override {
        here_.resize(std::max(here_.size(), series + 1));
        for (std::size_t i = 0; i < known_.size(); ++i) {
            if (known_[i].name == description.name && known_[i].fields.size() == description.fields.size()) {
                here_[series] = i;
                return wanted_[i];
            }
        }
        here_[series] = known_.size();
        known_.push_back(description);
        wanted_.push_back(to_.begin(here_[series], description));
        return wanted_.back();
    }
    void row(std::size_t series, double time, std::span<const double> values) override {
        shifted_.assign(values.begin(), values.end());
        const std::vector<LogField>& fields = known_[here_[series]].fields;
        for (std::size_t i = 0; i < fields.size(); ++i) {
            shifted_[i] += fields[i].name.ends_with("stamp") ? shift_ : 0;
        }
        to_.row(here_[series], time + shift_, shifted_);
    }

private:
    LogSink& to_;
    double shift_ = 0;
    std::vector<std::size_t> here_;
    std::vector<LogSeries> known_;
    std::vector<bool> wanted_;
    std::vector<double> shifted_;
};

/// Start of a log: read until it is known.
class NoRows : public LogSink {
public:
    bool begin(std::size_t, const LogSeries&) override { return false; }
    void row(std::size_t, double, std::span<const double>) override {}
};

LogEnd read_bag_folder(const fs::path& folder, LogSink& sink, core::Progress& progress) {
    const std::vector<fs::path> files = bag_files(folder);
    if (files.empty()) {
        throw core::InputError("missing", "a folder without .db3 or .mcap files is no ROS 2 bag",
                               {folder.string(), {}, {}, {}}, "name the log itself");
    }
    JoinedSink joined(sink);
    LogEnd all;
    for (std::size_t i = 0; i < files.size(); ++i) {
        double shift = 0;
        if (i > 0) {
            NoRows none;
            shift = 1e-9 * static_cast<double>(read_log(files[i], none, progress).start - all.start);
        }
        joined.next_file(shift);
        LogEnd one = read_log(files[i], joined, progress);
        all.start = i == 0 ? one.start : all.start;
        all.format = one.format;
        all.clock = one.clock;
        all.unread.insert(all.unread.end(), one.unread.begin(), one.unread.end());
        all.problems.insert(all.problems.end(), one.problems.begin(), one.problems.end());
    }
    return all;
}

}  // namespace

std::string log_format(std::string_view bytes) {
    if (bytes.starts_with(ulog_magic)) {
        return "ulog";
    }
    if (bytes.starts_with(mcap_magic)) {
        return "mcap";
    }
    if (bytes.starts_with(sqlite_magic)) {
        return "sqlite bag";
    }
    if (bytes.starts_with("\xa3\x95")) {
        return "dataflash";
    }
    // Text logs begin with their formats; some have lines of a header before them.
    const std::size_t at = bytes.find("FMT,");
    if (at != std::string_view::npos && (at == 0 || bytes[at - 1] == '\n') && bytes.substr(at).find(',') == 3) {
        return "dataflash text";
    }
    return {};
}

std::string log_format(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
        const std::vector<fs::path> files = bag_files(path);
        return files.empty() ? std::string() : log_format(files.front());
    }
    std::ifstream file(path, std::ios::binary);
    char first[512];
    file.read(first, sizeof first);
    return log_format(std::string_view(first, static_cast<std::size_t>(file.gcount())));
}

LogEnd read_log(ByteStream& stream, const std::string& name, LogSink& sink, core::Progress& progress) {
    LogBytes bytes(stream, progress);
    const std::string format = log_format(bytes.peek(512));
    if (format == "ulog") {
        return read_ulog(bytes, name, sink);
    }
    if (format == "dataflash") {
        return read_dataflash(bytes, name, sink);
    }
    if (format == "dataflash text") {
        return read_dataflash_text(bytes, name, sink);
    }
    if (format == "mcap") {
        return read_mcap(bytes, name, sink);
    }
    if (format == "sqlite bag") {
        throw core::InputError("format", "a SQLite bag cannot be read from a stream", {name, {}, {}, {}},
                               "name the file, or record the bag as MCAP: ros2 bag record -s mcap");
    }
    no_log(name);
}

LogEnd read_log(const fs::path& path, LogSink& sink, core::Progress& progress) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
        return read_bag_folder(path, sink, progress);
    }
    if (log_format(path) == "sqlite bag") {
        return read_sqlite_bag(path, sink, progress);
    }
    FileStream stream(path);
    return read_log(stream, path.string(), sink, progress);
}

}  // namespace underbody::dynamics
