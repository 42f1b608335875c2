// One input of a fuzzer as a vehicle's log. Only errors about the input may come out.
#pragma once

#include <cstdint>
#include <string_view>

#include "surrogates/dynamics/logs/log.h"
#include "surrogates/dynamics/logs/log_bytes.h"

namespace underbody::test {

struct AllRows : dynamics::LogSink {
    double sum = 0;
    bool begin(std::size_t, const dynamics::LogSeries&) override { return true; }
    void row(std::size_t, double time, std::span<const double> values) override {
        sum += time;
        for (const double value : values) {
            sum += value;
        }
    }
};

/// Reads the bytes with one reader, whatever they begin with.
template <typename Reader>
void feed_log(Reader&& reader, const std::uint8_t* data, std::size_t size) {
    dynamics::MemoryStream stream({reinterpret_cast<const char*>(data), size});
    dynamics::LogBytes bytes(stream, core::Progress::none());
    AllRows sink;
    try {
        (void)reader(bytes, "fuzzed", sink);
    } catch (const core::Error&) {
        // Refused: what a fuzzer's log deserves.
    }
}

}  // namespace underbody::test
