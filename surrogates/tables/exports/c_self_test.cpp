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
    while (points.size() < grid.self_test_points) {
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

/// Straight lines between numbers at the nodes of the grid; the place is held to its ends.
double between(const ExportGrid& grid, const std::vector<double>& nodes, const double* place) {
    const std::size_t n = grid.axes.size();
    std::array<std::size_t, max_axes> cell{};
    std::array<double, max_axes> share{};
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = grid.axes[k].points;
        const double at = std::clamp(place[k], x.front(), x.back());
        const auto above = std::upper_bound(x.begin(), x.end(), at) - x.begin();
        cell[k] = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above, 1, std::ssize(x) - 1)) - 1;
        share[k] = (at - x[cell[k]]) / (x[cell[k] + 1] - x[cell[k]]);
    }
    double sum = 0;
    for (std::size_t corner = 0; corner < std::size_t{1} << n; ++corner) {
        std::size_t node = 0;
        double weight = 1;
        for (std::size_t k = 0; k < n; ++k) {
            const bool far = (corner >> k & 1U) != 0;
            node = node * grid.axes[k].points.size() + cell[k] + (far ? 1 : 0);
            weight *= far ? share[k] : 1 - share[k];
        }
        sum += weight * nodes[node];
    }
    return sum;
}

/// A line of the grid beside its twin, where the table jumps: nothing is tried between them.
bool kink(const ExportAxis& axis, std::size_t i) {
    return axis.points[i + 1] - axis.points[i] < 1e-6 * (axis.points.back() - axis.points.front());
}

/// How far such lines in whole numbers of so many bits may be from those in real numbers: the roundings of the sums,
/// and those of the lines' places where the lines are steep.
double rounding_between(const ExportGrid& grid, const std::vector<double>& nodes, int bits, const FixedBits& all) {
    const std::size_t n = grid.axes.size();
    double rounding = 4 * (static_cast<double>(n) + 2) * std::ldexp(1.0, -bits);
    std::size_t step = nodes.size();
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = grid.axes[k].points;
        step /= x.size();
        double steepest = 0;
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            const std::size_t i = node / step % x.size();
            if (i + 1 < x.size() && !kink(grid.axes[k], i)) {
                steepest = std::max(steepest, std::abs(nodes[node + step] - nodes[node]) / (x[i + 1] - x[i]));
            }
        }
        rounding += 2 * steepest * std::ldexp(1.0, -all.axis[k]);
    }
    return rounding;
}

/// One number of a quantity of a header in whole numbers.
struct WholeNumber {
    std::vector<double> nodes;
    int bits = 0;
    double allowed = 0;
};

/// Value, slopes and error of one quantity at the nodes of its grid.
std::vector<WholeNumber> whole_numbers(const ExportGrid& grid, std::size_t at, const FixedBits& bits) {
    const ExportQuantity& q = grid.quantities[at];
    const std::size_t n = grid.axes.size(), nodes = q.surface.nodes();
    std::vector<WholeNumber> all(n + 2);
    for (std::size_t i = 0; i <= n; ++i) {
        all[i].bits = i == 0 ? bits.value[at] : bits.slope[at][i - 1];
        for (std::size_t node = 0; node < nodes; ++node) {
            all[i].nodes.push_back(q.surface.hermite()[(node << n) + (i == 0 ? 0 : std::size_t{1} << (i - 1))]);
        }
    }
    all[n + 1] = {q.error.node_sigma(), bits.value[at], 0};
    all[n + 1].nodes.resize(nodes, 0.0);
    for (WholeNumber& one : all) {
        one.allowed = rounding_between(grid, one.nodes, one.bits, bits);
    }
    for (std::size_t k = 0; k < n; ++k) {  // what the way outside adds
        const double far = (grid.axes[k].upper - grid.axes[k].lower) / 4;
        all[0].allowed += far * all[1 + k].allowed + std::ldexp(1.0, -bits.value[at]);
        all[n + 1].allowed += far * std::ldexp(1.0, -bits.growth[at][k]) + std::ldexp(1.0, -bits.value[at]);
    }
    return all;
}

/// What a header in whole numbers says there, before it is rounded.
std::vector<double> said_by_lines(const ExportGrid& grid, const ExportQuantity& q, const std::vector<WholeNumber>& of,
                                  const Point& point) {
    const std::size_t n = grid.axes.size();
    std::vector<double> numbers;
    for (const WholeNumber& one : of) {
        numbers.push_back(between(grid, one.nodes, point.at.data()));
    }
    for (std::size_t k = 0; k < n; ++k) {
        const auto& x = grid.axes[k].points;
        const double over = point.at[k] - std::clamp(point.at[k], x.front(), x.back());
        if (over == 0) {
            continue;
        }
        numbers[n + 1] += std::abs(over) * q.error.growth(k)[over < 0 ? 0 : 1];
        const bool goes_on = grid.axes[k].range == RangePolicy::extrapolate;
        numbers[0] += goes_on ? over * numbers[1 + k] : 0;
        numbers[1 + k] = goes_on ? numbers[1 + k] : 0;
    }
    return numbers;
}

