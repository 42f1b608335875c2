// Stability: what is asked at its left side, and the places of its views.
// First, because Qt makes `signals` a keyword and the dynamics room has a member of that name.
// clang-format off
#include "surrogates/dynamics/plant/heave.h"
#include "surrogates/dynamics/basin/region.h"
// clang-format on

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
#include "studio/desktop/region_panel.h"
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

void RegionPanel::build() {
    auto* all = new QHBoxLayout(this);
    auto* controls = new QWidget;
    auto* scroll = new QScrollArea;  // also where the window is low
    scroll->setWidget(controls);
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setFixedWidth(330);
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
    map_cells_ = new QWidget;
    grid_ = new QGridLayout(map_cells_);
    grid_->setContentsMargins(0, 0, 0, 0);
    motion_ = new PlotView(this);
    plots->addWidget(map_cells_);
    plots->addWidget(motion_);
    plots->setStretchFactor(0, 3);
    plots->setStretchFactor(1, 2);
    say("Open a study with a stability region");
    connect(motion_, &PlotView::hovered, this, &Panel::remark);
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
    show_->addItem("what the sensors can know", "estimator");
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
    feedback_ = new QLineEdit;
    feedback_->setAccessibleName("Feedback");
    feedback_->setPlaceholderText("none; gap_gain=10,reference=20mm");
    feedback_->setToolTip(
        "Closes the loop: gap_gain, velocity_gain, reference, limit; with pitch also pitch_gain, pitch_rate_gain, "
        "pitch_reference, moment_limit (SI or with units)");
    form.addRow("Under &feedback", feedback_);
    sweep_text_ = new QLineEdit;
    sweep_text_->setAccessibleName("Condition that is swept");
    sweep_text_->setPlaceholderText("speed=0.3:0.7");
    form.addRow("S&wept condition", sweep_text_);
    sensors_ = new QWidget;
    auto* sensors = new QHBoxLayout(sensors_);
    sensors->setContentsMargins(0, 0, 0, 0);
    gap_noise_ = new NumberEdit("m", "mm");
    gap_noise_->setAccessibleName("Noise of the gap sensor");
    gap_noise_->setToolTip("One standard deviation of a reading of the gap");
    velocity_noise_ = new NumberEdit("m/s", "mm/s");
    velocity_noise_->setAccessibleName("Noise of the velocity sensor");
    velocity_noise_->setToolTip("One standard deviation of a reading of the heave velocity; 0: it is not measured");
    drag_error_ = new NumberEdit("1", "percent");
    drag_error_->setAccessibleName("Error of the drag law");
    drag_error_->setToolTip("How far the declared drag law may be off: it alone tells ground force and drag apart");
    for (const auto& [field, key] :
         {std::pair{gap_noise_, "gap_noise"}, {velocity_noise_, "velocity_noise"}, {drag_error_, "drag_error"}}) {
        sensors->addWidget(field);
        connect(field, &NumberEdit::entered, this, [this, name = std::string(key)](double value) {
            act(name + "=" + core::format_number(value) +
                (name == "gap_noise"        ? "m"
                 : name == "velocity_noise" ? "m/s"
                                            : ""));
        });
    }
    form.addRow("Se&nsors, drag law", sensors_);
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
    text(feedback_, "feedback");
}

}  // namespace underbody::studio
