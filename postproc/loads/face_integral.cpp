#include "postproc/loads/face_integral.h"

#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace underbody::postproc {

namespace {

// Three numbers in the four lanes of one register: with AVX2 every operation below is an instruction or two.
#pragma GCC diagnostic ignored "-Wpsabi"
using Lanes __attribute__((vector_size(32))) = double;

struct V3 {
    Lanes v{0, 0, 0, 0};
};
#define UNDERBODY_INLINE [[gnu::always_inline]] inline
UNDERBODY_INLINE V3 make(double x, double y, double z) { return {Lanes{x, y, z, 0}}; }
UNDERBODY_INLINE V3 operator+(const V3& a, const V3& b) { return {a.v + b.v}; }
UNDERBODY_INLINE V3 operator-(const V3& a, const V3& b) { return {a.v - b.v}; }
UNDERBODY_INLINE V3 operator*(double s, const V3& a) { return {s * a.v}; }
UNDERBODY_INLINE Lanes turned(const Lanes& a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); }
UNDERBODY_INLINE V3 cross(const V3& a, const V3& b) { return {turned(a.v * turned(b.v) - turned(a.v) * b.v)}; }
UNDERBODY_INLINE double dot(const V3& a, const V3& b) {
    const Lanes product = a.v * b.v;
    return product[0] + product[1] + product[2];
}
UNDERBODY_INLINE double norm(const V3& a) { return std::sqrt(dot(a, a)); }

/// The sums in the making, in registers.
struct Sums {
    double area = 0;
    V3 area_vector, pressure_force, pressure_moment, shear_force, shear_moment, flux_of_place;

    UNDERBODY_INLINE void place(const V3& x, const V3& a) { flux_of_place.v += x.v * a.v; }
    /// Adds those of a face whose area and shear count `share` times.
    UNDERBODY_INLINE void add(const Sums& face, double share) {
        area += share * face.area;
        area_vector = area_vector + face.area_vector;
        pressure_force = pressure_force + face.pressure_force;
        pressure_moment = pressure_moment + face.pressure_moment;
        shear_force = shear_force + share * face.shear_force;
        shear_moment = shear_moment + share * face.shear_moment;
        flux_of_place = flux_of_place + face.flux_of_place;
    }
};

/// Reads what belongs to a face. `node_pressure`, `node_shear`: values by node, else one for the face; without a
/// pressure the shape alone is summed.
template <bool has_pressure, bool node_pressure, bool node_shear, bool has_shear>
class Kernel {
public:
    Kernel(const SurfaceArrays& surface, const FaceValues& values, const std::array<double, 3>& origin)
        : points_(surface.points().data()),
          offsets_(surface.offsets().data()),
          nodes_(surface.connectivity().data()),
          pressure_(values.pressure.data()),
          shear_(values.shear.data()),
          reference_(values.reference_pressure),
          origin_(make(origin[0], origin[1], origin[2])) {}

    UNDERBODY_INLINE void add(std::size_t face, Sums& sums) const {
        const Index* n = nodes_ + offsets_[face];
        const Index count = offsets_[face + 1] - offsets_[face];
        if (count == 4) {
            quad(face, n, sums);
        } else if (count == 3) {
            triangle({point(n[0]), point(n[1]), point(n[2])}, {p(face, n[0]), p(face, n[1]), p(face, n[2])},
                     {t(face, n[0]), t(face, n[1]), t(face, n[2])}, sums);
        } else if (count > 4) {
            polygon(face, n, count, sums);
        }
    }

private:
    [[nodiscard]] UNDERBODY_INLINE V3 point(Index n) const {
        const double* x = points_ + 3 * n;
        return make(x[0], x[1], x[2]) - origin_;
    }
    [[nodiscard]] UNDERBODY_INLINE double p(std::size_t face, Index n) const {
        if constexpr (!has_pressure) {
            return 0;
        }
        return (node_pressure ? pressure_[n] : pressure_[face]) - reference_;
    }
    [[nodiscard]] UNDERBODY_INLINE V3 t(std::size_t face, Index n) const {
        if constexpr (!has_shear) {
            return {};
        }
        const double* s = shear_ + (node_shear ? 3 * static_cast<std::size_t>(n) : 3 * face);
        return make(s[0], s[1], s[2]);
    }

