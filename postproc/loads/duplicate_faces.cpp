#include "postproc/loads/duplicate_faces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "postproc/field/vector_math.h"

namespace underbody::postproc {

namespace {

struct Face {
    std::uint64_t key;  ///< of the place of its centre
    std::uint32_t zone;
    std::uint32_t face;
};

class Finder {
public:
    explicit Finder(const std::vector<SummedZone>& zones) : zones_(zones) {
        Vector lower = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
        Vector upper = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
        for (const auto& zone : zones) {
            const auto points = zone.surface->points();
            for (std::size_t i = 0; i < points.size(); ++i) {
                lower[i % 3] = std::min(lower[i % 3], points[i]);
                upper[i % 3] = std::max(upper[i % 3], points[i]);
            }
            for (const double p : zone.values.pressure) {
                largest_pressure_ = std::max(largest_pressure_, std::abs(p));
            }
        }
        tolerance_ = 1e-6 * norm(plus(upper, lower, -1));
        corner_ = lower;
    }

    std::vector<DoubledZone> find() {
        match();
        std::vector<DoubledZone> doubled;
        std::vector<bool> taken(zones_.size(), false);
        for (std::size_t z = zones_.size(); z-- > 0;) {
            const DoubledZone one = partners_of(z, taken);
            if (one.whole) {
                taken[z] = true;
                doubled.push_back(one);
            }
        }
        for (std::size_t z = 0; z < zones_.size(); ++z) {
            const DoubledZone one = taken[z] ? DoubledZone{} : partners_of(z, taken);
            if (one.faces > 0) {
                doubled.push_back(one);
            }
        }
        return doubled;
    }

private:
    [[nodiscard]] std::size_t corners(std::size_t zone, std::size_t face) const {
        const auto offsets = zones_[zone].surface->offsets();
        return static_cast<std::size_t>(offsets[face + 1] - offsets[face]);
    }
    [[nodiscard]] Index node(std::size_t zone, std::size_t face, std::size_t i) const {
        return zones_[zone]
            .surface->connectivity()[static_cast<std::size_t>(zones_[zone].surface->offsets()[face]) + i];
    }
    [[nodiscard]] Vector point(std::size_t zone, std::size_t face, std::size_t i) const {
        const double* x = zones_[zone].surface->points().data() + 3 * node(zone, face, i);
        return {x[0], x[1], x[2]};
    }

    [[nodiscard]] std::uint64_t key_of(std::size_t zone, std::size_t face) const {
        Vector centre{};
        const std::size_t count = corners(zone, face);
        for (std::size_t i = 0; i < count; ++i) {
            centre = plus(centre, point(zone, face, i), 1.0 / static_cast<double>(count));
        }
        std::uint64_t key = 1469598103934665603ULL;
        for (std::size_t k = 0; k < 3; ++k) {
            // The odd share keeps the borders of the cells away from the round numbers of regular meshes.
            const auto cell = static_cast<std::uint64_t>(
                std::llround(std::floor((centre[k] - corner_[k]) / (4 * tolerance_) + 0.381966)));
            key = (key ^ cell) * 1099511628211ULL;
            key ^= key >> 29;
        }
        return key;
    }

    [[nodiscard]] double pressure_on(std::size_t zone, std::size_t face) const {
        const FaceValues& values = zones_[zone].values;
        if (!values.pressure_on_nodes) {
            return values.pressure[face];
        }
        double sum = 0;
        for (std::size_t i = 0; i < corners(zone, face); ++i) {
            sum += values.pressure[static_cast<std::size_t>(node(zone, face, i))];
        }
        return sum / static_cast<double>(corners(zone, face));
    }

    [[nodiscard]] Vector area_vector(std::size_t zone, std::size_t face) const {
        Vector sum{};
        const Vector first = point(zone, face, 0);
        for (std::size_t i = 1; i + 1 < corners(zone, face); ++i) {
            sum = plus(sum, cross(plus(point(zone, face, i), first, -1), plus(point(zone, face, i + 1), first, -1)));
        }
        return sum;
    }

    [[nodiscard]] bool same(const Face& a, const Face& b) const {
        const std::size_t count = corners(a.zone, a.face);
        if (a.zone == b.zone || count != corners(b.zone, b.face)) {
            return false;
        }
        for (std::size_t i = 0; i < count; ++i) {
            bool there = false;
            for (std::size_t j = 0; j < count && !there; ++j) {
                there = norm(plus(point(a.zone, a.face, i), point(b.zone, b.face, j), -1)) <= tolerance_;
            }
            if (!there) {
                return false;
            }
        }
        if (dot(area_vector(a.zone, a.face), area_vector(b.zone, b.face)) < 0) {
            return false;
        }
        constexpr double printed = 1e-5;
        return std::abs(pressure_on(a.zone, a.face) - pressure_on(b.zone, b.face)) <= printed * largest_pressure_;
    }

    /// Which zones each face of each zone stands in, beside its own.
    void match() {
        std::vector<Face> faces;
        for (std::size_t z = 0; z < zones_.size(); ++z) {
            partners_.emplace_back(zones_[z].surface->faces());
            for (std::size_t f = 0; f < zones_[z].surface->faces(); ++f) {
                faces.push_back({key_of(z, f), static_cast<std::uint32_t>(z), static_cast<std::uint32_t>(f)});
            }
        }
        std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
            return std::tie(a.key, a.zone, a.face) < std::tie(b.key, b.zone, b.face);
        });
        for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
            while (end < faces.size() && faces[end].key == faces[begin].key) {
                ++end;
            }
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t j = i + 1; j < end; ++j) {
                    if (same(faces[i], faces[j])) {
                        partners_[faces[i].zone][faces[i].face].push_back(faces[j].zone);
                        partners_[faces[j].zone][faces[j].face].push_back(faces[i].zone);
                    }
                }
            }
        }
    }

    [[nodiscard]] DoubledZone partners_of(std::size_t zone, const std::vector<bool>& taken) const {
        DoubledZone one;
        one.zone = zone;
        for (const auto& partners : partners_[zone]) {
            bool there = false;
            for (const auto other : partners) {
                if (taken[other]) {
                    continue;
                }
                there = true;
                if (std::find(one.others.begin(), one.others.end(), other) == one.others.end()) {
                    one.others.push_back(other);
                }
            }
            one.faces += there ? 1 : 0;
        }
        one.whole = one.faces > 0 && one.faces == partners_[zone].size();
        std::sort(one.others.begin(), one.others.end());
        return one;
    }

    const std::vector<SummedZone>& zones_;
    double tolerance_ = 0;
    double largest_pressure_ = 0;
    Vector corner_{};
    std::vector<std::vector<std::vector<std::uint32_t>>> partners_;  ///< by zone and face
};

}  // namespace

std::vector<DoubledZone> doubled_zones(const std::vector<SummedZone>& zones) {
    return zones.size() < 2 ? std::vector<DoubledZone>{} : Finder(zones).find();
}

}  // namespace underbody::postproc
