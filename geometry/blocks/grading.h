// Points along lines at graded distances. Internal to the block mesher; any unit of length.
#pragma once

#include <functional>
#include <vector>

namespace underbody::geometry {

struct Point2 {
    double x = 0, y = 0;
    friend Point2 operator+(const Point2& a, const Point2& b) { return {a.x + b.x, a.y + b.y}; }
    friend Point2 operator-(const Point2& a, const Point2& b) { return {a.x - b.x, a.y - b.y}; }
    friend Point2 operator*(double s, const Point2& a) { return {s * a.x, s * a.y}; }
};
double length(const Point2& v);

using Line2 = std::vector<Point2>;

/// Distances 0 .. `length` of `cells` cells in geometric growth from `first` at the start and `last` at the end; both
/// are made shorter where equal cells are shorter still.
std::vector<double> graded(double length, int cells, double first, double last);
/// The same with free growth toward the end.
std::vector<double> graded_from(double length, int cells, double first);
/// Positions from `from` to `to` through every one of `fixed` (inside, rising), with steps of about size(x); at least
/// one cell between neighbours. `size` is sampled: it should not change by more than its third over itself.
std::vector<double> sized(double from, double to, const std::vector<double>& fixed,
                          const std::function<double(double)>& size);

/// A cubic Bezier curve as a polyline.
Line2 bezier(const Point2& p0, const Point2& p1, const Point2& p2, const Point2& p3);
double length(const Line2& line);
/// Points of a polyline at distances along it.
Line2 at_distances(const Line2& line, const std::vector<double>& distances);
/// Shares of the length at the points of a polyline, 0 .. 1.
std::vector<double> shares(const Line2& line);

}  // namespace underbody::geometry
