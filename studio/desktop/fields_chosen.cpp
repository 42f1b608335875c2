// Compare: what is chosen in the 3D view and at its side: the time, the place whose values are read off, the zones of
// the body, the plane of a half model.
#include <QApplication>
#include <QBoxLayout>
#include <QClipboard>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMenu>
#include <QPushButton>
#include <QSignalBlocker>
#include <QToolButton>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.h"
#include "core/text.h"
#include "postproc/field/times.h"
#include "postproc/loads/body_zones.h"
#include "postproc/probe/probe.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"

namespace underbody::studio {

QWidget* FieldsPanel::build_time() {
    time_row_ = new QWidget;
    auto* row = new QHBoxLayout(time_row_);
    row->setContentsMargins(0, 0, 0, 0);
    row->setSpacing(2);
    const auto add_step = [&](const QString& text, const QString& name, const QString& key, int by) {
        auto* button = new QToolButton;
        button->setText(text);
        button->setAccessibleName(name);
        button->setToolTip(name + " (" + key + ")");
        button->setShortcut(QKeySequence(key));
        button->setAutoRepeat(true);
        row->addWidget(button);
        connect(button, &QToolButton::clicked, this, [this, by] { step_time(by); });
    };
    add_step("◀", "Earlier", "Alt+Left", -1);
    time_ = new QComboBox;
    time_->setEditable(true);
    time_->setInsertPolicy(QComboBox::NoInsert);
    time_->setAccessibleName("Time");
    time_->setToolTip(
        "Of files with several times (OpenFOAM, EnSight, CGNS, .pvd): the one that is shown; empty: the last");
    time_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    time_->lineEdit()->setAccessibleName("Time");
    row->addWidget(time_, 1);
    add_step("▶", "Later", "Alt+Right", 1);
    connect(time_, QOverload<int>::of(&QComboBox::activated), this, [this] {
        desk_.act({"fields", "time=" + time_->currentText().trimmed().toStdString()});
    });
    connect(time_->lineEdit(), &QLineEdit::editingFinished, this, [this] {
        if (time_->lineEdit()->isModified()) {
            time_->lineEdit()->setModified(false);
            desk_.act({"fields", "time=" + time_->currentText().trimmed().toStdString()});
        }
    });
    time_row_->hide();
    return time_row_;
}

/// Where a file has several times it can be said which.
void FieldsPanel::fill_time() {
    std::set<double> all;
    for (const auto& cell : cells_) {
        if (cell->ready) {
            const auto times = postproc::stated_times(*cell->field);
            all.insert(times.begin(), times.end());
        }
    }
    const bool reading = std::any_of(cells_.begin(), cells_.end(), [](const auto& cell) {
        return !cell->source.id.empty() && !cell->ready && cell->failed.isEmpty();
    });
    const std::vector<double> times(all.begin(), all.end());
    time_row_->setVisible(!times.empty() || reading || state().fields.time);
    const QSignalBlocker quiet(time_);
    if (times != times_ && !reading) {
        times_ = times;
        time_->clear();
        for (const double time : times_) {
            time_->addItem(qt(core::format_number(time)) + " s");
        }
    }
    time_row_->setVisible(!times_.empty() || state().fields.time);
    time_->lineEdit()->setPlaceholderText("the last time");
    if (!time_->lineEdit()->hasFocus() || !time_->lineEdit()->isModified()) {
        time_->setEditText(state().fields.time ? qt(core::format_number(*state().fields.time)) + " s" : QString());
        time_->lineEdit()->setModified(false);
    }
}

void FieldsPanel::step_time(int by) {
    if (times_.empty()) {
        return;
    }
    const double now = state().fields.time.value_or(times_.back());
    const auto nearest = std::min_element(times_.begin(), times_.end(),
                                          [&](double a, double b) { return std::abs(a - now) < std::abs(b - now); });
    const auto at =
        std::clamp<std::ptrdiff_t>(nearest - times_.begin() + by, 0, static_cast<std::ptrdiff_t>(times_.size()) - 1);
    desk_.act({"fields", "time=" + core::format_number(times_[static_cast<std::size_t>(at)]) + "s"});
}

void FieldsPanel::build_probe(QBoxLayout& column) {
    probe_row_ = new QWidget;
    auto* row = new QHBoxLayout(probe_row_);
    row->setContentsMargins(0, 0, 0, 0);
    probe_ = new QLabel;
    probe_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
    probe_->setAccessibleName("Values at the place that was clicked");
    probe_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    row->addWidget(probe_, 1);
    auto* copy = new QPushButton("Cop&y");
    copy->setToolTip("The values as text");
    connect(copy, &QPushButton::clicked, this, [this] { QApplication::clipboard()->setText(probed()); });
    row->addWidget(copy);
    auto* away = new QToolButton;
    away->setText("×");
    away->setAccessibleName("No values at a place");
    connect(away, &QToolButton::clicked, this, [this] { desk_.act({"fields", "probe="}); });
    row->addWidget(away);
    probe_row_->hide();
    column.addWidget(probe_row_);
}

namespace {

/// The arrays of a row of a probe, or one of them: "  ·  pressure −51.4 Pa  ·  wall shear (0.1, 0, 0) Pa".
QString values_in(const core::Table& table, const std::string& only) {
    QString text;
    const auto& columns = table.columns();
    const auto shown = [](const core::Column& column) {
        return qt(core::format_number(column.numbers.front(), 5)).replace('-', QChar(0x2212));
    };
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto& column = columns[i];
        if (column.is_text() || column.name == "x" || column.name == "y" || column.name == "z" ||
            column.name == "distance_to_surface" || !std::isfinite(column.numbers.front())) {
            continue;
        }
        const std::string vector =
            column.name.substr(0, column.name.size() - std::min<std::size_t>(2, column.name.size()));
        const bool three = column.name.ends_with("_x") && i + 2 < columns.size() &&
                           columns[i + 1].name == vector + "_y" && columns[i + 2].name == vector + "_z" &&
                           !columns[i + 1].is_text() && !columns[i + 2].is_text();
        if (!only.empty() && only != (three ? vector : column.name)) {
            i += three ? 2 : 0;
            continue;
        }
        text += "  ·  " + qt(three ? vector : column.name).replace('_', ' ') + " ";
        text += three ? "(" + shown(column) + ", " + shown(columns[i + 1]) + ", " + shown(columns[i + 2]) + ")"
                      : shown(column);
        text += " " + qt(pretty_unit(column.unit));
        i += three ? 2 : 0;
    }
    return text;
}

struct Probed {
    QString all, shown;  ///< every array; the one that colours
};

/// What one field has at the place of its surfaces that is nearest: zone, place, values of every array there.
Probed values_at(const postproc::Field& field, const std::vector<std::string>& zones, const std::array<double, 3>& at,
                 const std::string& coloured, core::Progress& progress) {
    Probed best{"no surface that is shown", {}};
    best.shown = best.all;
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& zone : zones) {
        postproc::ProbeOptions options;
        options.on_surface = true;
        options.zones = {zone};
        const core::Table table = postproc::probe_points(field, {at}, options, progress);
        const double distance = table.numbers("distance_to_surface").front();
        if (!(distance < nearest)) {
            continue;
        }
        nearest = distance;
        best = {qt(zone) + values_in(table, ""), qt(zone) + values_in(table, coloured)};
    }
    return best;
}

