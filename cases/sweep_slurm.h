// A sweep as Slurm job arrays.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cases/study.h"
#include "cases/sweep.h"
#include "core/progress.h"

namespace underbody::cases {

/// A case that was submitted: NAME.submitted beside its folder, written before the job is.
struct SlurmClaim {
    std::string submission;  ///< also the end of the job's name
    std::string job;         ///< Slurm's number; empty while it is not known
    int task = 0;            ///< index in the array
    std::string since;
};
std::filesystem::path claim_file(const std::filesystem::path& case_folder);
std::optional<SlurmClaim> read_claim(const std::filesystem::path& case_folder);

/// What Slurm says of claims; each submission is asked for once.
class SlurmQueue {
public:
    /// "PENDING", "RUNNING", ...; "" when Slurm no longer has it; nothing when it cannot be asked (no squeue here, or
    /// it fails).
    std::optional<std::string> state(const SlurmClaim& claim);
    /// Does Slurm still have any task of its submission?
    bool has_any(const SlurmClaim& claim);

private:
    std::map<std::string, std::optional<std::map<int, std::string>>> known_;
};

/// One array of a sweep.
struct SlurmArray {
    std::filesystem::path script;
    std::vector<std::string> names;  ///< cases, task 1 first
    std::string job;                 ///< number; empty when there is no sbatch here
};

struct SlurmSweep {
    std::vector<SlurmArray> arrays;   ///< empty when nothing is missing
    std::optional<SlurmArray> study;  ///< the job that runs the study when they have ended (SlurmSpec::run_study)
};

struct SlurmSubmission {
    std::filesystem::path script;     ///< of the first array; those that follow are called NAME-2.sh, ...
    std::optional<std::string> only;  ///< this case alone, by name
    SlurmSpec settings;
    std::string program;  ///< this program, as the tasks call it
    bool keep_stale = false, replace_stale = false;
};

/// Writes the scripts of the missing cases, each task `program sweep STUDY --only NAME`, and submits them where there
/// is an sbatch. Cases that wait or run already are left out, and marked as submitted before sbatch is called: nobody
/// submits them twice. With several cores a task takes that many of one node. More cases than the site takes in one
/// array (SlurmSpec::max_array, else what `scontrol` says, else 1000) make several; with a throttle one begins when the
/// other has ended. Empty when nothing is missing. The job that runs the study waits for what was submitted earlier,
/// too, and is made for that alone where nothing is missing. Throws core::SystemError: sbatch refuses (its cases are
/// free again).
SlurmSweep submit_sweep(const Study& study, const SlurmSubmission& what,
                        core::Progress& progress = core::Progress::none());

/// May this stand as the value of one of Slurm's options in a script? One word: a blank or a line's end would make of
/// its rest another option, or a command.
bool slurm_takes(const std::string& text);

/// Waits until no case of the sweep waits or is being made; the cases as they are then. Throws core::Cancelled.
std::vector<SweepCase> wait_for_sweep(const Study& study, core::Progress& progress);

/// Cancels the jobs of the study that Slurm still has, also the one that would run the study; their numbers. What they
/// had begun stays for the next sweep. Throws core::SystemError: there is no scancel here, or it refuses.
std::vector<std::string> cancel_sweep(const Study& study, core::Progress& progress);

}  // namespace underbody::cases
