// The tables of the XML, interpolated linearly as JSBSim does it, stay within what the file says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "surrogates/tables/fit/table_batch.h"
#include "tests/surrogates/tables/exports_support.h"
#include "tests/surrogates/tables/jsbsim_evaluator.h"

namespace underbody {
namespace {

using tables::ForceTable;
using ::testing::HasSubstr;

/// One function of the file, over its axes as plain inputs.
struct Linear {
    test::Jsbsim file;
    std::string name;
    std::vector<std::string> axes;

    Linear(const std::string& xml, std::string function, const ForceTable& table)
        : file(plain(xml)), name("underbody/t/" + std::move(function)) {
        for (const auto& axis : table.axes()) {
            axes.push_back("underbody/t/" + axis.name);
        }
    }

    [[nodiscard]] double at(const double* p) {
        for (std::size_t k = 0; k < axes.size(); ++k) {
            file.properties[axes[k]] = p[k];
        }
        return file.property(name);
    }

private:
    /// The file without the functions that take the axes from the state of the vehicle.
    static std::string plain(std::string xml) {
        for (const char* axis : {"pitch", "speed", "gap"}) {
            const std::size_t begin = xml.find("<function name=\"underbody/t/" + std::string(axis) + "\">");
            if (begin != std::string::npos) {
                xml.erase(begin, xml.find("</function>", begin) + 11 - begin);
            }
        }
        return xml;
    }
};

double range_of(const ForceTable& table) {
    const auto& f = table.points().numbers("lift_force");
    const auto [low, high] = std::minmax_element(f.begin(), f.end());
    return *high - *low;
}

TEST(ExportsOfJsbsim, InterpolateLinearlyWithinWhatTheySay) {
    core::TemporaryFolder folder;
    for (const auto& table : {test::one_axis(), test::two_axes(), test::three_axes()}) {
        const std::size_t n = table.axes().size();
        for (const double share : {0.0, 0.02, 0.005}) {
            tables::ExportOptions options;
            options.max_error = share;
            const auto result = export_table(table, "jsbsim", folder.path() / "t.xml", options);
            const std::string xml = core::read_file(folder.path() / "t.xml");
            if (test::have("python3")) {
                EXPECT_EQ(
                    std::system(
                        ("python3 -c \"import xml.dom.minidom as m;d=m.parse('" + (folder.path() / "t.xml").string() +
                         "');assert len([f for f in d.getElementsByTagName('table')])==" + std::to_string(3 + n) + "\"")
                            .c_str()),
                    0);
            }
            Linear value(xml, "lift_force", table), sigma(xml, "lift_force_sigma", table);
            const auto points = test::random_points(table, 2000);
            for (std::size_t i = 0; i < points.size(); i += n) {
                const double difference = std::abs(value.at(&points[i]) - table.value(&points[i]));
                ASSERT_LE(difference, result.error);
                // JSBSim holds the ends, of the error too.
                std::vector<double> held(n);
                for (std::size_t k = 0; k < n; ++k) {
                    held[k] = std::clamp(points[i + k], table.axes()[k].lower, table.axes()[k].upper);
                }
                ASSERT_GE(sigma.at(&points[i]), (1 - 1e-12) * (table.sigma(held.data()) + difference));
            }
            EXPECT_LE(result.error, (share > 0 ? share : n == 3 ? 0.02 : 0.004) * range_of(table));
            EXPECT_THAT(xml, HasSubstr("Differs from the full table by at most"));
            EXPECT_THAT(xml, HasSubstr("interpolates linearly"));
            EXPECT_THAT(xml, HasSubstr("lift_force [N]"));
        }
    }
}

TEST(ExportsOfJsbsim, SayWhereTheyHaveNoData) {
    core::TemporaryFolder folder;
    for (const auto& table : {test::one_axis(), test::two_axes(), test::three_axes(), test::band()}) {
        const std::size_t n = table.axes().size();
        export_table(table, "jsbsim", folder.path() / "t.xml");
        const std::string xml = core::read_file(folder.path() / "t.xml");
        Linear outside(xml, "outside", table), no_data(xml, "no_data", table);
        const auto points = test::random_points(table, 2000);
        int empty = 0;
        for (std::size_t i = 0; i < points.size(); i += n) {
            const auto e = table.at({&points[i], n});
            ASSERT_EQ(outside.at(&points[i]), e.outside ? 1 : 0);
            ASSERT_EQ(no_data.at(&points[i]), e.no_data ? 1 : 0);
            empty += e.no_data && !e.outside ? 1 : 0;
        }
        EXPECT_EQ(empty > 0, table.kind() == "Gaussian process") << "the band has empty corners, the grids have none";
    }
}

/// To the last bit on both sides of every line between a cell with data and one without.
TEST(ExportsOfJsbsim, ChangeTheFlagAtTheLinesThemselves) {
    core::TemporaryFolder folder;
    const auto table = test::band();
    export_table(table, "jsbsim", folder.path() / "t.xml");
    Linear no_data(core::read_file(folder.path() / "t.xml"), "no_data", table);
    const tables::Support& support = *tables::data_support(table);
    for (const double gap : support.lines()[0]) {
        for (const double pitch : support.lines()[1]) {
            for (const double g : {gap, std::nextafter(gap, 0.0)}) {
                for (const double p : {pitch, std::nextafter(pitch, -1.0)}) {
                    const double at[2] = {g, p};
                    ASSERT_EQ(no_data.at(at), table.at(at).no_data ? 1 : 0) << g << " " << p;
                }
            }
        }
    }
}

TEST(ExportsOfJsbsim, TakeTheFewestPointsThatStraightLinesNeed) {
    // For a parabola of curvature 2 lines between n even points miss 1/(4 n^2): 1 % of its range needs 7 points, of
    // which two may be lost to the choice among halved cells.
    std::vector<double> x, y;
    for (int i = 0; i <= 40; ++i) {
        x.push_back(i / 40.0);
        y.push_back(x.back() * x.back());
    }
    core::Table data;
    data.add_numbers("gap", "m", x);
    data.add_numbers("lift_force", "N", y);
    const auto table = ForceTable::fit(data, "lift_force", test::interpolation());
    core::TemporaryFolder folder;
    tables::ExportOptions options;
    options.max_error = 0.01;
    const auto result = export_table(table, "jsbsim", folder.path() / "t.xml", options);
    EXPECT_GE(result.grid[0], 6u);
    EXPECT_LE(result.grid[0], 9u);
    EXPECT_LE(result.error, 0.01);
    // What no number of points reaches is said, and nothing is written.
    options.max_error = 1e-13;
    EXPECT_THROW(export_table(table, "jsbsim", folder.path() / "none.xml", options), core::UsageError);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "none.xml"));
}

