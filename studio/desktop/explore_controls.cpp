// Explore: what is typed at its head, what varies and which ranges are kept.
#include <QBoxLayout>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QRegularExpression>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "studio/desktop/explore_panel.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

void ExplorePanel::build_head(QVBoxLayout& column) {
    auto* row = new QHBoxLayout;
    what_ = new QComboBox;
    what_->addItems({"Cases of the study", "Shapes that vary"});
    what_->setAccessibleName("What is explored");
    x_ = new QComboBox;
    y_ = new QComboBox;
    for (auto* box : {x_, y_}) {
        box->setSizeAdjustPolicy(QComboBox::AdjustToContents);
    }
    x_->setAccessibleName("Along the scatter plot");
    y_->setAccessibleName("Up the scatter plot");
    brush_ = new QLineEdit;
    brush_->setPlaceholderText("all; or gap=2mm:5mm, pitch=0, lift_force=0:0.3");
    brush_->setAccessibleName("Ranges that are kept");
    brush_->setMinimumWidth(180);
    brush_->setToolTip("The ranges that are dragged on the axes, as numbers: change them and press Enter");
    brush_->setClearButtonEnabled(true);
    count_ = new QLabel;
    auto* clear = new QPushButton("&All");
    clear->setToolTip("Takes every range away");
    row->addWidget(what_);
    row->addWidget(new QLabel("Kept"));
    row->addWidget(brush_, 1);
    row->addWidget(count_);
    row->addWidget(clear);
    column.addLayout(row);
    vary_row_ = new QWidget;
    auto* second = new QHBoxLayout(vary_row_);
    second->setContentsMargins(0, 0, 0, 0);
    vary_ = new QLineEdit;
    vary_->setPlaceholderText("protrusion.height=1mm:3mm:5 body.base_cut=0.6:0.8:4");
    vary_->setAccessibleName("What varies");
    vary_->setToolTip("PARAMETER=FROM:TO:COUNT or PARAMETER=VALUE,VALUE, several with spaces; Enter makes the shapes");
    parameter_ = new QComboBox;
    parameter_->setAccessibleName("Parameter to vary");
    parameter_->addItem("Add a parameter …");
    for (const auto& parameter : geometry::parameter_names()) {
        if (!parameter.unit.empty()) {
            parameter_->addItem(qt(parameter.name));
        }
    }
    take_ = new QPushButton("Take into &Design");
    take_->setToolTip("The numbers of the selected shape, in Design");
    second->addWidget(new QLabel("Vary"));
    second->addWidget(vary_, 1);
    second->addWidget(parameter_);
    second->addWidget(take_);
    column.addWidget(vary_row_);
    const auto axes = [this] {
        desk_.act({"axes", x_->currentData().toString().toStdString(), y_->currentData().toString().toStdString()});
    };
    connect(x_, QOverload<int>::of(&QComboBox::activated), this, axes);
    connect(y_, QOverload<int>::of(&QComboBox::activated), this, axes);
    connect(clear, &QPushButton::clicked, this, [this] { desk_.act({"brush"}); });
    connect(brush_, &QLineEdit::editingFinished, this, &ExplorePanel::type_brush);
    connect(vary_, &QLineEdit::returnPressed, this, &ExplorePanel::type_vary);
    connect(take_, &QPushButton::clicked, this, &ExplorePanel::take_selected);
    connect(what_, QOverload<int>::of(&QComboBox::activated), this, [this](int chosen) {
        desk_.act({"rows", chosen == 0 ? "cases" : "shapes"});
    });
    connect(parameter_, QOverload<int>::of(&QComboBox::activated), this, [this](int chosen) {
        if (chosen > 0) {
            add_parameter(parameter_->itemText(chosen));
            parameter_->setCurrentIndex(0);
        }
    });
}

void ExplorePanel::type_brush() {
    if (!brush_->isModified()) {
        return;
    }
    brush_->setModified(false);
    Words words = {"brush"};
    static const QRegularExpression between(R"(,|\s+(?=[\w.]+\s*=))");  // with commas, or as the log has them
    for (const auto& part : brush_->text().split(between, Qt::SkipEmptyParts)) {
        words.push_back(part.trimmed().toStdString());
    }
    try {  // what is wrong with it is said before what is kept is taken away
        static_cast<void>(applied(state(), words, session()));
        desk_.act({"brush"});
    } catch (const core::Error&) {
    }
    if (words.size() > 1) {
        desk_.act(words);
    }
}

void ExplorePanel::type_vary() {
    Words words = {"vary"};
    for (const auto& part : vary_->text().split(' ', Qt::SkipEmptyParts)) {
        words.push_back(part.toStdString());
    }
    desk_.act(words);
}

/// A fifth to either side of what the shape has, in five steps.
void ExplorePanel::add_parameter(const QString& name) {
    const std::string shape = shown_shape(state(), session());
    double value = NAN;
    try {
        value = geometry::parameter(shape_of(state(), session(), shape), name.toStdString());
    } catch (const core::Error&) {  // the part is not there
    }
    const std::string unit = geometry::parameter_unit(name.toStdString(), {});
    const double step = std::isfinite(value) && value != 0 ? 0.2 * std::abs(value) : unit == "m" ? 0.001 : 0.05;
    const double from = std::isfinite(value) && value != 0 ? value - step : unit == "m" ? step : 0;
    const auto text = [&](double number) {
        std::string written_value = geometry::shown_value(number, unit, 4);
        written_value.erase(std::remove(written_value.begin(), written_value.end(), ' '), written_value.end());
        return qt(written_value);
    };
    vary_->setText(
        (vary_->text().trimmed() + " " + name + "=" + text(from) + ":" + text(from + 2 * step) + ":5").trimmed());
    vary_->setFocus();
}

}  // namespace underbody::studio
