#include "surrogates/discovery/least_squares.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/no_limit.h"

namespace underbody::discovery {

namespace {

constexpr double difference_step = 1e-3;   ///< of a typical value, for slopes
constexpr double least_curvature = 1e-12;  ///< in units of typical values: the damping of a number nothing depends on
constexpr double least_damping = 1e-9,
                 first_damping = 1e-6;  ///< Levenberg and Marquardt: after a step that helped; after one that did not
constexpr double damping_change = 0.1;
constexpr double least_information = 1e-14;  ///< of the largest eigenvalue: below, the data do not say
constexpr double at_bound = 1e-9;            ///< of the range

class Solver {
public:
    Solver(const std::vector<FitParameter>& parameters, const WhitenedResiduals& residuals, const FitOptions& options)
        : parameters_(parameters), evaluate_(residuals), options_(options), count_(parameters.size()) {}

    Fit run() {
        Fit fit;
        for (const FitParameter& parameter : parameters_) {
            fit.parameters.push_back(std::clamp(parameter.start, parameter.lower, parameter.upper));
        }
        fit.log_determinant = evaluate(fit.parameters, fit.residuals);
        fit.cost = cost(fit.residuals, fit.log_determinant);
        double damping = 1e-3;
        bool fresh =
            false;  // the Jacobian belongs to where the fit stands, but for a step that gained less than the tolerance
        for (int i = 0; i < options_.iterations && count_ > 0; ++i) {
            linearise(fit);
            fresh = true;
            if (promised(fit) < options_.tolerance) {
                break;
            }
            const Taken taken = step(fit, damping);
            fresh = taken != Taken::far;
            if (fresh) {
                break;
            }
        }
        if (count_ > 0 && !fresh &&
            options_.iterations > 1) {  // a single step is part of a longer search: its errors are not asked for
            linearise(fit);
        }
        spread(fit);
        fit.evaluations = evaluations_;
        return fit;
    }

private:
    double evaluate(const std::vector<double>& p, std::vector<double>& r) {
        ++evaluations_;
        return evaluate_(p, r);
    }

    static double cost(const std::vector<double>& r, double log_determinant) {
        double sum = log_determinant;
        for (const double value : r) {
            sum += value * value;
        }
        return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
    }

    double centre(std::size_t j) const { return options_.about_zero ? 0 : parameters_[j].start; }

    double prior(const std::vector<double>& p) const {
        double sum = 0;
        for (std::size_t j = 0; j < count_; ++j) {
            const double distance = (p[j] - centre(j)) / parameters_[j].typical;
            sum += options_.ridge * distance * distance;
        }
        return sum;
    }

    /// Normal equations in units of `typical`.
    void linearise(const Fit& fit) {
        const Eigen::Index rows = static_cast<Eigen::Index>(fit.residuals.size());
        const Eigen::Index n = static_cast<Eigen::Index>(count_);
        jacobian_.resize(rows, n);
        std::vector<double> moved = fit.parameters;
        std::vector<double> r;
        const Eigen::Map<const Eigen::VectorXd> at(fit.residuals.data(), rows);
        for (std::size_t j = 0; j < count_; ++j) {
            const FitParameter& parameter = parameters_[j];
            double h = difference_step * parameter.typical;
            if (fit.parameters[j] + h > parameter.upper) {
                h = -h;
            }
            moved[j] = fit.parameters[j] + h;
            evaluate(moved, r);
            moved[j] = fit.parameters[j];
            const Eigen::Map<const Eigen::VectorXd> there(r.data(), rows);
            jacobian_.col(static_cast<Eigen::Index>(j)) = (there - at) * (parameter.typical / h);
        }
        if (!jacobian_.allFinite()) {
            jacobian_.setZero();
        }
        normal_ = jacobian_.transpose() * jacobian_;
        gradient_ = jacobian_.transpose() * at;
        for (std::size_t j = 0; j < count_; ++j) {
            const Eigen::Index k = static_cast<Eigen::Index>(j);
            normal_(k, k) += options_.ridge;
            gradient_(k) += options_.ridge * (fit.parameters[j] - centre(j)) / parameters_[j].typical;
        }
    }

