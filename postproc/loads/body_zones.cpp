#include "postproc/loads/body_zones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/text.h"
#include "postproc/field/point_index.h"
#include "postproc/field/rim_edges.h"
#include "postproc/field/vector_math.h"
#include "postproc/loads/face_integral.h"

namespace underbody::postproc {

namespace {

double diagonal(const WallShape& wall) {
    return std::hypot(wall.upper[0] - wall.lower[0], wall.upper[1] - wall.lower[1], wall.upper[2] - wall.lower[2]);
}

void widen(WallShape& box, const WallShape& more) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.lower[k] = std::min(box.lower[k], more.lower[k]);
        box.upper[k] = std::max(box.upper[k], more.upper[k]);
    }
}

/// The most that a closed surface within the box can turn toward `direction`: the shadow of the box.
double shadow(const WallShape& box, const Vector& direction) {
    double area = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3;
        const std::size_t j = (k + 2) % 3;
        area += std::abs(direction[k]) * (box.upper[i] - box.lower[i]) * (box.upper[j] - box.lower[j]);
    }
    return area / norm(direction);
}

bool is_flat(const WallShape& wall) { return norm(wall.area_vector) > 0.999 * wall.area; }

/// Do two flat walls lie in one plane?
bool coplanar(const WallShape& a, const WallShape& b) {
    const double along = dot(a.area_vector, b.area_vector) / (norm(a.area_vector) * norm(b.area_vector));
    Vector between{};
    for (std::size_t k = 0; k < 3; ++k) {
        between[k] = 0.5 * (b.lower[k] + b.upper[k] - a.lower[k] - a.upper[k]);
    }
    const double off = std::abs(dot(between, a.area_vector)) / norm(a.area_vector);
    return std::abs(along) > 0.9999 && off < 1e-3 * std::max(diagonal(a), diagonal(b));
}

/// Walls that are judged together: flat ones in one plane, or one alone.
struct Group {
    std::vector<std::size_t> members;
    WallShape shape;  ///< box, area and area vector of all
};

std::vector<Group> groups_of(const std::vector<WallShape>& walls) {
    std::vector<Group> groups;
    for (std::size_t i = 0; i < walls.size(); ++i) {
        const auto with = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
            return is_flat(walls[i]) && is_flat(group.shape) && coplanar(group.shape, walls[i]);
        });
        if (with == groups.end()) {
            groups.push_back({{i}, walls[i]});
            continue;
        }
        const double same_way = dot(with->shape.area_vector, walls[i].area_vector) < 0 ? -1 : 1;
        for (std::size_t k = 0; k < 3; ++k) {
            with->shape.area_vector[k] += same_way * walls[i].area_vector[k];
        }
        with->shape.area += walls[i].area;
        widen(with->shape, walls[i]);
        with->members.push_back(i);
    }
    return groups;
}

const WallShape& shape(const WallShape& wall) { return wall; }
const WallShape& shape(const Group& group) { return group.shape; }

/// The box around those that are `wanted`; nothing when none is.
template <typename Walls, typename Wanted>
std::optional<WallShape> box_around(const Walls& walls, Wanted&& wanted) {
    std::optional<WallShape> box;
    for (const auto& wall : walls) {
        if (!wanted(wall)) {
            continue;
        }
        if (box) {
            widen(*box, shape(wall));
        } else {
            box = shape(wall);
        }
    }
    return box;
}

/// Larger by so much cannot be a matter of rounding or of a rim.
constexpr double excess_factor = 1.05;

Vector seen_from(const Vector& place, const SurfaceArrays& surface, Index node) {
    const double* x = surface.points().data() + 3 * node;
    return {x[0] - place[0], x[1] - place[1], x[2] - place[2]};
}

