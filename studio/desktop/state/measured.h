// Measurements that were taken into a study, as actions and commands say them. What is on disk follows the state
// (Desk).
#pragma once

#include <filesystem>
#include <string>

#include "cases/add_measurement.h"
#include "studio/desktop/state/state.h"
#include "studio/desktop/state/words.h"

namespace underbody::studio {

/// Throws as cases::measured_channel.
cases::NewMeasurement new_measurement(const std::string& name, const MeasuredRecord& record);

/// `measure NAME KEY=VALUE ...`, as the action takes it.
Words words_of_measurement(const std::string& name, const MeasuredRecord& record);

/// `underbody study add FOLDER --data ...`, which does the same.
Words command_of_measurement(const std::filesystem::path& study, const std::string& name, const MeasuredRecord& record);

}  // namespace underbody::studio
