// Explore: the table, the points and the pictures of what is kept.
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QSplitter>
#include <QStackedWidget>
#include <QTabBar>
#include <QTableView>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "core/units.h"
#include "geometry/body/body_figures.h"
#include "studio/desktop/case_pictures.h"
#include "studio/desktop/compare_sheet.h"
#include "studio/desktop/explore_columns.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/kept_rows.h"
#include "studio/desktop/parallel_view.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/side_by_side.h"
#include "studio/figures/render.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {

constexpr std::size_t most_pictures = 60;  ///< more than a sheet can show

}  // namespace

std::vector<const core::Column*> columns_of(const core::Table& table) {
    std::vector<const core::Column*> columns;
    for (const auto& column : table.columns()) {
        bool wanted = !column.is_text();
        for (const char* part :
             {"_sigma", "coefficient", "closure", "smallest_angle", "distance_largest", "volume_error"}) {
            wanted = wanted && column.name.find(part) == std::string::npos;
        }
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

QString axis_words(const std::string& name) { return qt(name).replace('_', ' ').replace('.', ' '); }

std::string unit_of(const core::Column& column) {
    const bool written = column.unit == "m^3" || column.unit == "m^2";
    return written && !column.written_unit.empty() ? column.written_unit : geometry::shown_unit(column.unit);
}

void ExplorePanel::show_cells() {
    const QString pictures = state().explore.shapes ? "Bodies from below" : "Pictures of cases";
    pictures_cell_->set_title(pictures);
    points_or_pictures_->tabs()->setTabText(1, pictures);
    points_or_pictures_->show_right(state().explore.pictures);
    points_or_pictures_->want(shows("points"), shows("pictures"));
    lines_cell_->setVisible(shows("lines"));
    table_cell_->setVisible(shows("table"));
    lower_->setVisible(shows("table") || shows("points") || shows("pictures"));
}

void ExplorePanel::fill_table() {
    const bool shapes = state().explore.shapes;
    const core::Table& all = rows();
    std::vector<KeptRows::Column> columns;
    for (const auto* column : columns_of(all)) {
        const std::string unit = unit_of(*column);
        columns.push_back({qt(axis_title(axis_words(column->name).toStdString(), unit)), column,
                           core::conversion(column->unit, unit)});
    }
    const auto* refused = shapes ? all.find("refused") : nullptr;
    const auto* names = all.find(shapes ? "name" : "case");
    const auto name = [names, held = std::pair(desk_.session_pointer(), shapes_)](std::size_t row) {
        return names != nullptr && names->is_text() ? names->text[row] : std::to_string(row);
    };
    quiet_ = true;
    const bool other = table_rows_->show(
        shapes ? "shape" : "case", std::move(columns), kept_,
        {[name](std::size_t row) { return qt(name(row)); },
         [refused](std::size_t row) {
             return refused != nullptr && refused->text[row] != "-" ? qt(refused->text[row]) : QString();
         },
         [this, name](std::size_t row) { return state().stars.contains("case/" + name(row)); }});
    if (other) {
        table_->resizeColumnsToContents();
        // Names of shapes are long and differ at their ends: their numbers are to be seen beside them.
        table_->setColumnWidth(0, std::min(table_->columnWidth(0), std::max(120, table_->viewport()->width() * 2 / 5)));
        take_->setEnabled(false);
    }
    show_selection();
    quiet_ = false;
}

void ExplorePanel::draw_scatter() {
    const core::Table& table = rows();
    const auto* x = table.find(x_->currentData().toString().toStdString());
    const auto* y = table.find(y_->currentData().toString().toStdString());
    if (x == nullptr || y == nullptr || x->is_text() || y->is_text()) {
        scatter_->show_text(table.rows() == 0 ? QString() : "Choose two columns above");
        return;
    }
    core::Figure figure;
    const auto label = [](const core::Column& column) { return axis_words(column.name).toStdString(); };
    figure.x = {label(*x), unit_of(*x), 0, 0, false};
    figure.y = {label(*y), unit_of(*y), 0, 0, false};
    const auto to_x = core::conversion(x->unit, unit_of(*x));
    const auto to_y = core::conversion(y->unit, unit_of(*y));
    core::FigurePoints all, kept;
    all.name = kept_.size() == table.rows() ? "" : "others";
    all.colour = {150, 150, 150, 110};
    kept.name = kept_.size() == table.rows() ? "" : "kept";
    kept.colour = core::palette(0);
    std::vector<bool> in(table.rows(), false);
    for (const std::size_t row : kept_) {
        in[row] = true;
    }
    for (std::size_t row = 0; row < table.rows(); ++row) {
        auto& points = in[row] ? kept : all;
        if (std::isfinite(x->numbers[row]) && std::isfinite(y->numbers[row])) {
            points.x.push_back(to_x(x->numbers[row]));
            points.y.push_back(to_y(y->numbers[row]));
        }
    }
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const auto* points : {&all, &kept}) {
        for (const double value : points->x) {
            lowest = std::min(lowest, value);
            highest = std::max(highest, value);
        }
    }
    figure.x.logarithmic = lowest > 0 && lowest < highest && tables::spans_decades(lowest, highest);
    if (!all.x.empty()) {
        figure.points.push_back(all);
    }
    if (!kept.x.empty()) {
        figure.points.push_back(kept);
    }
    core::FigurePoints chosen;
    chosen.name = "selected";
    chosen.colour = core::palette(1);
    chosen.size = kept.size + 3;
    for (const std::size_t row : marked()) {
        if (std::isfinite(x->numbers[row]) && std::isfinite(y->numbers[row])) {
            chosen.x.push_back(to_x(x->numbers[row]));
            chosen.y.push_back(to_y(y->numbers[row]));
        }
    }
    if (!chosen.x.empty()) {
        figure.points.push_back(chosen);
    }
    scatter_->show_figure(figure, true);
}

/// The kept bodies, seen from below, or the pictures of the kept cases.
void ExplorePanel::draw_pictures() {
    if (!pictures_cell_->isVisible()) {
        return;
    }
    if (!state().explore.shapes) {
        std::vector<std::string> names;
        for (const std::size_t row : kept_) {
            names.push_back(name_of_row(row));
        }
        cases_->show_cases(names);
        return;
    }
    std::vector<geometry::NamedBody> bodies;
    for (const std::size_t row : shapes_ ? kept_ : std::vector<std::size_t>{}) {
        const auto& made = shapes_->made.at(row);
        if (!made.mesh.triangles.empty() && bodies.size() < most_pictures) {
            bodies.push_back({made.variant->name.substr(made.variant->name.rfind('-') + 1), &made.mesh});
        }
    }
    if (bodies.empty()) {
        bodies_->show_text("No shape is kept");
        return;
    }
    const std::string more = kept_.size() > bodies.size() ? ", the first " + std::to_string(bodies.size()) : "";
    bodies_->show_figure(geometry::sheet_figure(bodies, "kept" + more), true);
}

bool ExplorePanel::has_picture() const {
    return (scatter_->isVisible() && scatter_->has_figure()) || (bodies_->isVisible() && bodies_->has_figure()) ||
           (cases_->isVisible() && cases_->list()->count() > 0) || parallel_->isVisible();
}

/// What is seen: of points and pictures beside each other the one that was asked for last, else the lines.
void ExplorePanel::export_picture(const std::filesystem::path& path) {
    const bool points = scatter_->isVisible() && scatter_->has_figure();
    const bool bodies = bodies_->isVisible() && bodies_->has_figure();
    const bool cases = cases_->isVisible() && cases_->list()->count() > 0;
    if (points && !(state().explore.pictures && (bodies || cases))) {
        scatter_->write(path);
    } else if (bodies) {
        bodies_->write(path);
    } else if (cases) {
        write_sheet(cases_->sheet(), path);
    } else {
        Sheet lines;
        lines.title = count_->text();
        lines.about = qt(session().study.title);
        lines.cells = {{QString(), parallel_->grab().toImage()}};
        write_sheet(lines, path);
    }
}

void ExplorePanel::export_table(const std::filesystem::path& path) { core::write_csv(path, rows().selected(kept_)); }

}  // namespace underbody::studio
