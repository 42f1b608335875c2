#include "geometry/water/added_mass.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/body/body_surface.h"
#include "geometry/body/mass_properties.h"
#include "geometry/water/above_ground.h"
#include "geometry/water/source_panels.h"

namespace underbody::geometry {

namespace {

using Modes = std::array<double, 6>;
constexpr double four_pi = 12.566370614359172;

// The panels of one system with the images that carry their sources too.
struct System {
    std::vector<SourcePanel> panels;
    bool mirrored = false;  // in y: half the body, the sources of the other half have the sign `parity`
    bool ground = false;
};

// Of a panel of unit strength, its image in the ground and, with the sign of `parity`, its images in y.
template <class Value>
double with_images(const System& system, double parity, const Value& value) {
    double sum = value(false, false);
    if (system.ground) {
        sum += value(false, true);
    }
    if (system.mirrored) {
        sum += parity * value(true, false);
        if (system.ground) {
            sum += parity * value(true, true);
        }
    }
    return sum;
}

Vec3 reflected(Vec3 p, bool in_y, bool in_z) {
    p.y = in_y ? -p.y : p.y;
    p.z = in_z ? -p.z : p.z;
    return p;
}

using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The flux of a panel's source through the whole closed surface is known: -4 pi times its strength, and 0 of its
// images. The diagonal takes what the other entries leave of it, which brings in the curvature of the surface at the
// panel itself and makes the method second order (a flat panel alone gives first). `own` holds the diagonal without the
// images in y, found with parity 1 and used for both.
void balance_flux(const System& system, double parity, DenseMatrix& matrix, std::vector<double>& own) {
    const std::size_t n = system.panels.size();
    std::vector<double> in_y(n, 0.0);
    if (system.mirrored) {
        for (std::size_t j = 0; j < n; ++j) {
            const SourcePanel& panel = system.panels[j];
            for (const bool ground : {false, true}) {
                if (!ground || system.ground) {
                    in_y[j] += dot(reflected(panel.normal(), true, ground),
                                   panel.gradient(reflected(panel.centre(), true, ground)));
                }
            }
        }
    }
    if (own.empty()) {
        std::vector<double> flux(n, 0.0);
        for (std::size_t i = 0; i < n; ++i) {
            const double area = system.panels[i].area();
            for (std::size_t j = 0; j < n; ++j) {
                flux[j] += i == j ? 0.0 : area * matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
            }
        }
        for (std::size_t j = 0; j < n; ++j) {
            own.push_back(-four_pi - flux[j] / system.panels[j].area() - in_y[j]);
        }
    }
    for (std::size_t j = 0; j < n; ++j) {
        matrix(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(j)) = own[j] + parity * in_y[j];
    }
}

// Normal velocities at the centroids that sources of strength one on each panel make.
void fill(DenseMatrix& matrix, const System& system, double parity, core::Progress& progress) {
    const std::size_t n = system.panels.size();
    core::parallel_blocks(
        n, 16,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const SourcePanel& here = system.panels[i];
                for (std::size_t j = 0; j < n; ++j) {
                    const SourcePanel& panel = system.panels[j];
                    // A mirrored panel seen from here is the panel seen from the mirrored place.
                    matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
                        with_images(system, parity, [&](bool in_y, bool in_z) {
                            return dot(reflected(here.normal(), in_y, in_z),
                                       panel.gradient(reflected(here.centre(), in_y, in_z)));
                        });
                }
            }
        },
        progress);
}

// Strengths for the given normal velocities (columns), then potentials at the centroids.
Eigen::MatrixXd potentials(const System& system, double parity, const Eigen::MatrixXd& velocities,
                           std::vector<double>& own, core::Progress& progress) {
    const std::size_t n = system.panels.size();
    Eigen::MatrixXd strengths;
    {
        DenseMatrix matrix(n, n);
        fill(matrix, system, parity, progress);
        balance_flux(system, parity, matrix, own);
        progress.check();
        Eigen::PartialPivLU<Eigen::Ref<DenseMatrix>> factors(matrix);  // in place: no second matrix
        progress.check();
        strengths = factors.solve(velocities);
    }
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(velocities.rows(), velocities.cols());
    core::parallel_blocks(
        n, 16,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t j = 0; j < n; ++j) {
                    const double value = with_images(system, parity, [&](bool in_y, bool in_z) {
                        return system.panels[j].potential(reflected(system.panels[i].centre(), in_y, in_z));
                    });
                    result.row(static_cast<Eigen::Index>(i)) += value * strengths.row(static_cast<Eigen::Index>(j));
                }
            }
        },
        progress);
    return result;
}

