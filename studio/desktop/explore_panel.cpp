#include "studio/desktop/explore_panel.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSplitter>
#include <QStackedWidget>
#include <QTableView>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

#include "core/table_rows.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/case_pictures.h"
#include "studio/desktop/explore_columns.h"
#include "studio/desktop/kept_rows.h"
#include "studio/desktop/natural_order.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/side_by_side.h"
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {

QString in_unit(double value, const core::Column& column) {
    const std::string unit = unit_of(column);
    return qt(core::format_number(core::convert(value, column.unit, unit), 4)) + (unit == "1" ? "" : qt(unit));
}

std::string written(const geometry::Vary& vary) {
    std::string values;
    for (const auto& value : vary.values) {
        values += (values.empty() ? "" : ",") + value;
    }
    values.erase(std::remove(values.begin(), values.end(), ' '), values.end());
    return vary.key + "=" + values;
}

}  // namespace

ExplorePanel::ExplorePanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
    setObjectName("explore");
    auto* column = new QVBoxLayout(this);
    build_head(*column);
    build_views(*column);
}

void ExplorePanel::build_views(QVBoxLayout& column) {
    auto* halves = new QSplitter(Qt::Vertical);
    column.addWidget(halves, 1);
    parallel_ = new ParallelView(this);
    lines_cell_ = new ViewCell(*this, "lines", "Lines", parallel_);
    halves->addWidget(lines_cell_);
    lower_ = new QSplitter(Qt::Horizontal);
    table_ = new QTableView;
    table_->setTextElideMode(Qt::ElideMiddle);
    table_rows_ = new KeptRows(table_);
    table_->setModel(table_rows_);
    table_->horizontalHeader()->setResizeContentsPrecision(60);  // rows that a width is made for: of ten thousand, some
    table_->setAccessibleName("What is kept");
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->verticalHeader()->setDefaultSectionSize(21);
    scatter_ = new PlotView(this);
    bodies_ = new PlotView(this);
    cases_ = new CasePictures(desk_, this);
    pictures_ = new QStackedWidget;
    pictures_->addWidget(bodies_);
    pictures_->addWidget(cases_);
    constexpr int room = 640;  // px: narrower ones are too small to compare anything
    table_cell_ = new ViewCell(*this, "table", "Table", table_);
    pictures_cell_ = new ViewCell(*this, "pictures", "Pictures", pictures_);
    pictures_cell_->on_show = [this] { draw_pictures(); };
    auto* points = new QWidget;
    auto* over_each_other = new QVBoxLayout(points);
    over_each_other->setContentsMargins(0, 0, 0, 0);
    auto* axes = new QHBoxLayout;
    axes->addWidget(y_);
    axes->addWidget(new QLabel("over"));
    axes->addWidget(x_);
    axes->addStretch(1);
    over_each_other->addLayout(axes);
    over_each_other->addWidget(scatter_, 1);
    points_or_pictures_ =
        new SideBySide(new ViewCell(*this, "points", "Points", points), "Points", pictures_cell_, "Pictures", room);
    lower_->addWidget(table_cell_);
    lower_->addWidget(points_or_pictures_);
    lower_->setSizes({500, 500});
    lower_->setStretchFactor(0, 1);
    lower_->setStretchFactor(1, 1);
    halves->addWidget(lower_);
    halves->setSizes({260, 340});
    connect(scatter_, &PlotView::hovered, this, &Panel::remark);
    connect(points_or_pictures_->tabs(), &QTabBar::currentChanged, this, [this](int tab) {
        desk_.act({"show", tab == 1 ? "pictures" : "points"});
    });
    connect(parallel_, &ParallelView::brushed, this, [this](const QString& name, double low, double high) {
        desk_.act({"brush", name.toStdString() + "=" +
                                (low < high ? core::format_number(low, 6) + ":" + core::format_number(high, 6)
                                            : std::string())});
    });
    connect(parallel_, &ParallelView::reordered, this, [this](const QStringList& names) {
        Words words = {"order"};
        for (const auto& name : names) {
            words.push_back(name.toStdString());
        }
        desk_.act(words);
    });
    connect(cases_, &CasePictures::hovered, this, [this](const QString& name) {
        const auto at = std::find_if(kept_.begin(), kept_.end(),
                                     [&](std::size_t row) { return name_of_row(row) == name.toStdString(); });
        parallel_->point_out(name.isEmpty() || at == kept_.end() ? std::nullopt : std::optional(*at));
    });
    connect(table_->selectionModel(), &QItemSelectionModel::selectionChanged, this, &ExplorePanel::take_selection);
    connect(table_, &QTableView::activated, this, [this] {  // Enter
        state().explore.shapes ? take_selected() : static_cast<void>(desk_.act({"workspace", "compare"}));
    });
}

