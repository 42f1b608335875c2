#include "studio/desktop/explore_panel.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTableWidget>
#include <cmath>

#include "core/table.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

/// Columns of numbers that are looked at: conditions and the main loads, not their errors.
std::vector<const core::Column*> columns_of(const core::Table& loads) {
    std::vector<const core::Column*> columns;
    for (const auto& column : loads.columns()) {
        const bool wanted = !column.is_text() && column.name.find("_sigma") == std::string::npos &&
                            column.name.find("coefficient") == std::string::npos &&
                            column.name.find("closure") == std::string::npos;
        if (!wanted) {
            continue;
        }
        double first = NAN;
        bool varies = false;
        for (const double value : column.numbers) {
            varies = varies || (std::isfinite(first) && std::isfinite(value) && value != first);
            first = std::isfinite(first) ? first : value;
        }
        if (varies && columns.size() < 9) {
            columns.push_back(&column);
        }
    }
    return columns;
}

std::string unit_of(const core::Column& column) {
    return column.unit == "m" ? "mm" : column.unit == "rad" ? "deg" : column.unit;
}

}  // namespace

ExplorePanel::ExplorePanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
    setObjectName("explore");
    auto* column = new QVBoxLayout(this);
    auto* row = new QHBoxLayout;
    x_ = new QComboBox;
    y_ = new QComboBox;
    x_->setAccessibleName("Along the scatter plot");
    y_->setAccessibleName("Up the scatter plot");
    count_ = new QLabel;
    auto* clear = new QPushButton("&All cases");
    row->addWidget(new QLabel("Scatter of"));
    row->addWidget(y_);
    row->addWidget(new QLabel("over"));
    row->addWidget(x_);
    row->addStretch(1);
    row->addWidget(count_);
    row->addWidget(clear);
    column->addLayout(row);
    auto* halves = new QSplitter(Qt::Vertical);
    column->addWidget(halves, 1);
    parallel_ = new ParallelView(this);
    halves->addWidget(parallel_);
    auto* lower = new QSplitter(Qt::Horizontal);
    table_ = new QTableWidget;
    table_->setAccessibleName("Cases that are kept");
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->verticalHeader()->setDefaultSectionSize(21);
    scatter_ = new PlotView(this);
    lower->addWidget(table_);
    lower->addWidget(scatter_);
    halves->addWidget(lower);
    halves->setSizes({260, 340});
    connect(scatter_, &PlotView::hovered, this, &Panel::remark);
    const auto axes = [this] { desk_.act({"axes", x_->currentText().toStdString(), y_->currentText().toStdString()}); };
    connect(x_, QOverload<int>::of(&QComboBox::activated), this, axes);
    connect(y_, QOverload<int>::of(&QComboBox::activated), this, axes);
    connect(clear, &QPushButton::clicked, this, [this] { desk_.act({"brush"}); });
    connect(parallel_, &ParallelView::brushed, this, [this](const QString& name, double low, double high) {
        desk_.act({"brush", name.toStdString() + "=" +
                                (low < high ? core::format_number(low, 6) + ":" + core::format_number(high, 6)
                                            : std::string())});
    });
    connect(table_, &QTableWidget::itemSelectionChanged, this, [this] {
        Words words = {"select"};
        for (const auto& index : table_->selectionModel()->selectedRows()) {
            words.push_back("case/" + table_->item(index.row(), 0)->text().toStdString());
        }
        if (words.size() > 1) {
            desk_.act(words);
        }
    });
}

void ExplorePanel::draw_again(bool fresh) {
    const core::Table& loads = session().results.loads;
    const auto columns = columns_of(loads);
    if (fresh) {
        std::vector<ParallelView::Axis> axes;
        for (const auto* column : columns) {
            const std::string unit = unit_of(*column);
            axes.push_back({column->name, qt(axis_title(column->name, unit)), core::convert(1, column->unit, unit),
                            column->numbers, 0, 1});
        }
        parallel_->show_axes(std::move(axes));
    }
    const QSignalBlocker quiet_x(x_), quiet_y(y_);
    for (auto* box : {x_, y_}) {
        box->clear();
        for (const auto* column : columns) {
            box->addItem(qt(column->name));
        }
    }
    x_->setCurrentText(qt(state().explore.x));
    y_->setCurrentText(qt(state().explore.y));
    kept_.clear();
    for (std::size_t row = 0; row < loads.rows(); ++row) {
        bool in = true;
        for (const auto& [name, range] : state().explore.brush) {
            const auto* column = loads.find(name);
            const double value = column != nullptr && !column->is_text() ? column->numbers[row] : NAN;
            in = in && value >= range[0] && value <= range[1];
        }
        if (in) {
            kept_.push_back(row);
        }
    }
    parallel_->show_brush(state().explore.brush, kept_);
    count_->setText(QString("%1 of %2 cases").arg(kept_.size()).arg(loads.rows()));
    fill_table();
    draw_scatter();
}

