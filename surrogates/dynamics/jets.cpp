#include "surrogates/dynamics/jets.h"

#include <algorithm>
#include <cmath>

namespace underbody::dynamics {

Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Wrench jet_wrench(std::span<const Jet> jets, std::span<const double> thrust) {
    Wrench sum;
    for (std::size_t i = 0; i < jets.size(); ++i) {
        const Vector3 arm = cross(jets[i].position, jets[i].direction);
        for (std::size_t k = 0; k < 3; ++k) {
            sum.force[k] += thrust[i] * jets[i].direction[k];
            sum.moment[k] += thrust[i] * arm[k];
        }
    }
    return sum;
}

std::vector<Jet> evie_jets(const EvieJets& l) {
    const double sa = std::sin(l.alpha), ca = std::cos(l.alpha), sb = std::sin(l.beta), cb = std::cos(l.beta);
    const double sg = std::sin(l.gamma), cg = std::cos(l.gamma);
    const double low = l.bidirectional ? -l.maximum : 0.0;
    const auto jet = [&](const char* name, Vector3 position, Vector3 direction, double minimum) {
        return Jet{name, position, direction, minimum, l.maximum, l.lag};
    };
    return {jet("J1", {-l.turn_x, l.turn_y, -l.turn_z}, {cg * cb, sg * cb, sb}, 0),
            jet("J2", {-l.turn_x, -l.turn_y, -l.turn_z}, {cg * cb, -sg * cb, sb}, 0),
            jet("J3", {-l.pitch_x, 0, -l.pitch_upper}, {sa, 0, ca}, low),
            jet("J4", {l.pitch_x, 0, -l.pitch_upper}, {-sa, 0, ca}, low),
            jet("J5", {l.turn_x, l.turn_y, -l.turn_z}, {-cg * cb, sg * cb, sb}, 0),
            jet("J6", {l.turn_x, -l.turn_y, -l.turn_z}, {-cg * cb, -sg * cb, sb}, 0),
            jet("J7", {-l.pitch_x, 0, l.pitch_lower}, {sa, 0, -ca}, low),
            jet("J8", {l.pitch_x, 0, l.pitch_lower}, {-sa, 0, -ca}, low),
            jet("Jj", {0, 0, l.bottom}, {0, 0, -1}, 0)};
}

double pitch_free_elevation(double turn_x, double turn_z, double gamma) {
    return std::atan(turn_z * std::cos(gamma) / turn_x);
}

double pair_yaw_torque(double thrust, double beta, double gamma, double turn_x, double turn_y) {
    return 2 * thrust * std::cos(beta) * (turn_y * std::cos(gamma) + turn_x * std::sin(gamma));
}

double munk_yaw_moment(double munk_coefficient, double speed, double sideslip) {
    return 0.5 * munk_coefficient * speed * speed * std::sin(2 * sideslip);
}

double needed_yaw_torque(double munk_coefficient, double speed, double sideslip, double friction_force,
                         double friction_offset) {
    return std::abs(munk_yaw_moment(munk_coefficient, speed, sideslip)) + friction_force * friction_offset;
}

TurnAllocation allocate_turning(const EvieJets& l, double force_x, double force_y, double moment_z) {
    const double cb = std::cos(l.beta), sg = std::sin(l.gamma), cg = std::cos(l.gamma);
    if (std::abs(sg) < 1e-12) {
        throw core::InputError("range",
                               "straight jets (gamma = 0) make no side force: the map from thrusts has rank 2");
    }
    const double x = force_x / (cg * cb), y = force_y / (sg * cb),
                 z = moment_z / ((l.turn_y * cg + l.turn_x * sg) * cb);
    TurnAllocation result;
    const double parts[4] = {x + y - z, x - y + z, -x + y + z, -x - y - z};
    double least = 0;
    for (int i = 0; i < 4; ++i) {
        result.thrust[i] = parts[i] / 4;
        least = std::min(least, result.thrust[i]);
    }
    for (double& thrust : result.thrust) {
        thrust -= least;
    }
    result.pressing_force = -4 * least * std::sin(l.beta);
    return result;
}

namespace {

std::array<double, 6> column(const Jet& jet) {
    const Vector3 arm = cross(jet.position, jet.direction);
    return {jet.direction[0], jet.direction[1], jet.direction[2], arm[0], arm[1], arm[2]};
}

}  // namespace

Allocation allocate(std::span<const Jet> jets, const Wrench& wanted, const std::array<double, 6>& weights) {
    const std::size_t n = jets.size();
    std::vector<std::array<double, 6>> columns;
    for (const Jet& jet : jets) {
        columns.push_back(column(jet));
        for (std::size_t k = 0; k < 6; ++k) {
            columns.back()[k] *= weights[k];
        }
    }
    std::array<double, 6> target{};
    for (std::size_t k = 0; k < 3; ++k) {
        target[k] = wanted.force[k] * weights[k];
        target[k + 3] = wanted.moment[k] * weights[k + 3];
    }
    // Coordinate descent on |B f - target|^2 + tiny |f|^2 within the limits: convex, so it finds the minimum; thrusts
    // are few.
    constexpr double tiny = 1e-9;
    Allocation result;
    result.thrust.assign(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        result.thrust[i] = std::clamp(0.0, jets[i].minimum, jets[i].maximum);
    }
    std::array<double, 6> residual = target;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < 6; ++k) {
            residual[k] -= columns[i][k] * result.thrust[i];
        }
    }
    for (int sweep = 0; sweep < 20000; ++sweep) {
        double moved = 0;
        for (std::size_t i = 0; i < n; ++i) {
            double gradient = -tiny * result.thrust[i], curvature = tiny;
            for (std::size_t k = 0; k < 6; ++k) {
                gradient += columns[i][k] * residual[k];
                curvature += columns[i][k] * columns[i][k];
            }
            const double next = std::clamp(result.thrust[i] + gradient / curvature, jets[i].minimum, jets[i].maximum);
            const double step = next - result.thrust[i];
            result.thrust[i] = next;
            for (std::size_t k = 0; k < 6; ++k) {
                residual[k] -= columns[i][k] * step;
            }
            moved = std::max(moved, std::abs(step));
        }
        if (moved < 1e-14) {
            break;
        }
    }
    result.reached = jet_wrench(jets, result.thrust);
    double squares = 0;
    for (const double part : residual) {
        squares += part * part;
    }
    result.misfit = std::sqrt(squares);
    for (std::size_t i = 0; i < n; ++i) {
        result.saturated = result.saturated || result.thrust[i] >= jets[i].maximum;
    }
    return result;
}

