#include "postproc/loads/uncertainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/error.h"
#include "core/text.h"

namespace underbody::postproc {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string percent(double share) { return core::format_number(100 * share, 3) + " %"; }

void check(std::vector<MeshValue>& values) {
    if (values.size() < 2) {
        throw core::InputError("range",
                               "a mesh study needs two meshes at least, here " + std::to_string(values.size()));
    }
    std::sort(values.begin(), values.end(), [](const MeshValue& a, const MeshValue& b) { return a.size < b.size; });
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i].value) || !std::isfinite(values[i].size) || !(values[i].size > 0)) {
            throw core::InputError("range", "mesh sizes must be positive and values finite");
        }
        if (i > 0 && !(values[i].size > values[i - 1].size * (1 + 1e-9))) {
            throw core::InputError("range", "two meshes have the same size", {},
                                   "a mesh study compares one case on different meshes");
        }
    }
}

/// ln(1 - exp(-x)), x > 0.
double log_of_rest(double x) { return std::log(-std::expm1(-x)); }

/// Celik's equation 3 for values that go one way (his s = 1; those that oscillate get no order): the p at which
/// (r32^p - 1) r21^p / (r21^p - 1) is e32 / e21. His fixed-point iteration diverges for ordinary refinements
/// (1.15, 1.6); the logarithm of the left side begins at ln(a / b) with a = ln r32, b = ln r21, and grows with p by a +
/// a / (exp(a p) - 1) - b / (exp(b p) - 1), which is a / 2 at least, since 1 - x / 2 <= x / (exp(x) - 1) <= 1: one
/// root, and a bracket of it. Needs e32 / e21 above a / b.
double celik_order(double e21, double e32, double r21, double r32) {
    const double a = std::log(r32);
    const double b = std::log(r21);
    const double wanted = std::log(std::abs(e32)) - std::log(std::abs(e21));
    double low = 0;
    double high = 2 * (wanted - std::log(a / b)) / a;
    while (true) {
        const double p = 0.5 * (low + high);
        if (!(p > low && p < high)) {  // nothing lies between
            return p;
        }
        (a * p + log_of_rest(a * p) - log_of_rest(b * p) < wanted ? low : high) = p;
    }
}

void set_interval(MeshUncertainty& result, double half_width, const std::string& text) {
    result.expanded_uncertainty = half_width;
    result.standard_uncertainty = half_width / std::sqrt(3.0);
    result.gci_fine = result.value != 0 ? half_width / std::abs(result.value) : nan;
    result.text = text;
}

/// In words; of a value of nothing there is no share.
std::string gci_of(const MeshUncertainty& result) {
    return std::isfinite(result.gci_fine)
               ? "GCI " + percent(result.gci_fine)
               : "uncertainty " + core::format_number(result.expanded_uncertainty, 3) + " about 0";
}

double range_of(const std::vector<MeshValue>& values) {
    const auto [low, high] = std::minmax_element(
        values.begin(), values.end(), [](const MeshValue& a, const MeshValue& b) { return a.value < b.value; });
    return high->value - low->value;
}

void two_meshes(const std::vector<MeshValue>& v, double formal_order, MeshUncertainty& result) {
    result.verdict = MeshVerdict::assumed;
    result.observed_order = nan;
    result.used_order = formal_order;
    const double factor = std::pow(v[1].size / v[0].size, formal_order) - 1;
    result.extrapolated = v[0].value + (v[0].value - v[1].value) / factor;
    result.expanded_uncertainty = 3 * std::abs(v[0].value - v[1].value) / factor;
    result.standard_uncertainty = result.expanded_uncertainty / 2;
    result.gci_fine = v[0].value != 0 ? result.expanded_uncertainty / std::abs(v[0].value) : nan;
    result.text =
        "two meshes: order " + core::format_number(formal_order, 3) + " assumed, safety factor 3, " + gci_of(result);
}

