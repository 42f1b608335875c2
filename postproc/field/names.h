// How files spell the canonical names. The names themselves: field.h.
#pragma once

#include <string>

namespace underbody::postproc {

/// How plain a file's name for a canonical one is: 0 that itself ("pressure"), 1 the same in other letters
/// ("Pressure"), then the spellings from the most to the least usual ("Static Pressure", "Solved Pressure").
int spelling_rank(const std::string& original, const std::string& canonical);

}  // namespace underbody::postproc