void ExplorePanel::fill_table() {
    const QSignalBlocker quiet(table_);
    const core::Table& loads = session().results.loads;
    const auto columns = columns_of(loads);
    const auto* names = loads.find("case");
    QStringList titles = {"case"};
    for (const auto* column : columns) {
        titles << qt(axis_title(column->name, unit_of(*column)));
    }
    table_->setColumnCount(titles.size());
    table_->setHorizontalHeaderLabels(titles);
    const std::size_t rows = std::min<std::size_t>(kept_.size(), 2000);
    table_->setRowCount(static_cast<int>(rows));
    for (std::size_t i = 0; i < rows; ++i) {
        const std::string name = names != nullptr && names->is_text() ? names->text[kept_[i]] : std::to_string(i);
        const bool starred = state().stars.contains("case/" + name);
        auto* first = new QTableWidgetItem(qt(name));
        first->setIcon({});
        first->setToolTip(starred ? "starred" : "");
        QFont font = table_->font();
        font.setBold(starred);
        first->setFont(font);
        table_->setItem(static_cast<int>(i), 0, first);
        for (std::size_t k = 0; k < columns.size(); ++k) {
            const double value = core::convert(columns[k]->numbers[kept_[i]], columns[k]->unit, unit_of(*columns[k]));
            auto* item = new QTableWidgetItem(std::isfinite(value) ? qt(core::format_number(value, 4)) : QString("–"));
            item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
            table_->setItem(static_cast<int>(i), static_cast<int>(k) + 1, item);
        }
    }
    table_->resizeColumnsToContents();
}

void ExplorePanel::draw_scatter() {
    const core::Table& loads = session().results.loads;
    const auto* x = loads.find(state().explore.x);
    const auto* y = loads.find(state().explore.y);
    if (x == nullptr || y == nullptr || x->is_text() || y->is_text()) {
        scatter_->show_text("Choose two columns above");
        return;
    }
    core::Figure figure;
    figure.x = {x->name, unit_of(*x), 0, 0, false};
    figure.y = {y->name, unit_of(*y), 0, 0, false};
    const auto to_x = core::conversion(x->unit, unit_of(*x));
    const auto to_y = core::conversion(y->unit, unit_of(*y));
    core::FigurePoints all, kept;
    all.name = kept_.size() == loads.rows() ? "" : "others";
    all.colour = {150, 150, 150, 110};
    kept.name = kept_.size() == loads.rows() ? "" : "kept";
    kept.colour = core::palette(0);
    std::vector<bool> in(loads.rows(), false);
    for (const std::size_t row : kept_) {
        in[row] = true;
    }
    for (std::size_t row = 0; row < loads.rows(); ++row) {
        auto& points = in[row] ? kept : all;
        if (std::isfinite(x->numbers[row]) && std::isfinite(y->numbers[row])) {
            points.x.push_back(to_x(x->numbers[row]));
            points.y.push_back(to_y(y->numbers[row]));
        }
    }
    if (!all.x.empty()) {
        figure.points.push_back(all);
    }
    if (!kept.x.empty()) {
        figure.points.push_back(kept);
    }
    scatter_->show_figure(figure, true);
}

bool ExplorePanel::has_picture() const { return scatter_->has_figure(); }
void ExplorePanel::export_picture(const std::filesystem::path& path) { scatter_->write(path); }
void ExplorePanel::export_table(const std::filesystem::path& path) {
    core::write_csv(path, session().results.loads.selected(kept_));
}

}  // namespace underbody::studio
