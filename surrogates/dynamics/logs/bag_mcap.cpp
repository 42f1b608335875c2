// ROS 2 bags as MCAP (mcap.dev/spec): records of an operation, a length and their content; chunks hold records,
// compressed by lz4 or zstd.
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "core/counted.h"
#include "core/text.h"
#include "surrogates/dynamics/logs/log_bytes.h"
#include "surrogates/dynamics/logs/ros_message.h"

namespace underbody::dynamics {

namespace {

constexpr std::size_t head_size = 9;
constexpr std::uint64_t largest_record = std::uint64_t{1} << 30;

/// Fields of a record one after the other; a short record ends them.
class Fields {
public:
    explicit Fields(std::string_view bytes) : bytes_(bytes) {}
    template <typename Number>
    Number number() {
        const std::string_view own = take(sizeof(Number));
        return own.size() == sizeof(Number) ? number_at<Number>(own, 0) : Number{};
    }
    std::string_view text() { return take(number<std::uint32_t>()); }
    std::string_view take(std::uint64_t count) {
        ok_ = ok_ && count <= bytes_.size();
        const std::string_view own = bytes_.substr(0, ok_ ? static_cast<std::size_t>(count) : 0);
        bytes_.remove_prefix(own.size());
        return own;
    }
    [[nodiscard]] std::string_view rest() const { return bytes_; }
    [[nodiscard]] bool ok() const { return ok_; }

private:
    std::string_view bytes_;
    bool ok_ = true;
};

/// Grows `out` as the bytes come, so that a wrong size cannot ask for memory that the file does not fill.
bool unpack_zstd(std::string_view packed, std::uint64_t size, std::string& out) {
    const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(), ZSTD_freeDStream);
    ZSTD_inBuffer in{packed.data(), packed.size(), 0};
    std::string block(ZSTD_DStreamOutSize(), '\0');
    while (in.pos < in.size && out.size() <= size) {
        ZSTD_outBuffer to{block.data(), block.size(), 0};
        if (ZSTD_isError(ZSTD_decompressStream(stream.get(), &to, &in)) != 0) {
            return false;
        }
        out.append(block.data(), to.pos);
    }
    return out.size() == size;
}

bool unpack_lz4(std::string_view packed, std::uint64_t size, std::string& out) {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) {
        return false;
    }
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context,
                                                                                     LZ4F_freeDecompressionContext);
    std::string block(1 << 16, '\0');
    while (!packed.empty() && out.size() <= size) {
        std::size_t to = block.size(), from = packed.size();
        const std::size_t left = LZ4F_decompress(context, block.data(), &to, packed.data(), &from, nullptr);
        if (LZ4F_isError(left) != 0 || (to == 0 && from == 0)) {
            return false;
        }
        out.append(block.data(), to);
        packed.remove_prefix(from);
        if (left == 0) {
            break;
        }
    }
    return out.size() == size;
}

class McapReader {
public:
    McapReader(LogBytes& bytes, const std::string& name, LogSink& sink)
        : bytes_(bytes), name_(name), topics_(name, sink) {}

    LogEnd read() {
        LogEnd end;
        end.format = "ROS 2 bag, MCAP";
        bytes_.skip(8);
        while (next()) {
        }
        if (cut_at_) {
            end.problems.push_back(
                {core::Problem::Severity::warning,
                 "the log " + cut_ + ": " + cut_left_ + "; " +
                     core::counted(topics_.messages(), "message before it was", "messages before it were") +
                     " read, up to " + core::format_number(topics_.last(), 6) + " s of the log",
                 core::Place{name_, {}, {}, *cut_at_}});
        }
        for (const auto& [what, count] : bad_chunks_) {
            end.problems.push_back({core::Problem::Severity::warning,
                                    std::to_string(count.first) + (count.first == 1 ? " chunk " : " chunks ") + what +
                                        ": what they hold is missing",
                                    core::Place{name_, {}, {}, count.second}});
        }
        if (topics_.messages() == 0 && (cut_at_ || !bad_chunks_.empty())) {
            throw core::InputError("damaged",
                                   "an MCAP log without any message that can be read: " +
                                       (end.problems.empty() ? cut_ : end.problems.front().message),
                                   {name_, {}, {}, bytes_.offset()}, "copy it from the vehicle anew");
        }
        topics_.finish(end);
        return end;
    }

private:
    bool next() {
        const std::string_view head = bytes_.peek(head_size);
        if (head.size() < head_size) {
            cut("ends without its footer", bytes_left(head.size()));
            return false;
        }
        const auto operation = static_cast<unsigned char>(head[0]);
        const auto length = number_at<std::uint64_t>(head, 1);
        if (operation == 0x02 || operation == 0x0f) {
            return false;  // footer, end of data: what follows only repeats
        }
        if (operation == 0 || length > largest_record) {
            cut("is damaged here, where no record begins", "what follows was not read");
            return false;
        }
        const std::string_view record = bytes_.peek(head_size + length);
        if (record.size() < head_size + length) {
            cut("ends within a record", bytes_left(record.size()));
            if (operation == 0x06) {
                take_chunk(record.substr(head_size), true);
            }
            return false;
        }
        const std::string_view content = record.substr(head_size);
        operation == 0x06 ? take_chunk(content, false) : take(operation, content);
        bytes_.skip(head_size + length);
        return true;
    }

