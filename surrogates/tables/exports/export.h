// Force tables for controllers: files that evaluate like the table, with slopes and error where the format can.
//
// A new format is one file in this folder and one line in `exporters()` (export.cpp).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/figure.h"
#include "core/progress.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::tables {

/// Sign convention of what is written.
enum class Frame {
    up,  ///< as inside the program: lift positive up, drag against the motion
    ned  ///< body axes x forward, y starboard, z down: z_force = -lift_force, x_force = -drag_force, w =
         ///< -heave_velocity
};

struct ExportOptions {
    std::string name;               ///< prefix of C identifiers, model name; empty: that of the file
    bool single_precision = false;  ///< C: float instead of double
    bool fixed_point = false;       ///< C: whole numbers of 32 bits instead; straight lines between the points
    Frame frame = Frame::up;
    double max_error = 0;  ///< > 0: thin the grid to the smallest that stays within this share of range_of_points
    std::vector<std::pair<std::string, std::size_t>> points;  ///< axis -> that many evenly spaced points
    bool overwrite = false;                                   ///< also files that this program did not write
    bool self_test = false;  ///< C: beside the header NAME_test.c, a program that compares it with what this program
                             ///< says at so many points
    std::size_t self_test_points = 200;   ///< few enough for the memory of a controller
    std::vector<std::string> provenance;  ///< further lines on where the table comes from, for the head of the file
    /// Where the forces act: from the centre of gravity to the centre of the base, x forward, y starboard, z down, m.
    /// For formats that apply them to a body.
    std::optional<std::array<double, 3>> lever;
};

struct ExportResult {
    std::vector<std::filesystem::path> files;  ///< the first is the one asked for
    std::vector<std::size_t> grid;             ///< points an axis
    double error = 0;  ///< largest difference of the first quantity from the table in its range, in its unit (0: none)
    std::vector<std::pair<std::string, double>> errors;  ///< of every quantity, each in its unit
    core::Problems remarks;
};

struct ExportFormat {
    std::string name;         ///< "c"
    std::string ending;       ///< ".h"
    std::string description;  ///< one line
};
const std::vector<ExportFormat>& export_formats();

/// Smallest and largest force of the table's points; ExportOptions::max_error is a share of what lies between. Of the
/// points: a grid may reach far beyond the forces that were measured, where no points are.
std::pair<double, double> range_of_points(const ForceTable& table);

/// A name that C, MATLAB and Modelica take: letters, digits and underscores, a letter first.
std::string identifier(const std::string& text);

/// Throws core::UsageError for an unknown format, an axis that is none, a share that makes no sense; core::InputError
/// (kind "exists") when the path holds something this program did not write, or the file that the table was made of;
/// core::SystemError when it cannot be written. Whole files by rename.
ExportResult export_table(const ForceTable& table, const std::string& format, const std::filesystem::path& path,
                          const ExportOptions& options = {}, core::Progress& progress = core::Progress::none());
/// What the file gives less what the table gives, along the first axis; of several axes the largest difference over the
/// others. Throws as export_table does.
core::Figure export_difference_figure(const ForceTable& table, const std::string& format,
                                      const ExportOptions& options = {},
                                      core::Progress& progress = core::Progress::none());
/// Several forces and moments in one file, on one grid, looked up by one call. At least one; the same axes.
ExportResult export_tables(const std::vector<ForceTable>& tables, const std::string& format,
                           const std::filesystem::path& path, const ExportOptions& options = {},
                           core::Progress& progress = core::Progress::none());

}  // namespace underbody::tables
