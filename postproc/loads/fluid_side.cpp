#include "postproc/loads/fluid_side.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "postproc/field/rim_edges.h"
#include "postproc/loads/loads_result.h"

namespace underbody::postproc {

namespace {

using Point = std::array<double, 3>;

class Settler {
public:
    Settler(const std::vector<FacingZone>& zones, int symmetry, const Point& origin, int dimension)
        : zones_(zones), symmetry_(symmetry), origin_(origin), dimension_(dimension) {
        facing_.signs.assign(zones.size(), 1.0);
        for (const auto& zone : zones) {
            area_ += zone.sums.area;
        }
    }

    Facing settle() {
        const auto known = std::count_if(zones_.begin(), zones_.end(), [](const FacingZone& z) { return z.known; });
        if (known == static_cast<std::ptrdiff_t>(zones_.size())) {
            facing_.how = "the file says which side the fluid is on";
        } else if (closes(known > 0)) {
            facing_.how = known > 0
                              ? "turned so that the surface closes with the zones that the file vouches for"
                              : "the surface closes" + std::string(symmetry_ >= 0 ? " with its mirror image" : "") +
                                    ": the fluid is outside the volume it encloses";
        } else {
            settle_open();
        }
        return std::move(facing_);
    }

private:
    [[nodiscard]] double openness(const std::vector<double>& signs) const {
        double square = 0;
        for (int k = 0; k < 3; ++k) {
            double sum = 0;
            for (std::size_t i = 0; k != symmetry_ && i < zones_.size(); ++i) {
                sum += signs[i] * zones_[i].sums.area_vector[static_cast<std::size_t>(k)];
            }
            square += sum * sum;
        }
        return area_ > 0 ? std::sqrt(square) / area_ : 0;
    }

    /// Volume along each of the axes that close; what bounds one gives the same along all.
    [[nodiscard]] std::vector<double> volumes(const std::vector<double>& signs) const {
        std::vector<double> all;
        for (int k = 0; k < 3; ++k) {
            double sum = 0;
            for (std::size_t i = 0; i < zones_.size(); ++i) {
                sum += signs[i] * zones_[i].sums.flux_of_place[static_cast<std::size_t>(k)];
            }
            if (k != symmetry_) {
                all.push_back(sum);
            }
        }
        return all;
    }

    /// Nothing bounds a duct at its ends: along it the volume is none.
    [[nodiscard]] bool is_duct(const std::vector<double>& volumes) const {
        constexpr double alike = 0.5;
        const auto [low, high] = std::minmax_element(volumes.begin(), volumes.end());
        const double largest = std::max(std::abs(*low), std::abs(*high));
        return dimension_ == 3 && largest > tiny_volume() && !(*low > alike * largest || *high < -alike * largest);
    }

    /// True when one choice of signs closes the surface and no other comes near it.
    bool closes(bool anchored) {
        std::vector<std::size_t> free;
        for (std::size_t i = 0; i < zones_.size(); ++i) {
            if (!zones_[i].known) {
                free.push_back(i);
            }
        }
        if (!anchored) {
            free.erase(free.begin());  // all turned together is decided by the volume
        }
        if (free.size() > 12) {
            return false;
        }
        double best = std::numeric_limits<double>::infinity();
        double second = best;
        std::vector<double> best_signs = facing_.signs;
        for (std::size_t choice = 0; choice < (std::size_t{1} << free.size()); ++choice) {
            std::vector<double> signs(zones_.size(), 1.0);
            for (std::size_t k = 0; k < free.size(); ++k) {
                signs[free[k]] = ((choice >> k) & 1) != 0 ? -1.0 : 1.0;
            }
            const double open = openness(signs);
            if (open < best) {
                second = best;
                best = open;
                best_signs = signs;
            } else {
                second = std::min(second, open);
            }
        }
        if (best > nearly_closed_within || second < 4 * best + 1e-9) {
            return false;
        }
        const std::vector<double> along = volumes(best_signs);
        const double enclosed = std::accumulate(along.begin(), along.end(), 0.0) / static_cast<double>(along.size());
        if (!anchored && is_duct(along)) {
            facing_.problems.push_back({core::Problem::Severity::warning,
                                        "the walls are open at both ends, as those of a duct are: on which side their "
                                        "fluid is cannot be told from their shape, "
                                        "and outside is taken; for a flow inside give the side, option 'fluid file' or "
                                        "option 'fluid reversed'",
                                        {}});
            return false;
        }
        if (!anchored && std::abs(enclosed) < tiny_volume()) {
            return false;
        }
        if (!anchored && enclosed < 0) {
            for (auto& sign : best_signs) {
                sign = -sign;
            }
        }
        facing_.signs = best_signs;
        return true;
    }

