#include "surrogates/estimator/extended_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace underbody::estimator {

namespace {

using State = std::array<double, 3>;   // gap, velocity, departure
using Square = std::array<double, 9>;  // row-major

Square product(const Square& a, const Square& b) {
    Square c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t j = 0; j < 3; ++j) {
                c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
            }
        }
    }
    return c;
}

Square transposed(const Square& a) { return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]}; }

Square inverse_of(const Square& a) {
    Square c{a[4] * a[8] - a[5] * a[7], a[2] * a[7] - a[1] * a[8], a[1] * a[5] - a[2] * a[4],
             a[5] * a[6] - a[3] * a[8], a[0] * a[8] - a[2] * a[6], a[2] * a[3] - a[0] * a[5],
             a[3] * a[7] - a[4] * a[6], a[1] * a[6] - a[0] * a[7], a[0] * a[4] - a[1] * a[3]};
    const double determinant = a[0] * c[0] + a[1] * c[3] + a[2] * c[6];
    for (double& v : c) {
        v /= determinant;
    }
    return c;
}

struct Belief {
    State x{};
    Square p{};
};

class Filter {
public:
    Filter(const SeparatedPlant& plant, const FilterNoise& noise) : plant_(plant), noise_(noise) {}

    // Mean and covariance over dt with the input held; `phi` receives the transition.
    void predict(Belief& b, double dt, double input, Square& phi) const {
        phi = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        const int pieces = std::clamp(static_cast<int>(std::ceil(dt / 0.02)), 1, 500);
        const double step = dt / pieces;
        for (int i = 0; i < pieces; ++i) {
            double ground_slope = 0, drag_slope = 0;
            plant_.ground_force(b.x[0], ground_slope);
            plant_.drag_force(b.x[1], drag_slope);
            const double s = 1 / plant_.virtual_mass;
            const double a10 = ground_slope * s, a11 = -drag_slope * s, a12 = s;
            const double a22 = noise_.force_time > 0 ? -1 / noise_.force_time : 0;
            // exp(A step) to second order: the pieces are short against every time constant of the plant.
            const double h = 0.5 * step * step;
            const Square f{1 + h * a10, step + h * a11,                           h * a12,
                           step * a10 + h * a11 * a10, 1 + step * a11 + h * (a10 + a11 * a11), step * a12 + h * (a11 * a12 + a12 * a22),
                           0, 0, std::exp(step * a22)};
            const double q = noise_.force_density;
            // White noise into the departure, integrated through velocity and gap (Van Loan's series).
            const double t3 = step * step * step;
            const Square noise{q * s * s * t3 * step * step / 20, q * s * s * t3 * step / 8, q * s * t3 / 6,
                               q * s * s * t3 * step / 8,         q * s * s * t3 / 3,        q * s * step * step / 2,
                               q * s * t3 / 6,                    q * s * step * step / 2,   q * step};
            plant_.advance(b.x[0], b.x[1], input + b.x[2], step);
            b.x[2] *= f[8];
            b.p = product(product(f, b.p), transposed(f));
            for (std::size_t k = 0; k < 9; ++k) {
                b.p[k] += noise[k];
            }
            phi = product(f, phi);
        }
    }

    // Scalar measurement of component c. Returns false for an outlier (belief unchanged).
    bool update(Belief& b, std::size_t c, double value, double sigma, double& innovation, double& spread, bool trust_always) const {
        const double r = sigma * sigma;
        spread = b.p[4 * c] + r;
        innovation = value - b.x[c];
        if (!trust_always && noise_.gate > 0 && innovation * innovation > noise_.gate * noise_.gate * spread) {
            return false;
        }
        const State k{b.p[c] / spread, b.p[3 + c] / spread, b.p[6 + c] / spread};
        Square keep{1, 0, 0, 0, 1, 0, 0, 0, 1};
        for (std::size_t i = 0; i < 3; ++i) {
            b.x[i] += k[i] * innovation;
            keep[3 * i + c] -= k[i];
        }
        b.p = product(product(keep, b.p), transposed(keep));  // Joseph's form
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                b.p[3 * i + j] += k[i] * k[j] * r;
            }
        }
        return true;
    }

    void describe(const Belief& b, FilterEstimate& e) const {
        double ground_slope = 0, drag_slope = 0;
        const double table = plant_.ground_force(b.x[0], ground_slope);
        e.gap = b.x[0];
        e.velocity = b.x[1];
        e.departure = b.x[2];
        e.drag_force = plant_.drag_force(b.x[1], drag_slope);
        e.ground_force = table + b.x[2];
        e.total_force = e.ground_force - e.drag_force;
        e.covariance = b.p;
        const auto sigma_along = [&](double gh, double gw, double gd) {
            const State g{gh, gw, gd};
            double v = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t j = 0; j < 3; ++j) {
                    v += g[i] * b.p[3 * i + j] * g[j];
                }
            }
            return std::sqrt(std::max(v, 0.0));
        };
        e.gap_sigma = sigma_along(1, 0, 0);
        e.velocity_sigma = sigma_along(0, 1, 0);
        e.departure_sigma = sigma_along(0, 0, 1);
        e.total_sigma = sigma_along(ground_slope, -drag_slope, 1);
        const double law = noise_.drag_relative * e.drag_force;
        e.drag_sigma = std::hypot(sigma_along(0, drag_slope, 0), law);
        e.ground_sigma = std::hypot(sigma_along(ground_slope, 0, 1), law);
        e.outside = b.x[0] < plant_.lower || b.x[0] > plant_.upper;
    }

