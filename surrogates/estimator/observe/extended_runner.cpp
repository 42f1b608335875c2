#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "surrogates/estimator/observe/extended_filter.h"

namespace underbody::estimator {

namespace {

using State = Eigen::Vector3d;  // gap, velocity, departure
using Square = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Map<Square> square(std::array<double, 9>& p) { return Eigen::Map<Square>(p.data()); }
Eigen::Map<const Square> square(const std::array<double, 9>& p) { return Eigen::Map<const Square>(p.data()); }

}  // namespace

ExtendedRunner::ExtendedRunner(const SeparatedPlant& plant, const FilterNoise& noise)
    : plant_(&plant), noise_(&noise), departure_sigma_(noise.departure_sigma) {
    if (!(noise.gap > 0)) {
        throw core::InputError("range", "the noise of the gap sensor must be positive");
    }
    double slope = 0;
    for (int i = 0; i <= 200 && !(noise.departure_sigma > 0); ++i) {
        departure_sigma_ = std::max(
            departure_sigma_, std::abs(plant.ground_force(plant.lower + (plant.upper - plant.lower) * i / 200, slope)));
    }
    departure_sigma_ = std::max(departure_sigma_, 1e-9);
}

void ExtendedRunner::start(const Belief& belief) {
    belief_ = belief;
    predicted_ = belief;
    rejected_ = 0;
}

void ExtendedRunner::start(double gap, double velocity) {
    const bool seen = std::isfinite(velocity) && noise_->velocity > 0;
    Belief b;
    b.x = {gap, seen ? velocity : 0, 0};
    const double sw = seen ? noise_->velocity : 0.03;
    b.p = {noise_->gap * noise_->gap, 0, 0, 0, sw * sw, 0, 0, 0, departure_sigma_ * departure_sigma_};
    start(b);
}

namespace {

/// exp(A step) and what white noise of density q into the departure adds to the covariance over the step: series over a
/// part that is short against A, doubled as often as needed (a film at a small gap is fast).
void over_step(const dynamics::HeaveSlopes& slopes, double relaxation, double q, double step, Square& f,
               Square& noise) {
    const double s = 1 / slopes.mass,
                 fastest = std::max({std::abs(slopes.velocity), std::sqrt(std::abs(slopes.gap)), relaxation});
    int doublings = 0;
    while (fastest * step > 0.3 && doublings < 40) {
        step *= 0.5;
        ++doublings;
    }
    const double a10 = slopes.gap, a11 = slopes.velocity, a12 = s, a22 = -relaxation, h = 0.5 * step * step;
    f << 1 + h * a10, step + h * a11, h * a12,  //
        step * a10 + h * a11 * a10, 1 + step * a11 + h * (a10 + a11 * a11),
        step * a12 + h * (a11 * a12 + a12 * a22),  //
        0, 0, std::exp(step * a22);
    // Integrated through velocity and gap (Van Loan's series).
    const double t3 = step * step * step;
    noise << q * s * s * t3 * step * step / 20, q * s * s * t3 * step / 8, q * s * t3 / 6,  //
        q * s * s * t3 * step / 8, q * s * s * t3 / 3, q * s * step * step / 2,             //
        q * s * t3 / 6, q * s * step * step / 2, q * step;
    for (; doublings > 0; --doublings) {
        noise += (f * noise * f.transpose()).eval();
        f = (f * f).eval();
    }
}

}  // namespace

void ExtendedRunner::predict(double dt, double input, double time) {
    Belief& b = belief_;
    phi_ = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const int pieces = std::clamp(static_cast<int>(std::ceil(dt / 0.02)), 1, 500);
    const double step = dt / pieces;
    for (int i = 0; i < pieces; ++i) {
        const double now = time + step * i;
        dynamics::HeaveSlopes slopes;
        plant_->acceleration(b.x[0], b.x[1], input + b.x[2], now, slopes);
        Square f, noise;
        over_step(slopes, noise_->force_time > 0 ? 1 / noise_->force_time : 0, noise_->force_density, step, f, noise);
        plant_->advance(b.x[0], b.x[1], input + b.x[2], step, now);
        b.x[2] *= f(2, 2);
        square(b.p) = (f * square(b.p) * f.transpose() + noise).eval();
        square(phi_) = (f * square(phi_)).eval();
    }
}

// Scalar measurement of component c. Returns false for an outlier (belief unchanged).
bool ExtendedRunner::update(std::size_t c, double value, double sigma, double& innovation, double& spread,
                            bool trust_always) {
    const double r = sigma * sigma;
    spread = belief_.p[4 * c] + r;
    innovation = value - belief_.x[c];
    if (!trust_always && noise_->gate > 0 && innovation * innovation > noise_->gate * noise_->gate * spread) {
        return false;
    }
    const auto component = static_cast<Eigen::Index>(c);
    const State k = square(belief_.p).col(component) / spread;
    Square keep = Square::Identity();
    keep.col(component) -= k;
    for (std::size_t i = 0; i < 3; ++i) {
        belief_.x[i] += k[static_cast<Eigen::Index>(i)] * innovation;
    }
    square(belief_.p) = (keep * square(belief_.p) * keep.transpose() + r * k * k.transpose()).eval();  // Joseph's form
    return true;
}

double split_sigma(const FilterNoise& noise, const FilterEstimate& e) {
    // All of it is the one's or the other's, each as likely: half of its square is expected.
    const double departure =
        noise.split_departure ? std::hypot(e.departure, e.departure_sigma) / std::numbers::sqrt2 : 0;
    return std::hypot(noise.drag_relative * e.drag_force, departure);
}

void ExtendedRunner::describe(const Belief& b, FilterEstimate& e) const {
    double ground_slope = 0;
    DragSlopes drag;
    const double table = plant_->ground_force(b.x[0], ground_slope);
    e.gap = b.x[0];
    e.velocity = b.x[1];
    e.departure = b.x[2];
    e.drag_force = plant_->drag_force(b.x[0], b.x[1], drag);
    e.ground_force = table + b.x[2];
    e.total_force = e.ground_force - e.drag_force;
    e.covariance = b.p;
    const auto sigma_along = [&](double gh, double gw, double gd) {
        const State g{gh, gw, gd};
        return std::sqrt(std::max(g.dot(square(b.p) * g), 0.0));
    };
    e.gap_sigma = sigma_along(1, 0, 0);
    e.velocity_sigma = sigma_along(0, 1, 0);
    e.departure_sigma = sigma_along(0, 0, 1);
    e.total_sigma = sigma_along(ground_slope - drag.gap, -drag.velocity, 1);
    const double split = split_sigma(*noise_, e);
    e.drag_sigma = std::hypot(sigma_along(drag.gap, drag.velocity, 0), split);
    e.ground_sigma = std::hypot(sigma_along(ground_slope, 0, 1), split);
    e.outside = b.x[0] < plant_->lower || b.x[0] > plant_->upper;
}

double ExtendedRunner::measure(double gap, double velocity, FilterEstimate& e) {
    predicted_ = belief_;
    double likelihood = 0, spread = 0;
    const auto score = [&](double innovation) {
        likelihood -= 0.5 * (innovation * innovation / spread + std::log(2 * std::numbers::pi * spread));
    };
    e.innovation = NAN;
    e.outlier = false;
    if (std::isfinite(gap)) {
        // Several refused in a row are no outliers: the belief was wrong.
        e.outlier = !update(0, gap, noise_->gap, e.innovation, spread, rejected_ >= 3);
        e.innovation_sigma = std::sqrt(spread);
        if (e.outlier) {
            ++rejected_;
            likelihood -= 0.5 * (noise_->gate * noise_->gate + std::log(2 * std::numbers::pi * spread));
        } else {
            rejected_ = 0;
            score(e.innovation);
        }
    }
    if (noise_->velocity > 0 && std::isfinite(velocity)) {
        double innovation = 0;
        if (update(1, velocity, noise_->velocity, innovation, spread, false)) {
            score(innovation);
        }
    }
    describe(belief_, e);
    return likelihood;
}

}  // namespace underbody::estimator
