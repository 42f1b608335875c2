// One quantity from runs of several fidelities (coarse, medium, fine mesh): recursive co-kriging.
//
// Kennedy and O'Hagan 2000, in the recursive form of Le Gratiet and Garnier 2014: each level is a factor times the
// level below plus a Gaussian process of its own,
//     f_0 = trend + process_0,     f_t = f_(t-1) + (rho_t - 1) m_(t-1) + c_t + process_t,
// where m_(t-1) is the prediction of the level below. The factor rho_t is 1 before any data speak.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/progress.h"
#include "surrogates/tables/fit/gaussian_process.h"

namespace underbody::tables {

/// Runs of one fidelity. Coordinates of about unit range, values of about unit size.
struct FidelityRuns {
    std::vector<double> x;           ///< [run * axes + axis]
    std::vector<double> y;           ///< [run]
    std::vector<double> noise;       ///< known variance of each
    std::vector<std::size_t> group;  ///< which runs belong together (one shape), for leaving out; empty: each alone

    [[nodiscard]] std::size_t count() const { return y.size(); }
};

/// Immutable.
class MultiFidelity {
public:
    /// levels[0] is the cheapest; the last is what is predicted. Levels without runs above the last that has some are
    /// dropped. Throws std::invalid_argument when the lowest level has no runs or sizes do not fit.
    static MultiFidelity fit(std::vector<FidelityRuns> levels, std::size_t axes,
                             core::Progress& progress = core::Progress::none());
    /// With given parameters of each level's process.
    MultiFidelity(std::vector<FidelityRuns> levels, std::size_t axes, std::vector<GpParameters> parameters);

    [[nodiscard]] std::size_t levels() const { return processes_.size(); }
    [[nodiscard]] const std::vector<FidelityRuns>& runs() const { return runs_; }
    /// rho_t of the level (1 at the lowest).
    [[nodiscard]] double factor(std::size_t level) const;
    [[nodiscard]] const GpParameters& parameters(std::size_t level) const { return processes_[level].parameters(); }

    /// Prediction of a level, with slopes by the coordinates where asked for. Variance: of the value itself, without
    /// the noise and scatter of a run.
    [[nodiscard]] GpPrediction at(std::span<const double> x, std::size_t level, bool slopes = false) const;
    [[nodiscard]] GpPrediction at(std::span<const double> x, bool slopes = false) const {
        return at(x, levels() - 1, slopes);
    }
    /// The means of at() alone, of several points at once: x [point * axes].
    [[nodiscard]] GpMeans means(std::span<const double> x, std::size_t level, bool slopes = false) const;
    /// Covariance of a level at several points: x [point * axes] -> [i * points + j].
    [[nodiscard]] std::vector<double> covariance(std::span<const double> x, std::size_t level) const;

    /// The variance that a further run at `x` on `level` would leave of the highest level at `target`, with the
    /// parameters held.
    [[nodiscard]] double variance_after(std::span<const double> target, std::span<const double> x,
                                        std::size_t level) const;

    /// The same without the runs of one group, parameters held.
    [[nodiscard]] MultiFidelity without(std::size_t group) const;
    /// The same with one run more.
    [[nodiscard]] MultiFidelity with(std::span<const double> x, double y, double noise, std::size_t level) const;

private:
    std::vector<double> trend(std::span<const double> x, std::size_t level, std::vector<double>* slope) const;
    void add_level(GpParameters parameters);
    GpData data_of(std::size_t level) const;

    std::vector<FidelityRuns> runs_;
    std::size_t axes_ = 1;
    std::vector<GaussianProcess> processes_;
};

}  // namespace underbody::tables
