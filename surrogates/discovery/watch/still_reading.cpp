#include "surrogates/discovery/watch/still_reading.h"

#include <algorithm>
#include <cmath>

namespace underbody::discovery {

namespace {

constexpr double by_chance = 1e-11;     ///< of a stretch: one in a thousand days at 1 kHz
constexpr double least_readings = 100;  ///< from which is learned how easily neighbours are equal
constexpr double longer = 3;            ///< than the longest stretch before
constexpr double from_the_first = 30;   ///< s without any change
constexpr double coarse = 0.5;          ///< share of equal neighbours beyond which a reading at rest may stay as it is

}  // namespace

bool StillReading::take(double time, double value) {
    if (!std::isfinite(value)) {
        return false;
    }
    if (alike_ > 0 && value == last_) {
        ++alike_;
    } else {
        end_stretch(value);
        alike_ = 1;
        since_ = time;
        last_ = value;
        said_ = false;
    }
    const bool begins = !said_ && no_chance(time);
    said_ = said_ || begins;
    return begins;
}

void StillReading::end_stretch(double next) {
    if (alike_ == 0) {
        return;
    }
    if (!said_) {  // else it was the sensor
        repeats_ += static_cast<double>(alike_ - 1);
        longest_ = std::max(longest_, alike_);
    }
    ++changes_;
    const double change = std::abs(next - last_);
    constexpr double same = 1.5;  // of the smallest
    if (least_change_ == 0 || change < least_change_ / same) {
        least_change_ = change;
        least_changes_ = 0;
    }
    least_changes_ += change < same * least_change_ ? 1 : 0;
}

bool StillReading::no_chance(double time) const {
    const auto alike = static_cast<double>(alike_);
    if (changes_ == 0) {
        return alike >= least_readings && time - since_ >= from_the_first;
    }
    if (changes_ + repeats_ < least_readings || alike < longer * static_cast<double>(longest_)) {
        return false;
    }
    const double share = (repeats_ + 1) / (changes_ + repeats_ + 2);
    // One that moves by single steps and mostly not at all is rounded more coarsely than its noise; one that is logged
    // several times moves by any.
    if (share > coarse && least_changes_ > coarse * changes_) {
        return false;
    }
    // Equal neighbours come together, where the noise is coloured and while the vehicle rests: the root of their share.
    return (alike - 1) * 0.5 * std::log(share) < std::log(by_chance);
}

}  // namespace underbody::discovery
