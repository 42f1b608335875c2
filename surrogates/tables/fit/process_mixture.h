// Several Gaussian processes whose weighted mean a table is: what the laws, the lengths and the sizes could also be,
// given the points. For the files of this room only.
#pragma once

#include <cstdint>
#include <vector>

#include "surrogates/tables/fit/gaussian_process.h"
#include "surrogates/tables/fit/process_form.h"

namespace underbody::tables {

struct ProcessPart {
    Form form;
    GaussianProcess process;
    double weight = 1;
};

struct ProcessMixture {
    using Grid = std::vector<std::vector<double>>;

    std::vector<ProcessPart> parts;  ///< weights add up to 1; the likeliest first
    Grid grid;                       ///< grid lines an axis
    /// How much wider than its parts say the error is, where the points say nothing (share 1 of the prior variance is
    /// left) and where they say all (share 0).
    double widened_far = 1, widened_near = 1;
    bool scatter_is_noise = false;  ///< no errors were stated: what the process leaves unexplained is noise of the
                                    ///< points, not an error of the force
    std::vector<double>
        misfit;  ///< a point: square of its leave-one-out miss over the (widened) variance stated for it
    std::vector<double>
        sigma;  ///< a node: standard deviation of the mixture, widened, with the scatter where it is no noise
    std::vector<double> own_sigma;  ///< a node: before both

    /// No single miss counts for more than this, as a square: one point must not set the error of all.
    static constexpr double largest_square = 6;

    /// How much larger than usual the leave-one-out misses around a point are (coordinates of the first part): by
    /// squared correlation, against three points' worth of 1. Point `but` does not count.
    [[nodiscard]] double local_widening(const double* coordinates,
                                        std::size_t but = static_cast<std::size_t>(-1)) const;

    /// Grid lines that resolve the parts.
    void choose_grid(const SetPoints& points);
    /// Weighted mean of the parts as Hermite data on the grid; fills both sigmas. Units of the force.
    std::vector<double> tabulate();
    [[nodiscard]] std::size_t lines_to_skip() const;
    /// local_widening() at the nodes of a grid.
    [[nodiscard]] std::vector<double> widening_on(const Grid& nodes) const;
    /// Values at the nodes of one draw from the joint posterior, as its difference from the mean (Hermite data `mean`):
    /// a part by its weight, then a random function conditioned on the points (Matheron's rule with random Fourier
    /// features: Wilson and others 2020), scaled so that its standard deviation at every node is that of the table.
    [[nodiscard]] std::vector<double> deviation(const std::vector<double>& mean, std::uint64_t seed) const;

    /// Leave-one-out mean and variance (of the measured force) of each point by the mixture, and the share of the prior
    /// variance left there.
    struct LeftOut {
        std::vector<double> mean, variance, share;
    };
    [[nodiscard]] LeftOut leave_one_out(const SetPoints& points) const;
};

}  // namespace underbody::tables