TEST(ExportsOfJsbsim, StateAnErrorNearThatOfTheTable) {
    // One that holds everywhere is easily far too large.
    core::TemporaryFolder folder;
    const auto table = test::two_axes();
    const auto result = export_table(table, "jsbsim", folder.path() / "t.xml");
    Linear sigma(core::read_file(folder.path() / "t.xml"), "lift_force_sigma", table);
    core::Random random(17);
    double stated = 0, own = 0;
    for (int i = 0; i < 3000; ++i) {
        const double p[2] = {random.uniform(table.axes()[0].lower, table.axes()[0].upper),
                             random.uniform(table.axes()[1].lower, table.axes()[1].upper)};
        ASSERT_GE(sigma.at(p), (1 - 1e-12) * table.sigma(p));
        stated += sigma.at(p) / 3000;
        own += table.sigma(p) / 3000;
    }
    EXPECT_LE(stated, 1.1 * own + result.error);
}

TEST(ExportsOfJsbsim, SayThatTheyOnlyHoldTheirEnds) {
    core::TemporaryFolder folder;
    const auto result = export_table(test::two_axes("gap=refuse"), "jsbsim", folder.path() / "t.xml");
    std::string remarks;
    for (const auto& remark : result.remarks) {
        remarks += remark.message + "\n";
    }
    EXPECT_THAT(remarks, HasSubstr("JSBSim holds the ends of gap: it cannot refuse"));
    EXPECT_THAT(core::read_file(folder.path() / "t.xml"),
                HasSubstr("Outside the range of an axis JSBSim holds the end value"));
}

using Vector = std::array<double, 3>;

/// From axes along the heading, to starboard and down to body axes, roll after pitch.
Vector to_body(const Vector& v, double pitch, double roll) {
    const double st = std::sin(pitch), ct = std::cos(pitch), sp = std::sin(roll), cp = std::cos(roll);
    const double x = v[0] * ct - v[2] * st, z = v[0] * st + v[2] * ct;
    return {x, v[1] * cp + z * sp, -v[1] * sp + z * cp};
}

