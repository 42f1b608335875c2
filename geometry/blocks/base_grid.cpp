#include "geometry/blocks/base_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/text.h"

namespace underbody::geometry {

namespace {

using std::numbers::pi;
using Index = std::int32_t;

/// The core's share of the radius, how round it is, and how far its corners stand out.
constexpr double core_share = 0.58, roundness = 0.55, corner_share = 0.80;
/// The core's share of the half width where its lines run straight.
constexpr double straight_share = 0.6;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// (i, j) of the core's points on its outline: from its front end on the middle line over port to its aft end.
struct CoreIndex {
    int along, across;
    [[nodiscard]] std::pair<int, int> operator()(int m) const {
        if (m <= across) {
            return {along, m};
        }
        return m <= across + along ? std::pair{along - (m - across), across}
                                   : std::pair{0, across - (m - across - along)};
    }
    [[nodiscard]] int count() const { return 2 * across + along + 1; }
};

/// Points of the core by (i, j), i from aft to front, j from the middle line to port: transfinite interpolation.
std::vector<std::vector<Point2>> core_points(const CoreIndex& index, const std::vector<Point2>& outline,
                                             const std::vector<double>& middle) {
    const int n = index.across, na = index.along;
    std::vector<std::vector<Point2>> c(at(na) + 1, std::vector<Point2>(at(n) + 1));
    for (int m = 0; m < index.count(); ++m) {
        const auto [i, j] = index(m);
        c[at(i)][at(j)] = outline[at(m)];
    }
    for (int i = 0; i <= na; ++i) {
        c[at(i)][0] = {middle[at(i)], 0};
    }
    for (int i = 1; i < na; ++i) {
        for (int j = 1; j < n; ++j) {
            const double u = (middle[at(i)] - middle[0]) / (middle[at(na)] - middle[0]), v = static_cast<double>(j) / n;
            c[at(i)][at(j)] = (1 - v) * c[at(i)][0] + v * c[at(i)][at(n)] + (1 - u) * c[0][at(j)] +
                              u * c[at(na)][at(j)] - (1 - u) * (1 - v) * c[0][0] - u * (1 - v) * c[at(na)][0] -
                              (1 - u) * v * c[0][at(n)] - u * v * c[at(na)][at(n)];
        }
    }
    return c;
}

void add_quad(PlaneGrid& grid, Index a, Index b, Index c, Index d, bool nozzle) {
    grid.quads.push_back({a, b, c, d});
    grid.in_nozzle.push_back(nozzle ? 1 : 0);
}

/// Quads between two chains of points with equally many; the second lies to the left of the first.
void add_strip(PlaneGrid& grid, const std::vector<Index>& right, const std::vector<Index>& left, bool nozzle) {
    for (std::size_t m = 1; m < right.size(); ++m) {
        add_quad(grid, right[m - 1], right[m], left[m], left[m - 1], nozzle);
    }
}

/// Rings from an inner chain to points around it; `shares(m)` are positions between, 0 at the inner one, 1 outside.
template <class Shares>
std::vector<Index> add_rings(PlaneGrid& grid, std::vector<Index> inner, const std::vector<Point2>& outer,
                             const Shares& shares_of, int rings, bool nozzle) {
    const std::vector<Index> start = inner;
    std::vector<std::vector<double>> share;
    for (int m = 0; m < static_cast<int>(outer.size()); ++m) {
        share.push_back(shares_of(m));
    }
    for (int r = 1; r <= rings; ++r) {
        std::vector<Index> next;
        for (std::size_t m = 0; m < outer.size(); ++m) {
            const Point2 from = grid.points[static_cast<std::size_t>(start[m])];
            next.push_back(grid.add(r == rings ? outer[m] : from + share[m][at(r)] * (outer[m] - from)));
        }
        add_strip(grid, next, inner, nozzle);  // outer chain runs counter-clockwise: the inner one lies to its left
        inner = next;
    }
    return inner;
}

/// Adds a core; `hole` cells to both sides of line `hole_at`, as many across, are left out. Returns ids by (i, j).
std::vector<std::vector<Index>> add_core(PlaneGrid& grid, const std::vector<std::vector<Point2>>& points, int hole_at,
                                         int hole, bool nozzle) {
    const int na = static_cast<int>(points.size()) - 1, n = static_cast<int>(points[0].size()) - 1;
    std::vector<std::vector<Index>> id(at(na) + 1, std::vector<Index>(at(n) + 1, -1));
    for (int i = 0; i <= na; ++i) {
        for (int j = 0; j <= n; ++j) {
            const bool inside = hole > 0 && std::abs(i - hole_at) < hole && j < hole;
            id[at(i)][at(j)] = inside ? -1 : grid.add(points[at(i)][at(j)]);
        }
    }
    for (int i = 0; i < na; ++i) {
        for (int j = 0; j < n; ++j) {
            const bool inside = hole > 0 && i >= hole_at - hole && i < hole_at + hole && j < hole;
            if (!inside) {
                add_quad(grid, id[at(i)][at(j)], id[at(i) + 1][at(j)], id[at(i) + 1][at(j) + 1], id[at(i)][at(j) + 1],
                         nozzle);
            }
        }
    }
    return id;
}

/// Outline of a near square core inside a unit circle whose corners lie at the given azimuths.
Point2 round_core(double azimuth, double front_corner, double back_corner, double radius) {
    const double square_angle = azimuth < front_corner ? azimuth / front_corner * pi / 4
                                : azimuth <= back_corner
                                    ? pi / 4 + (azimuth - front_corner) / (back_corner - front_corner) * pi / 2
                                    : 3 * pi / 4 + (azimuth - back_corner) / (pi - back_corner) * pi / 4;
    const double c = std::cos(square_angle), s = std::sin(square_angle);
    const double out = corner_share / std::max(std::abs(c), std::abs(s));
    return core_share *
           (roundness * radius * Point2{std::cos(azimuth), std::sin(azimuth)} + (1 - roundness) * out * Point2{c, s});
}

std::vector<double> evenly(double from, double to, int cells) {
    std::vector<double> values(at(cells) + 1);
    for (int i = 0; i <= cells; ++i) {
        values[at(i)] = from + (to - from) * i / cells;
    }
    return values;
}

std::vector<Index> outline_of(const CoreIndex& index, const std::vector<std::vector<Index>>& id) {
    std::vector<Index> chain;
    for (int m = 0; m < index.count(); ++m) {
        const auto [i, j] = index(m);
        chain.push_back(id[at(i)][at(j)]);
    }
    return chain;
}

[[noreturn]] void no_room(const std::string& what, const std::string& hint) {
    throw core::InputError("mesh", "no block mesh: " + what, {}, hint);
}

/// Where lines of the core must run straight across the base: positions in X, and how fine around them.
struct Feature {
    double low, high;           ///< its extent
    std::vector<double> lines;  ///< inside or at its ends
    double size;                ///< of the cells there
};

std::vector<Feature> features_of(const BodySection& section, const DiscCounts& counts) {
    const ExactBody& body = section.body();
    std::vector<Feature> features;
    if (body.shape().protrusion) {
        const ExactBody::Foot foot = body.protrusion_foot();
        const double x = foot.x / section.to_x(), r = foot.radius / section.to_x(), crest = foot.crest / section.to_x();
        Feature ridge{x - r, x + r, {x - r}, std::min(counts.core_size, 4.0 * r / counts.across)};
        const bool blended = crest < 0.97 * r && crest > 0.03 * r;
        if (blended) {
            ridge.lines.push_back(x - crest);
        }
        ridge.lines.push_back(x);
        if (blended) {
            ridge.lines.push_back(x + crest);
        }
        ridge.lines.push_back(x + r);
        features.push_back(ridge);
    }
    return features;
}

/// Half the side of the square around the nozzle, in cells.
int nozzle_square(const BodySection& section, const DiscCounts& counts) {
    const Nozzle& nozzle = *section.body().shape().nozzle;
    const double radius = 0.5 * nozzle.diameter / std::min(section.to_x(), section.to_y());
    const int cells = std::max(3, static_cast<int>(std::ceil(1.6 * radius / counts.core_size)));
    if (cells > counts.across - 3) {
        no_room("the nozzle of " + core::format_number(1000 * nozzle.diameter, 4) +
                    " mm leaves no room for cells between it and the edge of the base",
                "a smaller nozzle, or the other mesher (snappy)");
    }
    return cells;
}

/// The square around the nozzle: its middle in X, half its side, and half its side in cells.
struct NozzleSquare {
    double x, half;
    int cells;
};

/// Of a base without features: evenly between its corners.
RimAzimuths plain_rim(double front, double back, int across) {
    RimAzimuths rim;
    rim.along = 2 * across;
    for (const auto& part : {evenly(0, front, across), evenly(front, back, 2 * across), evenly(back, pi, across)}) {
        rim.azimuth.insert(rim.azimuth.end(), part.begin() + (rim.azimuth.empty() ? 0 : 1), part.end());
    }
    return rim;
}

/// From where to where in X, aft and front, the lines of the core run: around every feature.
std::pair<double, double> core_stretch(const BodySection& section, const std::vector<Feature>& features) {
    const double nose = section.rim(0), tail = -section.rim(pi);
    double front = straight_share * nose, back = straight_share * tail;
    const double margin = 0.02 * (nose - tail);
    for (const Feature& f : features) {
        front = std::max(front, f.high + margin);
        back = std::min(back, f.low - margin);
    }
    if (front > nose - 0.6 * margin || back < tail + 0.6 * margin) {
        no_room(std::string("protrusion or nozzle lies too near to the ") +
                    (back < tail + 0.6 * margin ? "tail" : "nose") +
                    " end of the base for straight lines of cells around it",
                "move it by some millimetres toward the middle, or take the other mesher (snappy)");
    }
    return {back, front};
}

/// Where lines must stand: in the features, and along the cells of the square around the nozzle.
std::vector<double> fixed_lines(const std::vector<Feature>& features, const std::optional<NozzleSquare>& square) {
    std::vector<double> fixed;
    for (const Feature& f : features) {
        fixed.insert(fixed.end(), f.lines.begin(), f.lines.end());
    }
    if (square) {
        for (const Feature& f : features) {
            if (!f.lines.empty() && f.high > square->x - square->half && f.low < square->x + square->half) {
                no_room("protrusion and nozzle lie so near to each other that their cells overlap",
                        "move one of them, or take the other mesher (snappy)");
            }
        }
        for (int i = -square->cells; i <= square->cells; ++i) {
            fixed.push_back(square->x + square->half * i / square->cells);
        }
        std::sort(fixed.begin(), fixed.end());
    }
    return fixed;
}

/// From where to where something reaches.
struct Stretch {
    double back, front;
};

/// A point of the rim for each line: abreast of it in a feature, spread to the corners outside. `corners` are
/// azimuths; `core` and `featured` X of lines.
std::vector<double> rim_points(const BodySection& section, const std::vector<double>& lines, const Stretch& corners,
                               const Stretch& core, const Stretch& featured, int n) {
    const auto [back, front] = corners;
    const double first = featured.back, last = featured.front;
    std::vector<double> azimuth;
    const double front_x = section.rim(front) * std::cos(front), back_x = section.rim(back) * std::cos(back);
    const auto part = evenly(0, front, n);
    azimuth.assign(part.begin(), part.end() - 1);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        double x = lines[i];
        if (x > last) {
            const double w = (x - last) / (core.front - last);
            x = last + (front_x - last) * w;
        } else if (x < first) {
            const double w = (first - x) / (first - core.back);
            x = first + (back_x - first) * w;
        }
        azimuth.push_back(i == 0 ? front : i + 1 == lines.size() ? back : section.rim_azimuth(x));
    }
    const auto aft = evenly(back, pi, n);
    azimuth.insert(azimuth.end(), aft.begin() + 1, aft.end());
    return azimuth;
}

}  // namespace

