// Running one OpenFOAM case in its folder.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "cases/child_process.h"
#include "cases/lock.h"
#include "cases/stall_watch.h"

namespace underbody::cases {

/// Throws core::SystemError (kind "missing", with the package to install) when OpenFOAM is not on the PATH.
void need_openfoam();

/// How far a case is.
struct RunState {
    std::string step;    ///< "snappyHexMesh", "simpleFoam", ...: the newest log
    int iteration = 0;   ///< of the solver; 0 while the mesh is made
    int iterations = 0;  ///< as system/controlDict wants (endTime over deltaT); 0: not said
    /// s, to the last iteration at the pace of the latest ones; a run that settles ends earlier.
    std::optional<double> seconds_left;
    [[nodiscard]] double fraction() const;  ///< 0..1, the mesh being a tenth
};
RunState run_state(const std::filesystem::path& folder);

/// What the loads of a case did over its last iterations; forces of the mesh (a half's are half the body's).
struct SettledLoads {
    bool settled = false;
    int iterations = 0;       ///< that were looked at: 0 when there are too few
    double resultant = 0;     ///< N, size of the mean force
    double force_range = 0;   ///< N, largest less smallest of lift and of drag, the larger of both
    double moment_range = 0;  ///< N m, of the pitch moment
    std::string text;         ///< "lift, drag and pitch moment stay within 0.12 % of the resultant over 100 iterations"
};
/// Over the last 100 iterations neither lift nor drag changes by more than 0.3 % of the resultant, nor the pitch moment
/// by more than 0.3 % of the resultant times a tenth of the body's length (`lRef` of controlDict; without it the moment
/// does not count); not before iteration 220. Chosen, not fitted; of two coarse cases (ellipse at 2
/// and 5 mm) the means over 100 iterations moved by less than 2e-4 of the resultant from there to iteration 300. Throws
/// core::InputError for forces that cannot be read.
SettledLoads settled_loads(const std::filesystem::path& folder);

/// A case on its way: `Allrun` of the folder, as `underbody body domain` writes it. A solve of such a case that was cut
/// goes on from its last whole time; what is there of another mesh, or diverged, is set aside first (see
/// openfoam_result.h).
class OpenFoamRun {
public:
    /// Throws core::InputError when the folder is no case with an Allrun, when another process solves it (kind "busy"),
    /// and as need_openfoam().
    /// `lock`: the descriptor of a lock of the caller's that is to last as long as the solver runs; -1: none. `cores`:
    /// more than one by MPI; what a run that was cut left decomposed is put together first. A solver that hangs is
    /// ended: see StallWatch, whose limit UNDERBODY_HUNG_AFTER sets.
    explicit OpenFoamRun(std::filesystem::path folder, int lock = -1, int cores = 1);

    /// True when its script has ended well. Ends a run whose loads have settled, where the case waits for that. Throws
    /// core::InputError with the solver's own last words when it failed (kind "solver"; one whose forces are no longer
    /// finite, or that hangs, is ended), or was ended by a signal from outside (kind "killed").
    bool finished();
    /// Ends it; what it wrote stays.
    void stop() { child_->stop(); }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] double seconds() const;
    /// The time it goes on from, 0 with the mesh that was there; nothing when it began anew.
    [[nodiscard]] std::optional<double> went_on_from() const { return from_; }

private:
    std::filesystem::path folder_;
    std::chrono::steady_clock::time_point start_;
    std::optional<Lock> lock_;
    std::optional<double> from_;
    std::optional<ChildProcess> child_;
    bool watched_ = false;  // the case waits for settled_file
    std::chrono::steady_clock::time_point looked_;
    int cores_;
    StallWatch stall_;
    void look_at_loads();
    void look_whether_it_hangs();
};

}  // namespace underbody::cases
