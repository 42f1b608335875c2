// What study.toml may hold.
#pragma once

#include "core/file_format.h"

namespace underbody::cases {

/// Keys of study.toml. `Study::open` reads by it.
const core::FileFormat& study_format();

}  // namespace underbody::cases