// The number of triangles of the port half when the second half of the list mirrors the first exactly, else 0.
std::size_t mirrored_count(const SurfaceMesh& mesh) {
    const std::size_t half = mesh.triangles.size() / 2;
    if (mesh.triangles.size() % 2 != 0) {
        return 0;
    }
    for (std::size_t i = 0; i < half; ++i) {
        const auto image = [](Vec3 p) { return reflected(p, true, false); };
        if (!(image(mesh.corner(i, 0)) == mesh.corner(half + i, 0) &&
              image(mesh.corner(i, 1)) == mesh.corner(half + i, 2) &&
              image(mesh.corner(i, 2)) == mesh.corner(half + i, 1))) {
            return 0;
        }
    }
    return half;
}

struct Axes {
    std::array<Vec3, 3> direction;  // surge, sway, heave of the body
    Vec3 reference;
    [[nodiscard]] Modes modes(const SourcePanel& panel) const {
        const Vec3 turning = cross(panel.centre() - reference, panel.normal());
        Modes m{};
        for (std::size_t k = 0; k < 3; ++k) {
            m[k] = dot(direction[k], panel.normal());
            m[3 + k] = dot(direction[k], turning);
        }
        return m;
    }
};

// Adds minus density times the integrals of potential times mode.
void add_system(Matrix6& matrix, const System& system, double parity, const std::vector<std::size_t>& modes,
                const Axes& axes, double density, std::vector<double>& own, core::Progress& progress) {
    const auto n = static_cast<Eigen::Index>(system.panels.size());
    Eigen::MatrixXd velocities(n, static_cast<Eigen::Index>(modes.size()));
    for (Eigen::Index i = 0; i < n; ++i) {
        const Modes m = axes.modes(system.panels[static_cast<std::size_t>(i)]);
        for (std::size_t k = 0; k < modes.size(); ++k) {
            velocities(i, static_cast<Eigen::Index>(k)) = m[modes[k]];
        }
    }
    const Eigen::MatrixXd phi = potentials(system, parity, velocities, own, progress);
    const double factor = -density * (system.mirrored ? 2 : 1);
    for (std::size_t k = 0; k < modes.size(); ++k) {
        for (std::size_t l = 0; l < modes.size(); ++l) {
            double sum = 0;
            for (Eigen::Index i = 0; i < n; ++i) {
                sum += system.panels[static_cast<std::size_t>(i)].area() * phi(i, static_cast<Eigen::Index>(k)) *
                       velocities(i, static_cast<Eigen::Index>(l));
            }
            matrix[modes[k]][modes[l]] += factor * sum;
        }
    }
}

// Symmetric part; returns how far it was from symmetric.
double symmetrise(Matrix6& a) {
    double asymmetry = 0;
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const double size = std::sqrt(std::abs(a[i][i] * a[j][j]));
            if (size > 0) {
                asymmetry = std::max(asymmetry, std::abs(a[i][j] - a[j][i]) / size);
            }
            a[i][j] = a[j][i] = 0.5 * (a[i][j] + a[j][i]);
        }
    }
    return asymmetry;
}

double edge_against_gap(const SurfaceMesh& mesh, double clearance) {
    double longest = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (mesh.centre(i).z < 2 * clearance) {
            for (std::size_t k = 0; k < 3; ++k) {
                longest = std::max(longest, norm(mesh.corner(i, k) - mesh.corner(i, (k + 1) % 3)));
            }
        }
    }
    return longest / clearance;
}

/// Panels of a body, or of its port half, the first `half` triangles, when the rest mirrors them.
System system_of(const SurfaceMesh& body, std::size_t half, bool ground) {
    System system;
    system.mirrored = half > 0;
    system.ground = ground;
    const std::size_t count = half > 0 ? half : body.triangles.size();
    if (count > 20000) {
        throw core::InputError("size",
                               std::to_string(count) + " unknowns would need a matrix of " +
                                   std::to_string(count * count * 8 / 1'000'000'000) + " GB",
                               {}, "take a mesh of fewer triangles");
    }
    for (std::size_t i = 0; i < count; ++i) {
        system.panels.emplace_back(body.corner(i, 0), body.corner(i, 1), body.corner(i, 2));
    }
    return system;
}

}  // namespace