/// The solid angle that a surface fills, with a sign by the way its faces look (A. Van Oosterom, J. Strackee, IEEE
/// Trans. Biomed. Eng. 30, 1983).
double solid_angle(const Vector& place, const SurfaceArrays& surface) {
    double angle = 0;
    const auto offsets = surface.offsets();
    const auto nodes = surface.connectivity();
    for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
        const Vector a = seen_from(place, surface, nodes[static_cast<std::size_t>(offsets[f])]);
        for (Index i = offsets[f] + 1; i + 1 < offsets[f + 1]; ++i) {
            const Vector b = seen_from(place, surface, nodes[static_cast<std::size_t>(i)]);
            const Vector c = seen_from(place, surface, nodes[static_cast<std::size_t>(i + 1)]);
            const double below =
                norm(a) * norm(b) * norm(c) + dot(a, b) * norm(c) + dot(b, c) * norm(a) + dot(c, a) * norm(b);
            angle += 2 * std::atan2(dot(a, cross(b, c)), below);
        }
    }
    return angle;
}

/// The nodes of a wall that lie in a box.
std::vector<const double*> nodes_within(const WallShape& wall, const Vector& lower, const Vector& upper) {
    std::vector<const double*> nodes;
    const auto points = wall.surface->points();
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
        const double* x = points.data() + i;
        if (x[0] >= lower[0] && x[0] <= upper[0] && x[1] >= lower[1] && x[1] <= upper[1] && x[2] >= lower[2] &&
            x[2] <= upper[2]) {
            nodes.push_back(x);
        }
    }
    return nodes;
}

/// Do two walls have a node in common, as a base and its hull at their rim? It must lie where their boxes overlap.
bool touch(const WallShape& a, const WallShape& b) {
    if (a.surface == nullptr || b.surface == nullptr) {
        return false;
    }
    const double tolerance = 1e-6 * std::min(diagonal(a), diagonal(b));
    Vector lower{};
    Vector upper{};
    for (std::size_t k = 0; k < 3; ++k) {
        lower[k] = std::max(a.lower[k], b.lower[k]) - tolerance;
        upper[k] = std::min(a.upper[k], b.upper[k]) + tolerance;
    }
    auto few = nodes_within(a, lower, upper);
    auto many = nodes_within(b, lower, upper);
    if (few.size() > many.size()) {
        std::swap(few, many);
    }
    Places places(tolerance);
    for (const double* node : few) {
        places.number(node);
    }
    return !few.empty() && std::any_of(many.begin(), many.end(), [&](const double* node) { return places.has(node); });
}

bool faces_one_way(const Group& group) {
    constexpr double one_sided = 0.95;  // a ground may be uneven; the open half of a hull is rounder
    return norm(group.shape.area_vector) >= one_sided * group.shape.area;
}

bool meet(const Group& group, const Group& other, const std::vector<WallShape>& walls) {
    return std::any_of(group.members.begin(), group.members.end(), [&](std::size_t i) {
        return std::any_of(other.members.begin(), other.members.end(),
                           [&](std::size_t k) { return touch(walls[i], walls[k]); });
    });
}

/// Two sides of a closed box that are as large look as if they balanced each other, the ceiling over a floor: but
/// nothing between them does. A flat hull over its base does, and meets it.
bool balances_by_size_only(const Group& group, const Group& other, const std::vector<WallShape>& walls) {
    const double own = norm(group.shape.area_vector);
    const double theirs = norm(other.shape.area_vector);
    if (theirs <= own / excess_factor || !faces_one_way(other)) {
        return false;
    }
    const bool across = std::abs(dot(group.shape.area_vector, other.shape.area_vector)) < 0.95 * own * theirs;
    return across || !meet(group, other, walls);
}

bool too_large_to_be_balanced(const Group& group, const std::vector<Group>& groups,
                              const std::vector<WallShape>& walls) {
    if (!faces_one_way(group)) {
        return false;
    }
    const auto rest = box_around(
        groups, [&](const Group& other) { return &other != &group && !balances_by_size_only(group, other, walls); });
    return rest && norm(group.shape.area_vector) > excess_factor * shadow(*rest, group.shape.area_vector);
}

