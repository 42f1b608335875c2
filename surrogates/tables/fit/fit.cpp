#include "surrogates/tables/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "core/random.h"
#include "core/text.h"
#include "surrogates/tables/fit/force_table_impl.h"
#include "surrogates/tables/fit/outliers.h"
#include "surrogates/tables/fit/process_mixture.h"

namespace underbody::tables {

using core::InputError;

namespace {

double root_mean_square(const std::vector<double>& misses, const std::vector<double>& where_known) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < misses.size(); ++i) {
        if (!std::isnan(where_known[i])) {
            sum += misses[i] * misses[i];
            ++count;
        }
    }
    return count == 0 ? std::nan("") : std::sqrt(sum / static_cast<double>(count));
}

constexpr const char* none_inside = "interpolated: no point lies inside the grid, so nothing can be left out";

constexpr double follows_closely =
    0.7;  ///< of the stated errors: interpolation that misses left-out points by less stays

constexpr std::size_t many = 2500;  ///< more points than are worth the time of leaving each one out

void add_remark(ForceTable::Impl& table, const std::string& text,
                core::Problem::Severity severity = core::Problem::Severity::note) {
    table.remarks.push_back({severity, text, {table.source, {}, {}, {}}});
}

std::shared_ptr<ForceTable::Impl> with_remark(std::shared_ptr<ForceTable::Impl> table, const std::string& text) {
    add_remark(*table, text);
    return table;
}

/// Many points of a full grid with errors. Interpolation that misses points left out by no more than their errors
/// stays; else a process of their averages is tried at the points themselves, each of which is one of many that made
/// it.
std::shared_ptr<const ForceTable::Impl> table_of_many_points(const SetPoints& points,
                                                             const std::shared_ptr<ForceTable::Impl>& interpolated) {
    const auto known = interpolation_misses(points, 5000);
    const double of_interpolation = root_mean_square(known, known);
    const double stated = root_mean_square(points.sigma, known);
    const auto in_words = [&](double v) { return core::format_number(v, 3) + " " + points.unit; };
    if (std::isnan(of_interpolation)) {
        return with_remark(interpolated, none_inside);
    }
    if (!(of_interpolation > 1.05 * stated)) {  // independent errors alone would make it 1.1 to 1.3 times as much
        return with_remark(interpolated, "interpolated: left-out points are met within " + in_words(of_interpolation) +
                                             ", no worse than their stated errors");
    }
    auto process = fit_gaussian_process(points, nullptr);
    std::vector<double> misses(points.x.size(), 0.0);
    for (std::size_t i = 0; i < misses.size(); ++i) {
        misses[i] = std::isnan(known[i]) ? 0 : process->surface.value(points.x[i].data(), nullptr) - points.value[i];
    }
    const double of_process = root_mean_square(misses, known);
    const std::string scores = "points are missed by " + in_words(of_process) +
                               " by a Gaussian process of their averages, left-out ones by " +
                               in_words(of_interpolation) + " by interpolation";
    return of_process < of_interpolation ? with_remark(process, "Gaussian process chosen: " + scores)
                                         : with_remark(interpolated, "interpolated: " + scores);
}

}  // namespace

