#include "studio/desktop/force_panel.h"

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHeaderView>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QTableWidget>
#include <algorithm>
#include <cmath>

#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::studio {

namespace {

QString number(double value, int digits = 4) {
    if (std::isinf(value)) {
        return value > 0 ? "∞" : "−∞";
    }
    return std::isnan(value) ? QString("–") : qt(core::format_number(value, digits)).replace('-', QChar(0x2212));
}

constexpr int slider_steps = 2000;

}  // namespace

double ForcePanel::Held::value() const { return lower + (upper - lower) * slider->value() / slider_steps; }

ForcePanel::ForcePanel(Jobs& jobs, QWidget* parent) : Panel(jobs, parent) {
    setObjectName("forces");
    build();
}

ForcePanel::~ForcePanel() = default;

void ForcePanel::build() {
    auto* all = new QHBoxLayout(this);
    auto* left = new QVBoxLayout;
    auto* controls = new QWidget;
    controls->setFixedWidth(270);
    controls->setLayout(left);
    all->addWidget(controls, 0);
    auto* form = new QFormLayout;
    form->setRowWrapPolicy(QFormLayout::WrapAllRows);
    left->addLayout(form);
    build_controls(*form);
    held_form_ = new QFormLayout;
    held_form_->setRowWrapPolicy(QFormLayout::WrapAllRows);
    left->addLayout(held_form_);
    about_ = new QLabel;
    about_->setWordWrap(true);
    about_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    left->addWidget(about_);
    left->addStretch(1);

    auto* right = new QVBoxLayout;
    all->addLayout(right, 1);
    plot_ = new PlotView(this);
    right->addWidget(plot_, 1);
    connect(plot_, &PlotView::hovered, this, &Panel::remark);
    list_ = new QTableWidget(0, 7);
    list_->setHorizontalHeaderLabels(
        {"gap (mm)", "± (mm)", "stability", "stiffness (N/m)", "frequency (Hz)", "largest kick (mm/s)", "remark"});
    list_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    list_->verticalHeader()->hide();
    list_->horizontalHeader()->setStretchLastSection(true);
    list_->setMaximumHeight(130);
    list_->verticalHeader()->setDefaultSectionSize(22);
    list_->setSelectionBehavior(QAbstractItemView::SelectRows);
    right->addWidget(list_);
    plot_->show_text("Open a study with force tables");
}

void ForcePanel::build_controls(QFormLayout& form) {
    choice_ = new QComboBox;
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    form.addRow("Force table", choice_);
    view_ = new QComboBox;
    form.addRow("Shown as", view_);
    weight_ = new QSlider(Qt::Horizontal);
    weight_->setRange(-slider_steps, slider_steps);
    weight_->setToolTip("Weight less buoyancy, positive sinks. Drag it and watch the equilibria move.");
    weight_box_ = new QDoubleSpinBox;
    weight_box_->setDecimals(4);
    weight_box_->setSuffix(" N");
    weight_box_->setRange(-1e6, 1e6);
    weight_box_->setSingleStep(0.01);
    auto* weight_row = new QHBoxLayout;
    weight_row->addWidget(weight_, 1);
    weight_row->addWidget(weight_box_);
    form.addRow("Net weight", weight_row);
    mass_ = new QDoubleSpinBox;
    mass_->setDecimals(3);
    mass_->setSuffix(" kg");
    mass_->setRange(0, 1e6);
    mass_->setSingleStep(0.1);
    mass_->setToolTip("Mass and added mass in heave: for the frequency and the largest kick");
    form.addRow("Virtual mass", mass_);
    logarithmic_ = new QCheckBox("&logarithmic axis");
    form.addRow(logarithmic_);
    connect(logarithmic_, &QCheckBox::toggled, this, [this] { redraw(); });
    connect(choice_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] { choose_table(); });
    connect(view_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] {
        if (table_) {
            suggest_scale();
        }
        fill_held();
        redraw();
    });
    connect(mass_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, [this] { redraw(); });
    connect(weight_, &QSlider::valueChanged, this, [this](int step) {
        const QSignalBlocker quiet(weight_box_);
        weight_box_->setValue(weight_range_ * step / slider_steps);
        redraw();
    });
    connect(weight_box_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, [this](double value) {
        const QSignalBlocker quiet(weight_);
        weight_->setValue(static_cast<int>(std::lround(std::clamp(value / weight_range_, -1.0, 1.0) * slider_steps)));
        redraw();
    });
}

void ForcePanel::show_session(const SessionPointer& session) {
    session_ = session;
    const QString kept = choice_->currentText();
    {
        const QSignalBlocker quiet(choice_);
        choice_->clear();
        for (const auto& table : session->study.tables) {
            choice_->addItem(qt(table.name));
        }
        const int at = choice_->findText(kept);
        choice_->setCurrentIndex(at >= 0 ? at : 0);
    }
    choose_table();
}

