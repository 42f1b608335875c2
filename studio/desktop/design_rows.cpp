// Design: the numbers of the shape and of its operation, in rows under the parts that they are of.
#include <QBoxLayout>
#include <QComboBox>
#include <QLabel>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QTimer>
#include <QToolButton>
#include <algorithm>
#include <cmath>

#include "core/told.h"
#include "geometry/body/variants.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

namespace {

/// As it stands in files and commands: "2 mm".
std::string written(double value, const std::string& unit) { return core::told(value, unit, 12); }

}  // namespace

void DesignPanel::connect_row(ParameterRow* row, const std::string& verb, const std::string& key,
                              const std::string& unit) {
    const auto text = [key, unit](double value) { return key + "=" + written(value, unit); };
    connect(row, &ParameterRow::moved, this, [this, verb, text](double value, const QString& gesture) {
        desk_.act({verb, text(value)}, gesture);
    });
    connect(row, &ParameterRow::entered, this, [this, verb, text](double value) { desk_.act({verb, text(value)}); });
    connect(row, &ParameterRow::released, this, [this] {
        desk_.end_gesture();
        rest_->start();
    });
}

QVBoxLayout& DesignPanel::add_group(const std::string& part) {
    auto* head = new QToolButton;
    head->setObjectName("fold " + qt(part));
    head->setAccessibleName("Fold " + qt(part).replace('_', ' '));
    head->setToolTip("Folds these numbers away, or shows them");
    head->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    head->setAutoRaise(true);
    QFont bold = head->font();
    bold.setBold(true);
    head->setFont(bold);
    auto* rows = new QWidget;
    auto* column = new QVBoxLayout(rows);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(1);
    parameter_column_->addWidget(head);
    parameter_column_->addWidget(rows);
    groups_.push_back({part, head, rows, {}});
    connect(head, &QToolButton::clicked, this, [this, at = groups_.size() - 1] {
        groups_[at].chosen = groups_[at].rows->isHidden();
        show_groups();
        ask_ranges();
        if (*groups_[at].chosen) {
            show_group(groups_[at]);
        }
    });
    return *column;
}

/// As much of it as there is room for, its head above; once its rows have their place.
void DesignPanel::show_group(const Group& group) {
    QTimer::singleShot(0, this, [this, rows = group.rows, head = group.head] {
        parameter_area_->ensureWidgetVisible(rows, 0, 0);
        parameter_area_->ensureWidgetVisible(head, 0, 0);
    });
}

void DesignPanel::find_row(const QString& parameter) {
    const auto at =
        std::find_if(rows_.begin(), rows_.end(), [&](const auto& row) { return qt(row.first) == parameter; });
    if (at == rows_.end() || !isEnabled()) {
        return;
    }
    for (auto& group : groups_) {
        if (parameter.startsWith(qt(group.part) + ".") && group.rows->isHidden()) {
            group.chosen = true;
        }
    }
    show_groups();
    ask_ranges();
    QTimer::singleShot(0, this, [this, row = at->second] {  // once it has its place
        parameter_area_->ensureWidgetVisible(row);
        row->number()->setFocus(Qt::ShortcutFocusReason);
        row->number()->selectAll();
    });
}

void DesignPanel::show_groups() {
    for (const auto& group : groups_) {
        const bool there = group.part == "operation" || geometry::has_part_of(shape_, group.part + ".");
        const bool open = group.chosen.value_or(there);
        group.head->setText(qt(group.part).replace('_', ' ') + (there ? "" : " (none)"));
        group.head->setArrowType(open ? Qt::DownArrow : Qt::RightArrow);
        group.rows->setVisible(open);
    }
}

std::set<std::string> DesignPanel::open_groups() const {
    std::set<std::string> parts;
    for (const auto& group : groups_) {
        if (!group.rows->isHidden()) {
            parts.insert(group.part);
        }
    }
    return parts;
}

