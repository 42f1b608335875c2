// PX4 ULog, as documented in the PX4 user guide, "ULog File Format": a header, then messages of a size, a type and
// their content.
#include <algorithm>
#include <map>
#include <optional>

#include "core/text.h"
#include "surrogates/dynamics/logs/log_bytes.h"

namespace underbody::dynamics {

namespace {

constexpr std::size_t head_size = 3;
constexpr std::string_view known_types = "BFIMPQARDLCSO";

struct Primitive {
    std::string_view name;
    std::size_t size;
    double (*value)(std::string_view, std::size_t);
};

template <typename Number>
double as_double(std::string_view bytes, std::size_t at) {
    return static_cast<double>(number_at<Number>(bytes, at));
}

const Primitive* find_primitive(std::string_view name) {
    static const Primitive all[] = {
        {"int8_t", 1, as_double<std::int8_t>},   {"uint8_t", 1, as_double<std::uint8_t>},
        {"int16_t", 2, as_double<std::int16_t>}, {"uint16_t", 2, as_double<std::uint16_t>},
        {"int32_t", 4, as_double<std::int32_t>}, {"uint32_t", 4, as_double<std::uint32_t>},
        {"int64_t", 8, as_double<std::int64_t>}, {"uint64_t", 8, as_double<std::uint64_t>},
        {"float", 4, as_double<float>},          {"double", 8, as_double<double>},
        {"bool", 1, as_double<std::uint8_t>},    {"char", 1, nullptr},
    };
    const auto* found =
        std::find_if(std::begin(all), std::end(all), [&](const Primitive& one) { return one.name == name; });
    return found == std::end(all) ? nullptr : found;
}

/// Where a number lies in a message.
struct Leaf {
    std::string name;
    const Primitive* type;
    std::size_t at;
    [[nodiscard]] bool is_stamp() const { return type->name == "uint64_t" && name.starts_with("timestamp"); }
};

struct Layout {
    std::vector<Leaf> leaves;
    std::size_t size = 0;  ///< with the padding at its end
    std::size_t without_padding = 0;
    std::optional<std::size_t> time;  ///< index of the leaf "timestamp"
};

/// One subscription: messages of an id.
struct Subscription {
    std::size_t series = 0;
    Layout layout;
    bool wanted = false, begun = false;
    LogSeries description;
};

class UlogReader {
public:
    UlogReader(LogBytes& bytes, std::string name, LogSink& sink) : bytes_(bytes), name_(std::move(name)), sink_(sink) {}

    LogEnd read() {
        read_header();
        while (next()) {
        }
        damage_.tell(name_, last_, end_.problems);
        if (drops_ > 0) {
            end_.problems.push_back({core::Problem::Severity::warning,
                                     "the logger itself says that it lost data " + std::to_string(drops_) +
                                         (drops_ == 1 ? " time, " : " times, ") +
                                         core::format_number(1e-3 * dropped_ms_, 3) + " s in all",
                                     core::Place{name_, {}, {}, {}}});
        }
        if (subscriptions_.empty()) {
            throw core::InputError("damaged", "a ULog without any message that can be read",
                                   {name_, {}, {}, bytes_.offset()}, "copy it from the vehicle anew");
        }
        return end_;
    }

private:
    [[noreturn]] void bad(const std::string& what, const std::string& hint) const {
        throw core::InputError("format", what, {name_, {}, {}, bytes_.offset()}, hint);
    }

    void read_header() {
        const std::string_view head = bytes_.peek(16);
        if (head.size() < 16) {
            bad("a ULog of " + std::to_string(head.size()) + " bytes ends within its header",
                "copy it from the vehicle anew");
        }
        if (head[7] > 1) {
            bad("ULog version " + std::to_string(static_cast<int>(head[7])) + " is not known", "version 0 and 1 are");
        }
        start_us_ = number_at<std::uint64_t>(head, 8);
        end_.format = "PX4 ULog";
        end_.clock = "microseconds since the autopilot started";
        end_.start = static_cast<std::int64_t>(start_us_ * 1000);
        bytes_.skip(16);
    }

    /// True if a message of the type and size can stand at `at` of `window`.
    [[nodiscard]] bool plausible(std::string_view window, std::size_t at) const {
        const auto size = number_at<std::uint16_t>(window, at);
        const char type = window[at + 2];
        if (size == 0 || known_types.find(type) == std::string_view::npos) {
            return false;
        }
        if (type == 'D' && at + 5 <= window.size()) {
            return data_fits(number_at<std::uint16_t>(window, at + 3), size);
        }
        return true;
    }

