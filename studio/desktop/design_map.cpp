// Design: the stability map of the shape that is shown, by what is known of its lift.
// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "cases/shape_region.h"
// clang-format on

#include <QLabel>
#include <QTimer>

#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

/// The one that Stability shows.
std::string DesignPanel::region_name() const {
    std::vector<std::string> names;
    for (const auto& region : session().study.regions) {
        names.push_back(region.name);
    }
    return state().current("region", names);
}

QString DesignPanel::no_map() const {
    if (!desk_.has_study()) {
        return "There is no stability map without a study: open one with Ctrl+O";
    }
    if (session().study.regions.empty() && session().study.measurements.empty()) {
        return "There is no stability map: the study declares no vehicle. Write its mass, drag and net weight as "
               "model.toml and name it in a [[region]]";
    }
    if (lift_.basis == cases::KnownLift::Basis::nothing) {
        return "There is no stability map: no lift of a shape like this one is known. Ask for its CFD";
    }
    if (lift_.table != nullptr && session().results.loads.rows() == 0) {
        return "There is no stability map yet: the loads are not computed (Ctrl+R)";
    }
    return {};
}

/// All that the map depends on but the words over it: another shape whose lift is that of the same table has the same.
std::string DesignPanel::map_key() const {
    std::string key = region_name();
    if (const auto view = state().regions.find(key); view != state().regions.end()) {
        for (const auto& [name, value] : view->second.set) {
            key += " " + name + "=" + core::format_number(value);
        }
    }
    const auto weight = net_weight();
    key += weight ? " weight=" + core::format_number(*weight) : "";
    if (lift_.basis != cases::KnownLift::Basis::surrogate) {
        return key + " table=" + (lift_.table == nullptr ? "" : lift_.table->name);
    }
    for (const double number : lift_.design) {
        key += " " + core::format_number(number);
    }
    return key + " pitch=" + core::format_number(state().design.pitch) +
           " speed=" + core::format_number(state().design.speed);
}

void DesignPanel::show_map() {
    const std::string key = map_key();
    const QString why = no_map();
    if (key == map_of_ && mapped_ == desk_.session_pointer() && why.isEmpty()) {
        draw_map();
        return;
    }
    map_of_ = why.isEmpty() ? key : std::string();
    mapped_ = desk_.session_pointer();
    map_.reset();
    map_label_->clear();
    jobs_.cancel("design map");
    map_plot_->show_text(why.isEmpty() ? QString("…") : why);
    if (why.isEmpty()) {
        map_rest_->start();
    } else {
        map_rest_->stop();
    }
}

void DesignPanel::ask_map() {
    if (dragging()) {
        map_rest_->start();
        return;
    }
    cases::ShapeRegion asked;
    asked.lift = lift_;
    asked.net_weight = net_weight();
    asked.pitch = state().design.pitch;
    asked.speed = state().design.speed;
    if (const auto view = state().regions.find(region_name()); view != state().regions.end()) {
        asked.set = view->second.set;
    }
    jobs_.start(
        "design map", "stability map of " + qt(name_),
        [this, asked, region = region_name(), surrogate = surrogate_, session = mapped_,
         key = map_of_](core::Progress& progress) mutable {
            auto map = std::make_shared<ShapeMap>();
            try {
                asked.vehicle = cases::vehicle_of(session->study, region);
                const auto model = cases::shape_model(session->study, session->results, asked, surrogate.get());
                map->vehicle = cases::vehicle_words(asked, model);
                map->region = std::make_shared<const dynamics::StabilityRegion>(
                    dynamics::stability_region(model, cases::shape_region_options(asked, model), progress));
            } catch (const core::InputError& error) {  // said where the map would be: every move would say it again
                map->why = error.message() + (error.hint().empty() ? "" : " (" + error.hint() + ")");
            }
            return [this, map, session, key] {
                if (key == map_of_ && session == mapped_) {
                    map_ = map;
                    draw_map();
                }
            };
        },
        true,
        [this] {
            if (!map_ && !map_of_.empty() && !jobs_.busy("design map") && !map_rest_->isActive()) {
                map_of_.clear();  // cancelled by hand: made with the next change
                map_plot_->show_text("The stability map was not made");
            }
        });
}

void DesignPanel::draw_map() {
    if (!map_) {
        return;
    }
    if (!map_->region) {
        map_plot_->show_text("There is no stability map: " + qt(map_->why));
        return;
    }
    core::Figure figure = cases::shape_region_figure(*map_->region, lift_, map_->vehicle);
    const auto gap = core::convert(state().design.gap, "m", figure.x.unit);
    if (gap > figure.x.lower && gap < figure.x.upper) {
        figure.lines.push_back({true, gap, "gap", {120, 120, 120, 255}, true});
    }
    map_label_->setText("Map: this lift; " + qt(map_->vehicle));
    map_plot_->show_figure(figure, true);
}

}  // namespace underbody::studio
