// ArduPilot DataFlash: messages that begin with A3 95 and a type; FMT messages describe them, FMTU, UNIT and MULT their
// units (ArduPilot, libraries/AP_Logger/LogStructure.h). The text form has one message a line.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/text.h"
#include "surrogates/dynamics/logs/log_bytes.h"

namespace underbody::dynamics {

namespace {

/// Letters of a format: bytes, and what the stored number is to be multiplied with. 0 bytes: no such letter.
struct Letter {
    std::size_t size = 0;
    double factor = 1;
    double (*value)(std::string_view, std::size_t) = nullptr;  ///< nullptr: text or a list
};

template <typename Number>
double as_double(std::string_view bytes, std::size_t at) {
    return static_cast<double>(number_at<Number>(bytes, at));
}

double half_float(std::string_view bytes, std::size_t at) {
    const auto bits = number_at<std::uint16_t>(bytes, at);
    const int exponent = (bits >> 10) & 31, fraction = bits & 1023;
    const double size = exponent == 31  ? (fraction != 0 ? std::nan("") : std::numeric_limits<double>::infinity())
                        : exponent == 0 ? std::ldexp(fraction, -24)
                                        : std::ldexp(1024 + fraction, exponent - 25);
    return (bits & 0x8000) != 0 ? -size : size;
}

Letter letter(char c) {
    switch (c) {
        case 'b':
            return {1, 1, as_double<std::int8_t>};
        case 'B':
        case 'M':
            return {1, 1, as_double<std::uint8_t>};
        case 'h':
            return {2, 1, as_double<std::int16_t>};
        case 'H':
            return {2, 1, as_double<std::uint16_t>};
        case 'i':
            return {4, 1, as_double<std::int32_t>};
        case 'I':
            return {4, 1, as_double<std::uint32_t>};
        case 'f':
            return {4, 1, as_double<float>};
        case 'd':
            return {8, 1, as_double<double>};
        case 'g':
            return {2, 1, half_float};
        case 'q':
            return {8, 1, as_double<std::int64_t>};
        case 'Q':
            return {8, 1, as_double<std::uint64_t>};
        case 'c':
            return {2, 1e-2, as_double<std::int16_t>};
        case 'C':
            return {2, 1e-2, as_double<std::uint16_t>};
        case 'e':
            return {4, 1e-2, as_double<std::int32_t>};
        case 'E':
            return {4, 1e-2, as_double<std::uint32_t>};
        case 'L':
            return {4, 1e-7, as_double<std::int32_t>};
        case 'n':
            return {4, 1, nullptr};
        case 'N':
            return {16, 1, nullptr};
        case 'Z':
        case 'a':
            return {64, 1, nullptr};
        default:
            return {};
    }
}

/// One type of message.
struct Format {
    std::string name, letters;
    std::vector<std::string> labels;
    std::size_t length = 0;  ///< of the whole message, binary logs
    std::string unit_ids, multiplier_ids;
    struct Instance {
        std::size_t series = 0;
        bool wanted = false;
    };
    std::map<long, Instance> instances;
    [[nodiscard]] bool is_time(std::size_t i) const { return labels[i] == "TimeUS" || labels[i] == "TimeMS"; }
    /// When a sample was taken, on the same clock.
    [[nodiscard]] bool is_stamp(std::size_t i) const { return is_time(i) || labels[i] == "SampleUS"; }
};

/// "RFND" and its numbers to series of the sink; what both forms of a DataFlash log share.
class DataflashRows {
public:
    DataflashRows(std::string name, LogSink& sink) : name_(std::move(name)), sink_(sink) {}

    void add_unit(long id, const std::string& label) { units_[static_cast<char>(id)] = label; }
    void add_multiplier(long id, double factor) { multipliers_[static_cast<char>(id)] = factor; }

