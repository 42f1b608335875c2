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
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {

QString map_number(double value, int digits = 4) {
    return std::isnan(value) ? QString("–") : qt(core::format_number(value, digits)).replace('-', QChar(0x2212));
}

/// Shares and attractors in words.
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
        text += QString("<p>%1 % of the motions are at some time outside that range.</p>")
                    .arg(map_number(100 * region.path_outside_fraction, 3));
    }
    return text;
}

/// Adds the trajectory to the map, in the map's units.
void overlay(core::Figure& figure, const dynamics::StabilityRegion& region, const dynamics::Trajectory& trajectory) {
    const auto values_of = [&](const std::string& axis) -> const std::vector<double>* {
        return axis == "gap" ? &trajectory.gap : axis == "heave_velocity" ? &trajectory.heave_velocity : nullptr;
    };
    const auto* x = values_of(region.axes[0].name);
    const auto* y = values_of(region.axes[1].name);
    if (x == nullptr || y == nullptr || x->empty()) {
        return;
    }
    const auto to_x = core::conversion(region.axes[0].name == "gap" ? "m" : "m/s", figure.x.unit);
    const auto to_y = core::conversion(region.axes[1].name == "gap" ? "m" : "m/s", figure.y.unit);
    core::FigureCurve path;
    path.name = "motion from the start";
    path.colour = {20, 20, 20, 255};
    path.width = 1.8;
    std::transform(x->begin(), x->end(), std::back_inserter(path.x), to_x);
    std::transform(y->begin(), y->end(), std::back_inserter(path.y), to_y);
    core::FigurePoints start{
        "start", {path.x.front()}, {path.y.front()}, {}, {20, 20, 20, 255}, core::FigurePoints::Shape::diamond, 10};
    figure.curves.push_back(std::move(path));
    figure.points.push_back(std::move(start));
}

}  // namespace

RegionPanel::RegionPanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
    setObjectName("stability");
    build();
}

RegionPanel::~RegionPanel() = default;

void RegionPanel::build() {
    auto* all = new QHBoxLayout(this);
    auto* controls = new QWidget;
    auto* scroll = new QScrollArea;  // also where the window is low
    scroll->setWidget(controls);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setFixedWidth(310);
    auto* left = new QVBoxLayout(controls);
    left->setContentsMargins(0, 0, 0, 0);
    all->addWidget(scroll, 0);
    form_ = new QFormLayout;
    form_->setRowWrapPolicy(QFormLayout::WrapAllRows);
    left->addLayout(form_);
    build_controls(*form_);
    changes_label_ = new QLabel;
    changes_label_->setWordWrap(true);
    left->addWidget(changes_label_);
    reset_ = new QPushButton("As &declared");
    reset_->setToolTip("Forget the changed numbers");
    left->addWidget(reset_);
    about_ = new QLabel;
    about_->setWordWrap(true);
    about_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    left->addWidget(about_);
    left->addStretch(1);

    auto* plots = new QSplitter(Qt::Vertical);
    all->addWidget(plots, 1);
    map_ = new PlotView(this);
    motion_ = new PlotView(this);
    plots->addWidget(map_);
    plots->addWidget(motion_);
    plots->setStretchFactor(0, 3);
    plots->setStretchFactor(1, 2);
    say("Open a study with a stability region");
    connect(map_, &PlotView::hovered, this, &Panel::remark);
    connect(motion_, &PlotView::hovered, this, &Panel::remark);
    connect(map_, &PlotView::clicked, this, &RegionPanel::start_from);
    connect(reset_, &QPushButton::clicked, this, [this] { act("as_declared="); });
}

