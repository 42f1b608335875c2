#include "geometry/body/exact_body.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace underbody::geometry {

namespace {

constexpr double half_pi = std::numbers::pi / 2;
constexpr std::size_t arc_samples = 192;

double square(double v) { return v * v; }

}  // namespace

SideProfile::SideProfile(double foot, double reach, double depth, double edge_radius)
    : depth_(depth), radius_(edge_radius), edge_(foot) {
    const double overhang = reach - foot;
    if (overhang <= depth) {  // a circle with its centre at midplane height, through the foot and (reach, midplane)
        centre_ = (foot * foot + depth * depth - reach * reach) / (2 * (foot - reach));
        semi_ = rise_ = reach - centre_;
        arc_start_ = -std::atan2(depth, foot - centre_);
    } else {  // a quarter of an ellipse, level where it meets the base
        centre_ = foot;
        semi_ = overhang;
        rise_ = depth;
        arc_start_ = -half_pi;
    }
    if (radius_ > 0 && semi_ == rise_) {
        // ball inside the arc and on the base
        edge_centre_ = centre_ + std::sqrt(std::max(0.0, square(semi_ - radius_) - square(depth - radius_)));
        const double angle = std::atan2(depth - radius_, edge_centre_ - centre_);
        arc_start_ = -angle;
        fillet_end_ = half_pi - angle;
        fillet_top_ = depth - semi_ * std::sin(angle);
        edge_ = edge_centre_;
    } else {
        radius_ = 0;
    }
    arcs_.assign(1, 0.0);
    At last = at_parameter(0);
    for (std::size_t i = 1; i <= 2 * arc_samples; ++i) {
        const At next = at_parameter(2.0 * static_cast<double>(i) / (2 * arc_samples));
        arcs_.push_back(arcs_.back() + std::hypot(next.half - last.half, next.height - last.height));
        last = next;
    }
}

// w in [0, 1]: the rounding; in [1, 2]: the arc.
SideProfile::At SideProfile::at_parameter(double w) const {
    if (w < 1) {
        const double angle = w * fillet_end_;
        const double half_sine = std::sin(angle / 2);
        return {edge_centre_ + radius_ * std::sin(angle) + (radius_ > 0 ? 0.0 : edge_ - edge_centre_),
                2 * radius_ * half_sine * half_sine};
    }
    const double angle = arc_start_ * (2 - w);
    const double height = w == 1 && radius_ == 0 ? 0.0 : depth_ + rise_ * std::sin(angle);
    return {centre_ + semi_ * std::cos(angle), std::clamp(height, 0.0, depth_)};
}

SideProfile::At SideProfile::at_arc(double arc) const {
    arc = std::clamp(arc, 0.0, arcs_.back());
    const auto upper = std::upper_bound(arcs_.begin(), arcs_.end(), arc);
    const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(upper - arcs_.begin()), arcs_.size() - 1);
    const double low = arcs_[i - 1], high = arcs_[i];
    const double fraction = high > low ? (arc - low) / (high - low) : 1.0;
    return at_parameter((static_cast<double>(i - 1) + fraction) / arc_samples);
}

double SideProfile::arc_of_height(double height) const {
    double w;
    if (height < fillet_top_) {
        w = 2 * std::asin(std::sqrt(std::clamp(height / (2 * radius_), 0.0, 1.0))) / fillet_end_;
    } else {
        const double angle = std::asin(std::clamp((height - depth_) / rise_, -1.0, 1.0));
        w = 2 - std::clamp(angle / arc_start_, 0.0, 1.0);
    }
    const double position = w * arc_samples;
    const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(position), arcs_.size() - 2);
    return arcs_[i] + (position - static_cast<double>(i)) * (arcs_[i + 1] - arcs_[i]);
}

double SideProfile::half(double height) const {
    if (height < fillet_top_) {
        return edge_centre_ + std::sqrt(std::max(0.0, height * (2 * radius_ - height)));
    }
    const double z = std::min(1.0, (depth_ - height) / rise_);
    return centre_ + semi_ * std::sqrt(std::max(0.0, 1 - z * z));
}

