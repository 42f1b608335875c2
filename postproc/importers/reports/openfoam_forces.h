// What OpenFOAM's function object `forces` writes beside its fields.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"

namespace underbody::postproc {

/// Histories of force and moment on some patches, axes of the case.
struct ForceHistory {
    using Triple = std::array<double, 3>;

    std::string name;                ///< of the function object: the folder under postProcessing
    std::vector<std::string> files;  ///< what was read, oldest start first
    std::vector<std::string>
        patches;      ///< names and patterns (regular expressions) of system/controlDict; empty: not found there
    Triple centre{};  ///< m, of the moments (CofR)
    std::vector<double> time;
    std::vector<Triple> pressure_force;  ///< N (with rhoInf of the function object)
    std::vector<Triple> viscous_force;
    std::vector<Triple> pressure_moment;  ///< N m about `centre`; empty when no moments were written
    std::vector<Triple> viscous_moment;
};

/// All function objects that wrote forces under CASE/postProcessing: force.dat and moment.dat (v1906 on) or forces.dat
/// (older, and the Foundation's). Parts written by restarts are joined, the later one counts. Porous parts are left
/// out. Empty when there are none. Throws core::InputError with file and line for a row that is not as its heading
/// says.
std::vector<ForceHistory> read_openfoam_forces(const std::filesystem::path& case_folder);

}  // namespace underbody::postproc
