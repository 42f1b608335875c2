#include "surrogates/discovery/heave/heave_filter.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

#include "surrogates/dynamics/simulate/start_state.h"

namespace underbody::discovery {

namespace {

constexpr double longest_step = 0.05;    ///< s, of the integrator
constexpr double shortest_step = 0.001;  ///< s
constexpr double series_holds =
    0.8;  ///< of step times stiffness: the series of the matrix functions are cut after four terms

/// The heave equation of dynamics with the run's own lift, a force without a law, and memory over steps.
class Equation {
public:
    Equation(const HeaveRecord& record, const HeaveExplanation& explanation)
        : terms_(explanation.terms),
          curve_(record.plant->lift_curve()),
          flexible_(explanation.flexible),
          gain_(explanation.lift_gain * record.lift_factor),
          held_(record.plant->held()),
          history_(terms_.history != 0) {
        for (double& memory : memory_) {
            memory = 0;
        }
    }

    /// To be called before the motion to step k is asked for.
    void to_step(const HeaveRecord& record, std::size_t k) {
        scale_ = record.lift_scale.empty() ? 1 : record.lift_scale[k];
    }

    [[nodiscard]] double mass(double h) const { return dynamics::heave_inertia(terms_, h).mass; }

    double acceleration(double t, double h, double w, double u, double velocity_variance) const {
        dynamics::HeaveSlopes slopes;
        return acceleration(t, h, w, u, velocity_variance, slopes);
    }

