// From clean points to a table. For the files of this room only.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "surrogates/tables/fit/error_model.h"
#include "surrogates/tables/fit/force_table.h"
#include "surrogates/tables/fit/process_candidates.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::tables {

/// Chooses and fits; throws core::InputError when the kind asked for cannot take the points.
std::shared_ptr<const ForceTable::Impl> fit_points(const SetPoints& points, const FitOptions& options);

/// A table that `export --format csv` or `json` wrote, taken back as it was; nothing when the table is not one of
/// those, not of this quantity, or lacks the columns of its axes or slopes. Throws core::InputError when rows or
/// numbers of it are missing.
std::shared_ptr<const ForceTable::Impl> fit_exported(const core::Table& table, const std::string& quantity,
                                                     const FitOptions& options);

/// Slope-sign changes of a full grid with errors that those errors do not support (less than two joint standard
/// deviations high).
core::Problems kinks(const SetPoints& points);

/// Beyond its ends a table knows nothing but that the force may go on as steeply as it came: per unit of the axis the
/// larger of the steepest mean slope over the last tenth of the points, and of the range of all values over the length
/// of the axis.
ErrorModel::Growth end_growth(const CubicGrid& grid, std::size_t k);

/// Leave-one-out errors of the monotone interpolation at the inner points of a full grid (the mean of the predictions
/// along the axes), in the order of the points; NaN at the ends of every axis, and at those that are passed over so
/// that no more than `at_most` are judged.
std::vector<double> interpolation_misses(const SetPoints& points, std::size_t at_most = SIZE_MAX);

/// Gaussian process, any points. `misses` (may be null) gets its leave-one-out errors, in the order of the points.
/// `candidates`: ranked_candidates of the points where they are known; empty: they are made.
std::shared_ptr<ForceTable::Impl> fit_gaussian_process(const SetPoints& points, std::vector<double>* misses,
                                                       std::vector<ProcessCandidate> candidates = {});

/// Scatter of points without errors about the process that suits them best.
struct Scatter {
    std::vector<double> sigma;  ///< of every point; empty: the points do not tell it
    bool plain = false;         ///< well told, and more than a hundredth of the spread of the forces
};
Scatter scatter_of(const SetPoints& points, std::vector<ProcessCandidate> candidates = {});

/// Exact interpolation of a full grid.
std::shared_ptr<ForceTable::Impl> fit_interpolation(const SetPoints& points, const FitOptions& options);

/// The table with its values moved by one draw from its error.
std::shared_ptr<const ForceTable::Impl> drawn_from(const ForceTable::Impl& table, std::uint64_t seed);

}  // namespace underbody::tables
