// The base with its protrusion and nozzle.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/body/surface_builder.h"

namespace underbody::geometry {

namespace {

using std::numbers::pi;

class BaseMaker {
public:
    BaseMaker(SurfaceBuilder& builder, const Chain& outline) : b_(builder), body_(builder.body), outline_(outline) {}

    void make() {
        make_features();
        make_symmetry_line();
        SurfaceBuilder::Face face;
        face.chains = features_;
        face.chains.push_back(outline_);
        face.chains.insert(face.chains.end(), symmetry_.begin(), symmetry_.end());
        face.seeds = seeds_;
        face.to_plane = [&](std::int32_t i) { return PlanePoint{b_.at(i).x, b_.at(i).y}; };
        face.to_space = [&](const PlanePoint& p) { return on_base(p.u, p.v); };
        face.edge = [&](const PlanePoint& p) { return b_.edge.on_base(p.u, p.v); };
        face.turned = true;
        SurfaceBuilder::Filled filled = b_.fill(face);
        for (std::size_t i = 0; i < filled.triangles.size(); ++i) {
            b_.half.triangles.push_back(filled.triangles[i]);
            b_.half.patch.push_back(filled.label[i]);
        }
        if (body_.shape().nozzle && body_.shape().nozzle->depth > 0) {
            bore();
        }
    }

private:
    [[nodiscard]] Vec3 on_base(double x, double y) const {
        const double depth = body_.protrusion_depth(x, y);
        return {x, y, depth > 0 ? -depth : 0.0};
    }
    [[nodiscard]] auto length() const {
        return [this](const Vec3& p) { return b_.edge.on_base(p.x, p.y); };
    }
    // A point on the line y = 0 that the features and the line share.
    std::int32_t crossing(double x) {
        const std::int32_t point = b_.add(on_base(x, 0));
        crossings_.push_back(point);
        return point;
    }

    void make_features() {
        if (body_.shape().protrusion) {
            const ExactBody::Foot foot = body_.protrusion_foot();
            add_stadium(foot.x, foot.half_axis, foot.radius);
            const bool sharp = body_.shape().protrusion->profile == ProtrusionProfile::sharp;
            if (sharp) {
                const Vec3 end = on_base(foot.x, foot.half_axis);
                features_.push_back(b_.chain(
                    crossing(foot.x), b_.add(end), [&](double w) { return on_base(foot.x, w * foot.half_axis); },
                    length()));
            }
            seeds_.push_back({{foot.x + 0.4 * foot.radius, 0.3 * foot.radius}, protrusion_patch});
            if (sharp) {  // the crest does not part the region, unless it is as long as the axis of a foot of no width
                seeds_.push_back({{foot.x - 0.4 * foot.radius, 0.3 * foot.radius}, protrusion_patch});
            }
        }
        if (body_.shape().nozzle) {
            const double x = body_.shape().base_x(body_.shape().nozzle->position),
                         radius = body_.shape().nozzle->diameter / 2;
            add_stadium(x, 0, radius);
            rim_ = features_.back();
            seeds_.push_back({{x, 0.4 * radius}, nozzle_patch});
        }
    }

    // Half of two half circles about (x, +-axis) and the lines between them.
    void add_stadium(double x, double axis, double radius) {
        const double whole = 2 * axis + pi * radius;
        const auto curve = [this, x, axis, radius, whole](double w) {
            const double way = w * whole;
            if (way <= axis) {
                return on_base(x + radius, way);
            }
            if (way >= whole - axis) {
                return on_base(x - radius, whole - way);
            }
            const double angle = (way - axis) / radius;
            const Vec3 p = on_base(x + radius * std::cos(angle), axis + radius * std::sin(angle));
            return Vec3{p.x, p.y, 0};
        };
        const std::int32_t fore = crossing(x + radius), aft = crossing(x - radius);
        b_.straight[static_cast<std::size_t>(fore)].z = b_.straight[static_cast<std::size_t>(aft)].z = 0;
        features_.push_back(b_.chain(fore, aft, curve, length(), 6));
    }

