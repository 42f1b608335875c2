// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "cases/region_model.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/basin/region.h"
// clang-format on

#include "studio/desktop/region_panel.h"

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QGridLayout>
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
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

RegionPanel::RegionPanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
    setObjectName("stability");
    build();
}

RegionPanel::~RegionPanel() = default;

void RegionPanel::act(const std::string& assignment) {
    if (!spec_.name.empty()) {
        desk_.act({"region", spec_.name, assignment});
    }
}

const RegionView& RegionPanel::settings() const {
    static const RegionView none;
    const auto at = state().regions.find(spec_.name);
    return at == state().regions.end() ? none : at->second;
}

void RegionPanel::say(const QString& text) {
    model_.reset();
    region_.reset();
    probability_.reset();
    sweep_.reset();
    known_.reset();
    trajectory_.reset();
    pitch_trajectory_.reset();
    map_of_.clear();
    about_of_.clear();
    motion_of_.clear();
    about_->clear();
    changes_label_->clear();
    reset_->setEnabled(false);
    place_maps();
    for (const auto& kind : kinds()) {
        map(kind).show_text(text);
    }
    motion_->show_text("Click a start in the map to see its motion");
}

void RegionPanel::draw_again(bool) {
    const QSignalBlocker quiet(choice_), quiet_cells(cells_);
    std::vector<std::string> names;
    choice_->clear();
    for (const auto& region : session().study.regions) {
        names.push_back(region.name);
        choice_->addItem(qt(region.name));
    }
    const std::string name = state().current("region", names);
    if (name.empty()) {
        spec_ = {};
        say(desk_.has_study() ? "This study has no stability regions" : "Open a study with a stability region");
        return;
    }
    choice_->setCurrentText(qt(name));
    const bool other = spec_.name != name || read_ != desk_.session_pointer();
    spec_ = *std::find_if(session().study.regions.begin(), session().study.regions.end(),
                          [&](const auto& region) { return region.name == name; });
    cells_->setValue(settings().cells);
    duration_->show_number(duration());
    fill_kinds();
    place_maps();
    const bool ready = std::all_of(spec_.forces.begin(), spec_.forces.end(), [&](const std::string& force) {
        return cases::has_loads(*session().study.find_table(force), session().results);
    });
    if (!ready) {
        say("The loads of this study are not computed yet: Study > Compute what changed (Ctrl+R)");
    } else if (other || !model_) {
        read_model();
    } else {
        fill_parameters();
        compute();
        compute_motion();
    }
}

void RegionPanel::read_model() {
    read_ = desk_.session_pointer();
    say("…");
    jobs_.start("region model", "reading the model of " + qt(spec_.name),
                [this, spec = spec_, session = read_](core::Progress&) {
                    auto model = std::make_shared<const dynamics::Model>(
                        cases::region_model(session->study, spec, session->results));
                    return [this, model, session, name = spec.name] {
                        if (session == read_ && name == spec_.name) {
                            model_ = model;
                            fill_parameters();
                            compute();
                            compute_motion();
                        }
                    };
                });
}

void RegionPanel::fill_parameters() {
    const QSignalBlocker quiet(parameter_);
    const QString kept = parameter_->currentData().toString();
    parameter_->clear();
    for (const auto& parameter : model_->parameters()) {
        parameter_->addItem(qt(parameter.name), qt(parameter.name));
        parameter_->setItemData(parameter_->count() - 1, qt(parameter.meaning), Qt::ToolTipRole);
    }
    const int at = parameter_->findData(kept.isEmpty() ? "vehicle.net_weight" : kept);
    parameter_->setCurrentIndex(at >= 0 ? at : 0);
    show_parameter();
}

void RegionPanel::show_parameter() {
    if (!model_) {
        return;
    }
    const std::string name = parameter_->currentData().toString().toStdString();
    for (const auto& parameter : model_->parameters()) {
        if (parameter.name != name) {
            continue;
        }
        const auto at = settings().set.find(name);
        const bool plain = parameter.unit.empty() || !core::is_unit(parameter.unit);
        // A field for the unit of this number.
        auto* field = new NumberEdit(plain ? "1" : parameter.unit, plain ? "1" : parameter.unit);
        field->setAccessibleName(parameter_->currentText());
        field->show_number(at != settings().set.end() ? at->second : parameter.value);
        field->setToolTip(qt(parameter.meaning) + QString("\ndeclared: %1, between %2 and %3")
                                                      .arg(map_number(parameter.value))
                                                      .arg(map_number(parameter.lower))
                                                      .arg(map_number(parameter.upper)));
        connect(field, &NumberEdit::entered, this, [this, name, parameter](double value) {
            if (value >= parameter.lower && value <= parameter.upper) {
                act("set." + name + "=" + core::format_number(value));
            } else {
                Q_EMIT remark(QString("%1 lies between %2 and %3")
                                  .arg(qt(name), map_number(parameter.lower), map_number(parameter.upper)));
                show_parameter();
            }
        });
        form_->replaceWidget(value_, field);
        value_->deleteLater();
        value_ = field;
        QWidget::setTabOrder(parameter_, value_);
    }
    QString text;
    for (const auto& [changed, value] : settings().set) {
        text += QString("%1 = %2 (declared %3)\n")
                    .arg(qt(changed), qt(core::format_number(value, 12)), map_number(model_->parameter(changed)));
    }
    changes_label_->setText(text.trimmed());
    reset_->setEnabled(!settings().set.empty());
}

dynamics::Model RegionPanel::changed_model() const {
    dynamics::Model model = *model_;
    for (const auto& [name, value] : settings().set) {
        model = model.with_parameter(name, value);
    }
    return model.resolved();
}

