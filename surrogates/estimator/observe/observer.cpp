#include "surrogates/estimator/observe/observer.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace underbody::estimator {

namespace {

std::size_t index_of(const std::vector<std::string>& names, const std::string& name) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) {
        throw core::InputError("name", "the model has no '" + name + "'", {}, core::did_you_mean(name, names));
    }
    return static_cast<std::size_t>(at - names.begin());
}

Matrix sensor_matrix(const AugmentedModel& model, const std::vector<std::string>& sensors) {
    if (sensors.empty()) {
        throw core::InputError("missing", "an observer needs at least one sensor");
    }
    Matrix c(sensors.size(), model.layout.states.size());
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        c(i, model.state(sensors[i])) = 1;
    }
    return c;
}

std::string pole_text(const Poles& poles) {
    std::string text;
    for (const auto& p : poles) {
        char number[80];
        std::snprintf(number, sizeof number, p.imag() == 0 ? "%.4g" : "%.4g%+.4gi", p.real(), p.imag());
        text += (text.empty() ? "" : ", ") + std::string(number);
    }
    return text;
}

void refuse_unstable(const Poles& poles, const Poles& discrete, double step) {
    if (poles.front().real() >= 0) {
        throw core::InputError("unstable", "the observer is unstable: poles of its error " + pole_text(poles) + " 1/s",
                               {}, "choose a gain that puts every pole to the left of zero");
    }
    for (const auto& p : discrete) {
        if (std::abs(p) >= 1) {
            throw core::InputError("unstable",
                                   "the observer is unstable at a step of " + std::to_string(step) +
                                       " s: discrete poles " + pole_text(discrete),
                                   {}, "take a shorter step, or exact discretisation instead of Euler");
        }
    }
}

// Adds total_force = ground_force - drag_force to the estimates when both are there.
void add_total(LinearFilter& f) {
    const auto has = [&](const char* name) {
        return std::find(f.estimates.begin(), f.estimates.end(), name) != f.estimates.end();
    };
    if (!has("ground_force") || !has("drag_force") || has("total_force")) {
        return;
    }
    const std::size_t g = index_of(f.estimates, "ground_force"), d = index_of(f.estimates, "drag_force");
    const auto grow = [&](Matrix& m) {
        Matrix next(m.rows() + 1, m.columns());
        next.set_block(0, 0, m);
        for (std::size_t j = 0; j < m.columns(); ++j) {
            next(m.rows(), j) = m(g, j) - m(d, j);
        }
        m = next;
    };
    grow(f.output);
    grow(f.feed);
    f.output_constant.push_back(f.output_constant[g] - f.output_constant[d]);
    f.estimates.emplace_back("total_force");
}

// ds = F s + G_y y + G_u u + g, y sampled, u held.
void discretise_filter(LinearFilter& f, const Matrix& dynamics, const Matrix& from_y, const Matrix& from_u,
                       const Vector& drift, Hold hold) {
    const std::size_t n = dynamics.rows();
    Matrix held(n, from_u.columns() + 1);
    held.set_block(0, 0, from_u);
    held.set_block(0, from_u.columns(), Matrix::column(drift));
    f.present = Matrix(n, from_y.columns());
    if (hold == Hold::euler) {
        f.phi = Matrix::identity(n) + f.step * dynamics;
        f.previous = f.step * from_y;
        held = f.step * held;
    } else {
        const Discrete d = discretise(dynamics, held, f.step);
        f.phi = d.phi;
        held = d.gamma;
        if (hold == Hold::zero_order) {
            f.previous = discretise(dynamics, from_y, f.step).gamma;
        } else {
            const auto linear = discretise_first_order_hold(dynamics, from_y, f.step);
            f.previous = linear.gamma0;
            f.present = linear.gamma1;
        }
    }
    f.input = held.block(0, 0, n, from_u.columns());
    f.constant = held.column_of(from_u.columns());
}

void check_step(double step) {
    if (!(step > 0) || !std::isfinite(step)) {
        throw core::InputError("range", "the sample time of an observer must be positive");
    }
}

