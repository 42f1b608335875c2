// A search whose loads are smooth functions in place of a solver, in a folder of its own.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "cases/design.h"
#include "core/angle.h"
#include "core/file.h"
#include "core/own_files.h"
#include "core/text.h"

namespace underbody::cases::design_search {

inline constexpr const char* design_toml = R"(
title = "search"
[frame]
symmetry = "y"
[design]
shape = "evie.toml"
points = 16
gap = ["3 mm", "5 mm", "10 mm"]
pitch = ["-1 deg", "1 deg"]
quantities = ["lift_force", "pitch_moment"]
[[design.vary]]
key = "protrusion.height"
from = "0.5 mm"
to = "3 mm"
[[design.vary]]
key = "body.base_cut"
from = 0.6
to = 0.85
[[design.tie]]
key = "protrusion.length"
of = "protrusion.height"
factor = 12
[[design.fidelity]]
name = "coarse"
cell = 0.25
cost = "40 s"
[[design.fidelity]]
name = "medium"
cost = "160 s"
[[design.objective]]
name = "lift"
quantity = "lift_force"
sense = "maximise"
at = { gap = "5 mm", pitch = 0 }
[[design.objective]]
name = "stiffness"
quantity = "pitch_moment"
slope_along = "pitch"
sense = "minimise"
at = { gap = "5 mm", pitch = 0 }
[design.volume]
at_least = "0.1 L"
)";

inline constexpr const char* shape_toml = R"(
[body]
length = "203.2 mm"
width = "152 mm"
height = "145 mm"
base_cut = 0.75
[protrusion]
position = 0.8
height = "1 mm"
length = "20 mm"
)";

/// Smooth loads in place of a solver.
inline double lift(double height, double cut, double gap, double pitch) {
    return 0.3 * std::pow(gap / 5e-3, -0.5) * (1 + 60 * height - std::pow((cut - 0.72) / 0.1, 2) * 0.3) + 2 * pitch;
}
inline double moment(double height, double cut, double gap, double pitch) {
    return 0.4 * pitch * (1 - 300 * height) * std::pow(gap / 5e-3, -0.4) - 0.007 + 0.004 * cut;
}

/// The highest ridge with which a base of that cut clears the ground at all gaps and pitches of the search.
inline double highest(const Design& design, double cut) {
    const auto base = geometry::read_shape(design.spec().shape);
    double low = 0.5e-3, high = 3e-3;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (broken_by(design.spec(), base, std::vector<double>{middle, cut}) <= 0 ? low : high) = middle;
    }
    return low;
}

class DesignFiles : public testing::Test {
protected:
    DesignFiles() {
        core::write_file(folder_.path() / "study.toml", design_toml);
        core::write_file(folder_.path() / "evie.toml", shape_toml);
    }

    [[nodiscard]] Design open() const { return Design::open(Study::open(folder_.path())); }

    /// What another solver would put there: every design at every condition.
    void compute(const Design& design, bool leave_out_last = false) const {
        compute(design, {3, 5, 10}, {-1, 1}, lift, 0.0005, leave_out_last);
    }
    /// Gaps in mm, pitches in degrees, `sigma` of the lift in N.
    void compute(const Design& design, const std::vector<double>& gaps, const std::vector<double>& pitches,
                 double (*lift_of)(double, double, double, double), double sigma, bool leave_out_last = false) const {
        std::string csv =
            "design,protrusion.height [m],body.base_cut [1],gap [mm],pitch [deg],fidelity,lift_force "
            "[N],lift_force_sigma [N],"
            "pitch_moment [N m],pitch_moment_sigma [N m],state\n";
        std::size_t index = 0;
        for (const PlannedDesign& d : design.plan()) {
            const bool failed = leave_out_last && ++index == design.plan().size();
            for (const double gap : gaps) {
                for (const double pitch : pitches) {
                    const double a = pitch * core::degree;
                    csv += d.name + "," + core::format_number(d.at[0]) + "," + core::format_number(d.at[1]) + "," +
                           std::to_string(gap) + "," + std::to_string(pitch) + "," + d.fidelity + ",";
                    csv += failed ? ",,,,diverged\n"
                                  : std::to_string(lift_of(d.at[0], d.at[1], gap / 1e3, a)) + "," +
                                        core::format_number(sigma) + "," +
                                        std::to_string(moment(d.at[0], d.at[1], gap / 1e3, a)) + ",0.00001,solved\n";
                }
            }
        }
        core::write_file(folder_.path() / "design" / "results.csv", csv);
    }

    core::TemporaryFolder folder_;
};

}  // namespace underbody::cases::design_search
