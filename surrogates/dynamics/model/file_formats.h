// What model.toml and dataset.toml may hold.
#pragma once

#include "core/file_format.h"

namespace underbody::dynamics {

/// Keys of model.toml: those of `model_items()` with forces, jets, effects and the rest. `read_model` reads by it.
const core::FileFormat& model_format();

/// Keys of dataset.toml. `read_measurements` reads by it.
const core::FileFormat& dataset_format();

}  // namespace underbody::dynamics
