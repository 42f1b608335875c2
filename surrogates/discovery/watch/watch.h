// Watching a vehicle: when does it stop being its model, with a stated rate of false alarms?
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::discovery {

struct WatchOptions {
    double false_alarms_per_day = 1;  ///< at most, while the vehicle is the model
    double learn = 60;                ///< s of readings from which noise and its colour are learned at first
    double remember = 1200;           ///< s that are kept for finding out what changed
    /// s of readings that numbers of the model were fitted to: they are that sure and no surer. 0: they are known.
    double fitted_over = 0;
    std::map<std::string, double> noise;       ///< declared, SI: gap, heave_velocity; where the search begins
    std::map<std::string, double> conditions;  ///< SI, held
};

/// An alarm: the vehicle is not the model any more.
struct WatchAlarm {
    double time = 0;   ///< s, when it was raised
    double since = 0;  ///< s, when it began, as far as can be told
    /// What tells it: "a constant force, up", "a force that grows with the input, against it" ..., "more scatter than
    /// before"; several with "or" between them, best first, where what was read does not tell them apart. "a jump of
    /// the gap, or a large force" within a second, where blocks are longer than two.
    std::string shows;
    double force = 0;  ///< N, mean of a constant force where that shows best, else 0
    /// It is a sensor that stands still, not the vehicle: `shows` says which and where. Its readings are none until it
    /// moves again.
    bool sensor = false;
};

/// A log that is not what it is called, or not of this model: in other units, with columns exchanged or turned.
struct WatchDoubt {
    std::string text;
    std::string hint;  ///< what to do
};

/// What the readings say that noise was learned from, where the vehicle was not its model from the first one.
struct WatchFault {
    bool noisier = false;  ///< more noise than declared, by more than chance and more than sensors are off their sheets
    double declared = 0;   ///< m, noise of the gap; 0: none was
    double noise = 0;      ///< m, that was learned
    /// What force would explain it that the model lacks ("a constant force, up" ...); empty: none is seen.
    std::string shows;
    double force = 0;          ///< N, of a constant one
    double noise_with_it = 0;  ///< m, that would be left with it
    double gain = 0;           ///< what it explains, in -2 log likelihood
};

/// Takes readings one by one; memory does not grow with their number. Times ascend; one that does not is passed over,
/// and after twenty of them in a row the clock is taken to have begun anew.
///
/// The model runs beside the vehicle as an extended Kalman filter. Residuals of the readings are scored along five
/// directions (forces that may be missing) and for their scatter, in blocks that are long against the colour of the
/// noise; each score is made standard normal by those before it (Hawkins 1987) and summed up (Page 1954) to thresholds
/// that give the stated rate (Siegmund 1985), shared equally among all tests. Readings outside the model's tables are
/// none: nothing is known of the force there.
class Watch {
public:
    /// Throws core::InputError as HeavePlant does; core::UsageError for a rate or a time that is not positive.
    Watch(const dynamics::Model& model, WatchOptions options);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    /// Input force (N) commanded from this time on, until another one.
    void input(double time, double force);
    /// Another condition from now on: speed, jet_voltage, pitch ..., SI. Followed in steps of about a hundredth.
    void condition(const std::string& quantity, double value);
    /// A measured heave velocity, m/s.
    void velocity(double time, double value);
    /// A reading of the gap, m. An alarm at most once in each block of readings.
    std::optional<WatchAlarm> gap(double time, double value);

    [[nodiscard]] bool learned() const;
    /// What was wrong from the beginning, as far as it shows; asked each time that noise is learned.
    [[nodiscard]] const std::optional<WatchFault>& fault() const;
    /// A log that this model cannot be watched on; asked after a second, and when noise is first learned.
    [[nodiscard]] const std::optional<WatchDoubt>& doubt() const;
    [[nodiscard]] std::size_t readings() const;
    [[nodiscard]] std::size_t outside() const;      ///< readings that lay outside the model's tables
    [[nodiscard]] std::size_t passed_over() const;  ///< readings whose time did not ascend
    /// m, standard deviation of a gap reading, averaged over a step where it is faster; 0 before it is known.
    [[nodiscard]] double noise() const;
    /// s, over which the noise of the gap is correlated; 0: white.
    [[nodiscard]] double correlation_time() const;
    [[nodiscard]] double block() const;   ///< s: readings are judged in blocks of this length
    [[nodiscard]] double judged() const;  ///< s of readings that were judged
    /// s at the end that are not: the block that they are in is not complete.
    [[nodiscard]] double not_judged() const;
    /// Share of its threshold of the test that is nearest to an alarm.
    [[nodiscard]] double nearest() const;
    /// What was read from `since` on, as runs of about ten seconds and more for discover(); as far back as is kept.
    /// Signs, factors and clocks are already as the model's [records] say: to be read with none.
    [[nodiscard]] dynamics::Measurements since(double since) const;
    /// All tests begin anew (after an alarm that was seen to); what was learned before the change stays, and nothing
    /// more is learned: a change that goes on is no noise.
    void reset();
    /// The same with the model that was found. `fitted_over`: s of readings that its numbers were fitted to. Where
    /// nothing was learned yet, it is learned with that model.
    void go_on_with(const dynamics::Model& model, double fitted_over);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace underbody::discovery
