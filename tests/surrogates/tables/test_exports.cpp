#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <dlfcn.h>
#include <matio.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "surrogates/tables/exports/export.h"
#include "surrogates/tables/force_table.h"
#include "tests/surrogates/tables/tables_support.h"

namespace underbody {
namespace {

using tables::ExportOptions;
using tables::FitOptions;
using tables::ForceTable;
using ::testing::HasSubstr;

core::Table with_sigma(core::Table table, double sigma) {
    table.add_numbers("lift_force_sigma", "N", std::vector<double>(table.rows(), sigma));
    return table;
}

FitOptions interpolation(tables::RangePolicy range = tables::RangePolicy::clamp) {
    FitOptions options;
    options.kind = FitOptions::Kind::interpolation;
    options.range = range;
    return options;
}

ForceTable one_axis(tables::RangePolicy range = tables::RangePolicy::clamp) {
    return ForceTable::fit(with_sigma(test::ref_a(), 2e-4), "lift_force", interpolation(range));
}

ForceTable two_axes(tables::RangePolicy range = tables::RangePolicy::clamp) {
    std::vector<double> gap, pitch;
    for (int i = 0; i < 24; ++i) {
        gap.push_back(0.001 * std::pow(100.0, i / 23.0));
    }
    for (int i = -6; i <= 6; ++i) {
        pitch.push_back(i * 0.012);
    }
    return ForceTable::fit(with_sigma(test::grid_table(gap, pitch, [](double h, double p) { return 3e-4 / h + 4 * p / (1 + 40 * h) + 0.3 * std::sin(9 * h); }), 0.01),
                           "lift_force", interpolation(range));
}

ForceTable three_axes() {
    std::vector<double> g, p, u, f;
    for (const double a : {0.001, 0.003, 0.01, 0.05}) {
        for (const double b : {-0.05, 0.0, 0.05}) {
            for (const double c : {0.3, 0.5, 0.9}) {
                g.push_back(a);
                p.push_back(b);
                u.push_back(c);
                f.push_back(c * c * (1e-3 / a + 3 * b) + std::cos(100 * a));
            }
        }
    }
    core::Table table;
    table.source = "three";
    table.add_numbers("gap", "m", g);
    table.add_numbers("pitch", "rad", p);
    table.add_numbers("speed", "m/s", u);
    table.add_numbers("lift_force", "N", f);
    return ForceTable::fit(table, "lift_force", interpolation());
}

/// Random points, a third of them outside.
std::vector<double> random_points(const ForceTable& table, std::size_t count, bool as_float = false) {
    core::Random random(1234);
    std::vector<double> points;
    for (std::size_t i = 0; i < count; ++i) {
        for (const auto& axis : table.axes()) {
            const double span = axis.upper - axis.lower;
            const bool inside = random.below(3) != 0;
            double x = inside ? random.uniform(axis.lower, axis.upper) : random.uniform(axis.lower - span, axis.upper + span);
            if (random.below(20) == 0) {
                x = axis.points[random.below(axis.points.size())];
            }
            points.push_back(as_float ? static_cast<double>(static_cast<float>(x)) : x);
        }
    }
    return points;
}

/// A C program around the header: points on stdin, value, slopes, sigma, outside, beyond on stdout, all double.
std::string driver(const std::string& name, std::size_t axes) {
    const std::string n = std::to_string(axes);
    return "#include <stdio.h>\n#include \"table.h\"\nint main(void) {\n    double in[" + n + "];\n    while (fread(in, sizeof(double), " + n + ", stdin) == " + n +
           ") {\n        " + name + "_real p[" + n + "];\n        " + name + "_result r;\n        double out[" + std::to_string(3 + 2 * axes) +
           "];\n        int k;\n        for (k = 0; k < " + n + "; ++k) {\n            p[k] = (" + name + "_real)in[k];\n        }\n        " + name +
           "_at(p, &r);\n        out[0] = (double)r.value;\n        out[1] = (double)r.sigma;\n        out[2] = r.outside;\n        for (k = 0; k < " + n +
           "; ++k) {\n            out[3 + k] = (double)r.slope[k];\n            out[3 + " + n +
           " + k] = (double)r.beyond[k];\n        }\n        fwrite(out, sizeof(double), " + std::to_string(3 + 2 * axes) +
           ", stdout);\n    }\n    return 0;\n}\n";
}

std::vector<double> run_header(const std::filesystem::path& folder, const std::string& compiler, const std::string& name, std::size_t axes,
                               const std::vector<double>& points, bool& ok) {
    core::write_file(folder / "main.c", driver(name, axes));
    core::write_file(folder / "points.bin", {reinterpret_cast<const char*>(points.data()), points.size() * sizeof(double)});
    const std::string at = "cd '" + folder.string() + "' && ";
    ok = std::system((at + compiler + " -std=c99 -O2 -Wall -Wextra -Wconversion -Werror -pedantic main.c -o main 2> errors.txt && ./main < points.bin > out.bin").c_str()) == 0;
    if (!ok) {
        ADD_FAILURE() << core::read_file(folder / "errors.txt");
        return {};
    }
    const std::string bytes = core::read_file(folder / "out.bin");
    std::vector<double> out(bytes.size() / sizeof(double));
    std::memcpy(out.data(), bytes.data(), out.size() * sizeof(double));
    return out;
}

bool have(const std::string& program) { return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0; }

void check_header(const ForceTable& table, bool single, const std::string& compiler) {
    core::TemporaryFolder folder;
    ExportOptions options;
    options.single_precision = single;
    export_table(table, "c", folder.path() / "table.h", options);
    const std::size_t n = table.axes().size();
    const auto points = random_points(table, 10000, single);
    bool ok = false;
    const auto out = run_header(folder.path(), compiler, "lift_force", n, points, ok);
    if (!ok) {
        return;
    }
    const std::size_t width = 3 + 2 * n;
    ASSERT_EQ(out.size(), 10000 * width);
    double size = 0;
    double steepest[4] = {};
    for (int i = 0; i < 10000; ++i) {
        const auto e = table.at({&points[i * n], n});
        size = std::max(size, std::abs(e.value));
        for (std::size_t k = 0; k < n; ++k) {
            steepest[k] = std::max(steepest[k], std::abs(e.slope[k]));
        }
    }
    const double tolerance = single ? 1e-6 : 1e-12;
    for (int i = 0; i < 10000; ++i) {
        const auto e = table.at({&points[i * n], n});
        const double* o = &out[i * width];
        ASSERT_NEAR(o[0], e.value, tolerance * size);
        ASSERT_NEAR(o[1], e.sigma, tolerance * (1 + e.sigma));
        bool at_an_end = false;  // an end rounded to float may fall on either side
        for (std::size_t k = 0; k < n; ++k) {
            at_an_end = at_an_end || (e.beyond[k] != 0 && std::abs(e.beyond[k]) < 1e-6);
        }
        if (single && at_an_end) {
            continue;
        }
        ASSERT_EQ(o[2] != 0, e.outside);
        for (std::size_t k = 0; k < n; ++k) {
            ASSERT_NEAR(o[3 + k], e.slope[k], (single ? 1e-4 : 1e-11) * steepest[k]);
            ASSERT_NEAR(o[3 + n + k], e.beyond[k], tolerance);
        }
    }
}

class CHeader : public ::testing::TestWithParam<const char*> {};

TEST_P(CHeader, EvaluatesLikeTheTableInsideAndOutside) {
    if (!have(GetParam())) {
        GTEST_SKIP() << "skipped: " << GetParam() << " is not installed";
    }
    for (const auto range : {tables::RangePolicy::clamp, tables::RangePolicy::extrapolate}) {
        check_header(one_axis(range), false, GetParam());
        check_header(two_axes(range), false, GetParam());
    }
    check_header(three_axes(), false, GetParam());
    check_header(three_axes(), true, GetParam());
    check_header(one_axis(), true, GetParam());
    check_header(two_axes(), true, GetParam());
}
INSTANTIATE_TEST_SUITE_P(Compilers, CHeader, ::testing::Values("gcc", "clang"));

/// Both formats come back as the table they were made from.
void check_read_back(const std::string& format) {
    core::TemporaryFolder folder;
    for (const ForceTable& table : {one_axis(), two_axes(), three_axes(), test::ref_a_spline(), two_axes(tables::RangePolicy::extrapolate)}) {
        const auto path = folder.path() / ("t." + format);
        export_table(table, format, path, {});
        const ForceTable again = ForceTable::read(path, "lift_force");
        EXPECT_EQ(again.kind(), "exported grid");
        const std::size_t n = table.axes().size();
        ASSERT_EQ(again.axes().size(), n);
        const auto points = random_points(table, 10000);
        for (int i = 0; i < 10000; ++i) {
            const auto a = table.at({&points[i * n], n});
            const auto b = again.at({&points[i * n], n});
            ASSERT_NEAR(a.value, b.value, 1e-12 * (1 + std::abs(a.value)));
            ASSERT_NEAR(a.sigma, b.sigma, 1e-12 * (1 + a.sigma));
            ASSERT_EQ(a.outside, b.outside);
            for (std::size_t k = 0; k < n; ++k) {
                ASSERT_NEAR(a.slope[k], b.slope[k], 1e-10 * (1 + std::abs(a.slope[k])));
            }
        }
    }
}

TEST(Exports, OfCsvReadBackAsTheSameTable) { check_read_back("csv"); }
TEST(Exports, OfJsonReadBackAsTheSameTable) { check_read_back("json"); }

TEST(Exports, OfJsonThatAreNoTablesSayWhatIsWrong) {
    core::TemporaryFolder folder;
    const auto message = [&](const std::string& text) {
        core::write_file(folder.path() / "t.json", text);
        try {
            ForceTable::read(folder.path() / "t.json", "lift_force");
        } catch (const core::InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_THAT(message("{\"a\": }"), HasSubstr("not JSON"));
    EXPECT_THAT(message("{\"a\": 1}"), HasSubstr("not a force table"));
    EXPECT_THAT(message("{\"format\": \"Underbody force table\"}"), HasSubstr("not complete"));
    export_table(one_axis(), "json", folder.path() / "ours.json");
    auto json = nlohmann::json::parse(core::read_file(folder.path() / "ours.json"));
    json["hermite"].erase(json["hermite"].begin());
    EXPECT_THAT(message(json.dump()), HasSubstr("grid points together"));
}

/// What the JSON itself says about evaluating it, done by its words.
struct JsonTable {
    nlohmann::json j;
    [[nodiscard]] std::pair<double, double> at(const double* p) const {
        const std::size_t n = j["axes"].size();
        std::vector<std::size_t> cell(n), size(n);
        std::vector<double> t(n), h(n), x(n);
        double sigma = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const auto points = j["axes"][k]["points"].get<std::vector<double>>();
            size[k] = points.size();
            x[k] = std::clamp(p[k], points.front(), points.back());
            cell[k] = 0;
            while (cell[k] + 2 < points.size() && x[k] >= points[cell[k] + 1]) {
                ++cell[k];
            }
            h[k] = points[cell[k] + 1] - points[cell[k]];
            t[k] = (x[k] - points[cell[k]]) / h[k];
            if (!j["cell_error"][k].empty()) {
                sigma += j["cell_error"][k][cell[k]].get<double>() * 4 * t[k] * (1 - t[k]);
            }
            sigma += j["growth"][k][p[k] < x[k] ? 0 : 1].get<double>() * std::abs(p[k] - x[k]);
        }
        double value = 0;
        for (std::size_t corner = 0; corner < std::size_t{1} << n; ++corner) {
            std::size_t node = 0;
            double weight = 1;
            for (std::size_t k = 0; k < n; ++k) {
                const bool up = (corner >> k & 1) != 0;
                node = node * size[k] + cell[k] + (up ? 1 : 0);
                weight *= up ? t[k] : 1 - t[k];
            }
            sigma += weight * j["sigma"][node].get<double>();
            for (std::size_t m = 0; m < std::size_t{1} << n; ++m) {
                double product = j["hermite"][node][m].get<double>();
                for (std::size_t k = 0; k < n; ++k) {
                    const double r = 1 - t[k];
                    const bool up = (corner >> k & 1) != 0;
                    const bool slope = (m >> k & 1) != 0;
                    product *= slope ? (up ? -h[k] * t[k] * t[k] * r : h[k] * t[k] * r * r) : (up ? t[k] * t[k] * (3 - 2 * t[k]) : r * r * (1 + 2 * t[k]));
                }
                value += product;
            }
        }
        return {value, sigma};
    }
};

TEST(Exports, OfJsonEvaluateByTheirOwnWords) {
    core::TemporaryFolder folder;
    for (const ForceTable& table : {one_axis(), two_axes()}) {
        export_table(table, "json", folder.path() / "t.json", {});
        const JsonTable json{nlohmann::json::parse(core::read_file(folder.path() / "t.json"))};
        const std::size_t n = table.axes().size();
        const auto points = random_points(table, 10000);
        for (int i = 0; i < 10000; ++i) {
            const auto e = table.at({&points[i * n], n});
            const auto [value, sigma] = json.at(&points[i * n]);
            ASSERT_NEAR(value, e.value, 1e-12 * (1 + std::abs(e.value)));
            ASSERT_NEAR(sigma, e.sigma, 1e-12 * (1 + e.sigma));
        }
    }
}

TEST(Exports, ThinTheGridAndKeepTheErrorAskedFor) {
    std::vector<double> gap, pitch;
    for (int i = 0; i < 60; ++i) {
        gap.push_back(0.001 * std::pow(100.0, i / 59.0));
        pitch.push_back(-0.1 + 0.2 * i / 59);
    }
    const auto table = ForceTable::fit(test::grid_table(gap, pitch, [](double h, double p) { return 3e-4 / h + 4 * p / (1 + 40 * h) + 0.3 * std::sin(9 * h); }),
                                       "lift_force", interpolation());
    core::TemporaryFolder folder;
    ExportOptions options;
    options.max_error = 0.005;
    const auto result = export_table(table, "csv", folder.path() / "thin.csv", options);
    ASSERT_EQ(result.grid.size(), 2u);
    EXPECT_LT(result.grid[0] * result.grid[1], 200u);
    const auto thin = ForceTable::read(folder.path() / "thin.csv", "lift_force");
    double low = 1e9, high = -1e9, worst = 0;
    core::Random random(5);
    for (int i = 0; i < 20000; ++i) {
        const double p[2] = {random.uniform(0.001, 0.1), random.uniform(-0.1, 0.1)};
        const double v = table.value(p);
        low = std::min(low, v);
        high = std::max(high, v);
        worst = std::max(worst, std::abs(v - thin.value(p)));
    }
    EXPECT_LE(worst, 0.0051 * (high - low));
    EXPECT_GT(result.error, 0);
    EXPECT_THAT(core::read_file(folder.path() / "thin.csv"), HasSubstr("Differs from the full table by at most"));
}

TEST(Exports, AreThinnedByTheRangeOfThePointsNotOfTheCornersWithoutAny) {
    // A steep force along a diagonal band: the corners of the grid are extrapolated far beyond what was measured.
    std::vector<double> g, p, f;
    for (int i = 0; i < 12; ++i) {
        for (const int j : {-1, 0, 1}) {
            g.push_back(0.002 + 0.001 * i);
            p.push_back(0.01 * (i + j) - 0.05);
            f.push_back(std::exp(-200 * g.back()) + 4 * p.back() + 30 * p.back() * p.back());
        }
    }
    core::Table data;
    data.add_numbers("gap", "m", g);
    data.add_numbers("pitch", "rad", p);
    data.add_numbers("lift_force", "N", f);
    core::TemporaryFolder folder;
    ExportOptions options;
    options.max_error = 0.01;
    const auto result = export_table(ForceTable::fit(data, "lift_force"), "csv", folder.path() / "thin.csv", options);
    const auto [low, high] = std::minmax_element(f.begin(), f.end());
    EXPECT_GT(result.error, 0);
    EXPECT_LE(result.error, 0.01 * (*high - *low));
}

TEST(Exports, InTheDownFrameTurnTheirSigns) {
    core::TemporaryFolder folder;
    std::vector<double> w, f;
    for (const double v : {-0.2, -0.1, 0.05, 0.3}) {
        w.push_back(v);
        f.push_back(1 - 2 * v + v * v);
    }
    core::Table data;
    data.add_numbers("heave_velocity", "m/s", w);
    data.add_numbers("lift_force", "N", f);
    const auto table = ForceTable::fit(data, "lift_force", interpolation());
    ExportOptions options;
    options.frame = tables::Frame::ned;
    export_table(table, "csv", folder.path() / "ned.csv", options);
    const auto ned = ForceTable::read(folder.path() / "ned.csv", "z_force");
    for (double v = -0.25; v < 0.35; v += 0.01) {
        const double down = -v;
        EXPECT_NEAR(ned.value(&down), -table.value(&v), 1e-14);
        EXPECT_NEAR(ned.at({&down, 1}).slope[0], table.at({&v, 1}).slope[0], 1e-12);
    }
}

TEST(Exports, OfMatReadBackByMatioAndByOctave) {
    core::TemporaryFolder folder;
    const auto table = two_axes();
    const auto result = export_table(table, "mat", folder.path() / "lift.mat");
    ASSERT_EQ(result.files.size(), 2u);
    mat_t* file = Mat_Open((folder.path() / "lift.mat").c_str(), MAT_ACC_RDONLY);
    ASSERT_NE(file, nullptr);
    std::map<std::string, std::vector<double>> read;
    for (const char* name : {"x0", "x1", "hermite", "sigma", "growth", "cell_error0", "cell_error1"}) {
        matvar_t* v = Mat_VarRead(file, name);
        ASSERT_NE(v, nullptr) << name;
        const auto* data = static_cast<const double*>(v->data);
        read[name].assign(data, data + v->nbytes / sizeof(double));
        Mat_VarFree(v);
    }
    Mat_Close(file);
    // Through the JSON evaluator, which knows the same words.
    nlohmann::json j;
    for (int k = 0; k < 2; ++k) {
        j["axes"].push_back({{"points", read["x" + std::to_string(k)]}});
        j["cell_error"].push_back(read["cell_error" + std::to_string(k)]);
        j["growth"].push_back({read["growth"][k], read["growth"][2 + k]});
    }
    j["sigma"] = read["sigma"];
    for (std::size_t i = 0; i < read["hermite"].size(); i += 4) {
        j["hermite"].push_back(std::vector<double>(&read["hermite"][i], &read["hermite"][i] + 4));
    }
    const JsonTable by_matio{j};
    const auto points = random_points(table, 10000);
    for (int i = 0; i < 10000; ++i) {
        const auto e = table.at({&points[i * 2], 2});
        const auto [value, sigma] = by_matio.at(&points[i * 2]);
        ASSERT_NEAR(value, e.value, 1e-12 * (1 + std::abs(e.value)));
        ASSERT_NEAR(sigma, e.sigma, 1e-12 * (1 + e.sigma));
    }
    if (!have("octave-cli") && !have("octave")) {
        GTEST_SKIP() << "skipped: Octave is not installed; the .m file was not run";
    }
    core::write_file(folder.path() / "points.bin", {reinterpret_cast<const char*>(points.data()), points.size() * sizeof(double)});
    const std::string script = "f=fopen('points.bin');p=reshape(fread(f,'double'),2,[])';fclose(f);[v,s,g,o]=lift_at(p);f=fopen('out.bin','w');fwrite(f,[v s g o]','double');fclose(f);";
    ASSERT_EQ(std::system(("cd '" + folder.path().string() + "' && $(command -v octave-cli || command -v octave) --eval \"" + script + "\" > /dev/null 2>&1").c_str()), 0);
    const std::string bytes = core::read_file(folder.path() / "out.bin");
    ASSERT_EQ(bytes.size(), 10000 * 5 * sizeof(double));
    std::vector<double> out(50000);
    std::memcpy(out.data(), bytes.data(), bytes.size());
    for (int i = 0; i < 10000; ++i) {
        const auto e = table.at({&points[i * 2], 2});
        ASSERT_NEAR(out[5 * i], e.value, 1e-12 * (1 + std::abs(e.value)));
        ASSERT_NEAR(out[5 * i + 1], e.slope[0], 1e-9 * (1 + std::abs(e.slope[0])));
        ASSERT_NEAR(out[5 * i + 2], e.slope[1], 1e-9 * (1 + std::abs(e.slope[1])));
        ASSERT_NEAR(out[5 * i + 3], e.sigma, 1e-12 * (1 + e.sigma));
        ASSERT_EQ(out[5 * i + 4] != 0, e.outside);
    }
}

/// Linear interpolation in the tables of the XML as JSBSim does it, for one or two axes.
TEST(Exports, OfJsbsimInterpolateLinearlyWithinWhatTheySay) {
    core::TemporaryFolder folder;
    for (const auto& table : {one_axis(), two_axes()}) {
        const auto result = export_table(table, "jsbsim", folder.path() / "t.xml");
        const std::string xml = core::read_file(folder.path() / "t.xml");
        if (have("python3")) {
            EXPECT_EQ(std::system(("python3 -c \"import xml.dom.minidom as m;d=m.parse('" + (folder.path() / "t.xml").string() + "');assert len(d.getElementsByTagName('function'))==" +
                                   std::to_string(2 + table.axes().size()) + "\"")
                                      .c_str()),
                      0);
        }
        const std::size_t at = xml.find("<function name=\"underbody/lift_force\">");
        ASSERT_NE(at, std::string::npos);
        const std::size_t begin = xml.find("<tableData>", at) + 11;
        std::istringstream lines(xml.substr(begin, xml.find("</tableData>", begin) - begin));
        const std::size_t n = table.axes().size();
        std::vector<double> x, y;
        std::vector<std::vector<double>> f;
        std::string line;
        std::getline(lines, line);
        while (std::getline(lines, line)) {
            std::istringstream numbers(line);
            std::vector<double> row;
            for (double v; numbers >> v;) {
                row.push_back(v);
            }
            if (row.empty()) {
                continue;
            }
            if (n == 2 && y.empty()) {
                y = row;
                continue;
            }
            x.push_back(row.front());
            f.emplace_back(row.begin() + 1, row.end());
        }
        const auto cell = [](const std::vector<double>& points, double v, double& t) {
            std::size_t i = 0;
            while (i + 2 < points.size() && v >= points[i + 1]) {
                ++i;
            }
            t = std::clamp((v - points[i]) / (points[i + 1] - points[i]), 0.0, 1.0);
            return i;
        };
        const auto points = random_points(table, 10000);
        for (int i = 0; i < 10000; ++i) {
            const double* p = &points[i * n];
            double t = 0, u = 0;
            const std::size_t a = cell(x, p[0], t);
            double value = 0;
            if (n == 1) {
                value = (1 - t) * f[a][0] + t * f[a + 1][0];
            } else {
                const std::size_t b = cell(y, p[1], u);
                value = (1 - t) * ((1 - u) * f[a][b] + u * f[a][b + 1]) + t * ((1 - u) * f[a + 1][b] + u * f[a + 1][b + 1]);
            }
            ASSERT_NEAR(value, table.value(p), 1.6 * result.error);
        }
        EXPECT_LT(result.error, 0.01);
    }
}

/// Entries of a zip of stored files.
std::map<std::string, std::string> unzipped(const std::string& zip) {
    std::map<std::string, std::string> entries;
    const auto number = [&](std::size_t at, int bytes) {
        std::size_t v = 0;
        for (int i = bytes; i-- > 0;) {
            v = v << 8 | static_cast<unsigned char>(zip[at + i]);
        }
        return v;
    };
    for (std::size_t at = 0; number(at, 4) == 0x04034b50;) {
        const std::size_t size = number(at + 18, 4), name = number(at + 26, 2);
        entries[zip.substr(at + 30, name)] = zip.substr(at + 30 + name, size);
        at += 30 + name + size;
    }
    return entries;
}

TEST(Exports, OfFmuAreLoadedAndEvaluateLikeTheTable) {
    core::TemporaryFolder folder;
    for (const auto& table : {one_axis(), two_axes()}) {
        const auto path = folder.path() / "lift.fmu";
        const auto result = export_table(table, "fmu", path);
        const std::string first = core::read_file(path);
        export_table(table, "fmu", path);
        EXPECT_TRUE(first == core::read_file(path)) << "the same table must give the same bytes";
        if (have("python3")) {
            EXPECT_EQ(std::system(("python3 -c \"import zipfile,xml.dom.minidom as m;z=zipfile.ZipFile('" + path.string() +
                                   "');assert z.testzip() is None;m.parseString(z.read('modelDescription.xml'))\"").c_str()),
                      0);
        }
        const auto entries = unzipped(first);
        ASSERT_TRUE(entries.contains("modelDescription.xml"));
        ASSERT_TRUE(entries.contains("sources/fmu.c"));
        if (!entries.contains("binaries/linux64/lift_force.so")) {
            GTEST_SKIP() << "skipped: no C compiler, so the FMU has no binary";
        }
        const std::string& xml = entries.at("modelDescription.xml");
        const std::size_t g = xml.find("guid=\"") + 6;
        const std::string guid = xml.substr(g, xml.find('"', g) - g);
        core::write_file(folder.path() / "lift.so", entries.at("binaries/linux64/lift_force.so"));
        void* library = ::dlopen((folder.path() / "lift.so").c_str(), RTLD_NOW | RTLD_LOCAL);
        ASSERT_NE(library, nullptr) << ::dlerror();
        using Instantiate = void* (*)(const char*, int, const char*, const char*, const void*, int, int);
        using Real = int (*)(void*, const unsigned*, std::size_t, double*);
        using Step = int (*)(void*, double, double, int);
        using Plain = int (*)(void*);
        using Free = void (*)(void*);
        const auto instantiate = reinterpret_cast<Instantiate>(::dlsym(library, "fmi2Instantiate"));
        const auto get = reinterpret_cast<Real>(::dlsym(library, "fmi2GetReal"));
        const auto set = reinterpret_cast<Real>(::dlsym(library, "fmi2SetReal"));
        const auto step = reinterpret_cast<Step>(::dlsym(library, "fmi2DoStep"));
        const auto enter = reinterpret_cast<Plain>(::dlsym(library, "fmi2EnterInitializationMode"));
        const auto leave = reinterpret_cast<Plain>(::dlsym(library, "fmi2ExitInitializationMode"));
        const auto free_instance = reinterpret_cast<Free>(::dlsym(library, "fmi2FreeInstance"));
        ASSERT_NE(instantiate, nullptr);
        EXPECT_EQ(instantiate("x", 1, "wrong", "", nullptr, 0, 0), nullptr);
        const std::size_t n = table.axes().size();
        for (const int type : {0, 1}) {  // model exchange, co-simulation
            void* instance = instantiate("x", type, guid.c_str(), "", nullptr, 0, 0);
            ASSERT_NE(instance, nullptr);
            ASSERT_EQ(enter(instance), 0);
            ASSERT_EQ(leave(instance), 0);
            if (type == 0) {
                // The life of a model-exchange instance without states: events once, then continuous time.
                struct {
                    int flags[5];
                    double next;
                } event = {{1, 1, 1, 1, 1}, 0};
                ASSERT_EQ(reinterpret_cast<int (*)(void*, void*)>(::dlsym(library, "fmi2NewDiscreteStates"))(instance, &event), 0);
                EXPECT_EQ(event.flags[0], 0) << "no further events";
                ASSERT_EQ(reinterpret_cast<Plain>(::dlsym(library, "fmi2EnterContinuousTimeMode"))(instance), 0);
                ASSERT_EQ(reinterpret_cast<int (*)(void*, double)>(::dlsym(library, "fmi2SetTime"))(instance, 1.5), 0);
                double none = 0;
                ASSERT_EQ(reinterpret_cast<int (*)(void*, double*, std::size_t)>(::dlsym(library, "fmi2GetDerivatives"))(instance, &none, 0), 0);
                int asks_event = 1, asks_end = 1;
                ASSERT_EQ(reinterpret_cast<int (*)(void*, int, int*, int*)>(::dlsym(library, "fmi2CompletedIntegratorStep"))(instance, 1, &asks_event, &asks_end), 0);
                EXPECT_EQ(asks_event + asks_end, 0);
            }
            auto points = random_points(table, 10000);
            const unsigned inputs[4] = {0, 1, 2, 3};
            for (int i = 0; i < 10000; ++i) {
                ASSERT_EQ(set(instance, inputs, n, &points[i * n]), 0);
                if (type == 1) {
                    ASSERT_EQ(step(instance, 0.1 * i, 0.1, 1), 0);
                }
                std::vector<unsigned> outputs;
                for (unsigned k = 0; k < n + 3; ++k) {
                    outputs.push_back(static_cast<unsigned>(n) + k);
                }
                std::vector<double> out(n + 3);
                ASSERT_EQ(get(instance, outputs.data(), outputs.size(), out.data()), 0);
                const auto e = table.at({&points[i * n], n});
                ASSERT_NEAR(out[0], e.value, 1e-12 * (1 + std::abs(e.value)));
                ASSERT_NEAR(out[1 + n], e.sigma, 1e-12 * (1 + e.sigma));
                ASSERT_EQ(out[2 + n] != 0, e.outside);
                for (std::size_t k = 0; k < n; ++k) {
                    ASSERT_NEAR(out[1 + k], e.slope[k], 1e-9 * (1 + std::abs(e.slope[k])));
                }
                if (i % 100 == 0) {
                    using Directional = int (*)(void*, const unsigned*, std::size_t, const unsigned*, std::size_t, const double*, double*);
                    const double along[4] = {0.5, -2, 1, 1};
                    double change = 0, expected = 0;
                    for (std::size_t k = 0; k < n; ++k) {
                        expected += along[k] * e.slope[k];
                    }
                    ASSERT_EQ(reinterpret_cast<Directional>(::dlsym(library, "fmi2GetDirectionalDerivative"))(instance, outputs.data(), 1, inputs, n, along, &change), 0);
                    ASSERT_NEAR(change, expected, 1e-9 * (1 + std::abs(expected)));
                }
            }
            free_instance(instance);
        }
        ::dlclose(library);
    }
}

TEST(Exports, DoNotTouchAFileThatIsNotOurs) {
    core::TemporaryFolder folder;
    const auto path = folder.path() / "mine.h";
    core::write_file(path, "int precious;\n");
    EXPECT_THROW(export_table(one_axis(), "c", path), core::InputError);
    EXPECT_EQ(core::read_file(path), "int precious;\n");
    ExportOptions options;
    options.overwrite = true;
    export_table(one_axis(), "c", path, options);
    export_table(one_axis(), "c", path);  // ours now
    EXPECT_THAT(core::read_file(path), HasSubstr("Underbody"));
    EXPECT_THROW(export_table(one_axis(), "c", folder.path()), core::InputError);
    EXPECT_THROW(export_table(one_axis(), "cc", path), core::UsageError);
}

}  // namespace
}  // namespace underbody
