// The hull below the midplane of a body whose sides are cut: faces between creases that are found first.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/body/surface_builder.h"

namespace underbody::geometry {

namespace {

using std::numbers::pi;

// A root of f between two heights where it changes its sign.
template <class F>
double bisect(const F& f, double low, double high) {
    const bool rising = f(low) < 0;
    for (int i = 0; i < 200; ++i) {
        const double mid = 0.5 * (low + high);
        if (mid == low || mid == high) {
            break;
        }
        ((f(mid) < 0) == rising ? low : high) = mid;
    }
    return 0.5 * (low + high);
}

class CutHull {
public:
    explicit CutHull(SurfaceBuilder& builder) : b_(builder), body_(builder.body), depth_(builder.body.depth()) {}

    LowerHull make();

private:
    // One end of the port side: where it meets the cut in front or aft, and the ellipsoid between them.
    struct Corner {
        Side end = Side::front;
        int sign = 1;  // of x
        struct Piece {
            bool open = true;  // the ellipsoid shows between the sides
            double low = 0, high = 0;
            Chain on_end, on_port;  // creases, upward; the same chain when closed
        };
        std::vector<Piece> pieces;
        std::int32_t base_end = -1,
                     base_port = -1;  // points of the base outline; the same when the corner is closed there
        Chain arc;                    // of the base outline between them, from nose to tail
    };

    [[nodiscard]] double end_half(Side end, double u) const { return body_.profile(end).half(u); }
    [[nodiscard]] double port_half(double u) const { return body_.profile(Side::port).half(u); }
    // x of the ellipsoid where its outline has the given y; nothing when it is narrower. Likewise y for a given |x|.
    [[nodiscard]] std::optional<double> x_at(double u, double y) const;
    [[nodiscard]] std::optional<double> y_at(double u, double x) const;
    [[nodiscard]] double parameter_at_x(double u, double x) const;
    // Positive where the corner of the two sides stands outside the ellipsoid.
    [[nodiscard]] double openness(Side end, double u) const;
    // Height where a side leaves the ellipsoid: the midplane when it is inside all the way up.
    [[nodiscard]] double tip_height(Side side) const;

    [[nodiscard]] Vec3 end_crease(const Corner& corner, double u) const;
    [[nodiscard]] Vec3 port_crease(const Corner& corner, double u) const;
    [[nodiscard]] Vec3 closed_crease(const Corner& corner, double u) const {
        return {corner.sign * end_half(corner.end, u), port_half(u), u};
    }

    std::vector<double> openings(Side end) const;
    void make_corner(Corner& corner);
    void make_tips();
    void make_creases(Corner& corner);
    void make_symmetry_lines();
    void make_outline(LowerHull& result);
    void make_midplane(LowerHull& result);
    void fill_end(const Corner& corner, const Chain& base, const Chain& middle);
    void fill_port();
    void fill_ellipsoid(const LowerHull& result);
    void fill_ellipsoid_piece(const std::vector<Chain>& chains);