/// Walls that hang together: those that have nodes in common, whatever they are called.
using Cluster = std::vector<const WallShape*>;

std::vector<Cluster> clusters_of(const std::vector<WallShape>& walls) {
    std::vector<std::size_t> root(walls.size());
    std::iota(root.begin(), root.end(), std::size_t{0});
    const auto find = [&](std::size_t i) {
        while (root[i] != i) {
            i = root[i];
        }
        return i;
    };
    for (std::size_t i = 0; i < walls.size(); ++i) {
        for (std::size_t k = i + 1; k < walls.size(); ++k) {
            if (find(i) != find(k) && touch(walls[i], walls[k])) {
                root[find(k)] = find(i);
            }
        }
    }
    std::vector<Cluster> clusters(walls.size());
    for (std::size_t i = 0; i < walls.size(); ++i) {
        clusters[find(i)].push_back(&walls[i]);
    }
    std::erase_if(clusters, [](const Cluster& cluster) { return cluster.empty(); });
    return clusters;
}

WallShape box_of(const Cluster& cluster) {
    WallShape box = *cluster.front();
    for (const WallShape* wall : cluster) {
        widen(box, *wall);
    }
    return box;
}

/// The box of the others lies within that of these walls along two axes at least: a tunnel is open at its ends.
bool is_around(const WallShape& box, const WallShape& others) {
    int axes = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double room = 0.02 * (box.upper[k] - box.lower[k]);
        axes += box.lower[k] < others.lower[k] - room && box.upper[k] > others.upper[k] + room ? 1 : 0;
    }
    return axes >= 2;
}

/// The volume of the cones from the faces to one place.
double volume_from(const Cluster& cluster, const WallShape& box) {
    double volume = 0;
    for (const WallShape* wall : cluster) {
        volume += wall->volume;
        for (std::size_t k = 0; k < 3; ++k) {
            volume += 0.5 * (wall->lower[k] + wall->upper[k] - box.lower[k] - box.upper[k]) * wall->area_vector[k] / 3;
        }
    }
    return volume;
}

/// Do the others lie in the hollow of these walls? Half of all directions from there end at the walls, 1 inside what is
/// closed, 0 outside. The base of a hull lies in its hollow too, but hangs on it.
bool hold(const Cluster& cluster, const WallShape& box, const std::vector<Cluster>& others, bool half) {
    std::vector<const SurfaceArrays*> surfaces;
    for (const WallShape* wall : cluster) {
        if (wall->surface == nullptr) {
            return false;
        }
        surfaces.push_back(wall->surface);
    }
    const SignedGroups groups = joined_along_rims(surfaces, diagonal(box));
    const auto share_of_directions = [&](const Vector& place) {
        std::vector<double> angles(surfaces.size(), 0);  // of each group, at its root
        for (std::size_t i = 0; i < surfaces.size(); ++i) {
            const auto [root, sign] = groups.root(i);
            angles[root] += sign * solid_angle(place, *surfaces[i]);
        }
        double all = 0;
        for (const double angle : angles) {
            all += std::abs(angle);
        }
        return all / (16 * std::atan(1.0));
    };
    const double enough = half ? 0.25 : 0.5;  // half a tunnel fills half of what the whole one does
    for (const auto& other : others) {
        for (const WallShape* wall : other) {
            if (other.front() == cluster.front()) {
                break;
            }
            if (wall->surface == nullptr || wall->surface->nodes() == 0) {
                return false;
            }
            // A few of its points.
            constexpr std::size_t samples = 16;
            const std::size_t count = wall->surface->nodes();
            for (std::size_t i = 0; i < std::min(samples, count); ++i) {
                const double* x = wall->surface->points().data() + 3 * (i * count / std::min(samples, count));
                if (share_of_directions({x[0], x[1], x[2]}) < enough) {
                    return false;
                }
            }
        }
    }
    return true;
}

