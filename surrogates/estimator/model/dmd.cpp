#include "surrogates/estimator/model/dmd.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "surrogates/dynamics/model/matrix_algebra.h"

namespace underbody::estimator {

SnapshotPairs snapshot_pairs(const SeparatedPlant& plant, const TrainingOptions& options, double step,
                             core::Progress& progress) {
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

namespace {

/// One step of (x, u, 1), input and one held, from the law between scaled snapshots.
Matrix step_matrix(const Matrix& law, const Moments& m, const Vector& sigma, std::size_t nx, std::size_t nu) {
    const std::size_t ne = nu + nx;
    Matrix whole = Matrix::identity(nx + nu + 1);
    for (std::size_t i = 0; i < nx; ++i) {
        double constant = m.mean[ne + i];
        for (std::size_t j = 0; j < ne; ++j) {
            const double value = sigma[j] > 0 ? law(i, j) / sigma[j] : 0;
            whole(i, j < nu ? nx + j : j - nu) = value;
            constant -= value * m.mean[j];
        }
        whole(i, nx + nu) = constant;
    }
    return whole;
}

/// Correlations of the states and inputs before a step with each other, and with the states behind it, whose scale
/// stays.
struct Correlations {
    Matrix own, cross;
};

Correlations correlations(const Moments& m, const Vector& sigma, std::size_t nx, std::size_t ne) {
    Correlations c{Matrix(ne, ne), Matrix(nx, ne)};
    for (std::size_t j = 0; j < ne; ++j) {
        for (std::size_t i = 0; i < ne && sigma[j] > 0; ++i) {
            c.own(i, j) = sigma[i] > 0 ? m.covariance(i, j) / (sigma[i] * sigma[j]) : 0;
        }
        for (std::size_t i = 0; i < nx && sigma[j] > 0; ++i) {
            c.cross(i, j) = m.covariance(ne + i, j) / sigma[j];
        }
    }
    return c;
}

/// The inverse of the correlations along their directions of most variance, `order` of them (0: all but noise). Order,
/// rank and eigenvalues go into the model.
Matrix leading_inverse(const Matrix& own, std::size_t order, AugmentedModel& model) {
    const std::size_t ne = own.rows();
    const auto spectrum = dynamics::symmetric_eigen(own);
    Matrix inverted(ne, ne);
    for (std::size_t k = 0; k < ne; ++k) {
        model.eigenvalues.push_back(spectrum.values[k]);
        const bool noise = spectrum.values[k] <= 1e-12 * static_cast<double>(ne);
        model.rank += noise ? 0U : 1U;
        if (!noise && (order == 0 || model.order < order)) {
            ++model.order;
            const Matrix direction = Matrix::column(spectrum.vectors.column_of(k));
            inverted = inverted + (1 / spectrum.values[k]) * (direction * direction.transposed());
        }
    }
    return inverted;
}

}  // namespace

AugmentedModel learn_dmd(const SnapshotPairs& pairs, std::size_t order) {
    const Layout& layout = pairs.layout;
    const std::size_t nu = layout.inputs.size(), nx = layout.states.size(), ne = nu + nx;
    if (pairs.count < layout.channels()) {
        throw core::InputError("few", std::to_string(pairs.count) + " pairs of snapshots cannot fix a model of " +
                                          std::to_string(layout.channels()) + " channels");
    }
    const Moments m =
        moments(SampleView::samples_in_rows(pairs.values.data(), pairs.count, layout.channels()), layout.names());
    Vector sigma(layout.channels());
    for (std::size_t i = 0; i < sigma.size(); ++i) {
        sigma[i] = std::sqrt(std::max(m.covariance(i, i), 0.0));
    }
    const auto [own, cross] = correlations(m, sigma, nx, ne);
    AugmentedModel model;
    model.layout = layout;
    model.samples = pairs.count;
    const Matrix law = cross * leading_inverse(own, order, model);
    // Its logarithm holds A, B and the offset.
    const Matrix whole = step_matrix(law, m, sigma, nx, nu);
    const Matrix rate = (1 / pairs.step) * logarithm(whole);
    model.A = rate.block(0, 0, nx, nx);
    model.B = rate.block(0, nx, nx, nu);
    model.offset = rate.block(0, nx + nu, nx, 1).column_of(0);
    model.mean = m.mean;
    model.sigma = sigma;
    model.method = layout.states.size() > layout.measured ? "edmdc" : "dmdc";
    if (!model.A.finite()) {
        throw core::InputError("singular", "the discrete model has no continuous-time form", {},
                               "take a shorter step or fewer observables");
    }
    return model;
}

}  // namespace underbody::estimator