std::int32_t PlaneGrid::add(const Point2& p) {
    points.push_back(p);
    return static_cast<std::int32_t>(points.size()) - 1;
}

RimAzimuths rim_azimuths(const BodySection& section, const DiscCounts& counts) {
    const int n = counts.across;
    double front = section.front_corner(), back = section.back_corner();
    RimAzimuths rim;
    std::vector<Feature> features = features_of(section, counts);
    std::optional<NozzleSquare> square;
    if (const auto& nozzle = section.body().shape().nozzle) {
        const int cells = nozzle_square(section, counts);
        square = {section.body().shape().base_x(nozzle->position) / section.to_x(), cells * counts.core_size, cells};
        features.push_back({square->x - square->half, square->x + square->half, {}, counts.core_size});
    }
    if (features.empty()) {
        return plain_rim(front, back, n);
    }
    const auto [core_back, core_front] = core_stretch(section, features);
    // Corners of the base stay where they are; on a smooth rim they move out as the core does.
    const bool back_is_smooth = !section.body().cut(Side::back), front_is_smooth = !section.body().cut(Side::front);
    if (front_is_smooth) {
        front = std::min(front, section.rim_azimuth(core_front + 0.35 * (section.rim(0) - core_front)));
    }
    if (back_is_smooth) {
        back = std::max(back, section.rim_azimuth(core_back + 0.35 * (-section.rim(pi) - core_back)));
    }
    // X of lines, from aft to front: fine in a feature, coarser away from it.
    std::sort(features.begin(), features.end(), [](const Feature& a, const Feature& b) { return a.low < b.low; });
    const auto size = [&](double x) {
        double s = counts.core_size;
        for (const Feature& f : features) {
            s = std::min(s, f.size + 0.25 * std::max({0.0, f.low - x, x - f.high}));
        }
        return s;
    };
    std::vector<double> lines = sized(core_back, core_front, fixed_lines(features, square), size);
    rim.along = static_cast<int>(lines.size()) - 1;
    std::reverse(lines.begin(), lines.end());  // from the front, as azimuths run
    if (square) {
        const auto nearest = std::min_element(lines.begin(), lines.end(), [&](double a, double b) {
            return std::abs(a - square->x) < std::abs(b - square->x);
        });
        rim.nozzle_line = static_cast<int>(nearest - lines.begin());
        rim.nozzle_cells = square->cells;
    }
    rim.azimuth = rim_points(section, lines, {back, front}, {core_back, core_front},
                             {features.front().low, features.back().high}, n);
    rim.lines = lines;
    return rim;
}