/// What is chosen of a part by a word: the outline of the base, the profile of the protrusion.
void DesignPanel::add_words(const std::string& part, QVBoxLayout& column) {
    for (const auto& word : geometry::parameter_names()) {
        if (!word.unit.empty() || !word.name.starts_with(part + ".")) {
            continue;
        }
        auto* box = new QComboBox;
        box->setAccessibleName(qt(word.name));
        if (word.name == "body.base") {
            for (const auto& base : geometry::base_names()) {
                box->addItem(qt(base));
            }
        } else {
            box->addItems({"rounded", "sharp"});
        }
        connect(box, QOverload<int>::of(&QComboBox::activated), this, [this, box, name = word.name] {
            desk_.act({"set", name + "=" + box->currentText().toStdString()});
        });
        auto* line = new QHBoxLayout;
        line->addWidget(new QLabel(qt(word.name.substr(word.name.find('.') + 1))));
        line->addWidget(box, 1);
        column.addLayout(line);
        words_.emplace_back(word.name, box);
    }
}

void DesignPanel::make_rows() {
    std::string part;
    QVBoxLayout* column = nullptr;
    for (const auto& parameter : geometry::parameter_names()) {
        const std::string of = parameter.name.substr(0, parameter.name.find('.'));
        if (parameter.unit.empty()) {
            continue;
        }
        if (of != part) {
            part = of;
            column = &add_group(part);
            add_words(part, *column);
        }
        auto* row =
            new ParameterRow(qt(parameter.name), {}, parameter.unit, std::string(core::told_unit(parameter.unit)));
        column->addWidget(row);
        rows_.emplace_back(parameter.name, row);
        connect_row(row, "set", parameter.name, parameter.unit);
        connect(row, &ParameterRow::reset, this, [this, name = parameter.name] { desk_.act({"reset", name}); });
    }
    column = &add_group("operation");
    gap_ = new ParameterRow("gap", "under the centre of the base", "m", "mm");
    pitch_ = new ParameterRow("pitch", "nose up positive", "rad", "deg");
    speed_ = new ParameterRow("speed", "through the water, where the surrogate knows several", "m/s", "m/s");
    for (const auto& [row, unit] : {std::pair{gap_, "m"}, {pitch_, "rad"}, {speed_, "m/s"}}) {
        column->addWidget(row);
        connect_row(row, "operation", row->objectName().toStdString(), unit);
    }
    speed_->hide();
    parameter_column_->addStretch(1);
}

/// The library decides what a number may be; asking it about all that are seen takes a while, so a job does, when the
/// hand rests. What is known of a shape before stays until then.
void DesignPanel::ask_ranges() {
    const auto parts = open_groups();
    std::string key = geometry::shape_hash(shape_);
    for (const auto& part : parts) {
        key += " " + part;
    }
    if (ranges_of_ == key) {
        return;
    }
    ranges_of_ = key;
    jobs_.start(
        "design ranges", "limits",
        [this, shape = shape_, parts, key](core::Progress& progress) {
            const auto ranges = allowed_ranges(shape, parts, progress);
            return [this, ranges, key] {
                if (key == ranges_of_) {
                    ranges_ = ranges;
                    fill_rows(name_, shape_);
                }
            };
        },
        true);
}

void DesignPanel::fill_rows(const std::string& name, const geometry::BodyShape& shape) {
    const auto changed = state().design.changes.find(name);
    const auto is_changed = [&](const std::string& parameter) {
        return changed != state().design.changes.end() && changed->second.contains(parameter);
    };
    for (const auto& [parameter, row] : rows_) {
        std::optional<double> value;
        try {
            value = geometry::parameter(shape, parameter);
        } catch (const core::Error&) {  // the part is not there
        }
        if (value && !std::isfinite(*value)) {
            value.reset();
        }
        const auto range = ranges_.find(parameter);
        const double size = 2 * std::abs(value.value_or(0));
        row->show_value(value, range != ranges_.end() ? range->second[0] : 0,
                        range != ranges_.end() ? range->second[1] : size, is_changed(parameter));
    }
    for (const auto& [parameter, box] : words_) {
        const QSignalBlocker quiet(box);
        const bool base = parameter == "body.base";
        box->setCurrentText(base               ? qt(geometry::name_of(shape.base))
                            : shape.protrusion ? qt(geometry::name_of(shape.protrusion->profile))
                                               : QString("rounded"));
    }
    gap_->show_value(state().design.gap, 0.0005, 0.05, false);
    pitch_->show_value(state().design.pitch, -0.1, 0.1, false);
    speed_->show_value(state().design.speed, 0.1, 5, false);
}

}  // namespace underbody::studio