namespace {

/// Points that the others contradict, and the ways to fit the rest.
class Fits {
public:
    Fits(SetPoints points, const FitOptions& options)
        : options_(options), suspects_(find_suspects(points)), smoothed_(points), followed_(std::move(points)) {
        doubt(smoothed_, suspects_.found, false);
        doubt(followed_, suspects_.found, true);
        for (SetPoints* p : {&smoothed_, &followed_}) {
            for (auto& kink : kinks(*p)) {
                p->remarks.push_back(std::move(kink));
            }
        }
    }
    [[nodiscard]] std::shared_ptr<ForceTable::Impl> process(std::vector<double>* misses = nullptr) const {
        return fit_gaussian_process(smoothed_, misses, suspects_.candidates);
    }
    /// Through all points; of points without errors the scatter about a smooth curve is their error.
    [[nodiscard]] std::shared_ptr<ForceTable::Impl> interpolation() const {
        SetPoints points = followed_;
        const std::size_t n = points.x.size();
        double mean = 0;
        if (!points.has_sigma() && n >= 8 && n >= points.axes.size() + 6 && n <= 60) {
            const Scatter scatter = scatter_of(smoothed_, suspects_.candidates);
            points.scatter = scatter.sigma;
            mean = std::accumulate(scatter.sigma.begin(), scatter.sigma.end(), 0.0) / static_cast<double>(n);
            if (scatter.plain) {
                points.remarks.push_back({core::Problem::Severity::warning,
                                          "the points state no errors but scatter by about " +
                                              core::format_number(mean, 2) + " " + points.unit +
                                              " about a smooth curve: that is taken as their error, and the table "
                                              "still goes through them; state it in a column " +
                                              points.quantity + "_sigma, or fit a Gaussian process",
                                          {points.table.source, {}, {}, {}}});
            }
        }
        auto table = fit_interpolation(points, options_);
        table->point_scatter = mean;
        return table;
    }
    /// Leave-one-out misses of interpolation; NaN where none is known, and at suspect points.
    [[nodiscard]] std::vector<double> misses() const {
        auto known = interpolation_misses(followed_);
        for (const Suspect& s : suspects_.found) {
            known[s.point] = std::nan("");
        }
        return known;
    }

private:
    const FitOptions& options_;
    Suspects suspects_;
    SetPoints smoothed_, followed_;
};

/// The better of the two by leaving each point out.
std::shared_ptr<const ForceTable::Impl> better_of(const SetPoints& points, const Fits& fits) {
    auto interpolated = fits.interpolation();
    if (!points.has_sigma()) {
        return with_remark(interpolated, std::string("interpolated: the points fill a grid and state no errors, ") +
                                             (interpolated->point_scatter > 0
                                                  ? "the table goes through them, their scatter is taken as their error"
                                                  : "so they are taken as exact"));
    }
    if (points.x.size() < points.axes.size() + 3) {
        return with_remark(interpolated, "interpolated: too few points to judge by leaving one out");
    }
    if (points.x.size() > many) {
        return table_of_many_points(points, interpolated);
    }
    const auto known = fits.misses();
    const double of_interpolation = root_mean_square(known, known);
    if (std::isnan(of_interpolation)) {
        return with_remark(interpolated, none_inside);
    }
    // Points that scatter as their errors say are missed by 1.1 to 1.3 of these when left out; ones that are met much
    // better do not scatter.
    const double stated = root_mean_square(points.sigma, known);
    if (of_interpolation < follows_closely * stated) {
        return with_remark(interpolated, "interpolated: left-out points are met within " +
                                             core::format_number(of_interpolation, 3) + " " + points.unit +
                                             ", well within their stated errors, so the points do not scatter");
    }
    std::vector<double> misses;
    auto process = fits.process(&misses);
    if (misses.size() != known.size()) {
        return interpolated;
    }
    const double of_process = root_mean_square(misses, known);
    const std::string scores = "leave-one-out error " + core::format_number(of_process, 3) + " " + points.unit +
                               " by Gaussian process, " + core::format_number(of_interpolation, 3) + " " + points.unit +
                               " by interpolation";
    return of_process < of_interpolation ? with_remark(process, "Gaussian process chosen: " + scores)
                                         : with_remark(interpolated, "interpolated: " + scores);
}

}  // namespace

std::shared_ptr<const ForceTable::Impl> fit_points(const SetPoints& points, const FitOptions& options) {
    using Kind = FitOptions::Kind;
    const bool automatic = options.kind == Kind::automatic;
    if (!points.full_grid && !automatic && options.kind != Kind::gaussian_process) {
        throw InputError("grid",
                         "the points do not fill a grid, which interpolation needs" +
                             (points.missing.empty() ? "" : ": " + points.missing),
                         {points.table.source, {}, {}, {}}, "fit a Gaussian process, or add the missing set points");
    }
    const Fits fits(points, options);
    if (options.kind == Kind::gaussian_process || !points.full_grid) {
        return fits.process();
    }
    return automatic ? better_of(points, fits) : fits.interpolation();
}

