#include "studio/desktop/force_panel.h"

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QHeaderView>
#include <QLabel>
#include <QSignalBlocker>
#include <QTableWidget>
#include <QTimer>
#include <algorithm>
#include <cmath>

#include "cases/add_table.h"
#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/case_points.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/parameter_row.h"
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

}  // namespace

ForcePanel::ForcePanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
    setObjectName("tables");
    build();
}

ForcePanel::~ForcePanel() = default;

void ForcePanel::build() {
    auto* column = new QVBoxLayout(this);
    auto* all = new QHBoxLayout;
    column->addLayout(all, 1);
    auto* left = new QVBoxLayout;
    auto* controls = new QWidget;
    controls->setFixedWidth(390);  // the slider of the net weight is long enough to choose with
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
    reach_ = new QLabel;
    reach_->setWordWrap(true);
    left->addWidget(reach_);
    left->addStretch(1);

    auto* cells = new QWidget;
    grid_ = new QGridLayout(cells);
    grid_->setContentsMargins(0, 0, 0, 0);
    all->addWidget(cells, 1);
    plot_ = new PlotView(this);
    grid_->addWidget(plot_, 0, 0);
    connect(plot_, &PlotView::hovered, this, &Panel::remark);
    connect(plot_, &PlotView::clicked, this, &ForcePanel::point_clicked);
    list_ = new QTableWidget(0, 9);
    list_->setHorizontalHeaderLabels({"gap (mm)", "± (mm)", "stability", "stiffness (N/m)", "± (N/m)", "frequency (Hz)",
                                      "± (Hz)", "largest kick (mm/s)", "remark"});
    list_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    list_->verticalHeader()->hide();
    list_->horizontalHeader()->setStretchLastSection(true);
    list_->setMaximumHeight(130);
    list_->verticalHeader()->setDefaultSectionSize(22);
    list_->setSelectionBehavior(QAbstractItemView::SelectRows);
    column->addWidget(list_);  // under both: its columns have their room
    at_rest_ = new QTimer(this);
    at_rest_->setSingleShot(true);
    at_rest_->setInterval(200);
    plot_->show_text("Open a study with force tables");
}

void ForcePanel::build_controls(QFormLayout& form) {
    choice_ = new QComboBox;
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choice_->setAccessibleName("Force table");
    form.addRow("Force &table", choice_);
    view_ = new QComboBox;
    view_->setAccessibleName("Shown as");
    form.addRow("Shown &as", view_);
    weight_ = new ParameterRow("net weight", "weight less buoyancy, positive sinks: drag it and watch the equilibria",
                               "N", "N");
    mass_ =
        new ParameterRow("virtual mass", "mass and added mass in heave: for frequency and largest kick", "kg", "kg");
    form.addRow(weight_);
    form.addRow(mass_);
    logarithmic_ = new QCheckBox("l&ogarithmic axis");
    form.addRow(logarithmic_);
    connect(logarithmic_, &QCheckBox::clicked, this,
            [this](bool on) { act(on ? "logarithmic=on" : "logarithmic=off"); });
    connect(choice_, QOverload<int>::of(&QComboBox::activated), this, [this] {
        desk_.act({"select", "table/" + choice_->currentText().toStdString()});
    });
    connect(view_, QOverload<int>::of(&QComboBox::activated), this,
            [this] { act("shown=" + view_->currentData().toString().toStdString()); });
    const auto row = [this](ParameterRow* one, const char* key, const char* unit) {
        const auto text = [key, unit](double value) {
            return std::string(key) + "=" + core::format_number(value) + " " + unit;
        };
        connect(one, &ParameterRow::moved, this,
                [this, text](double value, const QString& gesture) { act(text(value), gesture); });
        connect(one, &ParameterRow::entered, this, [this, text](double value) { act(text(value)); });
        connect(one, &ParameterRow::released, this, [this] { desk_.end_gesture(); });
        connect(one, &ParameterRow::reset, this, [this, key] { act(std::string(key) + "="); });
    };
    row(weight_, "net_weight", "N");
    row(mass_, "virtual_mass", "kg");
}