void ExplorePanel::take_selection() {
    const auto chosen = table_->selectionModel()->selectedRows();
    take_->setEnabled(state().explore.shapes && !chosen.isEmpty());
    Words words = {"select"};
    for (const auto& index : chosen) {
        words.push_back("case/" + index.data().toString().toStdString());
    }
    if (words.size() > 1 && !state().explore.shapes && !quiet_) {
        desk_.act(words);
    }
}

std::vector<std::size_t> ExplorePanel::marked() const {
    const auto names = state().selected("case");
    const std::set<std::string> chosen(names.begin(), names.end());
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < this->rows().rows() && !chosen.empty() && !state().explore.shapes; ++row) {
        if (chosen.contains(name_of_row(row))) {
            rows.push_back(row);
        }
    }
    return rows;
}

/// Rows that follow one another are one range, as in the tree.
void ExplorePanel::show_selection() {
    const auto of_cases = marked();
    const std::set<std::size_t> chosen(of_cases.begin(), of_cases.end());
    QItemSelection wanted;
    const auto count = static_cast<int>(kept_.size());
    for (int row = 0, next = 0; row < count; row = next + 1) {
        for (next = row; next < count && chosen.contains(kept_[static_cast<std::size_t>(next)]);) {
            ++next;
        }
        if (next > row) {
            wanted.select(table_rows_->index(row, 0), table_rows_->index(next - 1, table_rows_->columnCount() - 1));
        }
    }
    if (!state().explore.shapes && wanted != table_->selectionModel()->selection()) {
        table_->selectionModel()->select(wanted, QItemSelectionModel::ClearAndSelect);
    }
}

const core::Table& ExplorePanel::rows() const {
    static const core::Table none;
    return !state().explore.shapes ? session().results.loads : shapes_ ? shapes_->table : none;
}

std::string ExplorePanel::name_of_row(std::size_t row) const {
    const auto* names = rows().find(state().explore.shapes ? "name" : "case");
    return names != nullptr && names->is_text() ? names->text[row] : std::to_string(row);
}

/// Only the shape's numbers: the parameters that vary and were changed.
void ExplorePanel::take_selected() {
    const auto chosen = table_->selectionModel()->selectedRows();
    if (chosen.isEmpty() || !shapes_) {
        return;
    }
    const std::size_t row = kept_.at(static_cast<std::size_t>(chosen.front().row()));
    Words words = {"set"};
    for (std::size_t k = 0; k < shapes_->set.keys.size(); ++k) {
        words.push_back(shapes_->set.keys[k] + "=" + shapes_->set.variants.at(row).values[k]);
    }
    if (desk_.act(words)) {
        desk_.act({"workspace", "design"});
    }
}

/// The shapes are those of the state; another shape or range, other shapes.
void ExplorePanel::ask_shapes() {
    const auto& wanted = state().explore;
    if (!wanted.shapes) {
        return;  // those that were made stay for the way back
    }
    const std::string name = shown_shape(state(), session());
    std::string key;
    geometry::BodyShape shape;
    if (!wanted.vary.empty() && !name.empty()) {
        try {
            shape = shape_of(state(), session(), name);
            key = geometry::shape_hash(shape);
        } catch (const core::Error&) {  // Design says why
        }
        for (const auto& one : wanted.vary) {
            key += "\n" + written(one);
        }
    }
    if (key == shapes_of_) {
        return;
    }
    shapes_of_ = key;
    shapes_.reset();
    jobs_.cancel("explore shapes");
    if (key.empty()) {
        return;
    }
    jobs_.start("explore shapes", "shapes of " + qt(name),
                [this, shape, name, varies = wanted.vary, key](core::Progress& progress) {
                    auto made = std::make_shared<MadeShapes>();
                    made->set = geometry::variants_of(shape, name, varies);
                    made->made = geometry::make_variants(made->set, 3000, progress);
                    made->table = geometry::table(made->set, made->made);
                    return [this, made, key] {
                        if (key == shapes_of_) {
                            shapes_ = made;
                            draw_again(false);
                        }
                    };
                });
}