PlaneGrid disc_grid(const RimAzimuths& rim, const DiscCounts& counts, int rings) {
    PlaneGrid grid;
    const CoreIndex index{rim.along, counts.across};
    const double front = rim.azimuth[at(counts.across)], back = rim.azimuth[at(counts.across + rim.along)];
    std::vector<Point2> outline, circle;
    for (int m = 0; m < index.count(); ++m) {
        const double azimuth = rim.azimuth[at(m)];
        const bool on_middle = m == 0 || m + 1 == index.count();
        outline.push_back(round_core(azimuth, front, back, 1));
        circle.push_back({on_middle ? (m == 0 ? 1.0 : -1.0) : std::cos(azimuth), on_middle ? 0 : std::sin(azimuth)});
        if (on_middle) {
            outline.back().y = 0;
        }
    }
    std::vector<double> middle = evenly(outline.back().x, outline.front().x, rim.along);
    if (!rim.lines.empty()) {
        for (int i = 1; i < rim.along; ++i) {
            const double first = outline[at(counts.across + rim.along)].x, last = outline[at(counts.across)].x;
            const double x = outline[at(counts.across + rim.along - i)].x;
            middle[at(i)] = middle[0] + (middle[at(rim.along)] - middle[0]) * (x - first) / (last - first);
        }
    }
    const auto id = add_core(grid, core_points(index, outline, middle), 0, 0, false);
    const auto equal = evenly(0, 1, rings);
    grid.rim = add_rings(
        grid, outline_of(index, id), circle, [&](int) { return equal; }, rings, false);
    return grid;
}