AddedMass added_mass(const SurfaceMesh& mesh, const AddedMassOptions& options, core::Progress& progress) {
    const Vec3 centroid = mass_properties(mesh).centroid;
    AddedMass result;
    result.density = options.density;
    result.placement = options.placement;
    result.reference = options.reference.value_or(centroid);
    result.panels = mesh.triangles.size();
    const Placement placement = options.placement.value_or(Placement{});
    const SurfaceMesh body = options.placement ? placed(mesh, placement) : mesh;
    if (options.placement) {
        const Clearance clear = clearance(mesh, placement);
        require_above_ground(clear, placement);
        result.edge_over_gap = edge_against_gap(body, clear.smallest);
    }
    const std::size_t half = placement.roll == 0 ? mirrored_count(mesh) : 0;
    const System system = system_of(body, half, options.placement.has_value());
    Axes axes;
    const Placement turn{0, placement.pitch, placement.roll};
    axes.direction = {placed({1, 0, 0}, turn), placed({0, -1, 0}, turn), placed({0, 0, -1}, turn)};
    // About a point of the plane of symmetry the modes are even or odd; another point's matrix follows from that one's.
    const Vec3 wanted = result.reference;
    result.reference.y = 0;
    axes.reference = options.placement ? placed(result.reference, placement) : result.reference;
    std::vector<double> own;
    if (half > 0) {
        add_system(result.matrix, system, 1, {0, 2, 4}, axes, options.density, own, progress);
        progress.report(0.5, "added mass");
        add_system(result.matrix, system, -1, {1, 3, 5}, axes, options.density, own, progress);
    } else {
        add_system(result.matrix, system, 1, {0, 1, 2, 3, 4, 5}, axes, options.density, own, progress);
    }
    result.asymmetry = symmetrise(result.matrix);
    return wanted.y == 0 ? result : moved(result, wanted);
}

AddedMass moved(const AddedMass& mass, const Vec3& reference) {
    // With v0 = v + w x d the velocity of the old point, d from the new to the old one in body axes: A' = T^T A T.
    const Vec3 shift = mass.reference - reference;
    const Vec3 d{shift.x, -shift.y, -shift.z};
    Eigen::Matrix<double, 6, 6> a, t = Eigen::Matrix<double, 6, 6>::Identity();
    for (Eigen::Index i = 0; i < 6; ++i) {
        for (Eigen::Index j = 0; j < 6; ++j) {
            a(i, j) = mass.matrix[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
        }
    }
    t(0, 4) = d.z, t(0, 5) = -d.y;
    t(1, 3) = -d.z, t(1, 5) = d.x;
    t(2, 3) = d.y, t(2, 4) = -d.x;
    const Eigen::Matrix<double, 6, 6> b = t.transpose() * a * t;
    AddedMass result = mass;
    result.reference = reference;
    for (Eigen::Index i = 0; i < 6; ++i) {
        for (Eigen::Index j = 0; j < 6; ++j) {
            result.matrix[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = b(i, j);
        }
    }
    return result;
}

void to_json(nlohmann::json& json, const AddedMass& mass) {
    json = {{"added_mass", mass.matrix},
            {"reference", {mass.reference.x, mass.reference.y, mass.reference.z}},
            {"density", mass.density},
            {"panels", mass.panels},
            {"asymmetry", mass.asymmetry},
            {"extrapolation", mass.extrapolation},
            {"axes", "x forward, y starboard, z down, about the reference point"},
            {"gap", nullptr}};
    if (mass.placement) {
        json["gap"] = mass.placement->gap;
        json["pitch"] = mass.placement->pitch;
        json["roll"] = mass.placement->roll;
        json["edge_over_gap"] = mass.edge_over_gap;
    }
    if (mass.fit) {
        json["panel_fit"] = {{"triangles", mass.fit->triangles},
                             {"distance_rms", mass.fit->distance_rms},
                             {"distance_largest", mass.fit->distance_largest},
                             {"volume_error", mass.fit->volume_error}};
    }
}

}  // namespace underbody::geometry
