#include "geometry/blocks/block_mesh.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.h"
#include "core/text.h"
#include "geometry/blocks/block_layout.h"
#include "geometry/water/above_ground.h"

namespace underbody::geometry {

namespace {

using std::numbers::pi;
using Index = std::int32_t;

enum PatchIndex : Index {
    base_boundary = 0,
    hull_boundary,
    protrusion_boundary,
    nozzle_boundary,
    bore_boundary,
    plate_boundary,
    ground_patch,
    symmetry_patch,
    far_patch
};
constexpr Index body_patches = ground_patch;

/// Semi-axis, speed and viscosity for which the sizes were found.
constexpr double usual_size = 0.0878736, usual_speed = 0.5, usual_viscosity = 1e-6;
/// For the estimate of y+.
constexpr double friction = 0.005;

BlockCounts counts_for(MeshDensity density) {
    BlockCounts c;
    switch (density) {
        case MeshDensity::draft:
            c = {{7, 7, 1.2e-3, 0}, 9, 8, 8, 17, 9, 2, 1.3e-4, 1.6e-4};
            break;
        case MeshDensity::coarse:
            c = {{10, 9, 0.8e-3, 0}, 13, 10, 10, 22, 13, 3, 1.0e-4, 1.2e-4};
            break;
        case MeshDensity::medium:
            c = {{14, 13, 0.5e-3, 0}, 18, 12, 13, 28, 18, 4, 0.7e-4, 0.9e-4};
            break;
        case MeshDensity::fine:
            c = {{20, 18, 0.35e-3, 0}, 26, 16, 18, 38, 25, 5, 0.45e-4, 0.6e-4};
            break;
    }
    return c;
}

/// Ids of points of a block, [a][b][c].
class Ids {
public:
    Ids(int na, int nb, int nc)
        : nb_(nb),
          nc_(nc),
          ids_(static_cast<std::size_t>(na) * static_cast<std::size_t>(nb) * static_cast<std::size_t>(nc), -1) {}
    Index& operator()(int a, int b, int c) {
        return ids_[(static_cast<std::size_t>(a) * static_cast<std::size_t>(nb_) + static_cast<std::size_t>(b)) *
                        static_cast<std::size_t>(nc_) +
                    static_cast<std::size_t>(c)];
    }

private:
    int nb_, nc_;
    std::vector<Index> ids_;
};

double six_volumes(const Hexahedron& h, const std::vector<Vec3>& points) {
    const auto p = [&](std::size_t c) -> const Vec3& { return points[static_cast<std::size_t>(h[c])]; };
    const Vec3 u = p(1) + p(2) + p(5) + p(6) - p(0) - p(3) - p(4) - p(7);
    const Vec3 v = p(2) + p(3) + p(6) + p(7) - p(0) - p(1) - p(4) - p(5);
    const Vec3 w = p(4) + p(5) + p(6) + p(7) - p(0) - p(1) - p(2) - p(3);
    return dot(cross(u, v), w);
}

class Builder {
public:
    Builder(const ExactBody& body, const BlockMeshOptions& options, core::Progress& progress)
        : body_(body),
          section_(body),
          options_(options),
          progress_(progress),
          scale_(section_.largest() / usual_size),
          layout_(section_, counts(), options.placement.gap, scale_),
          rim_(rim_azimuths(section_, layout_.counts().base)) {}

