// Stability: the motion from a start that is clicked.
// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "cases/region_model.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/simulate/heave_pitch.h"
#include "surrogates/dynamics/basin/region.h"
// clang-format on

#include <array>
#include <cmath>

#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/map_number.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/region_axes.h"
#include "studio/desktop/region_panel.h"

namespace underbody::studio {

namespace {

/// Of a motion that is drawn: until it touches, or leaves the map.
dynamics::TrajectoryOptions motion_options(double duration, double escape_gap) {
    dynamics::TrajectoryOptions options;
    options.duration = duration;
    options.output_step = duration / 3000;
    options.escape_gap = escape_gap;
    options.stop_at_contact = true;
    return options;
}

}  // namespace

/// The motion is always that of the model and the start that stand in the state.
void RegionPanel::compute_motion() {
    if (motion_of_ == motion_key() || !region_) {
        return;
    }
    motion_of_ = motion_key();
    trajectory_.reset();
    pitch_trajectory_.reset();
    jobs_.cancel("trajectory");
    if (pitches() && !settings().start_of.empty() && has_motions()) {
        compute_pitch_motion();
        return;
    }
    if (pitches() || !settings().start || !has_motions()) {
        motion_->show_text(has_motions() ? "Click a start in the map to see its motion"
                                         : "Motions start at a gap: take it as an axis of the map");
        show_region();
        return;
    }
    motion_->show_text("…");
    const dynamics::TrajectoryOptions options = motion_options(duration(), region_->escape_gap);
    jobs_.start("trajectory", "motion",
                [this, model = changed_model(), start = *settings().start, options, gains = settings().feedback,
                 key = motion_of_](core::Progress& progress) {
                    dynamics::InputSignals inputs;
                    inputs.held = model.conditions;
                    const dynamics::HeaveFeedback loop =
                        gains.empty() ? dynamics::HeaveFeedback() : dynamics::heave_feedback(gains);
                    auto trajectory = std::make_shared<const dynamics::Trajectory>(dynamics::simulate(
                        model, start[0], start[1], inputs, options, progress, gains.empty() ? nullptr : &loop));
                    return [this, trajectory, key] {
                        if (key == motion_of_) {
                            trajectory_ = trajectory;
                            show_trajectory();
                        }
                    };
                });
}

void RegionPanel::compute_pitch_motion() {
    motion_->show_text("…");
    const dynamics::TrajectoryOptions options = motion_options(duration(), region_->escape_gap);
    dynamics::PitchState start{};
    for (const auto& [name, value] : settings().start_of) {
        start[place_of(name)] = value;
    }
    jobs_.start("trajectory", "motion",
                [this, model = changed_model(), start, options, gains = settings().feedback,
                 key = motion_of_](core::Progress& progress) {
                    dynamics::HeavePitch plant(model, model.conditions);
                    if (!gains.empty()) {
                        plant.close_loop(dynamics::pitch_feedback(gains));
                    }
                    auto motion = std::make_shared<const dynamics::PitchTrajectory>(
                        dynamics::simulate(plant, start, options, progress));
                    return [this, motion, key] {
                        if (key == motion_of_) {
                            pitch_trajectory_ = motion;
                            show_region();
                            motion_->show_figure(dynamics::trajectory_figure(*motion));
                            Q_EMIT remark("the motion ends by " + qt(motion->end));
                        }
                    };
                });
}

void RegionPanel::start_from(double x, double y) {
    if (!region_) {
        return;
    }
    if (!has_motions()) {
        Q_EMIT remark("motions start at a gap: take it as an axis of the map");
        return;
    }
    const core::Figure figure = dynamics::region_figure(*region_);
    const std::array<std::string, 2> names = {region_->axes[0].name, region_->axes[1].name};
    const std::array<double, 2> at = {core::convert(x, figure.x.unit, unit_of(names[0])),
                                      core::convert(y, figure.y.unit, unit_of(names[1]))};
    if (pitches()) {
        act("start=" + names[0] + "=" + core::format_number(at[0]) + "," + names[1] + "=" + core::format_number(at[1]));
        return;
    }
    const bool first = names[0] == "gap";
    act("start=" + core::format_number(at[first ? 0 : 1]) + "m," + core::format_number(at[first ? 1 : 0]) + "m/s");
}

void RegionPanel::show_trajectory() {
    show_region();
    motion_->show_figure(dynamics::trajectory_figure(*trajectory_, region_->equilibria));
    const QString time = trajectory_->time.empty() ? QString("–") : map_number(trajectory_->time.back(), 3);
    Q_EMIT remark(QString("from %1 mm, %2 mm/s: %3 after %4 s")
                      .arg(map_number(1000 * trajectory_->gap.front(), 3))
                      .arg(map_number(1000 * trajectory_->heave_velocity.front(), 3))
                      .arg(trajectory_->end == "time" ? QString("still moving") : qt(trajectory_->end))
                      .arg(time));
}

}  // namespace underbody::studio