    /// Linear values: the integral of a product of two linear functions over a triangle is
    /// A/12 (sum f sum g + sum f_k g_k).
    UNDERBODY_INLINE static void triangle(const std::array<V3, 3>& x, const std::array<double, 3>& p,
                                          const std::array<V3, 3>& t, Sums& sums) {
        const V3 a = 0.5 * cross(x[1] - x[0], x[2] - x[0]);
        const V3 middle = x[0] + x[1] + x[2];
        const double p_sum = p[0] + p[1] + p[2];
        const V3 xp = p_sum * middle + (p[0] * x[0] + p[1] * x[1] + p[2] * x[2]);
        sums.area_vector = sums.area_vector + a;
        sums.pressure_force = sums.pressure_force - (p_sum / 3) * a;
        sums.pressure_moment = sums.pressure_moment - (1.0 / 12) * cross(xp, a);
        sums.place((1.0 / 3) * middle, a);
        const double area = norm(a);
        sums.area += area;
        if constexpr (has_shear) {
            const V3 t_sum = t[0] + t[1] + t[2];
            const V3 xt = cross(middle, t_sum) + cross(x[0], t[0]) + cross(x[1], t[1]) + cross(x[2], t[2]);
            sums.shear_force = sums.shear_force + (area / 3) * t_sum;
            sums.shear_moment = sums.shear_moment + (area / 12) * xt;
        }
    }

    /// x = a + b u + c v + d u v over the square [-1, 1]^2, p and t likewise; the normal x_u cross x_v is
    /// N0 + N1 u + N2 v, so that every integral below is a polynomial's.
    UNDERBODY_INLINE void quad(std::size_t face, const Index* n, Sums& sums) const {
        const std::array<V3, 4> x = {point(n[0]), point(n[1]), point(n[2]), point(n[3])};
        const V3 a = 0.25 * ((x[0] + x[1]) + (x[2] + x[3]));
        const V3 b = 0.25 * ((x[1] - x[0]) + (x[2] - x[3]));
        const V3 c = 0.25 * ((x[2] - x[1]) + (x[3] - x[0]));
        const V3 d = 0.25 * ((x[0] - x[1]) + (x[2] - x[3]));
        const V3 n0 = cross(b, c);
        const V3 n1 = cross(b, d);
        const V3 n2 = cross(d, c);
        sums.area_vector = sums.area_vector + 4.0 * n0;
        sums.place(4.0 * a, n0);
        sums.place((4.0 / 3) * b, n1);
        sums.place((4.0 / 3) * c, n2);
        if constexpr (node_pressure) {
            const std::array<double, 4> p = {pressure_[n[0]], pressure_[n[1]], pressure_[n[2]], pressure_[n[3]]};
            const double p0 = 0.25 * ((p[0] + p[1]) + (p[2] + p[3])) - reference_;
            const double pu = 0.25 * ((p[1] - p[0]) + (p[2] - p[3]));
            const double pv = 0.25 * ((p[2] - p[1]) + (p[3] - p[0]));
            const double pd = 0.25 * ((p[0] - p[1]) + (p[2] - p[3]));
            sums.pressure_force = sums.pressure_force - (4.0 * p0 * n0 + (4.0 / 3) * (pu * n1 + pv * n2));
            const V3 q0 = p0 * a + (1.0 / 3) * (pu * b + pv * c) + (pd / 9) * d;
            const V3 qu = (1.0 / 3) * (p0 * b + pu * a) + (1.0 / 9) * (pv * d + pd * c);
            const V3 qv = (1.0 / 3) * (p0 * c + pv * a) + (1.0 / 9) * (pu * d + pd * b);
            sums.pressure_moment = sums.pressure_moment - 4.0 * (cross(q0, n0) + cross(qu, n1) + cross(qv, n2));
        } else if constexpr (has_pressure) {
            const double p0 = 4.0 * (pressure_[face] - reference_);
            sums.pressure_force = sums.pressure_force - p0 * n0;
            sums.pressure_moment =
                sums.pressure_moment - p0 * (cross(a, n0) + (1.0 / 3) * (cross(b, n1) + cross(c, n2)));
        }
        const double size = norm(n0);
        sums.area += 4.0 * size;
        if constexpr (has_shear) {
            const double per = size > 0 ? 1 / size : 0;
            const double su = dot(n1, n0) * per;  // the area's density to first order: size + su u + sv v
            const double sv = dot(n2, n0) * per;
            quad_shear(face, n, {a, b, c, d}, {size, su, sv}, sums);
        }
    }