    BlockMesh make() {
        hex_.patch_names = {"base",       "hull",   "protrusion", "nozzle",  "nozzle_bore",
                            "tail_plate", "ground", "symmetry",   "farfield"};
        hex_.sheet = plate_boundary;
        add_gap();
        add_bore();
        progress_.check();
        add_flank();
        add_outward();
        add_outer();
        add_top();
        progress_.check();
        if (options_.half) {
            name_symmetry();
        } else {
            add_mirror_image();
        }
        BlockMesh made;
        place();
        made.smallest_clearance = clearance();
        progress_.check();
        made.mesh = faces_of(hex_);
        progress_.check();
        for (const auto& patch : made.mesh.patches) {
            if (patch.name != "ground" && patch.name != "symmetry" && patch.name != "farfield") {
                made.walls.push_back(patch.name);
            }
        }
        std::vector<std::string> resolved = made.walls;  // the plate has no fine layers
        std::erase(resolved, "tail_plate");
        made.quality = measure(made.mesh, resolved);
        made.cells_in_gap = layout_.counts().down();
        made.tail_plate_area = plate_area_;
        made.far_volume = layout_.far_volume() / (options_.half ? 2 : 1);
        made.wall_units_mean =
            made.quality.wall_distance_mean * options_.speed * std::sqrt(friction / 2) / options_.kinematic_viscosity;
        return made;
    }

private:
    BlockCounts counts() const {
        BlockCounts c = counts_for(options_.density);
        c.base.rim_size *= scale_;
        c.base.core_size = 1.06 * 0.5 * layout_size() / c.base.across;
        // Wall units go with speed and viscosity, about.
        const double thinner = std::clamp(
            std::pow(usual_speed / options_.speed, 0.9) * std::pow(options_.kinematic_viscosity / usual_viscosity, 0.9),
            0.02, 20.0);
        c.first *= thinner;
        c.first_ground *= thinner;
        return c;
    }
    double layout_size() const { return section_.rim(0); }

    Index add(const Vec3& p) {
        hex_.points.push_back(p);
        return static_cast<Index>(hex_.points.size()) - 1;
    }
    /// From the scaled plane to the axes of the body; z over the ground.
    Vec3 space(const Point2& p, double z) const { return {p.x * section_.to_x(), p.y * section_.to_y(), z}; }
    /// A point of a line at a rim's azimuth.
    Vec3 turned(const Point2& p, std::size_t m) const {
        const bool on_middle = m == 0 || m + 1 == rim_.azimuth.size();
        const double azimuth = rim_.azimuth[m];
        return space(
            {p.x * (on_middle ? (m == 0 ? 1.0 : -1.0) : std::cos(azimuth)), on_middle ? 0 : p.x * std::sin(azimuth)},
            p.y);
    }
    [[nodiscard]] int last_azimuth() const { return static_cast<int>(rim_.azimuth.size()) - 1; }

    /// Cells since `first` all turn the same way: that of most volume.
    void orient(std::size_t first) {
        double sum = 0;
        for (std::size_t c = first; c < hex_.cells.size(); ++c) {
            sum += six_volumes(hex_.cells[c], hex_.points) > 0 ? 1 : -1;
        }
        for (std::size_t c = first; sum < 0 && c < hex_.cells.size(); ++c) {
            Hexahedron& h = hex_.cells[c];
            h = {h[4], h[5], h[6], h[7], h[0], h[1], h[2], h[3]};
        }
    }

    void add_block(Ids& id, int na, int nb, int nc) {
        const std::size_t first = hex_.cells.size();
        for (int a = 0; a + 1 < na; ++a) {
            for (int b = 0; b + 1 < nb; ++b) {
                for (int c = 0; c + 1 < nc; ++c) {
                    hex_.cells.push_back({id(a, b, c), id(a + 1, b, c), id(a + 1, b + 1, c), id(a, b + 1, c),
                                          id(a, b, c + 1), id(a + 1, b, c + 1), id(a + 1, b + 1, c + 1),
                                          id(a, b + 1, c + 1)});
                }
            }
        }
        orient(first);
    }

    void name(Index a, Index b, Index c, Index d, Index patch) { hex_.named.push_back({{a, b, c, d}, patch}); }

    /// Columns over a grid: ids[point][level].
    void add_columns(const PlaneGrid& grid, Ids& id, int levels) {
        const std::size_t first = hex_.cells.size();
        for (const auto& q : grid.quads) {
            for (int k = 0; k + 1 < levels; ++k) {
                hex_.cells.push_back({id(q[0], k, 0), id(q[1], k, 0), id(q[2], k, 0), id(q[3], k, 0),
                                      id(q[0], k + 1, 0), id(q[1], k + 1, 0), id(q[2], k + 1, 0), id(q[3], k + 1, 0)});
            }
        }
        orient(first);
    }

