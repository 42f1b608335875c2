// Tables for blocks that draw straight lines: Simulink's n-D Lookup Table (its .mat read by Octave) and Modelica's
// CombiTable (its text read by what the Modelica Standard Library says about it).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "tests/surrogates/tables/exports_support.h"

namespace underbody {
namespace {

using tables::ForceTable;
using ::testing::HasSubstr;

/// In the range, one in three coordinates outside; what the block says there is compared with the table held at its
/// ends.
void expect_within(const ForceTable& table, const double* point, double error, double value, double sigma,
                   double no_data) {
    const std::size_t n = table.axes().size();
    std::vector<double> held(point, point + n);
    for (std::size_t k = 0; k < n; ++k) {
        held[k] = std::clamp(held[k], table.axes()[k].lower, table.axes()[k].upper);
    }
    const double difference = std::abs(value - table.value(point));
    ASSERT_LE(difference, error * (1 + 1e-9));
    ASSERT_GE(sigma, (1 - 1e-9) * (table.sigma(held.data()) + difference));
    ASSERT_NEAR(no_data, test::expected(table, point).at.no_data ? 1 : 0, 1e-12);
}

double range_of(const ForceTable& table) {
    const auto& f = table.points().numbers("lift_force");
    const auto [low, high] = std::minmax_element(f.begin(), f.end());
    return *high - *low;
}

TEST(ExportsOfSimulink, LookedUpByOctaveAreWithinWhatTheySay) {
    if (!test::have("octave-cli") && !test::have("octave")) {
        GTEST_SKIP() << "skipped: Octave is not installed; the .mat was not read";
    }
    core::TemporaryFolder folder;
    const std::vector<ForceTable> all{test::one_axis(), test::two_axes(), test::three_axes(), test::band()};
    std::vector<double> errors;
    std::string script;
    for (std::size_t t = 0; t < all.size(); ++t) {
        const std::string id = std::to_string(t);
        tables::ExportOptions options;
        options.max_error = t == 2 ? 0.02 : 0.005;
        errors.push_back(export_table(all[t], "simulink", folder.path() / ("t" + id + ".mat"), options).error);
        EXPECT_LE(errors[t], options.max_error * range_of(all[t]) * (1 + 1e-12));
        test::write_doubles(folder.path() / ("points" + id), test::random_points(all[t], 2000));
        std::string own, flag, at;
        for (std::size_t k = 0; k < all[t].axes().size(); ++k) {
            const std::string name = all[t].axes()[k].name, column = "p(:," + std::to_string(k + 1) + ")";
            own += "m.bp_" + name + ",";
            flag += "m.no_data_bp_" + name + ",";
            at += ",min(max(" + column + ",LINES" + name + "(1)),LINES" + name + "(end))";
        }
        const auto lookup = [&](const std::string& lines, const std::string& data, const char* prefix) {
            std::string place = at;
            for (std::size_t found; (found = place.find("LINES")) != std::string::npos;) {
                place.replace(found, 5, prefix);
            }
            return (all[t].axes().size() == 1 ? "interp1(" : "interpn(") + lines + "m." + data + place + ")";
        };
        script += "m=load('t" + id + ".mat');f=fopen('points" + id + "');p=reshape(fread(f,'double')," +
                  std::to_string(all[t].axes().size()) + ",[])';fclose(f);v=" + lookup(own, "lift_force", "m.bp_") +
                  ";s=" + lookup(own, "lift_force_sigma", "m.bp_") + ";e=" + lookup(flag, "no_data", "m.no_data_bp_") +
                  ";f=fopen('out" + id + "','w');fwrite(f,[v(:) s(:) e(:)]','double');fclose(f);";
    }
    core::write_file(folder.path() / "run.m", script);
    ASSERT_EQ(std::system(("cd '" + folder.path().string() +
                           "' && $(command -v octave-cli || command -v octave) run.m > errors.txt 2>&1")
                              .c_str()),
              0)
        << core::read_file(folder.path() / "errors.txt");
    for (std::size_t t = 0; t < all.size(); ++t) {
        const std::size_t n = all[t].axes().size();
        const auto points = test::random_points(all[t], 2000);
        const auto out = test::read_doubles(folder.path() / ("out" + std::to_string(t)));
        ASSERT_EQ(out.size(), 6000U);
        for (std::size_t i = 0; i < 2000; ++i) {
            ASSERT_NO_FATAL_FAILURE(
                expect_within(all[t], &points[n * i], errors[t], out[3 * i], out[3 * i + 1], out[3 * i + 2]))
                << "table " << t << " point " << i;
        }
    }
}

/// "double name(rows,columns)" and its numbers, after "#1"; lines with # are comments.
class CombiTables {
public:
    explicit CombiTables(const std::string& text) {
        std::istringstream lines(text);
        std::string line;
        std::getline(lines, line);
        EXPECT_EQ(line, "#1");
        for (std::vector<std::vector<double>>* table = nullptr; std::getline(lines, line);) {
            char name[64];
            std::size_t rows = 0, columns = 0;
            if (line.empty() || line[0] == '#') {
                continue;
            }
            if (std::sscanf(line.c_str(), "double %63[^(](%zu,%zu)", name, &rows, &columns) == 3) {
                table = &tables_[name];
                sizes_[name] = {rows, columns};
                continue;
            }
            std::istringstream numbers(line);
            table->emplace_back();
            for (double v = 0; numbers >> v;) {
                table->back().push_back(v);
            }
        }
        for (const auto& [name, size] : sizes_) {
            EXPECT_EQ(tables_[name].size(), size.first) << name;
            for (const auto& row : tables_[name]) {
                EXPECT_EQ(row.size(), size.second) << name;
            }
        }
    }

