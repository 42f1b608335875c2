// A pattern with conditions, guessed from the names of files as people write them.
#pragma once

#include <string>
#include <vector>

namespace underbody::cases {

struct GuessedPattern {
    std::string pattern;               ///< "runs/{variant}_h{gap:mm}mm_p{pitch:deg}.csv"; empty: no two names are alike
    std::vector<std::string> fitting;  ///< in the order of the names
    std::vector<std::string> others;   ///< names that are built otherwise
};

/// From names (paths relative to one folder) to the pattern that most of them fit. A letter or word before a number
/// says what it is (h, g, gap, height: gap; p, a, pitch, alpha, theta: pitch; u, v, speed: speed; t, time: time; V
/// behind the number, jet: jet voltage), the unit is the one behind the number, else mm, deg, m/s, s, V. A part that
/// differs from name to name is {variant}, or {mesh} where all its words are sizes of a mesh; what is the same stands
/// as it is. A solver's case file (.cas...) beside its data file (.dat...) is left out.
GuessedPattern guess_pattern(std::vector<std::string> names);

}  // namespace underbody::cases
