// Readings as residuals: standard normal and independent of each other while the vehicle is the model, with wild ones
// left out; and the noise that makes them so, learned from the vehicle.
#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "surrogates/discovery/watch/watch_filter.h"

namespace underbody::discovery {

/// The usual time between readings follows the last one, by a hundredth at most.
inline void follow_step(double& usual, double dt) {
    constexpr double most = 0.01;
    usual += usual == 0 ? dt : std::clamp(dt - usual, -most * dt, most * usual);
}

/// One reading, judged.
struct WatchResidual {
    double value = 0;                              ///< limited to +-3 (Huber 1964)
    std::array<double, watch_directions> slope{};  ///< what one unit of each direction adds to it
};

/// What is left of colour in one sensor's innovations beside the filter's own, as an autoregressive process.
struct WatchColour {
    static constexpr std::size_t order = 3;
    std::array<double, order> phi{};
    double scale = 1;  ///< standard deviation of what remains
    [[nodiscard]] bool white() const { return phi == std::array<double, order>{}; }
};

/// How sure numbers of the model are that are known to an error, each in its standard deviation, and what readings say
/// of them: as if they were states of the filter that do not change (Friedland 1969).
class WatchDoubts {
public:
    using Numbers = Eigen::Matrix<double, most_doubts, 1>;
    /// Of so many numbers nothing more is known than their error.
    void begin(std::size_t count);
    /// The filter begins anew, the numbers are as sure as they were.
    void restart() { response_.setZero(); }
    /// An innovation over the deviation that it has with the errors of the numbers. `white`: variance of independent
    /// innovations that say as much of a mean as these do.
    [[nodiscard]] WatchInnovation with_errors(const WatchInnovation& innovation, double white) const;
    /// That deviation over the one without.
    [[nodiscard]] double widened(const WatchInnovation& innovation, double white) const;
    /// By how much the numbers are higher after an innovation of the filter.
    Numbers learn(const WatchInnovation& innovation, double white);

private:
    Eigen::Matrix<double, most_doubts, most_doubts> spread_ = Eigen::Matrix<double, most_doubts, most_doubts>::Zero();
    /// What one unit of each direction has added to the numbers.
    Eigen::Matrix<double, most_doubts, watch_directions> response_ =
        Eigen::Matrix<double, most_doubts, watch_directions>::Zero();
};

/// Filter, whitening and the gate for wild readings. Sensors: [0] the gap, [1] the heave velocity.
class WatchResiduals {
public:
    WatchResiduals(std::shared_ptr<const dynamics::HeavePlant> plant, HeaveNoise noise) : filter_(plant, noise) {}
    void set_plant(std::shared_ptr<const dynamics::HeavePlant> plant) { filter_.set_plant(std::move(plant)); }
    /// Plants in which one number is higher by its standard deviation. As many as before: the same numbers under other
    /// conditions.
    void set_doubted(std::vector<WatchPlant> plants);
    void set_colours(const std::array<WatchColour, 2>& colours);
    /// A silence of more than a second makes the state unknown; a while after it nothing is judged.
    std::array<std::optional<WatchResidual>, 2> take(const WatchStep& step);

    /// True once, with the last of so many readings of the gap in a row beyond what noise and accidents make (a second
    /// and ten readings) that the vehicle, or its sensor, has jumped; not while a state is still found.
    [[nodiscard]] bool jumped() const { return jumped_; }
    /// s, of the first of these readings.
    [[nodiscard]] double beyond_since() const { return beyond_since_; }

    /// What the likelihood of a noise is made of: innovations over their deviations, and the sum of log variances.
    struct Likelihood {
        std::array<std::vector<double>, 2> normals;
        std::array<double, 2> log_variances{};
    };
    /// The scale of the innovations is not known yet: it is followed, and what they were is kept.
    void learn_into(Likelihood* likelihood) { likelihood_ = likelihood; }

private:
    struct Sensor {
        WatchColour colour;
        std::array<WatchInnovation, WatchColour::order> past{};
        std::size_t rejected = 0, unsettled = 0;
    };
    void restart(const WatchStep& step);
    [[nodiscard]] WatchInnovation gap_innovation(const WatchStep& step);
    std::optional<WatchResidual> judge(std::size_t sensor, const WatchInnovation& innovation);
    /// Variance of independent innovations that say as much of a mean as this sensor's.
    [[nodiscard]] double white(std::size_t sensor) const;
    WatchFilter filter_;
    WatchDoubts doubts_;
    std::array<Sensor, 2> sensors_;
    std::optional<double> time_;
    double usual_step_ = 0;
    std::size_t settling_ = 0, restarts_ = 0;
    std::size_t unjudged_ = 0;  ///< steps that a lost input may still show in
    std::size_t beyond_ = 0;    ///< readings of the gap in a row beyond the gate
    double beyond_since_ = 0;
    bool jumped_ = false;
    /// An input that nobody logged: its size in deviations out of the readings since (Willsky and Jones 1976).
    struct Kick {
        std::size_t steps = 0;              ///< in which it may still show
        double score = 0, information = 0;  ///< of the readings since
    };
    void look_for_kick(double value, double slope);
    /// What is known of it goes into the state.
    void take_kick();
    Kick kick_;
    double lost_share_ = 0;  ///< of the steps, lately: those whose input was lost
    Likelihood* likelihood_ = nullptr;
};

/// Noise and colour that were learned.
struct WatchNoise {
    HeaveNoise noise;
    std::array<WatchColour, 2> colours;
    double correlation_time = 0;  ///< s, of the gap's readings; 0: white
    double cost = 0;              ///< -2 log likelihood, without the colours
};

/// The most likely noise of these steps under the model: white and coloured part of the gap's noise and the
/// disturbances' density by maximum likelihood (the coloured part only where the Bayesian information criterion has
/// it), then what colour is left. `begin`: where the search starts (its gap and velocity noise matter).
WatchNoise learn_noise(const std::shared_ptr<const dynamics::HeavePlant>& plant, const std::deque<WatchStep>& steps,
                       const HeaveNoise& begin);
/// -2 log likelihood of these steps with this noise, its scale at its best.
double noise_cost(const std::shared_ptr<const dynamics::HeavePlant>& plant, const std::deque<WatchStep>& steps,
                  const HeaveNoise& noise);

}  // namespace underbody::discovery
