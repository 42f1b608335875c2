// Residuals to alarms: scores in blocks, made standard normal, summed up to thresholds of a stated rate.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <vector>

#include "surrogates/discovery/watch/sequential_test.h"
#include "surrogates/discovery/watch/watch_residuals.h"

namespace underbody::discovery {

class WatchScores {
public:
    /// `block`: s. `usual_step`: s between steps.
    /// `fitted_over`: WatchOptions::fitted_over.
    WatchScores(double block, double usual_step, double false_alarms_per_day, double fitted_over);
    /// A test passed its threshold.
    struct Passed {
        bool scatter = false;  ///< more scatter than before, no direction
        double since = 0;      ///< s before now
        struct Direction {
            std::size_t index = 0;
            double size = 0;  ///< mean since the test began to rise
        };
        /// The direction that explains most of what was read since, then those that explain nearly as much.
        std::vector<Direction> directions;
    };
    /// `judge` false: the vehicle is known to be the model, the scores learn their scale from it.
    std::optional<Passed> take(double time, const std::array<std::optional<WatchResidual>, 2>& residuals, bool judge);
    /// After an alarm that was seen to: sums begin anew, and what the scores said since the change that gave it counts
    /// no more for their scale. How much the readings scatter is learned on.
    void reset();
    /// The same with another model, whose numbers were fitted over so many s: the scatter is that from before, too.
    void go_on(double fitted_over);
    /// The clock began anew: the block that has begun is forgotten.
    void restart();
    [[nodiscard]] double nearest() const;
    [[nodiscard]] double block() const { return block_; }
    [[nodiscard]] double judged() const { return judged_; }
    /// s, of the block that is not complete at `time`.
    [[nodiscard]] double open(double time) const { return begin_ ? time - *begin_ : 0; }

private:
    std::optional<Passed> end_block(double time, bool judge);
    [[nodiscard]] Passed what_shows(std::size_t test) const;
    void begin_tests(double fitted_over);
    [[nodiscard]] std::size_t blocks_since(std::size_t test) const;
    double block_, least_count_, mean_blocks_, judged_ = 0;
    std::optional<double> begin_;
    std::array<double, watch_directions> score_{}, information_{};
    /// What the scores are judged by: those before.
    struct Scales {
        std::array<SelfStartingScore, watch_directions> directions;
        SelfStartingLevel scatter;
    };
    struct Block {
        std::array<double, watch_directions> score{}, information{};
        Scales before;
    };
    std::deque<Block> late_;  ///< the last ones
    double squares_ = 0, count_ = 0;
    Scales scales_;
    std::optional<Scales> before_change_;  ///< of the first alarm since reset()
    std::vector<TwoSidedCusum> tests_;
};

}  // namespace underbody::discovery
