// Tables that several tests use.
#pragma once

#include <string>
#include <vector>

#include "core/table.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::test {

/// REF-A of docs/physics.md section 6.3: gap (m) and force (mN), a made-up curve with zeros at 0 and 0.16 m.
inline core::Table ref_a() {
    const std::vector<double> gap = {-.05, -.04, -.03, -.02, -.01, 0,   .01, .02, .03, .04, .05, .06, .07,
                                     .08,  .09,  .10,  .12,  .14,  .16, .18, .20, .25, .30, .35, .40, .45,
                                     .50,  .60,  .70,  .80,  .90,  1.0, 1.1, 1.2, 1.3, 1.4, 1.6, 1.8};
    const std::vector<double> force = {40,    28.4,  18.8,   11,    4.9,   0,     -4.1, -7.4, -10, -12,
                                       -13.4, -14.2, -14.45, -14.2, -13.4, -12.2, -8.7, -4.4, 0,   3.9,
                                       7.3,   13.4,  17,     18.9,  19.75, 20,    19.8, 18.4, 16,  13.1,
                                       10.2,  7.6,   5.5,    3.9,   2.7,   1.9,   .9,   .4};
    std::vector<double> newton;
    for (const double f : force) {
        newton.push_back(f * 1e-3);
    }
    core::Table table;
    table.source = "REF-A";
    table.add_numbers("gap", "m", gap);
    table.add_numbers("lift_force", "N", newton);
    return table;
}

inline tables::ForceTable ref_a_spline() {
    tables::FitOptions options;
    options.kind = tables::FitOptions::Kind::spline;
    return tables::ForceTable::fit(ref_a(), "lift_force", options);
}

/// A table out of CSV text.
inline core::Table csv(const std::string& text) { return core::read_csv(text, "made.csv"); }

/// A full grid of gap (m) and pitch (rad) with values f(gap, pitch).
template <class F>
core::Table grid_table(const std::vector<double>& gap, const std::vector<double>& pitch, F&& f) {
    std::vector<double> a, b, v;
    for (const double g : gap) {
        for (const double p : pitch) {
            a.push_back(g);
            b.push_back(p);
            v.push_back(f(g, p));
        }
    }
    core::Table table;
    table.source = "grid";
    table.add_numbers("gap", "m", a);
    table.add_numbers("pitch", "rad", b);
    table.add_numbers("lift_force", "N", v);
    return table;
}

}  // namespace underbody::test
