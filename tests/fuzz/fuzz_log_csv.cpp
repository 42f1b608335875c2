// CSV as it comes, in one piece and in small ones. Only errors about the input may come out.
#include <memory>

#include "surrogates/dynamics/logs/growing.h"
#include "tests/fuzz/fuzz_log.h"

namespace underbody::test {
namespace {

struct Pieces : dynamics::ByteStream {
    std::string_view bytes;
    std::size_t piece;
    Pieces(std::string_view all, std::size_t most) : bytes(all), piece(most) {}
    std::size_t read(char* into, std::size_t most) override {
        const std::size_t count = std::min({piece, most, bytes.size()});
        bytes.copy(into, count);
        bytes.remove_prefix(count);
        return count;
    }
};

void read_in_pieces(std::string_view bytes, std::size_t piece) {
    struct Counting : dynamics::ChannelSink {
        Counting(const dynamics::LogChannels& channels, std::size_t& into) : ChannelSink(channels, {}), count(into) {}
        void reading(std::size_t, double, double) override { ++count; }
        std::size_t& count;
    };
    std::size_t count = 0;
    core::Problems problems;
    Pieces stream(bytes, piece);
    try {
        dynamics::read_csv_stream(
            stream, "fuzzed",
            [&](const core::Table& first) {
                return std::make_unique<Counting>(dynamics::channels_by_name(first), count);
            },
            problems);
    } catch (const core::Error&) {
        // Refused: what a fuzzer's log deserves.
    }
}

}  // namespace
}  // namespace underbody::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    for (const std::size_t piece : {size + 1, std::size_t{5}}) {
        underbody::test::read_in_pieces(bytes, piece);
    }
    return 0;
}