    enum class Taken { none, small, far };

    /// True where a number stands at a bound and the cost falls beyond it.
    bool held(const Fit& fit, std::size_t j) const {
        const double slope = gradient_(static_cast<Eigen::Index>(j));
        return (fit.parameters[j] <= parameters_[j].lower && slope > 0) ||
               (fit.parameters[j] >= parameters_[j].upper && slope < 0);
    }

    /// Normal equations with the numbers held at their bounds taken out.
    Eigen::VectorXd move_of(const Fit& fit, double damping) const {
        Eigen::MatrixXd damped = normal_;
        Eigen::VectorXd slope = gradient_;
        for (std::size_t j = 0; j < count_; ++j) {
            const Eigen::Index k = static_cast<Eigen::Index>(j);
            if (held(fit, j)) {
                damped.row(k).setZero();
                damped.col(k).setZero();
                damped(k, k) = 1;
                slope(k) = 0;
            } else {
                damped(k, k) += damping * std::max(normal_(k, k), least_curvature) + least_curvature;
            }
        }
        return -damped.ldlt().solve(slope);
    }

    /// Fall of the cost that a full step of the linearised problem promises.
    double promised(const Fit& fit) const { return -gradient_.dot(move_of(fit, 0)); }

    Taken step(Fit& fit, double& damping) {
        const double before = fit.cost + prior(fit.parameters);
        for (int attempt = 0; attempt < 6; ++attempt) {
            const Eigen::VectorXd move = move_of(fit, damping);
            std::vector<double> there = fit.parameters;
            for (std::size_t j = 0; j < count_; ++j) {
                const double wanted = there[j] + move(static_cast<Eigen::Index>(j)) * parameters_[j].typical;
                there[j] = std::clamp(wanted, parameters_[j].lower, parameters_[j].upper);
            }
            std::vector<double> r;
            const double log_determinant = evaluate(there, r);
            const double reached = cost(r, log_determinant);
            if (reached + prior(there) < before) {
                const bool go_on = before - reached - prior(there) > options_.tolerance;
                fit.parameters = std::move(there);
                fit.residuals = std::move(r);
                fit.log_determinant = log_determinant;
                fit.cost = reached;
                damping = std::max(damping * damping_change, least_damping);
                return go_on ? Taken::far : Taken::small;
            }
            damping = std::max(damping, first_damping) * 10;
        }
        return Taken::none;
    }

    void spread(Fit& fit) const {
        fit.covariance.assign(count_ * count_, 0);
        fit.sigma.assign(count_, std::numeric_limits<double>::infinity());
        if (count_ == 0) {
            return;
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(normal_);
        const double largest = eigen.eigenvalues().maxCoeff();
        Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(normal_.rows(), normal_.cols());
        for (Eigen::Index k = 0; k < normal_.rows(); ++k) {
            const double value = std::max(eigen.eigenvalues()(k), least_information * largest + core::least_divisor);
            inverse += eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).transpose() / value;
        }
        for (std::size_t i = 0; i < count_; ++i) {
            for (std::size_t j = 0; j < count_; ++j) {
                fit.covariance[i * count_ + j] = inverse(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) *
                                                 parameters_[i].typical * parameters_[j].typical;
            }
            fit.sigma[i] = std::sqrt(fit.covariance[i * count_ + i]);
            const double width = parameters_[i].upper - parameters_[i].lower;
            fit.at_bound = fit.at_bound || fit.parameters[i] - parameters_[i].lower < at_bound * width ||
                           parameters_[i].upper - fit.parameters[i] < at_bound * width;
        }
    }

    const std::vector<FitParameter>& parameters_;
    const WhitenedResiduals& evaluate_;
    const FitOptions& options_;
    std::size_t count_;
    Eigen::MatrixXd jacobian_;
    Eigen::MatrixXd normal_;
    Eigen::VectorXd gradient_;
    int evaluations_ = 0;
};

}  // namespace

Fit least_squares(const std::vector<FitParameter>& parameters, const WhitenedResiduals& residuals,
                  const FitOptions& options) {
    return Solver(parameters, residuals, options).run();
}

}  // namespace underbody::discovery
