// A sensor whose reading stands still: the same number again and again, where its noise does not let that happen.
#pragma once

#include <cstddef>

namespace underbody::discovery {

/// Takes the readings of one sensor. How easily neighbours are equal is learned from them: never in noise that is
/// written to many digits, often where it is rounded coarsely or a value is logged several times.
class StillReading {
public:
    /// True once for each stretch, as soon as so many equal readings are no chance (1e-11 a stretch) and three times as
    /// many as were ever equal before; or where nothing has changed from the first reading on, for half a minute.
    bool take(double time, double value);
    /// The stretch goes on.
    [[nodiscard]] bool still() const { return said_; }
    [[nodiscard]] double since() const { return since_; }
    [[nodiscard]] std::size_t alike() const { return alike_; }
    [[nodiscard]] double value() const { return last_; }
    [[nodiscard]] bool ever_changed() const { return changes_ > 0; }

private:
    void end_stretch(double next);
    [[nodiscard]] bool no_chance(double time) const;
    double last_ = 0, since_ = 0;
    std::size_t alike_ = 0;
    bool said_ = false;
    // of the stretches before
    double changes_ = 0, repeats_ = 0;
    std::size_t longest_ = 1;
    double least_change_ = 0, least_changes_ = 0;  ///< the smallest step from one reading to the next, and how often
};

}  // namespace underbody::discovery
