#include "surrogates/estimator/information.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/parallel.h"
#include "core/random.h"
#include "surrogates/estimator/linear_system.h"

namespace underbody::estimator {

namespace {

// Covariance of (gap, velocity, departure, drag scale) along a prescribed motion: the Riccati recursion at the truth.
struct Bound {
    double ground = 0, drag = 0, total = 0;
};

Bound bound_at(const SeparatedPlant& plant, const InformationOptions& o, double gap, double speed) {
    const double omega = 2 * std::numbers::pi / o.window, s = 1 / plant.virtual_mass, dt = o.sample_step;
    double largest = 1e-4, slope = 0;
    for (int i = 0; i <= 100; ++i) {
        largest = std::max(largest, std::abs(plant.ground_force(plant.lower + (plant.upper - plant.lower) * i / 100, slope)));
    }
    Matrix p = Matrix::diagonal({1e-2, 1e-2, largest * largest, o.drag_prior * o.drag_prior});
    const auto steps = static_cast<std::size_t>(std::round(o.window / dt));
    double ground_slope = 0, drag_slope = 0, drag = 0;
    for (std::size_t k = 0; k <= steps; ++k) {
        const double t = dt * static_cast<double>(k);
        const double h = gap + speed / omega * std::sin(omega * t), w = speed * std::cos(omega * t);
        plant.ground_force(h, ground_slope);
        drag = plant.drag_force(w, drag_slope);
        for (int sensor = 0; sensor < (o.noise.velocity > 0 ? 2 : 1); ++sensor) {
            const std::size_t c = sensor == 0 ? 0 : 1;
            const double sigma = sensor == 0 ? o.noise.gap : o.noise.velocity;
            const double spread = p(c, c) + sigma * sigma;
            const Vector column = p.column_of(c);
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t j = 0; j < 4; ++j) {
                    p(i, j) -= column[i] * column[j] / spread;
                }
            }
        }
        if (k == steps) {
            break;
        }
        const Matrix a{{0, 1, 0, 0},
                       {ground_slope * s, -drag_slope * s, s, -drag * s},
                       {0, 0, o.noise.force_time > 0 ? -1 / o.noise.force_time : 0, 0},
                       {0, 0, 0, 0}};
        const Matrix phi = Matrix::identity(4) + dt * a + (0.5 * dt * dt) * (a * a);
        p = phi * p * phi.transposed();
        const double q = o.noise.force_density;
        p(2, 2) += q * dt;
        p(1, 2) += q * s * dt * dt / 2;
        p(2, 1) += q * s * dt * dt / 2;
        p(1, 1) += q * s * s * dt * dt * dt / 3;
    }
    const auto along = [&](const Vector& g) {
        const Vector v = p * g;
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            sum += g[i] * v[i];
        }
        return std::sqrt(std::max(sum, 0.0));
    };
    return {along({ground_slope, 0, 1, 0}), along({0, drag_slope, 0, drag}), along({ground_slope, -drag_slope, 1, -drag})};
}

}  // namespace

InformationMap information_along_gap(const SeparatedPlant& plant, const InformationOptions& options, core::Progress& progress) {
    InformationMap map;
    map.gaps = options.gaps;
    map.speeds = options.speeds;
    const double lower = std::max(plant.lower, plant.contact_gap);
    for (int i = 0; options.gaps.empty() && i < 60; ++i) {
        map.gaps.push_back(lower + (plant.upper - lower) * (i + .5) / 60);
    }
    for (int i = 0; options.speeds.empty() && i < 13; ++i) {
        map.speeds.push_back(0.03 * i / 12);
    }
    const std::size_t n = map.gaps.size(), m = map.speeds.size();
    map.ground_sigma.resize(n * m);
    map.drag_sigma.resize(n * m);
    map.total_sigma.resize(n * m);
    map.ground_blind.assign(n * m, false);
    core::parallel_for(
        n * m,
        [&](std::size_t i) {
            const Bound b = bound_at(plant, options, map.gaps[i % n], map.speeds[i / n]);
            map.ground_sigma[i] = b.ground;
            map.drag_sigma[i] = b.drag;
            map.total_sigma[i] = b.total;
        },
        progress);
    double slope = 0;
    for (const double h : map.gaps) {
        map.ground_force.push_back(plant.ground_force(h, slope));
    }
    for (const double w : map.speeds) {
        map.drag_force.push_back(plant.drag_force(w, slope));
    }
    std::size_t blind = 0;
    for (std::size_t i = 0; i < n * m; ++i) {
        map.ground_blind[i] = map.ground_sigma[i] > std::max(std::abs(map.ground_force[i % n]), 1e-4);
        blind += map.ground_blind[i] ? 1U : 0U;
    }
    map.blind_share = static_cast<double>(blind) / static_cast<double>(n * m);
    return map;
}

