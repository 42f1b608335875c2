// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "cases/region_model.h"
#include "studio/desktop/region_known.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/simulate/feedback.h"
#include "surrogates/dynamics/basin/region.h"
// clang-format on

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QSplitter>
#include <algorithm>
#include <cmath>

#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/map_number.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/region_axes.h"
#include "studio/desktop/region_panel.h"
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {

QString summary(const dynamics::StabilityRegion& region) {
    QString text = "<table cellspacing=0 cellpadding=2>";
    for (const auto& end : region.classes) {
        QString name = qt(end.name);
        if (std::isfinite(end.gap)) {
            name += QString(" at %1 mm").arg(map_number(1000 * end.gap, 3));
        }
        text +=
            QString("<tr><td>%1</td><td align=right>&nbsp;%2 %</td></tr>").arg(name, map_number(100 * end.fraction, 3));
    }
    text += "</table>";
    if (region.outside_fraction > 0) {
        text += QString(
                    "<p>%1 % of the starts lie outside the range of the force tables, which hold their end values "
                    "there.</p>")
                    .arg(map_number(100 * region.outside_fraction, 3));
    }
    if (region.path_outside_fraction > 0) {
        text += QString("<p>%1 % of the motions are at some time outside the range of the force tables.</p>")
                    .arg(map_number(100 * region.path_outside_fraction, 3));
    }
    return text;
}

/// Adds the motion to the map, in the map's units; of each axis what `values_of` it gives.
template <class Values>
void overlay(core::Figure& figure, const dynamics::StabilityRegion& region, const Values& values_of) {
    const std::vector<double> x = values_of(region.axes[0].name), y = values_of(region.axes[1].name);
    if (x.empty() || y.empty()) {
        return;
    }
    const auto to_x = core::conversion(unit_of(region.axes[0].name), figure.x.unit);
    const auto to_y = core::conversion(unit_of(region.axes[1].name), figure.y.unit);
    core::FigureCurve path;
    path.name = "motion from the start";
    path.colour = {20, 20, 20, 170};
    path.width = 0.9;  // one that goes round a hundred times is no black spot
    std::transform(x.begin(), x.end(), std::back_inserter(path.x), to_x);
    std::transform(y.begin(), y.end(), std::back_inserter(path.y), to_y);
    core::FigurePoints start{
        "start", {path.x.front()}, {path.y.front()}, {}, {20, 20, 20, 255}, core::FigurePoints::Shape::diamond, 10};
    figure.curves.push_back(std::move(path));
    figure.points.push_back(std::move(start));
}

/// One map of a kind at a time.
QString slot_of(const std::string& kind) { return "region " + qt(kind); }

}  // namespace

void RegionPanel::forget(const std::string& kind) {
    about_of_.erase(kind);
    if (kind == "probability") {
        probability_.reset();
    } else if (kind == "sweep") {
        sweep_.reset();
    } else if (kind == "estimator") {
        known_.reset();
    } else {
        region_.reset();
        trajectory_.reset();
        pitch_trajectory_.reset();
        motion_of_.clear();
    }
}

/// Throws core::UsageError where gains of the pitch are given for a map in heave.
void RegionPanel::close_loop(dynamics::RegionOptions& options) const {
    const std::string& gains = settings().feedback;
    if (!gains.empty() && pitches()) {
        options.pitch_feedback = std::make_shared<dynamics::PitchFeedback>(dynamics::pitch_feedback(gains));
    } else if (!gains.empty()) {
        options.feedback = std::make_shared<dynamics::HeaveFeedback>(dynamics::heave_feedback(gains));
    }
}

void RegionPanel::say_about(const std::string& kind, const QString& text) {
    about_of_[kind] = text;
    about_->setText(about_of_[settings().show]);
}

