#include "surrogates/discovery/watch/watch_residuals.h"

#include <algorithm>
#include <cmath>

#include "core/normal.h"

namespace underbody::discovery {

namespace {

constexpr double median_step = 1.03;  ///< of the stochastic search of the median

constexpr std::size_t settle_steps = 25;  ///< not judged at the begin and after a silence
constexpr std::size_t first_steps = 3;    ///< after a begin: the reading it began with may have been wild
constexpr std::size_t most_restarts = 3;
constexpr std::size_t kick_steps = 60;   ///< in which a lost input shows: what it did to a slow body grows with time
constexpr std::size_t kick_settle = 20;  ///< not judged after one that did
constexpr double kick_shows = 2.5;       ///< deviations from none
constexpr double kick_limit = 2;         ///< of what one reading may say of it: a wild one alone shows none
constexpr double most_unjudged = 0.5;    ///< steps after lost inputs, as a share of all
constexpr double lost_memory = 500;      ///< steps
constexpr double longest_bridge = 3.5;   ///< usual steps whose input was lost too: the state is found anew as well
constexpr double silence = 1;            ///< s without a reading: the state is found anew
constexpr double gate = 4.5;             ///< beyond it one reading is wild ...
constexpr std::size_t most_wild = 4;     ///< ... and so many in a row are no accident
constexpr double jump_lasts = 1;         ///< s of readings beyond the gate, and at least ...
constexpr double jump_readings = 10;     ///< ... so many, that are no burst of wild ones
constexpr double limit = 3;              ///< of what one reading may say
constexpr double least_left = 0.02;      ///< one less the sum of a colour's coefficients
constexpr double uneven = 1.5;           ///< of the usual step: the colour's past is not known then

}  // namespace

void WatchDoubts::begin(std::size_t count) {
    response_.setZero();
    spread_.setZero();
    spread_.diagonal().head(static_cast<Eigen::Index>(count)).setOnes();
}

double WatchDoubts::widened(const WatchInnovation& innovation, double white) const {
    const Eigen::Map<const Numbers> slope(innovation.doubt.data());
    return std::sqrt(1 + slope.dot(spread_ * slope) / white);
}

WatchInnovation WatchDoubts::with_errors(const WatchInnovation& innovation, double white) const {
    const Eigen::Map<const Numbers> slope(innovation.doubt.data());
    const double wider = widened(innovation, white);
    WatchInnovation out = innovation;
    out.normal = innovation.normal / wider;
    for (std::size_t j = 0; j < watch_directions; ++j) {
        out.slope[j] = (innovation.slope[j] - slope.dot(response_.col(static_cast<Eigen::Index>(j)))) / wider;
    }
    out.kick = innovation.kick / wider;
    return out;
}

WatchDoubts::Numbers WatchDoubts::learn(const WatchInnovation& innovation, double white) {
    const Eigen::Map<const Numbers> slope(innovation.doubt.data());
    const Numbers seen = spread_ * slope, gain = seen / (white + slope.dot(seen));
    for (std::size_t j = 0; j < watch_directions; ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        response_.col(column) += gain * (innovation.slope[j] - slope.dot(response_.col(column)));
    }
    spread_ -= gain * seen.transpose();
    return gain * innovation.normal;
}

void WatchResiduals::set_doubted(std::vector<WatchPlant> plants) {
    if (plants.size() != filter_.doubts()) {
        doubts_.begin(plants.size());
    }
    filter_.set_doubted(std::move(plants));
}

double WatchResiduals::white(std::size_t sensor) const {
    const WatchColour& colour = sensors_[sensor].colour;
    double left = 1;
    for (const double phi : colour.phi) {
        left -= phi;
    }
    const double scale = colour.scale / std::max(left, least_left);
    return scale * scale;
}

void WatchResiduals::set_colours(const std::array<WatchColour, 2>& colours) {
    for (std::size_t s = 0; s < 2; ++s) {
        sensors_[s].colour = colours[s];
    }
}

std::optional<WatchResidual> WatchResiduals::judge(std::size_t index, const WatchInnovation& of_filter) {
    Sensor& sensor = sensors_[index];
    const double wider = doubts_.widened(of_filter, white(index));
    const WatchInnovation innovation = doubts_.with_errors(of_filter, white(index));
    WatchColour& colour = sensor.colour;
    WatchInnovation expected;
    for (std::size_t k = 0; k < WatchColour::order; ++k) {
        expected.normal += colour.phi[k] * sensor.past[k].normal;
        for (std::size_t j = 0; j < watch_directions; ++j) {
            expected.slope[j] += colour.phi[k] * sensor.past[k].slope[j];
        }
        expected.kick += colour.phi[k] * sensor.past[k].kick;
    }
    const double value = (innovation.normal - expected.normal) / colour.scale;
    const bool wild =
        std::abs(value) > gate && settling_ + first_steps <= settle_steps && ++sensor.rejected <= most_wild;
    if (index == 0) {
        const bool settled = settling_ == 0 && unjudged_ == 0 && kick_.steps == 0;
        beyond_ = settled && std::abs(value) > gate ? beyond_ + 1 : 0;
        beyond_since_ = beyond_ == 1 ? *time_ : beyond_since_;
        const double needed = std::max(jump_readings, usual_step_ > 0 ? std::ceil(jump_lasts / usual_step_) : 0.0);
        jumped_ = static_cast<double>(beyond_) == needed;
    }
    WatchInnovation used = innovation;
    used.normal = wild ? expected.normal : expected.normal + colour.scale * std::clamp(value, -gate, gate);
    if (likelihood_ != nullptr) {
        likelihood_->normals[index].push_back(innovation.normal);
        likelihood_->log_variances[index] += 2 * std::log(innovation.sigma);
        // a step of the stochastic search of the median
        colour.scale *=
            core::sigma_of_median_distance * std::abs(innovation.normal) > colour.scale ? median_step : 1 / median_step;
    }
    if (wild) {
        used.slope = expected.slope;
        used.kick = expected.kick;
    } else {
        sensor.rejected = std::abs(value) > gate ? sensor.rejected : 0;
        const bool whole = settling_ + first_steps > settle_steps;
        WatchInnovation taken = of_filter;
        taken.normal += whole ? 0 : wider * (used.normal - innovation.normal);
        filter_.absorb(of_filter, taken.normal);
        filter_.move_numbers(doubts_.learn(taken, white(index)));
    }
    std::rotate(sensor.past.begin(), sensor.past.end() - 1, sensor.past.end());
    sensor.past[0] = used;
    look_for_kick(value, (innovation.kick - expected.kick) / colour.scale);
    if (wild || settling_ > 0 || unjudged_ > 0 || sensor.unsettled > 0) {
        sensor.unsettled -= sensor.unsettled > 0 ? 1 : 0;
        return {};
    }
    WatchResidual out{std::clamp(value, -limit, limit), {}};
    for (std::size_t j = 0; j < watch_directions; ++j) {
        out.slope[j] = (innovation.slope[j] - expected.slope[j]) / colour.scale;
    }
    return out;
}

void WatchResiduals::look_for_kick(double value, double slope) {
    if (kick_.steps == 0) {
        return;
    }
    kick_.score += slope * std::clamp(value, -kick_limit, kick_limit);
    kick_.information += slope * slope;
    // Taken always, it would make the filter follow the noise, and scores along the motion would have a mean.
    if (std::abs(kick_.score) > kick_shows * std::sqrt(kick_.information + 1)) {
        take_kick();
        unjudged_ = std::max(unjudged_, kick_settle);
    }
}

void WatchResiduals::take_kick() {
    const double sure = kick_.information + 1, size = kick_.score / sure;
    filter_.take_kick(size, std::sqrt(size * size + 1 / sure));  // limited readings show less of it than was there
    kick_ = {};
}

void WatchResiduals::restart(const WatchStep& step) {
    filter_.restart(step.time, step.gap);
    doubts_.restart();
    settling_ = settle_steps;
    kick_ = {};
    unjudged_ = 0;
    for (Sensor& sensor : sensors_) {
        sensor.past = {};
        sensor.rejected = 0;
    }
}

/// Looks whether the state is another than was thought, before the reading is judged.
WatchInnovation WatchResiduals::gap_innovation(const WatchStep& step) {
    const WatchInnovation innovation = filter_.gap_innovation(step);
    const double size = std::abs(doubts_.with_errors(innovation, white(0)).normal) / sensors_[0].colour.scale;
    const bool just_begun = settling_ + first_steps > settle_steps;
    if (size > gate && restarts_ < most_restarts &&
        (just_begun || (settling_ + unjudged_ > 0 && sensors_[0].rejected >= most_wild))) {
        ++restarts_;
        restart(step);
        return filter_.gap_innovation(step);
    }
    return innovation;
}

std::array<std::optional<WatchResidual>, 2> WatchResiduals::take(const WatchStep& step) {
    jumped_ = false;
    const bool lost = step.unknown_input > 0 && step.unknown_for > longest_bridge * usual_step_;
    if (!time_ || lost || step.time - *time_ > silence) {
        if (!std::isfinite(step.gap)) {
            return {};
        }
        restarts_ = 0;
        restart(step);
    } else {
        const double dt = step.time - *time_;
        follow_step(usual_step_, dt);
        if (dt > uneven * usual_step_) {
            for (Sensor& sensor : sensors_) {
                sensor.past = {};
                sensor.unsettled = sensor.colour.white() ? 0 : WatchColour::order;
            }
        }
    }
    const bool kicked = step.unknown_input > 0 && !lost && time_ && step.time - *time_ <= silence;
    if (kicked) {
        if (kick_.steps > 0) {
            take_kick();  // another one comes before it is clear what this one did
        }
        kick_ = {kick_steps, 0, 0};
        // what a lost input did is none of what the model lacks; where many are lost, something has to be judged
        const double often = std::max(lost_share_, 1e-3);
        unjudged_ = std::max(unjudged_, std::min(kick_steps, static_cast<std::size_t>(most_unjudged / often)));
    }
    lost_share_ += ((step.unknown_input > 0 ? 1 : 0) - lost_share_) / lost_memory;
    time_ = step.time;
    filter_.advance(step);
    if (kicked) {
        filter_.follow_kick(step.unknown_input, step.unknown_for);
    }
    std::array<std::optional<WatchResidual>, 2> out;
    if (std::isfinite(step.gap)) {
        out[0] = judge(0, gap_innovation(step));
    }
    if (std::isfinite(step.velocity)) {
        out[1] = judge(1, filter_.velocity_innovation(step));
    }
    settling_ -= settling_ > 0 ? 1 : 0;
    unjudged_ -= unjudged_ > 0 ? 1 : 0;
    kick_.steps -= kick_.steps > 0 ? 1 : 0;
    restarts_ = settling_ + unjudged_ > 0 ? restarts_ : 0;
    return out;
}

}  // namespace underbody::discovery
