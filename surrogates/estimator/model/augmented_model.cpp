#include "surrogates/estimator/model/augmented_model.h"

#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/model/matrix_algebra.h"

namespace underbody::estimator {

std::vector<std::string> Layout::names() const {
    std::vector<std::string> all = inputs;
    all.insert(all.end(), states.begin(), states.end());
    for (const auto& s : states) {
        all.push_back("d_" + s);
    }
    return all;
}

Layout Layout::heave() { return {{"input_force"}, {"heave_velocity", "gap", "ground_force", "drag_force"}, 2}; }

std::size_t AugmentedModel::state(const std::string& name) const {
    const auto at = std::find(layout.states.begin(), layout.states.end(), name);
    if (at == layout.states.end()) {
        throw core::InputError("name", "the model has no state '" + name + "'", {},
                               core::did_you_mean(name, layout.states));
    }
    return static_cast<std::size_t>(at - layout.states.begin());
}

Vector AugmentedModel::derivative(const Vector& x, const Vector& u) const {
    Vector d = A * x;
    const Vector b = B * u;
    for (std::size_t i = 0; i < d.size(); ++i) {
        d[i] += b[i] + offset[i];
    }
    return d;
}

Matrix AugmentedModel::a_x() const { return A.block(0, 0, layout.measured, layout.measured); }
Matrix AugmentedModel::a_zeta() const {
    return A.block(0, layout.measured, layout.measured, A.columns() - layout.measured);
}
Matrix AugmentedModel::j_x() const { return A.block(layout.measured, 0, A.rows() - layout.measured, layout.measured); }
Matrix AugmentedModel::j_zeta() const {
    return A.block(layout.measured, layout.measured, A.rows() - layout.measured, A.columns() - layout.measured);
}
Matrix AugmentedModel::b_u() const { return B.block(0, 0, layout.measured, B.columns()); }
Matrix AugmentedModel::j_u() const { return B.block(layout.measured, 0, B.rows() - layout.measured, B.columns()); }

AugmentedModel AugmentedModel::from_matrices(const Layout& layout, const Matrix& a, const Matrix& b,
                                             const Vector& offset) {
    AugmentedModel model;
    model.layout = layout;
    model.A = a;
    model.B = b;
    model.offset = offset.empty() ? Vector(layout.states.size(), 0.0) : offset;
    model.method = "given";
    return model;
}

namespace {

// Moments about the point of the offset mode, normalised; blocks U, V, W of kept channels.
struct Normalised {
    Vector centre, sigma;              // all channels
    std::vector<std::size_t> kept;     // channels that vary
    std::vector<std::size_t> u, x, d;  // positions within `kept`
    Matrix c;                          // normalised second moments of kept channels
    Vector lambda;                     // descending
    Matrix t;                          // columns: eigenvectors
};

Vector centre_of(const Moments& m, const Layout& layout, const LearnOptions& options) {
    switch (options.offset) {
        case OffsetMode::mean:
            return m.mean;
        case OffsetMode::none:
            return Vector(m.mean.size(), 0.0);
        case OffsetMode::equilibrium:
            break;
    }
    if (options.point.size() != layout.inputs.size() + layout.states.size()) {
        throw core::InputError("shape", "the equilibrium point needs one value per input and state");
    }
    Vector centre = options.point;
    centre.resize(layout.channels(), 0.0);
    return centre;
}

void check_moments(const Moments& m, const Layout& layout) {
    if (m.mean.size() != layout.channels()) {
        throw core::InputError("shape", "the samples have " + std::to_string(m.mean.size()) +
                                            " channels, the model needs " + std::to_string(layout.channels()) +
                                            " (inputs, states, derivatives)");
    }
    if (m.count < layout.channels()) {
        throw core::InputError("few",
                               std::to_string(m.count) + " samples cannot fix a covariance of " +
                                   std::to_string(layout.channels()) + " channels",
                               {}, "take at least as many samples as channels, better a thousand times as many");
    }
    if (!m.covariance.finite()) {
        throw core::InputError("range", "the covariance holds a value that is not finite");
    }
}

Normalised normalise(const Moments& m, const Layout& layout, const LearnOptions& options) {
    check_moments(m, layout);
    const std::size_t n = layout.channels();
    Normalised out;
    out.centre = centre_of(m, layout, options);
    out.sigma.assign(n, 0.0);
    Matrix second = m.covariance;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            second(i, j) += (m.mean[i] - out.centre[i]) * (m.mean[j] - out.centre[j]);
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        const double deviation = std::sqrt(std::max(m.covariance(i, i), 0.0));
        out.sigma[i] = std::sqrt(std::max(second(i, i), 0.0));
        if (deviation > options.constant_tolerance * std::max(std::abs(m.mean[i]), 1e-150) && out.sigma[i] > 0) {
            const std::size_t position = out.kept.size();
            (i < layout.inputs.size()                          ? out.u
             : i < layout.inputs.size() + layout.states.size() ? out.x
                                                               : out.d)
                .push_back(position);
            out.kept.push_back(i);
        }
    }
    if (out.x.empty() || out.d.empty()) {
        throw core::InputError("constant", "no state varies in the samples: there is nothing to learn");
    }
    const std::size_t k = out.kept.size();
    out.c = Matrix(k, k);
    for (std::size_t i = 0; i < k; ++i) {
        for (std::size_t j = 0; j < k; ++j) {
            const std::size_t a = out.kept[i], b = out.kept[j];
            out.c(i, j) = 0.5 * (second(a, b) + second(b, a)) / (out.sigma[a] * out.sigma[b]);
        }
    }
    auto spectrum = dynamics::symmetric_eigen(out.c);
    out.lambda = std::move(spectrum.values);
    out.t = std::move(spectrum.vectors);
    for (std::size_t j = 0; j < k; ++j) {  // a sign that does not depend on the library: the largest entry is positive
        const Vector column = out.t.column_of(j);
        const auto at = std::max_element(column.begin(), column.end(),
                                         [](double x, double y) { return std::abs(x) < std::abs(y); });
        for (std::size_t i = 0; i < k && *at < 0; ++i) {
            out.t(i, j) = -out.t(i, j);
        }
    }
    return out;
}

Matrix rows_of(const Matrix& m, const std::vector<std::size_t>& rows) {
    Matrix out(rows.size(), m.columns());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        out.set_row(i, m.row(rows[i]));
    }
    return out;
}

