// Points that the others contradict. For the files of this room only.
#pragma once

#include <vector>

#include "surrogates/tables/fit/process_candidates.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::tables {

/// A point that the others contradict.
struct Suspect {
    std::size_t point = 0;  ///< index into SetPoints
    double expected = 0;    ///< what the others say there
    double sigma = 0;       ///< standard deviation of its miss, by its own error and that of what the others say
};

struct Suspects {
    std::vector<Suspect> found;
    std::vector<ProcessCandidate>
        candidates;  ///< ranked_candidates of the points, where none is suspect and they were made
};

/// Each point is tried as an outlier: the others are fitted anew without it, and it counts as one when a broad
/// distribution explains it so much better than the fit does that odds of 1 in 50 beforehand become 5 to 1 and more
/// (points without stated errors, that may show a true cliff: 50 to 1), and it lies more than four standard deviations
/// from what they say. One after the other, the clearest first; one in six points at most. The ends of a single axis
/// and the outermost of scattered points are never suspect: nothing lies around them. 8 to 150 points; none of others.
Suspects find_suspects(const SetPoints& points);

/// Says so in the remarks, and marks points of one axis that state errors (`doubted` by what each misses the others
/// by). Without errors, or with a cliff that one point of several axes alone shows (a body near contact), nobody can
/// tell: such points are kept as they are. `followed`: the table goes through them all the same.
void doubt(SetPoints& points, const std::vector<Suspect>& suspects, bool followed);

}  // namespace underbody::tables