void RegionPanel::build_controls(QFormLayout& form) {
    choice_ = new QComboBox;
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choice_->setAccessibleName("Region");
    form.addRow("&Region", choice_);
    auto* sizes = new QHBoxLayout;
    cells_ = new QSpinBox;
    cells_->setRange(20, 1000);
    cells_->setSingleStep(50);
    cells_->setKeyboardTracking(false);
    cells_->setSuffix(" starts a side");
    cells_->setAccessibleName("Starts a side");
    duration_ = new NumberEdit("s", "s");
    duration_->setAccessibleName("Time of motion");
    sizes->addWidget(cells_);
    sizes->addWidget(duration_);
    form.addRow("Starts and time", sizes);
    show_ = new QComboBox;
    show_->addItem("where each start ends", "ends");
    show_->addItem("how surely it ends well", "probability");
    show_->addItem("the shares over a condition", "sweep");
    show_->setAccessibleName("Kind of map");
    show_->setToolTip(
        "How surely: the share of draws of the force tables, from their errors, after which a start ends at an "
        "attractor");
    form.addRow("&Map of", show_);
    axes_ = new QLineEdit;
    axes_->setAccessibleName("Axes of the map");
    axes_->setToolTip("Two of gap, heave_velocity, pitch, pitch_rate with their ranges; empty: as the study says");
    form.addRow("A&xes", axes_);
    logarithmic_ = new QCheckBox("lo&garithmic gap");
    form.addRow(logarithmic_);
    connect(logarithmic_, &QCheckBox::clicked, this,
            [this](bool on) { act(on ? "logarithmic=on" : "logarithmic=off"); });
    sweep_text_ = new QLineEdit;
    sweep_text_->setAccessibleName("Condition that is swept");
    sweep_text_->setPlaceholderText("speed=0.3:0.7");
    form.addRow("S&wept condition", sweep_text_);
    parameter_ = new QComboBox;
    parameter_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    parameter_->setToolTip("Any number that the model declares can be changed here; the model file stays as it is");
    parameter_->setAccessibleName("Number of the model");
    form.addRow("&What if", parameter_);
    value_ = new NumberEdit("1", "1");
    value_->setAccessibleName("Value of that number");
    form.addRow("were", value_);
    connect(choice_, QOverload<int>::of(&QComboBox::activated), this, [this] {
        desk_.act({"select", "region/" + choice_->currentText().toStdString()});
    });
    connect(cells_, QOverload<int>::of(&QSpinBox::valueChanged), this,
            [this](int cells) { act("cells=" + std::to_string(cells)); });
    connect(duration_, &NumberEdit::entered, this,
            [this](double value) { act("duration=" + core::format_number(value) + "s"); });
    connect(parameter_, QOverload<int>::of(&QComboBox::activated), this, [this] { show_parameter(); });
    connect(show_, QOverload<int>::of(&QComboBox::activated), this,
            [this] { act("show=" + show_->currentData().toString().toStdString()); });
    const auto text = [this](QLineEdit* field, const char* key) {
        connect(field, &QLineEdit::editingFinished, this, [this, field, key] {
            if (field->isModified()) {
                field->setModified(false);
                act(std::string(key) + "=" + field->text().remove(' ').toStdString());
            }
        });
    };
    text(axes_, "axes");
    text(sweep_text_, "sweep");
}

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
    trajectory_.reset();
    map_of_.clear();
    motion_of_.clear();
    about_->clear();
    changes_label_->clear();
    reset_->setEnabled(false);
    map_->show_text(text);
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
    if (!spec_.forces.empty() && session().results.loads.rows() == 0) {
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

std::string RegionPanel::map_key() const {
    const RegionView& view = settings();
    std::string key = spec_.name + " " + std::to_string(view.cells) + " " + core::format_number(duration()) + " " +
                      view.show + " " + view.axes;
    key += view.show == "sweep"         ? " " + view.sweep + " " + std::to_string(view.steps)
           : view.show == "probability" ? " " + std::to_string(view.draws)
                                        : "";
    for (const auto& [name, value] : settings().set) {
        key += " " + name + "=" + core::format_number(value);
    }
    return key;
}

std::string RegionPanel::motion_key() const {
    const auto& start = settings().start;
    return start ? map_key() + " from " + core::format_number((*start)[0]) + " " + core::format_number((*start)[1])
                 : std::string();
}

void RegionPanel::fill_kinds() {
    const RegionView& view = settings();
    show_->setCurrentIndex(show_->findData(qt(view.show)));
    for (const auto& [field, text] : {std::pair{axes_, view.axes}, {sweep_text_, view.sweep}}) {
        if (!field->isModified()) {
            field->setText(qt(text));
            field->setModified(false);
        }
    }
    axes_->setPlaceholderText(qt(spec_.axes));
    sweep_text_->setEnabled(view.show == "sweep");
    if (QWidget* label = form_->labelForField(sweep_text_)) {
        label->setEnabled(view.show == "sweep");
    }
}

bool RegionPanel::has_motions() const {
    return region_ && region_->axes.size() == 2 && region_->axes[0].name == "gap" &&
           region_->axes[1].name == "heave_velocity";
}

void RegionPanel::compute() {
    if (map_of_ == map_key()) {
        if (region_ && settings().logarithmic != drawn_logarithmic_) {  // the same map on another scale
            show_region();
        } else if (probability_ && settings().logarithmic != drawn_logarithmic_) {
            show_map(dynamics::probability_figure(*probability_));
        }
        return;
    }
    map_of_ = map_key();
    region_.reset();
    probability_.reset();
    sweep_.reset();
    trajectory_.reset();
    motion_of_.clear();
    about_->clear();
    dynamics::RegionOptions options = cases::region_options(spec_);
    if (!settings().axes.empty()) {
        options.axes = core::parse_ranges(settings().axes);
    }
    options.columns = options.rows = static_cast<std::size_t>(settings().cells);
    options.duration = duration();
    motion_->show_text("Click a start in a map of where starts end to see its motion");
    if (settings().show == "probability") {
        compute_probability(options);
    } else if (settings().show == "sweep") {
        compute_sweep(options);
    } else {
        compute_map(options);
    }
}

void RegionPanel::compute_map(const dynamics::RegionOptions& options) {
    jobs_.start(
        "region", "stability map",
        [this, model = changed_model(), options, key = map_of_](core::Progress& progress) {
            auto region =
                std::make_shared<const dynamics::StabilityRegion>(dynamics::stability_region(model, options, progress));
            return [this, region, key] {
                if (key == map_of_) {
                    region_ = region;
                    show_region();
                    compute_motion();
                }
            };
        },
        false, [this] { say_when_nothing(); });
}

/// A map that failed or was cancelled is not waited for.
void RegionPanel::say_when_nothing() {
    if (!region_ && !probability_ && !sweep_ && !jobs_.busy("region")) {
        map_->show_text("There is no map: what is missing stands under Problems");
    }
}

/// Draws of the tables are many maps: at most 80 starts a side.
void RegionPanel::compute_probability(const dynamics::RegionOptions& wanted) {
    dynamics::RegionOptions options = wanted;
    options.columns = options.rows = std::min<std::size_t>(wanted.rows, 80);
    options.refine = false;
    map_->show_text("…");
    jobs_.start(
        "region", "chance of a safe end",
        [this, model = changed_model(), options, draws = static_cast<std::size_t>(settings().draws),
         key = map_of_](core::Progress& progress) {
            auto found = std::make_shared<const dynamics::ProbabilityMap>(
                dynamics::probability_map(model, options, draws, 1, progress));
            return [this, found, key] {
                if (key == map_of_) {
                    probability_ = found;
                    about_->setText(
                        QString("%1 ± %2 % of the starts end well, over %3 draws of the tables.")
                            .arg(map_number(100 * found->area_mean, 3), map_number(100 * found->area_sigma, 2))
                            .arg(found->draws));
                    for (const auto& remark : found->remarks) {
                        Q_EMIT problem(remark);
                    }
                    show_map(dynamics::probability_figure(*found));
                }
            };
        },
        false, [this] { say_when_nothing(); });
}

void RegionPanel::compute_sweep(const dynamics::RegionOptions& wanted) {
    if (settings().sweep.empty()) {
        jobs_.cancel("region");
        map_->show_text("Name the condition that is swept, such as speed=0.3:0.7");
        return;
    }
    dynamics::RegionOptions options = wanted;
    options.columns = options.rows = std::min<std::size_t>(wanted.rows, 120);
    const core::NamedRange range = core::parse_ranges(settings().sweep).front();
    map_->show_text("…");
    jobs_.start(
        "region", "stability maps over " + qt(range.name),
        [this, model = changed_model(), options, range, steps = static_cast<std::size_t>(settings().steps),
         key = map_of_](core::Progress& progress) {
            auto found = std::make_shared<const dynamics::RegionSweep>(
                dynamics::swept_regions(model, options, range, steps, progress));
            return [this, found, key] {
                if (key == map_of_) {
                    sweep_ = found;
                    map_->show_figure(dynamics::sweep_figure(*found), true);
                }
            };
        },
        false, [this] { say_when_nothing(); });
}

/// The motion is always that of the model and the start that stand in the state.
void RegionPanel::compute_motion() {
    if (motion_of_ == motion_key() || !region_) {
        return;
    }
    motion_of_ = motion_key();
    trajectory_.reset();
    jobs_.cancel("trajectory");
    if (!settings().start || !has_motions()) {
        motion_->show_text(has_motions() ? "Click a start in the map to see its motion"
                                         : "Motions are drawn over gap and heave velocity");
        show_region();
        return;
    }
    motion_->show_text("…");
    dynamics::TrajectoryOptions options;
    options.duration = duration();
    options.output_step = options.duration / 3000;
    options.escape_gap = region_->escape_gap;
    options.stop_at_contact = true;
    jobs_.start("trajectory", "motion",
                [this, model = changed_model(), start = *settings().start, options,
                 key = motion_of_](core::Progress& progress) {
                    dynamics::InputSignals inputs;
                    inputs.held = model.conditions;
                    auto trajectory = std::make_shared<const dynamics::Trajectory>(
                        dynamics::simulate(model, start[0], start[1], inputs, options, progress));
                    return [this, trajectory, key] {
                        if (key == motion_of_) {
                            trajectory_ = trajectory;
                            show_trajectory();
                        }
                    };
                });
}

void RegionPanel::show_region() {
    about_->setText(summary(*region_));
    for (const auto& remark : region_->remarks) {
        Q_EMIT problem(remark);
    }
    core::Figure figure = dynamics::region_figure(*region_);
    if (trajectory_) {
        overlay(figure, *region_, *trajectory_);
    }
    show_map(std::move(figure));
}

void RegionPanel::show_map(core::Figure figure) {
    drawn_logarithmic_ = settings().logarithmic;
    const core::FigureAxis& x = figure.x;
    const bool can = x.label == "gap" && x.lower > 0 && x.upper > x.lower;
    logarithmic_->setEnabled(can);
    figure.x.logarithmic = can && settings().logarithmic.value_or(tables::spans_decades(x.lower, x.upper));
    logarithmic_->setChecked(figure.x.logarithmic);
    map_->show_figure(figure, true);
}

void RegionPanel::start_from(double x, double y) {
    if (!region_) {
        return;
    }
    const core::Figure figure = dynamics::region_figure(*region_);
    double gap = std::nan("");
    double velocity = 0;
    const auto take = [&](const std::string& axis, double value, const std::string& unit) {
        if (axis == "gap") {
            gap = core::convert(value, unit, "m");
        } else if (axis == "heave_velocity") {
            velocity = core::convert(value, unit, "m/s");
        }
    };
    take(region_->axes[0].name, x, figure.x.unit);
    take(region_->axes[1].name, y, figure.y.unit);
    if (std::isnan(gap) || !has_motions()) {
        Q_EMIT remark("motions are drawn over gap and heave velocity");
        return;
    }
    act("start=" + core::format_number(gap) + "m," + core::format_number(velocity) + "m/s");
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

bool RegionPanel::has_picture() const { return map_->has_figure(); }

void RegionPanel::export_picture(const std::filesystem::path& path) { map_->write(path); }

bool RegionPanel::has_table() const { return trajectory_ != nullptr; }

void RegionPanel::export_table(const std::filesystem::path& path) {
    core::Table table = trajectory_->table();
    table.comments.push_back("motion in the study's region '" + spec_.name + "', end: " + trajectory_->end);
    core::write_csv(path, table);
}

}  // namespace underbody::studio