std::vector<std::string> labels_for(const LinearFilter& filter, const AugmentedModel& model, const Separability& s) {
    std::vector<std::string> labels;
    for (const auto& name : filter.estimates) {
        const auto at = std::find(model.layout.states.begin(), model.layout.states.end(), name);
        const auto i = static_cast<std::size_t>(at - model.layout.states.begin());
        labels.push_back(at == model.layout.states.end() || i < model.layout.measured
                             ? "observed"
                             : s.labels[i - model.layout.measured]);
    }
    return labels;
}

/// What follows from the filter: the total force, its poles, what it can tell apart. Throws where it is unstable.
void finish(ObserverDesign& design, const AugmentedModel& model, const Matrix& dynamics) {
    LinearFilter& f = design.filter;
    add_total(f);
    design.poles = eigenvalues(dynamics);
    design.discrete_poles = eigenvalues(f.phi);
    refuse_unstable(design.poles, design.discrete_poles, f.step);
    design.separability = separability(model);
    design.labels = labels_for(f, model, design.separability);
}

}  // namespace

Matrix reduced_gain(const AugmentedModel& model, const Poles& poles) {
    const std::size_t w = model.state("heave_velocity");
    const Matrix a_zeta = model.a_zeta();
    const std::vector<std::string> names(
        model.layout.states.begin() + static_cast<std::ptrdiff_t>(model.layout.measured), model.layout.states.end());
    const Matrix l = place_single_output(model.j_zeta(), a_zeta.block(w, 0, 1, a_zeta.columns()), poles, names);
    Matrix gain(l.rows(), model.layout.measured);
    gain.set_block(0, w, l);
    return gain;
}

ObserverDesign reduced_observer(const AugmentedModel& model, const Matrix& gain, double step, Hold hold,
                                const Vector& zeta_start) {
    check_step(step);
    const std::size_t nx = model.layout.measured, nz = model.layout.states.size() - nx;
    const Matrix dynamics = model.j_zeta() - gain * model.a_zeta();
    // d xi = F (xi + L x) + (J_x - L A_x) x + (J_u - L B) u + (c_zeta - L c_x)
    const Matrix from_x = dynamics * gain + model.j_x() - gain * model.a_x();
    const Matrix from_u = model.j_u() - gain * model.b_u();
    const auto split = model.offset.begin() + static_cast<std::ptrdiff_t>(nx);
    Vector drift(split, model.offset.end());
    const Vector taken = gain * Vector(model.offset.begin(), split);
    for (std::size_t i = 0; i < nz; ++i) {
        drift[i] -= taken[i];
    }
    ObserverDesign design;
    design.gain = gain;
    LinearFilter& f = design.filter;
    f.name = "reduced order";
    f.step = step;
    f.measured.assign(model.layout.states.begin(), model.layout.states.begin() + static_cast<std::ptrdiff_t>(nx));
    f.inputs = model.layout.inputs;
    f.estimates.assign(model.layout.states.begin() + static_cast<std::ptrdiff_t>(nx), model.layout.states.end());
    discretise_filter(f, dynamics, from_x, from_u, drift, hold);
    f.output = Matrix::identity(nz);
    f.feed = gain;
    f.output_constant = Vector(nz, 0.0);
    f.start = zeta_start.empty() ? Vector(nz, 0.0) : zeta_start;
    f.start_feed = -1.0 * gain;
    finish(design, model, dynamics);
    return design;
}

Matrix full_gain(const AugmentedModel& model, const std::vector<std::string>& sensors, const Vector& poles) {
    return place(model.A, sensor_matrix(model, sensors), poles, model.layout.states);
}