/// Differences that shrink with the mesh, all to one side (Celik 2008).
void monotone_meshes(const std::vector<MeshValue>& v, double formal_order, MeshUncertainty& result) {
    const double e21 = v[1].value - v[0].value;
    const double e32 = v[2].value - v[1].value;
    const double r21 = v[1].size / v[0].size;
    const double r32 = v[2].size / v[1].size;
    result.verdict = MeshVerdict::monotone;
    const double p = e21 == 0 ? nan : celik_order(e21, e32, r21, r32);
    result.observed_order = p;
    const bool too_good = !(p <= formal_order);
    constexpr double least_order = 0.1;
    result.used_order = too_good ? formal_order : std::max(p, least_order);
    const double factor21 = std::pow(r21, result.used_order) - 1;
    const double factor32 = std::pow(r32, result.used_order) - 1;
    result.extrapolated = v[0].value - e21 / factor21;
    const double error = std::abs(e21) / factor21;
    // Two meshes that agree better than their order allows agree by luck: then the coarser pair's difference counts.
    const double by_coarser = std::abs(e32) / factor32 / (factor21 + 1);
    result.expanded_uncertainty = 1.25 * (too_good ? std::max(error, by_coarser) : error);
    result.standard_uncertainty = result.expanded_uncertainty / 2;
    result.gci_fine = v[0].value != 0 ? result.expanded_uncertainty / std::abs(v[0].value) : nan;
    result.gci_coarse = v[1].value != 0 ? 1.25 * std::abs(e32 / v[1].value) / factor32 : nan;
    const double finer_alone = v[0].value != 0 ? 1.25 * error / std::abs(v[0].value) : nan;
    result.asymptotic_ratio = finer_alone > 0 ? result.gci_coarse / ((factor21 + 1) * finer_alone) : nan;
    result.text = "monotone convergence, " +
                  (std::isfinite(p) ? "observed order " + core::format_number(p, 3)
                                    : std::string("the finest two meshes agree")) +
                  (too_good          ? " (order " + core::format_number(formal_order, 3) + " and the coarser pair used)"
                   : p < least_order ? " (order " + core::format_number(least_order, 3) + " used)"
                                     : "") +
                  ", " + gci_of(result);
}

void three_meshes(const std::vector<MeshValue>& v, double formal_order, MeshUncertainty& result) {
    const double e21 = v[1].value - v[0].value;
    const double e32 = v[2].value - v[1].value;
    const double r21 = v[1].size / v[0].size;
    const double r32 = v[2].size / v[1].size;
    const double range = range_of(v);
    // With one order the difference over the coarser pair is (r32^p - 1) r21^p / (r21^p - 1) times the finer one: as p
    // goes to nothing that is ln r32 / ln r21. Less of it means that the finer pair differs more than it should.
    const bool shrinks = std::abs(e32) * std::log(r21) > std::abs(e21) * std::log(r32);
    result.observed_order = nan;
    result.used_order = nan;
    if (e21 != 0 && e32 / e21 < 0) {
        result.verdict = std::abs(e32) > std::abs(e21) ? MeshVerdict::oscillating : MeshVerdict::diverging;
        const bool shrinking = result.verdict == MeshVerdict::oscillating;
        const double half = shrinking ? range / 2 : range;
        set_interval(result, half,
                     (shrinking ? "values oscillate with the mesh: half their range, "
                                : "values oscillate with growing differences: no convergence, their range, ") +
                         core::format_number(half, 3) + ", is the interval");
        return;
    }
    if (!shrinks) {
        result.verdict = MeshVerdict::diverging;
        set_interval(result, range,
                     "differences grow as the mesh gets finer: no convergence, the range of the values, " +
                         core::format_number(range, 3) + ", is the interval");
        return;
    }
    monotone_meshes(v, formal_order, result);
}

// ---- more than three: least squares after Eça and Hoekstra ----

/// value = phi0 + sum of slopes[k] (size / finest)^orders[k], and what it says of the finest mesh.
struct Fit {
    std::vector<double> orders;
    double phi0 = 0;
    double error = 0;      ///< |terms at the finest mesh|: their delta
    double off = 0;        ///< |value - fit| there
    double deviation = 0;  ///< standard deviation of the fit
};