/// What the test is made of; of a header in whole numbers all of these are whole.
struct Numbers {
    std::vector<double> at, flags, wanted, allowed;
};

void add_point(const ExportGrid& grid, const Point& point, Numbers& numbers) {
    numbers.at.insert(numbers.at.end(), point.at.begin(),
                      point.at.begin() + static_cast<std::ptrdiff_t>(grid.axes.size()));
    numbers.flags.insert(numbers.flags.end(),
                         {point.outside ? 1.0 : 0.0, point.refused ? 1.0 : 0.0, point.no_data ? 1.0 : 0.0});
}

Numbers in_whole_numbers(const ExportGrid& grid, const FixedBits& bits) {
    Numbers numbers;
    std::vector<std::vector<WholeNumber>> of;
    for (std::size_t q = 0; q < grid.quantities.size(); ++q) {
        of.push_back(whole_numbers(grid, q, bits));
        for (const WholeNumber& one : of.back()) {
            numbers.allowed.push_back(std::min(std::ceil(std::ldexp(one.allowed, one.bits)) + 1, 1e9));
        }
    }
    for (Point point : test_points(grid)) {
        std::vector<double> raw;
        for (std::size_t k = 0; k < grid.axes.size(); ++k) {
            raw.push_back(std::round(std::ldexp(point.at[k], bits.axis[k])));
            point.at[k] = std::ldexp(raw[k], -bits.axis[k]);
        }
        add_point(grid, point, numbers);
        std::copy(raw.begin(), raw.end(), numbers.at.end() - std::ssize(raw));
        for (std::size_t q = 0; q < grid.quantities.size(); ++q) {
            const auto said = said_by_lines(grid, grid.quantities[q], of[q], point);
            for (std::size_t i = 0; i < said.size(); ++i) {
                const double most = INT32_MAX;
                numbers.wanted.push_back(std::clamp(std::round(std::ldexp(said[i], of[q][i].bits)), -most, most));
            }
        }
    }
    return numbers;
}

Numbers in_real_numbers(const ExportGrid& grid) {
    const std::size_t n = grid.axes.size(), quantities = grid.quantities.size();
    Numbers numbers;
    std::vector<double>& allowed = numbers.allowed;
    allowed.assign(quantities * (n + 2), 0.0);
    for (const Point& point : test_points(grid)) {
        add_point(grid, point, numbers);
        for (std::size_t q = 0; q < quantities; ++q) {
            const auto there = said(grid, grid.quantities[q], point);
            for (std::size_t i = 0; i < there.size(); ++i) {
                allowed[q * (n + 2) + i] = std::max(allowed[q * (n + 2) + i], std::abs(there[i]));
            }
            numbers.wanted.insert(numbers.wanted.end(), there.begin(), there.end());
        }
    }
    // A slope is a difference of values over the width of a cell.
    for (std::size_t q = 0; q < quantities; ++q) {
        for (std::size_t k = 0; k < n; ++k) {
            const auto& x = grid.axes[k].points;
            double narrow = x.back() - x.front();
            for (std::size_t i = 0; i + 1 < x.size(); ++i) {
                narrow = kink(grid.axes[k], i) ? narrow : std::min(narrow, x[i + 1] - x[i]);
            }
            double& slope = allowed[q * (n + 2) + 1 + k];
            slope = slope * (1 + std::max(std::abs(x.front()), std::abs(x.back())) / narrow) +
                    allowed[q * (n + 2)] / narrow;
        }
    }
    for (double& a : allowed) {
        a = a * (grid.single_precision ? 1e-6 : 2e-15) + 1e-300;
    }
    return numbers;
}

std::string array(const std::string& type, const std::string& name, const std::vector<double>& numbers) {
    std::string text = "static const " + type + " " + name + "[] = {";
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::string number =
            type == "double" ? core::format_number(numbers[i]) : std::to_string(std::llround(numbers[i]));
        text += (i % 6 == 0 ? "\n    " : " ") + number + (i + 1 < numbers.size() ? "," : "");
    }
    return text + "\n};\n";
}

}  // namespace