ObserverDesign full_observer(const AugmentedModel& model, const std::vector<std::string>& sensors, const Matrix& gain,
                             double step, Hold hold, const Vector& start) {
    check_step(step);
    const std::size_t n = model.layout.states.size();
    const Matrix c = sensor_matrix(model, sensors);
    const Matrix dynamics = model.A - gain * c;
    ObserverDesign design;
    design.gain = gain;
    LinearFilter& f = design.filter;
    f.name = "full order";
    f.step = step;
    f.measured = sensors;
    f.inputs = model.layout.inputs;
    f.estimates = model.layout.states;
    discretise_filter(f, dynamics, gain, model.B, model.offset, hold);
    f.output = Matrix::identity(n);
    f.feed = Matrix(n, sensors.size());
    f.output_constant = Vector(n, 0.0);
    f.start = start.empty() ? Vector(n, 0.0) : start;
    f.start_feed = Matrix(n, sensors.size());
    if (start.empty()) {  // begin at what is measured
        f.start_feed = c.transposed();
    }
    finish(design, model, dynamics);
    return design;
}

ObserverDesign latent_observer(const AugmentedModel& model, const Matrix& rotation, const Vector& scale,
                               const Vector& centre, const std::vector<std::string>& sensors, const Matrix& gain,
                               double step, Hold hold) {
    const std::size_t n = model.layout.states.size();
    ObserverDesign design = full_observer(model, sensors, gain, step, hold);
    // x = centre + Sigma T z; A_z = T' Sigma^-1 A Sigma T and so on.
    Vector inverse_scale(n);
    for (std::size_t i = 0; i < n; ++i) {
        inverse_scale[i] = 1 / scale[i];
    }
    const Matrix to_z = rotation.transposed() * Matrix::diagonal(inverse_scale);
    const Matrix from_z = Matrix::diagonal(scale) * rotation;
    const Matrix c = sensor_matrix(model, sensors);
    const Matrix a_z = to_z * model.A * from_z, l_z = to_z * gain, v = c * from_z;
    Vector drift = model.offset;  // d z = to_z (A centre + offset) + ...; the innovation is y - V z - C centre
    const Vector moved = model.A * centre;
    const Vector seen = gain * (c * centre);
    for (std::size_t i = 0; i < n; ++i) {
        drift[i] += moved[i] - seen[i];
    }
    LinearFilter& f = design.filter;
    f.name = "latent";
    discretise_filter(f, a_z - l_z * v, l_z, to_z * model.B, to_z * drift, hold);
    f.output = from_z;
    f.feed = Matrix(n, sensors.size());
    f.output_constant = centre;
    Vector away(n);
    for (std::size_t i = 0; i < n; ++i) {
        away[i] = -centre[i];
    }
    f.start = to_z * away;
    f.start_feed = to_z * c.transposed();
    f.estimates = model.layout.states;
    add_total(f);
    design.gain = l_z;
    design.poles = eigenvalues(a_z - l_z * v);
    design.discrete_poles = eigenvalues(f.phi);
    return design;
}

Matrix usual_rotation() {
    const double c = std::sqrt(.5);
    return {{c, 0, c, 0}, {0, c, 0, c}, {-c, 0, c, 0}, {0, -c, 0, c}};
}

LatentProjection latent_projection(const AugmentedModel& normalised, const Matrix& rotation,
                                   const Matrix& latent_gain) {
    const std::size_t nx = normalised.layout.measured, n = normalised.layout.states.size();
    const Matrix v = rotation.block(0, 0, nx, rotation.columns()),
                 w = rotation.block(nx, 0, n - nx, rotation.columns());
    const Matrix a_z = rotation.transposed() * normalised.A * rotation;
    LatentProjection result;
    result.error_matrix = w * (a_z - latent_gain * v) * w.transposed();
    result.j_zeta = normalised.j_zeta();
    const Matrix x_part = Matrix::identity(nx) - v * v.transposed(), zeta_part = v * w.transposed();
    result.innovation = std::max(x_part.largest(), zeta_part.largest());
    return result;
}