private:
    const SeparatedPlant& plant_;
    const FilterNoise& noise_;
};

void check(const RunSignals& run) {
    const std::size_t n = run.time.size();
    if (run.gap.size() != n || (!run.velocity.empty() && run.velocity.size() != n) || (!run.input.empty() && run.input.size() != n)) {
        throw core::InputError("shape", "the signals of a run differ in length");
    }
    if (std::count_if(run.gap.begin(), run.gap.end(), [](double v) { return std::isfinite(v); }) < 3) {
        throw core::InputError("few", "a run needs at least three measured gaps");
    }
    for (std::size_t i = 1; i < n; ++i) {
        if (!(run.time[i] > run.time[i - 1])) {
            throw core::InputError("range", "time does not ascend at sample " + std::to_string(i + 1));
        }
    }
    for (const double u : run.input) {
        if (!std::isfinite(u)) {
            throw core::InputError("range", "the input has a missing value: interpolate it or cut the run there");
        }
    }
}

// Start: the first gaps' straight line for gap and velocity, a wide belief about the force.
Belief start_of(const SeparatedPlant& plant, const RunSignals& run, const FilterNoise& noise) {
    double n = 0, st = 0, sh = 0, stt = 0, sth = 0, t0 = run.time.front();
    for (std::size_t i = 0; i < run.time.size() && (n < 3 || run.time[i] - t0 < 0.3); ++i) {
        if (std::isfinite(run.gap[i])) {
            const double t = run.time[i] - t0;
            n += 1;
            st += t;
            sh += run.gap[i];
            stt += t * t;
            sth += t * run.gap[i];
        }
    }
    const double determinant = n * stt - st * st;
    const double velocity = determinant > 0 ? (n * sth - st * sh) / determinant : 0;
    Belief b;
    b.x = {(sh - velocity * st) / n, velocity, 0};
    double slope = 0, largest = 0;
    for (int i = 0; i <= 200; ++i) {
        largest = std::max(largest, std::abs(plant.ground_force(plant.lower + (plant.upper - plant.lower) * i / 200, slope)));
    }
    const double sh2 = noise.gap * noise.gap;
    const double sw2 = determinant > 0 ? n * sh2 / determinant : 1;
    b.p = {4 * sh2, 0, 0, 0, 4 * sw2 + 1e-4, 0, 0, 0, std::max(largest * largest, 1e-8)};
    return b;
}

double input_over(const RunSignals& run, std::size_t k) {  // mean over the step that ends at sample k
    if (run.input.empty()) {
        return 0;
    }
    return run.held ? run.input[k - 1] : 0.5 * (run.input[k - 1] + run.input[k]);
}

// One filter over one run, a sample at a time.
struct Runner {
    Filter filter;
    const RunSignals& run;
    const FilterNoise& noise;
    Belief belief;
    Belief predicted;
    Square phi{};
    std::size_t rejected = 0;

    Runner(const SeparatedPlant& plant, const RunSignals& r, const FilterNoise& n)
        : filter(plant, n), run(r), noise(n), belief(start_of(plant, r, n)) {}

    // Log likelihood of the sample.
    double take(std::size_t k, FilterEstimate& e) {
        if (k > 0) {
            filter.predict(belief, run.time[k] - run.time[k - 1], input_over(run, k), phi);
        }
        predicted = belief;
        double likelihood = 0, spread = 0;
        const auto score = [&](double innovation) {
            likelihood -= 0.5 * (innovation * innovation / spread + std::log(2 * std::numbers::pi * spread));
        };
        e.innovation = NAN;
        if (std::isfinite(run.gap[k])) {
            // Several refused in a row are no outliers: the belief was wrong.
            e.outlier = !filter.update(belief, 0, run.gap[k], noise.gap, e.innovation, spread, rejected >= 3);
            e.innovation_sigma = std::sqrt(spread);
            if (e.outlier) {
                ++rejected;
                likelihood -= 0.5 * (noise.gate * noise.gate + std::log(2 * std::numbers::pi * spread));
            } else {
                rejected = 0;
                score(e.innovation);
            }
        }
        if (!run.velocity.empty() && noise.velocity > 0 && std::isfinite(run.velocity[k])) {
            double innovation = 0;
            if (filter.update(belief, 1, run.velocity[k], noise.velocity, innovation, spread, false)) {
                score(innovation);
            }
        }
        filter.describe(belief, e);
        return likelihood;
    }
};

