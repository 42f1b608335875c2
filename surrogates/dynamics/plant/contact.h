// Contact of a flat base with the ground at its nose edge and its tail edge: gap >= 0, force >= 0, one of them zero.
// The contact states of docs/physics.md section 3.3 are the sets of edges that bear: none (free), both (flat), tail
// edge, nose edge.
#pragma once

#include <array>
#include <optional>

namespace underbody::dynamics {

/// Which edges bear: bit 0 the nose edge, bit 1 the tail edge.
enum class ContactState { free = 0, nose_edge = 1, tail_edge = 2, flat = 3 };
const char* contact_state_name(ContactState state);

/// Accelerations of the two gaps are linear in the two normal forces: acceleration = matrix * force + rest.
struct ContactProblem {
    std::array<std::array<double, 2>, 2> matrix{};
    std::array<double, 2> rest{};
};

/// Forces that hold the gaps of the bearing edges still.
std::array<double, 2> holding_forces(const ContactProblem& problem, ContactState bearing);

/// The complementary solution among edges that may bear (`candidates`): forces >= 0, accelerations of candidates >= 0.
/// Empty when there is none (friction can make it so: Painleve's paradox).
std::optional<ContactState> contact_state(const ContactProblem& problem, ContactState candidates);

/// Inelastic impact: impulses >= 0 after which no candidate gap closes any more; `restitution` turns part of the speed
/// around. `rest` of the problem holds the speeds of the gaps before.
std::optional<std::array<double, 2>> impact_impulses(const ContactProblem& problem, ContactState candidates,
                                                     double restitution);

}  // namespace underbody::dynamics
