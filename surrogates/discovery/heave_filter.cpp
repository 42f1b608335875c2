#include "surrogates/discovery/heave_filter.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace underbody::discovery {

namespace {

constexpr double two_pi = 6.283185307179586;
constexpr double longest_step = 0.05;    ///< s, of the integrator
constexpr double shortest_step = 0.001;  ///< s

/// The heave equation as plain numbers, with the slopes that the covariance needs.
class Equation {
public:
    Equation(const HeaveRecord& record, const HeaveExplanation& explanation)
        : terms_(explanation.terms), curve_(record.plant->lift_curve()), flexible_(explanation.flexible),
          gain_(explanation.lift_gain * record.lift_factor), held_(record.plant->held()),
          rough_(terms_.rough_near != 0 || terms_.rough_far != 0), history_(terms_.history != 0) {
        for (double& memory : memory_) {
            memory = 0;
        }
    }

    /// To be called before the motion to step k is asked for.
    void to_step(const HeaveRecord& record, std::size_t k) { scale_ = record.lift_scale.empty() ? 1 : record.lift_scale[k]; }

    /// Virtual mass and its slope.
    double inertia(double h, double& slope) const {
        double mass = terms_.mass;
        slope = 0;
        if (!terms_.added_mass.empty()) {
            mass += terms_.added_mass.value(h, slope);
        }
        for (const auto& growth : terms_.growth) {
            const double base = std::max(h, 0.0) + growth.length;
            mass += growth.mass * growth.length / base;
            slope -= growth.mass * growth.length / (base * base);
        }
        return mass;
    }

    double acceleration(double t, double h, double w, double u, double velocity_variance) const {
        double slope_h = 0;
        double slope_w = 0;
        return acceleration(t, h, w, u, velocity_variance, slope_h, slope_w);
    }

    /// `velocity_variance` blurs the step of Coulomb's law as far as the velocity is unknown (statistical linearisation).
    double acceleration(double t, double h, double w, double u, double velocity_variance, double& slope_h, double& slope_w) const {
        double force_h = 0;
        double lift = curve_.empty() ? 0 : curve_.value(h, force_h);
        if (rough_) {
            const double x = h / terms_.rough_length;
            const double base = 1 + x * x;
            const double factor = 1 + (terms_.rough_near - terms_.rough_far * x * x) / base;
            const double factor_slope = -2 * x * (terms_.rough_near + terms_.rough_far) / (base * base) / terms_.rough_length;
            force_h = force_h * factor + lift * factor_slope;
            lift *= factor;
        }
        force_h *= gain_ * scale_;
        double force = terms_.constant + u + gain_ * scale_ * lift - terms_.stiffness * (h - terms_.stiffness_gap);
        force_h -= terms_.stiffness;
        const double relative = w - terms_.current;
        const double size = std::abs(relative);
        double force_w = 0;
        if (terms_.mixed) {
            force -= terms_.mixed_law(relative);
            force_w -= (terms_.mixed_law(relative + 1e-6) - terms_.mixed_law(relative - 1e-6)) / 2e-6;
        } else {
            force -= (terms_.linear + terms_.quadratic * size) * relative;
            force_w -= terms_.linear + 2 * terms_.quadratic * size;
        }
        force -= (terms_.extra_linear + terms_.extra_quadratic * size) * relative;
        force_w -= terms_.extra_linear + 2 * terms_.extra_quadratic * size;
        if (terms_.friction != 0) {
            const double width = terms_.friction_width * terms_.friction_width + 1.5707963 * velocity_variance;
            const double root = std::sqrt(w * w + width);
            force -= terms_.friction * w / root;
            force_w -= terms_.friction * width / (root * root * root);
        }
        if (terms_.film != 0) {
            const double gap = std::max(h, 2e-4);
            const double film = terms_.film / (gap * gap * gap);
            force -= film * w;
            force_w -= film;
            force_h += 3 * film * w / gap;
        }
        for (const auto& wave : terms_.waves) {
            force += wave.amplitude * std::sin(two_pi * wave.frequency * t + wave.phase);
        }
        for (const auto& extra : terms_.extras) {
            force += extra.force(extra.parameters, t, h, w);
        }
        if (flexible_ != nullptr) {
            force += flexible_->value(h, w, t, u, force_h, force_w);
        }
        for (const auto& correction : terms_.corrections) {
            double point[tables::max_axes] = {};
            for (std::size_t i = 0; i < correction.axes.size(); ++i) {
                const dynamics::Channel channel = correction.axes[i];
                point[i] = channel == dynamics::Channel::gap              ? h
                           : channel == dynamics::Channel::heave_velocity ? w
                           : channel == dynamics::Channel::time           ? t
                           : channel == dynamics::Channel::input_force    ? u
                                                                          : held_.get(channel, 0);
            }
            force += correction.table.value(point);
        }
        double mass_slope = 0;
        double mass = inertia(h, mass_slope);
        force -= 0.5 * mass_slope * w * w;
        if (history_) {
            const dynamics::HistoryKernel& kernel = dynamics::history_kernel();
            for (std::size_t i = 0; i < dynamics::history_states; ++i) {
                force -= terms_.history * kernel.weight[i] * kept_[i] * (w + memory_[i]);
                mass += terms_.history * kernel.weight[i] * grown_[i];
            }
            mass += terms_.history * kernel.mass;
        }
        slope_h = (force_h - force / mass * mass_slope) / mass;
        slope_w = (force_w - mass_slope * w) / mass;
        return force / mass;
    }

