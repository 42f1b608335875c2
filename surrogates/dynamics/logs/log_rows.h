// Rows of a run out of the readings of its channels. Only the reader of channels includes this.
#pragma once

#include <string>
#include <vector>

#include "surrogates/dynamics/logs/log_channels.h"

namespace underbody::dynamics {

/// As read_log_channels says it. `readings`: of each of `channels`, in the order of the log.
/// Throws core::InputError: a channel without a reading (`window`: of the log, for the message).
core::Table rows_of(const std::string& log, const LogChannels& channels, const std::vector<ChannelReadings>& readings,
                    const LogWindow& window, core::Problems& problems);

}  // namespace underbody::dynamics