    SurfaceBuilder& b_;
    const ExactBody& body_;
    double depth_;
    Corner front_{Side::front, 1, {}, -1, -1, {}}, back_{Side::back, -1, {}, -1, -1, {}};
    double port_tip_height_ = 0, front_tip_height_ = 0, back_tip_height_ = 0;
    std::int32_t port_tip_ = -1, front_tip_ = -1, back_tip_ = -1, nose_ = -1, tail_ = -1;
    std::int32_t base_nose_ = -1, base_tail_ = -1;
    Chain front_line_, front_upper_, back_line_, back_upper_;  // in the plane y = 0: on the side, on the ellipsoid
    Chain front_base_, port_base_, back_base_;
    // plane of the ellipsoid piece
    std::vector<double> plane_height_, plane_radius_;
    [[nodiscard]] double radius_of(double height) const;
    [[nodiscard]] double height_of(double radius) const;
    void make_plane();
};

std::optional<double> CutHull::x_at(double u, double y) const {
    if (y >= body_.ellipsoid_point(u, pi / 2).y) {
        return {};
    }
    if (body_.highest_fillet() <= u) {
        const double s = body_.ellipsoid_point(u, pi / 2).y / body_.semi_y(), q = y / (s * body_.semi_y());
        return s * body_.semi_x() * std::sqrt(std::max(0.0, 1 - q * q));
    }
    return body_.ellipsoid_point(u, bisect([&](double t) { return body_.ellipsoid_point(u, t).y - y; }, 0, pi / 2)).x;
}

double CutHull::parameter_at_x(double u, double x) const {
    return bisect([&](double t) { return body_.ellipsoid_point(u, t).x - x; }, 0, pi / 2);
}

std::optional<double> CutHull::y_at(double u, double x) const {
    if (x >= body_.ellipsoid_point(u, 0).x) {
        return {};
    }
    if (body_.highest_fillet() <= u) {
        const double s = body_.ellipsoid_point(u, 0).x / body_.semi_x(), p = x / (s * body_.semi_x());
        return s * body_.semi_y() * std::sqrt(std::max(0.0, 1 - p * p));
    }
    return body_.ellipsoid_point(u, parameter_at_x(u, x)).y;
}

double CutHull::openness(Side end, double u) const {
    const std::optional<double> x = x_at(u, port_half(u));
    return x ? end_half(end, u) - *x : 1.0;
}

double CutHull::tip_height(Side side) const {
    const double t = side == Side::port ? pi / 2 : 0;
    const auto inside = [&](double u) {
        const Vec3 p = body_.ellipsoid_point(u, t);
        return (side == Side::port ? p.y : p.x) - body_.profile(side).half(u);
    };
    // Both are vertical at the midplane, so there the curvatures decide: look a little below it, where the difference
    // (third order) still stands out of rounding.
    const double near = 0.98 * depth_;
    if (inside(near) > 0) {
        return depth_;
    }
    // Above the rounding of the edge, unless the side has left the ellipsoid in it already.
    const double low = std::min(body_.highest_fillet(), 0.5 * near);
    const auto outside = [&](double u) { return -inside(u); };
    return inside(low) > 0 ? bisect(outside, low, near) : bisect(outside, 0, low);
}

Vec3 CutHull::end_crease(const Corner& corner, double u) const {
    const double x = end_half(corner.end, u);
    return {corner.sign * x, y_at(u, x).value_or(0.0), u};
}

Vec3 CutHull::port_crease(const Corner& corner, double u) const {
    const double y = port_half(u);
    return {corner.sign * x_at(u, y).value_or(0.0), y, u};
}

// Heights where the corner opens or closes.
std::vector<double> CutHull::openings(Side end) const {
    const double tolerance = 1e-9 * body_.semi_x();
    const double top = std::min(port_tip_height_, end == Side::front ? front_tip_height_ : back_tip_height_);
    std::vector<double> found;
    constexpr int samples = 400;
    double last = openness(end, 0), last_u = 0;
    for (int i = 1; i <= samples; ++i) {
        const double w = static_cast<double>(i) / samples, u = top * w * w;
        const double next = openness(end, u);
        if (std::abs(last) > tolerance && last * next < 0) {
            found.push_back(bisect([&](double v) { return openness(end, v); }, last_u, u));
        }
        last = next;
        last_u = u;
    }
    return found;
}

void CutHull::make_corner(Corner& corner) {
    const double tolerance = 1e-9 * body_.semi_x();
    if (!body_.cut(corner.end)) {
        corner.base_port = b_.add(port_crease(corner, 0));
        corner.pieces.push_back({true, 0, port_tip_height_, {}, {}});
        return;
    }
    const double at_base = openness(corner.end, 0);
    const std::vector<double> heights = openings(corner.end);
    // The state above the last change is open; count down from there.
    bool open = heights.size() % 2 == 0;
    double low = 0;
    for (std::size_t i = 0; i <= heights.size(); ++i) {
        const double high = i < heights.size() ? heights[i] : depth_;
        corner.pieces.push_back({open, low, high, {}, {}});
        low = high;
        open = !open;
    }
    if (corner.pieces.front().open && at_base > tolerance) {
        corner.base_end = b_.add(end_crease(corner, 0));
        corner.base_port = b_.add(port_crease(corner, 0));
    } else {
        corner.base_end = corner.base_port = b_.add(closed_crease(corner, 0));
    }
}

void CutHull::make_tips() {
    port_tip_height_ = tip_height(Side::port);
    front_tip_height_ = body_.cut(Side::front) ? tip_height(Side::front) : 0;
    back_tip_height_ = tip_height(Side::back);
    nose_ = b_.add({body_.semi_x(), 0, depth_});
    tail_ = b_.add({-body_.semi_x(), 0, depth_});
    const auto tip = [&](double height, const Vec3& p, std::int32_t at_midplane) {
        return height == depth_ && at_midplane >= 0 ? at_midplane : b_.add(p);
    };
    port_tip_ = tip(port_tip_height_, {0, port_half(port_tip_height_), port_tip_height_}, -1);
    back_tip_ = tip(back_tip_height_, {-end_half(Side::back, back_tip_height_), 0, back_tip_height_}, tail_);
    if (body_.cut(Side::front)) {
        front_tip_ = tip(front_tip_height_, {end_half(Side::front, front_tip_height_), 0, front_tip_height_}, nose_);
        base_nose_ = b_.add({end_half(Side::front, 0), 0, 0});
    } else {
        base_nose_ = b_.add({body_.ellipsoid_point(0, 0).x, 0, 0});
    }
    base_tail_ = b_.add({-end_half(Side::back, 0), 0, 0});
}

void CutHull::make_creases(Corner& corner) {
    const double end_tip = corner.end == Side::front ? front_tip_height_ : back_tip_height_;
    // Upward; the parameter crowds where a curve begins or ends level (at the base, at a tip).
    const auto heights = [](double low, double high) {
        return [low, high](double w) { return low + (high - low) * (0.5 - 0.5 * std::cos(pi * w)); };
    };
    std::int32_t below_end = corner.base_end, below_port = corner.base_port;
    for (std::size_t i = 0; i < corner.pieces.size(); ++i) {
        Corner::Piece& piece = corner.pieces[i];
        const bool last = i + 1 == corner.pieces.size();
        const std::int32_t meeting = last ? -1 : b_.add(closed_crease(corner, piece.high));
        if (!piece.open) {
            const auto u = heights(piece.low, piece.high);
            piece.on_end = piece.on_port =
                b_.chain(below_end, meeting, [&](double w) { return closed_crease(corner, u(w)); });
        } else {
            if (body_.cut(corner.end)) {
                const auto u = heights(piece.low, last ? end_tip : piece.high);
                piece.on_end =
                    b_.chain(below_end, last ? (corner.end == Side::front ? front_tip_ : back_tip_) : meeting,
                             [&](double w) { return end_crease(corner, u(w)); });
            }
            const auto u = heights(piece.low, last ? port_tip_height_ : piece.high);
            piece.on_port =
                b_.chain(below_port, last ? port_tip_ : meeting, [&](double w) { return port_crease(corner, u(w)); });
        }
        below_end = below_port = meeting;
    }
}

void CutHull::make_symmetry_lines() {
    const auto on_side = [&](Side side, std::int32_t from, std::int32_t to, double height) {
        const SideProfile& profile = body_.profile(side);
        const double top = profile.arc_of_height(height), sign = side == Side::front ? 1 : -1;
        return b_.chain(from, to, [&profile, top, sign](double w) {
            const SideProfile::At at = profile.at_arc(w * top);
            return Vec3{sign * at.half, 0, at.height};
        });
    };
    const auto on_ellipsoid = [&](std::int32_t from, std::int32_t to, double low, double sign) {
        return b_.chain(from, to, [&](double w) {
            const double u = low + (depth_ - low) * (0.5 - 0.5 * std::cos(pi * w));
            return Vec3{sign * body_.ellipsoid_point(u, 0).x, 0, u};
        });
    };
    if (body_.cut(Side::front)) {
        front_line_ = on_side(Side::front, base_nose_, front_tip_, front_tip_height_);
        if (front_tip_ != nose_) {
            front_upper_ = on_ellipsoid(front_tip_, nose_, front_tip_height_, 1);
        }
    } else {
        front_upper_ = on_ellipsoid(base_nose_, nose_, 0, 1);
    }
    back_line_ = on_side(Side::back, base_tail_, back_tip_, back_tip_height_);
    if (back_tip_ != tail_) {
        back_upper_ = on_ellipsoid(back_tip_, tail_, back_tip_height_, -1);
    }
}

void CutHull::make_outline(LowerHull& result) {
    const auto line = [&](std::int32_t from, std::int32_t to) {
        const Vec3 p = b_.at(from), q = b_.at(to);
        return b_.chain(from, to, [p, q](double w) { return p + w * (q - p); });
    };
    const auto arc = [&](std::int32_t from, std::int32_t to) {
        const double t0 = body_.ellipsoid_parameter(b_.at(from)), t1 = body_.ellipsoid_parameter(b_.at(to));
        return b_.chain(from, to, [this, t0, t1](double w) { return body_.ellipsoid_point(0, t0 + w * (t1 - t0)); });
    };
    if (body_.cut(Side::front)) {
        front_base_ = line(base_nose_, front_.base_end);
        if (front_.base_end != front_.base_port) {
            front_.arc = arc(front_.base_end, front_.base_port);
        }
    } else {
        front_.arc = arc(base_nose_, front_.base_port);
    }
    port_base_ = line(front_.base_port, back_.base_port);
    if (back_.base_end != back_.base_port) {
        back_.arc = arc(back_.base_port, back_.base_end);
    }
    back_base_ = line(back_.base_end, base_tail_);
    for (const Chain* part : {&front_base_, &front_.arc, &port_base_, &back_.arc, &back_base_}) {
        for (const std::int32_t p : *part) {
            if (result.base_outline.empty() || result.base_outline.back() != p) {
                result.base_outline.push_back(p);
            }
        }
    }
}

void CutHull::make_midplane(LowerHull& result) {
    const bool touches = port_tip_height_ == depth_;
    const std::int32_t port = touches ? port_tip_ : b_.add({0, body_.semi_y(), depth_});
    const auto quarter = [&](std::int32_t from, std::int32_t to, double start) {
        return b_.chain(from, to,
                        [this, start](double w) { return body_.ellipsoid_point(depth_, start + w * pi / 2); });
    };
    result.midplane = quarter(nose_, port, 0);
    const Chain aft = quarter(port, tail_, pi / 2);
    result.midplane.insert(result.midplane.end(), aft.begin() + 1, aft.end());
}

void CutHull::fill_end(const Corner& corner, const Chain& base, const Chain& middle) {
    const SideProfile& profile = body_.profile(corner.end);
    const double sign = corner.sign;
    SurfaceBuilder::Face face;
    face.chains = {base, middle};
    for (const Corner::Piece& piece : corner.pieces) {
        face.chains.push_back(piece.on_end);
    }
    face.to_plane = [&](std::int32_t i) { return PlanePoint{b_.at(i).y, profile.arc_of_height(b_.at(i).z)}; };
    face.to_space = [&profile, sign](const PlanePoint& p) {
        const SideProfile::At at = profile.at_arc(p.v);
        return Vec3{sign * at.half, p.u, at.height};
    };
    face.edge = [&](const PlanePoint& p) { return b_.edge.at_height(profile.at_arc(p.v).height); };
    face.turned = corner.sign < 0;
    b_.fill(face, hull_patch);
}

void CutHull::fill_port() {
    const SideProfile& profile = body_.profile(Side::port);
    SurfaceBuilder::Face face;
    face.chains = {port_base_};
    for (const Corner* corner : {&front_, &back_}) {
        for (const Corner::Piece& piece : corner->pieces) {
            face.chains.push_back(piece.on_port);
        }
    }
    face.to_plane = [&](std::int32_t i) { return PlanePoint{b_.at(i).x, profile.arc_of_height(b_.at(i).z)}; };
    face.to_space = [&profile](const PlanePoint& p) {
        const SideProfile::At at = profile.at_arc(p.v);
        return Vec3{p.u, at.half, at.height};
    };
    face.edge = [&](const PlanePoint& p) { return b_.edge.at_height(profile.at_arc(p.v).height); };
    face.turned = true;
    b_.fill(face, hull_patch);
}

// The ellipsoid as polar coordinates (radius of its stereographic projection as a unit sphere, t): conformal but for
// the axes' ratio. Below the top of the rounding the radius goes on in proportion to the way.
void CutHull::make_plane() {
    const double top = body_.highest_fillet();
    if (top <= 0) {
        return;
    }
    const auto& ascent = b_.edge.ascent();
    const double s_top = (top - depth_) / body_.semi_z();
    const double radius_top = std::sqrt((1 + s_top) / (1 - s_top));
    const double scale =
        2 / (1 + radius_top * radius_top) * std::cbrt(body_.semi_x() * body_.semi_y() * body_.semi_z());
    const double way_top = b_.edge.way(top);
    for (std::size_t i = 0; i < ascent.height.size() && ascent.height[i] < top; ++i) {
        plane_height_.push_back(ascent.height[i]);
        plane_radius_.push_back(radius_top - (way_top - ascent.way[i]) / scale);
    }
    plane_height_.push_back(top);
    plane_radius_.push_back(radius_top);
    const double offset = std::min(0.0, plane_radius_.front() - 0.1 * radius_top);
    for (std::size_t i = 0; offset < 0 && i < plane_radius_.size(); ++i) {
        plane_radius_[i] =
            plane_radius_[i] - offset * (1 - static_cast<double>(i) / static_cast<double>(plane_radius_.size() - 1));
    }
}

double interpolated(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto upper = std::upper_bound(x.begin(), x.end(), at);
    const std::size_t i = std::clamp<std::size_t>(static_cast<std::size_t>(upper - x.begin()), 1, x.size() - 1);
    return y[i - 1] + (at - x[i - 1]) / (x[i] - x[i - 1]) * (y[i] - y[i - 1]);
}

double CutHull::radius_of(double height) const {
    if (!plane_height_.empty() && height < plane_height_.back()) {
        return interpolated(plane_height_, plane_radius_, height);
    }
    const double s = (height - depth_) / body_.semi_z();
    return std::sqrt((1 + s) / (1 - s));
}

double CutHull::height_of(double radius) const {
    if (!plane_height_.empty() && radius < plane_radius_.back()) {
        return std::max(0.0, interpolated(plane_radius_, plane_height_, radius));
    }
    const double square = radius * radius;
    return std::max(0.0, depth_ + body_.semi_z() * (square - 1) / (square + 1));
}

void CutHull::fill_ellipsoid_piece(const std::vector<Chain>& chains) {
    SurfaceBuilder::Face face;
    for (const Chain& chain : chains) {
        if (!chain.empty()) {
            face.chains.push_back(chain);
        }
    }
    face.to_plane = [&](std::int32_t i) {
        const Vec3& p = b_.at(i);
        const double radius = radius_of(p.z);
        if (p.y == 0) {
            return PlanePoint{p.x > 0 ? radius : -radius, 0};
        }
        const double t = body_.ellipsoid_parameter(p);
        return PlanePoint{radius * std::cos(t), radius * std::sin(t)};
    };
    face.to_space = [this](const PlanePoint& p) {
        const double height = height_of(std::hypot(p.u, p.v));
        return body_.ellipsoid_point(height, std::atan2(p.v, p.u));
    };
    face.edge = [this, space = face.to_space](const PlanePoint& p) {
        const double step = 1e-4;
        const Vec3 here = space(p);
        const Vec3 along_u = space({p.u + step, p.v}) - here, along_v = space({p.u, p.v + step}) - here;
        return b_.edge.at_height(here.z) * step / std::sqrt(norm(cross(along_u, along_v)));
    };
    face.turned = true;
    b_.fill(face, hull_patch);
}

void CutHull::fill_ellipsoid(const LowerHull& result) {
    make_plane();
    const bool split = port_tip_height_ == depth_;
    std::vector<Chain> whole;
    for (Corner* corner : {&front_, &back_}) {
        const bool front = corner == &front_;
        for (std::size_t i = 0; i < corner->pieces.size(); ++i) {
            const Corner::Piece& piece = corner->pieces[i];
            if (!piece.open) {
                continue;
            }
            std::vector<Chain> chains{piece.on_end, piece.on_port};
            if (i == 0) {
                chains.push_back(corner->arc);
            }
            if (i + 1 < corner->pieces.size()) {
                fill_ellipsoid_piece(chains);
                continue;
            }
            chains.push_back(front ? front_upper_ : back_upper_);
            if (!split) {
                whole.insert(whole.end(), chains.begin(), chains.end());
                continue;
            }
            const auto port = std::find(result.midplane.begin(), result.midplane.end(), port_tip_);
            chains.push_back(front ? Chain(result.midplane.begin(), port + 1) : Chain(port, result.midplane.end()));
            fill_ellipsoid_piece(chains);
        }
    }
    if (!split) {
        whole.push_back(result.midplane);
        fill_ellipsoid_piece(whole);
    }
}

LowerHull CutHull::make() {
    LowerHull result;
    make_tips();
    make_corner(front_);
    make_corner(back_);
    make_creases(front_);
    make_creases(back_);
    make_symmetry_lines();
    make_outline(result);
    make_midplane(result);
    if (body_.cut(Side::front)) {
        fill_end(front_, front_base_, front_line_);
    }
    fill_end(back_, back_base_, back_line_);
    fill_port();
    fill_ellipsoid(result);
    return result;
}

}  // namespace

LowerHull add_cut_hull(SurfaceBuilder& builder) { return CutHull(builder).make(); }

}  // namespace underbody::geometry