ObserverDesign disturbance_observer(double virtual_mass, double bias, double rate, double step, Hold hold) {
    check_step(step);
    if (!(rate > 0)) {
        throw core::InputError("unstable", "the rate of the disturbance observer must be positive");
    }
    ObserverDesign design;
    LinearFilter& f = design.filter;
    f.name = "total force";
    f.step = step;
    f.measured = {"heave_velocity"};
    f.inputs = {"input_force"};
    f.estimates = {"total_force"};
    const double feed = rate * virtual_mass;
    discretise_filter(f, Matrix{{-rate}}, Matrix{{-rate * feed}}, Matrix{{-rate}}, {-rate * bias}, hold);
    f.output = Matrix{{1}};
    f.feed = Matrix{{feed}};
    f.output_constant = {0};
    f.start = {0};
    f.start_feed = Matrix{{-feed}};
    design.gain = Matrix{{feed}};
    design.poles = eigenvalues(Matrix{{-rate}});
    design.discrete_poles = eigenvalues(f.phi);
    refuse_unstable(design.poles, design.discrete_poles, step);
    design.labels = {"observed"};
    design.separability.b_eff = NAN;
    design.separability.labels = {"observed"};
    design.separability.explanation =
        "the total force F_g - F_d is seen through the acceleration; nothing is assumed on its parts";
    return design;
}

namespace {

void check_noise(const Vector& sensor_sigma) {
    for (const double s : sensor_sigma) {
        if (!(s > 0)) {
            throw core::InputError("range", "the noise of a sensor must be positive");
        }
    }
}

/// x = phi' x + gain y + input u, with what the gain keeps of the model's own step.
LinearFilter kalman_filter(const AugmentedModel& model, const std::vector<std::string>& sensors, const Discrete& d,
                           const Matrix& gain, const Matrix& c, double step) {
    const std::size_t n = model.layout.states.size(), p = sensors.size();
    const Matrix keep = Matrix::identity(n) - gain * c;
    LinearFilter f;
    f.name = "Kalman";
    f.step = step;
    f.measured = sensors;
    f.inputs = model.layout.inputs;
    f.estimates = model.layout.states;
    f.phi = keep * d.phi;
    f.previous = Matrix(n, p);
    f.present = gain;
    f.input = keep * d.gamma.block(0, 0, n, model.layout.inputs.size());
    f.constant = keep * d.gamma.column_of(model.layout.inputs.size());
    f.output = Matrix::identity(n);
    f.feed = Matrix(n, p);
    f.output_constant = Vector(n, 0.0);
    f.start = Vector(n, 0.0);
    f.start_feed = c.transposed();
    return f;
}

}  // namespace

ObserverDesign kalman_observer(const AugmentedModel& model, const std::vector<std::string>& sensors,
                               const Vector& process, const Vector& sensor_sigma, double step) {
    check_step(step);
    const std::size_t n = model.layout.states.size(), p = sensors.size();
    if (process.size() != n || sensor_sigma.size() != p) {
        throw core::InputError("shape", "the filter needs one process density per state and one sigma per sensor");
    }
    check_noise(sensor_sigma);
    const Matrix c = sensor_matrix(model, sensors);
    Matrix held(n, model.layout.inputs.size() + 1);
    held.set_block(0, 0, model.B);
    held.set_block(0, model.layout.inputs.size(), Matrix::column(model.offset));
    const Discrete d = discretise(model.A, held, step);
    const Matrix q = discrete_noise(model.A, Matrix::diagonal(process), step);
    Vector variance(p);
    for (std::size_t i = 0; i < p; ++i) {
        variance[i] = sensor_sigma[i] * sensor_sigma[i];
    }
    const Matrix r = Matrix::diagonal(variance);
    const Matrix before = discrete_riccati(d.phi, c, q, r, model.layout.states);
    const Matrix gain = before * c.transposed() * inverse(c * before * c.transposed() + r);
    const Matrix keep = Matrix::identity(n) - gain * c;
    ObserverDesign design;
    design.gain = gain;
    const Matrix after = keep * before * keep.transposed() + gain * r * gain.transposed();  // Joseph's form
    LinearFilter& f = design.filter;
    f = kalman_filter(model, sensors, d, gain, c, step);
    add_total(f);
    design.covariance = f.output * after * f.output.transposed();
    design.discrete_poles = eigenvalues(f.phi);
    for (const auto& z : design.discrete_poles) {
        design.poles.push_back(std::log(z) / step);
    }
    refuse_unstable({{-1, 0}}, design.discrete_poles, step);
    design.separability = separability(model);
    design.labels = labels_for(f, model, design.separability);
    return design;
}

