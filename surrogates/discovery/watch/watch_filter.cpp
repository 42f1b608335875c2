#include "surrogates/discovery/watch/watch_filter.h"

#include <algorithm>
#include <cmath>

#include "surrogates/dynamics/simulate/sensor_noise.h"

namespace underbody::discovery {

namespace {

constexpr double longest_step = 0.05;   ///< s, of the integrator
constexpr double shortest_step = 1e-4;  ///< s
constexpr double series_holds = 0.5;    ///< of step times stiffness: the series of the matrix exponential is cut
constexpr double motion_width = 2e-3;   ///< m/s: below this a direction of motion is no direction
constexpr double unknown_gap = 1e-2, unknown_velocity = 0.1;  ///< m, m/s: what is known of a state at the begin
constexpr double middle_time = 30;                            ///< s, over which the middle of the gaps is taken

}  // namespace

double moved_by_its_error(const dynamics::EffectUse& use, std::size_t parameter) {
    const dynamics::EffectParameter& bounds = dynamics::effect(use.name).info().parameters[parameter];
    const double value = use.values[parameter], sigma = use.sigmas[parameter];
    if (value + sigma <= bounds.upper) {
        return value + sigma;
    }
    if (value - sigma >= bounds.lower) {
        return value - sigma;
    }
    return bounds.upper - value > value - bounds.lower ? bounds.upper : bounds.lower;
}

WatchFilter::WatchFilter(std::shared_ptr<const dynamics::HeavePlant> plant, HeaveNoise noise)
    : plant_(std::move(plant)), noise_(noise) {}

void WatchFilter::restart(double time, double gap) {
    time_ = time;
    state_ = {gap - plant_->terms.sensor_offset(time), 0, 0};
    middle_ = state_[0];
    spread_.setZero();
    spread_.diagonal() << unknown_gap * unknown_gap, unknown_velocity * unknown_velocity, noise_.slow * noise_.slow;
    deviations_.fill(Eigen::Vector3d::Zero());
    doubt_deviations_.fill(Eigen::Vector3d::Zero());
    kick_.setZero();
    memory_ = {};
}

/// The step of discovery's filter (short_step()), with what forces and numbers that the model lacks do beside it.
void WatchFilter::advance_part(double rest, double input) {
    while (rest > dynamics::same_instant) {
        double& h = state_[0];
        double& w = state_[1];
        dynamics::HeaveSlopes slopes;
        const double* memory = plant_->terms.history != 0 ? memory_.data() : nullptr;
        const dynamics::HeaveMoment now{time_, input, nullptr, nullptr, spread_(1, 1)};
        const double declared = plant_->acceleration(h, w, now, memory, slopes);
        std::array<double, most_doubts> push_of_doubt{};
        double a = declared;
        for (std::size_t k = 0; k < doubted_.size(); ++k) {
            dynamics::HeaveSlopes unused;
            push_of_doubt[k] = doubted_[k]->acceleration(h, w, now, memory, unused) - declared;
            a += moved_[k] * push_of_doubt[k];
        }
        const double stiffness = stiffness_of(slopes);
        double dt = std::min(rest, longest_step);
        if (stiffness * dt > series_holds) {
            dt = std::min(rest, std::max(series_holds / stiffness, shortest_step));
        }
        const double along[watch_directions] = {1, w, std::tanh(w / motion_width), h - middle_, input};
        const double before = w, q = 0.5 * dt * dt;
        const HeaveTransition over = short_step(dt, a, slopes, h, w);
        Eigen::Matrix3d f = Eigen::Matrix3d::Zero();
        f.topLeftCorner<2, 2>() << over.hh, over.hw, over.wh, over.ww;
        f(2, 2) = noise_.slow > 0 ? std::exp(-dt / noise_.slow_time) : 0;
        for (std::size_t j = 0; j < watch_directions; ++j) {
            const double push = along[j] / slopes.mass;
            deviations_[j] = f * deviations_[j] + Eigen::Vector3d(q * push, dt * push, 0);
        }
        for (std::size_t k = 0; k < doubted_.size(); ++k) {
            doubt_deviations_[k] =
                f * doubt_deviations_[k] + Eigen::Vector3d(q * push_of_doubt[k], dt * push_of_doubt[k], 0);
        }
        kick_ = f * kick_;
        state_[2] *= f(2, 2);
        for (std::size_t i = 0; memory != nullptr && i < memory_.size(); ++i) {
            memory_[i] = (before + memory_[i]) * std::exp(-dynamics::history_kernel().rate[i] * dt) - before;
        }
        spread_ = f * spread_ * f.transpose();
        spread_(0, 0) += noise_.process * dt * dt * dt / 3;
        spread_(0, 1) += noise_.process * q;
        spread_(1, 0) += noise_.process * q;
        spread_(1, 1) += noise_.process * dt;
        spread_(2, 2) += noise_.slow * noise_.slow * (1 - f(2, 2) * f(2, 2));
        if (h < plant_->contact_gap()) {
            h = plant_->contact_gap();
            w = std::max(w, 0.0);
        }
        middle_ += (h - middle_) * std::min(1.0, dt / middle_time);
        time_ += dt;
        rest -= dt;
    }
}

void WatchFilter::move_numbers(const Eigen::Matrix<double, most_doubts, 1>& by) {
    for (std::size_t k = 0; k < doubted_.size(); ++k) {
        const double change = by[static_cast<Eigen::Index>(k)];
        moved_[k] += change;
        state_ += change * doubt_deviations_[k];
    }
}

void WatchFilter::advance(const WatchStep& step) {
    advance_part(step.time - time_, step.input);
    time_ = step.time;
}

void WatchFilter::follow_kick(double input, double lasted) {
    dynamics::HeaveSlopes slopes;
    plant_->acceleration(state_[0], state_[1], {time_, 0, nullptr, nullptr, 0}, nullptr, slopes);
    const double speed = input * lasted / slopes.mass;
    kick_ << 0.5 * speed * lasted, speed, 0;
}

void WatchFilter::take_kick(double size, double error) {
    state_ += size * kick_;
    spread_ += error * error * kick_ * kick_.transpose();
    for (double& memory : memory_) {
        memory -= size * kick_[1];
    }
    kick_.setZero();
}

WatchInnovation WatchFilter::innovation(double residual, const Eigen::Vector3d& row, double variance) const {
    WatchInnovation out;
    const Eigen::Vector3d seen = spread_ * row;
    out.sigma = std::sqrt(row.dot(seen) + variance);
    out.normal = residual / out.sigma;
    out.variance = variance;
    out.gain = seen / out.sigma;
    out.shown = row;
    for (std::size_t j = 0; j < watch_directions; ++j) {
        out.slope[j] = row.dot(deviations_[j]) / out.sigma;
    }
    for (std::size_t k = 0; k < doubted_.size(); ++k) {
        out.doubt[k] = row.dot(doubt_deviations_[k]) / out.sigma;
    }
    out.kick = row.dot(kick_) / out.sigma;
    return out;
}

WatchInnovation WatchFilter::gap_innovation(const WatchStep& step) const {
    const double sigma = noise_.gap * step.gap_share, declared = plant_->terms.sensor_offset(step.time);
    std::array<double, most_doubts> shown_by_doubt{};
    double offset = declared, delay = plant_->terms.sensor_delay;
    for (std::size_t k = 0; k < doubted_.size(); ++k) {
        const dynamics::HeaveTerms& terms = doubted_[k]->terms;
        const double higher = terms.sensor_offset(step.time) - declared;
        const double later = terms.sensor_delay - plant_->terms.sensor_delay;
        shown_by_doubt[k] = higher - later * state_[1];
        offset += moved_[k] * higher;
        delay += moved_[k] * later;
    }
    const Eigen::Vector3d row(1, -delay, 1);
    WatchInnovation out = innovation(step.gap - offset - row.dot(state_), row, sigma * sigma);
    for (std::size_t k = 0; k < doubted_.size(); ++k) {
        out.doubt[k] += shown_by_doubt[k] / out.sigma;
    }
    return out;
}

WatchInnovation WatchFilter::velocity_innovation(const WatchStep& step) const {
    const double sigma = noise_.velocity * step.velocity_share;
    return innovation(step.velocity - state_[1], Eigen::Vector3d(0, 1, 0), sigma * sigma);
}

void WatchFilter::absorb(const WatchInnovation& innovation, double normal) {
    for (std::size_t j = 0; j < watch_directions; ++j) {
        deviations_[j] -= innovation.gain * innovation.slope[j];
    }
    for (std::size_t k = 0; k < doubted_.size(); ++k) {
        doubt_deviations_[k] -= innovation.gain * innovation.doubt[k];
    }
    kick_ -= innovation.gain * innovation.kick;
    state_ += innovation.gain * normal;
    for (double& memory : memory_) {
        memory -= innovation.gain[1] * normal;
    }
    // Joseph's form: keeps its sign where a reading is much surer than the state
    const Eigen::Vector3d gain = innovation.gain / innovation.sigma;
    const Eigen::Matrix3d left = Eigen::Matrix3d::Identity() - gain * innovation.shown.transpose();
    spread_ = left * spread_ * left.transpose() + innovation.variance * gain * gain.transpose();
}

}  // namespace underbody::discovery