/// Weighted least squares for given orders (one or two); weights 1 / size, or all alike. `unknowns`: those of the fit,
/// for its degrees of freedom.
Fit fit_of(const std::vector<MeshValue>& v, const std::vector<double>& orders, bool weighted, std::size_t unknowns) {
    const auto count = static_cast<double>(v.size());
    const auto weight = [&](const MeshValue& one) { return weighted ? v[0].size / one.size : 1; };
    const auto term = [&](const MeshValue& one, std::size_t k) {
        return k < orders.size() ? std::pow(one.size / v[0].size, orders[k]) : 0;
    };
    double all = 0;
    std::array<double, 2> middle{};
    double mean = 0;
    for (const auto& one : v) {
        all += weight(one);
        mean += weight(one) * one.value;
        middle = {middle[0] + weight(one) * term(one, 0), middle[1] + weight(one) * term(one, 1)};
    }
    mean /= all;
    middle = {middle[0] / all, middle[1] / all};
    double aa = 0, ab = 0, bb = 0, ay = 0, by = 0;  // about the middle: no large numbers that cancel
    for (const auto& one : v) {
        const double a = term(one, 0) - middle[0];
        const double b = term(one, 1) - middle[1];
        aa += weight(one) * a * a;
        ab += weight(one) * a * b;
        bb += weight(one) * b * b;
        ay += weight(one) * a * (one.value - mean);
        by += weight(one) * b * (one.value - mean);
    }
    const double determinant = aa * bb - ab * ab;
    const bool two = orders.size() > 1;
    const std::array<double, 2> slopes = {two ? (ay * bb - by * ab) / determinant : ay / aa,
                                          two ? (by * aa - ay * ab) / determinant : 0};
    Fit fit;
    fit.orders = orders;
    fit.phi0 = mean - slopes[0] * middle[0] - slopes[1] * middle[1];
    const auto residual = [&](const MeshValue& one) {
        return one.value - fit.phi0 - slopes[0] * term(one, 0) - slopes[1] * term(one, 1);
    };
    fit.error = std::abs(slopes[0] + slopes[1]);
    fit.off = std::abs(residual(v[0]));
    double square = 0;
    for (const auto& one : v) {
        square += count * weight(one) / all * residual(one) * residual(one);
    }
    fit.deviation = std::sqrt(square / (count - static_cast<double>(unknowns)));
    return fit;
}

constexpr double lowest_order = 0.05;  ///< of the search: at this end the values do not converge
constexpr double highest_order = 8;

/// The order that leaves the least deviation: a coarse search, then the golden section.
double best_order(const std::vector<MeshValue>& v, bool weighted) {
    constexpr int steps = 160;
    const auto at = [&](int i) { return lowest_order + (highest_order - lowest_order) * i / steps; };
    const auto deviation = [&](double p) { return fit_of(v, {p}, weighted, 3).deviation; };
    int best = 0;
    for (int i = 1; i <= steps; ++i) {
        best = deviation(at(i)) < deviation(at(best)) ? i : best;
    }
    double a = at(std::max(0, best - 1));
    double b = at(std::min(steps, best + 1));
    const double ratio = 0.5 * (std::sqrt(5.0) - 1);
    for (int i = 0; i < 60; ++i) {
        const double c = b - ratio * (b - a);
        const double d = a + ratio * (b - a);
        const bool left = deviation(c) < deviation(d);
        (left ? b : a) = left ? d : c;
    }
    return 0.5 * (a + b);
}

/// The better of the fits with and without weights, by their deviation.
Fit better_fit(const std::vector<MeshValue>& v, const std::vector<std::vector<double>>& choices) {
    Fit best;
    for (const auto& orders : choices) {
        for (const bool weighted : {true, false}) {
            const Fit fit = fit_of(v, orders, weighted, 1 + orders.size());
            best = best.orders.empty() || fit.deviation < best.deviation ? fit : best;
        }
    }
    return best;
}

std::string named_orders(const Fit& fit) {
    const std::string first = core::format_number(fit.orders[0], 3);
    return fit.orders.size() == 1 ? "order " + first
                                  : "orders " + first + " and " + core::format_number(fit.orders[1], 3) + " together";
}

