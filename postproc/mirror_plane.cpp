#include "postproc/mirror_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "core/text.h"
#include "core/units.h"
#include "postproc/places.h"
#include "postproc/surface_arrays.h"
#include "postproc/vector_math.h"

namespace underbody::postproc {

MirrorPlane mirror_plane_from(const std::string& text) {
    MirrorPlane plane;
    if (text.empty() || text == "none") {
        return plane;
    }
    const auto equals = text.find('=');
    const std::string axis = core::lower_case(core::trimmed(std::string_view(text).substr(0, equals)));
    if (axis.size() != 1 || axis[0] < 'x' || axis[0] > 'z') {
        throw core::UsageError("usage", "'" + text + "' is no symmetry plane", {}, "give its normal axis: --symmetry y, or --symmetry y=0.1");
    }
    plane.axis = axis[0] - 'x';
    if (equals != std::string::npos) {
        plane.at = core::parse_in(text.substr(equals + 1), "m");
    }
    return plane;
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

const double* corner(const SurfaceArrays& surface, Index i) { return surface.points().data() + 3 * surface.connectivity()[static_cast<std::size_t>(i)]; }

/// What there is of a body along the normal of its plane.
class Ends {
public:
    Ends(const std::vector<const SurfaceArrays*>& body, std::size_t axis) : body_(body), axis_(axis) {
        for (const SurfaceArrays* surface : body) {
            for (std::size_t i = 0; i < surface->connectivity().size(); ++i) {
                all_.widen(corner(*surface, static_cast<Index>(i)));
            }
        }
        size_ = norm(plus(all_.upper, all_.lower, -1));
        slack = 1e-3 * size_;
    }

    [[nodiscard]] double low() const { return all_.lower[axis_]; }   ///< m
    [[nodiscard]] double high() const { return all_.upper[axis_]; }  ///< m
    [[nodiscard]] bool empty() const { return !(low() <= high()); }

    /// Do edges of one face alone enclose something at this end? (The rim of an opening elsewhere only touches it.)
    [[nodiscard]] bool open_at(double end) const {
        Places places(1e-6 * size_);
        struct Edge {
            const double *from, *to;
            int faces = 0;
        };
        std::map<std::pair<std::int64_t, std::int64_t>, Edge> edges;
        for (const SurfaceArrays* surface : body_) {
            const auto offsets = surface->offsets();
            for (std::size_t f = 0; f < surface->faces(); ++f) {
                for (Index i = offsets[f]; i < offsets[f + 1]; ++i) {
                    const double* a = corner(*surface, i);
                    const double* b = corner(*surface, i + 1 < offsets[f + 1] ? i + 1 : offsets[f]);
                    if (std::abs(a[axis_] - end) > slack || std::abs(b[axis_] - end) > slack) {
                        continue;
                    }
                    const std::pair<std::int64_t, std::int64_t> ends = std::minmax({places.number(a), places.number(b)});
                    if (ends.first != ends.second) {
                        ++edges.try_emplace(ends, Edge{a, b}).first->second.faces;
                    }
                }
            }
        }
        Bounds rim;
        for (const auto& [ends, edge] : edges) {
            if (edge.faces == 1) {
                rim.widen(edge.from);
                rim.widen(edge.to);
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
    double size_ = 0;
};

/// The end where the plane is, when nobody says.
double end_at_plane(const Ends& ends) {
    const double nearer = std::abs(ends.low()) <= std::abs(ends.high()) ? ends.low() : ends.high();
    if (std::abs(nearer) <= ends.slack) {
        return 0;
    }
    const bool low = ends.open_at(ends.low());
    const bool high = ends.open_at(ends.high());
    return low == high ? nearer : low ? ends.low() : ends.high();
}

}  // namespace

PlacedMirror place_mirror(const MirrorPlane& plane, const std::vector<const SurfaceArrays*>& body, const core::Place& place, core::Problems& problems) {
    if (!plane.is_half()) {
        return {};
    }
    PlacedMirror mirror{plane.axis, plane.at.value_or(0)};
    const Ends ends(body, static_cast<std::size_t>(plane.axis));
    if (ends.empty()) {
        return mirror;
    }
    const std::string axis(1, "xyz"[plane.axis]);
    const auto shown = [&](double at) { return axis + " = " + core::format_number(at, 4) + " m"; };
    const bool beside_zero = ends.low() >= -ends.slack || ends.high() <= ends.slack;
    if (!plane.at && beside_zero) {
        mirror.at = end_at_plane(ends);
        if (mirror.at != 0) {
            problems.push_back({core::Problem::Severity::warning, "the symmetry plane is taken at " + shown(mirror.at) + ", where the surface ends", {}});
        }
    }
    if (ends.low() < mirror.at - ends.slack && ends.high() > mirror.at + ends.slack) {
        throw core::InputError("range", "the surface lies on both sides of " + shown(mirror.at) + ": it is no half model", place, "leave --symmetry away");
    }
    const auto is_at_plane = [&](double end) { return std::abs(end - mirror.at) <= ends.slack; };
    const std::array<double, 2> both = {ends.low(), ends.high()};
    const bool opens_at_plane = std::any_of(both.begin(), both.end(), [&](double end) { return is_at_plane(end) && ends.open_at(end); });
    for (const double end : both) {
        if (plane.at && !opens_at_plane && !is_at_plane(end) && ends.open_at(end)) {
            throw core::InputError("range", "the symmetry plane was said to lie at " + shown(mirror.at) + ", but the surface is open at " + shown(end) + ", where it ends", place,
                                   "--symmetry " + axis + " takes the plane where the surface is open");
        }
    }
    return mirror;
}

}  // namespace underbody::postproc
