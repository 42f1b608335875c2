// Columns of a simulated motion that are no quantities: whoever takes its file for a measured run is not told of them.
#pragma once

#include <string_view>

namespace underbody::dynamics {

inline constexpr const char* heave_drag_column = "heave_drag";  ///< N, of the declared law
inline constexpr const char* outside_table_column =
    "outside_table";  ///< 1 where a force table is asked beyond its range

/// True for the names above.
inline bool is_simulated(std::string_view name) { return name == heave_drag_column || name == outside_table_column; }

}  // namespace underbody::dynamics
