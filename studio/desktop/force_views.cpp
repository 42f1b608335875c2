// Tables: the views of a force table, the first and those beside it, and the axes that they hold.
#include <QComboBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QSignalBlocker>
#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "studio/desktop/force_panel.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::studio {

void ForcePanel::fill_axes() {
    const QSignalBlocker quiet(view_);
    view_->clear();
    const auto& axes = table_->axes();
    for (const auto& axis : axes) {
        view_->addItem("curve over " + qt(axis.name), "curve " + qt(axis.name));
    }
    for (std::size_t i = 0; i < axes.size(); ++i) {
        for (std::size_t k = 0; k < axes.size(); ++k) {
            if (i != k) {
                view_->addItem("curves over " + qt(axes[i].name) + ", one for each " + qt(axes[k].name),
                               "family " + qt(axes[i].name) + " " + qt(axes[k].name));
            }
            if (i < k) {
                view_->addItem("map over " + qt(axes[i].name) + " and " + qt(axes[k].name),
                               "map " + qt(axes[i].name) + " " + qt(axes[k].name));
            }
        }
    }
    const int at = view_->findData(qt(settings().shown));
    view_->setCurrentIndex(at >= 0 ? at : 0);
}

QStringList ForcePanel::view() const { return view_->currentData().toString().split(' '); }

std::vector<Panel::View> ForcePanel::views() const {
    std::vector<View> all;
    for (int i = 0; table_ && i < view_->count(); ++i) {
        const std::string name = view_->itemData(i).toString().toStdString();
        const auto& beside = settings().beside;
        all.push_back({name, view_->itemText(i),
                       i == view_->currentIndex() || std::find(beside.begin(), beside.end(), name) != beside.end()});
    }
    all.push_back({"equilibria", "equilibria", shows("equilibria")});
    return all;
}

/// The first view is that of the list beside; others stand in cells of their own.
void ForcePanel::choose_view(const std::string& name, bool shown) {
    if (name == "equilibria") {
        desk_.act(shown ? Words{"cells", "tables"} : Words{"cells", "tables", "curves"});
        return;
    }
    std::vector<std::string> beside = settings().beside;
    std::string first = view_->currentData().toString().toStdString();
    std::erase(beside, name);
    if (shown) {
        beside.push_back(name);
    } else if (first == name && !beside.empty()) {
        first = beside.front();
        beside.erase(beside.begin());
    }
    std::string others;
    for (const auto& one : beside) {
        others += (others.empty() ? "" : ",") + one;
    }
    desk_.act({"table", spec_.name, "shown=" + first, "beside=" + others});
}

/// Of the axes of a view all others are held.
core::Figure ForcePanel::figure_of(const QStringList& view, tables::FigureOptions options) const {
    options.axis = view.value(1).toStdString();
    const auto& axis = table_->axes()[tables::axis_index(*table_, options.axis)];
    options.logarithmic =
        axis.lower > 0 && settings().logarithmic.value_or(tables::spans_decades(axis.lower, axis.upper));
    for (const auto& one : table_->axes()) {
        if (!view.mid(1).contains(qt(one.name))) {
            options.held.emplace_back(one.name, held_value(one.name));
        }
    }
    const std::string second = view.value(2).toStdString();
    return view.value(0) == "map"      ? tables::map_figure(*table_, options.axis, second, options)
           : view.value(0) == "family" ? tables::family_figure(*table_, options.axis, second, options)
                                       : tables::curve_figure(*table_, options);
}

void ForcePanel::show_beside() {
    std::vector<QStringList> wanted;
    for (const auto& one : settings().beside) {
        if (qt(one) != view_->currentData().toString() && view_->findData(qt(one)) >= 0) {
            wanted.push_back(qt(one).split(' '));
        }
    }
    while (beside_.size() < wanted.size()) {
        beside_.push_back(new PlotView(this));
        connect(beside_.back(), &PlotView::hovered, this, &Panel::remark);
    }
    const int columns = wanted.empty() ? 1 : wanted.size() < 4 ? 2 : 3;
    for (std::size_t i = 0; i < beside_.size(); ++i) {
        grid_->removeWidget(beside_[i]);
        beside_[i]->setVisible(i < wanted.size());
        if (i >= wanted.size()) {
            continue;
        }
        const int place = static_cast<int>(i) + 1;
        grid_->addWidget(beside_[i], place / columns, place % columns);
        try {
            beside_[i]->show_figure(figure_of(wanted[i], {}), true);
        } catch (const core::Error& error) {
            beside_[i]->show_text(qt(error.what()));
        }
    }
}

double ForcePanel::held_value(const std::string& name) const {
    if (const auto at = settings().held.find(name); at != settings().held.end()) {
        return at->second;
    }
    const auto& axis = table_->axes()[tables::axis_index(*table_, name)];
    return axis.lower < 0 && axis.upper > 0 ? 0 : axis.lower;
}

void ForcePanel::fill_held() {
    std::vector<QStringList> seen = {view()};
    QString wanted = qt(spec_.name) + view().join(' ');
    for (const auto& one : settings().beside) {
        seen.push_back(qt(one).split(' '));
        wanted += "," + qt(one);
    }
    if (held_for_ != wanted) {
        for (const auto& held : held_) {
            held_form_->removeRow(held.row);
        }
        held_.clear();
        held_for_ = wanted;
        for (const auto& axis : table_->axes()) {
            if (std::all_of(seen.begin(), seen.end(),
                            [&](const QStringList& one) { return one.mid(1).contains(qt(axis.name)); })) {
                continue;
            }
            auto* row = new ParameterRow(qt(axis.name), "held at this value", axis.unit,
                                         tables::shown_unit(*table_, axis.name));
            held_form_->addRow(row);
            held_.push_back({axis.name, row});
            const auto text = [name = axis.name, unit = axis.unit](double value) {
                return "held." + name + "=" + core::format_number(value) + (unit == "1" ? "" : " " + unit);
            };
            connect(row, &ParameterRow::moved, this,
                    [this, text](double value, const QString& gesture) { act(text(value), gesture); });
            connect(row, &ParameterRow::entered, this, [this, text](double value) { act(text(value)); });
            connect(row, &ParameterRow::released, this, [this] { desk_.end_gesture(); });
        }
    }
    for (const auto& held : held_) {
        const auto& axis = table_->axes()[tables::axis_index(*table_, held.name)];
        held.row->show_value(held_value(held.name), axis.lower, axis.upper, false);
    }
}

void ForcePanel::hide_beside() {
    for (auto* one : beside_) {
        one->hide();
    }
}

}  // namespace underbody::studio
