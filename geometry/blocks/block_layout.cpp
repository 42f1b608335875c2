#include "geometry/blocks/block_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/error.h"

namespace underbody::geometry {

namespace {

using core::degree;
using std::numbers::pi;

double square(double v) { return v * v; }

double smooth_share(double s) {
    s = std::clamp(s, 0.0, 1.0);
    return s * s * (3 - 2 * s);
}

}  // namespace

BlockLayout::BlockLayout(const BodySection& section, BlockCounts counts, double gap, double scale)
    : far_radius(1.2 * scale),
      far_height(gap + 0.35 * scale),
      dome_height(0.85 * scale),
      section_(section),
      counts_(counts),
      gap_(gap),
      scale_(scale),
      largest_(section.largest()),
      centre_height_(gap + section.body().depth()),
      semi_z_(section.body().semi_z()),
      top_angle_(140 * degree),
      plate_(tail_plate(section.body().shape())) {
    const ExactBody& body = section.body();
    const double rim_angle = std::acos(body.depth() / semi_z_);
    // Sides that are cut meet the ellipsoid at its midplane. A shallow flank needs some length.
    const double lowest = plate_ != nullptr                        ? 66 * degree
                          : body.shape().base == BaseKind::ellipse ? 82 * degree
                                                                   : 90 * degree;
    equator_angle_ = std::min(std::max(lowest, rim_angle + 12 * degree), 115 * degree);
    if (plate_ != nullptr && (equator_angle_ > 78 * degree || body.shape().base != BaseKind::ellipse)) {
        throw core::InputError("mesh", "a tail plate needs lines of the mesh below it, for which this body has no room",
                               {}, "base = \"ellipse\" with a base_cut of at least 0.41, or no [tail_plate]");
    }
    const FlankLine flank(section, 0, ellipsoid(equator_angle_).y - gap);
    const double usual = (82 - 41.41) * degree;
    counts_.flank = std::max(counts_.flank / 2,
                             static_cast<int>(std::lround(counts_.flank * (equator_angle_ - rim_angle) / usual)));
    foot_radius_ = largest_ + 0.75 * ellipsoid(equator_angle_).y;
    equator_ = flank_line(ellipsoid(equator_angle_), 1, section.rim(0), flank.length());
    double sum = 0;
    layers_.push_back(0);
    for (int j = 1; j <= counts_.layers; ++j) {
        const auto i = static_cast<std::size_t>(j);
        sum += geometry::length(equator_[i] - equator_[i - 1]);
        layers_.push_back(sum);
    }
    if (plate_ != nullptr) {
        make_room_for_plate();
    }
}

void BlockLayout::make_room_for_plate() {
    plate_radius_ = largest_ * (1 + plate_->chord / section_.body().semi_x());
    beside_plate_ = free_outward(pi / 2);
    for (std::size_t j = 1; j < beside_plate_.size(); ++j) {
        if (std::abs(beside_plate_[j].x - plate_radius_) <
            std::abs(beside_plate_[static_cast<std::size_t>(plate_end_)].x - plate_radius_)) {
            plate_end_ = static_cast<int>(j);
        }
    }
    plate_end_ = std::max(plate_end_, 1);
}

double BlockLayout::far_volume() const { return pi * square(far_radius) * (far_height + 2.0 / 3 * dome_height); }

Point2 BlockLayout::ellipsoid(double angle) const {
    return {largest_ * std::sin(angle), centre_height_ - semi_z_ * std::cos(angle)};
}

Point2 BlockLayout::normal(double angle) const {
    const Point2 n{std::sin(angle) / largest_, -std::cos(angle) / semi_z_};
    return 1 / geometry::length(n) * n;
}

std::vector<double> BlockLayout::column() const {
    return graded(gap_, counts_.down(), counts_.first, counts_.first_ground);
}

// From a point at a share of the flank down to the ground: it leaves straight down at the rim, along the normal at the
// equator.
Line2 BlockLayout::flank_line(const Point2& from, double share, double rim, double flank_length) const {
    const double straight = std::min(flank_length / (foot_radius_ - rim), 1.0);
    const Point2 foot{rim + (foot_radius_ - rim) * (straight * share + (1 - straight) * share * share), 0};
    const Point2 n = normal(equator_angle_);
    const double angle = -pi / 2 + (std::atan2(n.y, n.x) + pi / 2) * share;
    const double way = geometry::length(foot - from);
    const Point2 p1 = from + (0.33 - 0.17 * share) * way * Point2{std::cos(angle), std::sin(angle)};
    const Point2 p2 = foot + Point2{0, (0.33 + 0.17 * share) * from.y};
    const Line2 curve = bezier(from, p1, p2, foot);
    Line2 line =
        at_distances(curve, graded(geometry::length(curve), counts_.down(), counts_.first, counts_.first_ground));
    line.front() = from;
    line.back() = foot;
    return line;
}

std::vector<Line2> BlockLayout::flank(double azimuth) const {
    const double top = ellipsoid(equator_angle_).y - gap_;
    const FlankLine line(section_, azimuth, top);
    const auto arcs = graded(line.length(), counts_.flank, counts_.base.rim_size, 3.5e-3 * scale_);
    std::vector<Line2> lines;
    for (std::size_t i = 0; i + 1 < arcs.size(); ++i) {
        const Point2 p = line.at(arcs[i]);
        lines.push_back(flank_line({p.x, gap_ + p.y}, arcs[i] / line.length(), section_.rim(azimuth), line.length()));
    }
    lines.push_back(equator_);
    return lines;
}

double BlockLayout::arc_between(double from, double to) const {
    constexpr int samples = 2000;
    double arc = 0;
    for (int i = 1; i <= samples; ++i) {
        arc += geometry::length(ellipsoid(from + (to - from) * i / samples) -
                                ellipsoid(from + (to - from) * (i - 1) / samples));
    }
    return arc;
}

std::vector<double> BlockLayout::angles_between(double from, double to, const std::vector<double>& arcs) const {
    constexpr int samples = 2000;
    std::vector<double> arc(samples + 1, 0.0);
    const auto angle = [&](double i) { return from + (to - from) * i / samples; };
    for (int i = 1; i <= samples; ++i) {
        arc[static_cast<std::size_t>(i)] =
            arc[static_cast<std::size_t>(i) - 1] + geometry::length(ellipsoid(angle(i)) - ellipsoid(angle(i - 1)));
    }
    std::vector<double> angles;
    std::size_t i = 1;
    for (const double d : arcs) {
        while (i < samples && arc[i] < d) {
            ++i;
        }
        angles.push_back(angle(static_cast<double>(i - 1) + (d - arc[i - 1]) / (arc[i] - arc[i - 1])));
    }
    angles.front() = from;
    angles.back() = to;
    return angles;
}

std::vector<double> BlockLayout::upper_angles() const {
    const double start = 2e-3 * scale_, end = 5.5e-3 * scale_;
    const auto lines = [&](double from, double to, int cells, double first, double last) {
        return angles_between(from, to, graded(arc_between(from, to), cells, first, last));
    };
    if (plate_ == nullptr) {
        return lines(equator_angle_, top_angle_, counts_.upper, start, end);
    }
    const double at_plate = 9e-3 * scale_ / counts_.upper;
    std::vector<double> angles = lines(equator_angle_, pi / 2, lines_below_plate(), start, at_plate);
    const std::vector<double> above = lines(pi / 2, top_angle_, counts_.upper, at_plate, end);
    angles.insert(angles.end(), above.begin() + 1, above.end());
    return angles;
}

// Down to the plate's level, where it is `share` of the plate's own line; in front of its end a point lies on that.
Line2 BlockLayout::beside_plate(Line2 line, const std::function<double(int)>& share) const {
    const double miss = plate_radius_ - beside_plate_[static_cast<std::size_t>(plate_end_)].x;
    const double from = plate_radius_ + 0.02 * scale_;
    for (std::size_t j = 1; j + 1 < line.size(); ++j) {
        const int at = static_cast<int>(j);
        const double near = smooth_share((from + 0.5 * scale_ - beside_plate_[j].x) / (0.5 * scale_));
        line[j].x += share(at) * smooth_share(1 - std::abs(at - plate_end_) / 4.0) * miss;
        line[j].y += share(at) * near * (centre_height_ - beside_plate_[j].y);
    }
    return line;
}

// With a plate its own line is level as far as it reaches; those above follow it less and less, those below lie between
// it and the lowest, which follows it by less than half.
Line2 BlockLayout::outward(double angle) const {
    Line2 line = free_outward(angle);
    if (plate_ == nullptr || angle >= top_angle_) {
        return line;
    }
    if (angle >= pi / 2) {
        const double share = smooth_share((top_angle_ - angle) / (top_angle_ - pi / 2));
        return beside_plate(std::move(line), [&](int) { return share; });
    }
    const auto beyond_layers = [&](int j) { return smooth_share((j - counts_.layers) / 5.0); };
    const auto less = [&](int j) { return 0.4 * beyond_layers(j); };
    const Line2 lower = beside_plate(free_outward(equator_angle_), less),
                upper = beside_plate(beside_plate_, [](int) { return 1.0; });
    const double u = (angle - equator_angle_) / (pi / 2 - equator_angle_), own = smooth_share(u);
    line = beside_plate(std::move(line), [&](int j) { return own + (1 - own) * less(j); });
    for (std::size_t j = 1; j < line.size(); ++j) {
        const double between = beyond_layers(static_cast<int>(j));
        line[j] = (1 - between) * line[j] + between * ((1 - u) * lower[j] + u * upper[j]);
    }
    return line;
}

Line2 BlockLayout::free_outward(double angle) const {
    const Point2 on_hull = ellipsoid(angle), n = normal(angle), at_equator = normal(equator_angle_),
                 equator = ellipsoid(equator_angle_);
    // Near the equator the layers bend as its own line does, which runs down to the ground.
    const double near = std::exp(-(angle - equator_angle_) / 0.15);
    Line2 line;
    for (std::size_t j = 0; j < layers_.size(); ++j) {
        line.push_back(on_hull + layers_[j] * n + near * (equator_[j] - equator - layers_[j] * at_equator));
    }
    const double turn = (plate_ != nullptr ? 18 : 35) * degree * std::exp(-(angle - equator_angle_) / 0.25);
    Point2 leave{n.x * std::cos(turn) - n.y * std::sin(turn), n.x * std::sin(turn) + n.y * std::cos(turn)};
    const double far_angle = pi / 2 * (angle - equator_angle_) / (pi - equator_angle_);
    Point2 arrive{std::cos(far_angle), std::sin(far_angle)};
    Point2 far{far_radius * arrive.x, far_height + dome_height * arrive.y};
    if (angle > pi - 1e-9) {
        far.x = 0;
        leave = arrive = {0, 1};
        for (Point2& p : line) {
            p.x = 0;
        }
    }
    const Point2 start = line.back();
    const double way = geometry::length(far - start);
    const Line2 curve = bezier(start, start + 0.08 * way * leave, far - 0.4 * way * arrive, far);
    const double last = layers_.back() - layers_[layers_.size() - 2];
    const Line2 out = at_distances(curve, graded_from(geometry::length(curve), counts_.outward, 1.15 * last));
    line.insert(line.end(), out.begin() + 1, out.end());
    line.back() = far;
    return line;
}

std::vector<Line2> BlockLayout::outer_block() const {
    const auto layers = static_cast<std::ptrdiff_t>(counts_.layers);
    const int nr = counts_.outward, ng = counts_.to_ground;
    const Line2 left(equator_.begin() + layers, equator_.end());
    const Line2 whole = outward(equator_angle_);
    Line2 top(whole.begin() + layers, whole.end());
    top.front() = left.front();
    Line2 right, bottom;
    std::vector<double> fall = graded(far_height, ng, 25e-3 * scale_, 8e-3 * scale_);
    if (plate_ != nullptr) {  // the top is low over the ground: lines that run across it keep their shares
        fall = shares(left);
        std::for_each(fall.begin(), fall.end(), [&](double& d) { d *= far_height; });
    }
    for (const double d : fall) {
        right.push_back({far_radius, far_height - d});
    }
    const FlankLine nose(section_, 0, ellipsoid(equator_angle_).y - gap_);
    const double before = 1 - 1.0 / counts_.flank;
    const Point2 p = nose.at(before * nose.length());
    const Line2 last_but_one = flank_line({p.x, gap_ + p.y}, before, section_.rim(0), nose.length());
    const double step = std::min(foot_radius_ - last_but_one.back().x, 6e-3 * scale_);
    for (const double d : graded_from(far_radius - foot_radius_, nr, step)) {
        bottom.push_back({foot_radius_ + d, 0});
    }
    const auto ut = shares(top), ub = shares(bottom), vl = shares(left), vr = shares(right);
    std::vector<Line2> block(static_cast<std::size_t>(nr) + 1, Line2(static_cast<std::size_t>(ng) + 1));
    for (std::size_t i = 0; i < block.size(); ++i) {
        for (std::size_t j = 0; j < block[i].size(); ++j) {
            // Where the straight lines between the shares of opposite sides meet.
            const double du = ub[i] - ut[i], dv = vr[j] - vl[j];
            const double u = (ut[i] + vl[j] * du) / (1 - du * dv), v = (vl[j] + ut[i] * dv) / (1 - du * dv);
            block[i][j] = (1 - v) * top[i] + v * bottom[i] + (1 - u) * left[j] + u * right[j] -
                          (1 - u) * (1 - v) * top.front() - u * (1 - v) * top.back() - (1 - u) * v * bottom.front() -
                          u * v * bottom.back();
        }
    }
    return block;
}

}  // namespace underbody::geometry
