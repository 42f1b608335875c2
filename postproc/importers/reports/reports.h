// What a solver writes beside its fields: report files (monitors), transcripts, plots, force reports.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"

namespace underbody::postproc {

/// What a table of coefficients says of them (OpenFOAM's forceCoeffs): force = coefficient 1/2 density speed^2 area,
/// moment that times the length.
struct MonitorCoefficients {
    std::optional<double> density, speed, area, length;                     ///< kg/m^3, m/s, m^2, m
    std::optional<std::array<double, 3>> centre;                            ///< m, of the moments
    std::vector<std::pair<std::string, std::array<double, 3>>> directions;  ///< liftDir, dragDir, pitchAxis ...
};

/// A table of histories: the first column counts iterations or time steps, every other one is a quantity.
/// Units are the solver's: these files do not state any.
struct Monitor {
    std::string file;
    std::string title;
    std::vector<std::string> columns;
    std::vector<std::vector<double>> values;  ///< one list a column, all of the same length
    core::Problems problems;                  ///< restarts that repeat iterations, values that are not finite
    std::optional<MonitorCoefficients> coefficients{};

    /// nullptr when there is no such column.
    [[nodiscard]] const std::vector<double>* find(const std::string& column) const;
};

/// Rows of a monitor by their first number; of those of one number the last counts.
class MonitorRows {
public:
    void add(std::vector<double> row);
    [[nodiscard]] bool empty() const { return rows_.empty(); }
    /// Gives `monitor`, whose columns have names, their values, and says what repeats and what is not finite.
    void into(Monitor& monitor) const;

private:
    std::map<double, std::vector<double>> rows_;
    std::size_t repeated_ = 0;
};

/// The note that goes with rows that repeat.
core::Problem repeated_rows(std::size_t rows, const std::string& file);

/// Tables of OpenFOAM's function objects (force.dat, coefficient.dat ...), Fluent report files (.out, `*-rfile.out`),
/// monitors of Fluent 12 and older (two columns without header), tables with one line of names (.csv), the residuals in
/// a transcript (.trn) and in the output of CFX's solver (.out). Found by content. After a restart the first column
/// repeats or jumps back: the last value counts. Throws InputError with line.
Monitor read_monitor(const std::filesystem::path& path);

/// One curve of a Fluent .xy plot. Points come in the order of the file, which need not be that of the curve.
struct PlotCurve {
    std::string name;
    std::vector<double> x;
    std::vector<double> y;
};
struct Plot {
    std::string title;
    std::string x_label;
    std::string y_label;
    std::vector<PlotCurve> curves;
};
/// Throws InputError with line.
Plot read_plot(const std::filesystem::path& path);

/// One row of a force or moment report.
struct ReportedForce {
    std::string zone;  ///< "Net" for the sum
    double pressure = 0;
    double viscous = 0;
    double total = 0;
    double pressure_coefficient = 0;
    double viscous_coefficient = 0;
    double total_coefficient = 0;
};
/// "Forces - Direction Vector (1 0 0)" and "Moments - Moment Center (...) Moment Axis (...)"; Fluent 6's "Force vector:
/// (1 0 0)" and "Moment Center: (...)".
struct ForceReport {
    bool moments = false;
    std::array<double, 3> direction{};  ///< direction of the forces, or axis of the moments
    std::array<double, 3> centre{};     ///< of the moments
    std::vector<ReportedForce> rows;    ///< N or N m, whatever unit the report is in

    [[nodiscard]] const ReportedForce* net() const;
};
/// The wall forces in the output of CFX's solver (see cfx_output.h) are six reports: forces and moments along x, y, z.
/// All reports of a text (a transcript may hold many, with other lines between); those with a vector for each entry
/// ("(0.1 0.2 0.3)") become three reports along x, y, z. Throws InputError with line when there is none, or when the
/// text ends within one.
std::vector<ForceReport> read_force_reports(const std::filesystem::path& path);

/// What a text holds of these, found by its first megabytes.
struct ReportKinds {
    bool plot = false;
    bool monitor = false;  ///< a table with a header of names, or residuals among other lines
    bool forces = false;
    [[nodiscard]] bool any() const { return plot || monitor || forces; }
};
ReportKinds report_kinds(const std::filesystem::path& path);

}  // namespace underbody::postproc
