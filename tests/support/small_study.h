// A small study of our own making, whose loads are known in closed form.
#pragma once

#include <filesystem>
#include <string>

namespace underbody::test {

/// A cube of 0.1 m whose base is at z = gap, in CFD-Post's CSV form (blocks base and hull, node values): its pressure
/// falls by `gradient` Pa/m with height, so that the lift is gradient * 0.001 m^3 whatever the gap.
std::string cube_field(double gap, double gradient);

/// Its half at positive y, open in the plane y = 0.
std::string half_cube_field(double gap, double gradient);

/// Writes study.toml and fields `cube-h1.csv` ... `cube-h6.csv` (gaps in mm) whose lift is (7 - gap) / 10 N, a table
/// "lift" with a net weight of 0.35 N (one stable equilibrium at 3.5 mm: stiffness 100 N/m), and a verification table.
void write_small_study(const std::filesystem::path& folder);

}  // namespace underbody::test
