// What a found effect changes beside the discovery's own consequence: separation of forces and stability map.
#pragma once

#include "core/progress.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/estimator/observe/made_again.h"

namespace underbody::discovery {

/// Separation along the gap and stability map with the found model beside those of the declared one: their figures go
/// into `found.figures`, their keys into `found.made_again`. Nothing where the verdict is "none".
std::optional<estimator::MadeAgain> make_again(Discovery& found, const dynamics::Model& declared,
                                               const dynamics::Measurements& data,
                                               core::Progress& progress = core::Progress::none());

}  // namespace underbody::discovery
