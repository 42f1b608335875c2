// Compare: the controls at its side, and what they say of what is shown.
#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPushButton>
#include <QShortcut>
#include <QSignalBlocker>
#include <QToolButton>
#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "postproc/field/lists.h"
#include "studio/desktop/fields_panel.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

void FieldsPanel::build_controls(QWidget& side) {
    auto* left = new QVBoxLayout(&side);
    left->setContentsMargins(0, 0, 0, 0);
    add_view_choice(*left);
    left->addWidget(build_time());
    add_colours(*left);
    add_switches(*left);
    left->addWidget(new QLabel("Zones"));
    zones_ = new QListWidget;
    zones_->setAccessibleName("Zones");
    zones_->setToolTip("Ticked zones are drawn, and set the range of the colours");
    zones_->setMinimumHeight(60);
    left->addWidget(zones_, 1);
    add_cameras(*left);
    add_body(*left);
    follow_controls();
}

void FieldsPanel::add_view_choice(QBoxLayout& left) {
    auto* show = new QLabel("Sho&w");
    left.addWidget(show);
    view_ = new QComboBox;
    view_->setAccessibleName("Show");
    show->setBuddy(view_);
    view_->addItem("surface, in 3D", "surface");
    for (const auto& kind : postproc::view_kinds()) {
        view_->addItem(qt(kind.name).replace('-', ", "), qt(kind.name));
        view_->setItemData(view_->count() - 1, qt(kind.meaning), Qt::ToolTipRole);
    }
    view_->addItem("gap profile", "profile-gap");
    view_->setItemData(view_->count() - 1,
                       "speed over the height between ground and base, at a few stations, of a field with a volume",
                       Qt::ToolTipRole);
    view_->setToolTip(
        "The surface to turn by hand, or a picture of the flow: planes and streamlines need a file with its volume");
    view_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    left.addWidget(view_);
}

void FieldsPanel::add_colours(QBoxLayout& left) {
    auto* colour = new QLabel("&Colour by");
    left.addWidget(colour);
    array_ = new QComboBox;
    array_->setToolTip("Which array of the field colours the surface");
    array_->setAccessibleName("Colour by");
    colour->setBuddy(array_);
    left.addWidget(array_);
    left.addWidget(new QLabel("Range, the same for all cells"));
    range_ = new QLineEdit;
    range_->setPlaceholderText("from what is seen; or -120:120");
    range_->setAccessibleName("Range of the colours");
    range_->setClearButtonEnabled(true);
    left.addWidget(range_);
    range_shown_ = new QLabel;
    range_shown_->setWordWrap(true);
    keep_range_ = new QToolButton;
    keep_range_->setText("Keep");
    keep_range_->setAccessibleName("Keep the range of the colours");
    keep_range_->setToolTip(
        "Other cases are shown in this range too, so that equal colours are equal values; clear it above to follow "
        "what is seen");
    connect(keep_range_, &QToolButton::clicked, this, [this] {
        if (range_now_) {
            desk_.act({"fields",
                       "range=" + core::format_number((*range_now_)[0]) + ":" + core::format_number((*range_now_)[1])});
        }
    });
    auto* now = new QHBoxLayout;
    now->addWidget(range_shown_, 1);
    now->addWidget(keep_range_);
    left.addLayout(now);
}

void FieldsPanel::add_switches(QBoxLayout& left) {
    whole_range_ = new QCheckBox("&whole range of colours");
    whole_range_->setToolTip(
        "Off: colours span the 1st to the 99th hundredth of the values, so that single points at an\n"
        "edge do not take all the colours");
    edges_ = new QCheckBox("mesh &lines");
    mirror_ = new QCheckBox("&mirror half model");
    difference_ = new QCheckBox("&difference to the first");
    difference_->setToolTip(
        "The cells after the first show their case less the first, from where the first is seen, as `underbody views "
        "difference` draws it");
    for (auto* box : {whole_range_, edges_, mirror_, difference_}) {
        left.addWidget(box);
    }
}