// Regression of rows `d` on columns `e` of the normalised moments; collinear regressors get the least-norm split.
Matrix regress(const Matrix& c, const std::vector<std::size_t>& d, const std::vector<std::size_t>& e) {
    Matrix cross(d.size(), e.size()), own(e.size(), e.size());
    for (std::size_t j = 0; j < e.size(); ++j) {
        for (std::size_t i = 0; i < d.size(); ++i) {
            cross(i, j) = c(d[i], e[j]);
        }
        for (std::size_t i = 0; i < e.size(); ++i) {
            own(i, j) = c(e[i], e[j]);
        }
    }
    return cross * pseudo_inverse(own, 1e-11);
}

// Normalised law [B A] of the kept derivatives over (inputs, states).
Matrix normalised_law(const Normalised& data, std::size_t order, Fit fit) {
    const Matrix t = data.t.block(0, 0, data.t.rows(), order);
    std::vector<std::size_t> e = data.u;
    e.insert(e.end(), data.x.begin(), data.x.end());
    const Matrix s = rows_of(t, e), w = rows_of(t, data.d);
    constexpr double cut = 1e-9;  // of the eigenvalues of I - W W', which lie in [0, 1]
    switch (fit) {
        case Fit::method1:
            return pseudo_inverse(Matrix::identity(w.rows()) - w * w.transposed(), cut) * w * s.transposed();
        case Fit::method2:
            return w * pseudo_inverse(s, std::sqrt(cut));
        case Fit::weighted_latent: {
            Vector weight(data.lambda.begin(), data.lambda.begin() + static_cast<std::ptrdiff_t>(order));
            for (double& l : weight) {
                l = std::max(l, 0.0);
            }
            const Matrix weighted = Matrix::diagonal(weight) * s.transposed();
            return w * weighted * pseudo_inverse(s * weighted, 1e-11);
        }
        case Fit::least_squares:
            break;
    }
    return regress(data.c, data.d, e);
}

const char* name_of(Fit fit) {
    switch (fit) {
        case Fit::least_squares:
            return "least_squares";
        case Fit::weighted_latent:
            return "weighted_latent";
        case Fit::method1:
            return "method1";
        case Fit::method2:
            break;
    }
    return "method2";
}

void set_offsets(AugmentedModel& model, OffsetMode mode) {
    const std::size_t nu = model.layout.inputs.size(), nx = model.layout.states.size();
    model.offset.assign(nx, 0.0);
    if (mode == OffsetMode::none) {
        return;
    }
    const auto at = [&](std::size_t i) { return model.mean.begin() + static_cast<std::ptrdiff_t>(i); };
    const Vector u(at(0), at(nu)), x(at(nu), at(nu + nx));
    const Vector d = model.derivative(x, u);
    for (std::size_t i = 0; i < nx; ++i) {
        model.offset[i] = model.mean[nu + nx + i] - d[i];
    }
}