    void start_history(double w) {
        for (double& memory : memory_) {
            memory = -w;
        }
    }
    /// The memory that another run of the same equation had come to; nullptr: the body has moved steadily.
    void start_history(double w, const double* memory) {
        start_history(w);
        if (memory != nullptr) {
            std::copy_n(memory, dynamics::history_states, memory_);
        }
    }
    [[nodiscard]] const double* memory() const { return memory_; }
    /// The velocity was found to be another by so much: it always was, the body did not jump.
    void correct_velocity(double change) {
        for (double& memory : memory_) {
            memory -= change;
        }
    }

    /// How a step changes small differences of (gap, velocity).
    struct Transition {
        double hh = 1, hw = 0, wh = 0, ww = 1;
    };

    /// One step of at most `rest`, less where the motion is stiff: exact for the equation linearised where the step begins
    /// (exponential Rosenbrock-Euler, Hochbruck and Ostermann 2010), its matrix functions as series. Returns its length.
    double advance(double t, double rest, double u, double variance, double& h, double& w, Transition& transition) {
        double slope_h = 0;
        double slope_w = 0;
        remember_over(rest);
        double a = acceleration(t + 0.5 * rest, h, w, u, variance, slope_h, slope_w);
        double dt = rest;
        const double stiffness = std::max(std::abs(slope_w), std::sqrt(std::abs(slope_h)));
        if (stiffness * dt > 0.8) {
            dt = std::max(0.8 / stiffness, std::min(rest, shortest_step));
            if (history_) {
                remember_over(dt);
                a = acceleration(t + 0.5 * dt, h, w, u, variance, slope_h, slope_w);
            }
        }
        const double jerk = slope_h * w + slope_w * a;
        const double snap = slope_h * a + slope_w * jerk;
        const double before = w;
        h += dt * (w + dt * (a / 2 + dt * (jerk / 6 + dt * snap / 24)));
        w += dt * (a + dt * (jerk / 2 + dt * snap / 6));
        const double q = 0.5 * dt * dt;
        transition.hh = 1 + q * slope_h;
        transition.hw = dt + q * slope_w;
        transition.wh = dt * slope_h + q * slope_h * slope_w;
        transition.ww = std::max(0.0, 1 + dt * slope_w + q * (slope_h + slope_w * slope_w));
        if (history_) {
            for (std::size_t i = 0; i < dynamics::history_states; ++i) {
                memory_[i] = (before + memory_[i]) * decay_[i] + (w - before) * kept_[i] - w;
            }
        }
        return dt;
    }

private:
    /// Each part of the memory, q = w + memory, obeys dq/dt = acceleration - rate q. Exact for an acceleration held over the step: of what
    /// was there at its begin the share `kept` acts on the average, and the acceleration itself acts like a mass.
    void remember_over(double dt) {
        if (!history_ || dt == memory_step_) {
            return;
        }
        memory_step_ = dt;
        const dynamics::HistoryKernel& kernel = dynamics::history_kernel();
        for (std::size_t i = 0; i < dynamics::history_states; ++i) {
            const double x = kernel.rate[i] * dt;
            decay_[i] = std::exp(-x);
            kept_[i] = x > 1e-6 ? -std::expm1(-x) / x : 1 - 0.5 * x;
            grown_[i] = x > 1e-6 ? (1 - kept_[i]) / kernel.rate[i] : 0.5 * dt;
        }
    }

