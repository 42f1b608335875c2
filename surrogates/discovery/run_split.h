// Which runs a time series is fitted to and which are held out of every fit and choice.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "surrogates/dynamics/model/measurements.h"

namespace underbody::discovery {

/// What is said of where an error is from (`held_out`), where nothing could be held out of the fit.
inline constexpr const char* fitted_runs =
    "the same runs that were fitted: there are too few to hold any out, so the error after is too good";
inline constexpr const char* fitted_readings =
    "the readings that were fitted, because fewer than eight set points leave none to hold out: too good by nature";

struct RunSplit {
    std::vector<std::size_t> train, test;          ///< of the records; of `beside` where that is there
    std::optional<dynamics::Measurements> beside;  ///< the data set in the folder held-out beside the data
    bool told = false;                             ///< by dataset.toml or a folder: not drawn
    std::string held_out;                          ///< for people
    core::Problems problems;
};

/// As dataset.toml marks them; else the folder held-out beside the data; else a quarter of the runs, one at least,
/// drawn by `seed`; with fewer than three the same runs, which is a warning. `run_of` is the run of each record.
RunSplit split_runs(const dynamics::Measurements& data, const std::vector<std::size_t>& run_of, std::uint64_t seed);

/// What is held out, as measurements: those of the split's test, or the data set beside.
dynamics::Measurements held_out_data(const RunSplit& split, const dynamics::Measurements& data,
                                     const std::vector<std::size_t>& run_of);

}  // namespace underbody::discovery