struct ToProbe {
    QString name, title;
    std::shared_ptr<const postproc::Field> field;
    std::vector<std::string> zones;
    std::string coloured;
};

}  // namespace

QString FieldsPanel::probed() const { return probe_row_->isHidden() ? QString() : probe_->toolTip(); }

/// The values of all cells at the place that stands in the state.
void FieldsPanel::show_probe() {
    const auto& at = state().fields.probe;
    probe_row_->setVisible(at.has_value());
    std::vector<ToProbe> cells;
    std::string key =
        at ? core::format_number((*at)[0]) + " " + core::format_number((*at)[1]) + " " + core::format_number((*at)[2])
           : std::string();
    for (const auto& cell : cells_) {
        cell->scene->mark(cell->ready ? at : std::nullopt);
        if (!at || !cell->ready) {
            continue;
        }
        ToProbe one{cell->source.title.section(':', 0, 0), cell->source.title, cell->field, {}, {}};
        for (const auto& choice : cell->scene->choices()) {
            one.coloured = qt(choice.label) == array_->currentText() ? choice.name : one.coloured;
        }
        key += "\n" + one.coloured;
        const auto& zones = cell->field->zones;
        for (std::size_t i = 0; i < zones.size(); ++i) {
            if (cell->scene->visible(i) && zones[i].surface && zones[i].surface->GetNumberOfCells() > 0) {
                one.zones.push_back(zones[i].name);
                key += "\n" + zones[i].name;
            }
        }
        key += "\n" + cell->source.key();
        cells.push_back(std::move(one));
    }
    if (key == probe_of_) {
        return;
    }
    probe_of_ = key;
    if (!at) {
        return;
    }
    jobs_.start(
        "probe", "values at a place",
        [this, cells, at = *at, key](core::Progress& progress) {
            Probed text;
            text.all = QString("x %1, y %2, z %3 mm, between the nodes of the nearest face")
                           .arg(1000 * at[0])
                           .arg(1000 * at[1])
                           .arg(1000 * at[2]);
            text.shown = text.all;
            for (const auto& one : cells) {
                const Probed own = values_at(*one.field, one.zones, at, one.coloured, progress);
                text.all += "\n" + one.title + ":  " + own.all;
                text.shown += "\n" + one.name + ":  " + own.shown;
            }
            return [this, text, key] {
                if (key == probe_of_) {
                    probe_->setText(text.shown);
                    probe_->setToolTip(text.all);
                }
            };
        },
        true);
}

