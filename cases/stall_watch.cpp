#include "cases/stall_watch.h"

#include <algorithm>

#include "core/text.h"

namespace underbody::cases {

std::string StallWatch::look(std::uintmax_t said, double processor, double clock, bool stopped) {
    // Processor time falls where a process of the group has ended that nobody waited for.
    if (!begun_ || said != said_ || stopped || processor < processor_) {
        begun_ = true;
        said_ = said, processor_ = processor, clock_ = clock;
        return {};
    }
    const double used = processor - processor_, waited = clock - clock_;
    if (used >= limit_) {
        return "it has written nothing into its log for " + core::format_number(used, 3) + " s of processor time";
    }
    if (used < 0.01 * limit_ && waited >= std::max(2 * limit_, 600.0)) {
        return "for " + core::format_number(waited, 3) +
               " s it has neither written into its log nor used the processor: it waits for something";
    }
    return {};
}

}  // namespace underbody::cases
