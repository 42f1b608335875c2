// What is known of a design without a run.
#pragma once

#include <string>

#include "cases/design_spec.h"

namespace underbody::cases {

/// Whether [design.volume] asks for anything.
bool limits_volume(const DesignSpec& spec);
/// Why a shape breaks [design.volume], in words; empty: it does not.
std::string volume_fault(const DesignSpec& spec, const geometry::BodyShape& shape);

}  // namespace underbody::cases
