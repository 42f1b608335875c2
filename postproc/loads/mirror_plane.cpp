#include "postproc/loads/mirror_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "core/units.h"
#include "postproc/field/rim_edges.h"
#include "postproc/field/surface_arrays.h"
#include "postproc/field/vector_math.h"

namespace underbody::postproc {

MirrorPlane mirror_plane_from(const std::string& text) {
    MirrorPlane plane;
    if (text.empty() || text == "none") {
        return plane;
    }
    const auto equals = text.find('=');
    const std::string axis = core::lower_case(core::trimmed(std::string_view(text).substr(0, equals)));
    if (axis.size() != 1 || axis[0] < 'x' || axis[0] > 'z') {
        throw core::UsageError("usage", "'" + text + "' is no symmetry plane", {},
                               "give its normal axis, option 'symmetry y', or with its place, option 'symmetry y=0.1'");
    }
    plane.axis = axis[0] - 'x';
    if (equals != std::string::npos) {
        plane.at = core::parse_in(text.substr(equals + 1), "m");
    }
    return plane;
}

namespace {

bool is_along(const Vector& direction, std::size_t axis) { return std::abs(direction[axis]) > 0.5 * norm(direction); }

}  // namespace

bool mirrors_motion(std::size_t axis, const Vector& forward, const Vector& up) {
    return is_along(up, axis) || is_along(forward, axis);
}

void check_mirror_lies_along(const MirrorPlane& plane, const Vector& forward, const Vector& up) {
    if (!plane.is_half() || !mirrors_motion(static_cast<std::size_t>(plane.axis), forward, up)) {
        return;
    }
    const auto normal = static_cast<std::size_t>(plane.axis);
    const bool lift = is_along(up, normal);
    const Vector starboard = cross(forward, up);
    const auto side = std::max_element(starboard.begin(), starboard.end(),
                                       [](double a, double b) { return std::abs(a) < std::abs(b); }) -
                      starboard.begin();
    throw core::UsageError("range",
                           std::string("a symmetry plane across '") + "xyz"[normal] + "' mirrors the " +
                               (lift ? "up" : "forward") + " axis: every " + (lift ? "lift" : "drag") +
                               " would be zero",
                           {},
                           std::string("the plane of a half model lies along the vehicle: option 'symmetry ") +
                               "xyz"[side] + "', or other axes for option 'forward' and option 'up'");
}

namespace {

struct Bounds {
    Vector lower, upper;

    Bounds() {
        lower.fill(std::numeric_limits<double>::infinity());
        upper.fill(-std::numeric_limits<double>::infinity());
    }
    void widen(const double* x) {
        for (std::size_t k = 0; k < 3; ++k) {
            lower[k] = std::min(lower[k], x[k]);
            upper[k] = std::max(upper[k], x[k]);
        }
    }
};

const double* node(const SurfaceArrays& surface, Index i) { return surface.points().data() + 3 * i; }

/// What there is of a body along the normal of its plane.
class Ends {
public:
    Ends(const std::vector<const SurfaceArrays*>& body, std::size_t axis) : body_(body), axis_(axis) {
        for (const SurfaceArrays* surface : body) {
            for (const Index used : surface->connectivity()) {
                all_.widen(node(*surface, used));
            }
        }
        size_ = norm(plus(all_.upper, all_.lower, -1));
        slack = 1e-3 * size_;
    }

    [[nodiscard]] double low() const { return all_.lower[axis_]; }   ///< m
    [[nodiscard]] double high() const { return all_.upper[axis_]; }  ///< m
    [[nodiscard]] bool empty() const { return !(low() <= high()); }

    /// Do edges of one face alone enclose something at this end? (The rim of an opening elsewhere only touches it.)
    [[nodiscard]] bool open_at(double end) {
        if (rims_.empty()) {
            joined_along_rims(body_, size_, &rims_);
        }
        Bounds rim;
        for (std::size_t i = 0; i < rims_.size(); ++i) {
            for (const RimEdge& edge : rims_[i]) {
                const double* a = node(*body_[i], edge.a);
                const double* b = node(*body_[i], edge.b);
                if (std::abs(a[axis_] - end) <= slack && std::abs(b[axis_] - end) <= slack) {
                    rim.widen(a);
                    rim.widen(b);
                }
            }
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const bool flat = all_.upper[k] - all_.lower[k] <= slack;
            if (k != axis_ && !flat && !(rim.upper[k] - rim.lower[k] > slack)) {
                return false;
            }
        }
        return true;
    }

    double slack = 0;  ///< m: what lies nearer to each other is in one place

private:
    const std::vector<const SurfaceArrays*>& body_;
    std::size_t axis_;
    Bounds all_;
    std::vector<std::vector<RimEdge>> rims_;
    double size_ = 0;
};

/// The end where the plane is, when nobody says.
double end_at_plane(Ends& ends) {
    const double nearer = std::abs(ends.low()) <= std::abs(ends.high()) ? ends.low() : ends.high();
    if (std::abs(nearer) <= ends.slack) {
        return 0;
    }
    const bool low = ends.open_at(ends.low());
    const bool high = ends.open_at(ends.high());
    return low == high ? nearer : low ? ends.low() : ends.high();
}

}  // namespace

PlacedMirror place_mirror(const MirrorPlane& plane, const std::vector<const SurfaceArrays*>& body,
                          const core::Place& place, core::Problems& problems) {
    if (!plane.is_half()) {
        return {};
    }
    PlacedMirror mirror{plane.axis, plane.at.value_or(0)};
    Ends ends(body, static_cast<std::size_t>(plane.axis));
    if (ends.empty()) {
        return mirror;
    }
    const std::string axis(1, "xyz"[plane.axis]);
    const auto shown = [&](double at) { return axis + " = " + core::format_number(at, 4) + " m"; };
    const bool beside_zero = ends.low() >= -ends.slack || ends.high() <= ends.slack;
    if (!plane.at && beside_zero) {
        mirror.at = end_at_plane(ends);
        if (mirror.at != 0) {
            problems.push_back({core::Problem::Severity::warning,
                                "the symmetry plane is taken at " + shown(mirror.at) + ", where the surface ends",
                                {}});
        }
    }
    if (ends.low() < mirror.at - ends.slack && ends.high() > mirror.at + ends.slack) {
        throw core::InputError("range",
                               "the surface lies on both sides of " + shown(mirror.at) + ": it is no half model", place,
                               "leave option 'symmetry' away");
    }
    const auto is_at_plane = [&](double end) { return std::abs(end - mirror.at) <= ends.slack; };
    const std::array<double, 2> both = {ends.low(), ends.high()};
    const bool opens_at_plane =
        std::any_of(both.begin(), both.end(), [&](double end) { return is_at_plane(end) && ends.open_at(end); });
    for (const double end : both) {
        if (plane.at && !opens_at_plane && !is_at_plane(end) && ends.open_at(end)) {
            throw core::InputError("range",
                                   "the symmetry plane was said to lie at " + shown(mirror.at) +
                                       ", but the surface is open at " + shown(end) + ", where it ends",
                                   place, "option 'symmetry " + axis + "' takes the plane where the surface is open");
        }
    }
    return mirror;
}

}  // namespace underbody::postproc