namespace {

/// Rings from the circle of the nozzle to the points of the square around it. They grow from `step`, the size of the
/// cells inside.
void add_rings_to_square(PlaneGrid& grid, const std::vector<Index>& square, const std::vector<Point2>& circle,
                         double step, double largest) {
    const double way = geometry::length(grid.points[static_cast<std::size_t>(square[0])] - circle[0]);
    int rings = 2;
    while (rings < 40 && way / step > (std::pow(1.3, rings) - 1) / 0.3) {
        ++rings;
    }
    std::vector<Point2> square_points;
    for (const Index s : square) {
        square_points.push_back(grid.points[static_cast<std::size_t>(s)]);
    }
    const auto growing = [&](int m) {
        const double here = geometry::length(square_points[at(m)] - circle[at(m)]);
        auto d = graded(here, rings, std::min(step, here / rings), largest);
        for (double& value : d) {
            value /= here;
        }
        return d;
    };
    // Rings end on points that are there already.
    std::vector<Index> chain = grid.nozzle_rim;
    std::vector<std::vector<double>> share;
    for (int m = 0; m < static_cast<int>(square.size()); ++m) {
        share.push_back(growing(m));
    }
    for (int r = 1; r <= rings; ++r) {
        std::vector<Index> next;
        for (int m = 0; m < static_cast<int>(square.size()); ++m) {
            next.push_back(
                r == rings ? square[at(m)]
                           : grid.add(circle[at(m)] + share[at(m)][at(r)] * (square_points[at(m)] - circle[at(m)])));
        }
        add_strip(grid, next, chain, false);
        chain = next;
    }
}

double core_scale(const BodySection& section) {
    return section.largest() * std::sqrt(1 - std::pow(section.body().shape().base_cut, 2));
}

/// What replaces the square around the nozzle: rings to its circle, and a round core inside.
void add_nozzle(PlaneGrid& grid, const BodySection& section, const RimAzimuths& rim,
                const std::vector<std::vector<Index>>& id, const DiscCounts& counts) {
    const Nozzle& nozzle = *section.body().shape().nozzle;
    const double x = section.body().shape().base_x(nozzle.position), radius = nozzle.diameter / 2;
    const int k = rim.nozzle_cells, centre = rim.along - rim.nozzle_line;
    const CoreIndex index{2 * k, k};
    std::vector<Index> square;
    std::vector<Point2> circle, inner;
    for (int m = 0; m < index.count(); ++m) {
        const auto [i, j] = index(m);
        square.push_back(id[at(centre - k + i)][at(j)]);
        const double angle = pi * m / (index.count() - 1);
        const bool on_middle = m == 0 || m + 1 == index.count();
        const Point2 around{std::cos(angle), on_middle ? 0 : std::sin(angle)};
        Point2 core = round_core(angle, pi / 4, 3 * pi / 4, 1);
        core.y = on_middle ? 0 : core.y;
        const auto scaled = [&](const Point2& p) {
            return Point2{(x + radius * p.x) / section.to_x(), radius * p.y / section.to_y()};
        };
        circle.push_back(scaled(around));
        inner.push_back(scaled(core));
    }
    // Inside: core and rings to the circle.
    const auto core = core_points(index, inner, evenly(inner.back().x, inner.front().x, 2 * k));
    const int inner_rings = std::max(2, k / 2);
    const auto equal = evenly(0, 1, inner_rings);
    grid.nozzle_rim = add_rings(
        grid, outline_of(index, add_core(grid, core, 0, 0, true)), circle, [&](int) { return equal; }, inner_rings,
        true);
    add_rings_to_square(grid, square, circle, 0.42 * radius / inner_rings, counts.core_size);
}

/// Outline and middle line of the core.
struct CoreLines {
    std::vector<Point2> outline;
    std::vector<double> middle;
};

CoreLines core_lines(const BodySection& section, const RimAzimuths& rim, const std::vector<Point2>& edge, int n) {
    const CoreIndex index{rim.along, n};
    const double front = rim.azimuth[at(n)], back = rim.azimuth[at(n + rim.along)];
    std::vector<Point2> outline(rim.azimuth.size());
    std::vector<double> middle;
    const double scale = section.largest() * std::sqrt(1 - std::pow(section.body().shape().base_cut, 2));
    if (rim.lines.empty()) {
        for (std::size_t m = 0; m < edge.size(); ++m) {
            const double azimuth = rim.azimuth[m];
            outline[m] = scale * round_core(azimuth, front, back, geometry::length(edge[m]) / scale);
        }
        outline.front().y = outline.back().y = 0;
        middle = evenly(outline.back().x, outline.front().x, rim.along);
    } else {
        const auto half = [&](int i) { return straight_share * edge[at(n + i)].y; };
        for (int m = 0; m < index.count(); ++m) {
            const int i = std::clamp(m - n, 0, rim.along);
            const int to_corner = m < n ? n - m : m > n + rim.along ? m - n - rim.along : 0;
            outline[at(m)] = {rim.lines[at(i)], half(i) * (n - to_corner) / n};
        }
        middle.assign(rim.lines.rbegin(), rim.lines.rend());
    }
    return {std::move(outline), std::move(middle)};
}

}  // namespace