// Puts a normalised law into physical units: A = Sig_dx A_n Sig_x^-1, B = Sig_dx B_n Sig_u^-1.
void denormalise(AugmentedModel& model, const Normalised& data, const Matrix& law) {
    const std::size_t nu = model.layout.inputs.size(), nx = model.layout.states.size();
    model.A = Matrix(nx, nx);
    model.B = Matrix(nx, nu);
    for (std::size_t i = 0; i < data.d.size(); ++i) {
        const std::size_t row = data.kept[data.d[i]];
        std::size_t column = 0;
        for (const std::size_t j : data.u) {
            model.B(row - nu - nx, data.kept[j]) = law(i, column++) * data.sigma[row] / data.sigma[data.kept[j]];
        }
        for (const std::size_t j : data.x) {
            model.A(row - nu - nx, data.kept[j] - nu) = law(i, column++) * data.sigma[row] / data.sigma[data.kept[j]];
        }
    }
}

std::size_t rank_of(const Normalised& data, double tolerance) {
    std::size_t rank = 0;
    for (const double l : data.lambda) {
        rank += l > tolerance * static_cast<double>(data.lambda.size()) ? 1U : 0U;
    }
    return rank;
}

AugmentedModel frame(const Moments& m, const Layout& layout, const Normalised& data, const LearnOptions& options) {
    AugmentedModel model;
    model.layout = layout;
    model.samples = m.count;
    model.eigenvalues = data.lambda;
    model.rank = rank_of(data, options.rank_tolerance);
    model.kept = data.kept;
    model.mean = data.centre;
    model.sigma = data.sigma;
    const auto names = layout.names();
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (std::find(data.kept.begin(), data.kept.end(), i) == data.kept.end()) {
            model.remarks.push_back({core::Problem::Severity::warning,
                                     "channel '" + names[i] + "' is constant in the samples and was left out",
                                     {}});
        }
    }
    for (auto& p : check_consistency(m, layout, options.virtual_mass)) {
        model.remarks.push_back(std::move(p));
    }
    return model;
}

void complete(AugmentedModel& model, const Normalised& data, std::size_t order, const LearnOptions& options) {
    model.order = order;
    model.method = name_of(options.fit);
    model.basis = data.t.block(0, 0, data.t.rows(), order);
    denormalise(model, data, normalised_law(data, order, options.fit));
    set_offsets(model, options.offset);
}

}  // namespace

AugmentedModel learn(const Moments& moments, const Layout& layout, const LearnOptions& options) {
    const Normalised data = normalise(moments, layout, options);
    AugmentedModel model = frame(moments, layout, data, options);
    const std::size_t order = options.order == 0 ? model.rank : options.order;
    if (order > model.rank) {
        throw core::InputError("order",
                               "order " + std::to_string(order) + " is above the rank " + std::to_string(model.rank) +
                                   " of the data: the extra directions are noise of rounding",
                               {}, "take an order of at most " + std::to_string(model.rank));
    }
    complete(model, data, order, options);
    const bool latent = options.fit == Fit::method1 || options.fit == Fit::method2;
    if (latent && order == model.rank && model.rank < model.kept.size()) {
        model.remarks.push_back({core::Problem::Severity::warning,
                                 "order " + std::to_string(order) +
                                     " is the rank of the data: exact relations come out exact and all other rows zero "
                                     "(least norm); take least_squares for the forces",
                                 {}});
    }
    return model;
}

std::vector<AugmentedModel> scan_orders(const Moments& moments, const Layout& layout, const LearnOptions& options) {
    const Normalised data = normalise(moments, layout, options);
    const AugmentedModel empty = frame(moments, layout, data, options);
    std::vector<AugmentedModel> models;
    for (std::size_t order = 1; order <= data.kept.size(); ++order) {
        models.push_back(empty);
        complete(models.back(), data, order, options);
        if (order > empty.rank) {
            models.back().method = "refused";
        }
    }
    return models;
}

