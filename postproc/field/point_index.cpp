#include "postproc/field/point_index.h"

#include <cmath>

namespace underbody::postproc {

namespace {

std::uint64_t hash_of(std::int64_t i, std::int64_t j, std::int64_t k) {
    return static_cast<std::uint64_t>(i) * 73856093ULL ^ static_cast<std::uint64_t>(j) * 19349663ULL ^
           static_cast<std::uint64_t>(k) * 83492791ULL;
}

/// One of the eight cells nearest to the point: everything within half a cell lies in one of them.
std::uint64_t cell_near(const double* x, double size, int corner) {
    std::array<std::int64_t, 3> i{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double at = x[k] / size;
        const double cell = std::floor(at);
        const bool lower = at - cell < 0.5;
        i[k] = std::llround(cell) + (((corner >> k) & 1) != 0 ? (lower ? -1 : 1) : 0);
    }
    return hash_of(i[0], i[1], i[2]);
}

}  // namespace

std::int64_t Places::find(const double* x) const {
    for (int corner = 0; corner < 8; ++corner) {
        const auto found = cells_.find(cell_near(x, cell_, corner));
        if (found == cells_.end()) {
            continue;
        }
        for (const auto i : found->second) {
            const auto& p = points_[static_cast<std::size_t>(i)];
            if (std::hypot(p[0] - x[0], p[1] - x[1], p[2] - x[2]) <= tolerance_) {
                return i;
            }
        }
    }
    return -1;
}

std::int64_t Places::number(const double* x) {
    if (const auto known = find(x); known >= 0) {
        return known;
    }
    const auto next = static_cast<std::int64_t>(points_.size());
    points_.push_back({x[0], x[1], x[2]});
    cells_[cell_near(x, cell_, 0)].push_back(next);
    return next;
}

}  // namespace underbody::postproc