void ForcePanel::act(const std::string& assignment, const QString& gesture) {
    if (!spec_.name.empty()) {
        desk_.act({"table", spec_.name, assignment}, gesture);
    }
}

const TableView& ForcePanel::settings() const {
    static const TableView none;
    const auto at = state().tables.find(spec_.name);
    return at == state().tables.end() ? none : at->second;
}

bool ForcePanel::has_weight() const { return spec_.quantity == "lift_force"; }
double ForcePanel::net_weight() const { return settings().net_weight.value_or(spec_.net_weight.value_or(0)); }
double ForcePanel::virtual_mass() const { return settings().virtual_mass.value_or(spec_.virtual_mass); }

void ForcePanel::draw_again(bool fresh) {
    const QSignalBlocker quiet(choice_);
    choice_->clear();
    for (const auto& table : session().study.tables) {
        choice_->addItem(qt(table.name));
    }
    choose_table(fresh);
}

void ForcePanel::choose_table(bool fresh) {
    std::vector<std::string> names;
    for (const auto& table : session().study.tables) {
        names.push_back(table.name);
    }
    const std::string name = state().current("table", names);
    const auto* spec = session().study.find_table(name);
    QString why;
    if (spec == nullptr && !lift_of_cases(session().study, session().results).points.empty()) {
        show_cases();
        return;
    }
    if (spec == nullptr) {
        why = desk_.has_study() ? "This study has no force tables: Study > Make a table of forces (Ctrl+T)"
                                : "Open a study with force tables";
    } else if (!cases::has_loads(*spec, session().results)) {
        why = "The loads of this study are not computed yet: Study > Compute what changed (Ctrl+R)";
    }
    if (!why.isEmpty()) {
        table_.reset();
        spec_ = {};
        hide_beside();
        list_->hide();
        about_->clear();
        reach_->clear();
        plot_->show_text(why);
        return;
    }
    choice_->setCurrentText(qt(name));
    if (fresh || spec_.name != name || fitted_ != desk_.session_pointer()) {
        fit(*spec);
    } else if (table_) {
        show_table();
    }
}

/// Without a table: the cases themselves, and what to write for one.
void ForcePanel::show_cases() {
    table_.reset();
    spec_ = {};
    hide_beside();
    list_->hide();
    reach_->clear();
    QString how;
    try {
        const cases::NewTable table = cases::proposed_table(session().study);
        how =
            "Study > Make a table of forces (Ctrl+T) makes one of them, with its error, equilibria and exports; or by "
            "hand, in study.toml:<pre>" +
            html(cases::lines_of(table, cases::plan_table(session().study, table))) + "</pre>";
    } catch (const core::Error& error) {
        how = "They make no table over the gap: " + html(error.message());
    }
    about_->setText("<b>No force table yet.</b> The points are the loads of the cases. " + how);
    plot_->show_figure(lift_of_cases(session().study, session().results), true);
}

void ForcePanel::fit(const cases::TableSpec& spec) {
    spec_ = spec;
    fitted_ = desk_.session_pointer();
    table_.reset();
    jobs_.start("force table", "fitting " + qt(spec.name), [this, spec, session = fitted_](core::Progress&) {
        const auto table = std::make_shared<const tables::ForceTable>(tables::ForceTable::fit(
            cases::table_points(spec, session->results), spec.quantity, cases::fit_options(spec)));
        return [this, spec, table] {
            if (spec_.name == spec.name) {
                table_ = table;
                for (const auto& remark : table_->remarks()) {
                    Q_EMIT problem(remark);
                }
                show_table();
            }
        };
    });
}

