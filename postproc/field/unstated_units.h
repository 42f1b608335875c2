// What a file does not say of its units, so that somebody can be asked.
#pragma once

#include <string>
#include <vector>

#include "postproc/field/field.h"

namespace underbody::postproc {

struct UnstatedUnit {
    std::string variable;  ///< as the file names it; empty: the coordinates
    std::string unit;      ///< the SI unit of its kind
    bool needed = true;    ///< without it the file is not read; else the SI unit is taken
    bool operator==(const UnstatedUnit&) const = default;
};

/// All of them, beyond those that `options` say. Reads the surfaces as often as there are some, and once more. Throws
/// as read_field for anything else that is wrong.
std::vector<UnstatedUnit> unstated_units(const std::filesystem::path& path, ReadOptions options = {},
                                         core::Progress& progress = core::Progress::none());

}  // namespace underbody::postproc