    [[nodiscard]] bool data_fits(std::uint16_t id, std::size_t size) const {
        const auto found = subscriptions_.find(id);
        return found != subscriptions_.end() &&
               (size == found->second.layout.size + 2 || size == found->second.layout.without_padding + 2);
    }

    /// Skips to where three messages follow one another.
    void find_next() {
        const std::int64_t from = bytes_.offset();
        bytes_.skip(1);
        for (;;) {
            const std::string_view window = bytes_.peek(1 << 18);
            std::size_t start = 0;
            bool found = false;
            for (; start + head_size <= window.size() && start < (1 << 16) && !found; ++start) {
                found = chain(window, start);
            }
            bytes_.skip(found ? start - 1 : start);
            if (found || window.size() < head_size) {
                break;
            }
        }
        if (bytes_.peek(head_size).size() < head_size) {
            bytes_.skip(head_size);
        }
        damage_.skipped(from, bytes_.offset() - from);
    }

    [[nodiscard]] bool chain(std::string_view window, std::size_t at) const {
        for (int link = 0; link < 3; ++link) {
            if (at == window.size() && link > 0) {
                return true;
            }
            if (at + head_size + 2 > window.size() || !plausible(window, at)) {
                return false;
            }
            at += head_size + number_at<std::uint16_t>(window, at);
        }
        return true;
    }

    bool next() {
        std::string_view head = bytes_.peek(head_size + 2);
        if (head.empty()) {
            return false;
        }
        if (head.size() < head_size) {
            damage_.cut(bytes_.offset(), head.size(), "a message");
            return false;
        }
        const std::size_t size = number_at<std::uint16_t>(head, 0);
        const char type = head[2];
        // Where data were appended after a crash, the part before may end anywhere.
        for (const std::uint64_t at : appended_) {
            const auto here = static_cast<std::uint64_t>(bytes_.offset());
            if (here < at && at < here + head_size + size) {
                bytes_.skip(at - here);
                return true;
            }
        }
        const bool sure = type == 'D' && plausible(head, 0);
        const std::string_view message = bytes_.peek(head_size + size + (sure ? 0 : head_size));
        if (message.size() < head_size + size) {
            damage_.cut(bytes_.offset(), message.size(), "a message");
            return false;
        }
        const bool follows = message.size() < head_size + size + head_size || plausible_head(message, head_size + size);
        if (size == 0 || (type == 'D' && !sure) || !follows) {
            find_next();
            return true;
        }
        take(type, message.substr(head_size, size));
        bytes_.skip(head_size + size);
        return true;
    }

    [[nodiscard]] static bool plausible_head(std::string_view window, std::size_t at) {
        return number_at<std::uint16_t>(window, at) > 0 && window[at + 2] >= 'A' && window[at + 2] <= 'Z';
    }

    void take(char type, std::string_view content) {
        if (type == 'D') {
            take_data(content);
        } else if (type == 'A' && content.size() > 3) {
            subscribe(static_cast<std::uint8_t>(content[0]), number_at<std::uint16_t>(content, 1),
                      std::string(content.substr(3)));
        } else if (type == 'F') {
            const std::size_t colon = content.find(':');
            if (colon != std::string_view::npos) {
                formats_[std::string(content.substr(0, colon))] = std::string(content.substr(colon + 1));
            }
        } else if (type == 'B' && content.size() >= 40) {
            take_flags(content);
        } else if (type == 'O' && content.size() >= 2) {
            ++drops_;
            dropped_ms_ += number_at<std::uint16_t>(content, 0);
        }
    }

    void take_flags(std::string_view content) {
        for (std::size_t i = 8; i < 16; ++i) {
            const int needed = static_cast<unsigned char>(content[i]) & (i == 8 ? 0xfe : 0xff);
            if (needed != 0) {
                bad("this ULog needs a feature that is not known (incompatible flag " + std::to_string(needed) +
                        " of byte " + std::to_string(i - 8) + ")",
                    "write it with an earlier logger, or convert it to CSV with ulog2csv");
            }
        }
        if ((content[8] & 1) != 0) {
            for (std::size_t i = 16; i < 40; i += 8) {
                appended_.push_back(number_at<std::uint64_t>(content, i));
            }
        }
    }

