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
};

struct ExportGrid {
    std::string name;      ///< identifier
    std::string quantity;  ///< in the frame: lift_force or z_force ...
    std::string unit;
    std::string meaning;   ///< one line with its sign
    std::vector<ExportAxis> axes;
    CubicGrid surface;
    ErrorModel error;
    RangePolicy range = RangePolicy::clamp;
    /// Where it came from, line by line: program, source and its hash, kind, points, range, conditions, frame, thinning, remarks.
    std::vector<std::string> origin;
    double thinning_error = 0;  ///< in `unit`
    bool single_precision = false;
};

/// The table in the frame and on the grid that the options ask for.
ExportGrid export_grid(const ForceTable& table, const ExportOptions& options, core::Progress& progress);

/// Smallest grid, out of the grid lines there are, whose cubic with the same slopes stays within `allowed` of `surface`.
std::vector<std::vector<double>> thinned_points(const CubicGrid& surface, double allowed, core::Progress& progress);
/// Largest difference of two functions over the cells of `fine`.
double largest_difference(const CubicGrid& fine, const CubicGrid& coarse);

/// Letters, digits and underscores; never starts with a digit.
std::string identifier(const std::string& text);

// The formats.
void export_c(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_csv(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_json(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_mat(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_jsbsim(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_fmu(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);

}  // namespace underbody::tables
