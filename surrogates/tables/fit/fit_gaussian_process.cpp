// Gaussian process of a force table: which coordinates and known laws it uses, how sure it is of them, and its table
// for fast evaluation.
#include <Eigen/Core>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "core/no_limit.h"
#include "core/normal.h"
#include "core/text.h"
#include "surrogates/tables/fit/fit.h"
#include "surrogates/tables/fit/force_table_impl.h"
#include "surrogates/tables/fit/hull.h"
#include "surrogates/tables/fit/process_candidates.h"
#include "surrogates/tables/fit/process_mixture.h"

namespace underbody::tables {

namespace {

using core::InputError;

void check_spread(const SetPoints& points) {
    const std::size_t n = points.axes.size();
    if (points.x.size() < n + 2) {
        throw InputError(
            "few",
            std::to_string(points.x.size()) + " points are too few for a table of " + std::to_string(n) + " axes",
            {points.table.source, {}, {}, {}}, "it needs at least " + std::to_string(n + 2) + " different set points");
    }
    if (n < 2) {
        return;
    }
    Eigen::MatrixXd x(static_cast<Eigen::Index>(points.x.size()), static_cast<Eigen::Index>(n));
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        for (Eigen::Index k = 0; k < x.cols(); ++k) {
            const TableAxis& axis = points.axes[static_cast<std::size_t>(k)];
            x(i, k) = (points.x[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] - axis.lower) /
                      (axis.upper - axis.lower);
        }
    }
    x.rowwise() -= x.colwise().mean();
    const Eigen::MatrixXd gram = x.transpose() * x / static_cast<double>(x.rows());
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(gram);
    if (svd.singularValues()(x.cols() - 1) < 1e-10) {
        std::string names;
        for (const auto& axis : points.axes) {
            names += (names.empty() ? "" : " and ") + axis.name;
        }
        throw InputError("collinear",
                         "all points lie on a line or plane of " + names + ": the axes cannot be told apart",
                         {points.table.source, {}, {}, {}}, "name one of them as the axis, or add points off the line");
    }
}

/// The points in each box of a grid of `side` boxes along each axis; a gap that spans a factor of four counts by its
/// logarithm.
std::vector<std::vector<std::size_t>> boxes_of(const SetPoints& points, std::size_t side) {
    const std::size_t n = points.axes.size();
    std::vector<std::vector<std::size_t>> boxes;
    std::size_t total = 1;
    for (std::size_t k = 0; k < n; ++k) {
        total *= side;
    }
    boxes.resize(total);
    for (std::size_t i = 0; i < points.x.size(); ++i) {
        std::size_t box = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const auto& axis = points.axes[k];
            const bool log = axis.name == "gap" && axis.lower > 0 && axis.upper / axis.lower >= 4;
            const double t = log ? std::log(points.x[i][k] / axis.lower) / std::log(axis.upper / axis.lower)
                                 : (points.x[i][k] - axis.lower) / (axis.upper - axis.lower);
            box = box * side + std::min(side - 1, static_cast<std::size_t>(t * static_cast<double>(side)));
        }
        boxes[box].push_back(i);
    }
    return boxes;
}

/// More points than a dense process can take are averaged over the boxes of a regular grid.
SetPoints reduced(const SetPoints& points, std::size_t most, core::Problems& remarks) {
    if (points.x.size() <= most) {
        return points;
    }
    const std::size_t n = points.axes.size();
    SetPoints result = points;
    for (std::size_t side =
             static_cast<std::size_t>(std::pow(static_cast<double>(most), 1.0 / static_cast<double>(n))) + 1;
         side > 1; --side) {
        const std::vector<std::vector<std::size_t>> boxes = boxes_of(points, side);
        const auto filled = static_cast<std::size_t>(
            std::count_if(boxes.begin(), boxes.end(), [](const auto& b) { return !b.empty(); }));
        if (filled > most) {
            continue;
        }
        result.x.clear();
        result.value.clear();
        result.sigma.clear();
        result.row.clear();
        for (const auto& box : boxes) {
            if (box.empty()) {
                continue;
            }
            const auto count = static_cast<double>(box.size());
            std::vector<double> x(n, 0.0);
            double value = 0, square = 0, stated = 0;
            for (const std::size_t i : box) {
                for (std::size_t k = 0; k < n; ++k) {
                    x[k] += points.x[i][k] / count;
                }
                value += points.value[i] / count;
                square += points.value[i] * points.value[i] / count;
                stated += points.has_sigma() ? points.sigma[i] * points.sigma[i] / (count * count) : 0;
            }
            result.x.push_back(x);
            result.value.push_back(value);
            result.row.push_back(points.row[box.front()]);
            if (points.has_sigma()) {
                result.sigma.push_back(std::sqrt(core::never_zero(stated)));
            }
        }
        remarks.push_back({core::Problem::Severity::warning,
                           std::to_string(points.x.size()) +
                               " points are more than a Gaussian process takes: they are averaged to " +
                               std::to_string(result.x.size()) + " over boxes of equal size",
                           {points.table.source, {}, {}, {}}});
        break;
    }
    return result;
}