    /// `velocity_variance` blurs the step of Coulomb's law as far as the velocity is unknown (statistical
    /// linearisation). Slopes with the memory of the history force as it is over the coming step.
    double acceleration(double t, double h, double w, double u, double velocity_variance,
                        dynamics::HeaveSlopes& slopes) const {
        dynamics::HeaveLoad load;
        if (!curve_.empty()) {
            const double gain = gain_ * scale_;
            load.force = gain * curve_.value(h, load.slope_h);
            load.slope_h *= gain;
            dynamics::roughen(terms_, h, load);
        }
        if (flexible_ != nullptr) {
            load.force += flexible_->value(h, w, t, u, load.slope_h, load.slope_w);
        }
        dynamics::add_forces(terms_, h, w, {t, u, nullptr, nullptr, velocity_variance}, held_, load);
        dynamics::HeaveMemory memory;
        if (history_) {
            const dynamics::HistoryKernel& kernel = dynamics::history_kernel();
            for (std::size_t i = 0; i < dynamics::history_states; ++i) {
                memory.force -= terms_.history * kernel.weight[i] * kept_[i] * (w + memory_[i]);
                memory.mass += terms_.history * kernel.weight[i] * grown_[i];
            }
            memory.mass += terms_.history * kernel.mass;
        }
        return dynamics::heave_acceleration(terms_, h, w, load, memory, slopes);
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

    using Transition = HeaveTransition;

    /// One step of at most `rest`, less where the motion is stiff (short_step()). Returns its length.
    double advance(double t, double rest, double u, double variance, double& h, double& w, Transition& transition) {
        dynamics::HeaveSlopes slopes;
        remember_over(rest);
        double a = acceleration(t + 0.5 * rest, h, w, u, variance, slopes);
        double dt = rest;
        const double stiffness = stiffness_of(slopes);
        if (stiffness * dt > series_holds) {
            dt = std::max(series_holds / stiffness, std::min(rest, shortest_step));
            if (history_) {
                remember_over(dt);
                a = acceleration(t + 0.5 * dt, h, w, u, variance, slopes);
            }
        }
        if (stiffness * dt > 2 * series_holds) {
            fast_step(dt, a, slopes, h, w, transition);
            return dt;
        }
        const double before = w;
        transition = short_step(dt, a, slopes, h, w);
        remember(before, w);
        return dt;
    }

private:
    /// The same step where even the shortest is long against the motion (a film at a small gap): the functions of the
    /// matrix in closed form of its eigenvalues.
    void fast_step(double dt, double a, const dynamics::HeaveSlopes& slopes, double& h, double& w,
                   Transition& transition) {
        using Complex = std::complex<double>;
        const double half = 0.5 * slopes.velocity;
        const Complex root = std::sqrt(Complex(half * half + slopes.gap));
        const Complex l1 = half + root;
        const Complex l2 =
            std::abs(root) > 1e-6 * std::abs(half) ? half - root : half - root - 1e-6 * std::abs(half) - 1e-9;
        // f(A) = f(l1) I + (f(l2) - f(l1))/(l2 - l1) (A - l1 I), with A = (0 1; gap velocity)
        const auto of_matrix = [&](const Complex& f1, const Complex& f2) {
            const Complex q = (f2 - f1) / (l2 - l1);
            return Transition{(f1 - q * l1).real(), q.real(), (q * slopes.gap).real(),
                              (f1 + q * (slopes.velocity - l1)).real()};
        };
        // (exp(l dt) - 1)/l
        const auto grown = [&](const Complex& l) {
            const Complex z = l * dt;
            return std::abs(z) < 1e-4 ? dt * (1.0 + z / 2.0 + z * z / 6.0) : (std::exp(z) - 1.0) / l;
        };
        const Transition over = of_matrix(grown(l1), grown(l2));
        transition = of_matrix(std::exp(l1 * dt), std::exp(l2 * dt));
        const double before = w;
        h += over.hh * before + over.hw * a;
        w += over.wh * before + over.ww * a;
        remember(before, w);
    }

    /// What the memory becomes over a step whose velocity ends at w.
    void remember(double before, double w) {
        for (std::size_t i = 0; history_ && i < dynamics::history_states; ++i) {
            memory_[i] = (before + memory_[i]) * decay_[i] + (w - before) * kept_[i] - w;
        }
    }

    /// Each part of the memory, q = w + memory, obeys dq/dt = acceleration - rate q. Exact for an acceleration held
    /// over the step: of what was there at its begin the share `kept` acts on the average, and the acceleration itself
    /// acts like a mass.
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
    bool history_;
    double memory_[dynamics::history_states];
    double decay_[dynamics::history_states] = {};
    double kept_[dynamics::history_states] = {};
    double grown_[dynamics::history_states] = {};
    double memory_step_ = -1;
};

/// Where the motion begins, roughly, and how far it moves there.
void first_guess(const HeaveRecord& record, double& h, double& w, double& span) {
    const dynamics::StartState start = dynamics::start_state(record.time, record.gap, 0, record.time.size() - 1);
    h = start.readings > 0 ? start.gap : 0.1;
    w = start.velocity;
    span = start.range;
}

/// Three states: gap, velocity, coloured noise of the gap sensor. Symmetric covariance in six numbers.
struct Covariance {
    double hh, hw, hn, ww, wn, nn;
};

}  // namespace

double stiffness_of(const dynamics::HeaveSlopes& slopes) {
    return std::max(std::abs(slopes.velocity), std::sqrt(std::abs(slopes.gap)));
}

HeaveTransition short_step(double dt, double a, const dynamics::HeaveSlopes& slopes, double& h, double& w) {
    const double slope_h = slopes.gap, slope_w = slopes.velocity;
    const double jerk = slope_h * w + slope_w * a;
    const double snap = slope_h * a + slope_w * jerk;
    h += dt * (w + dt * (a / 2 + dt * (jerk / 6 + dt * snap / 24)));
    w += dt * (a + dt * (jerk / 2 + dt * snap / 6));
    const double q = 0.5 * dt * dt;
    return {1 + q * slope_h, dt + q * slope_w, dt * slope_h + q * slope_h * slope_w,
            std::max(0.0, 1 + dt * slope_w + q * (slope_h + slope_w * slope_w))};
}

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
    const dynamics::Actuator& actuator = explanation.terms.actuator;
    const std::vector<double>& prepared = explanation.hold ? record.held_input : record.linear_input;
    if (actuator.dead_zone != 0 || actuator.has_states() || prepared.size() != record.time.size()) {
        actuator.mean_over_steps(record.raw_time, record.raw_input, explanation.hold, record.time, input);
        return;
    }
    input = prepared;
    if (actuator.gain != 1) {
        for (double& u : input) {
            u *= actuator.gain;
        }
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

namespace {

/// Gap, velocity and coloured noise of the gap sensor through one run, reading by reading.
class GapFilter {
public:
    GapFilter(const HeaveRecord& record, const HeaveExplanation& explanation, const HeaveNoise& noise,
              std::vector<double>& innovations)
        : record_(record),
          terms_(explanation.terms),
          noise_(noise),
          slow_(noise.slow * noise.slow),
          equation_(record, explanation),
          innovations_(innovations) {
        transform_input(record, explanation, input_);
        double span = 0;
        first_guess(record, h_, w_, span);
        h_ -= terms_.sensor_offset(record.time.front());
        equation_.start_history(w_);
        p_ = {std::max(1e-4, span * span), 0, 0, std::max(1e-4, span * span), 0, slow_};
    }

    /// From the step before to k.
    void to_step(std::size_t k) {
        double rest = record_.time[k] - record_.time[k - 1];
        double t = record_.time[k - 1];
        equation_.to_step(record_, k);
        while (rest > 1e-9) {
            Equation::Transition f;
            const double dt = equation_.advance(t, std::min(rest, longest_step), input_[k], p_.ww, h_, w_, f);
            spread(f, dt);
            t += dt;
            rest -= dt;
        }
    }

    void read_gap(std::size_t k) {
        if (!std::isfinite(record_.gap[k])) {
            innovations_.push_back(0);
            return;
        }
        double reading = h_ + terms_.sensor_offset(record_.time[k]) + n_;
        double ch = 1;
        double cw = 0;
        if (const double delay = terms_.sensor_delay; delay > 0) {
            dynamics::HeaveSlopes slopes;
            const double a = equation_.acceleration(record_.time[k], h_, w_, input_[k], p_.ww, slopes);
            reading += -delay * w_ + 0.5 * delay * delay * a;
            ch += 0.5 * delay * delay * slopes.gap;
            cw = -delay + 0.5 * delay * delay * slopes.velocity;
        }
        const double sigma = noise_.gap * record_.gap_share[k];
        take(record_.gap[k] - reading, ch, cw, 1, sigma * sigma);
    }

    void read_velocity(std::size_t k) {
        if (!std::isfinite(record_.velocity[k])) {
            innovations_.push_back(0);
            return;
        }
        const double sigma = noise_.velocity * record_.velocity_share[k];
        take(record_.velocity[k] - w_, 0, 1, 0, sigma * sigma);
    }

    [[nodiscard]] double gap() const { return h_; }
    [[nodiscard]] double velocity() const { return w_; }
    [[nodiscard]] const double* memory() const { return equation_.memory(); }
    [[nodiscard]] double log_determinant() const { return log_determinant_; }

private:
    /// The covariance over a step of `dt`.
    void spread(const Equation::Transition& f, double dt) {
        const Covariance o = p_;
        const double a = f.hh * o.hh + f.hw * o.hw;
        const double b = f.hh * o.hw + f.hw * o.ww;
        const double c = f.wh * o.hh + f.ww * o.hw;
        const double d = f.wh * o.hw + f.ww * o.ww;
        p_.hh = a * f.hh + b * f.hw + noise_.process * dt * dt * dt / 3;
        p_.hw = a * f.wh + b * f.ww + noise_.process * dt * dt / 2;
        p_.ww = c * f.wh + d * f.ww + noise_.process * dt;
        if (slow_ > 0) {
            const double phi = std::exp(-dt / noise_.slow_time);
            n_ *= phi;
            p_.hn = phi * (f.hh * o.hn + f.hw * o.wn);
            p_.wn = phi * (f.wh * o.hn + f.ww * o.wn);
            p_.nn = phi * phi * o.nn + slow_ * (1 - phi * phi);
        }
    }

    /// A reading that is `residual` off, of ch gap + cw velocity + cn coloured noise.
    void take(double residual, double ch, double cw, double cn, double variance) {
        const double ph = p_.hh * ch + p_.hw * cw + p_.hn * cn;
        const double pw = p_.hw * ch + p_.ww * cw + p_.wn * cn;
        const double pn = p_.hn * ch + p_.wn * cw + p_.nn * cn;
        const double s = ch * ph + cw * pw + cn * pn + variance;
        const double gain_h = ph / s;
        const double gain_w = pw / s;
        const double gain_n = pn / s;
        h_ += gain_h * residual;
        w_ += gain_w * residual;
        n_ += gain_n * residual;
        equation_.correct_velocity(gain_w * residual);
        p_.hh -= gain_h * ph;
        p_.hw -= gain_h * pw;
        p_.hn -= gain_h * pn;
        p_.ww -= gain_w * pw;
        p_.wn -= gain_w * pn;
        p_.nn -= gain_n * pn;
        innovations_.push_back(residual / std::sqrt(s));
        log_determinant_ += std::log(s);
    }

    const HeaveRecord& record_;
    const dynamics::HeaveTerms& terms_;
    const HeaveNoise& noise_;
    double slow_;  ///< m^2, variance of the coloured noise
    Equation equation_;
    std::vector<double> input_;
    std::vector<double>& innovations_;
    double h_ = 0, w_ = 0, n_ = 0;
    Covariance p_{};
    double log_determinant_ = 0;
};

}  // namespace

double filter_innovations(const HeaveRecord& record, const HeaveExplanation& explanation, const HeaveNoise& noise,
                          std::vector<double>& innovations, std::vector<double>* states,
                          std::vector<double>* memories) {
    GapFilter filter(record, explanation, noise, innovations);
    for (std::size_t k = 0; k < record.time.size(); ++k) {
        if (k > 0) {
            filter.to_step(k);
        }
        filter.read_gap(k);
        if (!record.velocity.empty()) {
            filter.read_velocity(k);
        }
        if (states != nullptr) {
            states->push_back(filter.gap());
            states->push_back(filter.velocity());
        }
        if (memories != nullptr) {
            memories->insert(memories->end(), filter.memory(), filter.memory() + dynamics::history_states);
        }
    }
    return filter.log_determinant();
}

namespace {

/// Gap, velocity and residual force at one step of the smoother, with their covariance.
struct ForceBelief {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    Eigen::Matrix3d p = Eigen::Matrix3d::Zero();

    void measure(double residual, const Eigen::Vector3d& c, double variance) {
        const Eigen::Vector3d pc = p * c;
        const double s = c.dot(pc) + variance;
        x += pc * (residual / s);
        p -= pc * pc.transpose() / s;
    }
};

/// Before and after the readings of each step, and how a step changes small differences.
struct ForceFilter {
    std::vector<ForceBelief> predicted, filtered;
    std::vector<Eigen::Matrix3d> transition;
};

/// Takes the belief over the step that ends at k; returns the step's transition.
Eigen::Matrix3d over_step(const HeaveRecord& record, Equation& equation, double input, std::size_t k,
                          const HeaveNoise& noise, double force_walk, ForceBelief& belief) {
    Eigen::Matrix3d whole = Eigen::Matrix3d::Identity();
    double rest = record.time[k] - record.time[k - 1];
    double t = record.time[k - 1];
    equation.to_step(record, k);
    while (rest > 1e-9) {
        const double per_mass = 1 / equation.mass(belief.x[0]);
        Equation::Transition m;
        const double dt = equation.advance(t, std::min(rest, longest_step), input + belief.x[2], belief.p(1, 1),
                                           belief.x[0], belief.x[1], m);
        t += dt;
        rest -= dt;
        Eigen::Matrix3d f;
        f << m.hh, m.hw, 0.5 * dt * dt * per_mass, m.wh, m.ww, dt * per_mass, 0, 0, 1;
        belief.p = f * belief.p * f.transpose();
        whole = f * whole;
        belief.p(0, 0) += noise.process * dt * dt * dt / 3;
        belief.p(0, 1) += noise.process * dt * dt / 2;
        belief.p(1, 0) = belief.p(0, 1);
        belief.p(1, 1) += noise.process * dt;
        belief.p(2, 2) += force_walk * force_walk * dt;
    }
    return whole;
}

ForceFilter filter_force(const HeaveRecord& record, const HeaveExplanation& explanation, const HeaveNoise& noise,
                         double force_walk) {
    Equation equation(record, explanation);
    std::vector<double> input;
    transform_input(record, explanation, input);
    const dynamics::HeaveTerms& terms = explanation.terms;
    ForceFilter all;
    ForceBelief belief;
    double span = 0;
    first_guess(record, belief.x[0], belief.x[1], span);
    belief.x[0] -= terms.sensor_offset(record.time.front());
    equation.start_history(belief.x[1]);
    belief.p.diagonal() << std::max(1e-4, span * span), std::max(1e-4, span * span), 1e-2;
    for (std::size_t k = 0; k < record.time.size(); ++k) {
        all.transition.push_back(k > 0 ? over_step(record, equation, input[k], k, noise, force_walk, belief)
                                       : Eigen::Matrix3d::Identity().eval());
        all.predicted.push_back(belief);
        if (std::isfinite(record.gap[k])) {
            const double sigma = noise.gap * record.gap_share[k];
            belief.measure(record.gap[k] - belief.x[0] - terms.sensor_offset(record.time[k]), {1, 0, 0},
                           sigma * sigma + noise.slow * noise.slow);
        }
        if (!record.velocity.empty() && std::isfinite(record.velocity[k])) {
            const double sigma = noise.velocity * record.velocity_share[k];
            belief.measure(record.velocity[k] - belief.x[1], {0, 1, 0}, sigma * sigma);
        }
        all.filtered.push_back(belief);
    }
    return all;
}

}  // namespace

SmoothedRun smooth_with_force(const HeaveRecord& record, const HeaveExplanation& explanation, const HeaveNoise& noise,
                              double force_walk) {
    const ForceFilter all = filter_force(record, explanation, noise, force_walk);
    const std::size_t n = record.time.size();
    SmoothedRun run;
    run.time = record.time;
    run.gap.resize(n);
    run.velocity.resize(n);
    run.force.resize(n);
    run.force_sigma.resize(n);
    ForceBelief later = all.filtered.back();
    for (std::size_t k = n; k-- > 0;) {
        if (k + 1 < n) {
            const ForceBelief& next = all.predicted[k + 1];
            ForceBelief now = all.filtered[k];
            const Eigen::Matrix3d gain = now.p * all.transition[k + 1].transpose() * next.p.inverse();
            now.x += gain * (later.x - next.x);
            now.p += gain * (later.p - next.p) * gain.transpose();
            later = now;
        }
        run.gap[k] = later.x[0];
        run.velocity[k] = later.x[1];
        run.force[k] = later.x[2];
        run.force_sigma[k] = std::sqrt(std::max(0.0, later.p(2, 2)));
    }
    return run;
}

double acceleration_of(const HeaveRecord& record, const HeaveExplanation& explanation, double t, double h, double w,
                       double input, dynamics::HeaveSlopes& slopes) {
    return Equation(record, explanation).acceleration(t, h, w, input, 0, slopes);
}

void step_once(const HeaveRecord& record, const HeaveExplanation& explanation, const std::vector<double>& input,
               std::size_t k, double& gap, double& velocity) {
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

void free_run(const HeaveRecord& record, const HeaveExplanation& explanation, const std::vector<double>& input,
              std::size_t first, std::size_t last, double gap, double velocity, std::vector<double>& predicted,
              const double* memory) {
    Equation equation(record, explanation);
    equation.start_history(velocity, memory);
    predicted.clear();
    double h = gap;
    double w = velocity;
    const auto reading = [&](std::size_t k) {
        double value = h + explanation.terms.sensor_offset(record.time[k]);
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