double SideProfile::distance(double half, double height) const {
    if (radius_ > 0) {
        // The rounding owns the wedge of directions of its centre between its two ends.
        const double dx = half - edge_centre_, dz = radius_ - height;
        const double angle = std::atan2(dx, dz);
        if (angle >= 0 && angle < fillet_end_ && dz > 0) {
            return std::hypot(dx, dz) - radius_;
        }
        if (dx < 0 && dz > 0) {
            return -height;  // over the flat base
        }
    }
    // Past its own middle (the other side of the body) the side says nothing.
    const double dx = std::max(0.0, half - centre_), dz = depth_ - height;
    if (semi_ == rise_) {
        return std::hypot(dx, dz) - semi_;
    }
    const double f = square(dx / semi_) + square(dz / rise_) - 1;
    return f / (2 * std::hypot(dx / square(semi_), dz / square(rise_)));
}

ExactBody::ExactBody(const BodyShape& shape, bool tabulated)
    : shape_(shape), a_(shape.length / 2), b_(shape.width / 2), c_(shape.height / 2), depth_(shape.base_depth()) {
    const BodyShape::BaseExtent extent = shape.base_extent();
    taper_ = shape.taper / (extent.nose - extent.tail);
    slope_ = std::tan(shape.base_pitch);
    offset_ = shape.base_offset;
    if (shape.base != BaseKind::ellipse) {
        along_ = SideProfile(-extent.tail, a_, depth_, shape.edge_radius);
        across_ = SideProfile(extent.half_width, b_, depth_, shape.edge_radius);
    }
    if (shape.edge_radius > 0 && tabulated) {
        tabulate_spine();
    }
    highest_fillet_ = std::max(fillet_top(0), fillet_top(half_pi));
    if (shape.base == BaseKind::ellipse_front) {
        cut_centre_ = 0.5 * (ellipsoid_point(0, 0).x - along_.base_half());
    }
    if (!shape.protrusion) {
        return;
    }
    // Profile against the distance d from the axis: d = 0 crest, then a flank down to the base at d = length/2; the
    // blend is an arc below (seen from the body: outside) that touches flank and base.
    const Protrusion& p = *shape.protrusion;
    const double half = p.length / 2, height = p.height, r = p.blend_radius;
    blend_ = r;
    if (p.profile == ProtrusionProfile::rounded) {
        crest_radius_ = (half * half + height * height) / (2 * height);
        crest_centre_ = height - crest_radius_;  // depth of the arc's centre below the base (negative: above it)
        // blend: centre at depth r, at distance crest_radius + r from the arc's centre
        foot_ = std::sqrt(square(crest_radius_ + r) - square(r - crest_centre_));
        flank_end_ = foot_ * crest_radius_ / (crest_radius_ + r);
    } else {
        const double angle = std::atan2(height, half);
        foot_ = half + r * std::tan(angle / 2);
        flank_end_ = foot_ - r * std::sin(angle);
    }
    half_axis_ = protrusion_width(shape) / 2 - foot_;
}

bool ExactBody::cut(Side side) const {
    return shape_.base == BaseKind::rectangle || (shape_.base == BaseKind::ellipse_front && side != Side::front);
}

ExactBody::Spine ExactBody::solved_spine(double t) const {
    // Contact of the ball: its height z (from the centre of the ellipsoid, negative) solves z - r n_z = r - depth.
    const double r = shape_.edge_radius, ct = std::cos(t), st = std::sin(t);
    const double horizontal = std::hypot(ct / a_, st / b_);
    // n_z = (z/c^2)/m with m^2 = (z/c^2)^2 + (1 - z^2/c^2) horizontal^2; d n_z/dz = horizontal^2/(c^2 m^3)
    const double c2 = c_ * c_, h2 = horizontal * horizontal;
    double z = r - depth_, nz = 0;
    double low = -depth_, high = 0;  // z - r n_z grows with z
    for (int i = 0; i < 60; ++i) {
        const double m2 = square(z / c2) + std::max(0.0, 1 - z * z / c2) * h2, m = std::sqrt(m2);
        nz = z / c2 / m;
        const double f = z - r * nz - r + depth_;
        (f < 0 ? low : high) = z;
        const double step = f / std::max(0.1, 1 - r * h2 / (c2 * m2 * m));
        if (std::abs(step) < 4e-16 * c_) {
            break;  // before the bracket, whose end z is
        }
        z = z - step > low && z - step < high ? z - step : 0.5 * (low + high);
    }
    const double s = std::sqrt(1 - square(z / c_));
    const double nh = std::sqrt(std::max(0.0, 1 - nz * nz));
    return {a_ * s * ct - r * nh * ct / (a_ * horizontal), b_ * s * st - r * nh * st / (b_ * horizontal), z + depth_};
}