void ForcePanel::show_table() {
    double largest = 0;
    for (const double value : table_->points().numbers(spec_.quantity)) {
        largest = std::max(largest, std::abs(value));
    }
    weight_range_ = largest > 0 ? 1.2 * largest : 1;
    weight_->setEnabled(has_weight());
    mass_->setEnabled(has_weight());
    weight_->show_value(net_weight(), -weight_range_, weight_range_, settings().net_weight.has_value());
    mass_->show_value(virtual_mass(), 0, std::max(1.0, 2 * std::max(spec_.virtual_mass, virtual_mass())),
                      settings().virtual_mass.has_value());
    QString range;
    for (const auto& axis : table_->axes()) {
        const std::string unit = tables::shown_unit(*table_, axis.name);
        range += QString("<br>%1 %2 to %3 %4")
                     .arg(qt(axis.name))
                     .arg(number(core::convert(axis.lower, axis.unit, unit)))
                     .arg(number(core::convert(axis.upper, axis.unit, unit)))
                     .arg(qt(pretty_unit(unit)));
    }
    const auto basis = cases::basis_of(spec_, session().results);
    about_->setText(QString("<b>%1</b>, %2 through %3 points%4%5")
                        .arg(qt(spec_.quantity).replace('_', ' '))
                        .arg(qt(table_->kind()))
                        .arg(table_->points().rows())
                        .arg(range)
                        .arg(basis.empty() ? QString() : "<br>" + html(basis.front())));
    fill_axes();
    fill_held();
    redraw();
}

void ForcePanel::redraw() {
    tables::FigureOptions options;
    options.axis = view().value(1).toStdString();
    const auto& axis = table_->axes()[tables::axis_index(*table_, options.axis)];
    logarithmic_->setEnabled(axis.lower > 0);
    logarithmic_->setChecked(axis.lower > 0 &&
                             settings().logarithmic.value_or(tables::spans_decades(axis.lower, axis.upper)));
    if (has_weight() && options.axis == "gap") {
        tables::EquilibriumOptions equilibria;
        equilibria.net_weight = net_weight();
        equilibria.virtual_mass = virtual_mass();
        for (const auto& one : table_->axes()) {
            if (one.name != options.axis) {
                equilibria.held.emplace_back(one.name, held_value(one.name));
            }
        }
        equilibria.axis = options.axis;
        options.equilibria = equilibria;
    }
    list_->setRowCount(0);
    list_->hide();
    at_rest_->stop();
    jobs_.cancel("equilibria");
    reach_->clear();
    try {
        plot_->show_figure(figure_of(view(), options), true);
        if (options.equilibria && view().value(0) == "curve") {
            list_equilibria(*options.equilibria);
        }
    } catch (const core::Error& error) {
        plot_->show_text(qt(error.what()));
    }
    show_beside();
}

/// A click on a point of the table selects the case that it is of.
void ForcePanel::point_clicked(double x, double y) {
    if (!table_ || view().value(0) == "map" || !spec_.shape.empty() || session().results.loads.rows() == 0) {
        return;
    }
    const std::string axis = view().value(1).toStdString();
    const double at =
        core::convert(x, tables::shown_unit(*table_, axis), table_->axes()[tables::axis_index(*table_, axis)].unit);
    const double force = core::convert(y, tables::shown_unit(*table_, spec_.quantity), table_->unit());
    const cases::Case* nearest = nullptr;
    double distance = 0.05;  // of the ranges
    const auto share_between = [&](const std::string& name, double a, double b) {
        const auto& range = table_->axes()[tables::axis_index(*table_, name)];
        return logarithmic_->isChecked() ? std::log(a / b) / std::log(range.upper / range.lower)
                                         : (a - b) / (range.upper - range.lower);
    };
    for (const auto& loads : session().results.case_loads) {
        const auto& one = session().study.cases[loads.entry];
        if (loads.values.empty() || !one.conditions.satisfies(spec_.where) || !one.conditions.number(axis)) {
            continue;
        }
        const double along = share_between(axis, at, *one.conditions.number(axis));
        const double away = std::hypot(along, (loads.value(spec_.quantity) - force) / (2 * weight_range_));
        if (away < distance) {
            distance = away;
            nearest = &one;
        }
    }
    if (nearest != nullptr) {
        desk_.act({"select", "table/" + spec_.name, "case/" + nearest->name});
        Q_EMIT remark(qt("the point is of " + nearest->name + ": Compare (F4) shows its field"));
    }
}