/// Few points leave open which law holds and how long the lengths are: the table is then the mean over what they allow.
ProcessMixture mixture_of(const SetPoints& points, std::vector<ProcessCandidate> candidates) {
    const auto rows = all_rows(points.x.size());
    ProcessMixture mixture;
    if (rows.size() > 120) {
        ProcessCandidate& best = candidates.front();
        best.options.iterations = 14;
        GpData data = data_of(points, rows, best.form);
        GaussianProcess process =
            rows.size() <= 600 ? GaussianProcess::fit(std::move(data), best.options)
                               : GaussianProcess(std::move(data), best.options.kernel, best.options.starts.front());
        mixture.parts.push_back({best.form, std::move(process), 1});
        return mixture;
    }
    const double best_score = candidates.front().score;
    for (ProcessCandidate& candidate : candidates) {
        const double weight = std::exp(candidate.score - best_score);
        if (weight < 0.05 || mixture.parts.size() > 30) {
            break;
        }
        const GpData data = data_of(points, rows, candidate.form);
        candidate.options.iterations = 40;
        const auto fitted = GaussianProcess::fit(data, candidate.options);
        for (const auto& point : GaussianProcess::posterior_design(data, candidate.options, fitted.parameters())) {
            if (point.weight > 0.003) {
                mixture.parts.push_back({candidate.form,
                                         GaussianProcess(data, candidate.options.kernel, point.parameters),
                                         weight * point.weight});
            }
        }
    }
    double sum = 0;
    for (const auto& part : mixture.parts) {
        sum += part.weight;
    }
    for (auto& part : mixture.parts) {
        part.weight /= sum;
    }
    return mixture;
}

/// How wide the error of a table of two and more axes is left, set with the forces of
/// tests/surrogates/tables/calibration.h, seeds 0 to 59 (November 2026): without it 70 to 80 % of the places lie within
/// one standard deviation, with it 66 to 76 %.
constexpr double several_axes = 0.93;

constexpr std::size_t few_points = 60;  ///< up to which the scatter of points without errors is looked for

/// Squares of leave-one-out misses over their stated variance. For few points lengths and sizes are fitted anew without
/// each point, because a single one of them may have set these.
std::vector<double> misfits(const ProcessMixture& mixture, const SetPoints& points,
                            const ProcessMixture::LeftOut& left_out, GpOptions options) {
    std::vector<double> squares;
    const ProcessPart& best = mixture.parts.front();
    for (std::size_t out = 0; out < points.x.size(); ++out) {
        squares.push_back(std::pow(points.value[out] - left_out.mean[out], 2) / left_out.variance[out]);
        if (points.x.size() > 50 || points.x.size() < points.axes.size() + 4) {
            continue;
        }
        std::vector<std::size_t> rest(points.x.size() - 1);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            rest[i] = i < out ? i : i + 1;
        }
        Form form = best.form;
        options.kernel = best.process.kernel();
        options.starts = {best.process.parameters()};
        options.iterations = 10;
        const auto without = GaussianProcess::fit(data_of(points, rest, form), options);
        const GpData& all = best.process.data();
        const std::span<const double> x(&all.x[out * all.axes], all.axes);
        const std::span<const double> h(&all.trend[out * all.trends], all.trends);
        const double unit = form.size * form.factor(points.x[out]);
        const double mean =
            form.factor(points.x[out]) * (form.offset + form.size * without.mean(x, h, all.amplitude_of(out)));
        const double stated = points.noise(out);
        const double variance =
            unit * unit * (without.variance(x, h, all.amplitude_of(out)) + std::pow(without.parameters().scatter, 2)) +
            stated * stated;
        const double anew = std::pow(points.value[out] - mean, 2) / variance;
        // Over one axis a single point sets much; with very few of them each one left out leaves too little to say how
        // much.
        const bool larger = points.axes.size() == 1 && points.x.size() >= 10;
        squares.back() = larger ? std::max(squares.back(), anew) : 0.5 * (squares.back() + anew);
    }
    return squares;
}

