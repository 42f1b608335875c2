// Models that actions ask for: read once, and again when something that they were read from has changed.
#pragma once

#include <filesystem>
#include <memory>

#include "surrogates/dynamics/model/model.h"

namespace underbody::studio {

/// The model as its file declares it. Kept with the state of every file that was read for it. Safe from any thread.
/// Throws as dynamics::read_model.
std::shared_ptr<const dynamics::Model> known_model(const std::filesystem::path& file);

/// How often a model was read from disk so far.
std::size_t models_read();

}  // namespace underbody::studio
