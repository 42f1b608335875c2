// Objectives and limits of [design] that are numbers of whole curves: the kick that a balance survives, the window of
// pitch.
#pragma once

#include <string>
#include <vector>

#include "cases/design_spec.h"
#include "core/toml.h"

namespace underbody::cases {

/// Reads what an objective or a limit with `curve` asks for; `r` has its conditions (`at`), of which the pitch that a
/// window lies about is none. Throws core::InputError with the place: a weight or mass that [design] does not state, a
/// load that it does not compute, a gap of a kick, a window of which nothing is asked, fewer than three gaps or
/// pitches.
void read_curve(const core::TomlTable& table, const DesignSpec& spec, tables::Response& r);

/// Keys of objectives and limits.
std::vector<core::FileKey> curve_keys();
/// Keys of [design] that they need.
std::vector<core::FileKey> keys_for_curves();

/// "0.012 +- 0.003 m/s", "at least 2 deg" where the range of the data cuts it, "none (-0.3 deg)" where there is none.
std::string told_response(const tables::ResponseValue& value, bool of_curves, const std::string& unit);
inline std::string told_response(const tables::ResponseValue& value, const tables::Response& response) {
    return told_response(value, response.curve.has_value(), response_unit(response));
}

}  // namespace underbody::cases
