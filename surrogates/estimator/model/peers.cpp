#include "surrogates/estimator/model/peers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/random.h"
#include "surrogates/estimator/model/dmd.h"

namespace underbody::estimator {

namespace {

/// F_g - F_d in a state, and its rate of change.
void total_force(const SeparatedPlant& plant, double h, double w, double u, double& force, double& rate) {
    double ground_slope = 0;
    DragSlopes drag;
    force = plant.ground_force(h, ground_slope) - plant.drag_force(h, w, drag);
    rate = (ground_slope - drag.gap) * w - drag.velocity * plant.acceleration(h, w, u);
}

/// m/s^2, under the total force that is known of the motion there.
double acceleration_of(const SeparatedPlant& plant, const TestMotion& m, std::size_t k) {
    dynamics::HeaveLoad load;
    load.force = m.total_force[k] + m.input[k] + plant.bias;
    if (plant.other_force) {
        load.force += plant.other_force(0, m.gap[k], m.velocity[k], m.input[k]).force;
    }
    const auto inertia = plant.inertia_at(m.gap[k]);
    dynamics::HeaveSlopes unused;
    return dynamics::heave_acceleration(inertia, m.velocity[k], load, {}, unused);
}

}  // namespace

std::vector<TestMotion> test_motions(const SeparatedPlant& plant, const PredictionTest& test) {
    std::vector<TestMotion> motions;
    const auto n = static_cast<std::size_t>(std::round(test.horizon / test.step));
    for (std::size_t r = 0; r < test.runs; ++r) {
        core::Random random(test.seed, r);
        double h = random.uniform(test.gap_lower, test.gap_upper),
               w = random.uniform(test.velocity_lower, test.velocity_upper), u = 0;
        TestMotion m;
        m.step = test.step;
        for (std::size_t k = 0; k <= n; ++k) {
            if (k % 5 == 0) {
                u = 0.95 * u + std::sqrt(1 - 0.95 * 0.95) * test.input_sigma * random.normal();
            }
            double force = 0, rate = 0;
            total_force(plant, h, w, u, force, rate);
            m.gap.push_back(h);
            m.velocity.push_back(w);
            m.input.push_back(u);
            m.total_force.push_back(force);
            m.total_rate.push_back(rate);
            plant.advance(h, w, u, test.step);
        }
        motions.push_back(std::move(m));
    }
    return motions;
}

namespace {

struct Sums {
    double gap = 0, velocity = 0, force = 0, acceleration = 0, rate = 0, end = 0, n = 0, motions = 0;
    bool diverged = false;
    [[nodiscard]] PredictionError error(const std::string& name, bool forces) const {
        return {name,
                std::sqrt(acceleration / n),
                forces ? std::sqrt(rate / n) : NAN,
                std::sqrt(gap / n),
                std::sqrt(velocity / n),
                std::sqrt(end / motions),
                forces ? std::sqrt(force / n) : NAN,
                diverged};
    }
};

// Range of the motions.
struct Range {
    double gap_lower = INFINITY, gap_upper = -INFINITY, velocity_rms = 0, velocity_largest = 0;
};

Range range_of(const std::vector<TestMotion>& motions) {
    Range r;
    double n = 0;
    for (const TestMotion& m : motions) {
        for (std::size_t k = 0; k < m.gap.size(); ++k) {
            r.gap_lower = std::min(r.gap_lower, m.gap[k]);
            r.gap_upper = std::max(r.gap_upper, m.gap[k]);
            r.velocity_rms += m.velocity[k] * m.velocity[k];
            r.velocity_largest = std::max(r.velocity_largest, std::abs(m.velocity[k]));
            n += 1;
        }
    }
    if (n == 0) {
        throw core::InputError("empty", "there is no motion to predict");
    }
    r.velocity_rms = std::sqrt(r.velocity_rms / n);
    return r;
}

// Adds one sample: predicted gap, velocity and total force (NaN: none) beside the truth.
struct Judge {
    double gap_lower, gap_upper, velocity_limit;
    explicit Judge(const Range& r)
        : gap_lower(r.gap_lower - 10 * (r.gap_upper - r.gap_lower)),
          gap_upper(r.gap_upper + 10 * (r.gap_upper - r.gap_lower)),
          velocity_limit(10 * r.velocity_largest + 1e-3) {}

