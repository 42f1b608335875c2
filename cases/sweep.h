// CFD of the cases that a study wants and does not have: [sweep] of study.toml.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cases/study.h"
#include "core/progress.h"

namespace underbody::cases {

/// A case that the sweep wants.
struct SweepCase {
    std::string name;            ///< "ellipse-h5-p0-u0.5": its folder under SweepSpec::folder, and its name in the study
    std::filesystem::path shape;
    Conditions conditions;       ///< variant, gap, pitch, speed, and the conditions that the sweep holds
    std::filesystem::path folder;
    bool present = false;        ///< solved here, or another file of the study has these conditions
};

/// Every body of the sweep at every gap, pitch and speed, in that order.
std::vector<SweepCase> sweep_cases(const Study& study);

/// The file that stands for a solved case and says of what it is made; readers of OpenFOAM cases take it.
inline constexpr const char* solved_marker = "case.foam";

/// The solved cases of a sweep, as cases of the study (Study::open adds them).
std::vector<Case> solved_cases(const Study& study);

struct SweepOptions {
    int jobs = 1;                    ///< cases at a time; each runs on one core
    std::optional<std::string> only; ///< this case alone, by name
};

struct SweepOutcome {
    std::string name;
    double seconds = 0;
    std::string error;  ///< empty: solved
};

/// Makes and solves the missing cases with OpenFOAM on this machine. A case is written and run in NAME.unfinished and
/// renamed when it is solved: a killed sweep goes on where it was. A case that fails does not stop the others; its
/// folder NAME.failed keeps the logs. Throws core::SystemError when OpenFOAM is not here, core::Cancelled (children
/// ended), core::InputError: no [sweep] in the study, no case of that name, a shape that cannot be placed.
std::vector<SweepOutcome> sweep_locally(const Study& study, const SweepOptions& options, core::Progress& progress = core::Progress::none());

/// A Slurm job array with one task a missing case, each `program sweep STUDY --only NAME`; the text of a batch script.
/// Empty when nothing is missing.
std::string slurm_script(const Study& study, const std::string& program);

}  // namespace underbody::cases
