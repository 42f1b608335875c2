// Reynolds' equation under an elliptic base by linear finite elements on rings of triangles.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "surrogates/dynamics/theory/film.h"

namespace underbody::dynamics {

namespace {

constexpr double pi = 3.14159265358979323846;

struct Mesh {
    std::vector<std::array<double, 2>> points;  ///< of the unit disc, ring by ring
    std::vector<std::array<std::size_t, 3>> triangles;
    std::size_t inner = 0;  ///< points that are not on the rim come first
};

/// Ring r of `rings` has 6 r points.
Mesh disc(int rings) {
    Mesh mesh;
    std::vector<std::size_t> start{0};
    mesh.points.push_back({0, 0});
    for (int r = 1; r <= rings; ++r) {
        start.push_back(mesh.points.size());
        for (int k = 0; k < 6 * r; ++k) {
            const double angle = 2 * pi * k / (6 * r);
            mesh.points.push_back({std::cos(angle) * r / rings, std::sin(angle) * r / rings});
        }
    }
    mesh.inner = start.back();
    for (int r = 1; r <= rings; ++r) {
        const auto at = [&](int ring, int k) -> std::size_t {
            return ring == 0 ? 0
                             : start[static_cast<std::size_t>(ring)] +
                                   static_cast<std::size_t>((k % (6 * ring) + 6 * ring) % (6 * ring));
        };
        for (int sector = 0; sector < 6; ++sector) {
            for (int k = 0; k < r; ++k) {
                const int outer = sector * r + k, inside = sector * (r - 1) + k;
                mesh.triangles.push_back({at(r, outer), at(r, outer + 1), at(r - 1, inside)});
                if (k + 1 < r) {
                    mesh.triangles.push_back({at(r, outer + 1), at(r - 1, inside + 1), at(r - 1, inside)});
                }
            }
        }
    }
    return mesh;
}

/// A symmetric matrix in rows of (column, value), and conjugate gradients with the diagonal as preconditioner.
struct Sparse {
    std::vector<std::vector<std::pair<std::size_t, double>>> rows;
    void add(std::size_t i, std::size_t j, double value) {
        for (auto& [column, old] : rows[i]) {
            if (column == j) {
                old += value;
                return;
            }
        }
        rows[i].emplace_back(j, value);
    }
    [[nodiscard]] std::vector<double> solve(const std::vector<double>& right) const {
        const std::size_t n = rows.size();
        std::vector<double> x(n, 0.0), r = right, z(n), p(n), ap(n), diagonal(n, 1.0);
        for (std::size_t i = 0; i < n; ++i) {
            for (const auto& [column, value] : rows[i]) {
                diagonal[i] = column == i ? value : diagonal[i];
            }
            z[i] = r[i] / diagonal[i];
        }
        p = z;
        double rz = 0, first = 0;
        for (std::size_t i = 0; i < n; ++i) {
            rz += r[i] * z[i];
        }
        first = rz;
        for (std::size_t step = 0; step < 10 * n && rz > 1e-26 * first; ++step) {
            double pap = 0;
            for (std::size_t i = 0; i < n; ++i) {
                ap[i] = 0;
                for (const auto& [column, value] : rows[i]) {
                    ap[i] += value * p[column];
                }
                pap += p[i] * ap[i];
            }
            const double alpha = rz / pap;
            double next = 0;
            for (std::size_t i = 0; i < n; ++i) {
                x[i] += alpha * p[i];
                r[i] -= alpha * ap[i];
                z[i] = r[i] / diagonal[i];
                next += r[i] * z[i];
            }
            for (std::size_t i = 0; i < n; ++i) {
                p[i] = z[i] + next / rz * p[i];
            }
            rz = next;
        }
        return x;
    }
};

}  // namespace

EllipticFilm elliptic_film(const EllipticFilmInput& in) {
    // Local x forward from the centre of the base; the gap opens forward when the nose is up.
    const auto gap = [&](double x) { return in.gap * 1.0 + x * std::tan(in.pitch); };
    if (!(gap(in.half_length) > 0) || !(gap(-in.half_length) > 0)) {
        throw core::InputError("range", "the base touches the ground: no film there");
    }
    const Mesh mesh = disc(std::max(in.rings, 2));
    Sparse matrix;
    matrix.rows.resize(mesh.inner);
    std::vector<double> right(mesh.inner, 0.0);
    const double slope = std::tan(in.pitch);
    // div(h^3 grad p) = 6 mu (U_ground - 0) dh/dx + 12 mu dh/dt, with the ground moving at -speed along x in the body's
    // frame.
    for (const auto& triangle : mesh.triangles) {
        std::array<double, 3> x{}, y{};
        for (std::size_t k = 0; k < 3; ++k) {
            x[k] = in.half_length * mesh.points[triangle[k]][0];
            y[k] = in.half_width * mesh.points[triangle[k]][1];
        }
        const double doubled = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        const double area = doubled / 2;
        double cube = 0;  // h^3 is a cubic of x: exact by the mid-side rule up to second order, plenty here
        for (std::size_t k = 0; k < 3; ++k) {
            cube += std::pow(gap((x[k] + x[(k + 1) % 3]) / 2), 3) / 3;
        }
        const double source = -(-6 * in.viscosity * in.speed * slope + 12 * in.viscosity * in.heave_velocity);
        for (std::size_t i = 0; i < 3; ++i) {
            if (triangle[i] >= mesh.inner) {
                continue;
            }
            right[triangle[i]] += source * area / 3;
            for (std::size_t j = 0; j < 3; ++j) {
                if (triangle[j] < mesh.inner) {
                    const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
                    const double product = (y[i1] - y[i2]) * (y[j1] - y[j2]) + (x[i2] - x[i1]) * (x[j2] - x[j1]);
                    matrix.add(triangle[i], triangle[j], cube * product / (4 * area));
                }
            }
        }
    }
    std::vector<double> pressure = matrix.solve(right);
    pressure.resize(mesh.points.size(), 0.0);
    EllipticFilm film;
    for (const auto& triangle : mesh.triangles) {
        std::array<double, 3> x{}, y{};
        for (std::size_t k = 0; k < 3; ++k) {
            x[k] = in.half_length * mesh.points[triangle[k]][0];
            y[k] = in.half_width * mesh.points[triangle[k]][1];
        }
        const double area = ((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])) / 2;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            const double p = (pressure[triangle[k]] + pressure[triangle[next]]) / 2;
            film.lift += p * area / 3;
            film.pitch_moment += p * area / 3 * (x[k] + x[next]) / 2;
        }
    }
    film.highest = *std::max_element(pressure.begin(), pressure.end());
    film.lowest = *std::min_element(pressure.begin(), pressure.end());
    const double widest = std::max(gap(in.half_length), gap(-in.half_length));
    film.reduced_reynolds = std::abs(in.speed) * widest * widest * in.density / (in.viscosity * 2 * in.half_length);
    film.valid = film.reduced_reynolds <= 1;
    return film;
}

}  // namespace underbody::dynamics
