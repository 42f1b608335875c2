// Measured data: a folder with `dataset.toml` and its runs (tables with units), docs/conventions.md section 4.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/table.h"

namespace underbody::dynamics {

/// What a run is for: fitted to, kept for the test, or left to the program to decide.
enum class RunUse { automatic, train, test };

/// One file of measurements.
struct MeasuredRun {
    std::string name;  ///< the file's name without folder and ending, "NAME piece 2"; distinct within a data set
    std::filesystem::path file;
    core::Table table;                         ///< SI, as read; missing values are NaN; its times ascend
    double clock_offset = 0;                   ///< s: times of the file less those of the table (run_pieces.h)
    std::map<std::string, double> conditions;  ///< SI; those of the data set, overridden by the run's own
    RunUse use = RunUse::automatic;

    /// The column `quantity`, or the condition of that name repeated for every row; empty when neither is there.
    [[nodiscard]] std::vector<double> values(const std::string& quantity) const;
    /// True if the column or the condition is there.
    [[nodiscard]] bool has(const std::string& quantity) const;
};

/// "run run-03 has no value of gap", of a column that is there; empty where it has one, and where there is none.
std::string empty_text(const MeasuredRun& run, const std::string& channel);

enum class MeasurementKind { time_series, steady };

struct Measurements {
    MeasurementKind kind = MeasurementKind::time_series;  ///< `steady` is `kind = "static"` in the file
    std::string title;
    /// Which motion the runs are of: "heave", "heave_pitch"; empty: as dataset.toml does not say, what the runs and the
    /// model can tell.
    std::string motion;
    std::filesystem::path folder;
    std::map<std::string, double> noise;  ///< declared standard deviation of a channel, SI
    std::vector<MeasuredRun> runs;        ///< in the file's order; of one whose clock was set each piece
    core::Problems problems;              ///< what the reader noticed and went on with

    /// The declared noise of a channel; nothing when it must be estimated.
    [[nodiscard]] std::optional<double> declared_noise(const std::string& channel) const;
    /// True if every run has the quantity, as a column or as a condition.
    [[nodiscard]] bool all_have(const std::string& quantity) const;
};

/// Reads `folder/dataset.toml` (or the file itself) and all its runs.
/// Throws core::InputError naming file and place: no dataset.toml, unknown kind or key (with the nearest known one), no
/// run, a file named twice, a run that does not read, a time series without `time` and `gap` or with fewer than three
/// rows, time that stands still or runs backwards where it cannot be cut into pieces (run_pieces.h), a static set
/// without a measured force or moment, noise that is not positive.
Measurements read_measurements(const std::filesystem::path& folder);

/// Names of the channels that a static set can measure: forces and moments.
const std::vector<std::string>& force_channels();

}  // namespace underbody::dynamics
