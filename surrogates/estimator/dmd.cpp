#include "surrogates/estimator/dmd.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "surrogates/estimator/internal/eigen.h"

namespace underbody::estimator {

SnapshotPairs snapshot_pairs(const SeparatedPlant& plant, const TrainingOptions& options, double step, core::Progress& progress) {
    if (!(step > 0)) {
        throw core::InputError("range", "the step between snapshots must be positive");
    }
    const TrainingSet set = training_set(plant, options, progress);
    SnapshotPairs pairs;
    pairs.layout = set.layout;
    pairs.step = step;
    pairs.count = set.count;
    pairs.values = set.values;
    const std::size_t channels = set.layout.channels(), n = set.layout.states.size();
    std::vector<double> row(channels);
    const int pieces = std::max(1, static_cast<int>(std::ceil(step / 0.02)));
    for (std::size_t i = 0; i < set.count; ++i) {
        double* pair = pairs.values.data() + i * channels;
        double w = pair[1], h = pair[2];
        for (int k = 0; k < pieces; ++k) {
            plant.advance(h, w, pair[0], step / pieces);
        }
        sample_at(plant, set.layout, pair[0], w, h, row.data());
        std::copy(row.begin() + 1, row.begin() + 1 + static_cast<std::ptrdiff_t>(n), pair + 1 + n);
    }
    return pairs;
}

SnapshotPairs snapshot_pairs(const Layout& layout, const std::vector<std::vector<double>>& inputs,
                             const std::vector<std::vector<double>>& states, double step) {
    SnapshotPairs pairs;
    pairs.layout = layout;
    pairs.step = step;
    const std::size_t n = states.empty() ? 0 : states.front().size();
    for (std::size_t k = 0; k + 1 < n; ++k) {
        const std::size_t before = pairs.values.size();
        for (const auto& u : inputs) {
            pairs.values.push_back(u[k]);
        }
        for (const std::size_t at : {k, k + 1}) {
            for (const auto& x : states) {
                pairs.values.push_back(x[at]);
            }
        }
        const bool whole = std::all_of(pairs.values.begin() + static_cast<std::ptrdiff_t>(before), pairs.values.end(),
                                       [](double v) { return std::isfinite(v); });
        if (whole) {
            ++pairs.count;
        } else {
            pairs.values.resize(before);
        }
    }
    return pairs;
}

AugmentedModel learn_dmd(const SnapshotPairs& pairs, std::size_t order) {
    const Layout& layout = pairs.layout;
    const std::size_t nu = layout.inputs.size(), nx = layout.states.size(), ne = nu + nx;
    if (pairs.count < layout.channels()) {
        throw core::InputError("few", std::to_string(pairs.count) + " pairs of snapshots cannot fix a model of " +
                                          std::to_string(layout.channels()) + " channels");
    }
    const Moments m = moments(SampleView::samples_in_rows(pairs.values.data(), pairs.count, layout.channels()), layout.names());
    Vector sigma(layout.channels());
    for (std::size_t i = 0; i < sigma.size(); ++i) {
        sigma[i] = std::sqrt(std::max(m.covariance(i, i), 0.0));
    }
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(ne), static_cast<Eigen::Index>(ne));
    Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(nx), static_cast<Eigen::Index>(ne));
    for (std::size_t j = 0; j < ne; ++j) {
        for (std::size_t i = 0; i < ne && sigma[j] > 0; ++i) {
            own(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = sigma[i] > 0 ? m.covariance(i, j) / (sigma[i] * sigma[j]) : 0;
        }
        for (std::size_t i = 0; i < nx && sigma[j] > 0; ++i) {
            cross(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = m.covariance(ne + i, j) / sigma[j];
        }
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(own);
    AugmentedModel model;
    model.layout = layout;
    model.samples = pairs.count;
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(own.rows(), own.cols());
    for (Eigen::Index i = own.rows() - 1; i >= 0; --i) {
        model.eigenvalues.push_back(solver.eigenvalues()[i]);
        const bool noise = solver.eigenvalues()[i] <= 1e-12 * static_cast<double>(own.rows());
        model.rank += noise ? 0U : 1U;
        if (!noise && (order == 0 || model.order < order)) {
            ++model.order;
            inverse += solver.eigenvectors().col(i) * solver.eigenvectors().col(i).transpose() / solver.eigenvalues()[i];
        }
    }
    const Eigen::MatrixXd law = cross * inverse;
    // One step of (x, u, 1), input and one held: its logarithm holds A, B and the offset.
    Matrix whole = Matrix::identity(nx + nu + 1);
    for (std::size_t i = 0; i < nx; ++i) {
        double constant = m.mean[ne + i];
        for (std::size_t j = 0; j < ne; ++j) {
            const double value = sigma[j] > 0 ? law(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) / sigma[j] : 0;
            whole(i, j < nu ? nx + j : j - nu) = value;
            constant -= value * m.mean[j];
        }
        whole(i, nx + nu) = constant;
    }
    const Matrix rate = (1 / pairs.step) * logarithm(whole);
    model.A = rate.block(0, 0, nx, nx);
    model.B = rate.block(0, nx, nx, nu);
    model.offset = rate.block(0, nx + nu, nx, 1).column_of(0);
    model.mean = m.mean;
    model.sigma = sigma;
    model.method = layout.states.size() > layout.measured ? "edmdc" : "dmdc";
    if (!model.A.finite()) {
        throw core::InputError("singular", "the discrete model has no continuous-time form", {}, "take a shorter step or fewer observables");
    }
    return model;
}

namespace {

struct Truth {
    std::vector<double> gap, velocity, input;
};

std::vector<Truth> true_runs(const SeparatedPlant& plant, const PredictionTest& test) {
    std::vector<Truth> runs;
    const auto n = static_cast<std::size_t>(std::round(test.horizon / test.step));
    for (std::size_t r = 0; r < test.runs; ++r) {
        core::Random random(test.seed, r);
        double h = random.uniform(test.gap_lower, test.gap_upper), w = random.uniform(test.velocity_lower, test.velocity_upper), u = 0;
        Truth t;
        for (std::size_t k = 0; k <= n; ++k) {
            if (k % 5 == 0) {
                u = 0.95 * u + std::sqrt(1 - 0.95 * 0.95) * test.input_sigma * random.normal();
            }
            t.gap.push_back(h);
            t.velocity.push_back(w);
            t.input.push_back(u);
            plant.advance(h, w, u, test.step);
        }
        runs.push_back(std::move(t));
    }
    return runs;
}

struct Sums {
    double gap = 0, velocity = 0, force = 0, acceleration = 0, n = 0;
    bool diverged = false;
    [[nodiscard]] PredictionError error(const std::string& name, bool forces) const {
        return {name, std::sqrt(gap / n), std::sqrt(velocity / n), forces ? std::sqrt(force / n) : NAN, std::sqrt(acceleration / n), diverged};
    }
};

}  // namespace

std::vector<PredictionError> compare_predictions(const SeparatedPlant& plant, const std::vector<std::pair<std::string, AugmentedModel>>& models,
                                                 const PredictionTest& test, core::Progress& progress) {
    const std::vector<Truth> runs = true_runs(plant, test);
    const double range = 10 * (test.gap_upper - test.gap_lower), limit_h = test.gap_upper + range, limit_w = 10 * test.velocity_upper + 1;
    std::vector<PredictionError> errors;
    const auto judge = [&](const std::string& name, const AugmentedModel& model, bool forces) {
        progress.check();
        const std::size_t iw = model.state("heave_velocity"), ih = model.state("gap");
        Matrix held(model.A.rows(), 2);
        held.set_block(0, 0, model.B);
        held.set_block(0, 1, Matrix::column(model.offset));
        const Discrete d = discretise(model.A, held, test.step);
        const auto at = [&](const char* s) { return std::find(model.layout.states.begin(), model.layout.states.end(), s); };
        const bool total = at("total_force") != model.layout.states.end();
        const bool both = at("ground_force") != model.layout.states.end() && at("drag_force") != model.layout.states.end();
        const std::size_t it = static_cast<std::size_t>(at("total_force") - model.layout.states.begin());
        const std::size_t ig = static_cast<std::size_t>(at("ground_force") - model.layout.states.begin());
        const std::size_t id = static_cast<std::size_t>(at("drag_force") - model.layout.states.begin());
        std::vector<double> row(model.layout.channels());
        Sums sums;
        for (const Truth& run : runs) {
            sample_at(plant, model.layout, run.input[0], run.velocity[0], run.gap[0], row.data());
            Vector x(row.begin() + 1, row.begin() + 1 + static_cast<std::ptrdiff_t>(model.layout.states.size()));
            for (std::size_t k = 0; k < run.gap.size(); ++k) {
                double slope = 0;
                const double force = plant.ground_force(run.gap[k], slope) - plant.drag_force(run.velocity[k], slope);
                sample_at(plant, model.layout, run.input[k], run.velocity[k], run.gap[k], row.data());
                const Vector truth(row.begin() + 1, row.begin() + 1 + static_cast<std::ptrdiff_t>(model.layout.states.size()));
                const double rate = model.derivative(truth, {run.input[k]})[iw] - row[1 + model.layout.states.size() + iw];
                const double h = std::clamp(x[ih], -limit_h, limit_h), w = std::clamp(x[iw], -limit_w, limit_w);
                sums.diverged = sums.diverged || std::abs(x[ih]) > limit_h || !std::isfinite(x[ih]);
                sums.gap += std::isfinite(h) ? (h - run.gap[k]) * (h - run.gap[k]) : limit_h * limit_h;
                sums.velocity += std::isfinite(w) ? (w - run.velocity[k]) * (w - run.velocity[k]) : limit_w * limit_w;
                const double own = total ? x[it] : both ? x[ig] - x[id] : 0;
                sums.force += (own - force) * (own - force);
                sums.acceleration += rate * rate;
                sums.n += 1;
                Vector next = d.phi * x;
                for (std::size_t i = 0; i < next.size(); ++i) {
                    next[i] += d.gamma(i, 0) * run.input[k] + d.gamma(i, 1);
                }
                x = next;
            }
        }
        errors.push_back(sums.error(name, forces && (total || both)));
    };
    const double middle = 0.5 * (test.gap_lower + test.gap_upper);
    const auto plane = [](const PlaneModel& p) {
        return AugmentedModel::from_matrices({{"input_force"}, {"heave_velocity", "gap"}, 2}, p.A, Matrix::column(p.B), p.offset);
    };
    judge("tangent at mid-range", plane(tangent_model(plant, middle, 0)), false);
    const double rms = (test.velocity_upper - test.velocity_lower) / std::sqrt(12.0);
    judge("equivalent linear", plane(equivalent_model(plant, middle, rms, MotionShape::gaussian)), false);
    for (const auto& [name, model] : models) {
        judge(name, model, true);
    }
    return errors;
}

}  // namespace underbody::estimator
