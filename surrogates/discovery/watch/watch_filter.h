// The declared heave equation run beside a vehicle, step by step and without an end: an extended Kalman filter whose
// innovations are white while the vehicle is the model, and how forces that the model lacks would show in them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "surrogates/discovery/heave/heave_filter.h"
#include "surrogates/dynamics/plant/heave.h"

namespace underbody::discovery {

/// Directions in which a vehicle may leave its model: forces that are constant, grow with the velocity, follow the
/// direction of motion, the gap, the input; in this order.
inline constexpr std::size_t watch_directions = 5;

/// Numbers of the model that are known to an error: so many are followed.
inline constexpr std::size_t most_doubts = 6;
/// Such a number higher by its standard deviation; lower where higher is out of its range, and where both are, at the
/// bound that is farther away.
double moved_by_its_error(const dynamics::EffectUse& use, std::size_t parameter);
using WatchPlant = std::shared_ptr<const dynamics::HeavePlant>;

/// Readings of one step (record_step or more), averaged.
struct WatchStep {
    double time = 0;  ///< s, mean of the readings
    double gap = 0;   ///< m; NaN: none
    double gap_share = 1;
    double velocity = 0;  ///< m/s; NaN: none
    double velocity_share = 1;
    double input = 0;    ///< N, as it reaches the body, mean since the step before
    double command = 0;  ///< N, the same before the actuator
    double unknown_input =
        0;                   ///< N: another input of this size may have acted since the step before, and was not logged
    double unknown_for = 0;  ///< s, for how long
};

/// What one reading says beside what was expected.
struct WatchInnovation {
    double normal = 0;  ///< difference over its standard deviation
    double sigma = 1;   ///< that deviation, in the reading's unit
    /// What one newton (N s/m, N/m ...) of each direction adds to `normal`.
    std::array<double, watch_directions> slope{};
    /// What one standard deviation of each doubted number adds to it.
    std::array<double, most_doubts> doubt{};
    double kick = 0;        ///< what the input that nobody logged adds to it, one deviation of it
    double variance = 0;    ///< share of the reading's own noise in sigma^2
    Eigen::Vector3d gain;   ///< of the filter, per unit of `normal`
    Eigen::Vector3d shown;  ///< row of the reading in (gap, velocity, colour)
};

/// State: gap, velocity, and the coloured part of the gap's noise (HeaveNoise::slow, first order).
class WatchFilter {
public:
    WatchFilter(std::shared_ptr<const dynamics::HeavePlant> plant, HeaveNoise noise);
    /// Other conditions from now on.
    void set_plant(std::shared_ptr<const dynamics::HeavePlant> plant) { plant_ = std::move(plant); }
    /// Plants in which one number is higher by its standard deviation; most_doubts at most.
    void set_doubted(std::vector<WatchPlant> plants) { doubted_ = std::move(plants); }
    [[nodiscard]] std::size_t doubts() const { return doubted_.size(); }
    /// These numbers are higher than they were thought to be, each by so many of its deviations.
    void move_numbers(const Eigen::Matrix<double, most_doubts, 1>& by);
    /// The state is not known any more: at the begin and after a silence.
    void restart(double time, double gap);
    /// To the step's time.
    void advance(const WatchStep& step);
    /// An input of this deviation (N), that nobody logged, may have acted for `lasted` s up to now: what it would have
    /// done is followed from here on.
    void follow_kick(double input, double lasted);
    /// It acted, with so many deviations and that error of them.
    void take_kick(double size, double error);
    /// What a reading says; nothing changes.
    [[nodiscard]] WatchInnovation gap_innovation(const WatchStep& step) const;
    [[nodiscard]] WatchInnovation velocity_innovation(const WatchStep& step) const;
    /// Takes it into the state. `normal`: of the innovation, limited where the reading is wild.
    void absorb(const WatchInnovation& innovation, double normal);

private:
    void advance_part(double dt, double input);
    [[nodiscard]] WatchInnovation innovation(double residual, const Eigen::Vector3d& row, double variance) const;
    WatchPlant plant_;
    std::vector<WatchPlant> doubted_;
    std::array<Eigen::Vector3d, most_doubts> doubt_deviations_;  ///< what one deviation of a number does to the state
    std::array<double, most_doubts> moved_{};                    ///< deviations, of each number
    HeaveNoise noise_;
    double time_ = 0, middle_ = 0;
    Eigen::Vector3d state_ = Eigen::Vector3d::Zero();
    Eigen::Matrix3d spread_ = Eigen::Matrix3d::Identity();
    std::array<Eigen::Vector3d, watch_directions> deviations_;
    Eigen::Vector3d kick_ = Eigen::Vector3d::Zero();  ///< what a lost input of one deviation did to the state
    std::array<double, dynamics::history_states> memory_{};
};

}  // namespace underbody::discovery
