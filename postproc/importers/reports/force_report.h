// Forces or moments on zones as a solver reports them.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace underbody::postproc {

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

}  // namespace underbody::postproc