    void add_gap() {
        base_ = base_grid(section_, rim_, layout_.counts().base);
        const std::vector<double> column = layout_.column();
        const int levels = static_cast<int>(column.size()), count = static_cast<int>(base_.points.size());
        Ids id(count, levels, 1);
        for (int p = 0; p < count; ++p) {
            for (int k = 0; k < levels; ++k) {
                const double z = k + 1 == levels ? 0 : layout_.gap() - column[static_cast<std::size_t>(k)];
                id(p, k, 0) = add(space(base_.points[static_cast<std::size_t>(p)], z));
            }
        }
        under_base_ = hex_.points.size();
        add_columns(base_, id, levels);
        for (std::size_t q = 0; q < base_.quads.size(); ++q) {
            const auto& c = base_.quads[q];
            name(id(c[0], levels - 1, 0), id(c[1], levels - 1, 0), id(c[2], levels - 1, 0), id(c[3], levels - 1, 0),
                 ground_patch);
            const bool opening = base_.in_nozzle[q] != 0;
            if (!opening || body_.shape().nozzle->depth <= 0) {
                name(id(c[0], 0, 0), id(c[1], 0, 0), id(c[2], 0, 0), id(c[3], 0, 0),
                     opening ? nozzle_boundary : patch_under(c));
            }
        }
        rim_columns_.assign(static_cast<std::size_t>(last_azimuth()) + 1, {});
        for (std::size_t m = 0; m < base_.rim.size(); ++m) {
            for (int k = 0; k < levels; ++k) {
                rim_columns_[m].push_back(id(base_.rim[m], k, 0));
            }
        }
        for (int p = 0; p < count; ++p) {
            base_ids_.push_back(id(p, 0, 0));
        }
    }

    Index patch_under(const std::array<Index, 4>& quad) const {
        Point2 middle;
        for (const Index p : quad) {
            middle = middle + 0.25 * base_.points[static_cast<std::size_t>(p)];
        }
        const Vec3 at = space(middle, 0);
        return body_.protrusion_depth(at.x, at.y) > 0 ? protrusion_boundary : base_boundary;
    }

    /// The nozzle's bore: columns up into the body.
    void add_bore() {
        if (!body_.shape().nozzle || body_.shape().nozzle->depth <= 0) {
            return;
        }
        const double depth = body_.shape().nozzle->depth;
        const int inner = 2 * rim_.nozzle_cells,
                  levels =
                      1 + std::max(4, static_cast<int>(std::lround(inner * depth / body_.shape().nozzle->diameter)));
        PlaneGrid disc = base_;
        disc.quads.clear();
        std::vector<Index> used(base_.points.size(), 0);
        for (std::size_t q = 0; q < base_.quads.size(); ++q) {
            if (base_.in_nozzle[q] != 0) {
                disc.quads.push_back(base_.quads[q]);
                for (const Index p : base_.quads[q]) {
                    used[static_cast<std::size_t>(p)] = 1;
                }
            }
        }
        const int count = static_cast<int>(base_.points.size());
        Ids id(count, levels, 1);
        for (int p = 0; p < count; ++p) {
            for (int k = 0; used[static_cast<std::size_t>(p)] != 0 && k < levels; ++k) {
                id(p, k, 0) = k == 0 ? base_ids_[static_cast<std::size_t>(p)]
                                     : add(space(base_.points[static_cast<std::size_t>(p)],
                                                 layout_.gap() + depth * k / (levels - 1)));
            }
        }
        add_columns(disc, id, levels);
        for (const auto& q : disc.quads) {
            name(id(q[0], levels - 1, 0), id(q[1], levels - 1, 0), id(q[2], levels - 1, 0), id(q[3], levels - 1, 0),
                 nozzle_boundary);
        }
        for (std::size_t m = 1; m < base_.nozzle_rim.size(); ++m) {
            const Index a = base_.nozzle_rim[m - 1], b = base_.nozzle_rim[m];
            for (int k = 0; k + 1 < levels; ++k) {
                name(id(a, k, 0), id(b, k, 0), id(b, k + 1, 0), id(a, k + 1, 0), bore_boundary);
            }
        }
    }

