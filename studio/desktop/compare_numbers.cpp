#include "studio/desktop/compare_numbers.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QSignalBlocker>
#include <QTableWidget>
#include <algorithm>
#include <cmath>

#include "cases/case_loads.h"
#include "cases/moved.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/loads/named_loads.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {

struct Quantity {
    const char* name;
    const char* title;
    const char* unit;
    double postproc::NamedLoads::*part;
};
const std::vector<Quantity> compared = {{"lift_force", "lift", "N", &postproc::NamedLoads::lift_force},
                                        {"drag_force", "drag", "N", &postproc::NamedLoads::drag_force},
                                        {"pitch_moment", "pitch moment", "N m", &postproc::NamedLoads::pitch_moment}};

QString shown(double value, int digits = 4) {
    return std::isfinite(value) ? qt(core::format_number(value, digits)).replace('-', QChar(0x2212)) : QString("–");
}

void put(QTableWidget& table, int row, int column, const QString& text, bool bold = false) {
    auto* item = new QTableWidgetItem(text);
    item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
    QFont font = table.font();
    font.setBold(bold);
    item->setFont(font);
    table.setItem(row, column, item);
}

/// Value of a running integral at a place; it is flat beyond the ends.
double at(const std::vector<postproc::LoadsStation>& stations, double position, double postproc::NamedLoads::*part) {
    if (position <= stations.front().position) {
        return stations.front().behind.*part;
    }
    for (std::size_t i = 1; i < stations.size(); ++i) {
        if (position <= stations[i].position) {
            const double share =
                (position - stations[i - 1].position) / (stations[i].position - stations[i - 1].position);
            return (1 - share) * stations[i - 1].behind.*part + share * stations[i].behind.*part;
        }
    }
    return stations.back().behind.*part;
}

const std::vector<postproc::ZoneLoads>& zones_of(const ComparedCase& one) {
    static const std::vector<postproc::ZoneLoads> none;
    return one.loads ? one.loads->zones : none;
}

/// What a zone carries of a case, N; "": all of them together; NaN where it is not known.
double on_zone(const ComparedCase& one, const std::string& name, double postproc::NamedLoads::*part) {
    if (name.empty()) {
        return one.loads ? one.loads->named.*part : std::nan("");
    }
    for (const auto& zone : zones_of(one)) {
        if (zone.name == name) {
            postproc::Wrench sum = zone.pressure;
            sum.force = postproc::plus(sum.force, zone.viscous.force);
            sum.moment = postproc::plus(sum.moment, zone.viscous.moment);
            return postproc::named_loads(sum, {one.loads->forward, one.loads->up, one.loads->starboard}).*part;
        }
    }
    return std::nan("");
}

QTableWidget* new_table(const QString& name) {
    auto* table = new QTableWidget;
    table->setAccessibleName(name);
    table->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table->verticalHeader()->setDefaultSectionSize(22);
    return table;
}

}  // namespace

CompareNumbers::CompareNumbers(Desk& desk, QWidget* parent) : QTabWidget(parent), desk_(desk) {
    setDocumentMode(true);
    setTabPosition(QTabWidget::South);  // the tabs stay where they are when curves take more room than rows
    forces_ = new_table("Forces of the cases and their differences to the first");
    forces_->setToolTip(
        "± is one standard deviation, as the study's tables know it (mesh study, stated error, scatter).\n"
        "Bold: the difference is more than twice the joint one.");
    addTab(forces_, "Forces");
    zones_ = new_table("What each zone carries");
    addTab(zones_, "By zone");
    auto* along = new QWidget;
    auto* column = new QVBoxLayout(along);
    column->setContentsMargins(0, 0, 0, 0);
    along_what_ = new QComboBox;
    along_what_->setAccessibleName("What is summed along the body");
    for (const auto& one : compared) {
        along_what_->addItem(one.title);
    }
    column->addWidget(along_what_, 0, Qt::AlignLeft);
    along_ = new PlotView(along);
    column->addWidget(along_, 1);
    addTab(along, "Along the body");
    auto* tables = new QWidget;
    auto* row = new QHBoxLayout(tables);
    row->setContentsMargins(0, 0, 0, 0);
    tables_ = new PlotView(tables);
    row->addWidget(tables_, 3);
    tables_said_ = new QLabel;
    tables_said_->setWordWrap(true);
    tables_said_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    row->addWidget(tables_said_, 1);
    addTab(tables, "Tables");
    for (auto* plot : {along_, tables_}) {  // the cells above need the room; a splitter gives more
        plot->set_least({200, 80});
    }
    connect(along_what_, QOverload<int>::of(&QComboBox::activated), this, [this] { draw_along(); });
    connect(along_, &PlotView::hovered, this, &CompareNumbers::remark);
    connect(tables_, &PlotView::hovered, this, &CompareNumbers::remark);
    connect(this, &QTabWidget::currentChanged, this, [this] { ask_tables(); });
}