    void add(Sums& sums, const TestMotion& m, std::size_t k, double gap, double velocity, double force) const {
        sums.diverged = sums.diverged || !(gap > gap_lower && gap < gap_upper);
        const double h = std::isfinite(gap) ? std::clamp(gap, gap_lower, gap_upper) : gap_upper;
        const double w =
            std::isfinite(velocity) ? std::clamp(velocity, -velocity_limit, velocity_limit) : velocity_limit;
        const auto square = [](double x) { return x * x; };
        sums.gap += square(h - m.gap[k]);
        sums.velocity += square(w - m.velocity[k]);
        sums.force += std::isfinite(force) ? square(force - m.total_force[k]) : 0;
        sums.n += 1;
        if (k + 1 == m.gap.size()) {
            sums.end += square(h - m.gap[k]);
            sums.motions += 1;
        }
    }
};

int place_of(const AugmentedModel& model, const char* name) {
    const auto at = std::find(model.layout.states.begin(), model.layout.states.end(), name);
    return at == model.layout.states.end() ? -1 : static_cast<int>(at - model.layout.states.begin());
}

PredictionError judge_linear(const SeparatedPlant& usual, const std::string& name, const AugmentedModel& model,
                             const std::vector<TestMotion>& motions, const Judge& judge) {
    const std::size_t iw = model.state("heave_velocity"), ih = model.state("gap"), n = model.layout.states.size();
    const int total = place_of(model, "total_force"), ground = place_of(model, "ground_force"),
              drag = place_of(model, "drag_force");
    const bool forces = total >= 0 || (ground >= 0 && drag >= 0);
    const auto force_of = [&](const Vector& x) {
        return total >= 0 ? x[static_cast<std::size_t>(total)]
               : forces   ? x[static_cast<std::size_t>(ground)] - x[static_cast<std::size_t>(drag)]
                          : NAN;
    };
    Matrix held(n, 2);
    held.set_block(0, 0, model.B);
    held.set_block(0, 1, Matrix::column(model.offset));
    std::vector<double> row(model.layout.channels());
    const auto state_at = [&](const TestMotion& m, std::size_t k) {
        sample_at(m.plant ? *m.plant : usual, model.layout, m.input[k], m.velocity[k], m.gap[k], row.data());
        return Vector(row.begin() + 1, row.begin() + 1 + static_cast<std::ptrdiff_t>(n));
    };
    Sums sums;
    double step = 0;
    Discrete d;
    for (const TestMotion& m : motions) {
        const SeparatedPlant& plant = m.plant ? *m.plant : usual;
        if (m.step != step) {
            step = m.step;
            d = discretise(model.A, held, step);
        }
        Vector x = state_at(m, 0);
        for (std::size_t k = 0; k < m.gap.size(); ++k) {
            const Vector rate = model.derivative(state_at(m, k), {m.input[k]});
            const double acceleration = acceleration_of(plant, m, k);
            sums.acceleration += (rate[iw] - acceleration) * (rate[iw] - acceleration);
            sums.rate += forces ? std::pow(force_of(rate) - m.total_rate[k], 2) : 0;
            judge.add(sums, m, k, x[ih], x[iw], force_of(x));
            Vector next = d.phi * x;
            for (std::size_t i = 0; i < n; ++i) {
                next[i] += d.gamma(i, 0) * m.input[k] + d.gamma(i, 1);
            }
            x = next;
        }
    }
    return sums.error(name, forces);
}

PredictionError judge_plant(const SeparatedPlant& usual, const std::vector<TestMotion>& motions, const Judge& judge) {
    Sums sums;
    for (const TestMotion& m : motions) {
        const SeparatedPlant& plant = m.plant ? *m.plant : usual;
        double h = m.gap[0], w = m.velocity[0];
        for (std::size_t k = 0; k < m.gap.size(); ++k) {
            const double own = plant.acceleration(m.gap[k], m.velocity[k], m.input[k]);
            const double acceleration = acceleration_of(plant, m, k);
            sums.acceleration += (own - acceleration) * (own - acceleration);
            double force = 0, rate = 0;
            total_force(plant, m.gap[k], m.velocity[k], m.input[k], force, rate);
            sums.rate += std::pow(rate - m.total_rate[k], 2);
            total_force(plant, h, w, m.input[k], force, rate);
            judge.add(sums, m, k, h, w, force);
            const int pieces = std::max(1, static_cast<int>(std::ceil(m.step / 0.02 - 1e-9)));
            for (int i = 0; i < pieces; ++i) {
                plant.advance(h, w, m.input[k], m.step / pieces);
            }
        }
    }
    return sums.error("nonlinear", true);
}

}  // namespace

std::vector<PredictionError> compare_predictions(const SeparatedPlant& plant, const NamedModels& models,
                                                 const std::vector<TestMotion>& motions, core::Progress& progress) {
    const Range range = range_of(motions);
    const Judge judge(range);
    const double middle = 0.5 * (range.gap_lower + range.gap_upper);
    const auto plane = [](const PlaneModel& p) {
        return AugmentedModel::from_matrices({{"input_force"}, {"heave_velocity", "gap"}, 2}, p.A, Matrix::column(p.B),
                                             p.offset);
    };
    std::vector<PredictionError> errors;
    errors.push_back(
        judge_linear(plant, "tangent at mid-range", plane(tangent_model(plant, middle, 0)), motions, judge));
    errors.push_back(judge_linear(plant, "equivalent linear",
                                  plane(equivalent_model(plant, middle, range.velocity_rms, MotionShape::gaussian)),
                                  motions, judge));
    for (const auto& [name, model] : models) {
        progress.check();
        errors.push_back(judge_linear(plant, name, model, motions, judge));
    }
    errors.push_back(judge_plant(plant, motions, judge));
    return errors;
}

const std::vector<std::string>& usual_dictionary() {
    static const std::vector<std::string> names{"ground_force", "velocity_squared", "gap_squared", "gap_cubed"};
    return names;
}

NamedModels usual_peers(const SeparatedPlant& plant, const TrainingSet& samples, const SnapshotPairs& plain,
                        const SnapshotPairs& lifted) {
    NamedModels models;
    const Moments m = moments(samples.view(), samples.layout.names());
    const auto rows = heave_rows(samples.layout, plant.virtual_mass, plant.bias);
    const AugmentedModel squares = learn(m, samples.layout);
    LearnOptions latent;
    latent.fit = Fit::method2;
    latent.order = std::max<std::size_t>(squares.rank, 2) - 1;
    models.emplace_back("order " + std::to_string(latent.order) + ", p3",
                        corrected(learn(m, samples.layout, latent), Correction::p3, rows));
    models.emplace_back("least squares, p2", corrected(squares, Correction::p2, rows));
    for (const SnapshotPairs* pairs : {&plain, &lifted}) {
        const char* name = pairs == &plain ? "dmdc" : "edmd";
        try {
            models.emplace_back(name, learn_dmd(*pairs));
        } catch (const core::InputError&) {
            continue;  // no continuous form from these snapshots
        }
    }
    return models;
}

NamedModels usual_peers(const SeparatedPlant& plant, TrainingOptions training, double dmd_step,
                        core::Progress& progress) {
    training.auxiliaries = {"ground_force", "drag_force"};
    const TrainingSet set = training_set(plant, training, progress);
    training.auxiliaries = {};
    const SnapshotPairs plain = snapshot_pairs(plant, training, dmd_step, progress);
    training.auxiliaries = usual_dictionary();
    return usual_peers(plant, set, plain, snapshot_pairs(plant, training, dmd_step, progress));
}

std::string prediction_text(const std::vector<PredictionError>& errors) {
    std::string text =
        "model                  d velocity   d force     gap   gap at end  velocity  force\n"
        "                           mm/s^2      mN/s      mm           mm      mm/s     mN\n";
    for (const PredictionError& e : errors) {
        char line[200];
        const auto number = [](double v, char* out, std::size_t size) {
            std::isfinite(v) ? std::snprintf(out, size, "%.4g", 1e3 * v) : std::snprintf(out, size, "-");
        };
        char rate[24], force[24];
        number(e.total_rate, rate, sizeof rate);
        number(e.total_force, force, sizeof force);
        std::snprintf(line, sizeof line, "%-22s %10.4g %9s %7.4g %12.4g %9.4g %6s%s\n", e.model.c_str(),
                      1e3 * e.acceleration, rate, 1e3 * e.gap, 1e3 * e.gap_at_end, 1e3 * e.velocity, force,
                      e.diverged ? "  leaves the range" : "");
        text += line;
    }
    return text;
}

core::Figure prediction_figure(const std::vector<PredictionError>& errors, const std::string& caption) {
    core::Figure f;
    f.title = "Models beside each other: error of the predicted gap";
    f.caption = caption;
    f.x = {"model", "1", 0, 0, false};
    f.y = {"rms error of the gap", "mm", 0, 0, false};
    core::FigureBars bars;
    for (const PredictionError& e : errors) {
        bars.labels.push_back(e.model + (e.diverged ? " (diverges)" : ""));
        bars.values.push_back(1e3 * e.gap);
    }
    f.bars.push_back(bars);
    return f;
}

void to_json(nlohmann::json& j, const PredictionError& e) {
    const auto number = [](double v) { return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(); };
    j = {{"model", e.model},
         {"derivatives", {{"heave_velocity", e.acceleration}, {"total_force", number(e.total_rate)}}},
         {"gap", e.gap},
         {"gap_at_end", e.gap_at_end},
         {"heave_velocity", e.velocity},
         {"total_force", number(e.total_force)},
         {"diverged", e.diverged}};
}

}  // namespace underbody::estimator
