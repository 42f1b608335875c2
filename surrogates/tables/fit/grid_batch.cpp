// Many points at once on two axes: first where they lie, then four polynomials side by side.
//
// The same products and sums in the same order as for one point, on vectors of four: AVX2 where the machine has it,
// pairs of SSE2 otherwise. No fused multiply-add, so that every machine gives the same bits.
#include <algorithm>
#include <cstdint>

#include "surrogates/tables/fit/grid.h"

namespace underbody::tables {

namespace {

using Four = double __attribute__((vector_size(32)));
using FourMasks = std::int64_t __attribute__((vector_size(32)));

constexpr std::size_t block = 128;

/// Where the points of a block lie.
struct Spots {
    alignas(32) double u[block];
    alignas(32) double v[block];
    alignas(32) std::int64_t held_u[block];  ///< all bits set: held at an end
    alignas(32) std::int64_t held_v[block];
    const double* cell[block];  ///< 16 coefficients
};

inline __attribute__((always_inline)) void load(Four& to, const double* from) {
    __builtin_memcpy(&to, from, sizeof to);
}

/// rows[i][j] -> rows[j][i]
inline __attribute__((always_inline)) void transpose(Four (&rows)[4]) {
    const Four a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6);
    const Four b = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
    const Four c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6);
    const Four d = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
    rows[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    rows[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    rows[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    rows[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/// `count` up to a multiple of four has been filled in.
template <bool with_slope>
inline __attribute__((always_inline)) void polynomials(const Spots& s, std::size_t count, double* value,
                                                       double* slope) {
    for (std::size_t i = 0; i < count; i += 4) {
        Four p[4];
        [[maybe_unused]] Four d[4];
        for (std::size_t q = 0; q < 4; ++q) {
            const double* c = s.cell[i + q];
            const double at = s.v[i + q];
            const Four v = {at, at, at, at};
            Four c0, c1, c2, c3;
            load(c0, c);
            load(c1, c + 4);
            load(c2, c + 8);
            load(c3, c + 12);
            p[q] = c0 + v * (c1 + v * (c2 + v * c3));
            if constexpr (with_slope) {
                d[q] = c1 + v * (2 * c2 + 3 * v * c3);
            }
        }
        transpose(p);
        Four u;
        load(u, &s.u[i]);
        const Four result = p[0] + u * (p[1] + u * (p[2] + u * p[3]));
        __builtin_memcpy(value + i, &result, sizeof result);
        if constexpr (with_slope) {
            transpose(d);
            FourMasks held_u, held_v;
            __builtin_memcpy(&held_u, &s.held_u[i], sizeof held_u);
            __builtin_memcpy(&held_v, &s.held_v[i], sizeof held_v);
            const Four along_u = p[1] + u * (2 * p[2] + 3 * u * p[3]);
            const Four along_v = d[0] + u * (d[1] + u * (d[2] + u * d[3]));
            FourMasks a, b;
            __builtin_memcpy(&a, &along_u, sizeof a);
            __builtin_memcpy(&b, &along_v, sizeof b);
            a &= ~held_u;
            b &= ~held_v;
            const FourMasks first = __builtin_shufflevector(a, b, 0, 4, 1, 5);
            const FourMasks second = __builtin_shufflevector(a, b, 2, 6, 3, 7);
            __builtin_memcpy(slope + 2 * i, &first, sizeof first);
            __builtin_memcpy(slope + 2 * i + 4, &second, sizeof second);
        }
    }
}

inline __attribute__((always_inline)) void polynomials(const Spots& s, std::size_t count, double* value,
                                                       double* slope) {
    if (slope != nullptr) {
        polynomials<true>(s, count, value, slope);
    } else {
        polynomials<false>(s, count, value, slope);
    }
}

using Polynomials = void (*)(const Spots& s, std::size_t count, double* value, double* slope);

void polynomials_plain(const Spots& s, std::size_t count, double* value, double* slope) {
    polynomials(s, count, value, slope);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void polynomials_avx2(const Spots& s, std::size_t count, double* value, double* slope) {
    polynomials(s, count, value, slope);
}

Polynomials best() { return __builtin_cpu_supports("avx2") ? polynomials_avx2 : polynomials_plain; }
#else
Polynomials best() { return polynomials_plain; }
#endif

}  // namespace

void CubicGrid::values(const double* points, std::size_t count, double* value, double* slope) const noexcept {
    const std::size_t n = axes_.size();
    if (n != 2) {
        for (std::size_t i = 0; i < count; ++i) {
            value[i] = this->value(points + i * n, slope != nullptr ? slope + i * n : nullptr);
        }
        return;
    }
    static const Polynomials evaluate = best();
    const std::size_t columns = axes_[1].size() - 1;
    Spots spots;
    double last_value[block];
    double last_slope[2 * block];
    for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t size = std::min(block, count - begin);
        for (std::size_t i = 0; i < size; ++i) {
            const double* point = points + 2 * (begin + i);
            const Spot a = spot(0, point[0]);
            const Spot b = spot(1, point[1]);
            spots.u[i] = a.offset;
            spots.v[i] = b.offset;
            spots.held_u[i] = a.held ? -1 : 0;
            spots.held_v[i] = b.held ? -1 : 0;
            spots.cell[i] = bicubics_[a.cell * columns + b.cell].c;
            __builtin_prefetch(spots.cell[i]);
            __builtin_prefetch(spots.cell[i] + 8);
        }
        const std::size_t whole = (size + 3) / 4 * 4;
        for (std::size_t i = size; i < whole; ++i) {
            spots.u[i] = spots.v[i] = 0;
            spots.held_u[i] = spots.held_v[i] = 0;
            spots.cell[i] = spots.cell[0];
        }
        if (whole == size) {
            evaluate(spots, size, value + begin, slope != nullptr ? slope + 2 * begin : nullptr);
            continue;
        }
        evaluate(spots, whole, last_value, slope != nullptr ? last_slope : nullptr);
        std::copy_n(last_value, size, value + begin);
        if (slope != nullptr) {
            std::copy_n(last_slope, 2 * size, slope + 2 * begin);
        }
    }
}

}  // namespace underbody::tables