bool surrounds(const Cluster& cluster, const std::vector<Cluster>& clusters, bool half) {
    const WallShape box = box_of(cluster);
    std::optional<WallShape> rest;
    for (const auto& other : clusters) {
        if (other.front() != cluster.front()) {
            const WallShape theirs = box_of(other);
            rest ? widen(*rest, theirs) : void(rest = theirs);
        }
    }
    if (!rest || !is_around(box, *rest)) {
        return false;
    }
    const bool known =
        std::all_of(cluster.begin(), cluster.end(), [](const WallShape* wall) { return wall->normals_into_fluid; });
    return known ? volume_from(cluster, box) < 0 : hold(cluster, box, clusters, half);
}

/// Words of the last part of a name, without numbers: "Block 1/velocity-inlet2", {"velocity", "inlet"}.
std::vector<std::string> words_of(const std::string& name) {
    std::vector<std::string> words(1);
    char before = ' ';
    for (const char c : name.substr(name.rfind('/') + 1)) {
        const bool upper = c >= 'A' && c <= 'Z';
        const bool after_lower = before >= 'a' && before <= 'z';
        const bool letter = upper || (c >= 'a' && c <= 'z') || static_cast<unsigned char>(c) >= 0x80;
        if ((upper && after_lower) || !letter) {
            words.emplace_back();
        }
        if (letter) {
            words.back() += c;
        }
        before = c;
    }
    std::erase(words, "");
    std::transform(words.begin(), words.end(), words.begin(),
                   [](const std::string& word) { return core::lower_case(word); });
    return words;
}

bool is_no_wall(ZoneKind kind) {
    constexpr ZoneKind others[] = {ZoneKind::inlet,     ZoneKind::outlet,   ZoneKind::symmetry, ZoneKind::periodic,
                                   ZoneKind::interface, ZoneKind::interior, ZoneKind::farfield};
    return std::find(std::begin(others), std::end(others), kind) != std::end(others);
}

}  // namespace

ZoneKind kind_from_name(const std::string& name) {
    const std::vector<std::string> words = words_of(name);
    const auto has = [&](const char* word) { return std::find(words.begin(), words.end(), word) != words.end(); };
    const auto ends = [&](const char* word) { return !words.empty() && words.back() == word; };
    // A wall is not called by these; the others may stand before it: "inlet duct", "opening door".
    if (has("symmetry") || has("symmetryplane") || has("symplane") || ends("sym")) {
        return ZoneKind::symmetry;
    }
    if (has("farfield") || has("freestream") ||
        (words.size() >= 2 && words[words.size() - 2] == "far" && ends("field"))) {
        return ZoneKind::farfield;
    }
    return ends("inlet") || ends("inflow")                        ? ZoneKind::inlet
           : ends("outlet") || ends("outflow") || ends("opening") ? ZoneKind::outlet
           : ends("periodic") || ends("cyclic")                   ? ZoneKind::periodic
           : ends("interior")                                     ? ZoneKind::interior
                                                                  : ZoneKind::unknown;
}

ZoneKind effective_kind(const Zone& zone) {
    return zone.kind == ZoneKind::unknown ? kind_from_name(zone.name) : zone.kind;
}

std::vector<const Zone*> possible_walls(const Field& field, std::vector<const Zone*>& excluded_by_kind) {
    excluded_by_kind.clear();
    std::vector<const Zone*> surfaces;
    std::vector<const Zone*> walls;
    for (const auto& zone : field.zones) {
        if (zone.surface == nullptr || zone.volume != nullptr) {
            continue;
        }
        surfaces.push_back(&zone);
        if (zone.kind == ZoneKind::wall) {
            walls.push_back(&zone);
        }
    }
    if (!walls.empty()) {
        return walls;
    }
    for (const Zone* zone : surfaces) {
        (is_no_wall(effective_kind(*zone)) ? excluded_by_kind : walls).push_back(zone);
    }
    if (walls.empty()) {
        std::swap(walls, excluded_by_kind);
    }
    return walls;
}