std::vector<core::NamedRange> RegionPanel::axes() const {
    return settings().axes.empty() ? cases::region_options(spec_).axes : core::parse_ranges(settings().axes);
}

/// Over a logarithmic gap the cells are of equal ratio: of equal width they would be steps at small gaps.
bool RegionPanel::by_ratio() const {
    for (const auto& axis : axes()) {
        if (axis.name == "gap" && axis.lower > 0) {
            return settings().logarithmic.value_or(tables::spans_decades(axis.lower, axis.upper));
        }
    }
    return false;
}

std::string RegionPanel::map_key(const std::string& kind) const {
    const RegionView& view = settings();
    std::string key = spec_.name + " " + std::to_string(view.cells) + " " + core::format_number(duration()) + " " +
                      kind + " " + view.axes + (by_ratio() ? " by ratio" : "");
    key += kind == "sweep"         ? " " + view.sweep + " " + std::to_string(view.steps)
           : kind == "probability" ? " " + std::to_string(view.draws)
           : kind == "estimator"
               ? " " + core::format_number(view.gap_noise) + " " + core::format_number(view.velocity_noise) + " " +
                     core::format_number(view.drag_error)
               : "";
    key += view.feedback.empty() || kind == "estimator" ? "" : " " + view.feedback;
    for (const auto& [name, value] : settings().set) {
        key += " " + name + "=" + core::format_number(value);
    }
    return key;
}

std::string RegionPanel::motion_key() const {
    std::string pitched;
    for (const auto& [name, value] : settings().start_of) {
        pitched += " " + name + "=" + core::format_number(value);
    }
    if (!pitched.empty()) {
        return map_key("ends") + " from" + pitched;
    }
    const auto& start = settings().start;
    return start
               ? map_key("ends") + " from " + core::format_number((*start)[0]) + " " + core::format_number((*start)[1])
               : std::string();
}

void RegionPanel::fill_kinds() {
    const RegionView& view = settings();
    show_->setCurrentIndex(show_->findData(qt(view.show)));
    for (const auto& [field, text] :
         {std::pair{axes_, view.axes}, {sweep_text_, view.sweep}, {feedback_, view.feedback}}) {
        if (!field->isModified()) {
            field->setText(qt(text));
            field->setModified(false);
        }
    }
    axes_->setPlaceholderText(qt(spec_.axes));
    const auto shown = kinds();
    const bool swept = std::find(shown.begin(), shown.end(), "sweep") != shown.end();
    const bool sensed = std::find(shown.begin(), shown.end(), "estimator") != shown.end();
    sweep_text_->setVisible(swept);
    gap_noise_->show_number(view.gap_noise);
    velocity_noise_->show_number(view.velocity_noise);
    drag_error_->show_number(view.drag_error);
    sensors_->setVisible(sensed);
    if (QWidget* label = form_->labelForField(sensors_)) {
        label->setVisible(sensed);
    }
    if (QWidget* label = form_->labelForField(sweep_text_)) {
        label->setVisible(swept);
    }
}

std::vector<std::string> RegionPanel::kinds() const {
    std::vector<std::string> all = {settings().show};
    for (const auto& kind : settings().beside) {
        if (std::find(all.begin(), all.end(), kind) == all.end()) {
            all.push_back(kind);
        }
    }
    return all;
}

PlotView& RegionPanel::map(const std::string& kind) {
    PlotView*& plot = maps_[kind];
    if (plot == nullptr) {
        plot = new PlotView(map_cells_);
        connect(plot, &PlotView::hovered, this, &Panel::remark);
        if (kind == "ends") {
            connect(plot, &PlotView::clicked, this, &RegionPanel::start_from);
        }
    }
    return *plot;
}

void RegionPanel::place_maps() {
    for (const auto& [kind, plot] : maps_) {
        grid_->removeWidget(plot);
        plot->hide();
    }
    int place = 0;
    for (const auto& kind : kinds()) {
        grid_->addWidget(&map(kind), place / 2, place % 2);
        map(kind).show();
        ++place;
    }
    map_cells_->setVisible(shows("map"));
    motion_->setVisible(shows("motion"));
}

std::vector<Panel::View> RegionPanel::views() const {
    std::vector<View> all;
    const auto shown = kinds();
    for (int i = 0; i < show_->count() && !spec_.name.empty(); ++i) {
        const std::string kind = show_->itemData(i).toString().toStdString();
        all.push_back({kind, show_->itemText(i), std::find(shown.begin(), shown.end(), kind) != shown.end()});
    }
    all.push_back({"motion", "motion", shows("motion")});
    return all;
}

void RegionPanel::choose_view(const std::string& name, bool shown) {
    if (name == "motion") {
        desk_.act(shown ? Words{"cells", "stability"} : Words{"cells", "stability", "map"});
        return;
    }
    auto all = kinds();
    std::erase(all, name);
    if (shown) {
        all.push_back(name);
    }
    if (all.empty()) {
        return;  // one stays
    }
    std::string others;
    for (std::size_t i = 1; i < all.size(); ++i) {
        others += (i > 1 ? "," : "") + all[i];
    }
    desk_.act({"region", spec_.name, "show=" + all.front(), "beside=" + others});
}

bool RegionPanel::has_motions() const {
    return region_ &&
           std::any_of(region_->axes.begin(), region_->axes.end(), [](const auto& axis) { return axis.name == "gap"; });
}

bool RegionPanel::pitches() const {
    const auto all = axes();
    return std::any_of(all.begin(), all.end(), [](const auto& axis) { return axis.name.starts_with("pitch"); });
}

}  // namespace underbody::studio