    /// Lays out a type's fields one after the other; false where a type is not described.
    bool lay_out(const std::string& type, const std::string& prefix, Layout& layout, int depth) {
        const auto format = formats_.find(type);
        if (format == formats_.end() || depth > 8) {
            return false;
        }
        for (const std::string_view part : core::split(format->second, ';')) {
            const std::size_t space = part.find(' ');
            if (space == std::string_view::npos) {
                continue;
            }
            std::string_view of = part.substr(0, space);
            const std::string field(part.substr(space + 1));
            std::size_t count = 1;
            const std::size_t bracket = of.find('[');
            if (bracket != std::string_view::npos) {
                const auto number = core::parse_integer(of.substr(bracket + 1, of.size() - bracket - 2));
                if (!number || *number < 1 || *number > 65535) {
                    return false;
                }
                count = static_cast<std::size_t>(*number);
                of = of.substr(0, bracket);
            }
            const bool padding = field.starts_with("_padding");
            const Primitive* primitive = find_primitive(of);
            for (std::size_t i = 0; i < count; ++i) {
                const std::string name =
                    prefix + field + (bracket != std::string_view::npos ? "[" + std::to_string(i) + "]" : "");
                if (primitive == nullptr) {
                    if (!lay_out(std::string(of), name + ".", layout, depth + 1)) {
                        return false;
                    }
                    continue;
                }
                if (primitive->value != nullptr && !padding) {
                    if (name == "timestamp" && primitive->size == 8) {
                        layout.time = layout.leaves.size();
                    }
                    layout.leaves.push_back({name, primitive, layout.size});
                }
                layout.size += primitive->size;
                if (layout.size > 65535) {
                    return false;
                }
            }
            layout.without_padding = padding ? layout.without_padding : layout.size;
        }
        return true;
    }

    void subscribe(unsigned instance, std::uint16_t id, const std::string& type) {
        Subscription one;
        one.description.name = type + (instance > 0 ? "[" + std::to_string(instance) + "]" : "");
        one.description.type = type;
        if (!lay_out(type, "", one.layout, 0) || !one.layout.time) {
            count_unread(end_.unread, one.description.name, type,
                         one.layout.size > 0 && formats_.count(type) > 0
                             ? "its format has no timestamp, or too many bytes"
                             : "its format is not described in the log");
            // Its size is unknown: such messages are passed over by the search for the next one.
            one.layout.leaves.clear();
        }
        for (const Leaf& leaf : one.layout.leaves) {
            one.description.fields.push_back({leaf.name, leaf.is_stamp() ? "s" : ""});
        }
        one.series = series_++;
        subscriptions_[id] = std::move(one);
    }

    void take_data(std::string_view content) {
        Subscription& of = subscriptions_.at(number_at<std::uint16_t>(content, 0));
        content.remove_prefix(2);
        if (of.layout.leaves.empty()) {
            return;
        }
        if (!of.begun) {
            of.begun = true;
            of.wanted = sink_.begin(of.series, of.description);
        }
        const double time = seconds(number_at<std::uint64_t>(content, of.layout.leaves[*of.layout.time].at));
        last_ = std::max(last_, time);
        if (!of.wanted) {
            return;
        }
        values_.clear();
        for (const Leaf& leaf : of.layout.leaves) {
            values_.push_back(leaf.is_stamp() ? seconds(number_at<std::uint64_t>(content, leaf.at))
                                              : leaf.type->value(content, leaf.at));
        }
        sink_.row(of.series, time, values_);
    }

    [[nodiscard]] double seconds(std::uint64_t microseconds) const {
        return static_cast<double>(static_cast<std::int64_t>(microseconds - start_us_)) / 1e6;
    }

    LogBytes& bytes_;
    std::string name_;
    LogSink& sink_;
    LogEnd end_;
    std::map<std::string, std::string> formats_;
    std::map<std::uint16_t, Subscription> subscriptions_;
    std::vector<std::uint64_t> appended_;
    std::vector<double> values_;
    DamageReport damage_;
    std::size_t series_ = 0, drops_ = 0;
    double dropped_ms_ = 0, last_ = 0;
    std::uint64_t start_us_ = 0;
};

}  // namespace

LogEnd read_ulog(LogBytes& bytes, const std::string& name, LogSink& sink) {
    return UlogReader(bytes, name, sink).read();
}

}  // namespace underbody::dynamics