void ForcePanel::choose_table() {
    const auto index = static_cast<std::size_t>(std::max(0, choice_->currentIndex()));
    if (!session_ || index >= session_->study.tables.size()) {
        table_.reset();
        list_->setRowCount(0);
        about_->clear();
        plot_->show_text("This study has no force tables");
        return;
    }
    if (session_->results.loads.rows() == 0) {
        table_.reset();
        list_->setRowCount(0);
        about_->clear();
        plot_->show_text("The loads of this study are not computed yet: Study > Compute what changed (Ctrl+R)");
        return;
    }
    const auto spec = session_->study.tables[index];
    jobs_.start("force table", "fitting " + qt(spec.name), [this, spec, session = session_](core::Progress&) {
        auto table = std::make_shared<tables::ForceTable>(tables::ForceTable::fit(
            cases::table_points(spec, session->results), spec.quantity, cases::fit_options(spec)));
        return [this, spec, table] {
            spec_ = spec;
            table_ = std::make_unique<tables::ForceTable>(*table);
            show_table();
        };
    });
}

void ForcePanel::show_table() {
    for (const auto& remark : table_->remarks()) {
        Q_EMIT problem(remark);
    }
    double largest = 0;
    for (const double value : table_->points().numbers(spec_.quantity)) {
        largest = std::max(largest, std::abs(value));
    }
    weight_range_ = largest > 0 ? 1.2 * largest : 1;
    const bool has_weight = spec_.quantity == "lift_force";
    for (auto* widget : std::initializer_list<QWidget*>{weight_, weight_box_, mass_}) {
        widget->setEnabled(has_weight);
    }
    {
        const QSignalBlocker quiet(weight_), quiet_box(weight_box_), quiet_mass(mass_);
        weight_box_->setValue(has_weight ? spec_.net_weight.value_or(0) : 0);
        weight_->setValue(static_cast<int>(std::lround(weight_box_->value() / weight_range_ * slider_steps)));
        mass_->setValue(spec_.virtual_mass);
    }
    QString range;
    for (const auto& axis : table_->axes()) {
        const std::string unit = tables::shown_unit(*table_, axis.name);
        range += QString("<br>%1 %2 to %3 %4")
                     .arg(qt(axis.name))
                     .arg(number(core::convert(axis.lower, axis.unit, unit)))
                     .arg(number(core::convert(axis.upper, axis.unit, unit)))
                     .arg(qt(pretty_unit(unit)));
    }
    about_->setText(QString("<b>%1</b>, %2 through %3 points%4")
                        .arg(qt(spec_.quantity))
                        .arg(qt(table_->kind()))
                        .arg(table_->points().rows())
                        .arg(range));
    fill_axes();
    suggest_scale();
    fill_held();
    redraw();
}

void ForcePanel::suggest_scale() {
    const auto& axis = table_->axes()[tables::axis_index(*table_, view_axis())];
    const QSignalBlocker quiet(logarithmic_);
    logarithmic_->setEnabled(axis.lower > 0);
    logarithmic_->setChecked(tables::spans_decades(axis.lower, axis.upper));
}

void ForcePanel::fill_axes() {
    const QSignalBlocker quiet(view_);
    const QString kept = view_->currentText();
    view_->clear();
    const auto& axes = table_->axes();
    for (const auto& axis : axes) {
        view_->addItem("curve over " + qt(axis.name), QStringList{"curve", qt(axis.name)});
    }
    for (std::size_t i = 0; i < axes.size(); ++i) {
        for (std::size_t k = 0; k < axes.size(); ++k) {
            if (i != k) {
                view_->addItem("curves over " + qt(axes[i].name) + ", one for each " + qt(axes[k].name),
                               QStringList{"family", qt(axes[i].name), qt(axes[k].name)});
            }
            if (i < k) {
                view_->addItem("map over " + qt(axes[i].name) + " and " + qt(axes[k].name),
                               QStringList{"map", qt(axes[i].name), qt(axes[k].name)});
            }
        }
    }
    const int at = view_->findText(kept);
    view_->setCurrentIndex(at >= 0 ? at : 0);
}

std::string ForcePanel::view_axis() const {
    const QStringList view = view_->currentData().toStringList();
    return view.size() > 1 ? view[1].toStdString() : table_->axes().front().name;
}