    void add_flank() {
        const int na = last_azimuth() + 1, nl = layout_.counts().flank + 1, nk = layout_.counts().down() + 1;
        Ids id(na, nl, nk);
        equator_ids_.assign(static_cast<std::size_t>(na), {});
        for (int m = 0; m < na; ++m) {
            const auto lines = layout_.flank(rim_.azimuth[static_cast<std::size_t>(m)]);
            for (int l = 0; l < nl; ++l) {
                for (int k = 0; k < nk; ++k) {
                    const auto at = static_cast<std::size_t>(k);
                    id(m, l, k) =
                        l == 0 ? rim_columns_[static_cast<std::size_t>(m)][at]
                               : add(turned(lines[static_cast<std::size_t>(l)][at], static_cast<std::size_t>(m)));
                }
            }
            for (int k = 0; k < nk; ++k) {
                equator_ids_[static_cast<std::size_t>(m)].push_back(id(m, nl - 1, k));
            }
        }
        add_block(id, na, nl, nk);
        for (int m = 0; m + 1 < na; ++m) {
            for (int l = 0; l + 1 < nl; ++l) {
                name(id(m, l, 0), id(m + 1, l, 0), id(m + 1, l + 1, 0), id(m, l + 1, 0), hull_boundary);
                name(id(m, l, nk - 1), id(m + 1, l, nk - 1), id(m + 1, l + 1, nk - 1), id(m, l + 1, nk - 1),
                     ground_patch);
            }
        }
    }

    void add_outward() {
        const auto angles = layout_.upper_angles();
        const int layers = layout_.counts().layers, na = last_azimuth() + 1, nt = static_cast<int>(angles.size()),
                  nr = layers + layout_.counts().outward + 1;
        Ids id(na, nt, nr);
        first_outward_.assign(static_cast<std::size_t>(na), {});
        last_outward_.assign(static_cast<std::size_t>(na), {});
        for (int t = 0; t < nt; ++t) {
            const Line2 line = layout_.outward(angles[static_cast<std::size_t>(t)]);
            for (int m = 0; m < na; ++m) {
                const auto at_m = static_cast<std::size_t>(m);
                for (int r = 0; r < nr; ++r) {
                    const auto at = static_cast<std::size_t>(r);
                    id(m, t, r) = t == 0 && r <= layers ? equator_ids_[at_m][at] : add(turned(line[at], at_m));
                    if (t == 0) {
                        first_outward_[at_m].push_back(id(m, t, r));
                    } else if (t + 1 == nt) {
                        last_outward_[at_m].push_back(id(m, t, r));
                    }
                }
            }
        }
        add_block(id, na, nt, nr);
        for (int m = 0; m + 1 < na; ++m) {
            for (int t = 0; t + 1 < nt; ++t) {
                name(id(m, t, 0), id(m + 1, t, 0), id(m + 1, t + 1, 0), id(m, t + 1, 0), hull_boundary);
                name(id(m, t, nr - 1), id(m + 1, t, nr - 1), id(m + 1, t + 1, nr - 1), id(m, t + 1, nr - 1), far_patch);
            }
        }
        if (layout_.plate_line() >= 0) {
            add_plate(id);
        }
    }

    /// The number of the azimuth that is nearest to a ray, an angle from the tail seen from above.
    int azimuth_at(double from_tail) const {
        const double ray =
            pi - std::atan2(section_.to_x() * std::sin(from_tail), section_.to_y() * std::cos(from_tail));
        const auto nearest = std::min_element(rim_.azimuth.begin(), rim_.azimuth.end(), [&](double a, double b) {
            return std::abs(a - ray) < std::abs(b - ray);
        });
        return static_cast<int>(nearest - rim_.azimuth.begin());
    }

