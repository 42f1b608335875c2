// The self-test beside a C header: points, what this program says there, and a comparison that needs no library.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

namespace {

constexpr std::size_t points_tried = 200;

struct Point {
    std::array<double, max_axes> at{};
    bool outside = false, refused = false, no_data = false;
};

/// In the range, and a quarter of the coordinates around it; numbers that a float holds, and none where rounding would
/// decide on which side of an end or of a line they lie.
std::vector<Point> test_points(const ExportGrid& grid) {
    core::Random random(4711);
    std::vector<Point> points;
    const auto apart = [&](std::size_t k, double x) {
        const ExportAxis& axis = grid.axes[k];
        const double rounding = 1e-5 * (axis.points.back() - axis.points.front());
        const auto near = [&](double line) { return std::abs(line - x) < rounding; };
        return !near(axis.lower) && !near(axis.upper) && std::none_of(axis.points.begin(), axis.points.end(), near) &&
               (grid.support.empty() ||
                std::none_of(grid.support.lines()[k].begin(), grid.support.lines()[k].end(), near));
    };
    while (points.size() < points_tried) {
        Point point;
        for (std::size_t k = 0; k < grid.axes.size(); ++k) {
            const ExportAxis& axis = grid.axes[k];
            const double span = axis.upper - axis.lower;
            double x = 0;
            do {
                x = random.below(4) == 0 ? random.uniform(axis.lower - span / 4, axis.upper + span / 4)
                                         : random.uniform(axis.lower, axis.upper);
                x = static_cast<double>(static_cast<float>(x));
            } while (!apart(k, x));
            point.at[k] = x;
            const bool beyond = x < axis.lower || x > axis.upper;
            point.outside = point.outside || beyond;
            point.refused = point.refused || (beyond && axis.range == RangePolicy::refuse);
        }
        point.no_data = point.outside || grid.support.no_data(point.at.data());
        points.push_back(point);
    }
    return points;
}

/// Value, slopes and error of one quantity.
std::vector<double> said(const ExportGrid& grid, const ExportQuantity& q, const Point& point) {
    const std::size_t n = grid.axes.size();
    unsigned going_on = 0;
    std::array<double, max_axes> beyond{};
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = grid.axes[k].points;
        beyond[k] = point.at[k] < x.front()  ? point.at[k] - x.front()
                    : point.at[k] > x.back() ? point.at[k] - x.back()
                                             : 0;
        going_on |= beyond[k] != 0 && grid.axes[k].range == RangePolicy::extrapolate ? 1U << k : 0;
    }
    std::vector<double> numbers(n + 2);
    numbers[0] = going_on == 0 ? q.surface.value(point.at.data(), &numbers[1])
                               : q.surface.continued(point.at.data(), &numbers[1], going_on);
    numbers[n + 1] = q.error.sigma(point.at.data(), beyond.data());
    return numbers;
}

std::string array(const std::string& name, const std::vector<double>& numbers) {
    std::string text = "static const double " + name + "[] = {";
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        text += (i % 6 == 0 ? "\n    " : " ") + core::format_number(numbers[i]) + (i + 1 < numbers.size() ? "," : "");
    }
    return text + "\n};\n";
}

}  // namespace

std::filesystem::path c_self_test(const std::filesystem::path& path) {
    return path.parent_path() / (path.stem().string() + "_test.c");
}