    /// `numbers`: one a label, NaN for text, as they are stored; in a text log those of c, C, e, E and L are scaled
    /// already.
    void row(Format& format, std::vector<double>& numbers, bool text) {
        long instance = 0;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            // A log may be cut and damaged anywhere: an instance that is no small number is none.
            if (i < format.unit_ids.size() && format.unit_ids[i] == '#' && numbers[i] >= 0 && numbers[i] < 256) {
                instance = static_cast<long>(numbers[i]);
            }
        }
        const double time = time_of(format, numbers);
        values_.clear();
        auto found = format.instances.find(instance);
        if (found == format.instances.end()) {
            LogSeries series;
            series.name = format.name + (instance > 0 ? "[" + std::to_string(instance) + "]" : "");
            for (std::size_t i = 0; i < numbers.size(); ++i) {
                if (is_number(format, i)) {
                    series.fields.push_back({format.labels[i], format.is_stamp(i) ? "s" : unit_of(format, i)});
                }
            }
            const std::size_t id = series_++;
            found = format.instances.emplace(instance, Format::Instance{id, sink_.begin(id, series)}).first;
        }
        if (!found->second.wanted) {
            return;
        }
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (is_number(format, i)) {
                values_.push_back(format.is_time(i)    ? time
                                  : format.is_stamp(i) ? since_start(1e-6 * numbers[i])
                                                       : numbers[i] * factor_of(format, i, text));
            }
        }
        sink_.row(found->second.series, time, values_);
    }

    [[nodiscard]] double last() const { return last_; }
    void finish(LogEnd& end, std::size_t messages) const {
        end.clock = "microseconds since the autopilot started";
        end.start = whole_part(1e9 * start_.value_or(0));
        if (messages == 0) {
            throw core::InputError("damaged", "a DataFlash log without any message that can be read",
                                   {name_, {}, {}, {}}, "download it from the vehicle anew");
        }
    }

private:
    [[nodiscard]] static bool is_number(const Format& format, std::size_t i) {
        return letter(format.letters[i]).value != nullptr;
    }

    /// s since the first stamp; messages without one came at the last stamp there was.
    double time_of(const Format& format, const std::vector<double>& numbers) {
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (format.is_time(i) && std::isfinite(numbers[i])) {
                const double seconds = numbers[i] * (format.labels[i] == "TimeUS" ? 1e-6 : 1e-3);
                start_ = start_.value_or(seconds);
                last_ = since_start(seconds);
                return last_;
            }
        }
        return last_;
    }

    /// In whole microseconds: the difference of two large numbers is not.
    [[nodiscard]] double since_start(double seconds) const {
        return std::round((seconds - start_.value_or(0)) * 1e6) / 1e6;
    }

    [[nodiscard]] std::string unit_of(const Format& format, std::size_t i) const {
        if (i >= format.unit_ids.size()) {
            return {};
        }
        const auto found = units_.find(format.unit_ids[i]);
        return found == units_.end() ? std::string() : known_unit(found->second);
    }

    [[nodiscard]] double factor_of(const Format& format, std::size_t i, bool text) const {
        const double own = letter(format.letters[i]).factor;
        if (own != 1) {
            return text ? 1 : own;
        }
        const auto found =
            i < format.multiplier_ids.size() ? multipliers_.find(format.multiplier_ids[i]) : multipliers_.end();
        return found == multipliers_.end() || !(found->second > 0) ? 1 : found->second;
    }

    std::string name_;
    LogSink& sink_;
    std::map<char, std::string> units_;
    std::map<char, double> multipliers_;
    std::optional<double> start_;
    double last_ = 0;
    std::size_t series_ = 0;
    std::vector<double> values_;
};

std::vector<std::string> words(std::string_view text) {
    std::vector<std::string> all;
    for (const std::string_view part : core::split(text, ',')) {
        all.emplace_back(core::trimmed(part));
    }
    return all;
}

bool describes_log(const std::string& name) {
    return name == "FMT" || name == "FMTU" || name == "UNIT" || name == "MULT";
}

class BinaryReader {
public:
    BinaryReader(LogBytes& bytes, const std::string& name, LogSink& sink)
        : bytes_(bytes), name_(name), rows_(name, sink) {}

    LogEnd read() {
        LogEnd end;
        end.format = "ArduPilot DataFlash";
        while (next()) {
        }
        damage_.tell(name_, rows_.last(), end.problems);
        rows_.finish(end, messages_);
        end.unread = unread_;
        return end;
    }

private:
    static constexpr std::size_t head_size = 3;
    static constexpr unsigned fmt_type = 128;
    static constexpr std::size_t fmt_length = 89;

    [[nodiscard]] std::size_t length_of(unsigned type) const {
        return type == fmt_type ? fmt_length : formats_[type].length;
    }

    bool next() {
        const std::string_view head = bytes_.peek(head_size);
        if (head.empty()) {
            return false;
        }
        const bool begins = head.size() == head_size && head.starts_with("\xa3\x95");
        const std::size_t length = begins ? length_of(static_cast<unsigned char>(head[2])) : 0;
        if (head.size() < head_size) {
            damage_.cut(bytes_.offset(), head.size(), "a message");
            return false;
        }
        if (length == 0) {
            find_next();
            return true;
        }
        const std::string_view message = bytes_.peek(length);
        if (message.size() < length) {
            damage_.cut(bytes_.offset(), message.size(), "a message");
            return false;
        }
        take(static_cast<unsigned char>(message[2]), message);
        bytes_.skip(length);
        return true;
    }