    const dynamics::HeaveTerms& terms_;
    const dynamics::Curve& curve_;
    const FlexibleForce* flexible_;
    double gain_;
    double scale_ = 1;
    const dynamics::Conditions& held_;
    bool rough_;
    bool history_;
    double memory_[dynamics::history_states];
    double decay_[dynamics::history_states] = {};
    double kept_[dynamics::history_states] = {};
    double grown_[dynamics::history_states] = {};
    double memory_step_ = -1;
};

/// Where the motion begins, roughly: a straight line through the first second.
void first_guess(const HeaveRecord& record, double& h, double& w, double& span) {
    double low = 1e300, high = -1e300;
    double n = 0, st = 0, sy = 0, stt = 0, sty = 0;
    const double begin = record.time.front();
    for (std::size_t k = 0; k < record.time.size() && record.time[k] - begin < 0.6; ++k) {
        if (std::isfinite(record.gap[k])) {
            const double t = record.time[k] - begin;
            low = std::min(low, record.gap[k]);
            high = std::max(high, record.gap[k]);
            n += 1;
            st += t;
            sy += record.gap[k];
            stt += t * t;
            sty += t * record.gap[k];
        }
    }
    const double determinant = n * stt - st * st;
    w = determinant > 1e-12 ? (n * sty - st * sy) / determinant : 0;
    h = n > 0 ? (sy - w * st) / n : 0.1;
    span = n > 0 ? high - low : 0;
}

/// Three states: gap, velocity, coloured noise of the gap sensor. Symmetric covariance in six numbers.
struct Covariance {
    double hh, hw, hn, ww, wn, nn;
};

}  // namespace

double FlexibleForce::value(double h, double w, double t, double u, double& slope_h, double& slope_w) const {
    double point[4];
    double slopes[4] = {};
    for (std::size_t v = 0; v < variables.size(); ++v) {
        const double value = variables[v] == Variable::gap              ? h
                             : variables[v] == Variable::heave_velocity ? w
                             : variables[v] == Variable::time           ? t
                                                                        : u;
        point[v] = std::clamp(value, lower[v], upper[v]);
    }
    const double sum = basis.sum(coefficients.data(), point, slopes);
    for (std::size_t v = 0; v < variables.size(); ++v) {
        if (point[v] > lower[v] && point[v] < upper[v]) {
            slope_h += variables[v] == Variable::gap ? slopes[v] : 0;
            slope_w += variables[v] == Variable::heave_velocity ? slopes[v] : 0;
        }
    }
    return sum;
}