    UNDERBODY_INLINE void quad_shear(std::size_t face, const Index* n, const std::array<V3, 4>& x,
                                     const std::array<double, 3>& s, Sums& sums) const {
        const auto& [a, b, c, d] = x;
        if constexpr (node_shear) {
            const V3 ta = t(face, n[0]);
            const V3 tb = t(face, n[1]);
            const V3 tc = t(face, n[2]);
            const V3 te = t(face, n[3]);
            const V3 t0 = 0.25 * ((ta + tb) + (tc + te));
            const V3 tu = 0.25 * ((tb - ta) + (tc - te));
            const V3 tv = 0.25 * ((tc - tb) + (te - ta));
            const V3 td = 0.25 * ((ta - tb) + (tc - te));
            sums.shear_force = sums.shear_force + 4.0 * s[0] * t0 + (4.0 / 3) * (s[1] * tu + s[2] * tv);
            // cross(x, t) weighted by the area's density; the same moments as for the pressure, gathered by t.
            const V3 of0 = s[0] * a + (1.0 / 3) * (s[1] * b + s[2] * c);
            const V3 ofu = (1.0 / 3) * (s[0] * b + s[1] * a) + (1.0 / 9) * (s[2] * d);
            const V3 ofv = (1.0 / 3) * (s[0] * c + s[2] * a) + (1.0 / 9) * (s[1] * d);
            const V3 ofd = (1.0 / 9) * (s[0] * d + s[1] * c + s[2] * b);
            sums.shear_moment =
                sums.shear_moment + 4.0 * (cross(of0, t0) + cross(ofu, tu) + cross(ofv, tv) + cross(ofd, td));
        } else {
            const V3 t0 = t(face, n[0]);
            sums.shear_force = sums.shear_force + 4.0 * s[0] * t0;
            sums.shear_moment = sums.shear_moment + 4.0 * cross(s[0] * a + (1.0 / 3) * (s[1] * b + s[2] * c), t0);
        }
    }

    /// A fan of triangles around the mean of the corners. The area that shear acts on is the size of the area vector,
    /// as in finite-volume solvers (and for quadrilaterals above): the triangles of a warped polygon have more
    /// together.
    UNDERBODY_INLINE void polygon(std::size_t face, const Index* n, Index count, Sums& sums) const {
        V3 centre;
        V3 t_centre;
        double p_centre = 0;
        for (Index i = 0; i < count; ++i) {
            centre = centre + point(n[i]);
            p_centre += p(face, n[i]);
            t_centre = t_centre + t(face, n[i]);
        }
        const double per = 1.0 / static_cast<double>(count);
        centre = per * centre;
        t_centre = per * t_centre;
        p_centre *= per;
        Sums own;
        for (Index i = 0; i < count; ++i) {
            const Index m = n[i];
            const Index o = n[i + 1 < count ? i + 1 : 0];
            triangle({centre, point(m), point(o)}, {p_centre, p(face, m), p(face, o)},
                     {t_centre, t(face, m), t(face, o)}, own);
        }
        sums.add(own, own.area > 0 ? norm(own.area_vector) / own.area : 0);
    }

    const double* points_;
    const Index* offsets_;
    const Index* nodes_;
    const double* pressure_;
    const double* shear_;
    double reference_;
    V3 origin_;
};

std::array<double, 3> plain(const V3& v) { return {v.v[0], v.v[1], v.v[2]}; }

FaceSums plain(const Sums& sums) {
    return {sums.area,
            plain(sums.area_vector),
            plain(sums.pressure_force),
            plain(sums.pressure_moment),
            plain(sums.shear_force),
            plain(sums.shear_moment),
            plain(sums.flux_of_place)};
}