void RegionPanel::compute() {
    const auto shown = kinds();
    for (const char* kind : {"ends", "probability", "sweep", "estimator"}) {
        if (map_of_.contains(kind) && std::find(shown.begin(), shown.end(), kind) == shown.end()) {
            map_of_.erase(kind);
            jobs_.cancel(slot_of(kind));
            forget(kind);
        }
    }
    about_->setText(about_of_[settings().show]);
    if (!region_) {
        motion_->show_text("Click a start in a map of where starts end to see its motion");
    }
    for (const auto& kind : shown) {
        if (map_of_[kind] == map_key(kind)) {
            if (kind == "estimator" && known_) {  // the same map, perhaps on another scale
                show_known();
            }
            continue;
        }
        map_of_[kind] = map_key(kind);
        forget(kind);
        about_->setText(about_of_[settings().show]);
        dynamics::RegionOptions options = cases::region_options(spec_);
        options.axes = axes();
        options.gap_by_ratio = by_ratio();
        options.columns = options.rows = static_cast<std::size_t>(settings().cells);
        options.duration = duration();
        try {
            close_loop(options);
        } catch (const core::Error& error) {
            map(kind).show_text(qt(error.what()));
            continue;
        }
        if (kind == "probability") {
            compute_probability(options);
        } else if (kind == "sweep") {
            compute_sweep(options);
        } else if (kind == "estimator") {
            compute_estimator();
        } else {
            motion_->show_text("Click a start in a map of where starts end to see its motion");
            compute_map(options);
        }
    }
}

void RegionPanel::compute_map(const dynamics::RegionOptions& options) {
    jobs_.start(
        slot_of("ends"), "stability map",
        [this, model = changed_model(), options, key = map_of_["ends"]](core::Progress& progress) {
            auto region =
                std::make_shared<const dynamics::StabilityRegion>(dynamics::stability_region(model, options, progress));
            return [this, region, key] {
                if (key == map_of_["ends"]) {
                    region_ = region;
                    show_region();
                    compute_motion();
                }
            };
        },
        false, [this] { say_when_nothing("ends"); });
}

void RegionPanel::say_when_nothing(const std::string& kind) {
    const bool there = kind == "probability" ? probability_ != nullptr
                       : kind == "sweep"     ? sweep_ != nullptr
                       : kind == "estimator" ? known_ != nullptr
                                             : region_ != nullptr;
    if (!there && map_of_.contains(kind) && !jobs_.busy(slot_of(kind))) {
        map(kind).show_text("There is no map: what is missing stands under Problems");
    }
}

/// Draws of the tables are many maps: at most 80 starts a side.
void RegionPanel::compute_probability(const dynamics::RegionOptions& wanted) {
    dynamics::RegionOptions options = wanted;
    options.columns = options.rows = std::min<std::size_t>(wanted.rows, 80);
    options.refine = false;
    map("probability").show_text("…");
    jobs_.start(
        slot_of("probability"), "chance of a safe end",
        [this, model = changed_model(), options, draws = static_cast<std::size_t>(settings().draws),
         key = map_of_["probability"]](core::Progress& progress) {
            auto found = std::make_shared<const dynamics::ProbabilityMap>(
                dynamics::probability_map(model, options, draws, 1, progress));
            return [this, found, key] {
                if (key == map_of_["probability"]) {
                    probability_ = found;
                    say_about("probability",
                              QString("%1 ± %2 % of the starts end well, over %3 draws of the tables.")
                                  .arg(map_number(100 * found->area_mean, 3), map_number(100 * found->area_sigma, 2))
                                  .arg(found->draws));
                    for (const auto& remark : found->remarks) {
                        Q_EMIT problem(remark);
                    }
                    show_map("probability", dynamics::probability_figure(*found));
                }
            };
        },
        false, [this] { say_when_nothing("probability"); });
}

void RegionPanel::compute_sweep(const dynamics::RegionOptions& wanted) {
    if (settings().sweep.empty()) {
        jobs_.cancel(slot_of("sweep"));
        map("sweep").show_text("Name the condition that is swept, such as speed=0.3:0.7");
        return;
    }
    dynamics::RegionOptions options = wanted;
    options.columns = options.rows = std::min<std::size_t>(wanted.rows, 120);
    options.gap_by_ratio = false;  // shares of the area are drawn, not the maps
    const core::NamedRange range = core::parse_ranges(settings().sweep).front();
    map("sweep").show_text("…");
    jobs_.start(
        slot_of("sweep"), "stability maps over " + qt(range.name),
        [this, model = changed_model(), options, range, steps = static_cast<std::size_t>(settings().steps),
         key = map_of_["sweep"]](core::Progress& progress) {
            auto found = std::make_shared<const dynamics::RegionSweep>(
                dynamics::swept_regions(model, options, range, steps, progress));
            return [this, found, key] {
                if (key == map_of_["sweep"]) {
                    sweep_ = found;
                    map("sweep").show_figure(dynamics::sweep_figure(*found), true);
                }
            };
        },
        false, [this] { say_when_nothing("sweep"); });
}