void write_c_self_test(const ExportGrid& grid, const std::filesystem::path& header) {
    const std::size_t n = grid.axes.size(), quantities = grid.quantities.size();
    const auto points = test_points(grid);
    std::vector<double> at, flags, wanted, allowed(quantities * (n + 2), 0.0);
    for (const Point& point : points) {
        at.insert(at.end(), point.at.begin(), point.at.begin() + static_cast<std::ptrdiff_t>(n));
        flags.insert(flags.end(), {point.outside ? 1.0 : 0.0, point.refused ? 1.0 : 0.0, point.no_data ? 1.0 : 0.0});
        for (std::size_t q = 0; q < quantities; ++q) {
            const auto numbers = said(grid, grid.quantities[q], point);
            for (std::size_t i = 0; i < numbers.size(); ++i) {
                allowed[q * (n + 2) + i] = std::max(allowed[q * (n + 2) + i], std::abs(numbers[i]));
            }
            wanted.insert(wanted.end(), numbers.begin(), numbers.end());
        }
    }
    // A slope is a difference of values over the width of a cell.
    for (std::size_t q = 0; q < quantities; ++q) {
        for (std::size_t k = 0; k < n; ++k) {
            const auto& x = grid.axes[k].points;
            double narrow = x.back() - x.front();
            for (std::size_t i = 0; i + 1 < x.size(); ++i) {
                const bool kink = x[i + 1] - x[i] < 1e-6 * (x.back() - x.front());
                narrow = kink ? narrow : std::min(narrow, x[i + 1] - x[i]);
            }
            double& slope = allowed[q * (n + 2) + 1 + k];
            slope = slope * (1 + std::max(std::abs(x.front()), std::abs(x.back())) / narrow) +
                    allowed[q * (n + 2)] / narrow;
        }
    }
    for (double& a : allowed) {
        a = a * (grid.single_precision ? 1e-6 : 2e-15) + 1e-300;
    }
    const std::string name = grid.name, axes = std::to_string(n), width = std::to_string(quantities * (n + 2));
    std::string text =
        "/* Self-test of " + header.filename().string() + ", a force table by Underbody: compares it at " +
        std::to_string(points_tried) + " points with what the program says.\n * cc -std=c99 " +
        c_self_test(header).filename().string() +
        " && ./a.out; the exit code is 0 when all agree, else 1.\n"
        " * With -DUNDERBODY_NO_MAIN it is the function int " +
        name + "_self_test(void): the number of points that do not agree. */\n#include \"" +
        header.filename().string() + "\"\n\n" + array(name + "_test_points", at) + "/* outside, refused, no_data */\n" +
        array(name + "_test_flags", flags) + "/* of each quantity the value, its slopes and its error */\n" +
        array(name + "_test_wanted", wanted) + array(name + "_test_allowed", allowed);
    text += "\nint " + name + "_self_test(void);\nint " + name +
            "_self_test(void) {\n    int failed = 0;\n    unsigned i, k;\n    for (i = 0; i < " +
            std::to_string(points_tried) + "u; ++i) {\n        const double* wanted = " + name + "_test_wanted + " +
            width + "u * i;\n        const double* flags = " + name + "_test_flags + 3u * i;\n        " + name +
            "_real point[" + axes + "];\n        " + name + "_result r;\n        double got[" + width +
            "];\n        int good;\n        for (k = 0; k < " + axes + "u; ++k) {\n            point[k] = (" + name +
            "_real)" + name + "_test_points[" + axes + "u * i + k];\n        }\n        " + name + "_at(point, &r);\n";
    for (std::size_t q = 0; q < quantities; ++q) {
        const std::string of = quantities > 1 ? identifier(grid.quantities[q].name) + "." : "",
                          first = std::to_string(q * (n + 2)) + "u";
        text += "        got[" + first + "] = (double)r." + of + "value;\n        for (k = 0; k < " + axes +
                "u; ++k) {\n            got[" + first + " + 1u + k] = (double)r." + of +
                "slope[k];\n        }\n        got[" + first + " + 1u + " + axes + "u] = (double)r." + of + "sigma;\n";
    }
    text +=
        "        good = r.outside == (flags[0] > 0.5) && r.refused == (flags[1] > 0.5) && r.no_data == (flags[2] > "
        "0.5);\n        for (k = 0; k < " +
        width + "u; ++k) {\n            const double off = got[k] - wanted[k];\n            const int error = k % " +
        std::to_string(n + 2) + "u == " + std::to_string(n + 1) +
        "u;\n            /* a refused point has no value and no slopes */\n            good = good && ((r.refused && "
        "!error) || (off <= " +
        name + "_test_allowed[k] && -off <= " + name +
        "_test_allowed[k]));\n        }\n        failed += good ? 0 : 1;\n    }\n    return failed;\n}\n\n#ifndef "
        "UNDERBODY_NO_MAIN\nint main(void) {\n    return " +
        name + "_self_test() > 0 ? 1 : 0;\n}\n#endif\n";
    core::write_file(c_self_test(header), text);
}

}  // namespace underbody::tables