int wrench_rank(std::span<const Jet> jets, const std::vector<int>& components, double tolerance) {
    std::vector<std::vector<double>> rows;
    for (const int component : components) {
        std::vector<double> row;
        for (const Jet& jet : jets) {
            row.push_back(column(jet)[static_cast<std::size_t>(component)]);
        }
        rows.push_back(std::move(row));
    }
    // Gauss with full pivoting.
    int rank = 0;
    const std::size_t n = jets.size();
    double first = 0;
    for (std::size_t step = 0; step < rows.size(); ++step) {
        std::size_t pi = step, pj = 0;
        double best = 0;
        for (std::size_t i = step; i < rows.size(); ++i) {
            for (std::size_t j = 0; j < n; ++j) {
                if (std::abs(rows[i][j]) > best) {
                    best = std::abs(rows[i][j]);
                    pi = i;
                    pj = j;
                }
            }
        }
        first = step == 0 ? best : first;
        if (best <= tolerance * first || best == 0) {
            break;
        }
        std::swap(rows[step], rows[pi]);
        ++rank;
        for (std::size_t i = step + 1; i < rows.size(); ++i) {
            const double factor = rows[i][pj] / rows[step][pj];
            for (std::size_t j = 0; j < n; ++j) {
                rows[i][j] -= factor * rows[step][j];
            }
            rows[i][pj] = 0;
        }
    }
    return rank;
}

}  // namespace underbody::dynamics