void transform_input(const HeaveRecord& record, const HeaveExplanation& explanation, std::vector<double>& input) {
    const dynamics::HeaveTerms& terms = explanation.terms;
    const std::vector<double>& prepared = explanation.hold ? record.held_input : record.linear_input;
    if (terms.input_delay == 0 && terms.input_dead_zone == 0 && terms.input_lag == 0 && prepared.size() == record.time.size()) {
        input = prepared;
        if (terms.input_gain != 1) {
            for (double& u : input) {
                u *= terms.input_gain;
            }
        }
        return;
    }
    const std::vector<double>& time = record.raw_time;
    const std::size_t n = time.size();
    std::vector<double> felt = record.raw_input;
    if (terms.input_dead_zone != 0 || terms.input_gain != 1) {
        for (double& u : felt) {
            u = terms.input_gain * std::copysign(std::max(0.0, std::abs(u) - terms.input_dead_zone), u);
        }
    }
    // the integral of what the body feels, exact for an input held or linear between samples
    std::vector<double> integral(n, 0);
    double lagged = felt.front();
    for (std::size_t i = 1; i < n; ++i) {
        const double dt = time[i] - time[i - 1];
        const double area = dt * (explanation.hold ? felt[i - 1] : 0.5 * (felt[i - 1] + felt[i]));
        double out = area;
        if (terms.input_lag > 0) {
            // area of the lagged signal = area of the input - time constant * growth of the lagged signal
            const double a = dt / terms.input_lag;
            const double decay = std::exp(-a);
            const double ramp = a > 1e-6 ? (1 - decay) / a : 1 - 0.5 * a;
            const double before = lagged;
            lagged = explanation.hold ? lagged * decay + felt[i - 1] * (1 - decay)
                                      : lagged * decay + felt[i] - felt[i - 1] * decay - (felt[i] - felt[i - 1]) * ramp;
            out = area - terms.input_lag * (lagged - before);
        }
        integral[i] = integral[i - 1] + out;
    }
    const bool lag = terms.input_lag > 0;
    std::size_t at = 0;
    const auto integral_at = [&](double t) {
        if (t <= time.front()) {
            return (t - time.front()) * felt.front();
        }
        if (t >= time.back()) {
            return integral.back() + (t - time.back()) * (lag ? lagged : felt.back());
        }
        while (at + 2 < n && time[at + 1] < t) {
            ++at;
        }
        const double dt = time[at + 1] - time[at];
        const double part = t - time[at];
        if (lag || explanation.hold) {
            return integral[at] + (integral[at + 1] - integral[at]) * part / dt;
        }
        return integral[at] + part * (felt[at] + 0.5 * (felt[at + 1] - felt[at]) * part / dt);
    };
    input.resize(record.time.size());
    double before = integral_at(record.time.front() - terms.input_delay);
    input[0] = felt.front();
    for (std::size_t k = 1; k < input.size(); ++k) {
        const double now = integral_at(record.time[k] - terms.input_delay);
        input[k] = (now - before) / (record.time[k] - record.time[k - 1]);
        before = now;
    }
}

void prepare_input(HeaveRecord& record) {
    HeaveExplanation as_recorded;
    record.held_input.clear();
    record.linear_input.clear();
    std::vector<double> linear;
    as_recorded.hold = false;
    transform_input(record, as_recorded, linear);
    as_recorded.hold = true;
    transform_input(record, as_recorded, record.held_input);
    record.linear_input = std::move(linear);
}

