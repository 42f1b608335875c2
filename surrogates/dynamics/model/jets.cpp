#include "surrogates/dynamics/model/jets.h"

#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/model/matrix_algebra.h"

namespace underbody::dynamics {

constexpr double in_plane = 1e-9;  ///< m and of a direction: none to the side

Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

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

namespace {

std::array<double, 6> column(const Jet& jet) {
    const Vector3 arm = cross(jet.position, jet.direction);
    return {jet.direction[0], jet.direction[1], jet.direction[2], arm[0], arm[1], arm[2]};
}

}  // namespace

namespace {

/// Least squares |B f - t|^2 + tiny |f|^2 over lower <= f <= upper, by active sets (Stark and Parker 1995): strictly
/// convex, so the minimum is the only point where no thrust inside its limits and none at a limit wants to move inward.
class BoundedLeastSquares {
public:
    BoundedLeastSquares(const std::vector<std::array<double, 6>>& columns, const std::array<double, 6>& target,
                        std::span<const Jet> jets)
        : columns_(columns), jets_(jets), normal_(columns.size(), columns.size()), right_(columns.size()) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            for (std::size_t j = 0; j < columns.size(); ++j) {
                for (std::size_t k = 0; k < 6; ++k) {
                    normal_(i, j) += columns[i][k] * columns[j][k];
                }
            }
            normal_(i, i) += tiny;
            for (std::size_t k = 0; k < 6; ++k) {
                right_[i] += columns[i][k] * target[k];
            }
        }
    }

    std::vector<double> solve() {
        const std::size_t n = columns_.size();
        thrust_.resize(n);
        free_.assign(n, false);
        for (std::size_t i = 0; i < n; ++i) {
            thrust_[i] = std::clamp(0.0, jets_[i].minimum, jets_[i].maximum);
            free_[i] = thrust_[i] > jets_[i].minimum && thrust_[i] < jets_[i].maximum;
        }
        // The smallest thrusts first; then about those found, so that the pull toward zero leaves no misfit behind.
        const std::vector<double> right = right_;
        for (int pass = 0; pass < 4; ++pass) {
            for (std::size_t round = 0; round < 20 * n + 20; ++round) {
                settle_free();
                const std::size_t next = most_wanting();
                if (next == n) {
                    break;
                }
                free_[next] = true;
            }
            for (std::size_t i = 0; i < n; ++i) {
                right_[i] = right[i] + tiny * thrust_[i];
            }
        }
        return thrust_;
    }

private:
    static constexpr double tiny = 1e-6, least_pivot = 0.1 * tiny;

    double gradient(std::size_t i) const {
        double value = right_[i];
        for (std::size_t j = 0; j < thrust_.size(); ++j) {
            value -= normal_(i, j) * thrust_[j];
        }
        return value;
    }

    /// The thrust at a limit that wants inward most; the count when none does.
    std::size_t most_wanting() const {
        std::size_t best = thrust_.size();
        double most = 1e-13;
        for (std::size_t i = 0; i < thrust_.size(); ++i) {
            if (free_[i] || jets_[i].maximum <= jets_[i].minimum) {
                continue;
            }
            const double inward = thrust_[i] <= jets_[i].minimum ? gradient(i) : -gradient(i);
            if (inward > most * normal_(i, i)) {
                most = inward / normal_(i, i);
                best = i;
            }
        }
        return best;
    }

    /// From here to the minimum over these thrusts, by Cholesky: a handful of unknowns, thousands of times a second.
    std::vector<double> newton_step(const std::vector<std::size_t>& which) const {
        const std::size_t n = which.size();
        Matrix l(n, n);
        std::vector<double> x(n);
        for (std::size_t i = 0; i < n; ++i) {
            x[i] = gradient(which[i]);
            for (std::size_t j = 0; j <= i; ++j) {
                double sum = normal_(which[i], which[j]);
                for (std::size_t k = 0; k < j; ++k) {
                    sum -= l(i, k) * l(j, k);
                }
                l(i, j) = i == j ? std::sqrt(std::max(sum, least_pivot)) : sum / l(j, j);
            }
            for (std::size_t k = 0; k < i; ++k) {
                x[i] -= l(i, k) * x[k];
            }
            x[i] /= l(i, i);
        }
        for (std::size_t i = n; i-- > 0;) {
            for (std::size_t k = i + 1; k < n; ++k) {
                x[i] -= l(k, i) * x[k];
            }
            x[i] /= l(i, i);
        }
        return x;
    }

