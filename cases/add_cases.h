// Cases for a study: a [[case]] more in study.toml, checked before anything is written.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cases/study.h"

namespace underbody::cases {

/// What a new [[case]] says.
struct NewCases {
    std::string files;                                            ///< pattern, relative to the study
    std::vector<std::pair<std::string, std::string>> conditions;  ///< "speed" -> "0.5m/s"
    std::vector<std::string> zones;
    std::string symmetry;     ///< normal axis of half models; empty: as the study has it
    std::string length_unit;  ///< that the files do not say
    std::vector<std::pair<std::string, std::string>> units;
    std::filesystem::path design_points;                          ///< Workbench's table
    std::vector<std::pair<std::string, std::string>> parameters;  ///< of it: "P1" -> "gap [mm]"
};

struct AddedCases {
    std::filesystem::path file;  ///< study.toml
    std::string text;            ///< of it, with the new lines
    Study study;                 ///< that it is
    std::size_t count = 0;       ///< of new cases
    /// Files that the pattern passes over though they look as if they were meant, each with the reason.
    std::vector<std::pair<std::filesystem::path, std::string>> left_out;
};

/// The study of the folder (or the beginning of one) with more cases; nothing is written. Throws core::InputError and
/// core::UsageError: what is wrong with the new lines, without a place, for nobody has seen them yet; a symmetry plane
/// that the other cases do not have.
AddedCases with_new_cases(const std::filesystem::path& folder, const NewCases& cases);

/// Writes study.toml.
void write_added(const AddedCases& added);

}  // namespace underbody::cases