/// The mixture must be as sure as its own leave-one-out errors allow: where points are near and where they are far,
/// around each point, and in its tail.
void widen(ProcessMixture& mixture, const SetPoints& points, const ProcessMixture::LeftOut& left_out,
           const std::vector<double>& squares) {
    const std::size_t n = squares.size();
    double near = 0, near_weight = 0, far = 0, far_weight = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double square = std::min(squares[i], ProcessMixture::largest_square);
        near += (1 - left_out.share[i]) * square;
        near_weight += 1 - left_out.share[i];
        far += left_out.share[i] * square;
        far_weight += left_out.share[i];
    }
    // Three points' worth of belief that the process is right; narrower by a fifth at most, and by a tenth where the
    // noise is fitted too.
    const double least = points.has_sigma() ? 0.64 : 0.81;
    near = std::clamp((near + 3) / (near_weight + 3), least, 25.0);
    far = std::clamp((far + 3) / (far_weight + 3), least, 25.0);
    mixture.scatter_is_noise = !points.has_sigma();
    mixture.misfit = squares;
    for (std::size_t i = 0; i < n; ++i) {
        mixture.misfit[i] /= near * (1 - left_out.share[i]) + far * left_out.share[i];
    }
    // The tail: 95 % of the misses, each judged by what its neighbours say, must lie where a normal distribution has
    // them.
    std::vector<double> judged;
    const GpData& data = mixture.parts.front().process.data();
    for (std::size_t i = 0; i < n; ++i) {
        judged.push_back(std::sqrt(mixture.misfit[i] / mixture.local_widening(&data.x[i * data.axes], i)));
    }
    std::sort(judged.begin(), judged.end());
    const std::size_t rank = std::min(n, static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(n + 1))));
    const double usual =
        core::normal_quantile(0.5 * (1 - (static_cast<double>(rank) - 0.3) / (static_cast<double>(n) + 0.4)));
    // Less than half of what it lacks: of few points the largest miss says little about the next one.
    const double tail = 0.6 + 0.4 * std::max(1.0, judged[rank - 1] / (1.05 * usual));
    // Over several axes forces are smoother than a Matern process expects, and the stated noise hides it from the
    // misses.
    const double smooth = points.axes.size() > 1 ? several_axes : 1;
    mixture.widened_near = smooth * tail * std::sqrt(near);
    mixture.widened_far = smooth * tail * std::sqrt(far);
}

std::string described(const ProcessMixture& mixture, const SetPoints& points) {
    const ProcessPart& best = mixture.parts.front();
    const auto& p = best.process.parameters();
    std::string words = std::string("Gaussian process (") +
                        (best.process.kernel() == Kernel::matern52 ? "Matern 5/2" : "squared exponential") +
                        best.form.text(points.axes) + "): lengths";
    for (std::size_t k = 0; k < points.axes.size(); ++k) {
        words += std::string(k == 0 ? " " : ", ") + core::format_number(p.length[k] * best.form.span[k], 3) +
                 (best.form.logarithmic[k] ? " e-foldings of " : " " + points.axes[k].unit + " of ") +
                 points.axes[k].name;
    }
    words += ", unexplained scatter " + core::format_number(p.scatter * best.form.size, 2) + " " + points.unit;
    if (best.form.decay || best.form.film) {
        const std::vector<double> nowhere(points.axes.size(), 0.0);
        const double constant[3] = {1, 0, 0};
        const std::span<const double> only(constant, best.form.trends());
        words += ", free-stream value " +
                 core::format_number(best.form.offset + best.form.size * best.process.mean(nowhere, only, 0), 3) +
                 " +- " + core::format_number(best.form.size * std::sqrt(best.process.variance(nowhere, only, 0)), 2) +
                 " " + points.unit;
    }
    double others = 0;
    for (const auto& part : mixture.parts) {
        others +=
            part.form.text(points.axes) != best.form.text(points.axes) || part.process.kernel() != best.process.kernel()
                ? part.weight
                : 0;
    }
    if (mixture.parts.size() > 1) {
        words += "; mean over " + std::to_string(mixture.parts.size()) + " sets of lengths and sizes";
        words += others > 0.01 ? ", other laws weigh " + core::format_number(100 * others, 2) + " %" : "";
    }
    if (std::max(std::abs(mixture.widened_near - 1), std::abs(mixture.widened_far - 1)) > 0.01) {
        words += "; error scaled by " + core::format_number(mixture.widened_near, 3) + " near points and " +
                 core::format_number(mixture.widened_far, 3) + " far from them after leave-one-out";
    }
    return words;
}

}  // namespace