    /// Free thrusts to the minimum over them, stopping at limits on the way.
    void settle_free() {
        for (;;) {
            std::vector<std::size_t> which;
            for (std::size_t i = 0; i < free_.size(); ++i) {
                if (free_[i]) {
                    which.push_back(i);
                }
            }
            if (which.empty()) {
                return;
            }
            const std::vector<double> step = newton_step(which);
            double part = 1;
            std::size_t stopped = which.size();
            for (std::size_t i = 0; i < which.size(); ++i) {
                const double at = thrust_[which[i]], goal = at + step[i];
                const double limit = std::clamp(goal, jets_[which[i]].minimum, jets_[which[i]].maximum);
                if (goal != limit && (limit - at) / step[i] < part) {
                    part = std::max(0.0, (limit - at) / step[i]);
                    stopped = i;
                }
            }
            for (std::size_t i = 0; i < which.size(); ++i) {
                const Jet& jet = jets_[which[i]];
                thrust_[which[i]] = std::clamp(thrust_[which[i]] + part * step[i], jet.minimum, jet.maximum);
            }
            if (stopped == which.size()) {
                return;
            }
            const Jet& jet = jets_[which[stopped]];
            thrust_[which[stopped]] = step[stopped] > 0 ? jet.maximum : jet.minimum;
            free_[which[stopped]] = false;
        }
    }

    const std::vector<std::array<double, 6>>& columns_;
    std::span<const Jet> jets_;
    Matrix normal_;
    std::vector<double> right_, thrust_;
    std::vector<bool> free_;
};

}  // namespace

Allocation allocate(std::span<const Jet> jets, const Wrench& wanted, const std::array<double, 6>& weights) {
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
    Allocation result;
    result.thrust = jets.empty() ? std::vector<double>{} : BoundedLeastSquares(columns, target, jets).solve();
    result.reached = jet_wrench(jets, result.thrust);
    double squares = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        squares += std::pow(weights[k] * (wanted.force[k] - result.reached.force[k]), 2) +
                   std::pow(weights[k + 3] * (wanted.moment[k] - result.reached.moment[k]), 2);
    }
    result.misfit = std::sqrt(squares);
    for (std::size_t i = 0; i < jets.size(); ++i) {
        result.saturated = result.saturated || result.thrust[i] >= jets[i].maximum ||
                           (jets[i].minimum < 0 && result.thrust[i] <= jets[i].minimum);
    }
    return result;
}

std::optional<EvieJets> turning_layout(std::span<const Jet> jets) {
    // Two jets at each end that push to both sides, mirrored about the middle plane.
    EvieJets layout;
    const Jet* aft = nullptr;
    int found = 0;
    for (const Jet& jet : jets) {
        if (std::abs(jet.position[1]) < in_plane || std::abs(jet.direction[0]) < in_plane) {
            continue;
        }
        ++found;
        if (jet.position[0] < 0 && jet.position[1] > 0) {
            aft = &jet;
        }
    }
    if (!aft || found < 2) {
        return std::nullopt;
    }
    layout.turn_x = -aft->position[0];
    layout.turn_y = aft->position[1];
    layout.turn_z = -aft->position[2];
    layout.beta = std::asin(std::clamp(aft->direction[2], -1.0, 1.0));
    layout.gamma = std::atan2(aft->direction[1], aft->direction[0]);
    layout.maximum = aft->maximum;
    layout.lag = aft->lag;
    return layout;
}

}  // namespace underbody::dynamics