void CompareNumbers::show_cases(std::vector<ComparedCase> cases, bool differences) {
    cases_ = std::move(cases);
    differences_ = differences;
    setVisible(!cases_.empty());
    if (errors_of_ != desk_.session_pointer()) {
        errors_of_ = desk_.session_pointer();
        errors_.clear();
        for (const auto& one : compared) {
            errors_[one.name] = cases::known_errors(errors_of_->study, errors_of_->results, one.name);
        }
    }
    fill_forces();
    fill_zones();
    draw_along();
    ask_tables();
}

double CompareNumbers::value(const ComparedCase& one, const std::string& quantity) const {
    const std::string_view name = one.id.starts_with("case/") ? std::string_view(one.id).substr(5) : std::string_view();
    for (const auto& stored : desk_.session().results.case_loads) {  // of thousands of cases, too
        if (stored.name == name && std::isfinite(stored.value(quantity))) {
            return stored.value(quantity);
        }
    }
    for (const auto& known : compared) {
        if (one.loads && known.name == quantity) {
            return one.loads->named.*known.part;
        }
    }
    return std::nan("");
}

void CompareNumbers::fill_forces() {
    forces_->clear();
    forces_->clearSpans();
    forces_->setRowCount(static_cast<int>(cases_.size()));
    forces_->setColumnCount(static_cast<int>(3 * compared.size()));
    QStringList titles, names;
    for (const auto& quantity : compared) {
        titles << QString("%1 (%2)").arg(quantity.title, quantity.unit) << "±"
               << "less the first";
    }
    for (const auto& one : cases_) {
        names << qt(one.name);
    }
    forces_->setHorizontalHeaderLabels(titles);
    forces_->setVerticalHeaderLabels(names);
    for (std::size_t i = 0; i < cases_.size(); ++i) {
        int column = 0;
        for (const auto& quantity : compared) {
            const auto& errors = errors_[quantity.name];
            const auto error_of = [&](const ComparedCase& one) {
                const auto known = errors.find(one.id.starts_with("case/") ? one.id.substr(5) : std::string());
                return known == errors.end() ? std::nan("") : known->second;
            };
            const double number = value(cases_[i], quantity.name);
            const double difference = number - value(cases_.front(), quantity.name);
            cases::Moved moved{quantity.name,
                               quantity.unit,
                               value(cases_.front(), quantity.name),
                               number,
                               error_of(cases_.front()),
                               error_of(cases_[i])};
            cases::judge(moved);
            const int row = static_cast<int>(i);
            put(*forces_, row, column++, shown(number));
            put(*forces_, row, column++, shown(error_of(cases_[i]), 2));
            put(*forces_, row, column++, i > 0 ? shown(difference, 3) : QString("–"),
                i > 0 && moved.shift == cases::Shift::beyond);
        }
        if (!cases_[i].why.empty()) {
            forces_->verticalHeaderItem(static_cast<int>(i))->setToolTip(qt(cases_[i].why));
        }
    }
    forces_->resizeColumnsToContents();
    for (int column = 2; column < forces_->columnCount(); column += 3) {
        forces_->setColumnHidden(column, cases_.size() < 2);  // the first less the first
    }
    for (std::size_t i = 0; i < cases_.size(); ++i) {
        const int row = static_cast<int>(i);
        if (!cases_[i].why.empty() && !std::isfinite(value(cases_[i], compared.front().name))) {
            forces_->setSpan(row, 0, 1, forces_->columnCount());
            put(*forces_, row, 0, qt(cases_[i].why).simplified());
            forces_->item(row, 0)->setToolTip(qt(cases_[i].why));
            forces_->item(row, 0)->setTextAlignment(Qt::AlignLeft | Qt::AlignVCenter);
        }
    }
}