double filter_innovations(const HeaveRecord& record, const HeaveExplanation& explanation, const HeaveNoise& noise,
                          std::vector<double>& innovations, std::vector<double>* states, std::vector<double>* memories) {
    Equation equation(record, explanation);
    const dynamics::HeaveTerms& terms = explanation.terms;
    std::vector<double> input;
    transform_input(record, explanation, input);
    double h = 0;
    double w = 0;
    double span = 0;
    first_guess(record, h, w, span);
    h -= terms.sensor_bias;
    equation.start_history(w);
    double n = 0;
    const double slow = noise.slow * noise.slow;
    Covariance p{std::max(1e-4, span * span), 0, 0, std::max(1e-4, span * span), 0, slow};
    const double delay = terms.sensor_delay;
    double log_determinant = 0;
    const auto update = [&](double residual, double ch, double cw, double cn, double variance) {
        const double ph = p.hh * ch + p.hw * cw + p.hn * cn;
        const double pw = p.hw * ch + p.ww * cw + p.wn * cn;
        const double pn = p.hn * ch + p.wn * cw + p.nn * cn;
        const double s = ch * ph + cw * pw + cn * pn + variance;
        const double gain_h = ph / s;
        const double gain_w = pw / s;
        const double gain_n = pn / s;
        h += gain_h * residual;
        w += gain_w * residual;
        n += gain_n * residual;
        equation.correct_velocity(gain_w * residual);
        p.hh -= gain_h * ph;
        p.hw -= gain_h * pw;
        p.hn -= gain_h * pn;
        p.ww -= gain_w * pw;
        p.wn -= gain_w * pn;
        p.nn -= gain_n * pn;
        innovations.push_back(residual / std::sqrt(s));
        log_determinant += std::log(s);
    };
    for (std::size_t k = 0; k < record.time.size(); ++k) {
        if (k > 0) {
            double rest = record.time[k] - record.time[k - 1];
            double t = record.time[k - 1];
            equation.to_step(record, k);
            while (rest > 1e-9) {
                Equation::Transition f;
                const double dt = equation.advance(t, std::min(rest, longest_step), input[k], p.ww, h, w, f);
                const Covariance o = p;
                const double a = f.hh * o.hh + f.hw * o.hw;
                const double b = f.hh * o.hw + f.hw * o.ww;
                const double c = f.wh * o.hh + f.ww * o.hw;
                const double d = f.wh * o.hw + f.ww * o.ww;
                p.hh = a * f.hh + b * f.hw + noise.process * dt * dt * dt / 3;
                p.hw = a * f.wh + b * f.ww + noise.process * dt * dt / 2;
                p.ww = c * f.wh + d * f.ww + noise.process * dt;
                if (slow > 0) {
                    const double phi = std::exp(-dt / noise.slow_time);
                    n *= phi;
                    p.hn = phi * (f.hh * o.hn + f.hw * o.wn);
                    p.wn = phi * (f.wh * o.hn + f.ww * o.wn);
                    p.nn = phi * phi * o.nn + slow * (1 - phi * phi);
                }
                t += dt;
                rest -= dt;
            }
        }
        if (std::isfinite(record.gap[k])) {
            double reading = h + terms.sensor_bias + n;
            double ch = 1;
            double cw = 0;
            if (delay > 0) {
                double slope_h = 0;
                double slope_w = 0;
                const double a = equation.acceleration(record.time[k], h, w, input[k], p.ww, slope_h, slope_w);
                reading += -delay * w + 0.5 * delay * delay * a;
                ch += 0.5 * delay * delay * slope_h;
                cw = -delay + 0.5 * delay * delay * slope_w;
            }
            const double sigma = noise.gap * record.gap_share[k];
            update(record.gap[k] - reading, ch, cw, 1, sigma * sigma);
        } else {
            innovations.push_back(0);
        }
        if (!record.velocity.empty()) {
            if (std::isfinite(record.velocity[k])) {
                const double sigma = noise.velocity * record.velocity_share[k];
                update(record.velocity[k] - w, 0, 1, 0, sigma * sigma);
            } else {
                innovations.push_back(0);
            }
        }
        if (states != nullptr) {
            states->push_back(h);
            states->push_back(w);
        }
        if (memories != nullptr) {
            memories->insert(memories->end(), equation.memory(), equation.memory() + dynamics::history_states);
        }
    }
    return log_determinant;
}

