// CFD of the cases that a study wants and does not have: [sweep] of study.toml.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cases/study.h"
#include "core/progress.h"

namespace underbody::cases {

enum class SweepState {
    missing,  ///< to be made, or begun and cut: `reason` says where it goes on
    present,  ///< another file of the study has these conditions
    solved,   ///< here, of what the study asks for now
    stale,    ///< solved here, of something else: `reason` says what differs
    waiting,  ///< submitted to Slurm
    running,  ///< being made by another process, here or elsewhere
    failed,   ///< the last attempt failed: `reason` is its error; it is tried again
};
std::string to_string(SweepState state);

/// A case that the sweep wants.
struct SweepCase {
    std::string name;  ///< "ellipse-h5-p0-u0.5": its folder under SweepSpec::folder, and its name in the study
    std::filesystem::path shape;
    Conditions conditions;  ///< variant, gap, pitch, speed, and the conditions that the sweep holds
    std::filesystem::path folder;
    SweepState state = SweepState::missing;
    std::string reason;
    bool present = false;                ///< solved or present: nothing to be made
    int iteration = 0, iterations = 0;   ///< of one that runs or was cut; 0: not begun
    std::optional<double> seconds_left;  ///< of one that runs, at most
};

/// Every body of the sweep at every gap, pitch and speed, in that order, with their states. A case counts as solved
/// when its folder says so, what it was made of is what the study asks for now, and its last time is still whole. Where
/// the code that writes cases has changed since, or an older version left no record, the case is written anew into a
/// temporary folder and its files are compared. Writes nothing. Throws as sweep_locally for a shape that cannot be
/// read.
std::vector<SweepCase> sweep_cases(const Study& study, core::Progress& progress = core::Progress::none());

/// The file that stands for a solved case and says of what it is made; readers of OpenFOAM cases take it. It is written
/// whole at the end of a complete solve.
inline constexpr const char* solved_marker = "case.foam";

/// The solved cases of a sweep, as cases of the study (Study::open adds them); `notes` names those that are stale and
/// left out. Compares what the cases say of themselves and looks no further.
std::vector<Case> solved_cases(const Study& study, core::Problems& notes);

/// What becomes of cases that were solved of something else than the study asks for now.
enum class StaleCases {
    redo,     ///< solved again; the old folder is kept in set_aside beside the cases
    replace,  ///< solved again; the old folder is removed then
    keep,     ///< left as they are
};

struct SweepOptions {
    int jobs = 1;     ///< cases at a time
    int cores = 1;    ///< of each case, by MPI
    int retries = 0;  ///< of a case whose solver was ended or failed; one that diverged is not tried again
    std::optional<std::string> only;  ///< this case alone, by name
    StaleCases stale = StaleCases::redo;
    std::string submission;  ///< of the Slurm job whose task this is: its own cases are not somebody else's
    std::function<bool(const SweepCase&)> wanted;  ///< these cases alone; empty: all
    /// Called when a case is over that was begun here: its error, empty when it is solved.
    std::function<void(const SweepCase&, const std::string& error)> ended;
};

struct SweepOutcome {
    std::string name;
    double seconds = 0;
    std::string error;    ///< empty: solved, or skipped
    std::string skipped;  ///< why it was not made here: another process makes it, or has just made it
    std::string note;     ///< "goes on from iteration 150", "iterations: 40 there, 60 now: solved again"
};

/// Makes and solves the missing cases with OpenFOAM on this machine. A case is written and run in NAME.unfinished and
/// renamed when it is solved to its end (see solve_end): a killed sweep goes on where it was, a killed solve from its
/// last whole checkpoint. A case that fails does not stop the others; its folder NAME.failed keeps the logs. A solver
/// that was killed, or left its last time half-written, goes on the next time. NAME.lock keeps two sweeps from one
/// case. Throws core::SystemError when OpenFOAM is not here, core::Cancelled (children ended), core::InputError: no
/// [sweep] in the study, no case of that name, a shape that cannot be placed.
std::vector<SweepOutcome> sweep_locally(const Study& study, const SweepOptions& options,
                                        core::Progress& progress = core::Progress::none());

/// The cases to make: missing, failed and (unless they are kept) stale ones, or the one that is named; also those that
/// another process makes or Slurm has, as their state says. Cases that another version of the program solved with the
/// same files are noted as compared in their folders.
std::vector<SweepCase> wanted_cases(const Study& study, const SweepOptions& options,
                                    core::Progress& progress = core::Progress::none());

}  // namespace underbody::cases
