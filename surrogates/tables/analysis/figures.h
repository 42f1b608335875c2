// Pictures of tables as core::Figure values: curves with error bands, points and equilibria; maps for two axes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/figure.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/table_json.h"

namespace underbody::tables {

struct FigureOptions {
    std::string axis;  ///< along which; empty: gap, or the first
    Held held;         ///< the other axes, SI; those that are missing take 0 (pitch) or the middle of their range
    std::optional<EquilibriumOptions> equilibria;  ///< draws the net weight and the equilibria
    std::string title;
    /// Of the axis, where its values are positive. Not given: for a gap that spans decades.
    std::optional<bool> logarithmic;
    int samples = 400;
};

/// The curve along one axis with its band of two standard deviations, the points that lie on it, and the equilibria.
core::Figure curve_figure(const ForceTable& table, const FigureOptions& options = {});
/// One curve for each value of a second axis (its points, at most nine).
core::Figure family_figure(const ForceTable& table, const std::string& axis, const std::string& family,
                           const FigureOptions& options = {});
/// Colours over two axes, with the points; other axes held.
core::Figure map_figure(const ForceTable& table, const std::string& x_axis, const std::string& y_axis,
                        const FigureOptions& options = {});
/// Several tables of one quantity over each other, with names.
core::Figure comparison_figure(const std::vector<std::pair<std::string, ForceTable>>& tables,
                               const FigureOptions& options = {});
/// The one to show first: a map for two and more axes, a curve for one.
core::Figure figure(const ForceTable& table, const FigureOptions& options = {});

/// Unit of a slope: "N/m", "N/(m/s)".
std::string unit_per(const std::string& unit, const std::string& of);

}  // namespace underbody::tables