/// The errors are out of drawn tables, as in the report: of one axis at once, of more, which takes some tenths of a
/// second, when the sliders have come to rest.
void ForcePanel::list_equilibria(tables::EquilibriumOptions options) {
    const bool at_once = table_->axes().size() == 1;
    options.draws = at_once ? tables::usual_draws : 0;
    show_equilibria(tables::equilibria(*table_, options));
    options.draws = tables::usual_draws;
    at_rest_->disconnect();
    connect(at_rest_, &QTimer::timeout, this, [this, table = table_, options] {
        jobs_.start(
            "equilibria", "errors of the equilibria",
            [this, table, options](core::Progress&) {
                const auto found = std::make_shared<const tables::Equilibria>(tables::equilibria(*table, options));
                return [this, table, found] {
                    if (table == table_) {
                        show_equilibria(*found);
                    }
                };
            },
            true);
    });
    at_once ? at_rest_->stop() : at_rest_->start();
}

namespace {

/// What takes from its number.
QString doubts_of(const tables::Equilibrium& one) {
    const QString range = one.limited_by_range ? "limited by the range of the table" : "";
    return one.doubtful()
               ? "exists with probability " + number(*one.probability, 2) + (range.isEmpty() ? "" : "; " + range)
               : range;
}

}  // namespace

void ForcePanel::show_equilibria(const tables::Equilibria& found) {
    if (found.all.empty()) {
        reach_->setText(
            QString("No equilibrium in the table's range: the net force is %1 N at its lower and %2 N at its "
                    "upper end.")
                .arg(number(found.force_at_lower, 3), number(found.force_at_upper, 3)));
    }
    list_->setRowCount(static_cast<int>(found.all.size()));
    for (int row = 0; row < list_->rowCount(); ++row) {
        const auto& one = found.all[static_cast<std::size_t>(row)];
        const bool moves = one.stability == tables::Stability::stable && found.virtual_mass > 0;
        const auto error = [](const std::optional<double>& sigma) { return number(sigma.value_or(NAN), 2); };
        const QStringList cells = {number(1000 * one.gap),
                                   number(1000 * one.sigma, 2),
                                   qt(tables::to_string(one.stability)),
                                   number(one.stiffness),
                                   error(one.stiffness_sigma),
                                   moves ? number(one.frequency, 3) : "–",
                                   error(one.frequency_sigma),
                                   moves ? number(1000 * one.kick_velocity, 3) : "–",
                                   doubts_of(one)};
        for (int column = 0; column < cells.size(); ++column) {
            auto* item = new QTableWidgetItem(cells[column]);
            item->setTextAlignment(column == 2 || column == 8 ? Qt::AlignLeft | Qt::AlignVCenter
                                                              : Qt::AlignRight | Qt::AlignVCenter);
            list_->setItem(row, column, item);
        }
    }
    list_->setVisible(!found.all.empty() && shows("equilibria"));
    list_->resizeColumnsToContents();
    list_->horizontalHeader()->setStretchLastSection(true);
}

bool ForcePanel::has_picture() const { return plot_->has_figure(); }

void ForcePanel::export_picture(const std::filesystem::path& path) { plot_->write(path); }

bool ForcePanel::has_table() const { return table_ != nullptr; }

void ForcePanel::export_table(const std::filesystem::path& path) { core::write_csv(path, table_->points()); }

}  // namespace underbody::studio