    /// The tail plate: faces of its line, between the azimuths that are nearest to its rays.
    void add_plate(Ids& id) {
        const TailPlate& plate = *body_.shape().tail_plate;
        const int t = layout_.plate_line();
        for (int m = azimuth_at(plate.half_angle); m < azimuth_at(plate.inner_angle); ++m) {
            for (int r = 0; r < layout_.plate_end(); ++r) {
                const Quad q{id(m, t, r), id(m + 1, t, r), id(m + 1, t, r + 1), id(m, t, r + 1)};
                name(q[0], q[1], q[2], q[3], plate_boundary);
                const auto at = [&](std::size_t c) { return hex_.points[static_cast<std::size_t>(q[c])]; };
                plate_area_ += norm(cross(at(2) - at(0), at(3) - at(1)));  // of both halves
            }
        }
    }

    void add_outer() {
        const auto block = layout_.outer_block();
        const int layers = layout_.counts().layers, na = last_azimuth() + 1, nr = static_cast<int>(block.size()),
                  nj = static_cast<int>(block[0].size());
        Ids id(na, nr, nj);
        for (int m = 0; m < na; ++m) {
            const auto at_m = static_cast<std::size_t>(m);
            for (int r = 0; r < nr; ++r) {
                for (int j = 0; j < nj; ++j) {
                    id(m, r, j) =
                        j == 0   ? first_outward_[at_m][static_cast<std::size_t>(layers + r)]
                        : r == 0 ? equator_ids_[at_m][static_cast<std::size_t>(layers + j)]
                                 : add(turned(block[static_cast<std::size_t>(r)][static_cast<std::size_t>(j)], at_m));
                }
            }
        }
        add_block(id, na, nr, nj);
        for (int m = 0; m + 1 < na; ++m) {
            for (int r = 0; r + 1 < nr; ++r) {
                name(id(m, r, nj - 1), id(m + 1, r, nj - 1), id(m + 1, r + 1, nj - 1), id(m, r + 1, nj - 1),
                     ground_patch);
            }
            for (int j = 0; j + 1 < nj; ++j) {
                name(id(m, nr - 1, j), id(m + 1, nr - 1, j), id(m + 1, nr - 1, j + 1), id(m, nr - 1, j + 1), far_patch);
            }
        }
    }

    void add_top() {
        const PlaneGrid disc = disc_grid(rim_, layout_.counts().base, layout_.counts().rings);
        const int count = static_cast<int>(disc.points.size()),
                  levels = layout_.counts().layers + layout_.counts().outward + 1;
        std::vector<int> rim_of(static_cast<std::size_t>(count), -1);
        for (std::size_t m = 0; m < disc.rim.size(); ++m) {
            rim_of[static_cast<std::size_t>(disc.rim[m])] = static_cast<int>(m);
        }
        Ids id(count, levels, 1);
        for (int p = 0; p < count; ++p) {
            const auto at = static_cast<std::size_t>(p);
            if (rim_of[at] >= 0) {
                for (int k = 0; k < levels; ++k) {
                    id(p, k, 0) = last_outward_[static_cast<std::size_t>(rim_of[at])][static_cast<std::size_t>(k)];
                }
                continue;
            }
            const Point2 on_disc = disc.points[at];
            const double radius = geometry::length(on_disc);
            const Point2 way = radius > 0 ? 1 / radius * on_disc : Point2{1, 0};
            const Line2 line = layout_.outward(pi - radius * (pi - layout_.top_angle()));
            for (int k = 0; k < levels; ++k) {
                const Point2 q = line[static_cast<std::size_t>(k)];
                id(p, k, 0) = add(space({q.x * way.x, on_disc.y == 0 ? 0 : q.x * way.y}, q.y));
            }
        }
        add_columns(disc, id, levels);
        for (const auto& q : disc.quads) {
            name(id(q[0], 0, 0), id(q[1], 0, 0), id(q[2], 0, 0), id(q[3], 0, 0), hull_boundary);
            name(id(q[0], levels - 1, 0), id(q[1], levels - 1, 0), id(q[2], levels - 1, 0), id(q[3], levels - 1, 0),
                 far_patch);
        }
    }