    [[nodiscard]] double tiny_volume() const { return 1e-6 * std::pow(area_, 1.5); }

    /// Open surfaces: relative signs from shared edges, the sign of each group from the volume toward its own opening.
    void settle_open() {
        std::vector<const SurfaceArrays*> surfaces;
        for (const auto& zone : zones_) {
            surfaces.push_back(zone.surface);
        }
        std::vector<std::vector<RimEdge>> unmatched;
        const SignedGroups groups = joined_along_rims(surfaces, size(), &unmatched);
        facing_.how =
            "zones that share edges agree; the fluid is outside the volume toward the centre of the open edges";
        for (std::size_t root = 0; root < zones_.size(); ++root) {
            if (groups.root(root).first == root) {
                settle_group(groups, root, unmatched);
            }
        }
    }

    void settle_group(const SignedGroups& groups, std::size_t root,
                      const std::vector<std::vector<RimEdge>>& unmatched) {
        std::vector<std::size_t> members;
        double anchored = 0;
        for (std::size_t i = 0; i < zones_.size(); ++i) {
            if (groups.root(i).first == root) {
                members.push_back(i);
                anchored = anchored == 0 && zones_[i].known ? groups.root(i).second : anchored;
            }
        }
        double sign = anchored;
        if (sign == 0) {
            double enclosed = group_volume(groups, members, centre_of_edges(members, unmatched));
            if (std::abs(enclosed) < tiny_volume() && members.size() < zones_.size()) {
                enclosed =
                    group_volume(groups, members, centre_of_all());  // a flat part: away from the rest of the body
            }
            if (std::abs(enclosed) < tiny_volume()) {
                facing_.problems.push_back(
                    {core::Problem::Severity::warning,
                     "which side of zone '" + zones_[members[0]].name +
                         "' the fluid is on cannot be told from its shape: the node order of the file was used",
                     {}});
                facing_.guessed = true;
                facing_.how = "a guess: zone '" + zones_[members[0]].name +
                              "' has no inside; the node order of the file was used";
                enclosed = 1;
            }
            sign = enclosed > 0 ? 1.0 : -1.0;
        }
        for (const auto i : members) {
            facing_.signs[i] = zones_[i].known ? 1.0 : sign * groups.root(i).second;
        }
    }

    [[nodiscard]] double group_volume(const SignedGroups& groups, const std::vector<std::size_t>& members,
                                      const Point& apex) const {
        double sum = 0;
        for (const auto i : members) {
            for (std::size_t k = 0; k < 3; ++k) {
                sum += groups.root(i).second *
                       (zones_[i].sums.flux_of_place[k] - (apex[k] - origin_[k]) * zones_[i].sums.area_vector[k]);
            }
        }
        return sum / 3;
    }

    [[nodiscard]] Point centre_of_edges(const std::vector<std::size_t>& members,
                                        const std::vector<std::vector<RimEdge>>& edges) const {
        Point sum{};
        double weight = 0;
        for (const auto i : members) {
            for (const auto& edge : edges[i]) {
                const double* a = zones_[i].surface->points().data() + 3 * edge.a;
                const double* b = zones_[i].surface->points().data() + 3 * edge.b;
                const double length = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
                weight += length;
                for (std::size_t k = 0; k < 3; ++k) {
                    sum[k] += length * 0.5 * (a[k] + b[k]);
                }
            }
        }
        return weight > 0 ? Point{sum[0] / weight, sum[1] / weight, sum[2] / weight} : origin_;
    }

    void extent(Point& lower, Point& upper) const {
        lower.fill(std::numeric_limits<double>::infinity());
        upper.fill(-std::numeric_limits<double>::infinity());
        for (const auto& zone : zones_) {
            for (std::size_t i = 0; i < zone.surface->points().size(); ++i) {
                lower[i % 3] = std::min(lower[i % 3], zone.surface->points()[i]);
                upper[i % 3] = std::max(upper[i % 3], zone.surface->points()[i]);
            }
        }
    }
    [[nodiscard]] Point centre_of_all() const {
        Point lower, upper;
        extent(lower, upper);
        return {0.5 * (lower[0] + upper[0]), 0.5 * (lower[1] + upper[1]), 0.5 * (lower[2] + upper[2])};
    }
    [[nodiscard]] double size() const {
        Point lower, upper;
        extent(lower, upper);
        return std::hypot(upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]);
    }

    const std::vector<FacingZone>& zones_;
    int symmetry_;
    Point origin_;
    int dimension_;
    double area_ = 0;
    Facing facing_;
};

}  // namespace

Facing settle_facing(const std::vector<FacingZone>& zones, int symmetry, const std::array<double, 3>& origin,
                     int dimension) {
    return Settler(zones, symmetry, origin, dimension).settle();
}

}  // namespace underbody::postproc