namespace {

/// Lower Cholesky factor of a correlation matrix along one axis: exp(-(distance/length)^2/2), length a quarter of the
/// span.
std::vector<double> correlation_factor(const std::vector<double>& x) {
    const std::size_t n = x.size();
    const double length = 0.25 * (x.back() - x.front());
    std::vector<double> factor(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            const double d = (x[i] - x[j]) / length;
            double sum = i == j ? 1.0 + 1e-8 : std::exp(-0.5 * d * d);
            for (std::size_t k = 0; k < j; ++k) {
                sum -= factor[i * n + k] * factor[j * n + k];
            }
            factor[i * n + j] = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / factor[j * n + j];
        }
    }
    return factor;
}

/// Independent normal numbers on a grid, correlated along every axis.
std::vector<double> correlated_field(const std::vector<std::vector<double>>& points, std::uint64_t seed) {
    std::size_t count = 1;
    for (const auto& x : points) {
        count *= x.size();
    }
    core::Random random(seed);
    std::vector<double> field(count);
    for (double& z : field) {
        z = random.normal();
    }
    std::size_t stride = count;
    for (const auto& x : points) {
        stride /= x.size();
        const auto factor = correlation_factor(x);
        std::vector<double> line(x.size());
        for (std::size_t start = 0; start < count; ++start) {
            if (start / stride % x.size() != 0) {
                continue;
            }
            for (std::size_t i = 0; i < x.size(); ++i) {
                line[i] = 0;
                for (std::size_t j = 0; j <= i; ++j) {
                    line[i] += factor[i * x.size() + j] * field[start + j * stride];
                }
            }
            for (std::size_t i = 0; i < x.size(); ++i) {
                field[start + i * stride] = line[i];
            }
        }
    }
    return field;
}

/// The grid lines, and the middles between them along axes with an error of interpolation there.
std::vector<std::vector<double>> points_with_middles(const ForceTable::Impl& table) {
    auto points = table.surface.points();
    for (std::size_t k = 0; k < points.size() && !table.error.empty(); ++k) {
        const auto& cells = table.error.cell_error(k);
        if (std::none_of(cells.begin(), cells.end(), [](double e) { return e > 0; }) || points[k].size() > 300) {
            continue;
        }
        std::vector<double> finer{points[k].front()};
        for (std::size_t i = 1; i < points[k].size(); ++i) {
            finer.push_back(0.5 * (points[k][i - 1] + points[k][i]));
            finer.push_back(points[k][i]);
        }
        points[k] = std::move(finer);
    }
    return points;
}

}  // namespace

std::shared_ptr<const ForceTable::Impl> drawn_from(const ForceTable::Impl& table, std::uint64_t seed) {
    auto drawn = std::make_shared<ForceTable::Impl>(table);
    drawn->kind += ", drawn";
    drawn->processes.reset();
    const auto add = [&](const CubicGrid& mean, std::vector<double> deviation, SlopeRule rule) {
        const CubicGrid moved(mean.points(), deviation, rule);
        std::vector<double> hermite = mean.hermite();
        for (std::size_t i = 0; i < hermite.size(); ++i) {
            hermite[i] += moved.hermite()[i];
        }
        drawn->surface = CubicGrid(mean.points(), std::move(hermite));
    };
    if (table.processes) {
        // Straight from the joint posterior; splines carry the deviation between the nodes.
        add(table.surface, table.processes->deviation(table.surface.hermite(), seed), SlopeRule::not_a_knot);
        return drawn;
    }
    const auto points = points_with_middles(table);
    const CubicGrid mean = table.surface.resampled(points);
    std::vector<double> deviation = correlated_field(points, seed);
    std::vector<double> at(points.size());
    for (std::size_t node = 0; node < deviation.size(); ++node) {
        std::size_t rest = node;
        for (std::size_t k = points.size(); k-- > 0;) {
            at[k] = points[k][rest % points[k].size()];
            rest /= points[k].size();
        }
        deviation[node] *= table.error.sigma(at.data(), nullptr);
    }
    add(mean, std::move(deviation), SlopeRule::monotone);
    return drawn;
}

}  // namespace underbody::tables