std::filesystem::path c_self_test(const std::filesystem::path& path) {
    return path.parent_path() / (path.stem().string() + "_test.c");
}

void write_c_self_test(const ExportGrid& grid, const std::filesystem::path& header, const FixedBits* bits) {
    const std::size_t n = grid.axes.size(), quantities = grid.quantities.size();
    const Numbers numbers = bits != nullptr ? in_whole_numbers(grid, *bits) : in_real_numbers(grid);
    const std::string number = bits != nullptr ? "int32_t" : "double", wide = bits != nullptr ? "int64_t" : "double";
    const std::string name = grid.name, axes = std::to_string(n), width = std::to_string(quantities * (n + 2)),
                      coordinate = bits != nullptr ? number : name + "_real";
    std::string text =
        "/* Self-test of " + header.filename().string() + ", a force table by Underbody: compares it at " +
        std::to_string(grid.self_test_points) + " points with what the program says.\n * cc -std=c99 " +
        c_self_test(header).filename().string() +
        " && ./a.out; the exit code is 0 when all agree, else 1. It says how many do not, and\n"
        " * how far off a value is at most.\n"
        " * With -DUNDERBODY_NO_MAIN it is the function int " +
        name + "_self_test(void): the number of points that do not agree. */\n#include \"" +
        header.filename().string() + "\"\n\n" + array(number, name + "_test_points", numbers.at) +
        "/* outside, refused, no_data */\n" + array("unsigned char", name + "_test_flags", numbers.flags) +
        "/* of each quantity the value, its slopes and its error */\n" +
        array(number, name + "_test_wanted", numbers.wanted) + array(number, name + "_test_allowed", numbers.allowed);
    text += "\nstatic " + wide + " " + name + "_test_worst = 0;\n\nint " + name + "_self_test(void);\nint " + name +
            "_self_test(void) {\n    int failed = 0;\n    unsigned i, k;\n    for (i = 0; i < " +
            std::to_string(grid.self_test_points) + "u; ++i) {\n        const " + number + "* wanted = " + name +
            "_test_wanted + " + width + "u * i;\n        const unsigned char* flags = " + name +
            "_test_flags + 3u * i;\n        " + coordinate + " point[" + axes + "];\n        " + name +
            "_result r;\n        " + wide + " got[" + width + "];\n        int good;\n        for (k = 0; k < " + axes +
            "u; ++k) {\n            point[k] = (" + coordinate + ")" + name + "_test_points[" + axes +
            "u * i + k];\n        }\n        " + name + "_at(point, &r);\n";
    for (std::size_t q = 0; q < quantities; ++q) {
        const std::string of = quantities > 1 || bits != nullptr ? identifier(grid.quantities[q].name) + "." : "",
                          first = std::to_string(q * (n + 2)) + "u";
        text += "        got[" + first + "] = (" + wide + ")r." + of + "value;\n        for (k = 0; k < " + axes +
                "u; ++k) {\n            got[" + first + " + 1u + k] = (" + wide + ")r." + of +
                "slope[k];\n        }\n        got[" + first + " + 1u + " + axes + "u] = (" + wide + ")r." + of +
                "sigma;\n";
    }
    text +=
        "        good = r.outside == (flags[0] != 0) && r.refused == (flags[1] != 0) && r.no_data == (flags[2] != "
        "0);\n        for (k = 0; k < " +
        width + "u; ++k) {\n            const " + wide +
        " off = got[k] - wanted[k];\n            const int error = k % " + std::to_string(n + 2) +
        "u == " + std::to_string(n + 1) + "u;\n            const int value = k % " + std::to_string(n + 2) +
        "u == 0u && !r.refused;\n            const " + wide + " size = off < 0 ? -off : off;\n            " + name +
        "_test_worst = value && size > " + name + "_test_worst ? size : " + name +
        "_test_worst;\n            /* a refused point has no value and no slopes */\n            good = good && "
        "((r.refused && "
        "!error) || size <= " +
        name +
        "_test_allowed[k]);\n        }\n        failed += good ? 0 : 1;\n    }\n    return failed;\n}\n\n#ifndef "
        "UNDERBODY_NO_MAIN\n#include <stdio.h>\nint main(void) {\n    const int failed = " +
        name + "_self_test();\n    printf(\"%d of " + std::to_string(grid.self_test_points) + " differ; a value by " +
        (bits != nullptr ? "%ld units" : "%.3g") + " at most\\n\", failed, " + (bits != nullptr ? "(long)" : "") +
        name + "_test_worst);\n    return failed > 0 ? 1 : 0;\n}\n#endif\n";
    core::write_file(c_self_test(header), text);
}

}  // namespace underbody::tables