    void find_next() {
        const std::int64_t from = bytes_.offset();
        bytes_.skip(1);
        for (;;) {
            const std::string_view window = bytes_.peek(1 << 16);
            if (window.size() < head_size) {
                bytes_.skip(window.size());
                break;
            }
            std::size_t at = 0;
            bool found = false;
            while (at + head_size <= window.size() && !found) {
                at = std::min(window.find("\xa3\x95", at), window.size());
                found = at + head_size <= window.size() && length_of(static_cast<unsigned char>(window[at + 2])) > 0;
                at += found ? 0 : 1;
            }
            bytes_.skip(found ? at : window.size() - 2);
            if (found) {
                break;
            }
        }
        damage_.skipped(from, bytes_.offset() - from);
    }

    void take(unsigned type, std::string_view message) {
        if (type == fmt_type) {
            take_format(message);
            return;
        }
        Format& format = formats_[type];
        if (format.letters.empty()) {
            return;
        }
        numbers_.clear();
        std::vector<std::string> texts;
        std::size_t at = head_size;
        for (std::size_t i = 0; i < format.letters.size(); ++i) {
            const Letter one = letter(format.letters[i]);
            numbers_.push_back(one.value != nullptr ? one.value(message, at) : std::nan(""));
            if (one.value == nullptr && describes_log(format.name)) {
                const std::string_view text = message.substr(at, one.size);
                texts.emplace_back(text.substr(0, text.find('\0')));
            }
            at += one.size;
        }
        ++messages_;
        if (!describes_log(format.name)) {
            rows_.row(format, numbers_, false);
            return;
        }
        const auto number = [&](const char* label) {
            const auto found = std::find(format.labels.begin(), format.labels.end(), label);
            return found == format.labels.end() ? std::nan("")
                                                : numbers_[static_cast<std::size_t>(found - format.labels.begin())];
        };
        if (format.name == "UNIT" && texts.size() == 1 && std::isfinite(number("Id"))) {
            rows_.add_unit(whole_part(number("Id")), texts[0]);
        } else if (format.name == "MULT" && std::isfinite(number("Id"))) {
            rows_.add_multiplier(whole_part(number("Id")), number("Mult"));
        } else if (format.name == "FMTU" && texts.size() == 2 && number("FmtType") >= 0 && number("FmtType") < 256) {
            Format& described = formats_[static_cast<std::size_t>(number("FmtType"))];
            described.unit_ids = texts[0];
            described.multiplier_ids = texts[1];
        }
    }

    void take_format(std::string_view message) {
        const auto text = [&](std::size_t at, std::size_t size) {
            const std::string_view all = message.substr(at, size);
            return std::string(all.substr(0, all.find('\0')));
        };
        const auto type = static_cast<unsigned char>(message[3]);
        Format format;
        format.length = static_cast<unsigned char>(message[4]);
        format.name = text(5, 4);
        format.letters = text(9, 16);
        format.labels = words(text(25, 64));
        std::size_t size = head_size;
        bool known = !format.letters.empty() && format.labels.size() == format.letters.size();
        for (const char c : format.letters) {
            known = known && letter(c).size > 0;
            size += letter(c).size;
        }
        if (type == fmt_type || formats_[type].name == format.name) {
            return;  // logs that are downloaded may describe a type again
        }
        if (!known || size != format.length) {
            if (format.length >= head_size && !format.name.empty()) {
                count_unread(unread_, format.name, "", "its format '" + format.letters + "' is not known");
            }
            format.letters.clear();
            format.labels.clear();
            format.length = std::max<std::size_t>(format.length, head_size);
        }
        formats_[type] = std::move(format);
    }

    LogBytes& bytes_;
    std::string name_;
    DataflashRows rows_;
    std::array<Format, 256> formats_;
    std::vector<double> numbers_;
    std::vector<UnreadMessages> unread_;
    DamageReport damage_;
    std::size_t messages_ = 0;
};

class TextReader {
public:
    TextReader(LogBytes& bytes, const std::string& name, LogSink& sink)
        : bytes_(bytes), name_(name), rows_(name, sink) {}

