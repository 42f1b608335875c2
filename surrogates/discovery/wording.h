// Findings as sentences, and the pieces of them that both pipelines share.
#pragma once

#include <string>
#include <vector>

#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/hypothesis.h"

namespace underbody::discovery {

/// "gap and speed", "gap, speed and time"; "nothing that was measured" for none.
std::string list_of(const std::vector<std::string>& names);

/// The numbers of a fitted hypothesis as a finding (of its first name; all its parameters).
FoundEffect found_effect(const FittedHypothesis& fitted, double probability);

/// One finding per name, each with its own parameters, uses and share.
std::vector<FoundEffect> split_by_name(const FoundEffect& whole, const FittedHypothesis& fitted);

/// The verdict for people, one or two sentences.
std::string verdict_sentence(const Discovery& discovery);

/// "9.8 ± 0.4 mN".
std::string value_text(const FoundParameter& parameter);

/// "0.87"; "above 0.99" and "below 0.01" where more digits would promise more than anybody knows.
std::string probability_text(double probability);

}  // namespace underbody::discovery