std::vector<KnownRow> heave_rows(const Layout& layout, double virtual_mass, double bias) {
    const std::size_t n = layout.states.size();
    const auto at = [&](const std::string& name) {
        return static_cast<std::size_t>(std::find(layout.states.begin(), layout.states.end(), name) -
                                        layout.states.begin());
    };
    KnownRow velocity{"heave_velocity", Vector(n, 0.0), Vector(layout.inputs.size(), 0.0), bias / virtual_mass};
    KnownRow gap{"gap", Vector(n, 0.0), Vector(layout.inputs.size(), 0.0), 0};
    const std::size_t total = at("total_force"), ground = at("ground_force"), drag = at("drag_force");
    if (total < n) {
        velocity.a[total] = 1 / virtual_mass;
    } else if (ground < n && drag < n) {
        velocity.a[ground] = 1 / virtual_mass;
        velocity.a[drag] = -1 / virtual_mass;
    } else {
        throw core::InputError("name",
                               "the known rows need total_force, or ground_force and drag_force, among the states");
    }
    for (std::size_t j = 0; j < layout.inputs.size(); ++j) {
        velocity.b[j] = layout.inputs[j] == "input_force" ? 1 / virtual_mass : 0;
    }
    if (at("heave_velocity") >= n || at("gap") >= n) {
        throw core::InputError("name", "the known rows need heave_velocity and gap among the states");
    }
    gap.a[at("heave_velocity")] = 1;
    return {velocity, gap};
}

void fix_rows(AugmentedModel& model, const std::vector<KnownRow>& rows) {
    for (const KnownRow& row : rows) {
        const std::size_t i = model.state(row.state);
        model.A.set_row(i, row.a);
        model.B.set_row(i, row.b);
        model.offset[i] = row.offset;
    }
}

namespace {

bool may_depend(const std::string& state, const std::string& on) {
    if (state == "ground_force") {
        return on == "heave_velocity";
    }
    if (state == "drag_force") {
        return on == "ground_force" || on == "drag_force" || on == "input_force" || on == "total_force";
    }
    return true;
}

}  // namespace

AugmentedModel corrected(const AugmentedModel& model, Correction correction, const std::vector<KnownRow>& rows) {
    AugmentedModel out = model;
    if (correction == Correction::p1) {
        return out;
    }
    const auto& states = out.layout.states;
    const auto known = [&](const std::string& name) {
        return std::any_of(rows.begin(), rows.end(), [&](const KnownRow& r) { return r.state == name; });
    };
    if (correction >= Correction::p3) {
        for (std::size_t i = 0; i < states.size(); ++i) {
            out.A(i, out.state("gap")) = 0;
        }
    }
    if (correction == Correction::p4) {
        for (std::size_t i = 0; i < states.size(); ++i) {
            for (std::size_t j = 0; j < states.size() && !known(states[i]); ++j) {
                out.A(i, j) = may_depend(states[i], states[j]) ? out.A(i, j) : 0;
            }
            for (std::size_t j = 0; j < out.layout.inputs.size() && !known(states[i]); ++j) {
                out.B(i, j) = may_depend(states[i], out.layout.inputs[j]) ? out.B(i, j) : 0;
            }
        }
    }
    if (!out.mean.empty() && std::any_of(model.offset.begin(), model.offset.end(), [](double v) { return v != 0; })) {
        set_offsets(out, OffsetMode::mean);
    }
    fix_rows(out, rows);
    const char* names[] = {"p1", "p2", "p3", "p4"};
    out.method += std::string(", ") + names[static_cast<int>(correction)];
    return out;
}

DerivativeError derivative_error(const AugmentedModel& model, const Moments& test) {
    check_moments(test, model.layout);
    const std::size_t nu = model.layout.inputs.size(), nx = model.layout.states.size();
    DerivativeError error;
    for (std::size_t i = 0; i < nx; ++i) {
        Vector weight(test.mean.size(), 0.0);  // residual = weight . sample - offset
        for (std::size_t j = 0; j < nu; ++j) {
            weight[j] = -model.B(i, j);
        }
        for (std::size_t j = 0; j < nx; ++j) {
            weight[nu + j] = -model.A(i, j);
        }
        weight[nu + nx + i] += 1;
        double mean = -model.offset[i], square = 0;
        const Vector c = test.covariance * weight;
        for (std::size_t j = 0; j < weight.size(); ++j) {
            mean += weight[j] * test.mean[j];
            square += weight[j] * c[j];
        }
        error.rms.push_back(std::sqrt(std::max(square, 0.0) + mean * mean));
        const double deviation = std::sqrt(std::max(test.covariance(nu + nx + i, nu + nx + i), 0.0));
        error.relative.push_back(deviation > 0 ? error.rms.back() / deviation : 0);
    }
    return error;
}

}  // namespace underbody::estimator
