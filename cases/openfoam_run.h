// Running one OpenFOAM case in its folder.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "cases/child_process.h"

namespace underbody::cases {

/// Throws core::SystemError (kind "missing", with the package to install) when OpenFOAM is not on the PATH.
void need_openfoam();

/// How far a case is.
struct RunState {
    std::string step;     ///< "snappyHexMesh", "simpleFoam", ...: the newest log
    int iteration = 0;    ///< of the solver; 0 while the mesh is made
    int iterations = 0;   ///< as system/controlDict wants (endTime over deltaT); 0: not said
    [[nodiscard]] double fraction() const;  ///< 0..1, the mesh being a tenth
};
RunState run_state(const std::filesystem::path& folder);

/// True when the solver has written its last time, the one that system/controlDict wants or that it called converged.
bool is_solved(const std::filesystem::path& folder);

/// A case on its way: `Allrun` of the folder, as `underbody body domain` writes it.
class OpenFoamRun {
public:
    /// Throws core::InputError when the folder is no case with an Allrun, and as need_openfoam().
    explicit OpenFoamRun(std::filesystem::path folder);

    /// True when it has ended well. Throws core::InputError with the solver's own last words when it failed.
    bool finished();
    /// Ends it; what it wrote stays.
    void stop() { child_->stop(); }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] double seconds() const;

private:
    std::filesystem::path folder_;
    std::chrono::steady_clock::time_point start_;
    std::optional<ChildProcess> child_;
};

}  // namespace underbody::cases