    static std::string bytes_left(std::size_t count) {
        return count == 0 ? "what came behind it is missing"
                          : "its last " + std::to_string(count) + (count == 1 ? " byte was left" : " bytes were left");
    }

    void cut(const std::string& how, const std::string& left) {
        cut_at_ = bytes_.offset();
        cut_ = how;
        cut_left_ = left;
    }

    void bad_chunk(const std::string& what) {
        auto& count = bad_chunks_[what];
        count.second = count.first == 0 ? bytes_.offset() : count.second;
        ++count.first;
    }

    void take(unsigned operation, std::string_view content) {
        Fields fields(content);
        if (operation == 0x03) {
            const auto id = fields.number<std::uint16_t>();
            const std::string type(fields.text());
            const std::string encoding(fields.text());
            const std::string_view text = fields.text();
            if (fields.ok()) {
                schemas_[id] = type;
                topics_.add_definition(type, encoding, text);
            }
        } else if (operation == 0x04) {
            const auto id = fields.number<std::uint16_t>();
            const auto schema = fields.number<std::uint16_t>();
            const std::string topic(fields.text());
            const std::string encoding(fields.text());
            if (fields.ok() && channels_.emplace(id, true).second) {
                topics_.add_topic(id, topic, schemas_.count(schema) > 0 ? schemas_[schema] : "", encoding);
            }
        } else if (operation == 0x05) {
            const auto channel = fields.number<std::uint16_t>();
            (void)fields.number<std::uint32_t>();
            const auto time = fields.number<std::uint64_t>();
            (void)fields.number<std::uint64_t>();
            if (fields.ok()) {
                topics_.message(channel, static_cast<std::int64_t>(time), fields.rest());
            }
        }
    }

    void take_chunk(std::string_view content, bool ends_early) {
        Fields fields(content);
        (void)fields.number<std::uint64_t>();
        (void)fields.number<std::uint64_t>();
        const auto size = fields.number<std::uint64_t>();
        const auto sum = fields.number<std::uint32_t>();
        const std::string compression(fields.text());
        const auto packed_size = fields.number<std::uint64_t>();
        if (!fields.ok() || size > largest_record) {
            bad_chunk("that cannot be read");
            return;
        }
        const std::string_view packed =
            fields.rest().substr(0, std::min<std::uint64_t>(packed_size, fields.rest().size()));
        std::string records;
        if (compression.empty()) {
            records = packed;
        } else if (compression != "zstd" && compression != "lz4") {
            bad_chunk("compressed by '" + compression + "', which is not known (zstd and lz4 are)");
            return;
        } else if (!(compression == "zstd" ? unpack_zstd(packed, size, records) : unpack_lz4(packed, size, records)) &&
                   !ends_early) {
            bad_chunk("that cannot be unpacked");
            return;
        }
        const auto found = crc32(0, reinterpret_cast<const Bytef*>(records.data()), static_cast<uInt>(records.size()));
        if (!ends_early && sum != 0 && found != sum) {
            bad_chunk("with a wrong checksum");
            return;
        }
        for (std::string_view rest = records; rest.size() >= head_size;) {
            const auto length = number_at<std::uint64_t>(rest, 1);
            if (length > rest.size() - head_size) {
                if (!ends_early) {
                    bad_chunk("whose last record is cut");
                }
                break;
            }
            take(static_cast<unsigned char>(rest[0]), rest.substr(head_size, length));
            rest.remove_prefix(head_size + length);
        }
    }

    LogBytes& bytes_;
    std::string name_;
    RosTopics topics_;
    std::map<std::uint16_t, std::string> schemas_;
    std::map<std::uint16_t, bool> channels_;
    std::optional<std::int64_t> cut_at_;
    std::string cut_, cut_left_;
    std::map<std::string, std::pair<std::size_t, std::int64_t>> bad_chunks_;
};

}  // namespace

LogEnd read_mcap(LogBytes& bytes, const std::string& name, LogSink& sink) {
    return McapReader(bytes, name, sink).read();
}

}  // namespace underbody::dynamics