void FieldsPanel::add_cameras(QBoxLayout& left) {
    auto* views = new QGridLayout;
    const std::vector<std::tuple<QString, std::string, QString>> buttons = {{"Underbody", "bottom", "U"},
                                                                            {"Top", "top", "T"},
                                                                            {"Side", "side", "S"},
                                                                            {"Front", "front", "R"},
                                                                            {"Oblique", "iso", "O"}};
    int place = 0;
    for (const auto& [text, view, key] : buttons) {
        auto* button = new QPushButton(text);
        button->setToolTip("Look from there (" + key + ")");
        views->addWidget(button, place / 2, place % 2);
        ++place;
        const auto act = [this, v = view] {
            if (state().fields.camera == v && !state().fields.turned) {
                camera_.clear();  // the window may have another size
                recolour();
            }
            desk_.act({"fields", "camera=" + v});  // also back to it after turning by hand
        };
        connect(button, &QPushButton::clicked, this, act);
        auto* shortcut = new QShortcut(QKeySequence(key), this);
        shortcut->setContext(Qt::WidgetWithChildrenShortcut);
        connect(shortcut, &QShortcut::activated, this, act);
    }
    left.addLayout(views);
}

void FieldsPanel::add_body(QBoxLayout& left) {
    body_mode_ = new QPushButton("Choose the &body in 3D");
    body_mode_->setCheckable(true);
    body_mode_->setToolTip(
        "All zones are shown, those of the body in orange: a click on one makes it part of the body or takes it out.\n"
        "The right button on a zone, or on its name above, offers the same at any time.");
    left.addWidget(body_mode_);
    connect(body_mode_, &QPushButton::toggled, this, [this] { recolour(); });
    half_offer_ = new QPushButton;
    half_offer_->hide();
    left.addWidget(half_offer_);
    connect(half_offer_, &QPushButton::clicked, this, &FieldsPanel::take_half);
    zones_->setContextMenuPolicy(Qt::CustomContextMenu);
    connect(zones_, &QListWidget::customContextMenuRequested, this, [this](const QPoint& at) {
        if (const auto* item = zones_->itemAt(at)) {
            zone_menu(cells_.size(), item->text().toStdString(), zones_->viewport()->mapToGlobal(at));
        }
    });
    units_ = new QPushButton("Units, &half model …");
    units_->setToolTip("What a file from outside the study does not say: units, half or whole, zones of the body");
    left.addWidget(units_);
    connect(units_, &QPushButton::clicked, this, &FieldsPanel::ask_units);
}

void FieldsPanel::follow_controls() {
    connect(view_, QOverload<int>::of(&QComboBox::activated), this, [this] {
        desk_.act({"fields", "view=" + view_->currentData().toString().toStdString()});
    });
    const auto on_off = [this](const char* key, bool on) {
        desk_.act({"fields", std::string(key) + (on ? "=on" : "=off")});
    };
    connect(array_, QOverload<int>::of(&QComboBox::activated), this, [this] {
        desk_.act({"fields", "array=" + array_->currentText().toStdString()});
    });
    connect(range_, &QLineEdit::editingFinished, this, [this] {
        if (range_->isModified()) {
            range_->setModified(false);
            desk_.act({"fields", "range=" + range_->text().trimmed().toStdString()});
        }
    });
    connect(whole_range_, &QCheckBox::clicked, this, [on_off](bool on) { on_off("whole_range", on); });
    connect(edges_, &QCheckBox::clicked, this, [on_off](bool on) { on_off("edges", on); });
    connect(mirror_, &QCheckBox::clicked, this, [on_off](bool on) { on_off("mirror", on); });
    connect(difference_, &QCheckBox::clicked, this, [on_off](bool on) { on_off("difference", on); });
    connect(zones_, &QListWidget::itemChanged, this, [this](QListWidgetItem* item) {
        const bool on = item->checkState() == Qt::Checked;
        desk_.act({"fields", "zone." + item->text().toStdString() + (on ? "=on" : "=off")});
    });
}

