#include "surrogates/tables/fit/outliers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/fit/hull.h"
#include "surrogates/tables/fit/process_candidates.h"

namespace underbody::tables {

namespace {

constexpr double rare = 1.0 / 50;         ///< share of points that are outliers, before the data
constexpr double least_distance = 4;      ///< standard deviations
constexpr std::size_t tried_at_once = 3;  ///< with all laws and kernels
constexpr std::size_t tried_each = 40;    ///< points up to which each one is tried

SetPoints without(const SetPoints& points, const std::vector<std::size_t>& rows) {
    SetPoints rest = points;
    rest.x.clear();
    rest.value.clear();
    rest.sigma.clear();
    for (const std::size_t i : rows) {
        rest.x.push_back(points.x[i]);
        rest.value.push_back(points.value[i]);
        if (points.has_sigma()) {
            rest.sigma.push_back(points.sigma[i]);
        }
    }
    return rest;
}

/// The best process of some of the points, and how likely it makes their forces.
struct Explained {
    Form form;
    GaussianProcess process;
    double log_density;

    Explained(const SetPoints& points, ProcessCandidate candidate)
        : form(candidate.form),
          process(GaussianProcess::fit(data_of(points, all_rows(points.x.size()), form), candidate.options)) {
        log_density = GaussianProcess::log_posterior(process.data(), candidate.options, process.parameters(), nullptr) -
                      static_cast<double>(points.x.size()) * std::log(form.size);
        for (const auto& x : points.x) {
            log_density -= std::log(form.factor(x));
        }
    }
    explicit Explained(const SetPoints& points) : Explained(points, ranked_candidates(points).front()) {}

    /// Mean and standard deviation of a measured force at a point with this error of its own.
    [[nodiscard]] std::pair<double, double> predicted(const std::vector<double>& x, double sigma) const {
        std::vector<double> t(x.size()), h(form.trends());
        for (std::size_t k = 0; k < x.size(); ++k) {
            t[k] = form.coordinate(k, x[k]);
        }
        form.trend(x, h.data());
        const double unit = form.size * form.factor(x);
        const double mean = form.factor(x) * (form.offset + form.size * process.mean(t, h, form.amplitude(x)));
        const double own = process.variance(t, h, form.amplitude(x)) + std::pow(process.parameters().scatter, 2);
        return {mean, std::hypot(unit * std::sqrt(own), sigma)};
    }
};

/// Log density of a value among values that tell nothing about each other.
double broad_density(const std::vector<double>& values, double value) {
    const auto n = static_cast<double>(values.size());
    double mean = 0, square = 0;
    for (const double v : values) {
        mean += v / n;
    }
    for (const double v : values) {
        square += (v - mean) * (v - mean) / n;
    }
    const double deviation = 2 * std::sqrt(square);
    return -0.5 * std::pow((value - mean) / deviation, 2) - std::log(deviation * std::sqrt(2 * std::numbers::pi));
}

/// May it be an outlier at all? Beyond all others, at the end of an axis or at the edge of scattered points, a force
/// may rise as it likes.
bool lies_between(const SetPoints& points, std::size_t i) {
    if (points.axes.size() == 1) {
        return points.x[i][0] != points.axes[0].lower && points.x[i][0] != points.axes[0].upper;
    }
    auto others = points.x;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    return Hull(points.axes, others).distance(points.x[i].data()) <= 1e-9;
}

/// How much likelier the points become when a broad distribution explains point `i`, by one process of the form that
/// suits all of them.
double quick_gain(const SetPoints& points, const Explained& all, std::size_t i) {
    std::vector<std::size_t> rest = all_rows(points.x.size());
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    ProcessCandidate candidate{all.form, {}, 0};
    candidate.options.kernel = all.process.kernel();
    candidate.options.expected_scatter = expected_scatter(points);
    candidate.options.iterations = 12;
    return Explained(without(points, rest), candidate).log_density + broad_density(points.value, points.value[i]) -
           all.log_density;
}

/// The points to try, the most promising first. A few points are all tried quickly, because an outlier among them can
/// make the process so rough that it explains it; of more, those that miss what the others say by most.
std::vector<std::size_t> strangest(const SetPoints& points, const Explained& all) {
    std::vector<double> size(points.x.size());
    double least = 0;
    if (points.x.size() <= tried_each) {
        for (std::size_t i = 0; i < size.size(); ++i) {
            size[i] = lies_between(points, i) ? quick_gain(points, all, i) : -INFINITY;
        }
    } else {
        const auto left_out = all.process.leave_one_out();
        for (std::size_t i = 0; i < size.size(); ++i) {
            size[i] = lies_between(points, i)
                          ? std::abs(all.process.data().y[i] - left_out.mean[i]) / std::sqrt(left_out.variance[i])
                          : 0;
        }
        least = 2;
    }
    std::vector<std::size_t> order = all_rows(size.size());
    std::erase_if(order, [&](std::size_t i) { return size[i] < least; });
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size[a] > size[b]; });
    order.resize(std::min(order.size(), tried_at_once));
    return order;
}

}  // namespace

