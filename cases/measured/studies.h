// Studies of third-party measurements: a simple declared model, the files, and what is known of what it lacks.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/progress.h"
#include "surrogates/discovery/discovery.h"

namespace underbody::cases {

struct MeasuredStudy {
    std::string name;                                ///< "ball drops: golf ball"
    std::string data;                                ///< the file, with its owner and licence
    std::string declared;                            ///< the simple model in words
    std::string known;                               ///< what is known of the answer
    std::shared_ptr<core::TemporaryFolder> scratch;  ///< holds the table of the declared model
    dynamics::Model model;                           ///< as declared
    dynamics::Measurements measured;
    discovery::Discovery found;
};

/// Balls falling from a bridge: heave runs of a body without a force table, weight alone. One study a ball; for one
/// that was not weighed forces are for a mass of 1 kg. Throws core::InputError when a file is not as its PROVENANCE.md
/// says.
std::vector<MeasuredStudy> ball_drop_studies(const std::filesystem::path& folder,
                                             core::Progress& progress = core::Progress::none());

/// Bearing of a tow-tank turbine: torque against shaft speed, declared viscous.
MeasuredStudy bearing_study(const std::filesystem::path& folder, core::Progress& progress = core::Progress::none());

/// Struts of the same turbine without blades: torque against shaft speed, declared as its square.
MeasuredStudy strut_study(const std::filesystem::path& folder, core::Progress& progress = core::Progress::none());

/// A ship model along a bank: mean sinkage and trim against speed and place, each declared as the square of the speed.
/// Two studies.
std::vector<MeasuredStudy> bank_studies(const std::filesystem::path& folder,
                                        core::Progress& progress = core::Progress::none());

/// A small drone on a thrust stand: thrust of settled readings against the motor command, declared as a parabola.
MeasuredStudy thrust_stand_study(const std::filesystem::path& folder,
                                 core::Progress& progress = core::Progress::none());

/// The same kind of drone hovering under a plate: height held against height asked for.
MeasuredStudy ceiling_study(const std::filesystem::path& folder, core::Progress& progress = core::Progress::none());

/// All of them whose folder is there. Throws core::InputError when a file is not as its PROVENANCE.md says.
std::vector<MeasuredStudy> measured_studies(const std::filesystem::path& folder,
                                            core::Progress& progress = core::Progress::none());

/// One folder a study as discovery::write_discovery() fills it, and index.html over all: what was declared, what is
/// known, what was found.
void write_measured_reports(const std::vector<MeasuredStudy>& studies, const std::filesystem::path& folder,
                            const discovery::FigureRenderer& renderer);

}  // namespace underbody::cases
