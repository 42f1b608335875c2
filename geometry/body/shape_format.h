// What SHAPE.toml may hold.
#pragma once

#include "core/file_format.h"

namespace underbody::geometry {

/// Keys of SHAPE.toml, also with [[vary]] and [[tie]] of a file of variants; `read_shape`, `read_loading` and
/// `read_variants` read by it.
const core::FileFormat& shape_format();

}  // namespace underbody::geometry