void smooth_back(const Filter& filter, const std::vector<Belief>& filtered, const std::vector<Belief>& predicted,
                 const std::vector<Square>& transitions, std::vector<FilterEstimate>& estimates) {
    Belief next = filtered.back();
    for (std::size_t k = filtered.size() - 1; k-- > 0;) {
        const Square gain = product(product(filtered[k].p, transposed(transitions[k + 1])), inverse_of(predicted[k + 1].p));
        Belief b = filtered[k];
        Square difference{};
        for (std::size_t i = 0; i < 9; ++i) {
            difference[i] = next.p[i] - predicted[k + 1].p[i];
        }
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                b.x[i] += gain[3 * i + j] * (next.x[j] - predicted[k + 1].x[j]);
            }
        }
        const Square change = product(product(gain, difference), transposed(gain));
        for (std::size_t i = 0; i < 9; ++i) {
            b.p[i] += change[i];
        }
        filter.describe(b, estimates[k]);
        next = b;
    }
}

}  // namespace

FilterResult extended_filter(const SeparatedPlant& plant, const RunSignals& run, const FilterNoise& noise, bool smooth) {
    check(run);
    if (!(noise.gap > 0)) {
        throw core::InputError("range", "the noise of the gap sensor must be positive");
    }
    Runner runner(plant, run, noise);
    const std::size_t n = run.time.size();
    FilterResult result;
    result.estimates.resize(n);
    std::vector<Belief> filtered, predicted;
    std::vector<Square> transitions;
    double last = NAN, squares = 0, neighbours = 0;
    for (std::size_t k = 0; k < n; ++k) {
        FilterEstimate& e = result.estimates[k];
        const double likelihood = runner.take(k, e);
        result.outliers += e.outlier ? 1U : 0U;
        result.missing += std::isnan(e.innovation) ? 1U : 0U;
        const double normal = e.outlier ? NAN : e.innovation / e.innovation_sigma;
        if (k > 10 && std::isfinite(normal)) {  // the start value came from the same data
            result.log_likelihood += likelihood;
            squares += normal * normal;
            neighbours += std::isfinite(last) ? normal * last : 0;
            ++result.used;
        }
        last = normal;
        if (smooth) {
            filtered.push_back(runner.belief);
            predicted.push_back(runner.predicted);
            transitions.push_back(runner.phi);
        }
    }
    if (result.used > 0) {
        result.mean_squared_innovation = squares / static_cast<double>(result.used);
        result.innovation_correlation = squares > 0 ? neighbours / squares : 0;
    }
    if (smooth && n > 1) {
        smooth_back(runner.filter, filtered, predicted, transitions, result.estimates);
    }
    return result;
}

double likely_force_density(const SeparatedPlant& plant, const std::vector<RunSignals>& runs, FilterNoise noise) {
    const auto score = [&](double exponent) {
        noise.force_density = std::pow(10.0, exponent);
        double sum = 0;
        for (const auto& run : runs) {
            sum += extended_filter(plant, run, noise).log_likelihood;
        }
        return sum;
    };
    double best = -7, highest = -INFINITY;
    for (double e = -12; e <= -2; e += 1) {
        const double s = score(e);
        if (s > highest) {
            highest = s;
            best = e;
        }
    }
    const double middle = best;
    for (const double step : {-0.66, -0.33, 0.33, 0.66}) {
        const double s = score(middle + step);
        if (s > highest) {
            highest = s;
            best = middle + step;
        }
    }
    return std::pow(10.0, best);
}

SurfaceProbability identify_surface(const std::vector<Surface>& surfaces, const RunSignals& run, const FilterNoise& noise,
                                    double switching) {
    if (surfaces.size() < 2) {
        throw core::InputError("few", "at least two surfaces are wanted to tell apart");
    }
    check(run);
    std::vector<Runner> bank;
    SurfaceProbability result;
    for (const auto& s : surfaces) {
        bank.emplace_back(s.plant, run, noise);
        result.names.push_back(s.name);
    }
    const std::size_t count = surfaces.size();
    std::vector<double> log_weight(count, -std::log(static_cast<double>(count)));
    result.time = run.time;
    result.probability.assign(count, std::vector<double>(run.time.size()));
    for (std::size_t k = 0; k < run.time.size(); ++k) {
        if (k > 0 && switching > 0) {
            const double stay = std::exp(-switching * (run.time[k] - run.time[k - 1]));
            for (double& w : log_weight) {
                w = std::log(stay * std::exp(w) + (1 - stay) / static_cast<double>(count));
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            FilterEstimate e;
            log_weight[i] += bank[i].take(k, e);
        }
        const double top = *std::max_element(log_weight.begin(), log_weight.end());
        double sum = 0;
        for (const double w : log_weight) {
            sum += std::exp(w - top);
        }
        for (std::size_t i = 0; i < count; ++i) {
            log_weight[i] -= top + std::log(sum);
            result.probability[i][k] = std::exp(log_weight[i]);
        }
    }
    result.best = static_cast<std::size_t>(std::max_element(log_weight.begin(), log_weight.end()) - log_weight.begin());
    return result;
}

}  // namespace underbody::estimator