void CompareNumbers::fill_zones() {
    std::vector<std::string> names;
    for (const auto& one : cases_) {
        for (const auto& zone : zones_of(one)) {
            if (std::find(names.begin(), names.end(), zone.name) == names.end()) {
                names.push_back(zone.name);
            }
        }
    }
    zones_->clear();
    zones_->setRowCount(static_cast<int>(cases_.size()));
    names.emplace_back();  // all of them
    zones_->setColumnCount(static_cast<int>(4 * names.size()));
    QStringList titles, rows;
    int column = 0;
    for (const auto& name : names) {
        const QString title = name.empty() ? QString("all") : qt(name);
        titles << title + ": lift (N)"
               << "less the first" << title + ": drag (N)"
               << "less the first";
        for (const auto part : {&postproc::NamedLoads::lift_force, &postproc::NamedLoads::drag_force}) {
            const double first = cases_.empty() ? std::nan("") : on_zone(cases_.front(), name, part);
            for (std::size_t i = 0; i < cases_.size(); ++i) {
                const double value = on_zone(cases_[i], name, part);
                put(*zones_, static_cast<int>(i), column, shown(value));
                put(*zones_, static_cast<int>(i), column + 1, i > 0 ? shown(value - first, 3) : QString("–"));
            }
            zones_->setColumnHidden(column + 1, cases_.size() < 2);  // the first less the first
            column += 2;
        }
    }
    for (const auto& one : cases_) {
        rows << qt(one.name);
    }
    zones_->setHorizontalHeaderLabels(titles);
    zones_->setVerticalHeaderLabels(rows);
    zones_->resizeColumnsToContents();
}

void CompareNumbers::draw_along() {
    const Quantity& quantity = compared[static_cast<std::size_t>(std::max(0, along_what_->currentIndex()))];
    core::Figure figure;
    figure.x = {"forward of the reference point", "mm", 0, 0, false};
    figure.y = {quantity.title, quantity.unit, 0, 0, false};
    figure.title = std::string(quantity.title) + " of what lies behind" + (differences_ ? ", less the first" : "");
    const ComparedCase* first = nullptr;
    for (std::size_t i = 0; i < cases_.size(); ++i) {
        const auto& one = cases_[i];
        if (!one.loads || one.loads->stations.empty()) {
            continue;
        }
        first = first == nullptr ? &one : first;
        if (differences_ && &one == first && cases_.size() > 1) {
            continue;
        }
        core::FigureCurve curve;
        curve.name = one.name;
        curve.colour = core::palette(i);
        for (const auto& station : one.loads->stations) {
            curve.x.push_back(1000 * station.position);
            curve.y.push_back(station.behind.*quantity.part -
                              (differences_ ? at(first->loads->stations, station.position, quantity.part) : 0));
        }
        figure.curves.push_back(std::move(curve));
    }
    if (figure.curves.empty()) {
        along_->show_text(cases_.empty() || cases_.front().why.empty() ? QString("…") : qt(cases_.front().why));
    } else {
        along_->show_figure(figure, true);
    }
}

/// Tables of one quantity over the gap alone: the chosen ones, else those that hold one of the cases.
std::vector<const cases::TableSpec*> CompareNumbers::tables_of_cases() const {
    const auto& session = desk_.session();
    const auto chosen = desk_.state().selected("table");
    std::vector<const cases::TableSpec*> specs;
    for (const auto& spec : session.study.tables) {
        bool wanted = std::find(chosen.begin(), chosen.end(), spec.name) != chosen.end();
        for (const auto& one : session.study.cases) {
            const bool compared_here = std::any_of(cases_.begin(), cases_.end(),
                                                   [&](const auto& shown) { return shown.id == "case/" + one.name; });
            wanted = wanted ||
                     (chosen.size() < 2 && compared_here && spec.shape.empty() && one.conditions.satisfies(spec.where));
        }
        const bool fits =
            spec.axes.size() == 1 &&
            (specs.empty() || (specs.front()->quantity == spec.quantity && specs.front()->axes == spec.axes));
        if (wanted && fits) {
            specs.push_back(&spec);
        }
    }
    return specs;
}

