#include "geometry/blocks/grading.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace underbody::geometry {

namespace {

constexpr int bezier_points = 240;

/// Ratio in [1, 5] for which the sum of the steps is `length`.
template <class Sum>
double growth(double length, const Sum& sum) {
    double low = 1, high = 5;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (sum(middle) < length ? low : high) = middle;
    }
    return high;
}

std::vector<double> summed(const std::vector<double>& steps, double length) {
    std::vector<double> distances(steps.size() + 1, 0.0);
    std::partial_sum(steps.begin(), steps.end(), distances.begin() + 1);
    const double scale = length / distances.back();
    for (double& d : distances) {
        d *= scale;
    }
    distances.back() = length;
    return distances;
}

}  // namespace

double length(const Point2& v) { return std::hypot(v.x, v.y); }

std::vector<double> graded(double length, int cells, double first, double last) {
    const auto count = static_cast<std::size_t>(cells);
    first = std::min(first, length / cells);
    last = std::min(last, length / cells);
    const auto fill = [&](double r, std::vector<double>& steps) {
        steps.resize(count);
        double from_start = first;
        for (std::size_t j = 0; j < count; ++j, from_start *= r) {
            steps[j] = from_start;
        }
        double from_end = last;
        for (std::size_t j = count; j-- > 0; from_end *= r) {
            steps[j] = std::min(steps[j], from_end);
        }
    };
    std::vector<double> steps;
    const auto sum = [&](double r) {
        fill(r, steps);
        return std::accumulate(steps.begin(), steps.end(), 0.0);
    };
    if (sum(1.0) >= length * (1 - 1e-9)) {
        steps.assign(count, 1.0);
    } else {
        fill(growth(length, sum), steps);
    }
    return summed(steps, length);
}

std::vector<double> graded_from(double length, int cells, double first) {
    first = std::min(first, length / cells);
    const double r = growth(length, [&](double ratio) {
        double total = 0, step = first;
        for (int j = 0; j < cells; ++j, step *= ratio) {
            total += step;
        }
        return total;
    });
    std::vector<double> steps(static_cast<std::size_t>(cells));
    double step = first;
    for (double& s : steps) {
        s = step;
        step *= r;
    }
    return summed(steps, length);
}

std::vector<double> sized(double from, double to, const std::vector<double>& fixed,
                          const std::function<double(double)>& size) {
    std::vector<double> ends{from};
    ends.insert(ends.end(), fixed.begin(), fixed.end());
    ends.push_back(to);
    std::vector<double> positions{from};
    constexpr int samples = 200;
    for (std::size_t i = 1; i < ends.size(); ++i) {
        const double low = ends[i - 1], width = ends[i] - low;
        std::vector<double> way(samples + 1, 0.0);
        for (int s = 0; s < samples; ++s) {
            way[static_cast<std::size_t>(s) + 1] =
                way[static_cast<std::size_t>(s)] + width / samples / size(low + width * (s + 0.5) / samples);
        }
        const int cells = std::max(1, static_cast<int>(std::ceil(way.back() - 0.2)));
        std::size_t s = 0;
        for (int c = 1; c < cells; ++c) {
            const double target = way.back() * c / cells;
            while (way[s + 1] < target) {
                ++s;
            }
            positions.push_back(low +
                                width * (static_cast<double>(s) + (target - way[s]) / (way[s + 1] - way[s])) / samples);
        }
        positions.push_back(ends[i]);
    }
    return positions;
}

Line2 bezier(const Point2& p0, const Point2& p1, const Point2& p2, const Point2& p3) {
    Line2 line(bezier_points + 1);
    for (int i = 0; i <= bezier_points; ++i) {
        const double u = static_cast<double>(i) / bezier_points, v = 1 - u;
        line[static_cast<std::size_t>(i)] = v * v * v * p0 + 3 * v * v * u * p1 + 3 * v * u * u * p2 + u * u * u * p3;
    }
    return line;
}

double length(const Line2& line) {
    double total = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
        total += length(line[i] - line[i - 1]);
    }
    return total;
}

Line2 at_distances(const Line2& line, const std::vector<double>& distances) {
    Line2 points;
    points.reserve(distances.size());
    std::size_t i = 1;
    double before = 0, step = length(line[1] - line[0]);
    for (const double d : distances) {
        while (i + 1 < line.size() && before + step < d) {
            before += step;
            ++i;
            step = length(line[i] - line[i - 1]);
        }
        const double w = step > 0 ? std::clamp((d - before) / step, 0.0, 1.0) : 0.0;
        points.push_back(w == 1 ? line[i] : line[i - 1] + w * (line[i] - line[i - 1]));
    }
    return points;
}

std::vector<double> shares(const Line2& line) {
    std::vector<double> s(line.size(), 0.0);
    for (std::size_t i = 1; i < line.size(); ++i) {
        s[i] = s[i - 1] + length(line[i] - line[i - 1]);
    }
    for (double& value : s) {
        value /= s.back();
    }
    return s;
}

}  // namespace underbody::geometry
