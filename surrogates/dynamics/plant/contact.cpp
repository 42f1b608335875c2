#include "surrogates/dynamics/plant/contact.h"

#include <algorithm>
#include <cmath>

namespace underbody::dynamics {

namespace {

bool bears(ContactState state, int edge) { return (static_cast<int>(state) >> edge & 1) != 0; }

}  // namespace

const char* contact_state_name(ContactState state) {
    switch (state) {
        case ContactState::nose_edge:
            return "nose edge";
        case ContactState::tail_edge:
            return "tail edge";
        case ContactState::flat:
            return "flat";
        case ContactState::free:
            break;
    }
    return "free";
}

std::array<double, 2> holding_forces(const ContactProblem& p, ContactState bearing) {
    const auto& a = p.matrix;
    switch (bearing) {
        case ContactState::nose_edge:
            return {-p.rest[0] / a[0][0], 0};
        case ContactState::tail_edge:
            return {0, -p.rest[1] / a[1][1]};
        case ContactState::flat: {
            const double determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
            return {(-p.rest[0] * a[1][1] + p.rest[1] * a[0][1]) / determinant,
                    (-p.rest[1] * a[0][0] + p.rest[0] * a[1][0]) / determinant};
        }
        case ContactState::free:
            break;
    }
    return {0, 0};
}

namespace {

constexpr double least_force = 1e-12;  ///< N
constexpr double resting = 1e-10;      ///< of the acceleration without contact

/// Forces of `state` if they are complementary for the candidates.
std::optional<std::array<double, 2>> complementary(const ContactProblem& p, ContactState state,
                                                   ContactState candidates) {
    const std::array<double, 2> force = holding_forces(p, state);
    const double size = std::max({std::abs(p.rest[0]), std::abs(p.rest[1]), least_force});
    for (int edge = 0; edge < 2; ++edge) {
        const auto e = static_cast<std::size_t>(edge);
        if (bears(state, edge) && !(force[e] >= -least_force)) {
            return {};
        }
        if (!bears(state, edge) && bears(candidates, edge)) {
            const double acceleration = p.matrix[e][0] * force[0] + p.matrix[e][1] * force[1] + p.rest[e];
            if (!(acceleration >= -resting * size)) {
                return {};
            }
        }
    }
    return force;
}

}  // namespace

std::optional<ContactState> contact_state(const ContactProblem& problem, ContactState candidates) {
    for (const ContactState state :
         {ContactState::free, ContactState::flat, ContactState::nose_edge, ContactState::tail_edge}) {
        const bool allowed = (static_cast<int>(state) & ~static_cast<int>(candidates)) == 0;
        if (allowed && complementary(problem, state, candidates)) {
            return state;
        }
    }
    return {};
}

std::optional<std::array<double, 2>> impact_impulses(const ContactProblem& problem, ContactState candidates,
                                                     double restitution) {
    ContactProblem p = problem;
    for (double& speed : p.rest) {
        speed *= speed < 0 ? 1 + restitution : 1;
    }
    const std::optional<ContactState> state = contact_state(p, candidates);
    if (!state) {
        return {};
    }
    return holding_forces(p, *state);
}

}  // namespace underbody::dynamics