void ForcePanel::fill_held() {
    for (const auto& held : held_) {
        held_form_->removeRow(held.slider->parentWidget());
    }
    held_.clear();
    if (!table_) {
        return;
    }
    const QStringList view = view_->currentData().toStringList();
    for (const auto& axis : table_->axes()) {
        if (view.mid(1).contains(qt(axis.name))) {
            continue;
        }
        auto* row = new QWidget;
        auto* line = new QHBoxLayout(row);
        line->setContentsMargins(0, 0, 0, 0);
        Held held{
            axis.name, tables::shown_unit(*table_, axis.name), axis.lower, axis.upper, new QSlider(Qt::Horizontal),
            new QLabel};
        held.slider->setRange(0, slider_steps);
        const double start = axis.lower < 0 && axis.upper > 0 ? 0 : axis.lower;
        held.slider->setValue(
            static_cast<int>(std::lround((start - axis.lower) / (axis.upper - axis.lower) * slider_steps)));
        held.shown->setMinimumWidth(70);
        line->addWidget(held.slider, 1);
        line->addWidget(held.shown);
        held_form_->addRow(qt(axis.name) + " held at", row);
        connect(held.slider, &QSlider::valueChanged, this, [this] { redraw(); });
        held_.push_back(held);
    }
}

void ForcePanel::redraw() {
    if (!table_) {
        return;
    }
    const QStringList view = view_->currentData().toStringList();
    tables::FigureOptions options;
    options.axis = view_axis();
    options.logarithmic = logarithmic_->isEnabled() && logarithmic_->isChecked();
    for (const auto& held : held_) {
        options.held.emplace_back(held.name, held.value());
        const auto* quantity = core::find_quantity(held.name);
        const double shown = core::convert(held.value(), quantity != nullptr ? quantity->unit : "1", held.unit);
        held.shown->setText(number(shown, 3) + " " + qt(pretty_unit(held.unit)));
    }
    if (weight_->isEnabled() && options.axis == "gap") {
        tables::EquilibriumOptions equilibria;
        equilibria.net_weight = weight_box_->value();
        equilibria.virtual_mass = mass_->value();
        equilibria.held = options.held;
        equilibria.axis = options.axis;
        options.equilibria = equilibria;
    }
    try {
        if (view.value(0) == "map") {
            plot_->show_figure(tables::map_figure(*table_, view[1].toStdString(), view[2].toStdString(), options),
                               true);
        } else if (view.value(0) == "family") {
            plot_->show_figure(tables::family_figure(*table_, view[1].toStdString(), view[2].toStdString(), options),
                               true);
        } else {
            plot_->show_figure(tables::curve_figure(*table_, options), true);
        }
        list_->setRowCount(0);
        if (options.equilibria && view.value(0) == "curve") {
            list_equilibria();
        }
    } catch (const core::Error& error) {
        plot_->show_text(qt(error.what()));
    }
}

void ForcePanel::list_equilibria() {
    tables::EquilibriumOptions options;
    options.net_weight = weight_box_->value();
    options.virtual_mass = mass_->value();
    options.axis = "gap";
    for (const auto& held : held_) {
        options.held.emplace_back(held.name, held.value());
    }
    const auto found = tables::equilibria(*table_, options);
    list_->setRowCount(static_cast<int>(found.all.size()));
    for (int row = 0; row < list_->rowCount(); ++row) {
        const auto& one = found.all[static_cast<std::size_t>(row)];
        const bool stable = one.stability == tables::Stability::stable;
        const QStringList cells = {number(1000 * one.gap),
                                   number(1000 * one.sigma, 2),
                                   qt(tables::to_string(one.stability)),
                                   number(one.stiffness),
                                   stable && options.virtual_mass > 0 ? number(one.frequency, 3) : "–",
                                   stable && options.virtual_mass > 0 ? number(1000 * one.kick_velocity, 3) : "–",
                                   one.limited_by_range ? "limited by the range of the table" : ""};
        for (int column = 0; column < cells.size(); ++column) {
            auto* item = new QTableWidgetItem(cells[column]);
            item->setTextAlignment(column == 2 || column == 6 ? Qt::AlignLeft | Qt::AlignVCenter
                                                              : Qt::AlignRight | Qt::AlignVCenter);
            list_->setItem(row, column, item);
        }
    }
    list_->resizeColumnsToContents();
    list_->horizontalHeader()->setStretchLastSection(true);
}

bool ForcePanel::has_picture() const { return plot_->has_figure(); }

void ForcePanel::export_picture(const std::filesystem::path& path) { plot_->write(path); }

bool ForcePanel::has_table() const { return table_ != nullptr; }

void ForcePanel::export_table(const std::filesystem::path& path) { core::write_csv(path, table_->points()); }

void ForcePanel::demonstrate() {
    if (table_ && weight_->isEnabled()) {
        weight_->setValue(weight_->value() * 95 / 100);
    }
}

}  // namespace underbody::studio
