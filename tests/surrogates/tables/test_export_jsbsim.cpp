// The tables of the XML, interpolated linearly as JSBSim does it, stay within what the file says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/surrogates/tables/exports_support.h"

namespace underbody {
namespace {

using tables::ForceTable;
using ::testing::HasSubstr;

/// One function of the file: points an axis, values with the last axis fastest.
struct Linear {
    std::vector<std::vector<double>> points;
    std::vector<double> values;

    Linear(const std::string& xml, const std::string& name, std::size_t axes) : points(axes) {
        const std::size_t begin = xml.find("<function name=\"underbody/" + name + "\">");
        const std::string text = xml.substr(begin, xml.find("</function>", begin) - begin);
        std::vector<std::vector<double>> layers;  // rows by columns each
        for (std::size_t at = text.find("<tableData"); at != std::string::npos; at = text.find("<tableData", at + 1)) {
            const std::size_t open = text.find('>', at);
            if (const std::size_t quote = text.find("breakPoint=\"", at); quote < open) {
                points[2].push_back(std::stod(text.substr(quote + 12)));
            }
            layers.push_back(rows_of(text.substr(open + 1, text.find("</tableData>", at) - open - 1), axes > 1));
        }
        for (std::size_t i = 0; i < layers.front().size(); ++i) {
            for (const auto& layer : layers) {
                values.push_back(layer[i]);
            }
        }
    }

    [[nodiscard]] double at(const double* p) const {
        const std::size_t n = points.size();
        std::vector<std::size_t> cell(n, 0);
        std::vector<double> t(n);
        for (std::size_t k = 0; k < n; ++k) {
            const auto& x = points[k];
            while (cell[k] + 2 < x.size() && p[k] >= x[cell[k] + 1]) {
                ++cell[k];
            }
            t[k] = std::clamp((p[k] - x[cell[k]]) / (x[cell[k] + 1] - x[cell[k]]), 0.0, 1.0);
        }
        double sum = 0;
        for (std::size_t corner = 0; corner < std::size_t{1} << n; ++corner) {
            double weight = 1;
            std::size_t node = 0;
            for (std::size_t k = 0; k < n; ++k) {
                const std::size_t up = corner >> k & 1;
                weight *= up != 0 ? t[k] : 1 - t[k];
                node = node * points[k].size() + cell[k] + up;
            }
            sum += weight * values[node];
        }
        return sum;
    }

private:
    std::vector<double> rows_of(const std::string& text, bool columns) {
        std::vector<double> values_here;
        points[0].clear();
        std::istringstream lines(text);
        bool header = columns;
        for (std::string line; std::getline(lines, line);) {
            std::istringstream numbers(line);
            std::vector<double> row;
            for (double v; numbers >> v;) {
                row.push_back(v);
            }
            if (row.empty()) {
                continue;
            }
            if (header) {
                points[1] = row;
                header = false;
                continue;
            }
            points[0].push_back(row.front());
            values_here.insert(values_here.end(), row.begin() + 1, row.end());
        }
        return values_here;
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
                EXPECT_EQ(std::system(("python3 -c \"import xml.dom.minidom as m;d=m.parse('" + (folder.path() / "t.xml").string() +
                                       "');assert len(d.getElementsByTagName('function'))==" + std::to_string(2 + n) + "\"").c_str()),
                          0);
            }
            const Linear value(xml, "lift_force", n), sigma(xml, "lift_force_sigma", n);
            const auto points = test::random_points(table, 10000);
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

TEST(ExportsOfJsbsim, TakeTheFewestPointsThatStraightLinesNeed) {
    // For a parabola of curvature 2 lines between n even points miss 1/(4 n^2): 1 % of its range needs 7 points, of which two may be lost to the
    // choice among halved cells.
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
    const Linear sigma(core::read_file(folder.path() / "t.xml"), "lift_force_sigma", 2);
    core::Random random(17);
    double stated = 0, own = 0;
    for (int i = 0; i < 3000; ++i) {
        const double p[2] = {random.uniform(table.axes()[0].lower, table.axes()[0].upper), random.uniform(table.axes()[1].lower, table.axes()[1].upper)};
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
    EXPECT_THAT(core::read_file(folder.path() / "t.xml"), HasSubstr("Outside the range of an axis JSBSim holds the end value"));
}

}  // namespace
}  // namespace underbody