Suspects find_suspects(const SetPoints& points) {
    Suspects suspects;
    std::vector<Suspect>& found = suspects.found;
    const std::size_t count = points.x.size();
    if (count < 8 || count < points.axes.size() + 6 || count > 150) {
        return suspects;
    }
    const double least_odds = points.has_sigma() ? 5 : 50;
    std::vector<std::size_t> rows = all_rows(count);
    while (found.size() < count / 6) {
        const SetPoints all = without(points, rows);
        auto candidates = ranked_candidates(all);
        const Explained explained(all, candidates.front());
        Suspect clearest;
        double best = std::log(least_odds);
        std::vector<std::size_t> best_rows;
        for (const std::size_t i : strangest(all, explained)) {
            std::vector<std::size_t> rest = rows;
            rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
            const Explained others(without(points, rest));
            const auto [mean, sigma] = others.predicted(all.x[i], points.has_sigma() ? all.sigma[i] : 0);
            const double gain =
                others.log_density + broad_density(all.value, all.value[i]) - explained.log_density + std::log(rare);
            if (gain > best && std::abs(all.value[i] - mean) > least_distance * sigma) {
                best = gain;
                clearest = {rows[i], mean, sigma};
                best_rows = rest;
            }
        }
        if (best_rows.empty()) {
            if (found.empty()) {
                suspects.candidates = std::move(candidates);
            }
            break;
        }
        found.push_back(clearest);
        rows = best_rows;
    }
    return suspects;
}

void doubt(SetPoints& points, const std::vector<Suspect>& suspects, bool followed) {
    for (const Suspect& s : suspects) {
        const double miss = points.value[s.point] - s.expected;
        const bool may_be_true = !points.has_sigma() || points.axes.size() > 1;
        if (!may_be_true) {
            points.doubted.resize(points.x.size(), 0.0);
            points.doubted[s.point] = std::abs(miss);
        }
        const std::string done = may_be_true ? "it is kept as it is, because the force may turn sharply there"
                                 : followed  ? "the table goes through it and states that difference as its error there"
                                             : "that difference is taken as its error, so that it hardly counts";
        const std::string force =
            points.quantity + " " + core::format_number(points.value[s.point], 5) + " " + points.unit;
        points.remarks.push_back({core::Problem::Severity::warning,
                                  "the point " + described(points, s.point) + " (" + force + ") is " +
                                      core::format_number(std::abs(miss) / s.sigma, 3) +
                                      " standard deviations from what the others say there, " +
                                      core::format_number(s.expected, 5) + " +- " + core::format_number(s.sigma, 2) +
                                      " " + points.unit + ": " + done + "; check it, or leave it out",
                                  points.table.place(points.row[s.point], points.quantity)});
    }
}

}  // namespace underbody::tables
