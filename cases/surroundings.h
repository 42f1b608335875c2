// The programs beside this one that some commands call: which are here, what each is for, how to get it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/progress.h"

namespace underbody::cases {

struct Surrounding {
    std::string name;     ///< "openfoam", "slurm", "display", ...
    std::string purpose;  ///< what this program does with it
    std::string get;      ///< how to install it on Debian
    bool found = false;
    std::string version;  ///< as it says itself; empty when it does not
    std::string path;     ///< of its main program; of a display its name
    std::string note;     ///< what is missing of it, or what else to know
};

/// Looks for all of them on the PATH and asks each for its version (at most five seconds each).
/// Nothing is changed or left running.
std::vector<Surrounding> surroundings(core::Progress& progress = core::Progress::none());

/// {name, for, found, version, path, get, note}
void to_json(nlohmann::json& json, const Surrounding& one);

/// The machine: {"cores", "memory" (bytes), "free_disk" (bytes, of the current folder)}.
nlohmann::json machine_json();

}  // namespace underbody::cases