/// What the declared sensors can know along the gap, and how many of the two forces the motion tells apart.
void RegionPanel::compute_estimator() {
    estimator::InformationOptions options;
    options.noise.gap = settings().gap_noise;
    options.noise.velocity = settings().velocity_noise;
    options.noise.drag_relative = settings().drag_error;
    options.drag_prior = settings().drag_error;
    map("estimator").show_text("…");
    jobs_.start(
        slot_of("estimator"), "what the sensors can know",
        [this, model = changed_model(), options, key = map_of_["estimator"]](core::Progress& progress) {
            const auto plant = estimator::separate(model, model.conditions);
            auto known = std::make_shared<KnownAlongGap>();
            known->information = estimator::information_along_gap(plant, options, progress);
            known->observability = estimator::observability_along_gap(plant, known->information.gaps);
            known->remarks = plant.remarks;
            return [this, known, key] {
                if (key == map_of_["estimator"]) {
                    known_ = known;
                    for (const auto& remark : known->remarks) {
                        Q_EMIT problem(remark);
                    }
                    show_known();
                }
            };
        },
        false, [this] { say_when_nothing("estimator"); });
}

void RegionPanel::show_known() {
    const auto& map = known_->information;
    const auto& rank = known_->observability.separate_rank;
    const auto one = std::count(rank.begin(), rank.end(), 1U);
    say_about(
        "estimator",
        QString("Blind, where the least error of the ground force is larger than itself: %1 % of gaps and speeds. "
                "The motion shows one combination of ground force and drag at %2 of %3 gaps; the law of the "
                "drag, known to %4 %, tells them apart.")
            .arg(map_number(100 * map.blind_share, 3))
            .arg(one)
            .arg(rank.size())
            .arg(map_number(100 * settings().drag_error, 3)));
    show_map("estimator", map.figure());
    if (settings().show == "estimator") {
        motion_->show_figure(
            known_->information.along_gap(known_->information.speeds[known_->information.speeds.size() / 2]));
    }
}

void RegionPanel::show_region() {
    say_about("ends", summary(*region_));
    for (const auto& remark : region_->remarks) {
        Q_EMIT problem(remark);
    }
    core::Figure figure = dynamics::region_figure(*region_);
    if (trajectory_) {
        overlay(figure, *region_, [this](const std::string& axis) {
            return axis == "gap" ? trajectory_->gap : trajectory_->heave_velocity;
        });
    } else if (pitch_trajectory_) {
        overlay(figure, *region_, [this](const std::string& axis) {
            std::vector<double> values;
            for (const auto& state : pitch_trajectory_->state) {
                values.push_back(state[place_of(axis)]);
            }
            return values;
        });
    }
    show_map("ends", std::move(figure));
}

void RegionPanel::show_map(const std::string& kind, core::Figure figure) {
    bool can = false, is = false;
    for (core::FigureAxis* axis : {&figure.x, &figure.y}) {
        if (axis->label == "gap" && axis->lower > 0 && axis->upper > axis->lower) {
            can = true;
            is = axis->logarithmic = settings().logarithmic.value_or(tables::spans_decades(axis->lower, axis->upper));
        }
    }
    logarithmic_->setEnabled(can);
    logarithmic_->setChecked(is);
    map(kind).show_figure(figure, true);
}

bool RegionPanel::has_picture() const {
    const auto first = maps_.find(settings().show);
    return first != maps_.end() && first->second->has_figure();
}

void RegionPanel::export_picture(const std::filesystem::path& path) { maps_.at(settings().show)->write(path); }

bool RegionPanel::has_table() const {
    return trajectory_ != nullptr || pitch_trajectory_ != nullptr || known_ != nullptr;
}

void RegionPanel::export_table(const std::filesystem::path& path) {
    if (known_) {
        core::write_csv(path, known_->information.table());
        return;
    }
    core::Table table = trajectory_ ? trajectory_->table() : pitch_trajectory_->table();
    table.comments.push_back("motion in the study's region '" + spec_.name +
                             "', end: " + (trajectory_ ? trajectory_->end : pitch_trajectory_->end));
    core::write_csv(path, table);
}

}  // namespace underbody::studio