    void make_symmetry_line() {
        std::vector<std::int32_t> stops{outline_.front()};
        std::sort(crossings_.begin(), crossings_.end(),
                  [&](std::int32_t i, std::int32_t j) { return b_.at(i).x > b_.at(j).x; });
        stops.insert(stops.end(), crossings_.begin(), crossings_.end());
        stops.push_back(outline_.back());
        for (std::size_t i = 1; i < stops.size(); ++i) {
            const double from = b_.at(stops[i - 1]).x, to = b_.at(stops[i]).x;
            symmetry_.push_back(b_.chain(
                stops[i - 1], stops[i], [&](double w) { return on_base(from + w * (to - from), 0); }, length()));
        }
    }

    // Lifts what lies inside the rim to the end of the bore and puts a wall between.
    void bore() {
        const double depth = body_.shape().nozzle->depth;
        std::vector<std::int32_t> lifted(b_.straight.size(), -1);
        const std::vector<char> on_rim = [&] {
            std::vector<char> flags(b_.straight.size(), 0);
            for (const std::int32_t i : rim_) {
                flags[static_cast<std::size_t>(i)] = 1;
            }
            return flags;
        }();
        const auto lift = [&](std::int32_t i, double height) { return Vec3{b_.at(i).x, b_.at(i).y, height}; };
        for (std::size_t t = 0; t < b_.half.triangles.size(); ++t) {
            if (b_.half.patch[t] != nozzle_patch) {
                continue;
            }
            for (std::int32_t& p : b_.half.triangles[t]) {
                std::int32_t& number = lifted[static_cast<std::size_t>(p)];
                if (number < 0) {
                    number = p;
                    if (on_rim[static_cast<std::size_t>(p)] != 0) {
                        number = b_.add(lift(p, depth));
                    } else {
                        b_.straight[static_cast<std::size_t>(p)].z = depth;
                        b_.half.points[static_cast<std::size_t>(p)] = body_.bent(b_.at(p));
                    }
                }
                p = number;
            }
        }
        const int levels = std::max(1, static_cast<int>(std::lround(depth / b_.edge.nozzle())));
        Chain below = rim_;
        for (int level = 1; level <= levels; ++level) {
            Chain above;
            for (const std::int32_t p : rim_) {
                above.push_back(level == levels ? lifted[static_cast<std::size_t>(p)]
                                                : b_.add(lift(p, depth * level / levels)));
            }
            // Water is inside the bore: the chains run the other way than on the hull.
            fill_strip(b_.half, Chain(below.rbegin(), below.rend()), Chain(above.rbegin(), above.rend()), bore_patch);
            below = above;
        }
    }

    SurfaceBuilder& b_;
    const ExactBody& body_;
    const Chain& outline_;
    std::vector<Chain> features_, symmetry_;
    std::vector<PatchProblem::Seed> seeds_;
    std::vector<std::int32_t> crossings_;
    Chain rim_;
};

// The flat base of an uncut ellipsoid by shrunken copies of its outline.
void add_plain_base(SurfaceBuilder& builder, Chain outer) {
    const ExactBody& body = builder.body;
    const double edge = builder.edge.base();
    const double nose = body.ellipsoid_point(0, 0).x, side = body.ellipsoid_point(0, pi / 2).y;
    const int rings = std::max(1, static_cast<int>(std::lround(0.5 * (nose + side) / (0.8660254 * edge))));
    for (int ring = rings - 1; ring >= 0; --ring) {
        const double scale = static_cast<double>(ring) / rings;
        Chain inner;
        if (ring == 0) {
            inner = {builder.add({0, 0, 0})};
        } else {
            std::vector<Vec3> points = along(
                [&](double w) {
                    const Vec3 p = body.ellipsoid_point(0, pi * w);
                    return Vec3{scale * p.x, w == 0 || w == 1 ? 0.0 : scale * p.y, 0};
                },
                [&](const Vec3&) { return edge; }, 2);
            inner = builder.add(points);
        }
        fill_strip(builder.half, inner, outer, base_patch);
        outer = std::move(inner);
    }
}

}  // namespace

void add_base(SurfaceBuilder& builder, const Chain& outline) {
    const BodyShape& shape = builder.body.shape();
    if (shape.base == BaseKind::ellipse && !shape.protrusion && !shape.nozzle &&
        builder.edge.at_height(0) >= builder.edge.base()) {
        add_plain_base(builder, outline);
    } else {
        BaseMaker(builder, outline).make();
    }
}

}  // namespace underbody::geometry