core::Figure InformationMap::figure() const {
    core::Figure f;
    f.title = "Least error of the ground force that the sensors allow";
    f.caption =
        "Cramer-Rao bound of ground_force against gap and amplitude of the heave velocity, the drag law's scale unknown. Crosses: blind, "
        "the bound is above the force itself.";
    const auto edge = [](const std::vector<double>& v, bool upper) {
        const double half = v.size() > 1 ? 0.5 * (v[1] - v[0]) : 0.5e-3;
        return 1e3 * (upper ? v.back() + half : v.front() - half);
    };
    f.x = {"gap", "mm", edge(gaps, false), edge(gaps, true)};
    f.y = {"heave velocity", "mm/s", edge(speeds, false), edge(speeds, true)};
    core::FigureMap map;
    map.columns = gaps.size();
    map.rows = speeds.size();
    map.x_lower = f.x.lower;
    map.x_upper = f.x.upper;
    map.y_lower = f.y.lower;
    map.y_upper = f.y.upper;
    map.label = "bound of ground_force";
    map.unit = "mN";
    core::FigurePoints crosses;
    crosses.name = "blind";
    crosses.shape = core::FigurePoints::Shape::cross;
    crosses.size = 4;
    crosses.colour = core::palette(7);
    for (std::size_t i = 0; i < ground_sigma.size(); ++i) {
        map.values.push_back(1e3 * ground_sigma[i]);
        if (ground_blind[i]) {
            crosses.x.push_back(1e3 * gaps[i % gaps.size()]);
            crosses.y.push_back(1e3 * speeds[i / gaps.size()]);
        }
    }
    f.maps.push_back(map);
    if (!crosses.x.empty()) {
        f.points.push_back(crosses);
    }
    return f;
}

ObservabilityAlongGap observability_along_gap(const SeparatedPlant& plant, const std::vector<double>& gaps) {
    ObservabilityAlongGap result;
    result.gaps = gaps;
    for (const double h : gaps) {
        double slope = 0, drag_slope = 0;
        plant.ground_force(h, slope);
        plant.drag_force(0.01, drag_slope);
        const double s = 1 / plant.virtual_mass;
        const Observability o = observability(Matrix{{0, 1, 0}, {slope * s, -drag_slope * s, s}, {0, 0, 0}}, Matrix{{1, 0, 0}}, {0.1, 0.01, 0.01});
        result.smallest_singular_value.push_back(o.singular_values.back() / o.singular_values.front());
        const AugmentedModel frozen = frozen_model(plant, h, 0.01);
        result.separate_rank.push_back(observability(frozen.j_zeta(), frozen.a_zeta()).rank);
    }
    return result;
}

