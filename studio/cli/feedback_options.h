// Feedback on the command line, shared by simulate and region.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/simulate/hold_with_jets.h"

namespace underbody::studio {

const char* feedback_help();
const char* lqr_help();

class Shell;

/// From --feedback or --lqr; nullptr when neither was given. `held` as for the plant. What is to be said of the loop
/// goes to the shell.
std::shared_ptr<dynamics::HeaveFeedback> heave_feedback_of(Shell& shell, const std::string& feedback,
                                                           const std::string& lqr, const dynamics::Model& model,
                                                           const dynamics::Conditions& held);
std::optional<dynamics::PitchFeedback> pitch_feedback_of(Shell& shell, const std::string& feedback,
                                                         const std::string& lqr, const dynamics::HeavePitch& plant);
dynamics::VehicleHold hold_of(const std::string& text);

/// Remarks on a model that its motion should come with.
void add_remarks(core::Problems& remarks, const dynamics::Model& model);

}  // namespace underbody::studio