void FieldsPanel::fill_controls() {
    const QSignalBlocker quiet_zones(zones_), quiet_array(array_);
    std::map<std::string, std::pair<bool, std::size_t>> zones;
    std::vector<QString> arrays;
    for (const auto& cell : cells_) {
        if (!cell->ready) {
            continue;
        }
        const auto& field = *cell->scene->field();
        // Where no zone looks like a body (an inlet alone, a blade without walls) all are shown.
        const auto of_body = body_zones(*cell);
        const bool any = std::find(of_body.begin(), of_body.end(), true) != of_body.end();
        for (std::size_t k = 0; k < field.zones.size(); ++k) {
            const auto& zone = field.zones[k];
            if (zone.surface && zone.surface->GetNumberOfCells() > 0) {
                const bool body = !any || of_body[k];
                const auto typed = state().fields.zones.find(zone.name);
                auto& entry = zones[zone.name];
                entry.first = typed != state().fields.zones.end() ? typed->second : entry.first || body;
                entry.second += static_cast<std::size_t>(zone.surface->GetNumberOfCells());
            }
        }
        for (const auto& choice : cell->scene->choices()) {
            if (std::find(arrays.begin(), arrays.end(), qt(choice.label)) == arrays.end()) {
                arrays.push_back(qt(choice.label));
            }
        }
    }
    zones_->clear();
    for (const auto& [name, entry] : zones) {
        auto* item = new QListWidgetItem(qt(name), zones_);
        item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsUserCheckable | Qt::ItemIsSelectable);
        item->setCheckState(entry.first ? Qt::Checked : Qt::Unchecked);
        item->setToolTip(QString("%1 faces").arg(entry.second));
    }
    array_->clear();
    for (const auto& label : arrays) {
        array_->addItem(label);
    }
    array_->addItem("(plain)");
    const int kept = array_->findText(qt(state().fields.array));
    const int pressure = array_->findText("pressure", Qt::MatchContains);  // divided by the density, as solvers have it
    array_->setCurrentIndex(kept >= 0 ? kept : std::max(0, pressure));
    whole_range_->setChecked(state().fields.whole_range);
    edges_->setChecked(state().fields.edges);
    difference_->setChecked(state().fields.difference);
    const bool halves = std::any_of(cells_.begin(), cells_.end(),
                                    [](const auto& cell) { return cell->ready && !cell->source.symmetry.empty(); });
    mirror_->setEnabled(halves);
    mirror_->setChecked(state().fields.mirror.value_or(true) && halves);
    view_->setCurrentIndex(std::max(0, view_->findData(qt(state().fields.view))));
    units_->setEnabled(std::any_of(cells_.begin(), cells_.end(),
                                   [](const auto& cell) { return cell->source.id.starts_with("field/"); }));
    body_mode_->setEnabled(units_->isEnabled());
    fill_time();
    if (!range_->hasFocus()) {
        const auto& range = state().fields.range;
        range_->setText(range ? qt(core::format_number((*range)[0]) + ":" + core::format_number((*range)[1])) : "");
        range_->setModified(false);
    }
}

/// Names of arrays and zones are those of the files: what none of them has is said once they are read.
void FieldsPanel::check_names() {
    const FieldView& view = state().fields;
    const bool reading = std::any_of(cells_.begin(), cells_.end(), [](const auto& cell) {
        return !cell->source.id.empty() && !cell->ready && cell->failed.isEmpty();
    });
    if (reading || first_ready() == nullptr) {
        return;
    }
    const auto look_for = [this](const std::string& name, const std::vector<std::string>& known, const char* what) {
        if (std::find(known.begin(), known.end(), name) == known.end()) {
            Q_EMIT desk_.refused("fields", std::make_exception_ptr(core::UsageError(
                                               "missing", std::string("no file that is shown has ") + what + name + "'",
                                               {}, core::did_you_mean(name, known))));
        }
    };
    std::vector<std::string> arrays, zones;
    for (int i = 0; i < array_->count(); ++i) {
        arrays.push_back(array_->itemText(i).toStdString());
    }
    for (int i = 0; i < zones_->count(); ++i) {
        zones.push_back(zones_->item(i)->text().toStdString());
    }
    if (view.array != checked_.array) {
        look_for(view.array, arrays, "an array '");
    }
    for (const auto& [zone, on] : view.zones) {
        if (!checked_.zones.contains(zone)) {
            look_for(zone, zones, "a zone '");
        }
    }
    checked_ = view;
}

}  // namespace underbody::studio
