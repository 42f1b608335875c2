// What a vehicle's log holds: messages, fields, rates, duration, gaps in time.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "surrogates/dynamics/logs/log.h"

namespace underbody::dynamics {

struct LogFieldSummary {
    std::string name, unit;
    double min = 0, max = 0;  ///< NaN: no finite value
};

struct LogSeriesSummary {
    std::string name, type;
    std::size_t count = 0;
    double first = 0, last = 0;  ///< s since the log's start
    double rate = 0;             ///< 1/s, of the usual step (median); 0: fewer than two rows
    /// Times without a message that are longer than five usual steps, the longest ones first, at most eight.
    struct Silence {
        double from = 0, to = 0;
    };
    std::vector<Silence> silences;
    std::size_t silence_count = 0;
    std::vector<LogFieldSummary> fields;
};

struct LogSummary {
    std::string file;
    LogEnd end;
    double duration = 0;                   ///< s, from the first row to the last
    std::vector<LogSeriesSummary> series;  ///< by name
};

/// Throws as read_log.
LogSummary summarise_log(const std::filesystem::path& log, core::Progress& progress = core::Progress::none());

void to_json(nlohmann::json& json, const LogSummary& summary);

}  // namespace underbody::dynamics
