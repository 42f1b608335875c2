#include "postproc/field/rim_edges.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "postproc/field/point_index.h"

namespace underbody::postproc {

namespace {

std::vector<RimEdge> open_edges(const SurfaceArrays& surface) {
    const auto key = [](Index a, Index b) {
        return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint64_t>(std::max(a, b));
    };
    std::unordered_map<std::uint64_t, int> seen;
    seen.reserve(surface.connectivity().size());
    const auto offsets = surface.offsets();
    const auto nodes = surface.connectivity();
    const auto for_edges = [&](auto&& act) {
        for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
            for (Index i = offsets[f]; i < offsets[f + 1]; ++i) {
                const Index a = nodes[static_cast<std::size_t>(i)];
                const Index b = nodes[static_cast<std::size_t>(i + 1 < offsets[f + 1] ? i + 1 : offsets[f])];
                if (a != b) {
                    act(a, b);
                }
            }
        }
    };
    for_edges([&](Index a, Index b) { ++seen[key(a, b)]; });
    std::vector<RimEdge> edges;
    for_edges([&](Index a, Index b) {
        if (seen[key(a, b)] == 1) {
            edges.push_back({a, b});
        }
    });
    return edges;
}

}  // namespace

SignedGroups::SignedGroups(std::size_t count) : parent_(count), sign_(count, 1.0) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
}

std::pair<std::size_t, double> SignedGroups::root(std::size_t i) const {
    double sign = 1;
    while (parent_[i] != i) {
        sign *= sign_[i];
        i = parent_[i];
    }
    return {i, sign};
}

void SignedGroups::join(std::size_t i, std::size_t j, double relative) {
    const auto [a, sa] = root(i);
    const auto [b, sb] = root(j);
    if (a != b) {
        parent_[b] = a;
        sign_[b] = relative * sa * sb;
    }
}

SignedGroups joined_along_rims(const std::vector<const SurfaceArrays*>& surfaces, double size,
                               std::vector<std::vector<RimEdge>>* unmatched) {
    struct Seen {
        std::size_t surface;
        RimEdge edge;
        bool forward;
    };
    Places places(1e-6 * size);
    std::unordered_map<std::uint64_t, std::vector<Seen>> by_place;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        const double* points = surfaces[s]->points().data();
        for (const RimEdge& edge : open_edges(*surfaces[s])) {
            const auto a = static_cast<std::uint64_t>(places.number(points + 3 * edge.a));
            const auto b = static_cast<std::uint64_t>(places.number(points + 3 * edge.b));
            by_place[(std::min(a, b) << 32) | std::max(a, b)].push_back({s, edge, a < b});
        }
    }
    if (unmatched != nullptr) {
        unmatched->assign(surfaces.size(), {});
    }
    std::vector<std::vector<double>> votes(surfaces.size(), std::vector<double>(surfaces.size(), 0));
    for (const auto& [key, seen] : by_place) {
        if (seen.size() == 2 && seen[0].surface != seen[1].surface) {
            const double vote = seen[0].forward == seen[1].forward ? -1 : 1;
            votes[seen[0].surface][seen[1].surface] += vote;
            votes[seen[1].surface][seen[0].surface] += vote;
        } else if (seen.size() == 1 && unmatched != nullptr) {
            (*unmatched)[seen[0].surface].push_back(seen[0].edge);
        }
    }
    SignedGroups groups(surfaces.size());
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        for (std::size_t j = i + 1; j < surfaces.size(); ++j) {
            if (votes[i][j] != 0) {
                groups.join(i, j, votes[i][j] > 0 ? 1.0 : -1.0);
            }
        }
    }
    return groups;
}

}  // namespace underbody::postproc