    LogEnd read() {
        LogEnd end;
        end.format = "ArduPilot DataFlash, text";
        std::string line;
        while (next_line(line)) {
            ++line_;
            take(core::trimmed(line));
        }
        if (bad_lines_ > 0) {
            end.problems.push_back(
                {core::Problem::Severity::warning,
                 std::to_string(bad_lines_) + (bad_lines_ == 1 ? " line fits" : " lines fit") +
                     " no format of the log and were passed over, this the first; the rest was read up to " +
                     core::format_number(rows_.last(), 6) + " s of the log",
                 core::Place{name_, first_bad_, {}, {}}});
        }
        rows_.finish(end, messages_);
        return end;
    }

private:
    bool next_line(std::string& line) {
        constexpr std::size_t longest = 1 << 16;
        for (std::size_t wanted = 256;; wanted *= 2) {
            const std::string_view window = bytes_.peek(wanted);
            const std::size_t end = window.find('\n');
            if (end != std::string_view::npos || window.size() < wanted || wanted >= longest) {
                if (window.empty()) {
                    return false;
                }
                line.assign(window.substr(0, end));
                bytes_.skip(end == std::string_view::npos ? window.size() : end + 1);
                return true;
            }
        }
    }

    void take(std::string_view line) {
        if (line.empty()) {
            return;
        }
        const std::vector<std::string_view> parts = core::split(line, ',');
        const std::string name(core::trimmed(parts[0]));
        if (name == "FMT" && parts.size() > 5) {
            Format format;
            format.name = core::trimmed(parts[3]);
            format.letters = core::trimmed(parts[4]);
            for (std::size_t i = 5; i < parts.size(); ++i) {
                format.labels.emplace_back(core::trimmed(parts[i]));
            }
            const bool known =
                format.labels.size() == format.letters.size() &&
                std::all_of(format.letters.begin(), format.letters.end(), [](char c) { return letter(c).size > 0; });
            type_names_[core::parse_integer(parts[1]).value_or(-1)] = format.name;
            if (known && formats_.count(format.name) == 0) {
                formats_[format.name] = std::move(format);
            }
            return;
        }
        const auto found = formats_.find(name);
        if (found == formats_.end() || parts.size() < found->second.letters.size() + 1) {
            first_bad_ = bad_lines_ == 0 ? line_ : first_bad_;
            ++bad_lines_;
            return;
        }
        ++messages_;
        if (describes_log(name)) {
            describe(name, found->second, parts);
            return;
        }
        numbers_.clear();
        for (std::size_t i = 0; i < found->second.letters.size(); ++i) {
            const bool number = letter(found->second.letters[i]).value != nullptr;
            numbers_.push_back(number ? core::parse_number(parts[i + 1]).value_or(std::nan("")) : std::nan(""));
        }
        rows_.row(found->second, numbers_, true);
    }

    void describe(const std::string& name, const Format& format, const std::vector<std::string_view>& parts) {
        const auto part = [&](const char* label) {
            const auto at = std::find(format.labels.begin(), format.labels.end(), label);
            return at == format.labels.end()
                       ? std::string_view()
                       : core::trimmed(parts[static_cast<std::size_t>(at - format.labels.begin()) + 1]);
        };
        const auto id = core::parse_integer(part(name == "FMTU" ? "FmtType" : "Id"));
        if (!id) {
            return;
        }
        if (name == "UNIT") {
            rows_.add_unit(static_cast<long>(*id), std::string(part("Label")));
        } else if (name == "MULT") {
            rows_.add_multiplier(static_cast<long>(*id), core::parse_number(part("Mult")).value_or(0));
        } else if (const auto described = formats_.find(type_names_[*id]); described != formats_.end()) {
            described->second.unit_ids = part("UnitIds");
            described->second.multiplier_ids = part("MultIds");
        }
    }

    LogBytes& bytes_;
    std::string name_;
    DataflashRows rows_;
    std::map<std::string, Format> formats_;
    std::map<long long, std::string> type_names_;
    std::vector<double> numbers_;
    std::size_t bad_lines_ = 0, messages_ = 0;
    std::int64_t line_ = 0, first_bad_ = 0;
};

}  // namespace

LogEnd read_dataflash(LogBytes& bytes, const std::string& name, LogSink& sink) {
    return BinaryReader(bytes, name, sink).read();
}

LogEnd read_dataflash_text(LogBytes& bytes, const std::string& name, LogSink& sink) {
    return TextReader(bytes, name, sink).read();
}

}  // namespace underbody::dynamics