Consistency consistency_along_gap(const SeparatedPlant& plant, const FilterNoise& noise, const std::vector<double>& gaps, std::size_t runs,
                                  double duration, double step, std::uint64_t seed, core::Progress& progress) {
    Consistency c;
    c.gaps = gaps;
    c.runs = runs;
    c.nees.assign(gaps.size(), 0);
    c.coverage.assign(gaps.size(), 0);
    c.innovation.assign(gaps.size(), 0);
    std::vector<double> nees(gaps.size() * runs), inside(nees.size()), nis(nees.size());
    core::parallel_for(
        nees.size(),
        [&](std::size_t job) {
            const double gap = gaps[job / runs];
            core::Random random(seed, job);
            const auto n = static_cast<std::size_t>(duration / step) + 1;
            RunSignals run;
            std::vector<double> truth(3 * n);
            double h = gap, w = random.uniform(-.01, .01), d = 2e-3 * random.normal(), slope = 0;
            for (std::size_t k = 0; k < n; ++k) {
                truth[3 * k] = h;
                truth[3 * k + 1] = w;
                truth[3 * k + 2] = d;
                run.time.push_back(step * static_cast<double>(k));
                run.gap.push_back(h + noise.gap * random.normal());
                if (noise.velocity > 0) {
                    run.velocity.push_back(w + noise.velocity * random.normal());
                }
                // A hand on the vehicle that keeps it near the gap: the input is known to the filter.
                const double u = -plant.ground_force(gap, slope) - plant.bias - 2 * (h - gap) - 2 * w;
                run.input.push_back(u);
                const int pieces = 4;
                for (int i = 0; i < pieces; ++i) {
                    plant.advance(h, w, u + d, step / pieces);
                    d += std::sqrt(noise.force_density * step / pieces) * random.normal() -
                         (noise.force_time > 0 ? d * step / pieces / noise.force_time : 0);
                }
            }
            run.held = true;
            FilterNoise own = noise;
            own.gate = 0;
            const FilterResult r = extended_filter(plant, run, own);
            const FilterEstimate& e = r.estimates.back();
            const Vector error{truth[3 * n - 3] - e.gap, truth[3 * n - 2] - e.velocity, truth[3 * n - 1] - e.departure};
            Matrix p(3, 3);
            std::copy(e.covariance.begin(), e.covariance.end(), p.data());
            const Vector solved = solve(p, error);
            nees[job] = error[0] * solved[0] + error[1] * solved[1] + error[2] * solved[2];
            const double force = plant.ground_force(truth[3 * n - 3], slope) + truth[3 * n - 1];
            inside[job] = std::abs(force - e.ground_force) < 1.96 * e.ground_sigma ? 1 : 0;
            nis[job] = r.mean_squared_innovation;
        },
        progress);
    for (std::size_t i = 0; i < nees.size(); ++i) {
        c.nees[i / runs] += nees[i] / static_cast<double>(runs);
        c.coverage[i / runs] += inside[i] / static_cast<double>(runs);
        c.innovation[i / runs] += nis[i] / static_cast<double>(runs);
    }
    const double spread = 1.96 * std::sqrt(6.0 / static_cast<double>(runs));  // variance of chi-square with 3: 6
    c.lower = 3 - spread;
    c.upper = 3 + spread;
    return c;
}

core::Figure Consistency::figure() const {
    core::Figure f;
    f.title = "Does the filter state its error truly?";
    f.caption = "Normalised estimation error squared of (gap, velocity, force departure) at the end of " + std::to_string(runs) +
                " simulated runs per gap; 3 is right, the band holds 95 % of such means.";
    f.x = {"gap", "mm", 0, 0, false};
    f.y = {"NEES", "1", 0, 0, false};
    core::FigureBand band;
    core::FigurePoints points;
    points.name = "mean of the runs";
    points.colour = core::palette(0);
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        band.x.push_back(1e3 * gaps[i]);
        band.lower.push_back(lower);
        band.upper.push_back(upper);
        points.x.push_back(1e3 * gaps[i]);
        points.y.push_back(nees[i]);
    }
    f.bands.push_back(band);
    f.points.push_back(points);
    f.lines.push_back({false, 3, "", {120, 120, 120, 255}, true});
    return f;
}

void to_json(nlohmann::json& j, const InformationMap& m) {
    j = {{"gaps", m.gaps},           {"speeds", m.speeds},       {"ground_sigma", m.ground_sigma},
         {"drag_sigma", m.drag_sigma}, {"total_sigma", m.total_sigma}, {"ground_force", m.ground_force},
         {"blind_share", m.blind_share}};
}

void to_json(nlohmann::json& j, const Consistency& c) {
    j = {{"gaps", c.gaps}, {"nees", c.nees}, {"lower", c.lower}, {"upper", c.upper}, {"coverage", c.coverage}, {"innovation", c.innovation},
         {"runs", c.runs}};
}

}  // namespace underbody::estimator