SmoothedRun smooth_with_force(const HeaveRecord& record, const HeaveExplanation& explanation, const HeaveNoise& noise,
                              double force_walk) {
    using Vector = std::array<double, 3>;
    using Matrix = std::array<double, 9>;
    Equation equation(record, explanation);
    std::vector<double> input;
    transform_input(record, explanation, input);
    const std::size_t n = record.time.size();
    std::vector<Vector> predicted(n), filtered(n);
    std::vector<Matrix> predicted_p(n), filtered_p(n), transition(n);
    Vector x{};
    double span = 0;
    first_guess(record, x[0], x[1], span);
    x[0] -= explanation.terms.sensor_bias;
    equation.start_history(x[1]);
    Matrix p{std::max(1e-4, span * span), 0, 0, 0, std::max(1e-4, span * span), 0, 0, 0, 1e-2};
    const auto measure = [&](double residual, const Vector& c, double variance) {
        Vector pc{};
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                pc[i] += p[3 * i + j] * c[j];
            }
        }
        const double s = c[0] * pc[0] + c[1] * pc[1] + c[2] * pc[2] + variance;
        for (int i = 0; i < 3; ++i) {
            x[i] += pc[i] / s * residual;
        }
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                p[3 * i + j] -= pc[i] * pc[j] / s;
            }
        }
    };
    for (std::size_t k = 0; k < n; ++k) {
        Matrix f{1, 0, 0, 0, 1, 0, 0, 0, 1};
        if (k > 0) {
            double rest = record.time[k] - record.time[k - 1];
            double t = record.time[k - 1];
            equation.to_step(record, k);
            while (rest > 1e-9) {
                double mass_slope = 0;
                const double per_mass = 1 / equation.inertia(x[0], mass_slope);
                Equation::Transition m;
                const double dt = equation.advance(t, std::min(rest, longest_step), input[k] + x[2], p[4], x[0], x[1], m);
                t += dt;
                rest -= dt;
                const Matrix g{m.hh, m.hw, 0.5 * dt * dt * per_mass, m.wh, m.ww, dt * per_mass, 0, 0, 1};
                Matrix gp{}, next{}, gf{};
                for (int i = 0; i < 3; ++i) {
                    for (int j = 0; j < 3; ++j) {
                        for (int l = 0; l < 3; ++l) {
                            gp[3 * i + j] += g[3 * i + l] * p[3 * l + j];
                            gf[3 * i + j] += g[3 * i + l] * f[3 * l + j];
                        }
                    }
                }
                for (int i = 0; i < 3; ++i) {
                    for (int j = 0; j < 3; ++j) {
                        for (int l = 0; l < 3; ++l) {
                            next[3 * i + j] += gp[3 * i + l] * g[3 * j + l];
                        }
                    }
                }
                p = next;
                f = gf;
                p[0] += noise.process * dt * dt * dt / 3;
                p[1] += noise.process * dt * dt / 2;
                p[3] = p[1];
                p[4] += noise.process * dt;
                p[8] += force_walk * force_walk * dt;
            }
        }
        predicted[k] = x;
        predicted_p[k] = p;
        transition[k] = f;
        if (std::isfinite(record.gap[k])) {
            const double sigma = noise.gap * record.gap_share[k];
            measure(record.gap[k] - x[0] - explanation.terms.sensor_bias, {1, 0, 0}, sigma * sigma + noise.slow * noise.slow);
        }
        if (!record.velocity.empty() && std::isfinite(record.velocity[k])) {
            const double sigma = noise.velocity * record.velocity_share[k];
            measure(record.velocity[k] - x[1], {0, 1, 0}, sigma * sigma);
        }
        filtered[k] = x;
        filtered_p[k] = p;
    }
    SmoothedRun run;
    run.time = record.time;
    run.gap.resize(n);
    run.velocity.resize(n);
    run.force.resize(n);
    run.force_sigma.resize(n);
    Vector s = filtered[n - 1];
    Matrix sp = filtered_p[n - 1];
    const auto invert = [](const Matrix& m) {
        Matrix r{};
        const double det = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
        const double inverse = 1 / det;
        r[0] = (m[4] * m[8] - m[5] * m[7]) * inverse;
        r[1] = (m[2] * m[7] - m[1] * m[8]) * inverse;
        r[2] = (m[1] * m[5] - m[2] * m[4]) * inverse;
        r[3] = (m[5] * m[6] - m[3] * m[8]) * inverse;
        r[4] = (m[0] * m[8] - m[2] * m[6]) * inverse;
        r[5] = (m[2] * m[3] - m[0] * m[5]) * inverse;
        r[6] = (m[3] * m[7] - m[4] * m[6]) * inverse;
        r[7] = (m[1] * m[6] - m[0] * m[7]) * inverse;
        r[8] = (m[0] * m[4] - m[1] * m[3]) * inverse;
        return r;
    };
    for (std::size_t k = n; k-- > 0;) {
        if (k + 1 < n) {
            const Matrix inverse = invert(predicted_p[k + 1]);
            Matrix pf{}, gain{};
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    for (int l = 0; l < 3; ++l) {
                        pf[3 * i + j] += filtered_p[k][3 * i + l] * transition[k + 1][3 * j + l];
                    }
                }
            }
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    for (int l = 0; l < 3; ++l) {
                        gain[3 * i + j] += pf[3 * i + l] * inverse[3 * l + j];
                    }
                }
            }
            Vector next = filtered[k];
            Matrix difference{}, gd{}, np = filtered_p[k];
            for (int i = 0; i < 9; ++i) {
                difference[i] = sp[i] - predicted_p[k + 1][i];
            }
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    next[i] += gain[3 * i + j] * (s[j] - predicted[k + 1][j]);
                    for (int l = 0; l < 3; ++l) {
                        gd[3 * i + j] += gain[3 * i + l] * difference[3 * l + j];
                    }
                }
            }
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    for (int l = 0; l < 3; ++l) {
                        np[3 * i + j] += gd[3 * i + l] * gain[3 * j + l];
                    }
                }
            }
            s = next;
            sp = np;
        }
        run.gap[k] = s[0];
        run.velocity[k] = s[1];
        run.force[k] = s[2];
        run.force_sigma[k] = std::sqrt(std::max(0.0, sp[8]));
    }
    return run;
}

