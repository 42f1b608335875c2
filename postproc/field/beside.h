// What lies beside a CFD file in its folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace underbody::postproc {

/// The name of a CFD file without its folder and endings: "case.cas.h5" -> "case".
std::string case_stem(const std::filesystem::path& file);

/// "case" and "case-coarse" of "case-coarse.txt", not "cas".
bool named_after(const std::string& name, const std::string& stem);

/// The files of the file's folder whose names begin with its stem, "case.txt", "case-forces.out", "case-coarse.csv";
/// itself not. Folders of many files are listed once.
std::vector<std::filesystem::path> files_named_after(const std::filesystem::path& file);

/// Texts that may hold residuals or monitors of the case: an OpenFOAM case's log files; for a file the texts (.out,
/// .trn, .log, .txt) that are named after it and no other CFD file, and where the folder holds no other case all its
/// .out and .trn.
std::vector<std::filesystem::path> histories_beside(const std::filesystem::path& file);

}  // namespace underbody::postproc
