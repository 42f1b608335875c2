// A solver that hangs, told from one that is slow.
#pragma once

#include <cstdint>
#include <string>

namespace underbody::cases {

/// Looks at a run now and then. It counts as hung when its logs have not grown while its processes used `limit` seconds
/// of processor time (a loop without end), or while they used less than a hundredth of that in twice the limit, and ten
/// minutes at least (it waits for what does not come). A slow machine, a starved or a stopped process are neither: the
/// first rule counts processor time alone, and processes that somebody stopped begin anew.
class StallWatch {
public:
    static constexpr double usual_limit = 1800;  ///< s

    explicit StallWatch(double limit = usual_limit) : limit_(limit) {}

    /// What is known now. `said`: bytes in its logs; `processor`: s that its processes have used since they began, by
    /// core; `clock`: s, of a clock that stands still while the machine sleeps. Empty, or in what way it hangs.
    std::string look(std::uintmax_t said, double processor, double clock, bool stopped);

private:
    double limit_;
    bool begun_ = false;
    std::uintmax_t said_ = 0;
    double processor_ = 0, clock_ = 0;  ///< when it last said something
};

}  // namespace underbody::cases
