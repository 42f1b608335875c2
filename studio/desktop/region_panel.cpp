// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "cases/region_model.h"
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/basin/region.h"
// clang-format on

#include "studio/desktop/region_panel.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QSplitter>
#include <algorithm>
#include <cmath>

#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"

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

RegionPanel::RegionPanel(Jobs& jobs, QWidget* parent) : Panel(jobs, parent) {
    setObjectName("stability");
    build();
}

RegionPanel::~RegionPanel() = default;

void RegionPanel::build() {
    auto* all = new QHBoxLayout(this);
    auto* controls = new QWidget;
    controls->setFixedWidth(270);
    auto* left = new QVBoxLayout(controls);
    left->setContentsMargins(0, 0, 0, 0);
    all->addWidget(controls, 0);
    auto* form = new QFormLayout;
    form->setRowWrapPolicy(QFormLayout::WrapAllRows);
    left->addLayout(form);
    build_controls(*form);
    auto* buttons = new QHBoxLayout;
    compute_ = new QPushButton("Co&mpute map");
    reset_ = new QPushButton("As &declared");
    reset_->setToolTip("Forget the changed numbers");
    buttons->addWidget(compute_);
    buttons->addWidget(reset_);
    left->addLayout(buttons);
    changes_label_ = new QLabel;
    changes_label_->setWordWrap(true);
    left->addWidget(changes_label_);
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
    map_->show_text("Open a study with a stability region");
    motion_->show_text("Click a start in the map to see its motion");
    connect(map_, &PlotView::hovered, this, &Panel::remark);
    connect(motion_, &PlotView::hovered, this, &Panel::remark);
    connect(map_, &PlotView::clicked, this, &RegionPanel::start_from);
    connect(compute_, &QPushButton::clicked, this, [this] { compute(); });
    connect(reset_, &QPushButton::clicked, this, [this] {
        changes_.clear();
        choose_parameter();
        compute();
    });
}

void RegionPanel::build_controls(QFormLayout& form) {
    choice_ = new QComboBox;
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    form.addRow("Region", choice_);
    auto* sizes = new QHBoxLayout;
    cells_ = new QSpinBox;
    cells_->setRange(20, 1000);
    cells_->setSingleStep(50);
    cells_->setValue(200);
    cells_->setSuffix(" starts a side");
    duration_ = new QDoubleSpinBox;
    duration_->setRange(0.1, 100000);
    duration_->setDecimals(1);
    duration_->setSuffix(" s");
    sizes->addWidget(cells_);
    sizes->addWidget(duration_);
    form.addRow("Starts and time", sizes);
    parameter_ = new QComboBox;
    parameter_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    parameter_->setToolTip("Any number that the model declares can be changed here; the model file stays as it is");
    form.addRow("What if", parameter_);
    value_ = new QDoubleSpinBox;
    value_->setDecimals(6);
    value_->setKeyboardTracking(false);
    form.addRow("were", value_);
    connect(choice_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] { choose_region(); });
    connect(parameter_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] { choose_parameter(); });
    connect(value_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, [this](double value) {
        const std::string name = parameter_->currentData().toString().toStdString();
        const auto at =
            std::find_if(changes_.begin(), changes_.end(), [&](const auto& change) { return change.first == name; });
        if (at != changes_.end()) {
            at->second = value;
        } else if (!name.empty()) {
            changes_.emplace_back(name, value);
        }
        compute();
    });
}

void RegionPanel::show_session(const SessionPointer& session) {
    session_ = session;
    const QString kept = choice_->currentText();
    {
        const QSignalBlocker quiet(choice_);
        choice_->clear();
        for (const auto& region : session->study.regions) {
            choice_->addItem(qt(region.name));
        }
        const int at = choice_->findText(kept);
        choice_->setCurrentIndex(at >= 0 ? at : 0);
    }
    choose_region();
}

void RegionPanel::choose_region() {
    const auto index = static_cast<std::size_t>(std::max(0, choice_->currentIndex()));
    model_.reset();
    region_.reset();
    trajectory_.reset();
    changes_.clear();
    about_->clear();
    motion_->show_text("Click a start in the map to see its motion");
    const bool any = session_ && index < session_->study.regions.size();
    compute_->setEnabled(any);
    reset_->setEnabled(any);
    if (!any) {
        map_->show_text("This study has no stability regions");
        return;
    }
    spec_ = session_->study.regions[index];
    if (!spec_.forces.empty() && session_->results.loads.rows() == 0) {
        map_->show_text("The loads of this study are not computed yet: Study > Compute what changed (Ctrl+R)");
        compute_->setEnabled(false);
        return;
    }
    duration_->setValue(spec_.duration);
    map_->show_text("…");
    jobs_.start("region model", "reading the model of " + qt(spec_.name),
                [this, spec = spec_, session = session_](core::Progress&) {
                    auto model = std::make_shared<const dynamics::Model>(
                        cases::region_model(session->study, spec, session->results));
                    return [this, model] {
                        model_ = model;
                        show_model();
                        compute();
                    };
                });
}

