#include "surrogates/discovery/watch/watch_scores.h"

#include <algorithm>
#include <cmath>

namespace underbody::discovery {

namespace {

constexpr double block_slack = 1e-9;  ///< of a block: times are sums

constexpr std::size_t most_blocks = 300;  ///< over which what shows is judged
constexpr double alike = 6;  ///< of -2 log likelihood: directions that differ by less are not told apart (20 to 1)
constexpr double least_filled = 0.5;     ///< share of a block's readings: with fewer it goes on
constexpr double nothing_moved = 1e-30;  ///< information along a direction
constexpr double fitted_sigmas = 3;      ///< by which a fitted number may be off

}  // namespace

WatchScores::WatchScores(double block, double usual_step, double false_alarms_per_day, double fitted_over)
    : block_(block), least_count_(least_filled * block / usual_step) {
    constexpr std::size_t tests = watch_directions * TwoSidedCusum::tests(false) + TwoSidedCusum::tests(true);
    mean_blocks_ = std::max(86400 / block / false_alarms_per_day * static_cast<double>(tests), 2.0);
    begin_tests(fitted_over);
}

void WatchScores::begin_tests(double fitted_over) {
    tests_.clear();
    for (std::size_t j = 0; j <= watch_directions; ++j) {
        const bool scatter = j == watch_directions;
        // a number fitted to n blocks is off by its sigma, and the mean of later ones with it by 1/sqrt(n) of theirs
        const double allowance = fitted_over > 0 && !scatter ? fitted_sigmas * std::sqrt(block_ / fitted_over) : 0;
        tests_.emplace_back(mean_blocks_, scatter, allowance);
    }
}

std::optional<WatchScores::Passed> WatchScores::take(double time,
                                                     const std::array<std::optional<WatchResidual>, 2>& residuals,
                                                     bool judge) {
    for (const auto& one : residuals) {
        if (!one) {
            continue;
        }
        for (std::size_t j = 0; j < watch_directions; ++j) {
            score_[j] += one->slope[j] * one->value;
            information_[j] += one->slope[j] * one->slope[j];
        }
        squares_ += one->value * one->value;
        ++count_;
    }
    if (count_ == 0 || !begin_) {
        begin_ = time;
        return {};
    }
    return time - *begin_ >= block_ * (1 - block_slack) && count_ >= least_count_ ? end_block(time, judge)
                                                                                  : std::nullopt;
}

std::optional<WatchScores::Passed> WatchScores::end_block(double time, bool judge) {
    std::optional<std::size_t> worst;
    const Scales before = scales_;
    for (std::size_t j = 0; j <= watch_directions; ++j) {
        double u = 0;
        if (j == watch_directions) {
            u = scales_.scatter.normal(std::cbrt(squares_ / count_));  // nearly normal (Wilson and Hilferty 1931)
        } else if (information_[j] > nothing_moved) {
            u = scales_.directions[j].normal(score_[j] / std::sqrt(information_[j]));
        } else {
            continue;
        }
        if (judge && tests_[j].take(u) && (!worst || tests_[j].share() > tests_[*worst].share())) {
            worst = j;
        }
    }
    late_.push_back({score_, information_, before});
    if (late_.size() > most_blocks) {
        late_.pop_front();
    }
    judged_ += judge ? time - *begin_ : 0;
    begin_ = time;
    score_ = information_ = {};
    squares_ = count_ = 0;
    if (worst && !before_change_) {
        before_change_ = late_[late_.size() - blocks_since(*worst)].before;
    }
    return worst ? std::optional(what_shows(*worst)) : std::nullopt;
}

WatchScores::Passed WatchScores::what_shows(std::size_t test) const {
    Passed out{test == watch_directions, block_ * static_cast<double>(tests_[test].steps_since()), {}};
    if (out.scatter) {
        return out;
    }
    const std::size_t blocks = blocks_since(test);
    Block since;
    std::array<double, watch_directions> explained{};  // fall of -2 log likelihood
    for (std::size_t j = 0; j < watch_directions; ++j) {
        for (std::size_t i = late_.size() - blocks; i < late_.size(); ++i) {
            since.score[j] += late_[i].score[j];
            since.information[j] += late_[i].information[j];
        }
        explained[j] =
            since.information[j] > nothing_moved ? since.score[j] * since.score[j] / since.information[j] : 0;
    }
    const double most = *std::max_element(explained.begin(), explained.end());
    for (std::size_t j = 0; j < watch_directions; ++j) {
        if (explained[j] > 0 && explained[j] > most - alike) {
            const Passed::Direction one{j, since.score[j] / since.information[j]};
            out.directions.insert(explained[j] == most ? out.directions.begin() : out.directions.end(), one);
        }
    }
    return out;
}

std::size_t WatchScores::blocks_since(std::size_t test) const {
    return std::clamp<std::size_t>(tests_[test].steps_since(), 1, late_.size());
}

void WatchScores::reset() {
    for (TwoSidedCusum& test : tests_) {
        test.reset();
    }
    if (before_change_) {
        scales_.directions = before_change_->directions;
    }
    before_change_.reset();
}

void WatchScores::go_on(double fitted_over) {
    if (before_change_) {
        scales_ = *before_change_;
    }
    before_change_.reset();
    begin_tests(fitted_over);
    restart();
    late_.clear();
}

void WatchScores::restart() {
    begin_.reset();
    score_ = information_ = {};
    squares_ = count_ = 0;
}

double WatchScores::nearest() const {
    double most = 0;
    for (const TwoSidedCusum& test : tests_) {
        most = std::max(most, test.share());
    }
    return most;
}

}  // namespace underbody::discovery
