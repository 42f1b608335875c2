// What every format writes: the grid with its Hermite data, its error, and the words for its header.
#pragma once

#include <string>
#include <vector>

#include "surrogates/tables/error_model.h"
#include "surrogates/tables/exports/export.h"
#include "surrogates/tables/grid.h"

namespace underbody::tables {

struct ExportAxis {
    std::string name;
    std::string unit;
    std::vector<double> points;
    RangePolicy range = RangePolicy::clamp;
};

struct ExportGrid {
    std::string name;      ///< identifier
    std::string quantity;  ///< in the frame: lift_force or z_force ...
    std::string unit;
    std::string meaning;   ///< one line with its sign
    std::vector<ExportAxis> axes;
    CubicGrid surface;
    ErrorModel error;
    /// Where it came from, line by line: program, source and its hash, kind, points, range, conditions, frame, thinning, remarks.
    std::vector<std::string> origin;
    std::vector<std::pair<std::string, double>> conditions;  ///< that the table holds for, SI
    std::vector<std::vector<double>> hull;  ///< points around which the table knows something; empty: all of the axes' box
    double thinning_error = 0;  ///< in `unit`: largest difference from the table, between the points too
    core::Problems remarks;
    bool single_precision = false;
};

/// The table in the frame and on the grid that the options ask for. `straight`: for a consumer that draws straight lines between the points. Its grid is
/// fine enough for these to stay within `max_error` of the table, or within a thousandth of the force's range where none is asked for.
ExportGrid export_grid(const ForceTable& table, const ExportOptions& options, bool straight, core::Progress& progress);

/// Smallest grid, out of the grid lines there are, whose cubic with the same slopes stays within `allowed` of `surface`.
std::vector<std::vector<double>> thinned_points(const CubicGrid& surface, double allowed, core::Progress& progress);
/// For consumers that draw straight lines between the points: the surface's grid lines with cells halved until those lines stay within `allowed`, at
/// most `most` an axis; and the fewest points out of a denser set that do.
std::vector<std::vector<double>> points_for_straight_lines(const CubicGrid& surface, double allowed, std::size_t most, core::Progress& progress);
std::vector<std::vector<double>> thinned_for_straight_lines(const CubicGrid& surface, double allowed, std::size_t most, core::Progress& progress);
/// What the file does outside its axes, one line for each; for formats that follow every policy.
std::vector<std::string> outside_lines(const ExportGrid& grid);
/// origin, then these lines.
std::vector<std::string> header_lines(const ExportGrid& grid);

/// Largest difference of two functions over the cells of `fine`.
double largest_difference(const CubicGrid& fine, const CubicGrid& coarse);
/// Likewise of a function and the multilinear one through its values at `points`.
double largest_straight_difference(const CubicGrid& fine, const std::vector<std::vector<double>>& points);

/// Letters, digits and underscores; never starts with a digit.
std::string identifier(const std::string& text);

// The formats.
void export_c(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_csv(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_json(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
std::filesystem::path mat_function(const std::filesystem::path& path);  ///< NAME_at.m that looks NAME.mat up
void export_mat(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_jsbsim(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_fmu(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);

}  // namespace underbody::tables
