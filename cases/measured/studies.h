// Studies of third-party measurements: a simple declared model, the files, and what is known of what it lacks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "surrogates/discovery/discovery.h"

namespace underbody::cases {

struct MeasuredStudy {
    std::string name;        ///< "ball drops: golf ball"
    std::string data;        ///< the file, with its owner and licence
    std::string declared;    ///< the simple model in words
    std::string known;       ///< what is known of the answer
    discovery::Discovery found;
};

/// Where the measurements lie: $UNDERBODY_SHARED/measured, else ../shared/measured beside the sources; empty when missing.
std::filesystem::path measured_folder(const std::filesystem::path& beside = {});

/// Balls falling from a bridge: heave runs of a body without a force table, weight alone. One study a ball of known weight.
/// Throws core::InputError when a file is not as its PROVENANCE.md says.
std::vector<MeasuredStudy> ball_drop_studies(const std::filesystem::path& folder, core::Progress& progress = core::Progress::none());

/// Bearing of a tow-tank turbine: torque against shaft speed, declared viscous.
MeasuredStudy bearing_study(const std::filesystem::path& folder, core::Progress& progress = core::Progress::none());

}  // namespace underbody::cases
