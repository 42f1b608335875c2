// A second method beside the closed forms of the film under an elliptic base: Reynolds' equation by linear finite
// elements, which know neither the polynomial that solves it nor its integral.
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "surrogates/dynamics/theory/film.h"

namespace underbody::dynamics {
namespace {

/// Triangles of an ellipse in rings around its centre: ring r has 6 r points, the rim comes last.
struct EllipseMesh {
    std::vector<Eigen::Vector2d> points{{0, 0}};
    std::vector<std::array<int, 3>> triangles;
    int inner = 0;

    EllipseMesh(double half_length, double half_width, int rings) {
        const auto at = [](int ring, int k) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + k % (6 * ring); };
        for (int r = 1; r <= rings; ++r) {
            inner = static_cast<int>(points.size());
            for (int k = 0; k < 6 * r; ++k) {
                const double angle = 2 * std::numbers::pi * k / (6 * r), radius = double(r) / rings;
                points.emplace_back(half_length * radius * std::cos(angle), half_width * radius * std::sin(angle));
            }
            for (int k = 0; k < 6 * r; ++k) {
                const int inside = k - k / r;
                triangles.push_back({at(r, k), at(r, k + 1), at(r - 1, inside)});
                if (k % r + 1 < r) {
                    triangles.push_back({at(r, k + 1), at(r - 1, inside + 1), at(r - 1, inside)});
                }
            }
        }
    }
};

/// Integral of the pressure p with div(h^3 grad p) = 12 mu dh/dt and p = 0 on the rim (N), for a uniform gap.
double film_force(const EllipseMesh& mesh, double gap, double viscosity, double rate) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(mesh.inner);  // integrals of the hat functions
    for (const auto& triangle : mesh.triangles) {
        std::array<Eigen::Vector2d, 3> side;
        for (std::size_t i = 0; i < 3; ++i) {
            side[i] = mesh.points[static_cast<std::size_t>(triangle[(i + 2) % 3])] -
                      mesh.points[static_cast<std::size_t>(triangle[(i + 1) % 3])];
        }
        const double area = (side[0].x() * side[1].y() - side[0].y() * side[1].x()) / 2;
        EXPECT_GT(area, 0);
        for (std::size_t i = 0; i < 3; ++i) {
            if (triangle[i] < mesh.inner) {
                weights[triangle[i]] += area / 3;
                for (std::size_t j = 0; j < 3; ++j) {
                    if (triangle[j] < mesh.inner) {
                        entries.emplace_back(triangle[i], triangle[j], side[i].dot(side[j]) / (4 * area));
                    }
                }
            }
        }
    }
    Eigen::SparseMatrix<double> stiffness(mesh.inner, mesh.inner);
    stiffness.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(stiffness);
    return -12 * viscosity * rate / std::pow(gap, 3) * weights.dot(solver.solve(weights));
}

TEST(FilmElements, AgreeWithTheClosedFormsOfTheEllipseAndConvergeTwofoldInOrder) {
    struct Base {
        double half_length, half_width;
    };
    for (const auto& [a, b] : {Base{.0717, .0536}, Base{.06, .06}, Base{.1, .02}}) {
        constexpr double gap = 1e-3, viscosity = 1e-3, rate = -1e-3;
        const double closed = -squeeze_damping(a, b, gap, viscosity) * rate;
        std::array<double, 3> error{};
        for (std::size_t i = 0; i < 3; ++i) {
            error[i] = film_force(EllipseMesh(a, b, 10 << i), gap, viscosity, rate) / closed - 1;
        }
        EXPECT_NEAR(error[2], 0, 2e-3) << a << " x " << b;
        EXPECT_NEAR(error[0] / error[1], 4, 0.3) << a << " x " << b;
        EXPECT_NEAR(error[1] / error[2], 4, 0.15) << a << " x " << b;
    }
}

}  // namespace
}  // namespace underbody::dynamics