Vector noise_gain(const LinearFilter& f, const Vector& sensor_sigma) {
    const std::size_t n = f.phi.rows(), p = f.measured.size();
    // State (s, y) so that the noise of the last sample, which enters twice, is counted as one.
    Matrix phi(n + p, n + p), gain(n + p, p);
    phi.set_block(0, 0, f.phi);
    phi.set_block(0, n, f.previous);
    gain.set_block(0, 0, f.present);
    gain.set_block(n, 0, Matrix::identity(p));
    Vector variance(p);
    for (std::size_t i = 0; i < p; ++i) {
        variance[i] = sensor_sigma[i] * sensor_sigma[i];
    }
    const Matrix covariance = discrete_lyapunov(phi, gain * Matrix::diagonal(variance) * gain.transposed());
    Matrix out(f.estimates.size(), n + p);
    out.set_block(0, 0, f.output);
    out.set_block(0, n, f.feed);
    const Matrix result = out * covariance * out.transposed();
    Vector sigma(result.rows());
    for (std::size_t i = 0; i < sigma.size(); ++i) {
        sigma[i] = std::sqrt(std::max(result(i, i), 0.0));
    }
    return sigma;
}

namespace {

std::string explanation_of(const Separability& s, const AugmentedModel& model, bool two) {
    const std::size_t nx = model.layout.measured, nz = model.layout.states.size() - nx;
    const auto& states = model.layout.states;
    if (s.reduced.rank < nz) {
        const std::vector<std::string> names(states.begin() + static_cast<std::ptrdiff_t>(nx), states.end());
        return "only the total force is seen; an error along " +
               direction_text(s.reduced.unobservable.column_of(0), names) + " stays for ever whatever the gain";
    }
    if (two) {
        char text[300];
        if (std::isnan(s.b_eff)) {
            std::snprintf(text, sizeof text, "the split of the total force rests on the model alone");
        } else {
            std::snprintf(text, sizeof text,
                          "the split rests on the drag law that the model holds: at slow drift drag_force is %.4g N "
                          "s/m times the "
                          "velocity, right or wrong; their difference, the total force, is seen",
                          s.b_eff);
        }
        return text;
    }
    return "each auxiliary variable is told apart by the model's own law; only what moves the acceleration is seen";
}

}  // namespace

Separability separability(const AugmentedModel& model) {
    const std::size_t nx = model.layout.measured, nz = model.layout.states.size() - nx;
    Separability s;
    s.b_eff = NAN;
    const Matrix j = model.j_zeta(), a = model.a_zeta();
    s.reduced = observability(j, a);
    Matrix c(nx, nx + nz);
    c.set_block(0, 0, Matrix::identity(nx));
    s.full = observability(model.A, c);
    const auto& states = model.layout.states;
    const bool two = nz == 2 && states[nx] == "ground_force" && states[nx + 1] == "drag_force";
    if (two) {
        const std::size_t w = model.state("heave_velocity");
        s.determinant = a(w, 0) * -a(w, 1) * (j(0, 0) + j(0, 1) - j(1, 0) - j(1, 1));
        const double denominator = -(j(1, 0) + j(1, 1));
        if (std::abs(denominator) > 1e-9 * (1 + j.largest())) {
            s.b_eff = model.j_x()(1, w) / denominator;
        }
    }
    for (std::size_t i = 0; i < nz; ++i) {
        bool hidden = false;
        for (std::size_t k = 0; k < s.reduced.unobservable.columns(); ++k) {
            hidden = hidden || std::abs(s.reduced.unobservable(i, k)) > 1e-6;
        }
        // One force beside the measured acceleration is observed; two forces are told apart only by the law the model
        // holds.
        s.labels.emplace_back(hidden ? "unobservable" : nz == 1 ? "observed" : "model-dependent");
    }
    s.explanation = explanation_of(s, model, two);
    return s;
}

}  // namespace underbody::estimator