/// Their section 3: the free order, with and without weights, counts from 0.5 to the formal one; above it the first or
/// the formal order is fitted, whichever leaves less, below it these or both together. The factor is 1.25 for orders
/// from 0.5 to 0.1 above the formal one, else 3; where the fit is worse than the values differ (sigma >= their mean
/// change), all of it is blown up by how much.
void many_meshes(const std::vector<MeshValue>& v, double formal_order, MeshUncertainty& result) {
    constexpr double least_plausible = 0.5;
    constexpr double excess = 0.1;
    Fit fit;
    for (const bool weighted : {true, false}) {
        const Fit one = fit_of(v, {best_order(v, weighted)}, weighted, 3);
        fit = fit.orders.empty() || one.deviation < fit.deviation ? one : fit;
    }
    const double p = fit.orders[0];
    const bool found = p > 2 * lowest_order && p < highest_order - lowest_order;  // not at an end of the search
    result.observed_order = found ? p : nan;
    const bool believed = p >= least_plausible && p <= formal_order;
    if (!believed) {
        std::vector<std::vector<double>> choices = {{formal_order}};
        if (formal_order > 1) {
            choices.push_back({1});
        }
        if (formal_order > 1 && p < least_plausible) {
            choices.push_back({1, formal_order});
        }
        fit = better_fit(v, choices);
    }
    result.used_order = fit.orders.size() == 1 ? fit.orders[0] : nan;
    const double mean_change = range_of(v) / static_cast<double>(v.size() - 1);
    const bool plausible = p >= least_plausible && p < formal_order + excess;
    const bool good = fit.deviation < mean_change;
    const double factor = plausible ? 1.25 : 3;
    result.expanded_uncertainty = good ? factor * fit.error + fit.deviation + fit.off
                                       : 3 * fit.deviation / mean_change * (fit.error + fit.deviation + fit.off);
    int changes = 0;
    for (std::size_t i = 2; i < v.size(); ++i) {
        changes += (v[i].value - v[i - 1].value) * (v[i - 1].value - v[i - 2].value) < 0 ? 1 : 0;
    }
    result.verdict = changes > 0 && !(plausible && good) ? MeshVerdict::oscillating
                     : p < 2 * lowest_order              ? MeshVerdict::diverging
                                                         : MeshVerdict::monotone;
    result.extrapolated = result.verdict == MeshVerdict::diverging ? result.value : fit.phi0;
    result.standard_uncertainty = result.expanded_uncertainty / 2;
    result.gci_fine = v[0].value != 0 ? result.expanded_uncertainty / std::abs(v[0].value) : nan;
    result.text = std::to_string(v.size()) + " meshes, least squares: " + to_string(result.verdict) +
                  (found ? ", observed order " + core::format_number(p, 3) : std::string(", no observed order")) +
                  (believed ? "" : " (" + named_orders(fit) + " used)") +
                  (good ? ", factor " + core::format_number(factor, 3) : ", scatters about its fit") + ", " +
                  gci_of(result);
}

}  // namespace

double mesh_size(double cells, int dimension) {
    if (!(cells > 0)) {
        throw core::InputError("range", "a mesh has a positive number of cells");
    }
    return std::pow(cells, -1.0 / dimension);
}

std::string to_string(MeshVerdict verdict) {
    switch (verdict) {
        case MeshVerdict::same:
            return "same";
        case MeshVerdict::assumed:
            return "assumed";
        case MeshVerdict::monotone:
            return "monotone";
        case MeshVerdict::oscillating:
            return "oscillating";
        case MeshVerdict::diverging:
            break;
    }
    return "diverging";
}

MeshUncertainty mesh_uncertainty(std::span<const MeshValue> given, double formal_order, double nothing) {
    std::vector<MeshValue> values(given.begin(), given.end());
    check(values);
    MeshUncertainty result;
    result.meshes = values.size();
    result.value = values[0].value;
    result.extrapolated = result.value;
    result.relative_change = result.value != 0 ? std::abs((values[1].value - values[0].value) / values[0].value) : nan;
    result.gci_coarse = nan;
    result.asymptotic_ratio = nan;
    double largest = 0;
    for (const auto& value : values) {
        largest = std::max(largest, std::abs(value.value));
    }
    if (range_of(values) <= std::max(1e-13 * largest, nothing)) {
        result.verdict = MeshVerdict::same;
        result.observed_order = nan;
        result.used_order = nan;
        result.text = "the value is the same on all meshes";
    } else if (values.size() == 2) {
        two_meshes(values, formal_order, result);
    } else if (values.size() == 3) {
        three_meshes(values, formal_order, result);
    } else {
        many_meshes(values, formal_order, result);
    }
    const double refinement = values[1].size / values[0].size;
    if (result.verdict != MeshVerdict::same && refinement < 1.1) {
        result.text += "; the finest two meshes differ by a factor of " + core::format_number(refinement, 3) +
                       " only, 1.3 is advised: what they differ by may be chance";
    }
    return result;
}

