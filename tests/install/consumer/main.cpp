#include <underbody/core/table.h>
#include <underbody/core/units.h>
#include <underbody/surrogates/tables/fit/force_table.h>

#include <array>
#include <cmath>
#include <cstdio>

int main() {
    using namespace underbody;
    const auto points = core::read_csv("gap [mm], lift_force [N]\n1, 0.6\n2, 0.4\n5, 0.3\n", "consumer");
    const auto table = tables::ForceTable::fit(points, "lift_force");
    const std::array<double, 1> gap = {core::convert(2, "mm", "m")};
    const double lift = table.at(gap).value;
    std::printf("lift at 2 mm: %g N\n", lift);
    return std::abs(lift - 0.4) < 1e-12 ? 0 : 1;
}