TEST(ExportsOfJsbsim, ApplyTheForcesToTheBodyAtTheCentreOfItsBase) {
    const ForceTable lift = test::sum_of_tables(), drag = test::sum_of_tables("clamp", "drag_force");
    core::Table turning;
    turning.source = "turning";
    const ForceTable two = test::two_axes();
    const core::Table& points = two.points();
    turning.add_numbers("gap", "m", points.numbers("gap"));
    turning.add_numbers("pitch", "rad", points.numbers("pitch"));
    turning.add_numbers("pitch_moment", "N m", points.numbers("lift_force"));
    core::TemporaryFolder folder;
    for (const auto frame : {tables::Frame::up, tables::Frame::ned}) {
        tables::ExportOptions options;
        options.frame = frame;
        const Vector lever{0.012, 0.003, 0.051};
        options.lever = lever;
        // Moments have the range of their own table; on one grid with the others only when that is the same, so here
        // alone.
        const auto result = export_tables({lift, drag}, "jsbsim", folder.path() / "hull.xml", options);
        const double most = result.errors[0].second + result.errors[1].second;  // straight lines between the points
        export_table(ForceTable::fit(turning, "pitch_moment", test::interpolation()), "jsbsim",
                     folder.path() / "turn.xml", options);
        test::Jsbsim hull(core::read_file(folder.path() / "hull.xml")),
            turn(core::read_file(folder.path() / "turn.xml"));
        core::Random random(31);
        for (int i = 0; i < 2000; ++i) {
            const double pitch = random.uniform(-0.08, 0.08), roll = random.uniform(-0.3, 0.3),
                         height = random.uniform(0.04, 0.2);
            const Vector flow{random.uniform(-1, 3), 0.1, random.uniform(-0.2, 0.2)};
            for (test::Jsbsim* file : {&hull, &turn}) {
                file->properties["attitude/theta-rad"] = pitch;
                file->properties["attitude/phi-rad"] = roll;
                file->properties["position/h-agl-ft"] = height / 0.3048;
                file->properties["velocities/u-aero-fps"] = flow[0] / 0.3048;
                file->properties["velocities/w-aero-fps"] = flow[2] / 0.3048;
            }
            // How far the base hangs below the centre of gravity: the lever turned back to the vertical.
            const Vector down = to_body({0, 0, 1}, pitch, roll);
            const double at[2] = {height - down[0] * lever[0] - down[1] * lever[1] - down[2] * lever[2], pitch};
            ASSERT_NEAR(hull.property("underbody/hull/gap"), at[0], 1e-14);
            const double forward = flow[0] * std::cos(pitch) + flow[2] * std::sin(pitch);
            const double sense = forward / std::sqrt(forward * forward + 1e-6);
            const double up = lift.value(at), back = sense * drag.value(at);
            const auto [force, moment] = hull.reactions();
            const Vector wanted = to_body({-back, 0, -up}, pitch, roll);
            for (std::size_t k = 0; k < 3; ++k) {
                ASSERT_NEAR(4.4482216152605 * force[k], wanted[k], most);
                const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
                ASSERT_NEAR(1.3558179483314004 * moment[k],
                            lever[a] * 4.4482216152605 * force[b] - lever[b] * 4.4482216152605 * force[a], 1e-12);
            }
            const auto [none, nose_up] = turn.reactions();
            ASSERT_EQ(none, (Vector{0, 0, 0}));
            ASSERT_NEAR(1.3558179483314004 * nose_up[1], turn.property("underbody/turn/pitch_moment"), 1e-12);
        }
    }
}

TEST(ExportsOfJsbsim, WithoutAPlaceOfTheBaseSaySo) {
    core::TemporaryFolder folder;
    const auto result = export_table(test::two_axes(), "jsbsim", folder.path() / "t.xml");
    std::string remarks;
    for (const auto& remark : result.remarks) {
        remarks += remark.message + "\n";
    }
    EXPECT_THAT(remarks, HasSubstr("nothing says where the centre of the base lies"));
    const std::string xml = core::read_file(folder.path() / "t.xml");
    EXPECT_THAT(xml, HasSubstr("Inputs to be set, in SI units: underbody/t/gap [m]"));
    EXPECT_TRUE(test::Jsbsim(xml).properties.contains("underbody/t/gap"));
}

}  // namespace
}  // namespace underbody
