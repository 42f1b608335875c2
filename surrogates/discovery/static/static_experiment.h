// Static measurements against a model: set points, forces, noise, and the whitened residuals of any hypothesis.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/error.h"
#include "surrogates/discovery/hypothesis.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::discovery {

/// One measured number.
struct Observation {
    std::size_t quantity = 0;   ///< index into StaticExperiment::quantities
    std::size_t set_point = 0;  ///< observations at one set point (gap, speed, jet_voltage, pitch, depth) share it
    std::size_t run = 0;        ///< index into the data set's runs
    std::size_t row = 0;        ///< row of the run's table
    dynamics::Conditions at;    ///< as measured
    double value = 0;           ///< SI
    double sigma = 0;           ///< declared standard deviation, 0: none declared
    bool accident = false;      ///< far from everything else: not counted when the noise is estimated
};

/// Where the noise of a channel came from.
struct NoiseFigure {
    double value = 0;
    std::string unit;
    std::string from;      ///< "declared", "estimated", "declared value found wrong, estimated"
    double declared = 0;   ///< 0: none
    double estimated = 0;  ///< from the scatter between repeats and smooth neighbours; 0: could not be had
    /// The declared figure is less than what smooth laws leave, and no set point has the repeats that could overrule
    /// it.
    bool doubted = false;
};

/// The channels that make a set point; the others (time, temperature, direction) come along with it.
bool sets_the_point(dynamics::Channel channel);

/// The measurements as a list of observations, and the model that shall explain them. Immutable once made.
class StaticExperiment {
public:
    /// Observations whose measured quantity the model does not give are left out with a remark.
    /// Throws core::InputError when nothing is left to compare.
    StaticExperiment(const dynamics::Model& model, const dynamics::Measurements& data);

    [[nodiscard]] const std::vector<std::string>& quantities() const { return quantities_; }
    [[nodiscard]] const std::vector<Observation>& observations() const { return observations_; }
    [[nodiscard]] std::size_t set_points() const { return set_points_; }
    /// Observations at set points outside the range of a force table, which holds its end value there.
    [[nodiscard]] std::size_t outside_tables() const { return outside_; }
    /// Channels with more than one value.
    [[nodiscard]] const std::vector<dynamics::Channel>& varying() const { return varying_; }
    [[nodiscard]] const std::map<std::string, NoiseFigure>& noise() const { return noise_; }
    [[nodiscard]] const core::Problems& problems() const { return problems_; }
    [[nodiscard]] const dynamics::Model& model() const { return model_; }

    /// What the model with these further effects says for one observation. `outside` becomes true where a table was
    /// asked beyond its range.
    [[nodiscard]] double predict(const Observation& observation, const std::vector<dynamics::EffectUse>& uses,
                                 bool* outside = nullptr) const;

    /// Standard deviation used for whitening: declared for the reading or its quantity, and scaled where that was found
    /// wrong.
    [[nodiscard]] double sigma(const Observation& observation) const;
    /// Puts other noise figures in the place of the estimated ones (a second data set of the same rig).
    void set_noise(std::map<std::string, NoiseFigure> noise) { noise_ = std::move(noise); }
    /// Marks readings that no estimate shall count.
    void mark_accidents(const std::vector<std::size_t>& observations);
    /// Estimates noise from scatter that no smooth law of the varying channels explains, and compares it with the
    /// declared one. `overrule`: that scatter is the noise also where it is no scatter of repeats.
    void estimate_noise(bool overrule = false);

    /// Looks for colour in residuals (neighbours in time that tell one story) and from then on whitens with it: an
    /// autoregression of fourth order for each measured quantity (Yule and Walker), where a portmanteau test (Ljung and
    /// Box 1978) finds one. `chosen` in the order of measurement, quantity by quantity. True if any was found.
    bool find_colour(const std::vector<std::size_t>& chosen, const std::vector<double>& residuals);
    /// Noise for every observation with the figures and the colour found, in SI.
    [[nodiscard]] std::vector<double> drawn_noise(std::uint64_t seed) const;
    /// Applies the whitening to values at the chosen observations.
    void whiten(const std::vector<std::size_t>& chosen, double* values) const;

    /// (measured - predicted)/sigma of the chosen observations, whitened.
    void residuals(const std::vector<std::size_t>& chosen, const std::vector<dynamics::EffectUse>& uses,
                   std::vector<double>& out) const;
    /// Best numbers of a hypothesis from the chosen observations, over all its starts.
    [[nodiscard]] FittedHypothesis fit(const Hypothesis& hypothesis, const std::vector<std::size_t>& chosen) const;

private:
    void collect(const dynamics::Measurements& data);
    void find_varying();
    void find_set_points();

    [[nodiscard]] double value_of(const dynamics::Model& model, const Observation& observation,
                                  const std::vector<dynamics::EffectUse>& uses, bool* outside) const;

    dynamics::Model model_;
    std::vector<std::string> quantities_;
    std::vector<Observation> observations_;
    std::vector<dynamics::Channel> varying_;
    std::size_t set_points_ = 0;
    std::size_t outside_ = 0;
    std::map<std::string, NoiseFigure> noise_;
    core::Problems problems_;
    std::vector<std::vector<double>>
        colour_;  ///< per quantity: autoregression and, last, the innovation's share; empty: white
};

}  // namespace underbody::discovery