/// Zones that are the body: those of the case's patterns, else what may be a wall but not the ground.
std::vector<bool> FieldsPanel::body_zones(const Cell& cell) const {
    const postproc::Field& field = *cell.field;
    std::vector<bool> body;
    std::vector<const postproc::Zone*> said_otherwise;
    const auto walls = postproc::possible_walls(field, said_otherwise);
    for (const auto& zone : field.zones) {
        const bool wall =
            std::find(walls.begin(), walls.end(), &zone) != walls.end() && !postproc::matches("*ground*", zone.name);
        body.push_back(zone.surface &&
                       (cell.source.zones.empty() ? wall : postproc::matches_any(cell.source.zones, zone.name)));
    }
    return body;
}

void FieldsPanel::tint_bodies() {
    for (const auto& cell : cells_) {
        if (cell->ready) {
            cell->scene->tint(body_mode_->isChecked() ? body_zones(*cell) : std::vector<bool>());
        }
    }
}

void FieldsPanel::picked(std::size_t index, const Scene::Picked& found) {
    Q_EMIT remark(found.text);
    if (body_mode_->isChecked()) {
        const auto& zones = cells_[index]->field->zones;
        const auto body = body_zones(*cells_[index]);
        for (std::size_t i = 0; i < zones.size(); ++i) {
            if (zones[i].name == found.zone) {
                mark_zone(index, found.zone, !body[i]);
                return;
            }
        }
        return;
    }
    std::string place;
    for (const double coordinate : found.at) {
        place += (place.empty() ? "" : ",") + core::format_number(coordinate, 6);
    }
    desk_.act({"fields", "probe=" + place});
}

/// Of every file that is shown where `index` names none.
void FieldsPanel::mark_zone(std::size_t index, const std::string& zone, bool body) {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        const Cell& cell = *cells_[i];
        if ((index < cells_.size() && i != index) || !cell.ready || cell.field->find(zone) == nullptr) {
            continue;
        }
        if (!cell.source.id.starts_with("field/")) {
            Q_EMIT remark("The zones of a case of the study stand in its study.toml: zones = [...]");
            continue;
        }
        std::string names;
        const auto of_body = body_zones(cell);
        for (std::size_t k = 0; k < of_body.size(); ++k) {
            const std::string& name = cell.field->zones[k].name;
            if (name == zone ? body : of_body[k]) {
                names += (names.empty() ? "" : ",") + name;
            }
        }
        if (names.empty()) {
            Q_EMIT remark("A body has one zone at least");
        } else {
            desk_.act({"read", cell.source.file.string(), "zones=" + names});
        }
    }
}

void FieldsPanel::zone_menu(std::size_t index, const std::string& zone, const QPoint& place) {
    auto* menu = new QMenu(this);
    menu->setAttribute(Qt::WA_DeleteOnClose);
    menu->addSection(qt(zone));
    const bool outside = units_->isEnabled();
    const auto add = [&](const QString& text, bool enabled, const std::function<void()>& act) {
        menu->addAction(text, this, act)->setEnabled(enabled);
    };
    add("Is part of the &body", outside, [this, index, zone] { mark_zone(index, zone, true); });
    add("Is &not part of the body", outside, [this, index, zone] { mark_zone(index, zone, false); });
    menu->addSeparator();
    add("&Hide it", true, [this, zone] { desk_.act({"fields", "zone." + zone + "=off"}); });
    add("Show it &alone", true, [this, zone] {
        Words words = {"fields"};
        for (int i = 0; i < zones_->count(); ++i) {
            const std::string name = zones_->item(i)->text().toStdString();
            words.push_back("zone." + name + (name == zone ? "=on" : "=off"));
        }
        desk_.act(words);
    });
    menu->popup(place);
}

void FieldsPanel::offer_half() {
    QString plane;
    for (const auto& cell : cells_) {
        if (cell->ready && cell->half && cell->source.symmetry.empty() && cell->source.id.starts_with("field/")) {
            plane = qt(cell->half->symmetry);
            half_offer_->setToolTip(
                (cell->half->zone.empty()
                     ? "The surface of " + qt(cell->source.file.filename().string()) + " is open there"
                     : "The flat symmetry boundary '" + qt(cell->half->zone) + "' has the body on one side") +
                ": loads and pictures then count both halves");
        }
    }
    half_offer_->setVisible(!plane.isEmpty());
    half_offer_->setText("Half model across " + plane + ": take it so");
}

void FieldsPanel::take_half() {
    std::vector<Words> all;
    for (const auto& cell : cells_) {
        if (cell->ready && cell->half && cell->source.symmetry.empty() && cell->source.id.starts_with("field/")) {
            all.push_back({"read", cell->source.file.string(), "symmetry=" + cell->half->symmetry});
        }
    }
    for (const auto& words : all) {
        desk_.act(words);
    }
}

}  // namespace underbody::studio
