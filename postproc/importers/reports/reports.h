// What a solver writes beside its fields: report files (monitors), transcripts, plots, force reports.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "postproc/importers/reports/force_report.h"
#include "postproc/importers/reports/monitor.h"

namespace underbody::postproc {

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
