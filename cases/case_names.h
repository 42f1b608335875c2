// What the cases of a study are called.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cases/study_spec.h"

namespace underbody::cases {

/// What a case is called as long as no other is called so. OpenFOAM's "case.foam" and "system/controlDict" are called
/// alike in every case: there it is the folder.
std::string short_name(const std::filesystem::path& path, const std::filesystem::path& study, bool folder);

/// Cases of one name get the folder before it that tells them apart.
void tell_names_apart(std::vector<Case>& cases, const std::filesystem::path& study);

}  // namespace underbody::cases