void step_once(const HeaveRecord& record, const HeaveExplanation& explanation, const std::vector<double>& input, std::size_t k, double& gap,
               double& velocity) {
    Equation equation(record, explanation);
    equation.start_history(velocity);
    equation.to_step(record, k);
    double t = record.time[k - 1];
    for (double rest = record.time[k] - t; rest > 1e-9;) {
        Equation::Transition transition;
        const double dt = equation.advance(t, std::min(rest, longest_step), input[k], 0, gap, velocity, transition);
        t += dt;
        rest -= dt;
    }
}

void free_run(const HeaveRecord& record, const HeaveExplanation& explanation, const std::vector<double>& input, std::size_t first,
              std::size_t last, double gap, double velocity, std::vector<double>& predicted, const double* memory) {
    Equation equation(record, explanation);
    equation.start_history(velocity, memory);
    predicted.clear();
    double h = gap;
    double w = velocity;
    const auto reading = [&](std::size_t k) {
        double value = h + explanation.terms.sensor_bias;
        if (explanation.terms.sensor_delay > 0) {
            const double delay = explanation.terms.sensor_delay;
            value += -delay * w + 0.5 * delay * delay * equation.acceleration(record.time[k], h, w, input[k], 0);
        }
        return value;
    };
    predicted.push_back(reading(first));
    for (std::size_t k = first + 1; k <= last; ++k) {
        double rest = record.time[k] - record.time[k - 1];
        double t = record.time[k - 1];
        equation.to_step(record, k);
        while (rest > 1e-9) {
            Equation::Transition transition;
            const double dt = equation.advance(t, std::min(rest, longest_step), input[k], 0, h, w, transition);
            t += dt;
            rest -= dt;
        }
        predicted.push_back(reading(k));
    }
}

}  // namespace underbody::discovery
