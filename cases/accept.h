// The model that discovery found for a measurement, taken as the study's own.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cases/study.h"

namespace underbody::cases {

struct Accepted {
    std::filesystem::path model;                                       ///< accepted_model()
    std::vector<std::pair<std::filesystem::path, std::string>> files;  ///< with their text, relative likewise
    std::vector<std::string> users;  ///< "measurement 'heave test'", "region 'glide'": whose model it becomes
    std::string study_text;          ///< of study.toml then
    std::string sentence;            ///< the verdict
};

/// Where the model of a measurement is written when it is accepted, relative to the study: models/NAME/model.toml.
std::filesystem::path accepted_model(const std::string& measurement);
/// One place in two spellings; nothing need be there.
bool same_place(const std::filesystem::path& a, const std::filesystem::path& b);

/// What accepting would change; nothing is written. The files are those of the stored discovery (else of the report
/// beside the study, which must be of the same result); the model becomes that of the measurement and of each
/// [[region]] and [[measurement]] that had the same; of a [[region]] whose model with the study's tables it was, too,
/// without `forces`: the found model has them. Throws core::UsageError: no such measurement; core::InputError:
/// nothing was discovered of it, or nothing is missing in its model, or the report is of an older result.
Accepted accept_model(const Study& study, const StudyResults& results, const std::string& measurement);

/// Writes the files and study.toml; the old model stays where it is.
void write_accepted(const Study& study, const Accepted& accepted);

/// The study with the found model in place, in a folder that lasts as long as the program, for looking at what rests
/// on it.
Study with_accepted(const Study& study, const StudyResults& results, const std::string& measurement);

}  // namespace underbody::cases