PlaneGrid base_grid(const BodySection& section, const RimAzimuths& rim, const DiscCounts& counts) {
    PlaneGrid grid;
    const CoreIndex index{rim.along, counts.across};
    const int n = counts.across;
    const double widest = section.rim(0);
    std::vector<Point2> edge;
    for (std::size_t m = 0; m < rim.azimuth.size(); ++m) {
        const double azimuth = rim.azimuth[m], r = section.rim(azimuth);
        const bool on_middle = m == 0 || m + 1 == rim.azimuth.size();
        edge.push_back({r * std::cos(azimuth), on_middle ? 0 : r * std::sin(azimuth)});
    }
    const CoreLines core = core_lines(section, rim, edge, n);
    const double scale = core_scale(section);
    const auto id = add_core(grid, core_points(index, core.outline, core.middle), rim.along - rim.nozzle_line,
                             rim.nozzle_cells, false);
    if (rim.nozzle_cells > 0) {
        add_nozzle(grid, section, rim, id, counts);
    }
    const double first_length = widest - geometry::length(core.outline.front());
    const auto common = graded(first_length, counts.rings, 0.9 * core_share * scale / n, counts.rim_size);
    const auto to_rim = [&](int m) {
        const double way = rim.lines.empty() ? first_length : geometry::length(edge[at(m)] - core.outline[at(m)]);
        std::vector<double> d =
            rim.lines.empty() ? common : graded(way, counts.rings, 0.9 * core_share * scale / n, counts.rim_size);
        for (double& value : d) {
            value /= way;
        }
        return d;
    };
    grid.rim = add_rings(grid, outline_of(index, id), edge, to_rim, counts.rings, false);
    return grid;
}

}  // namespace underbody::geometry