namespace {

struct Moments {
    double mean = 0, deviation = 0;
};

Moments moments_of(std::span<const double> values) {
    Moments m;
    m.mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    double square = 0;
    for (const double v : values) {
        square += (v - m.mean) * (v - m.mean);
    }
    m.deviation = std::sqrt(square / static_cast<double>(values.size() - 1));
    return m;
}

/// The truncation that minimises the standard error of what is left, over the first half.
std::size_t settled_from(std::span<const double> history) {
    // Sums from the end, so that each truncation costs nothing; values shifted for the rounding's sake.
    const double shift = history.back();
    double sum = 0;
    double square = 0;
    double best = std::numeric_limits<double>::infinity();
    std::size_t first = 0;
    for (std::size_t i = history.size(); i-- > 0;) {
        sum += history[i] - shift;
        square += (history[i] - shift) * (history[i] - shift);
        const auto count = static_cast<double>(history.size() - i);
        if (i > history.size() / 2) {
            continue;
        }
        const double error = std::max(0.0, square - sum * sum / count) / (count * count);
        if (error <= best) {
            best = error;
            first = i;
        }
    }
    return first;
}

double straight_line_change(std::span<const double> tail) {
    const auto n = static_cast<double>(tail.size());
    const double middle = 0.5 * (n - 1);
    const double mean = moments_of(tail).mean;
    double top = 0;
    double bottom = 0;
    for (std::size_t i = 0; i < tail.size(); ++i) {
        const double t = static_cast<double>(i) - middle;
        top += t * (tail[i] - mean);
        bottom += t * t;
    }
    return top / bottom * (n - 1);
}

/// One standard deviation of the change that the line has by chance, where there is no trend: that of a mean times
/// sqrt(12). Of what the line leaves, because a trend passes for scatter, and for values that hang together.
double chance_drift(std::span<const double> tail, double drift) {
    std::vector<double> rest(tail.begin(), tail.end());
    for (std::size_t i = 0; i < rest.size(); ++i) {
        rest[i] -= drift * (static_cast<double>(i) / static_cast<double>(rest.size() - 1) - 0.5);
    }
    return std::sqrt(12.0 * correlation_time(rest) / static_cast<double>(rest.size())) * moments_of(rest).deviation;
}

/// Lag of the first clear maximum of the autocorrelation behind its first zero.
double cycle_of(std::span<const double> tail, const Moments& m) {
    if (!(m.deviation > 0)) {
        return 0;
    }
    const std::size_t most = std::min<std::size_t>(tail.size() / 2, 2000);
    std::vector<double> correlation(most, 0);
    for (std::size_t lag = 0; lag < most; ++lag) {
        double sum = 0;
        for (std::size_t i = 0; i + lag < tail.size(); ++i) {
            sum += (tail[i] - m.mean) * (tail[i + lag] - m.mean);
        }
        correlation[lag] = sum / (static_cast<double>(tail.size() - lag) * m.deviation * m.deviation);
    }
    std::size_t lag = 1;
    while (lag < most && correlation[lag] > 0) {
        ++lag;
    }
    std::size_t peak = 0;
    for (; lag < most; ++lag) {
        if (peak == 0 || correlation[lag] > correlation[peak]) {
            peak = lag;
        } else if (correlation[peak] > 0.4 && correlation[lag] < 0.5 * correlation[peak]) {
            break;
        }
    }
    return peak > 1 && correlation[peak] > 0.4 ? static_cast<double>(peak) : 0;
}

}  // namespace

double correlation_time(std::span<const double> values) {
    const Moments m = moments_of(values);
    const std::size_t count = values.size();
    double squares = 0;
    for (const double v : values) {
        squares += (v - m.mean) * (v - m.mean);
    }
    if (!(squares > 0)) {
        return 1;
    }
    const auto at = [&](std::size_t lag) {
        double sum = 0;
        for (std::size_t i = 0; i + lag < count; ++i) {
            sum += (values[i] - m.mean) * (values[i + lag] - m.mean);
        }
        return sum / squares;
    };
    double time = -1;
    double before = 2;  // the sums of pairs of a stationary series fall: what rises again is noise
    constexpr std::size_t most = 4000;
    for (std::size_t lag = 0; lag + 1 < std::min(count, most); lag += 2) {
        const double pair = std::min(before, at(lag) + at(lag + 1));
        if (pair <= 0) {
            break;
        }
        time += 2 * pair;
        before = pair;
    }
    return std::clamp(time, 1.0, static_cast<double>(count));
}