bool bounds_a_volume(const FaceSums& sums, int dimension) {
    constexpr double rim = 1e-3;
    if (!(norm(sums.area_vector) < rim * sums.area)) {
        return false;
    }
    const auto& flux = sums.flux_of_place;
    const auto [low, high] = std::minmax_element(flux.begin(), flux.begin() + dimension);
    return *high - *low <= 0.01 * std::max(std::abs(*low), std::abs(*high)) && *high * *low > 0;
}

WallShape shape_of(const std::string& name, const SurfaceArrays& surface, bool normals_into_fluid, int dimension) {
    WallShape wall;
    wall.name = name;
    wall.normals_into_fluid = normals_into_fluid;
    wall.lower.fill(std::numeric_limits<double>::infinity());
    wall.upper.fill(-std::numeric_limits<double>::infinity());
    const auto points = surface.points();
    for (std::size_t i = 0; i < points.size(); ++i) {
        wall.lower[i % 3] = std::min(wall.lower[i % 3], points[i]);
        wall.upper[i % 3] = std::max(wall.upper[i % 3], points[i]);
    }
    Vector centre{};
    for (std::size_t k = 0; k < 3; ++k) {
        centre[k] = 0.5 * (wall.lower[k] + wall.upper[k]);
    }
    const FaceSums sums = integrate_faces(surface, {}, centre);
    wall.area = sums.area;
    wall.area_vector = sums.area_vector;
    wall.closed = bounds_a_volume(sums, dimension);
    wall.volume = (sums.flux_of_place[0] + sums.flux_of_place[1] + sums.flux_of_place[2]) / 3;
    return wall;
}

std::vector<LeftOutZone> walls_beside_body(const std::vector<WallShape>& all, bool half) {
    std::vector<LeftOutZone> others;
    std::vector<WallShape> walls = all;
    std::vector<Cluster> clusters = clusters_of(all);
    for (bool more = true; more && clusters.size() > 1;) {
        const auto outer = std::find_if(clusters.begin(), clusters.end(),
                                        [&](const Cluster& cluster) { return surrounds(cluster, clusters, half); });
        more = outer != clusters.end();
        if (more) {
            for (const WallShape* wall : *outer) {
                others.push_back({wall->name, outer->size() > 1
                                                  ? "with its neighbours it surrounds the others, with the fluid inside"
                                                  : "it surrounds the others, with the fluid inside"});
                std::erase_if(walls, [&](const WallShape& other) { return other.name == wall->name; });
            }
            clusters.erase(outer);
        }
    }
    const auto groups = groups_of(walls);
    for (const auto& group : groups) {
        if (too_large_to_be_balanced(group, groups, walls)) {
            for (const std::size_t i : group.members) {
                others.push_back({walls[i].name, std::string(is_flat(walls[i]) ? "a plane" : "a one-sided wall") +
                                                     " of " + core::format_number(walls[i].area, 3) +
                                                     " m^2, too large to be part of a body with the others"});
            }
        }
    }
    return others.size() < all.size() ? others : std::vector<LeftOutZone>{};
}

std::vector<std::string> separate_bodies(const std::vector<WallShape>& walls) {
    std::vector<const WallShape*> closed;
    for (const auto& wall : walls) {
        if (wall.closed) {
            closed.push_back(&wall);
        }
    }
    std::vector<std::string> names;
    for (const WallShape* wall : closed) {
        const bool apart = std::all_of(closed.begin(), closed.end(), [&](const WallShape* other) {
            bool disjoint = wall == other;
            for (std::size_t k = 0; k < 3; ++k) {
                disjoint = disjoint || wall->lower[k] > other->upper[k] || wall->upper[k] < other->lower[k];
            }
            return disjoint;
        });
        if (apart) {
            names.push_back(wall->name);
        }
    }
    return names.size() > 1 ? names : std::vector<std::string>{};
}

}  // namespace underbody::postproc