    /// All faces in the plane y = 0: a name inside the domain does no harm.
    void name_symmetry() {
        const auto flat = [&](Index p) { return hex_.points[static_cast<std::size_t>(p)].y == 0; };
        constexpr std::array<std::array<std::size_t, 4>, 6> sides = {
            {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
        for (const Hexahedron& h : hex_.cells) {
            for (const auto& s : sides) {
                if (flat(h[s[0]]) && flat(h[s[1]]) && flat(h[s[2]]) && flat(h[s[3]])) {
                    name(h[s[0]], h[s[1]], h[s[2]], h[s[3]], symmetry_patch);
                }
            }
        }
    }

    void add_mirror_image() {
        const std::size_t count = hex_.points.size(), cells = hex_.cells.size(), named = hex_.named.size();
        std::vector<Index> image(count);
        for (std::size_t p = 0; p < count; ++p) {
            const Vec3 q = hex_.points[p];
            image[p] = q.y == 0 ? static_cast<Index>(p) : add({q.x, -q.y, q.z});
            mirror_of_.resize(hex_.points.size(), -1);
            if (q.y != 0) {
                mirror_of_[static_cast<std::size_t>(image[p])] = static_cast<Index>(p);
            }
        }
        const auto of = [&](Index p) { return image[static_cast<std::size_t>(p)]; };
        for (std::size_t c = 0; c < cells; ++c) {
            const Hexahedron h = hex_.cells[c];
            hex_.cells.push_back({of(h[4]), of(h[5]), of(h[6]), of(h[7]), of(h[0]), of(h[1]), of(h[2]), of(h[3])});
        }
        for (std::size_t f = 0; f < named; ++f) {
            const auto face = hex_.named[f];
            const Quad& q = face.corners;
            name(of(q[0]), of(q[1]), of(q[2]), of(q[3]), face.patch);
        }
    }

    /// Where the body takes a point with it (`height` above the base, unbent): bend, then pitch, roll and gap.
    Vec3 moved(double x, double y, double height) const {
        Vec3 p = body_.bent({x, y, height});
        p.x -= body_.base_centre();
        return placed(p, options_.placement);
    }

    /// Moves all points: the body rigidly (but for its bend), the water about it less and less with the distance, on
    /// the ground only along it.
    void place() {
        const double gap = layout_.gap(), near = std::max(0.2 * scale_, 1.2 * std::max(body_.semi_x(), body_.semi_y())),
                     above = std::max(0.2 * scale_, 1.15 * body_.top());
        const double far = std::max(0.6 * scale_, 2.2 * near), top = std::max(0.5 * scale_, above + 0.25 * scale_);
        for (std::size_t i = 0; i < hex_.points.size(); ++i) {
            Vec3& p = hex_.points[i];
            const auto source =
                i < mirror_of_.size() && mirror_of_[i] >= 0 ? static_cast<std::size_t>(mirror_of_[i]) : i;
            if (source < under_base_) {
                const Vec3 base = moved(p.x, p.y, -body_.protrusion_depth(p.x, p.y));
                p = {base.x, base.y, p.z / gap * base.z};
                continue;
            }
            const double share = smooth_share((far - std::hypot(p.x, p.y)) / (far - near)) *
                                 smooth_share((top - (p.z - gap)) / (top - above));
            const Vec3 still{p.x - body_.base_centre(), p.y, p.z};
            p = share == 0 ? still : still + share * way_of_water(p);
        }
    }

    static double smooth_share(double s) {
        s = std::clamp(s, 0.0, 1.0);
        return s * s * (3 - 2 * s);
    }

    /// How far the body takes the water with it. Above a cone that touches the flank a little above the rim: as far as
    /// itself, but outside its outline (a little higher up) as the outline. Below: down to the ground in proportion.
    Vec3 way_of_water(const Vec3& p) const {
        const Point2 scaled{p.x / section_.to_x(), std::abs(p.y) / section_.to_y()};
        const double radius = geometry::length(scaled), azimuth = std::atan2(scaled.y, scaled.x);
        const double depth = body_.depth(), gap = layout_.gap(), touch = 0.15 * depth, step = 0.01 * depth;
        const double at_touch = section_.radius(touch, azimuth);
        const double rise =
            2 * step / (section_.radius(touch + step, azimuth) - section_.radius(touch - step, azimuth));
        const double cone = gap + std::clamp(0.7 * (touch + rise * (radius - at_touch)), 0.0, depth);
        const double height = std::max(0.0, p.z - gap),
                     limit = section_.radius(std::min(height + touch, depth), azimuth);
        const double share = radius > limit ? limit / radius : 1.0;
        const Vec3 from{share * p.x, share * p.y, height};
        if (layout_.plate_line() >= 0) {  // a plate turns with the body: what lies outside turns too, and bends no more
            Vec3 turned = p + (body_.bent(from) - from);
            turned = {turned.x - body_.base_centre(), turned.y, height + body_.bent(from).z - from.z};
            const Vec3 way = placed(turned, options_.placement) - Vec3{p.x - body_.base_centre(), p.y, height + gap};
            return {way.x, way.y, std::min(1.0, p.z / cone) * way.z};
        }
        const Vec3 way = moved(from.x, from.y, from.z) - Vec3{from.x - body_.base_centre(), from.y, from.z + gap};
        return {way.x, way.y, std::min(1.0, p.z / cone) * way.z};
    }

    /// Lowest point of the body; throws where it is on the ground or below it.
    double clearance() const {
        double lowest = HUGE_VAL;
        Index patch = 0;
        for (const auto& face : hex_.named) {
            for (const Index p : face.corners) {
                const double z = hex_.points[static_cast<std::size_t>(p)].z;
                if (face.patch < body_patches && z < lowest) {
                    lowest = z;
                    patch = face.patch;
                }
            }
        }
        require_above_ground({lowest, {}, {}, hex_.patch_names[static_cast<std::size_t>(patch)]},
                             {layout_.gap(), 0, 0});
        return lowest;
    }

    const ExactBody& body_;
    BodySection section_;
    const BlockMeshOptions& options_;
    core::Progress& progress_;
    double scale_;
    BlockLayout layout_;
    RimAzimuths rim_;
    HexMesh hex_;
    PlaneGrid base_;
    double plate_area_ = 0;
    std::size_t under_base_ = 0;  // points up to here are of the columns under the base
    std::vector<Index> base_ids_, mirror_of_;
    std::vector<std::vector<Index>> rim_columns_, equator_ids_, first_outward_, last_outward_;
};

}  // namespace

const std::vector<std::string>& density_names() {
    static const std::vector<std::string> names = {"draft", "coarse", "medium", "fine"};
    return names;
}

std::string name_of(MeshDensity density) { return density_names()[static_cast<std::size_t>(density)]; }

BlockMesh make_block_mesh(const BodyShape& shape, const BlockMeshOptions& options, core::Progress& progress) {
    check(shape);
    for (const auto& [name, value] : {std::pair{"gap", options.placement.gap},
                                      {"speed", options.speed},
                                      {"kinematic_viscosity", options.kinematic_viscosity}}) {
        if (!(value > 0) || !std::isfinite(value)) {
            throw core::InputError("range",
                                   std::string(name) + " is " + core::format_number(value, 6) + ": it must be positive",
                                   {}, "the nearest allowed value: above 0");
        }
    }
    if (options.half && options.placement.roll != 0) {
        throw core::InputError("symmetry", "a rolled body has no plane of symmetry", {},
                               "make a whole model, or take roll = 0");
    }
    const ExactBody body(shape);
    BlockMesh made = Builder(body, options, progress).make();
    if (const std::string fault = fault_of(made.quality); !fault.empty()) {
        throw core::InputError("mesh", "no block mesh of this body at this gap, pitch and roll: " + fault, {},
                               "another density, less pitch or roll, a larger gap, or the other mesher (snappy)");
    }
    return made;
}

void to_json(nlohmann::json& json, const BlockMesh& mesh) {
    json = mesh.quality;
    json["walls"] = mesh.walls;
    json["cells_in_gap"] = mesh.cells_in_gap;
    json["smallest_clearance"] = mesh.smallest_clearance;
    json["wall_units_mean"] = mesh.wall_units_mean;
    if (mesh.tail_plate_area > 0) {
        json["tail_plate_area"] = mesh.tail_plate_area;
    }
    json["far_volume"] = mesh.far_volume;
}

}  // namespace underbody::geometry