Scatter scatter_of(const SetPoints& points, std::vector<ProcessCandidate> candidates) {
    check_spread(points);
    const std::size_t n = points.x.size();
    Scatter scatter;
    if (points.has_sigma() || n > few_points) {
        return scatter;
    }
    ProcessCandidate best = candidates.empty() ? ranked_candidates(points).front() : std::move(candidates.front());
    const GpData data = data_of(points, all_rows(n), best.form);
    best.options.iterations = 40;
    const auto process = GaussianProcess::fit(data, best.options);
    const double uncertainty = GaussianProcess::scatter_uncertainty(data, best.options, process.parameters());
    const double noise = process.parameters().scatter;
    for (std::size_t i = 0; i < n && uncertainty < 0.9; ++i) {
        scatter.sigma.push_back(noise * best.form.size * best.form.factor(points.x[i]));
    }
    scatter.plain = uncertainty < 0.5 && noise > 0.01;
    return scatter;
}

namespace {

/// What a table says of its points.
void describe_points(ForceTable::Impl& table, const SetPoints& points) {
    table.quantity = points.quantity;
    table.unit = points.unit;
    table.source = points.table.source;
    table.axes = points.axes;
    table.points = points.table;
    table.constants = points.constants;
}

}  // namespace

std::shared_ptr<ForceTable::Impl> fit_gaussian_process(const SetPoints& all_points, std::vector<double>* misses,
                                                       std::vector<ProcessCandidate> candidates) {
    check_spread(all_points);
    core::Problems remarks = all_points.remarks;
    const SetPoints points = reduced(all_points, 1200, remarks);
    if (candidates.empty() || points.x.size() != all_points.x.size()) {
        candidates = ranked_candidates(points);
    }
    auto mixture = std::make_shared<ProcessMixture>(mixture_of(points, candidates));
    const auto left_out = mixture->leave_one_out(points);
    widen(*mixture, points, left_out, misfits(*mixture, points, left_out, candidates.front().options));
    if (misses != nullptr) {
        misses->clear();
        for (std::size_t i = 0; i < points.x.size(); ++i) {
            misses->push_back(left_out.mean[i] - points.value[i]);
        }
    }
    auto table = std::make_shared<ForceTable::Impl>();
    describe_points(*table, points);
    table->kind = "Gaussian process";
    table->rule = SlopeRule::not_a_knot;
    remarks.push_back({core::Problem::Severity::note, described(*mixture, points), {points.table.source, {}, {}, {}}});
    table->remarks = std::move(remarks);
    if (!points.has_sigma()) {
        const ProcessPart& best = mixture->parts.front();
        table->point_scatter = best.process.parameters().scatter * best.form.size;
    }
    mixture->choose_grid(points);
    auto hermite = mixture->tabulate();
    table->error = ErrorModel(mixture->grid, mixture->sigma);
    table->surface = CubicGrid(mixture->grid, std::move(hermite));
    for (std::size_t k = 0; k < mixture->grid.size(); ++k) {
        table->error.set_growth(k, end_growth(table->surface, k));
    }
    table->processes = std::move(mixture);
    if (points.axes.size() > 1 && !all_points.full_grid) {
        table->hull = std::make_shared<Hull>(points.axes, points.x);
    }
    return table;
}

}  // namespace underbody::tables