MeanInTime mean_in_time(std::span<const double> values) {
    if (values.size() < 2) {
        throw core::InputError("range",
                               "the mean of " + std::to_string(values.size()) + " value has no error: two are needed");
    }
    if (std::any_of(values.begin(), values.end(), [](double v) { return !std::isfinite(v); })) {
        throw core::InputError("range", "a history has values that are not finite: the solution diverged");
    }
    const Moments m = moments_of(values);
    MeanInTime result{m.mean, m.deviation, 0, correlation_time(values), 0};
    result.effective = static_cast<double>(values.size()) / result.correlation_time;
    result.error = m.deviation / std::sqrt(result.effective);
    return result;
}

IterationScatter iteration_scatter(std::span<const double> history) {
    if (history.size() < shortest_history) {
        throw core::InputError("range", "a monitor of " + std::to_string(history.size()) +
                                            " values is too short to judge: " + std::to_string(shortest_history) +
                                            " are needed");
    }
    if (std::any_of(history.begin(), history.end(), [](double v) { return !std::isfinite(v); })) {
        throw core::InputError("range", "the monitor has values that are not finite: the solution diverged");
    }
    IterationScatter result;
    result.first = settled_from(history);
    const auto tail = history.subspan(result.first);
    const Moments m = moments_of(tail);
    result.count = tail.size();
    result.mean = m.mean;
    result.deviation = m.deviation;
    result.correlation_time = correlation_time(tail);
    result.error_of_mean = m.deviation * std::sqrt(result.correlation_time / static_cast<double>(tail.size()));
    result.drift = straight_line_change(tail);
    result.period = cycle_of(tail, m);
    const bool small = std::abs(result.drift) + m.deviation < 1e-3 * std::abs(m.mean);
    const double chance = 2.5 * chance_drift(tail, result.drift) + 1e-12 * std::abs(m.mean);
    result.settled = small || std::abs(result.drift) <= chance || std::abs(result.drift) < 0.5 * m.deviation;
    result.standard_uncertainty = result.settled ? m.deviation : std::hypot(m.deviation, result.drift);
    result.text = (result.settled ? "settled" : "still drifting") + std::string(" over the last ") +
                  std::to_string(result.count) + " values: mean " + core::format_number(m.mean, 5) + ", scatter " +
                  core::format_number(m.deviation, 3) +
                  (result.settled ? "" : ", drift " + core::format_number(result.drift, 3)) +
                  (result.period > 0 ? ", cycle of " + core::format_number(result.period, 4) + " values" : "");
    return result;
}

double combined(std::span<const double> parts) {
    double square = 0;
    for (const double part : parts) {
        square += part * part;
    }
    return std::sqrt(square);
}

void to_json(nlohmann::json& json, const MeshUncertainty& r) {
    json = {{"verdict", to_string(r.verdict)},
            {"value", r.value},
            {"observed_order", r.observed_order},
            {"used_order", r.used_order},
            {"extrapolated", r.extrapolated},
            {"relative_change", r.relative_change},
            {"gci_fine", r.gci_fine},
            {"gci_coarse", r.gci_coarse},
            {"asymptotic_ratio", r.asymptotic_ratio},
            {"expanded_uncertainty", r.expanded_uncertainty},
            {"standard_uncertainty", r.standard_uncertainty},
            {"meshes", r.meshes},
            {"text", r.text}};
}

void to_json(nlohmann::json& json, const IterationScatter& r) {
    json = {{"first", r.first},
            {"count", r.count},
            {"mean", r.mean},
            {"deviation", r.deviation},
            {"error_of_mean", r.error_of_mean},
            {"correlation_time", r.correlation_time},
            {"drift", r.drift},
            {"period", r.period},
            {"settled", r.settled},
            {"standard_uncertainty", r.standard_uncertainty},
            {"text", r.text}};
}

}  // namespace underbody::postproc
