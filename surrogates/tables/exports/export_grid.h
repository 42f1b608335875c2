// What every format writes: the grid with its Hermite data, its error, and the words for its header.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "surrogates/tables/exports/export.h"
#include "surrogates/tables/fit/error_model.h"
#include "surrogates/tables/fit/grid.h"
#include "surrogates/tables/fit/support.h"

namespace underbody::tables {

struct ExportAxis {
    std::string name;
    std::string unit;
    std::vector<double> points;
    RangePolicy range = RangePolicy::clamp;
    double lower = 0, upper = 0;  ///< what counts as inside; the points may reach further

    /// Do the points end where the range does?
    [[nodiscard]] bool ends_with_range() const { return lower == points.front() && upper == points.back(); }
};

/// One force or moment over the axes.
struct ExportQuantity {
    std::string name;  ///< in the frame: lift_force or z_force ...
    std::string unit;
    std::string meaning;  ///< one line with its sign
    CubicGrid surface;
    ErrorModel error;
    std::vector<std::string> warnings;  ///< what changes what the numbers mean; read back with the table
    std::vector<std::string> told;      ///< lines of the head that no column says; likewise
    double difference =
        0;  ///< in `unit`: largest from the table, between the points too, and from the model that a table stands for
};

/// Where the forces act and how the vehicle is turned, when a model says it: from the centre of gravity to the centre
/// of the base, x forward, y starboard, z down, m.
using Lever = std::array<double, 3>;

struct ExportGrid {
    std::string name;  ///< identifier
    std::vector<ExportAxis> axes;
    std::vector<ExportQuantity> quantities;  ///< at least one, all on the same grid
    Frame frame = Frame::up;
    /// Where it came from, line by line: program, source and its hash, kind, points, range, conditions, frame,
    /// thinning, remarks.
    std::vector<std::string> origin;
    std::vector<std::pair<std::string, double>> conditions;  ///< that the table holds for, SI
    std::vector<std::vector<double>>
        hull;         ///< points around which the table knows something; empty: all of the axes' box
    Support support;  ///< where it has data
    std::optional<Lever> lever;
    core::Problems remarks;
    bool single_precision = false;
    bool fixed_point = false;
    std::size_t self_test_points = 0;  ///< 0: no self-test

    [[nodiscard]] const ExportQuantity& first() const { return quantities.front(); }
};

/// The tables in the frame and on one grid as the options ask for. `straight`: for a consumer that draws straight lines
/// between the points. These stay within `max_error` of the table (else core::UsageError); where neither an error nor
/// points are asked for, the cells of the table are halved until they stay within a thousandth of the force's range or
/// 400, 60 or 20 points an axis (one, two, more axes) are reached. `difference` says what came of it. Throws
/// core::UsageError when the tables have not the same axes.
ExportGrid export_grid(const std::vector<ForceTable>& tables, const ExportOptions& options, bool straight,
                       core::Progress& progress);

/// A function taken on other grid lines, with its slopes, and how far it is from what it was taken of.
struct Resampled {
    CubicGrid grid;
    double difference =
        0;  ///< largest, sampled in the cells too, with a margin of a fiftieth for what lies between the samples
};
Resampled resampled(const CubicGrid& fine, std::vector<std::vector<double>> points, core::Progress& progress);
/// Likewise for a consumer that draws straight lines between the values: `difference` is that of the lines.
Resampled straight_resampled(const CubicGrid& fine, std::vector<std::vector<double>> points, core::Progress& progress);
/// The difference on the grid lines of `coarse` along one axis.
double largest_difference_along(std::size_t axis, const CubicGrid& fine, const CubicGrid& coarse,
                                core::Progress& progress);

/// A small grid, out of the grid lines of `surface`, whose cubic with the same slopes stays within `allowed` of `full`:
/// along each axis the fewest lines for its share of the error. `surface` as it is where none does.
Resampled thinned(const CubicGrid& full, const CubicGrid& surface, double allowed, core::Progress& progress);
/// For consumers that draw straight lines between the points: the grid lines of `surface` with cells halved until those
/// lines stay within `allowed` of it, or `most` points an axis are reached; and a small grid out of a denser set that
/// stays within `allowed` of `full`, or the dense set where none does.
std::vector<std::vector<double>> points_for_straight_lines(const CubicGrid& surface, double allowed, std::size_t most,
                                                           core::Progress& progress);
Resampled thinned_for_straight_lines(const CubicGrid& full, const CubicGrid& surface, double allowed, std::size_t most,
                                     core::Progress& progress);
/// 1 where the grid has no data (outside its range, in an empty corner of its box), 0 where it has some, as a table for
/// a consumer that draws straight lines between its points and holds its ends: every change lies between two numbers
/// next to each other, so that no place sees another value.
struct Steps {
    std::vector<std::vector<double>> points;  ///< an axis
    std::vector<double> value;                ///< last axis fastest
};
Steps no_data_steps(const ExportGrid& grid);

/// What the file does outside its axes, one line for each; for formats that follow every policy.
std::vector<std::string> outside_lines(const ExportGrid& grid);
/// origin, then these lines.
std::vector<std::string> header_lines(const ExportGrid& grid);

// The formats.
std::filesystem::path c_self_test(const std::filesystem::path& path);  ///< NAME_test.c beside NAME.h
/// Bits after the point of the numbers of a header in whole numbers.
struct FixedBits {
    std::vector<int> axis;
    std::vector<int> value;               ///< of each quantity, also of its error
    std::vector<std::vector<int>> slope;  ///< of each quantity along each axis
    std::vector<std::vector<int>> growth;
};
/// A program without a library that says 0 when the header gives the values, slopes, errors and flags of the grid at
/// points in and around it; with `bits` a header in whole numbers, in whole numbers.
void write_c_self_test(const ExportGrid& grid, const std::filesystem::path& header, const FixedBits* bits = nullptr);
/// The header in whole numbers, and their bits; adds their rounding to the differences of the grid.
std::string c_fixed_point(ExportGrid& grid, FixedBits& bits);
void export_c(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_csv(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_json(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
std::filesystem::path mat_function(const std::filesystem::path& path);  ///< NAME_at.m that looks NAME.mat up
void export_mat(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_jsbsim(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_modelica(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_simulink(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);
void export_fmu(const ExportGrid& grid, const std::filesystem::path& path, ExportResult& result);

}  // namespace underbody::tables
