#include "studio/cli/feedback_options.h"

#include <cmath>

#include "core/text.h"
#include "core/units.h"
#include "studio/cli/shell.h"
#include "surrogates/dynamics/plant/environment.h"

namespace underbody::studio {

namespace {

using dynamics::assign;

void refuse_both(const std::string& feedback, const std::string& lqr) {
    if (!feedback.empty() && !lqr.empty()) {
        throw core::UsageError("range", "--feedback gives the gains, --lqr chooses them: use one");
    }
}

void check_weights(const std::vector<double>& weights) {
    for (const double weight : weights) {
        if (!(weight > 0)) {
            throw core::UsageError("range", "--lqr: weights are positive");
        }
    }
}

}  // namespace

const char* feedback_help() {
    return "close the loop: gap_gain=10,velocity_gain=9,reference=20mm,limit=0.05N; with pitch also pitch_gain, "
           "pitch_rate_gain, pitch_reference, moment_limit (SI or with units)";
}

const char* lqr_help() {
    return "close the loop by LQR about a gap: reference=20mm and weights gap=100,velocity=1,force=1; with pitch also "
           "pitch_reference and weights pitch=10,pitch_rate=0.1,moment=100; limit, moment_limit";
}

std::shared_ptr<dynamics::HeaveFeedback> heave_feedback_of(Shell& shell, const std::string& feedback,
                                                           const std::string& lqr, const dynamics::Model& model,
                                                           const dynamics::Conditions& held) {
    refuse_both(feedback, lqr);
    if (feedback.empty() && lqr.empty()) {
        return nullptr;
    }
    const dynamics::HeavePlant plant(model, held);
    dynamics::HeaveFeedback gains;
    if (!feedback.empty()) {
        gains = dynamics::heave_feedback(feedback);
    } else {
        double reference = std::nan(""), gap = 100, velocity = 1, force = 1, limit = 0;
        assign(lqr, {{"reference", "m", &reference},
                     {"gap", "1", &gap},
                     {"velocity", "1", &velocity},
                     {"force", "1", &force},
                     {"limit", "N", &limit}});
        if (std::isnan(reference)) {
            throw core::UsageError("missing", "--lqr needs the gap to hold: reference=20mm");
        }
        check_weights({gap, velocity, force});
        gains = dynamics::heave_lqr(plant, reference, velocity, gap, force);
        gains.limit = limit;
    }
    if (gains.limit < 0) {
        throw core::UsageError("range", "a limit is not negative");
    }
    shell.show(dynamics::loop_remarks(plant, gains, !lqr.empty()));
    return std::make_shared<dynamics::HeaveFeedback>(gains);
}

std::optional<dynamics::PitchFeedback> pitch_feedback_of(Shell& shell, const std::string& feedback,
                                                         const std::string& lqr, const dynamics::HeavePitch& plant) {
    refuse_both(feedback, lqr);
    if (feedback.empty() && lqr.empty()) {
        return std::nullopt;
    }
    if (!feedback.empty()) {
        const dynamics::PitchFeedback given = dynamics::pitch_feedback(feedback);
        shell.show(dynamics::loop_remarks(plant, given, false));
        return given;
    }
    dynamics::PitchWeights weights;
    double reference = std::nan(""), pitch = 0, limit = 0, moment_limit = 0;
    assign(lqr, {{"reference", "m", &reference},
                 {"pitch_reference", "rad", &pitch},
                 {"gap", "1", weights.state.data()},
                 {"velocity", "1", &weights.state[1]},
                 {"pitch", "1", &weights.state[2]},
                 {"pitch_rate", "1", &weights.state[3]},
                 {"force", "1", &weights.force},
                 {"moment", "1", &weights.moment},
                 {"limit", "N", &limit},
                 {"moment_limit", "N m", &moment_limit}});
    if (std::isnan(reference)) {
        throw core::UsageError("missing", "--lqr needs the gap to hold: reference=20mm");
    }
    check_weights(
        {weights.state[0], weights.state[1], weights.state[2], weights.state[3], weights.force, weights.moment});
    dynamics::PitchFeedback gains = dynamics::pitch_lqr(plant, reference, pitch, weights);
    gains.force_limit = limit;
    gains.moment_limit = moment_limit;
    shell.show(dynamics::loop_remarks(plant, gains, true));
    return gains;
}

dynamics::VehicleHold hold_of(const std::string& text) {
    dynamics::VehicleHold hold;
    double heading = std::nan(""), speed = std::nan(""), gap = std::nan(""), pitch = std::nan("");
    assign(text, {{"heading", "rad", &heading},
                  {"speed", "m/s", &speed},
                  {"gap", "m", &gap},
                  {"pitch", "rad", &pitch},
                  {"heading_gain", "N m/rad", &hold.heading_gain},
                  {"yaw_rate_gain", "N m s/rad", &hold.yaw_rate_gain},
                  {"speed_gain", "N s/m", &hold.speed_gain},
                  {"gap_gain", "N/m", &hold.gap_gain},
                  {"heave_gain", "N s/m", &hold.heave_gain},
                  {"pitch_gain", "N m/rad", &hold.pitch_gain},
                  {"pitch_rate_gain", "N m s/rad", &hold.pitch_rate_gain}});
    const auto given = [](double value) { return std::isnan(value) ? std::nullopt : std::optional<double>(value); };
    hold.heading = given(heading);
    hold.speed = given(speed);
    hold.gap = given(gap);
    hold.pitch = given(pitch);
    return hold;
}

void add_remarks(core::Problems& remarks, const dynamics::Model& model) {
    for (const core::Problem& remark : model.remarks) {
        remarks.push_back(remark);
    }
    for (core::Problem& remark : dynamics::effects_without_motion(model)) {
        remarks.push_back(std::move(remark));
    }
}

}  // namespace underbody::studio