double base_centre(const BodyShape& shape) { return ExactBody(shape).base_centre(); }

constexpr std::size_t spine_steps = 1024;

void ExactBody::tabulate_spine() {
    spine_table_.reserve(spine_steps + 1);
    for (std::size_t i = 0; i <= spine_steps; ++i) {
        constexpr double step = 1e-4;
        const double t = half_pi * static_cast<double>(i) / spine_steps;
        const Spine here = solved_spine(t), ahead = solved_spine(t + step), back = solved_spine(t - step);
        const double scale = half_pi / spine_steps / (2 * step);
        spine_table_.push_back(
            {here, {scale * (ahead.x - back.x), scale * (ahead.y - back.y), scale * (ahead.height - back.height)}});
    }
}

ExactBody::Spine ExactBody::spine(double t) const {
    // Fold into the first quadrant.
    double folded = std::abs(std::remainder(t, 2 * std::numbers::pi));
    const double sign_y = std::remainder(t, 2 * std::numbers::pi) < 0 ? -1 : 1;
    const double sign_x = folded > half_pi ? -1 : 1;
    folded = sign_x < 0 ? std::numbers::pi - folded : folded;
    if (spine_table_.empty()) {
        const Spine one = solved_spine(folded);
        return {sign_x * one.x, sign_y * one.y, one.height};
    }
    const double position = folded / half_pi * spine_steps;
    const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(position), spine_steps - 1);
    const double w = position - static_cast<double>(i);
    const SpineEntry &low = spine_table_[i], &high = spine_table_[i + 1];
    const auto cubic = [w](double a, double da, double b, double db) {
        const double v = 1 - w;
        return v * v * ((1 + 2 * w) * a + w * da) + w * w * ((3 - 2 * w) * b - v * db);
    };
    return {sign_x * cubic(low.value.x, low.slope.x, high.value.x, high.slope.x),
            sign_y * cubic(low.value.y, low.slope.y, high.value.y, high.slope.y),
            cubic(low.value.height, low.slope.height, high.value.height, high.slope.height)};
}

double ExactBody::fillet_top(double t) const { return shape_.edge_radius > 0 ? spine(t).height : 0.0; }

double ExactBody::highest_fillet() const { return highest_fillet_; }

Vec3 ExactBody::ellipsoid_point(double height, double t) const {
    const double ct = std::cos(t), st = std::sin(t), r = shape_.edge_radius;
    if (r > 0 && height < r) {
        const Spine ball = spine(t);
        if (height < ball.height) {
            const double horizontal = std::hypot(ct / a_, st / b_);
            const double out = std::sqrt(std::max(0.0, height * (2 * r - height))) / horizontal;
            return {ball.x + out * ct / a_, ball.y + out * st / b_, height};
        }
    }
    const double s = std::sqrt(std::max(0.0, 1 - square((height - depth_) / c_)));
    return {a_ * s * ct, b_ * s * st, height};
}

Vec3 ExactBody::bent(const Vec3& p) const {
    if (!is_bent() || p.z >= depth_) {
        return p;
    }
    // What stands below the base moves with it and keeps its shape.
    const double g = square(std::min(1.0, (depth_ - p.z) / depth_));
    const double x = p.x - cut_centre_;
    return {p.x + offset_ * g, p.y * (1 + taper_ * x * g), p.z + slope_ * x * g};
}

Vec3 ExactBody::unbent(const Vec3& p) const {
    if (!is_bent() || p.z >= depth_) {
        return p;
    }
    const double from_base = p.x - offset_ - cut_centre_;
    if (p.z <= slope_ * from_base) {
        return {p.x - offset_, p.y / (1 + taper_ * from_base), p.z - slope_ * from_base};
    }
    // With v = depth - height: v' = v - k v^2, k = slope x / depth^2; where the base is moved x follows v.
    const double bent_v = depth_ - p.z;
    double x = p.x - cut_centre_, v = bent_v;
    for (int i = 0; i < 60; ++i) {
        const double k = slope_ * x / square(depth_), before = v;
        v = 2 * bent_v / (1 + std::sqrt(std::max(0.0, 1 - 4 * k * bent_v)));
        x = p.x - cut_centre_ - offset_ * square(v / depth_);
        if (std::abs(v - before) < 1e-16 * depth_ || offset_ == 0) {
            break;
        }
    }
    const double g = square(v / depth_);
    return {x + cut_centre_, p.y / (1 + taper_ * x * g), depth_ - v};
}

