// Sequential tests whose rate of false alarms is known from theory: cumulative sums (Page 1954) of numbers that are
// standard normal while nothing has changed.
#pragma once

#include <array>
#include <cstddef>

namespace underbody::discovery {

/// Threshold h of the one-sided cumulative sum S = max(0, S + u - reference) of independent standard normal u that
/// passes h once in `mean_steps` steps while nothing has changed (Siegmund 1985, equation 2.57: random walk with its
/// overshoot corrected). `reference` > 0, `mean_steps` > 1.
double cusum_threshold(double reference, double mean_steps);

/// Makes standard normal numbers of scores of mean zero whose scale nobody knows, without a phase of learning: each is
/// judged by the spread of those before it (self-starting, Hawkins 1987: Student's t to a normal by its quantile).
/// Exact for independent normal scores; the first eight give 0.
class SelfStartingScore {
public:
    double normal(double score);

private:
    double squares_ = 0;
    double count_ = 0;
};

/// The same for numbers of unknown mean and scale.
class SelfStartingLevel {
public:
    double normal(double value);

private:
    double mean_ = 0;
    double squares_ = 0;  ///< about the mean
    double count_ = 0;
};

/// Both sides of one number, each for a large and fast and for a small and slow change.
class TwoSidedCusum {
public:
    static constexpr std::array<double, 2> references{0.5, 0.15};  ///< half of the changes looked for, in sigma
    /// Tests in one of them.
    static constexpr std::size_t tests(bool upper_only) { return (upper_only ? 1 : 2) * references.size(); }
    /// `mean_steps`: to a false alarm of any one of the tests. `upper_only`: the lower side is never looked at.
    /// `allowance`: a mean of either sign up to which nothing has changed, in sigma.
    TwoSidedCusum(double mean_steps, bool upper_only, double allowance = 0);
    /// Takes the number of one step; true when a test passed its threshold.
    bool take(double u);
    void reset();
    /// Of the test that is nearest to its threshold: its share of it, its side (+1, -1), steps since it was zero.
    [[nodiscard]] double share() const;
    [[nodiscard]] int side() const;
    [[nodiscard]] std::size_t steps_since() const;

private:
    struct Side {
        double sum = 0;
        std::size_t since = 0;
    };
    [[nodiscard]] std::size_t nearest() const;
    std::array<Side, 2 * references.size()> sides_;
    std::array<double, references.size()> thresholds_{};
    bool upper_only_;
    double allowance_;
};

}  // namespace underbody::discovery