template <bool has_pressure, bool node_pressure, bool node_shear, bool has_shear>
UNDERBODY_INLINE FaceSums sum_of(const SurfaceArrays& surface, const FaceValues& values,
                                 const std::array<double, 3>& origin, std::size_t from, std::size_t to) {
    const Kernel<has_pressure, node_pressure, node_shear, has_shear> kernel(surface, values, origin);
    Sums sums;
    for (std::size_t f = from; f < to; ++f) {
        kernel.add(f, sums);
    }
    return plain(sums);
}

using Range = FaceSums (*)(const SurfaceArrays&, const FaceValues&, const std::array<double, 3>&, std::size_t,
                           std::size_t);

// The same code twice: for every processor, and for those with AVX2.
template <bool has_pressure, bool node_pressure, bool node_shear, bool has_shear>
FaceSums sum_range(const SurfaceArrays& surface, const FaceValues& values, const std::array<double, 3>& origin,
                   std::size_t from, std::size_t to) {
    return sum_of<has_pressure, node_pressure, node_shear, has_shear>(surface, values, origin, from, to);
}

#if defined(__x86_64__)
template <bool has_pressure, bool node_pressure, bool node_shear, bool has_shear>
[[gnu::target("avx2,fma")]] FaceSums sum_range_avx2(const SurfaceArrays& surface, const FaceValues& values,
                                                    const std::array<double, 3>& origin, std::size_t from,
                                                    std::size_t to) {
    return sum_of<has_pressure, node_pressure, node_shear, has_shear>(surface, values, origin, from, to);
}

template <bool has_pressure, bool node_pressure, bool node_shear, bool has_shear>
Range pick() {
    static const bool wide = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
    return wide ? sum_range_avx2<has_pressure, node_pressure, node_shear, has_shear>
                : sum_range<has_pressure, node_pressure, node_shear, has_shear>;
}
#else
template <bool has_pressure, bool node_pressure, bool node_shear, bool has_shear>
Range pick() {
    return sum_range<has_pressure, node_pressure, node_shear, has_shear>;
}
#endif

Range range_for(const FaceValues& values) {
    if (values.pressure.empty()) {
        return pick<false, false, false, false>();
    }
    if (values.shear.empty()) {
        return values.pressure_on_nodes ? pick<true, true, false, false>() : pick<true, false, false, false>();
    }
    if (values.pressure_on_nodes) {
        return values.shear_on_nodes ? pick<true, true, true, true>() : pick<true, true, false, true>();
    }
    return values.shear_on_nodes ? pick<true, false, true, true>() : pick<true, false, false, true>();
}

}  // namespace

FaceSums& FaceSums::operator+=(const FaceSums& other) {
    area += other.area;
    for (std::size_t i = 0; i < 3; ++i) {
        area_vector[i] += other.area_vector[i];
        pressure_force[i] += other.pressure_force[i];
        pressure_moment[i] += other.pressure_moment[i];
        shear_force[i] += other.shear_force[i];
        shear_moment[i] += other.shear_moment[i];
        flux_of_place[i] += other.flux_of_place[i];
    }
    return *this;
}

FaceSums integrate_faces(const SurfaceArrays& surface, const FaceValues& values, const std::array<double, 3>& origin,
                         core::Progress& progress) {
    // Blocks of one size, added in their order: the same sum whatever the number of threads.
    constexpr std::size_t block = 32768;
    const Range range = range_for(values);
    std::vector<FaceSums> parts((surface.faces() + block - 1) / block);
    core::parallel_blocks(
        surface.faces(), block,
        [&](std::size_t from, std::size_t to) { parts[from / block] = range(surface, values, origin, from, to); },
        progress);
    FaceSums total;
    for (const auto& part : parts) {
        total += part;
    }
    return total;
}

FaceSums integrate_face(const SurfaceArrays& surface, const FaceValues& values, const std::array<double, 3>& origin,
                        std::size_t face) {
    return range_for(values)(surface, values, origin, face, face + 1);
}

}  // namespace underbody::postproc