void RegionPanel::show_model() {
    const QSignalBlocker quiet(parameter_);
    const QString kept = parameter_->currentData().toString();
    parameter_->clear();
    for (const auto& parameter : model_->parameters()) {
        parameter_->addItem(qt(parameter.name), qt(parameter.name));
        parameter_->setItemData(parameter_->count() - 1, qt(parameter.meaning), Qt::ToolTipRole);
    }
    const int at = parameter_->findData(kept.isEmpty() ? "vehicle.net_weight" : kept);
    parameter_->setCurrentIndex(at >= 0 ? at : 0);
    choose_parameter();
}

void RegionPanel::choose_parameter() {
    if (!model_) {
        return;
    }
    const std::string name = parameter_->currentData().toString().toStdString();
    for (const auto& parameter : model_->parameters()) {
        if (parameter.name != name) {
            continue;
        }
        const auto at =
            std::find_if(changes_.begin(), changes_.end(), [&](const auto& change) { return change.first == name; });
        const double value = at != changes_.end() ? at->second : parameter.value;
        const QSignalBlocker quiet(value_);
        value_->setRange(parameter.lower, parameter.upper);
        const double step = value != 0 ? std::pow(10, std::floor(std::log10(std::abs(value)))) / 2 : 0.01;
        value_->setSingleStep(step);
        value_->setSuffix(parameter.unit.empty() || parameter.unit == "1" ? "" : " " + qt(pretty_unit(parameter.unit)));
        value_->setValue(value);
        value_->setToolTip(qt(parameter.meaning) + QString("\ndeclared: %1").arg(map_number(parameter.value)));
    }
    QString text;
    for (const auto& [changed, value] : changes_) {
        text += QString("%1 = %2 (declared %3)\n")
                    .arg(qt(changed), map_number(value), map_number(model_->parameter(changed)));
    }
    changes_label_->setText(text.trimmed());
}

dynamics::Model RegionPanel::changed_model() const {
    dynamics::Model model = *model_;
    for (const auto& [name, value] : changes_) {
        model = model.with_parameter(name, value);
    }
    return model.resolved();
}

void RegionPanel::compute() {
    if (!model_) {
        return;
    }
    choose_parameter();
    trajectory_.reset();
    dynamics::RegionOptions options = cases::region_options(spec_);
    options.columns = options.rows = static_cast<std::size_t>(cells_->value());
    options.duration = duration_->value();
    jobs_.start("region", "stability map", [this, model = changed_model(), options](core::Progress& progress) {
        auto region =
            std::make_shared<const dynamics::StabilityRegion>(dynamics::stability_region(model, options, progress));
        return [this, region] {
            region_ = region;
            show_region();
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
    if (std::isnan(gap)) {
        Q_EMIT remark("motions are shown for maps over the gap");
        return;
    }
    dynamics::TrajectoryOptions options;
    options.duration = duration_->value();
    options.output_step = options.duration / 3000;
    options.escape_gap = region_->escape_gap;
    options.stop_at_contact = true;
    jobs_.start("trajectory", "motion",
                [this, model = changed_model(), gap, velocity, options](core::Progress& progress) {
                    dynamics::InputSignals inputs;
                    inputs.held = model.conditions;
                    auto trajectory = std::make_shared<const dynamics::Trajectory>(
                        dynamics::simulate(model, gap, velocity, inputs, options, progress));
                    return [this, trajectory] {
                        trajectory_ = trajectory;
                        show_trajectory();
                    };
                });
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

void RegionPanel::demonstrate() {
    if (!region_ || region_->axes[0].name != "gap" || region_->axes[1].name != "heave_velocity") {
        return;
    }
    // A small kick away from the first equilibrium that holds, or from the middle of the map.
    double gap = 0.5 * (region_->axes[0].lower + region_->axes[0].upper);
    for (const auto& equilibrium : region_->equilibria) {
        if (equilibrium.stable) {
            gap = equilibrium.gap;
            break;
        }
    }
    const core::Figure figure = dynamics::region_figure(*region_);
    start_from(core::convert(gap, "m", figure.x.unit),
               0.05 * core::convert(region_->axes[1].upper, "m/s", figure.y.unit));
}

}  // namespace underbody::studio