void ExplorePanel::show_axes() {
    std::string key = state().explore.shapes ? shapes_of_ + (shapes_ ? " made" : "") : "cases";
    key += " " + std::to_string(reinterpret_cast<std::uintptr_t>(desk_.session_pointer().get()));
    const auto& order = state().explore.order;
    const std::string in_order = line_of(order);
    if (key == axes_of_ && in_order == order_of_) {
        return;
    }
    order_of_ = in_order;
    axes_of_ = key;
    std::vector<ParallelView::Axis> axes;
    for (const auto* column : columns_of(rows())) {
        const std::string unit = unit_of(*column);
        axes.push_back({column->name, qt(axis_title(column->name, unit)).replace("N m", "N\u00a0m"),
                        core::convert(1, column->unit, unit), column->numbers, 0, 1});
    }
    const auto place = [&order](const ParallelView::Axis& axis) {
        return std::find(order.begin(), order.end(), axis.name) - order.begin();
    };
    std::stable_sort(axes.begin(), axes.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
    parallel_->show_axes(std::move(axes));
}

void ExplorePanel::draw_again(bool) {
    ask_shapes();
    const bool shapes = state().explore.shapes;
    what_->setCurrentIndex(shapes ? 1 : 0);
    vary_row_->setVisible(shapes);
    show_cells();
    pictures_->setCurrentIndex(shapes ? 0 : 1);
    if (!vary_->hasFocus() || vary_->text().isEmpty()) {
        QStringList parts;
        for (const auto& one : state().explore.vary) {
            parts << qt(written(one));
        }
        vary_->setText(parts.join(' '));
    }
    show_axes();
    const core::Table& table = rows();
    const auto columns = columns_of(table);
    const QSignalBlocker quiet_x(x_), quiet_y(y_);
    for (auto* box : {x_, y_}) {
        box->clear();
        for (const auto* column : columns) {
            box->addItem(axis_words(column->name), qt(column->name));
        }
    }
    x_->setCurrentIndex(x_->findData(qt(state().explore.x)));
    y_->setCurrentIndex(y_->findData(qt(state().explore.y)));
    x_->setCurrentIndex(std::max(0, x_->currentIndex()));  // what was chosen is not there
    y_->setCurrentIndex(std::max(0, y_->currentIndex()));
    if (y_->currentIndex() == x_->currentIndex() && y_->count() > 1) {
        y_->setCurrentIndex(x_->currentIndex() == y_->count() - 1 ? 0 : y_->count() - 1);
    }
    std::vector<core::NamedRange> ranges;  // those of other columns are of the other rows
    QStringList said;
    for (const auto& [name, range] : state().explore.brush) {
        if (const auto* column = table.find(name); column != nullptr && !column->is_text()) {
            ranges.push_back({name, range[0], range[1]});
            said << qt(name) + "=" + in_unit(range[0], *column) +
                        (range[0] < range[1] ? ":" + in_unit(range[1], *column) : QString());
        }
    }
    kept_ = core::rows_within(table, ranges);
    sort_kept();
    if (!brush_->isModified()) {
        brush_->setText(said.join(", "));
        brush_->setModified(false);
    }
    parallel_->show_brush(state().explore.brush, kept_, marked());
    show_count();
    fill_table();
    draw_scatter();
    draw_pictures();
}

/// By name, as the tree does. Where a name stands among all is found once for all that is brushed.
void ExplorePanel::sort_kept() {
    if (ranks_of_ != axes_of_ || ranks_.size() != rows().rows()) {
        ranks_of_ = axes_of_;
        std::vector<QString> names;
        for (std::size_t row = 0; row < rows().rows(); ++row) {
            names.push_back(qt(name_of_row(row)));
        }
        ranks_ = natural_ranks(names);
    }
    std::sort(kept_.begin(), kept_.end(), [this](std::size_t a, std::size_t b) { return ranks_[a] < ranks_[b]; });
}

void ExplorePanel::show_count() {
    const core::Table& table = rows();
    QString text = QString("%1 of %2").arg(kept_.size()).arg(table.rows());
    if (state().explore.shapes) {
        std::size_t refused = 0;
        for (const auto& variant : shapes_ ? shapes_->set.variants : std::vector<geometry::Variant>{}) {
            refused += variant.refused.empty() ? 0 : 1;
        }
        text += " shapes";
        text += refused > 0 ? QString(", %1 cannot be made").arg(refused) : QString();
        parallel_->say(state().explore.vary.empty() ? "Add parameters of " + qt(shown_shape(state(), desk_.session())) +
                                                          " that vary, and press Enter"
                       : shapes_of_.empty() ? QString("The shape cannot be made")
                                            : QString("The shapes are being made …"));
    } else {
        text += " cases";
        parallel_->say("No loads are computed yet: Study > Compute what changed (Ctrl+R)");
    }
    count_->setText(text);
}

}  // namespace underbody::studio