void CompareNumbers::ask_tables() {
    if (currentIndex() != 3) {
        return;
    }
    const auto specs = tables_of_cases();
    std::string key = desk_.session().folder.string();
    for (const auto* spec : specs) {
        key += "\n" + spec->name;
    }
    const bool ready = std::all_of(specs.begin(), specs.end(), [&](const cases::TableSpec* spec) {
        return cases::has_loads(*spec, desk_.session().results);
    });
    if (specs.size() < 2 || !ready) {
        tables_of_.clear();
        tables_said_->clear();
        tables_->show_text(
            "Choose cases of two variants that have a [[table]] over one axis, or two such tables in the tree "
            "(Ctrl+click)");
        return;
    }
    if (key == tables_of_) {
        return;
    }
    tables_of_ = key;
    tables_said_->clear();
    tables_->show_text("…");
    std::vector<cases::TableSpec> wanted;
    for (const auto* spec : specs) {
        wanted.push_back(*spec);
    }
    desk_.jobs().start(
        "compare tables", "comparing tables",
        [this, wanted, key, session = desk_.session_pointer()](core::Progress& progress) {
            std::vector<std::pair<std::string, tables::ForceTable>> fitted;
            for (const auto& spec : wanted) {
                progress.check();
                fitted.emplace_back(spec.name, tables::ForceTable::fit(cases::table_points(spec, session->results),
                                                                       spec.quantity, cases::fit_options(spec)));
            }
            auto result = std::make_shared<Compared>();
            result->comparison = tables::compare_tables(fitted, {});
            result->figure = tables::comparison_figure(fitted);
            return [this, result, key] {
                if (key != tables_of_) {
                    return;
                }
                const auto& comparison = result->comparison;
                const auto* axis = core::find_quantity(comparison.axis);
                const std::string unit = result->figure.x.unit;
                const std::string force = result->figure.y.unit;
                const auto in = [&](double value) {
                    return qt(core::format_number(core::convert(value, axis != nullptr ? axis->unit : unit, unit), 3));
                };
                QString text;
                for (const auto& one : comparison.differences) {
                    QString ranges;
                    for (const auto& [low, high] : one.beyond_error) {
                        ranges += (ranges.isEmpty() ? "" : ", ") + in(low) + " to " + in(high);
                        result->figure.lines.push_back({true,
                                                        core::convert(low, axis != nullptr ? axis->unit : unit, unit),
                                                        "",
                                                        {213, 94, 0, 160},
                                                        true});
                        result->figure.lines.push_back({true,
                                                        core::convert(high, axis != nullptr ? axis->unit : unit, unit),
                                                        "",
                                                        {213, 94, 0, 160},
                                                        true});
                    }
                    text += QString("<p><b>%1</b> less <b>%2</b>: ").arg(html(one.second), html(one.first)) +
                            (ranges.isEmpty() ? QString("nowhere beyond twice the joint error")
                                              : QString("beyond twice the joint error at %1 %2 %3")
                                                    .arg(html(comparison.axis), ranges, html(pretty_unit(unit)))) +
                            QString("; at most %1 ± %2 %3, at %4 %5</p>")
                                .arg(shown(one.largest, 3), shown(one.sigma, 2), html(pretty_unit(force)), in(one.at),
                                     html(pretty_unit(unit)));
                }
                tables_said_->setText(text);
                tables_->show_figure(result->figure, true);
            };
        });
}

std::vector<QStringList> CompareNumbers::rows() const {
    std::vector<QStringList> all(1);
    all.front() << "";
    std::vector<int> columns;
    for (int column = 0; column < forces_->columnCount(); ++column) {
        if (!forces_->isColumnHidden(column)) {
            columns.push_back(column);
        }
    }
    for (const int column : columns) {
        all.front() << forces_->horizontalHeaderItem(column)->text();
    }
    for (int row = 0; row < forces_->rowCount(); ++row) {
        QStringList cells = {forces_->verticalHeaderItem(row)->text()};
        for (const int column : columns) {
            cells << (forces_->columnSpan(row, 0) > 1 ? QString("–") : forces_->item(row, column)->text());
        }
        all.push_back(cells);
    }
    return all;
}

std::set<std::pair<std::size_t, int>> CompareNumbers::beyond() const {
    std::set<std::pair<std::size_t, int>> found;
    for (int row = 0; row < forces_->rowCount(); ++row) {
        for (int column = 0, shown = 1; column < forces_->columnCount(); ++column) {
            if (forces_->isColumnHidden(column)) {
                continue;
            }
            if (const auto* item = forces_->item(row, column); item != nullptr && item->font().bold()) {
                found.emplace(static_cast<std::size_t>(row) + 1, shown);
            }
            ++shown;
        }
    }
    return found;
}

core::Table CompareNumbers::table() const {
    core::Table table;
    std::vector<std::string> names;
    for (const auto& one : cases_) {
        names.push_back(one.name);
    }
    table.add_text("case", names);
    for (const auto& quantity : compared) {
        std::vector<double> values, sigmas;
        const auto errors = errors_.find(quantity.name);
        for (const auto& one : cases_) {
            values.push_back(value(one, quantity.name));
            const bool known = errors != errors_.end() && errors->second.contains(one.name);
            sigmas.push_back(known ? errors->second.at(one.name) : std::nan(""));
        }
        table.add_numbers(quantity.name, quantity.unit, values);
        if (std::any_of(sigmas.begin(), sigmas.end(), [](double s) { return std::isfinite(s); })) {
            table.add_numbers(std::string(quantity.name) + "_sigma", quantity.unit, sigmas);
        }
    }
    return table;
}

}  // namespace underbody::studio
