#include "surrogates/estimator/observe/information.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/normal.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/text.h"
#include "surrogates/estimator/model/linear_system.h"

namespace underbody::estimator {

namespace {

// Covariance of (gap, velocity, departure, drag scale) along a prescribed motion: the Riccati recursion at the truth.
struct Bound {
    double ground = 0, drag = 0, total = 0;
};

double largest_ground_force(const SeparatedPlant& plant) {
    double largest = 1e-4, slope = 0;
    for (int i = 0; i <= 100; ++i) {
        largest =
            std::max(largest, std::abs(plant.ground_force(plant.lower + (plant.upper - plant.lower) * i / 100, slope)));
    }
    return largest;
}

/// A reading of one state.
void take_reading(Matrix& p, std::size_t state, double sigma) {
    const double spread = p(state, state) + sigma * sigma;
    const Vector column = p.column_of(state);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            p(i, j) -= column[i] * column[j] / spread;
        }
    }
}

/// One standard deviation of a sum of states.
double deviation_along(const Matrix& p, const Vector& g) {
    const Vector v = p * g;
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        sum += g[i] * v[i];
    }
    return std::sqrt(std::max(sum, 0.0));
}

Bound bound_at(const SeparatedPlant& plant, const InformationOptions& o, double gap, double speed) {
    const double omega = 2 * std::numbers::pi / o.window, dt = o.sample_step;
    const double largest = largest_ground_force(plant);
    Matrix p = Matrix::diagonal({1e-2, 1e-2, largest * largest, o.drag_prior * o.drag_prior});
    const auto steps = static_cast<std::size_t>(std::round(o.window / dt));
    double ground_slope = 0, drag = 0;
    DragSlopes drag_slopes;
    for (std::size_t k = 0; k <= steps; ++k) {
        const double t = dt * static_cast<double>(k);
        const double h = gap + speed / omega * std::sin(omega * t), w = speed * std::cos(omega * t);
        plant.ground_force(h, ground_slope);
        drag = plant.drag_force(h, w, drag_slopes);
        dynamics::HeaveSlopes slopes;
        plant.acceleration(h, w, 0, 0, slopes);
        const double s = 1 / slopes.mass;
        take_reading(p, 0, o.noise.gap);
        if (o.noise.velocity > 0) {
            take_reading(p, 1, o.noise.velocity);
        }
        if (k == steps) {
            break;
        }
        const Matrix a{{0, 1, 0, 0},
                       {slopes.gap, slopes.velocity, s, -drag * s},
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
    return {deviation_along(p, {ground_slope, 0, 1, 0}),
            deviation_along(p, {drag_slopes.gap, drag_slopes.velocity, 0, drag}),
            deviation_along(p, {ground_slope - drag_slopes.gap, -drag_slopes.velocity, 1, -drag})};
}

}  // namespace

InformationMap information_along_gap(const SeparatedPlant& plant, const InformationOptions& options,
                                     core::Progress& progress) {
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
        map.drag_force.push_back(plant.drag(plant.upper, w));
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
        "Cramer-Rao bound of ground_force against gap and amplitude of the heave velocity, the drag law's scale "
        "unknown. Crosses: blind, "
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

core::Figure InformationMap::along_gap(double speed) const {
    const auto nearest = std::min_element(
        speeds.begin(), speeds.end(), [&](double a, double b) { return std::abs(a - speed) < std::abs(b - speed); });
    const auto row = static_cast<std::size_t>(nearest - speeds.begin()) * gaps.size();
    core::Figure f;
    f.title = "What can be told apart at " + core::format_number(1e3 * *nearest, 3) + " mm/s";
    f.caption =
        "Least standard deviations of the forces along the gap. A force is seen where its size lies above its "
        "curve.";
    f.x = {"gap", "mm", 1e3 * gaps.front(), 1e3 * gaps.back()};
    double highest = 0, lowest = std::numeric_limits<double>::infinity();
    const auto curve = [&](const char* name, const std::vector<double>& values, std::size_t from, int colour,
                           bool dashed) {
        core::FigureCurve drawn;
        drawn.name = name;
        drawn.colour = core::palette(colour);
        drawn.dashed = dashed;
        for (std::size_t i = 0; i < gaps.size(); ++i) {
            drawn.x.push_back(1e3 * gaps[i]);
            drawn.y.push_back(1e3 * std::abs(values[from + i]));
            highest = std::max(highest, drawn.y.back());
            lowest = drawn.y.back() > 0 ? std::min(lowest, drawn.y.back()) : lowest;
        }
        f.curves.push_back(std::move(drawn));
    };
    curve("error of the ground force", ground_sigma, row, 1, false);
    curve("error of the drag", drag_sigma, row, 2, false);
    curve("error of their sum", total_sigma, row, 0, false);
    curve("size of the ground force", ground_force, 0, 7, true);
    f.y = {"force", "mN", 0.7 * std::max(lowest, 1e-6 * highest), 1.5 * highest};
    f.y.logarithmic = lowest < highest;  // errors are far smaller than what they are errors of
    return f;
}

core::Table InformationMap::table() const {
    core::Table table;
    std::vector<double> gap, speed, ground, drag, blind;
    for (std::size_t i = 0; i < ground_sigma.size(); ++i) {
        gap.push_back(gaps[i % gaps.size()]);
        speed.push_back(speeds[i / gaps.size()]);
        ground.push_back(ground_force[i % gaps.size()]);
        drag.push_back(drag_force[i / gaps.size()]);
        blind.push_back(ground_blind[i] ? 1 : 0);
    }
    table.add_numbers("gap", "m", std::move(gap));
    table.add_numbers("heave_velocity", "m/s", std::move(speed));
    table.add_numbers("ground_force", "N", std::move(ground));
    table.add_numbers("ground_force_sigma", "N", ground_sigma);
    table.add_numbers("drag_force", "N", std::move(drag));
    table.add_numbers("drag_force_sigma", "N", drag_sigma);
    table.add_numbers("total_force_sigma", "N", total_sigma);
    table.add_numbers("blind", "1", std::move(blind));
    return table;
}

ObservabilityAlongGap observability_along_gap(const SeparatedPlant& plant, const std::vector<double>& gaps) {
    ObservabilityAlongGap result;
    result.gaps = gaps;
    for (const double h : gaps) {
        constexpr double slow = 0.01;  // m/s
        dynamics::HeaveSlopes slopes;
        plant.acceleration(h, slow, 0, 0, slopes);
        const Observability o =
            observability(Matrix{{0, 1, 0}, {slopes.gap, slopes.velocity, 1 / slopes.mass}, {0, 0, 0}},
                          Matrix{{1, 0, 0}}, {0.1, 0.01, 0.01});
        result.smallest_singular_value.push_back(o.singular_values.back() / o.singular_values.front());
        const AugmentedModel frozen = frozen_model(plant, h, slow);
        result.separate_rank.push_back(observability(frozen.j_zeta(), frozen.a_zeta()).rank);
    }
    return result;
}

namespace {

struct Trial {
    double nees = 0, inside = 0, innovation = 0;
};

// One simulated run under the filter's own assumptions, and what the filter says at its end.
Trial consistency_trial(const SeparatedPlant& plant, const ConsistencyOptions& o, double gap, double speed,
                        std::uint64_t job) {
    core::Random random(o.seed, job);
    const auto n = static_cast<std::size_t>(o.duration / o.step) + 1;
    const double omega = 2 * std::numbers::pi / std::max(o.duration / 2, 1.0),
                 phase = random.uniform(0, 2 * std::numbers::pi);
    // The hand leads the body along gap + speed/omega sin(omega t): the input is known to the filter.
    const auto wanted = [&](double t) { return gap + speed / omega * std::sin(omega * t + phase); };
    RunSignals run;
    run.held = true;
    double h = wanted(0), w = speed * std::cos(phase), d = 2e-3 * random.normal(), slope = 0;
    std::array<double, 3> truth{};
    for (std::size_t k = 0; k < n; ++k) {
        const double t = o.step * static_cast<double>(k);
        truth = {h, w, d};
        run.time.push_back(t);
        run.gap.push_back(h + o.noise.gap * random.normal());
        if (o.noise.velocity > 0) {
            run.velocity.push_back(w + o.noise.velocity * random.normal());
        }
        const double u = -plant.ground_force(wanted(t), slope) - plant.bias - 4 * (h - wanted(t)) -
                         4 * (w - speed * std::cos(omega * t + phase));
        run.input.push_back(u);
        const int pieces = 4;
        for (int i = 0; i < pieces; ++i) {
            plant.advance(h, w, u + d, o.step / pieces);
            d += std::sqrt(o.noise.force_density * o.step / pieces) * random.normal() -
                 (o.noise.force_time > 0 ? d * o.step / pieces / o.noise.force_time : 0);
        }
    }
    FilterNoise own = o.noise;
    own.gate = 0;
    const FilterResult r = extended_filter(plant, run, own);
    const FilterEstimate& e = r.estimates.back();
    const Vector error{truth[0] - e.gap, truth[1] - e.velocity, truth[2] - e.departure};
    Matrix p(3, 3);
    std::copy(e.covariance.begin(), e.covariance.end(), p.data());
    const Vector solved = solve(p, error);
    const double force = plant.ground_force(truth[0], slope) + truth[2];
    return {error[0] * solved[0] + error[1] * solved[1] + error[2] * solved[2],
            std::abs(force - e.ground_force) < core::sigmas_of_95 * e.ground_sigma ? 1.0 : 0.0,
            r.mean_squared_innovation};
}

}  // namespace

Consistency consistency_along_gap(const SeparatedPlant& plant, const ConsistencyOptions& options,
                                  core::Progress& progress) {
    Consistency c;
    c.gaps = options.gaps;
    c.speeds = options.speeds;
    c.runs = options.runs;
    const double lower = std::max(plant.lower, plant.contact_gap);
    for (int i = 0; options.gaps.empty() && i < 8; ++i) {
        c.gaps.push_back(lower + (plant.upper - lower) * (i + 1.0) / 9);
    }
    const std::size_t cells = c.gaps.size() * c.speeds.size();
    std::vector<Trial> trials(cells * options.runs);
    core::parallel_for(
        trials.size(),
        [&](std::size_t job) {
            const std::size_t cell = job / options.runs;
            trials[job] =
                consistency_trial(plant, options, c.gaps[cell % c.gaps.size()], c.speeds[cell / c.gaps.size()], job);
        },
        progress);
    c.nees.assign(cells, 0);
    c.coverage.assign(cells, 0);
    c.innovation.assign(cells, 0);
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const double share = 1 / static_cast<double>(options.runs);
        c.nees[i / options.runs] += trials[i].nees * share;
        c.coverage[i / options.runs] += trials[i].inside * share;
        c.innovation[i / options.runs] += trials[i].innovation * share;
    }
    const double spread =
        core::sigmas_of_95 * std::sqrt(6.0 / static_cast<double>(options.runs));  // variance of chi-square with 3: 6
    c.lower = 3 - spread;
    c.upper = 3 + spread;
    for (const double v : c.nees) {
        c.inside += v > c.lower && v < c.upper ? 1 / static_cast<double>(cells) : 0;
    }
    return c;
}

core::Figure Consistency::figure() const {
    core::Figure f;
    f.title = "Does the filter state its error truly?";
    f.caption =
        "Normalised estimation error squared of (gap, velocity, force departure) at the end of " +
        std::to_string(runs) +
        " simulated runs per point, by amplitude of the heave velocity; 3 is right, the band holds 95 % of such means.";
    f.x = {"gap", "mm", 0, 0, false};
    f.y = {"NEES", "1", 0, 0, false};
    core::FigureBand band;
    band.name = "where 95 % of such means lie";
    for (const double gap : gaps) {
        band.x.push_back(1e3 * gap);
        band.lower.push_back(lower);
        band.upper.push_back(upper);
    }
    f.bands.push_back(band);
    for (std::size_t s = 0; s < speeds.size(); ++s) {
        core::FigurePoints points;
        points.name = core::format_number(1e3 * speeds[s], 3) + " mm/s";
        points.colour = core::palette(s);
        for (std::size_t i = 0; i < gaps.size(); ++i) {
            points.x.push_back(1e3 * gaps[i]);
            points.y.push_back(nees[s * gaps.size() + i]);
        }
        f.points.push_back(points);
    }
    f.lines.push_back({false, 3, "as stated", {120, 120, 120, 255}, true});
    return f;
}

void to_json(nlohmann::json& j, const InformationMap& m) {
    j = {{"gaps", m.gaps},
         {"speeds", m.speeds},
         {"ground_sigma", m.ground_sigma},
         {"drag_sigma", m.drag_sigma},
         {"total_sigma", m.total_sigma},
         {"ground_force", m.ground_force},
         {"blind_share", m.blind_share}};
}

void to_json(nlohmann::json& j, const Consistency& c) {
    j = {{"gaps", c.gaps},
         {"speeds", c.speeds},
         {"nees", c.nees},
         {"lower", c.lower},
         {"upper", c.upper},
         {"coverage", c.coverage},
         {"innovation", c.innovation},
         {"runs", c.runs},
         {"inside", c.inside}};
}

void to_json(nlohmann::json& j, const ObservabilityAlongGap& o) {
    j = {{"gaps", o.gaps}, {"smallest_singular_value", o.smallest_singular_value}, {"separate_rank", o.separate_rank}};
}

}  // namespace underbody::estimator