    /// LinearSegments, HoldLastPoint.
    [[nodiscard]] double at(const std::string& name, const double* u, std::size_t n) const {
        const auto& m = tables_.at(name);
        std::vector<double> x, y;
        for (std::size_t i = n == 1 ? 0 : 1; i < m.size(); ++i) {
            x.push_back(m[i][0]);
            y.push_back(n == 1 ? m[i][1]
                               : between({m[0].begin() + 1, m[0].end()}, {m[i].begin() + 1, m[i].end()}, u[1]));
        }
        return between(x, y, u[0]);
    }

private:
    static double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
        if (!(at > x.front())) {
            return y.front();
        }
        if (at >= x.back()) {
            return y.back();
        }
        const auto i = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
        return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
    }
    std::map<std::string, std::vector<std::vector<double>>> tables_;
    std::map<std::string, std::pair<std::size_t, std::size_t>> sizes_;
};

TEST(ExportsOfModelica, LookedUpAsACombiTableAreWithinWhatTheySay) {
    core::TemporaryFolder folder;
    for (const ForceTable& table : {test::one_axis(), test::two_axes(), test::band()}) {
        const std::size_t n = table.axes().size();
        const auto path = folder.path() / "lift.combi";
        const auto result = export_table(table, "modelica", path);
        const std::string text = core::read_file(path);
        EXPECT_THAT(text, HasSubstr(n == 1 ? "CombiTable1Ds" : "CombiTable2Ds"));
        const CombiTables combi(text);
        const auto points = test::random_points(table, 2000);
        for (std::size_t i = 0; i < points.size(); i += n) {
            const double* p = &points[i];
            ASSERT_NO_FATAL_FAILURE(expect_within(table, p, result.error, combi.at("lift_force", p, n),
                                                  combi.at("lift_force_sigma", p, n), combi.at("no_data", p, n)));
        }
        EXPECT_NO_THROW(export_table(table, "modelica", path)) << "its own file is replaced";
    }
    EXPECT_THROW(export_table(test::three_axes(), "modelica", folder.path() / "x.combi"), core::UsageError);
    EXPECT_THROW(ForceTable::read(folder.path() / "lift.combi", "lift_force"), core::InputError);
}

}  // namespace
}  // namespace underbody
