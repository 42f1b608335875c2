// Findings as sentences.
#pragma once

#include <string>
#include <vector>

#include "surrogates/discovery/discovery.h"

namespace underbody::discovery {

/// "gap and speed", "gap, speed and time"; "nothing that was measured" for none.
std::string list_of(const std::vector<std::string>& names);

/// The verdict in names: "none", "coulomb_friction and input_delay", "gap_offset or force_bias" where the data cannot
/// well tell them apart, "unknown, over gap and speed".
std::string verdict_names(const Discovery& discovery);

/// The verdict as a heading: "The model lacks: coulomb friction".
std::string headline(const Discovery& discovery);

/// The verdict for people, one or two sentences.
std::string verdict_sentence(const Discovery& discovery);

/// " on held-out data"; " on the data it was fitted to" where nothing could be held out.
std::string error_is_on(const Discovery& discovery);
/// The same of a stored result, by its key `held_out`.
std::string error_is_on(const std::string& held_out);

/// What the model as found leaves unexplained of the held-out data, as a sentence that begins with a space; empty where
/// it is noise.
std::string rest_sentence(const Discovery& discovery);

/// "9.8 ± 0.4 mN".
std::string value_text(const FoundParameter& parameter);
/// What a number of an effect is called: its name, or of a declared one that is off that: "force.2.factor".
std::string number_name(const FoundEffect& effect, const FoundParameter& parameter);

/// "", " over 2 s", " in free run": what an error is of.
std::string horizon_text(double horizon);

/// What a model lacks along one axis of a coupled motion, before and after, as a sentence.
std::string axis_text(const AxisResidual& axis);

/// The smallest effects that would have been seen: a heading, and a line for each of the first few; empty: none is
/// known.
struct LimitsText {
    std::string heading;
    std::vector<std::string> lines;
};
LimitsText limits_text(const std::vector<DetectionLimit>& limits);

/// "0.87"; "above 0.99" and "below 0.01" where more digits would promise more than anybody knows.
std::string probability_text(double probability);

/// A next experiment: what for, which runs, and the chance that they reach odds of 20 to 1 ("this settles it (odds of
/// 20 to 1) with a chance of 97 %"); where that is next to none, that none of its kind settles it.
std::string experiment_text(const std::string& purpose, const std::string& runs, double chance);

}  // namespace underbody::discovery
