// A quantity over shapes and conditions, from runs of one or several fidelities: what a table is along gap and pitch,
// for up to ten named variables, with an error that was checked on shapes left out.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/table.h"
#include "surrogates/tables/search/multi_fidelity.h"

namespace underbody::tables {

/// What varies: a number of the shape ("protrusion.height"), "gap", "pitch", "speed". SI.
struct SearchVariable {
    std::string name;
    std::string unit;  ///< SI
    double lower = 0;  ///< the range searched; forces are learned from runs beyond it too
    double upper = 1;
    bool logarithmic = false;  ///< both ends positive: ratios count, not differences
    bool of_shape = true;      ///< false: a condition of a run (gap, pitch, speed), which does not make another shape

    /// 0 at `lower`, 1 at `upper`.
    [[nodiscard]] double scaled(double value) const;
    [[nodiscard]] double unscaled(double share) const;
    /// d scaled / d value.
    [[nodiscard]] double scaled_slope(double value) const;
};

/// One run of one case.
struct SearchRun {
    std::vector<double> at;  ///< SI, one a variable
    std::size_t level = 0;   ///< fidelity, 0 the cheapest; of some there may be no runs
    double value = 0;        ///< SI
    double sigma = 0;        ///< one standard deviation of the value: scatter of the run
};

struct SurrogatePrediction {
    double value = 0;  ///< SI
    double sigma = 0;  ///< one standard deviation of the value that the highest fidelity of which there are runs gives
    std::vector<double> slope;        ///< d value / d variable, where asked for
    std::vector<double> sigma_slope;  ///< d sigma / d variable
};

/// Values at many points, SI.
struct SurrogateCurve {
    std::vector<double> value;
    std::vector<double> slope;       ///< [point * variables + variable], where asked for
    std::vector<double> covariance;  ///< [i * points + j] of the values' errors, where asked for
};

/// How it does on shapes that it did not see: every shape left out once with all its runs, parameters held. A shape's
/// runs of the best fidelity that others have too are compared with the prediction of that fidelity; a shape that
/// shares none is not checked.
struct LeftOutCheck {
    std::size_t shapes = 0;
    std::size_t shapes_of_best = 0;  ///< of these, how many have runs of the highest fidelity
    std::size_t points = 0;          ///< of each shape, those of the best fidelity that it has
    double inside_95 = 0;            ///< share within 1.96 sigma (as stated, after calibration)
    double inside_lower = 0;         ///< its 95 % interval (Wilson 1927), counted by shape: runs of one err alike
    double inside_upper = 1;
    double root_mean_square = 0;  ///< SI
    double nearest_shape = 0;     ///< the same error when each is taken from the nearest shape's nearest run instead
    std::vector<double> measured, predicted, sigma;  ///< each point, SI
};

/// Immutable.
class Surrogate {
public:
    static constexpr std::size_t most_variables = 10;
    /// Throws core::InputError: fewer than three runs, one shape only, values that are not finite, more variables than
    /// that, a variable with one value everywhere.
    static Surrogate fit(std::string quantity, std::string unit, std::vector<SearchVariable> variables,
                         const std::vector<SearchRun>& runs, core::Progress& progress = core::Progress::none());

    [[nodiscard]] const std::string& quantity() const { return quantity_; }
    [[nodiscard]] const std::string& unit() const { return unit_; }
    [[nodiscard]] const std::vector<SearchVariable>& variables() const { return variables_; }
    [[nodiscard]] const MultiFidelity& process() const { return process_; }
    [[nodiscard]] const LeftOutCheck& check() const { return check_; }
    /// What stated errors are multiplied with since shapes left out were missed by that much more or less.
    [[nodiscard]] double error_factor() const { return error_factor_; }
    /// SearchRun::level of each level of the process: the fidelities of which there are runs, cheapest first.
    [[nodiscard]] const std::vector<std::size_t>& fidelities() const { return fidelities_; }
    /// SI per unit of the process's values.
    [[nodiscard]] double spread() const { return spread_; }

    [[nodiscard]] SurrogatePrediction at(std::span<const double> x, bool slopes = false) const;
    /// Of a weighted sum of values at several points, e.g. a difference over the pitch: value and sigma.
    [[nodiscard]] SurrogatePrediction sum(std::span<const double> weights,
                                          const std::vector<std::vector<double>>& points) const;
    /// Values along a curve, or anywhere: with their slopes, with the covariance of their errors (as stated: what
    /// shapes left out showed is in it).
    enum class With { values, slopes, covariance };
    [[nodiscard]] SurrogateCurve along(const std::vector<std::vector<double>>& points, With with) const;
    /// Sigma at `target` after a further run at `x` of a fidelity (of which there are runs).
    [[nodiscard]] double sigma_after(std::span<const double> target, std::span<const double> x,
                                     std::size_t fidelity) const;
    /// With a run more, parameters held: for batches. NaN stands for the prediction itself. A fidelity of which there
    /// are no runs counts as the next better one that has some, or as the best.
    [[nodiscard]] Surrogate with(const SearchRun& run) const;

    /// Point in the coordinates of the process.
    [[nodiscard]] std::vector<double> scaled(std::span<const double> x) const;

private:
    explicit Surrogate(MultiFidelity process) : process_(std::move(process)) {}
    void check_left_out(core::Progress& progress);
    [[nodiscard]] std::size_t level_of(std::size_t fidelity) const;

    std::string quantity_, unit_;
    std::vector<SearchVariable> variables_;
    std::vector<std::size_t> fidelities_;
    double middle_ = 0, spread_ = 1, error_factor_ = 1;
    MultiFidelity process_;
    LeftOutCheck check_;
};

/// `quantity`, `unit`, `variables`, `fidelities` (numbers of those that have runs), `runs` and `factors` (rho) of each
/// of these, `lengths` (of the highest fidelity's own process, in ranges), `error_factor`, `left_out` {`shapes`,
/// `shapes_of_best`, `points`, `inside_95`, `inside_95_interval`, `root_mean_square`, `nearest_shape`}.
void to_json(nlohmann::json& json, const Surrogate& surrogate);

}  // namespace underbody::tables