double ExactBody::profile_depth(double d) const {
    d = std::abs(d);
    if (d >= foot_ || !shape_.protrusion) {
        return 0;
    }
    if (d > flank_end_) {
        return blend_ - std::sqrt(std::max(0.0, square(blend_) - square(foot_ - d)));
    }
    const Protrusion& p = *shape_.protrusion;
    if (p.profile == ProtrusionProfile::rounded) {
        return crest_centre_ + std::sqrt(std::max(0.0, square(crest_radius_) - d * d));
    }
    return p.height * (1 - 2 * d / p.length);
}

ExactBody::Foot ExactBody::protrusion_foot() const {
    const Protrusion& p = *shape_.protrusion;
    Foot foot;
    foot.x = shape_.base_x(p.position);
    foot.radius = foot_;
    foot.crest = flank_end_;
    foot.half_axis = half_axis_;
    return foot;
}

double ExactBody::protrusion_depth(double x, double y) const {
    if (!shape_.protrusion) {
        return 0;
    }
    const Foot foot = protrusion_foot();
    return profile_depth(std::hypot(x - foot.x, std::max(0.0, std::abs(y) - foot.half_axis)));
}

double ExactBody::ellipsoid_parameter(const Vec3& p) const {
    double t = std::atan2(p.y / b_, p.x / a_);
    if (shape_.edge_radius == 0 || p.z >= highest_fillet_ || p.z >= fillet_top(t)) {
        return t;
    }
    // Nearest point of the spine: Gauss-Newton, whose factor is the ball's radius over the spine's.
    constexpr double step = 1e-5;
    for (int i = 0; i < 40; ++i) {
        const Spine here = spine(t), ahead = spine(t + step);
        const double dx = (ahead.x - here.x) / step, dy = (ahead.y - here.y) / step;
        const double change = ((p.x - here.x) * dx + (p.y - here.y) * dy) / (dx * dx + dy * dy);
        t += change;
        if (std::abs(change) < 1e-13) {
            break;
        }
    }
    return t;
}

double ExactBody::distance_to_ellipsoid(const Vec3& p) const {
    const Vec3 q = unbent(p);
    if (shape_.edge_radius > 0 && q.z < highest_fillet_) {
        const double r = shape_.edge_radius;
        const double t = ellipsoid_parameter(q);
        const Spine ball = spine(t);
        if (q.z < ball.height) {
            const double out = (q.x - ball.x) * std::cos(t) / a_ + (q.y - ball.y) * std::sin(t) / b_;
            return out < 0 ? -q.z : std::hypot(out / std::hypot(std::cos(t) / a_, std::sin(t) / b_), r - q.z) - r;
        }
    }
    const double z = q.z - depth_;
    const double f = square(q.x / a_) + square(q.y / b_) + square(z / c_) - 1;
    return f / (2 * norm({q.x / (a_ * a_), q.y / (b_ * b_), z / (c_ * c_)}));
}

double ExactBody::distance_to_side(const Vec3& p, Side side) const {
    const Vec3 q = unbent(p);
    const double half = side == Side::port ? std::abs(q.y) : side == Side::front ? q.x : -q.x;
    return profile(side).distance(half, q.z);
}

double ExactBody::distance_to_base(const Vec3& p) const {
    const Vec3 q = unbent(p);
    const double vertical = -(q.z + protrusion_depth(q.x, q.y));
    if (!shape_.protrusion) {
        return vertical;
    }
    const Foot foot = protrusion_foot();
    const double d = std::hypot(q.x - foot.x, std::max(0.0, std::abs(q.y) - foot.half_axis)), step = 1e-6 * foot.radius;
    const double slope = (profile_depth(d + step) - profile_depth(std::max(0.0, d - step))) / (2 * step);
    return vertical / std::hypot(1, slope);
}

}  // namespace underbody::geometry
