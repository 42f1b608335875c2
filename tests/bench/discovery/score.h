// Scores of verdicts against known truth, with their intervals.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "surrogates/discovery/discovery.h"

namespace underbody::bench {

/// One data set, one method.
struct Outcome {
    std::vector<std::string> truth;              ///< names; empty: clean; {"unknown"}
    std::vector<std::vector<std::string>> also;  ///< other names that are right; {"none"}: saying nothing
    std::string verdict;                         ///< none, effect, unknown
    std::vector<std::string> names;
    std::vector<std::pair<std::string, double>> rivals;
    bool variables = false;        ///< those of an unknown law were named rightly
    double stated = std::nan("");  ///< probability of the verdict; of one law under two names that of both together
    double before = 0, after = 0;  ///< held-out RMSE of the chief quantity, in noise
    double best = std::nan("");    ///< the same with the true law refitted
    /// Error of predictions of fresh runs with the model as found over that with the model as declared; NaN: no such
    /// runs.
    double fresh = std::nan("");
    double pull = std::nan("");  ///< (estimate - truth)/sigma of the first number of a rightly named effect
    double seconds = 0;

    [[nodiscard]] bool right() const;
    /// The same with a law under its other name, which only the rig tells from this one.
    [[nodiscard]] bool right_law() const;
    /// The truth shares the probability with the verdict (at least a fifth), or is the same law under another name.
    [[nodiscard]] bool tied() const;
    [[nodiscard]] bool wrong() const { return verdict == "effect" && !right() && !tied(); }
};

/// Outcome of discover(), without the error of the oracle and the pull.
Outcome outcome_of(const discovery::Discovery& found, const std::vector<std::string>& truth,
                   const std::vector<std::string>& depends_on);

/// "31/32 0.97 (0.84-0.99)", the interval by Wilson.
std::string share(std::size_t of, std::size_t all);

/// Counts over many outcomes.
struct Tally {
    std::vector<Outcome> outcomes;

    [[nodiscard]] std::size_t count() const { return outcomes.size(); }
    template <typename Predicate>
    [[nodiscard]] std::size_t count(Predicate predicate) const {
        std::size_t n = 0;
        for (const Outcome& one : outcomes) {
            n += predicate(one) ? 1 : 0;
        }
        return n;
    }
    [[nodiscard]] std::string line() const;
    /// Median over data sets of the error after over that of the true law refitted; NaN when no set has one.
    [[nodiscard]] double oracle_gap() const;
    /// The largest `fresh`, and how many are above 1.05.
    [[nodiscard]] std::string fresh_line() const;
    /// Root of the mean squares of the error after, in noise.
    [[nodiscard]] double after() const;
    [[nodiscard]] double before() const;
};

/// Stated probabilities against frequencies in bins, and their largest and mean difference; parameters within 1.96
/// sigma.
std::string calibration_lines(const std::vector<Outcome>& outcomes);
std::string coverage_line(const std::vector<Outcome>& outcomes);

}  // namespace underbody::bench
