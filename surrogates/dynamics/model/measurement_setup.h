// What dataset.toml says of data that are still coming: how channels come out of a log, noise and conditions.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "surrogates/dynamics/logs/log_channels.h"

namespace underbody::dynamics {

struct MeasurementSetup {
    std::string motion;                        ///< as dataset.toml says it; empty: it does not
    std::map<std::string, double> noise;       ///< declared standard deviation of a channel, SI
    std::map<std::string, double> conditions;  ///< SI
    LogChannels channels;
};

/// Reads all but the runs of a dataset.toml (or of the one in a folder). Throws as read_measurements.
MeasurementSetup read_measurement_setup(const std::filesystem::path& path);

}  // namespace underbody::dynamics
