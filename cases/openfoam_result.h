// Whether an OpenFOAM case is solved to its end, and from where a solve that was cut can go on.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace underbody::cases {

/// The number behind a word of system/controlDict or another dictionary: "endTime 400;". Comments are passed over.
std::optional<double> dictionary_number(const std::filesystem::path& dictionary, const std::string& word);

/// The end of a file: its last `bytes`.
std::string tail_of(const std::filesystem::path& file, long bytes);

/// A time folder of a case.
struct TimeFolder {
    double time = 0;
    std::filesystem::path folder;
};
/// Those after time 0, in order.
std::vector<TimeFolder> times_of(const std::filesystem::path& case_folder);

/// What a time folder lacks: "U ends before its end", "p has 900 values for 1000 cells", "there is no k"; empty when
/// every field is whole. Fields that the case has at time 0 have to be there for cases that Underbody wrote.
std::string missing_in(const TimeFolder& time);

/// In a case with a function object that waits for it: ends the run and has its last iteration written. OpenFOAM 1912
/// removes it then.
inline constexpr const char* settled_file = "settled";

/// How a solve ended.
struct SolveEnd {
    bool solved = false;
    std::string why;         ///< not solved: what is missing, in words
    double time = 0;         ///< the last one; 0: none
    bool converged = false;  ///< the solver called it converged before endTime, or its loads had settled
    bool settled = false;    ///< its loads had settled (see settled_loads), which ended it
    bool diverged = false;   ///< its forces are not finite
};

/// Solved means: the solver said that it ended (where it left a log), its last time is the one that controlDict wants
/// or that it called converged (or its loads had settled), every field of that time is whole, and the forces, where it
/// wrote some, reach it and are finite.
SolveEnd solve_end(const std::filesystem::path& folder);

/// Sets aside what a cut solve left half-written (times into incomplete-TIME) and says from which time it can go on;
/// nothing when it cannot: no complete mesh, one that is older than what it is made from, a solution that diverged, a
/// script that does not know `solve`.
std::optional<double> ready_to_go_on(const std::filesystem::path& folder);

/// A case whose script solves from the beginning only where there are no results: one that Underbody wrote.
bool solves_anew(const std::filesystem::path& folder);

/// Moves times, forces, logs and the mesh, if the script makes it, into previous, previous-2, ... within the case, so
/// that it begins anew. True when there was anything.
bool set_results_aside(const std::filesystem::path& folder);

}  // namespace underbody::cases
