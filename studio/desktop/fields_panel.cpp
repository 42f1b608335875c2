#include "studio/desktop/fields_panel.h"

#include <QBoxLayout>
#include <QBuffer>
#include <QCheckBox>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPainter>
#include <QPushButton>
#include <QShortcut>
#include <QSignalBlocker>
#include <QStackedLayout>
#include <QTableWidget>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "postproc/field/field.h"
#include "postproc/loads/body_zones.h"
#include "postproc/loads/loads.h"
#include "postproc/views/views.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

constexpr std::size_t most_cells = 6;

/// Zones that are the body: those of the case's patterns, else what may be a wall but not the ground.
bool is_body(const postproc::Field& field, const postproc::Zone& zone, const std::vector<std::string>& patterns) {
    if (!patterns.empty()) {
        return postproc::matches_any(patterns, zone.name);
    }
    std::vector<const postproc::Zone*> said_otherwise;
    const auto walls = postproc::possible_walls(field, said_otherwise);
    return std::find(walls.begin(), walls.end(), &zone) != walls.end() && !postproc::matches("*ground*", zone.name);
}

/// What the table under the cells shows of each case.
const std::vector<std::pair<const char*, const char*>> quantities = {
    {"lift_force", "lift (N)"}, {"drag_force", "drag (N)"}, {"pitch_moment", "pitch moment (N m)"}};

struct DrawnDifference {
    QImage image;
    QString said;  ///< the caption, or why there is no picture
};

/// Each less the first, with the widest range of all where none is given.
std::vector<DrawnDifference> differences_to(const postproc::Field& first,
                                            const std::vector<std::shared_ptr<const postproc::Field>>& fields,
                                            const std::string& array, postproc::ViewOptions options,
                                            core::Progress& progress) {
    std::vector<DrawnDifference> drawn(fields.size());
    const auto draw = [&](std::size_t k) -> std::optional<std::pair<double, double>> {
        try {
            const auto view = postproc::difference_view(first, *fields[k], array, options, progress);
            drawn[k] = {
                QImage::fromData(reinterpret_cast<const uchar*>(view.png.data()), static_cast<int>(view.png.size())),
                qt(view.caption)};
            return view.range;
        } catch (const core::InputError& error) {
            drawn[k] = {{}, qt(error.message())};
            return {};
        }
    };
    double widest = 0;
    std::vector<bool> there(fields.size());
    for (std::size_t k = 0; k < fields.size(); ++k) {
        const auto range = draw(k);
        there[k] = range.has_value();
        widest = std::max(widest, range ? std::max(std::abs(range->first), std::abs(range->second)) : 0);
    }
    if (options.ranges.empty() && fields.size() > 1) {
        options.ranges = {{"difference", {-widest, widest}}};
        for (std::size_t k = 0; k < fields.size(); ++k) {
            if (there[k]) {
                draw(k);
            }
        }
    }
    return drawn;
}

}  // namespace

/// A picture as large as its room allows, or a sentence in its place.
class FittedPicture : public QWidget {
public:
    using QWidget::QWidget;
    void show_text(const QString& text) {
        image = {};
        text_ = text;
        update();
    }
    void show_image(const QImage& drawn) {
        image = drawn;
        update();
    }
    QImage image;

protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        if (image.isNull()) {
            painter.drawText(rect().adjusted(12, 12, -12, -12), Qt::AlignCenter | Qt::TextWordWrap, text_);
            return;
        }
        painter.setRenderHint(QPainter::SmoothPixmapTransform);
        QRect room(QPoint(0, 0), image.size().scaled(size(), Qt::KeepAspectRatio));
        room.moveCenter(rect().center());
        painter.drawImage(room, image);
    }

private:
    QString text_;
};

FieldsPanel::FieldsPanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
    setObjectName("compare");
    build();
}

FieldsPanel::~FieldsPanel() = default;

void FieldsPanel::build() {
    auto* all = new QHBoxLayout(this);
    auto* side = new QWidget;
    side->setFixedWidth(220);
    build_controls(*side);
    all->addWidget(side);
    auto* right = new QVBoxLayout;
    all->addLayout(right, 1);
    auto* middle = new QWidget;
    stack_ = new QStackedLayout(middle);
    right->addWidget(middle, 1);
    empty_ = new QLabel("Choose one to six cases in the tree on the left (Ctrl+click adds one), or drop CFD files");
    empty_->setAlignment(Qt::AlignCenter);
    empty_->setWordWrap(true);
    stack_->addWidget(empty_);
    auto* cells = new QWidget;
    grid_ = new QGridLayout(cells);
    grid_->setContentsMargins(0, 0, 0, 0);
    grid_->setSpacing(3);
    stack_->addWidget(cells);
    loads_ = new QTableWidget;
    loads_->setAccessibleName("Forces of the cases and their differences to the first");
    loads_->setMaximumHeight(150);
    loads_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    loads_->verticalHeader()->setDefaultSectionSize(22);
    right->addWidget(loads_);
    if (!Scene::possible()) {
        empty_->setText(
            "The 3D view needs OpenGL 3.2, which this display does not offer.\n"
            "On a server, start the program under Xvfb with the package libgl1-mesa-dri installed.");
    }
}

void FieldsPanel::build_controls(QWidget& side) {
    auto* left = new QVBoxLayout(&side);
    left->setContentsMargins(0, 0, 0, 0);
    auto* colour = new QLabel("&Colour by");
    left->addWidget(colour);
    array_ = new QComboBox;
    array_->setToolTip("Which array of the field colours the surface");
    array_->setAccessibleName("Colour by");
    colour->setBuddy(array_);
    left->addWidget(array_);
    left->addWidget(new QLabel("Range, the same for all cells"));
    range_ = new QLineEdit;
    range_->setPlaceholderText("from what is seen; or -120:120");
    range_->setAccessibleName("Range of the colours");
    range_->setClearButtonEnabled(true);
    left->addWidget(range_);
    range_shown_ = new QLabel;
    left->addWidget(range_shown_);
    whole_range_ = new QCheckBox("&whole range of colours");
    whole_range_->setToolTip(
        "Off: colours span the 1st to the 99th hundredth of the values, so that single points at an\n"
        "edge do not take all the colours");
    edges_ = new QCheckBox("mesh &lines");
    mirror_ = new QCheckBox("&mirror half model");
    difference_ = new QCheckBox("&difference to the first");
    difference_->setToolTip(
        "The cells after the first show their case less the first, seen from below, as `underbody views difference` "
        "draws it");
    for (auto* box : {whole_range_, edges_, mirror_, difference_}) {
        left->addWidget(box);
    }
    left->addWidget(new QLabel("Zones"));
    zones_ = new QListWidget;
    zones_->setAccessibleName("Zones");
    zones_->setToolTip("Ticked zones are drawn, and set the range of the colours");
    left->addWidget(zones_, 1);
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
            camera_.clear();  // also back to it after turning by hand
            if (state().fields.camera == v) {
                look_from(v);
            }
            desk_.act({"fields", "camera=" + v});
        };
        connect(button, &QPushButton::clicked, this, act);
        auto* shortcut = new QShortcut(QKeySequence(key), this);
        shortcut->setContext(Qt::WidgetWithChildrenShortcut);
        connect(shortcut, &QShortcut::activated, this, act);
    }
    left->addLayout(views);
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

FieldsPanel::Source FieldsPanel::source_of(const cases::Case& one) const {
    return {"case/" + one.name, one.file, one.zones, qt(one.name + ": " + one.conditions.label())};
}

std::vector<FieldsPanel::Source> FieldsPanel::wanted() const {
    std::vector<Source> sources;
    const auto add = [&](const std::string& id) {
        if (id.starts_with("field/")) {
            const std::filesystem::path file = id.substr(6);
            sources.push_back({id, file, {}, qt(file.filename().string())});
        }
        for (const auto& one : session().study.cases) {
            if ("case/" + one.name == id) {
                sources.push_back(source_of(one));
            }
        }
    };
    for (const auto& id : state().selection) {
        add(id);
    }
    if (const auto last = state().last.find("case"); sources.empty() && last != state().last.end()) {
        for (const auto& name : last->second) {
            add("case/" + name);
        }
    }
    if (sources.empty() && !session().study.cases.empty()) {
        // A picture from the start: the first case that the study itself wants pictures of, else the first of all.
        const cases::Case* chosen = &session().study.cases.front();
        for (const auto& picture : session().study.pictures) {
            if (const auto found = session().study.select(picture.where); !found.empty()) {
                chosen = found.front();
                break;
            }
        }
        sources.push_back(source_of(*chosen));
    }
    if (sources.size() > most_cells) {
        sources.resize(most_cells);
    }
    return sources;
}

void FieldsPanel::lay_out(const std::vector<Source>& sources) {
    while (cells_.size() < sources.size()) {
        auto cell = std::make_unique<Cell>();
        cell->box = new QWidget;
        auto* column = new QVBoxLayout(cell->box);
        column->setContentsMargins(0, 0, 0, 0);
        cell->title = new QLabel;
        cell->title->setTextInteractionFlags(Qt::TextSelectableByMouse);
        cell->title->setWordWrap(true);
        cell->title->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);  // a long name widens no window
        column->addWidget(cell->title);
        cell->scene = std::make_unique<Scene>(cell->box);
        cell->scene->widget()->setMinimumSize(120, 100);
        cell->scene->on_pick = [this](const QString& text) { Q_EMIT remark(text); };
        cell->scene->on_turn = [this] {
            for (const auto& one : cells_) {
                if (one->ready && one->box->isVisible()) {
                    one->scene->render();
                }
            }
        };
        if (!cells_.empty()) {
            cell->scene->share_camera(*cells_.front()->scene);
        }
        column->addWidget(cell->scene->widget(), 1);
        cell->difference = new FittedPicture(cell->box);
        cell->difference->hide();
        column->addWidget(cell->difference, 1);
        cells_.push_back(std::move(cell));
    }
    const int columns = sources.size() <= 1 ? 1 : sources.size() <= 4 ? 2 : 3;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        grid_->removeWidget(cells_[i]->box);
        cells_[i]->box->setVisible(i < sources.size());
        if (i < sources.size()) {
            grid_->addWidget(cells_[i]->box, static_cast<int>(i) / columns, static_cast<int>(i) % columns);
        } else {
            cells_[i]->ready = false;
            cells_[i]->source = {};
            cells_[i]->field.reset();
        }
    }
}

void FieldsPanel::draw_again(bool) {
    if (!Scene::possible()) {
        return;
    }
    const auto sources = wanted();
    fill_loads(sources);
    stack_->setCurrentIndex(sources.empty() ? 0 : 1);
    lay_out(sources);
    bool all_ready = true;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        Cell& cell = *cells_[i];
        const auto stamp = core::stamp_of(sources[i].file);
        cell.title->setText(sources[i].title);
        cell.title->setToolTip(sources[i].title);
        if (cell.source.id != sources[i].id || !(cell.stamp == stamp)) {
            cell.source = sources[i];
            cell.stamp = stamp;
            read(i);
        }
        all_ready = all_ready && cell.ready;
    }
    if (all_ready && !sources.empty()) {
        recolour();
    }
}

void FieldsPanel::read(std::size_t index) {
    const Source source = cells_[index]->source;
    jobs_.start(QString("field %1").arg(index), "reading " + qt(source.file.filename().string()),
                [this, index, source, mirror = session().study.symmetry](core::Progress& progress) {
                    postproc::ReadOptions options;
                    options.surfaces_only = true;
                    auto field =
                        std::make_shared<const postproc::Field>(postproc::read_field(source.file, options, progress));
                    const auto prepared = Scene::prepare(field, mirror);
                    return [this, index, source, field, prepared] { taken(index, source, field, prepared); };
                });
}

void FieldsPanel::taken(std::size_t index, const Source& source, const std::shared_ptr<const postproc::Field>& field,
                        const std::shared_ptr<const Scene::Prepared>& prepared) {
    if (index >= cells_.size() || cells_[index]->source.id != source.id) {
        return;
    }
    Cell& cell = *cells_[index];
    const bool first = first_ready() == nullptr;
    cell.scene->show(prepared, first);
    cell.field = field;
    cell.ready = true;
    differences_of_.clear();
    for (const auto& found : cell.scene->field()->problems) {
        Q_EMIT problem(found);
    }
    if (first || session().folder.empty()) {
        camera_.clear();  // files from outside may be of any size
    }
    recolour();
}

FieldsPanel::Cell* FieldsPanel::first_ready() const {
    for (const auto& cell : cells_) {
        if (cell->ready) {
            return cell.get();
        }
    }
    return nullptr;
}

std::size_t FieldsPanel::drawn() const {
    return static_cast<std::size_t>(
        std::count_if(cells_.begin(), cells_.end(), [](const auto& cell) { return cell->ready; }));
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
        const bool any = std::any_of(field.zones.begin(), field.zones.end(), [&](const auto& zone) {
            return zone.surface && is_body(field, zone, cell->source.zones);
        });
        for (const auto& zone : field.zones) {
            if (zone.surface && zone.surface->GetNumberOfCells() > 0) {
                const bool body = !any || is_body(field, zone, cell->source.zones);
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
    array_->setCurrentIndex(kept >= 0 ? kept : 0);
    whole_range_->setChecked(state().fields.whole_range);
    edges_->setChecked(state().fields.edges);
    difference_->setChecked(state().fields.difference);
    mirror_->setEnabled(!session().study.symmetry.empty());
    mirror_->setChecked(state().fields.mirror.value_or(true) && !session().study.symmetry.empty());
    if (!range_->hasFocus()) {
        const auto& range = state().fields.range;
        range_->setText(range ? qt(core::format_number((*range)[0]) + ":" + core::format_number((*range)[1])) : "");
        range_->setModified(false);
    }
}

void FieldsPanel::recolour() {
    fill_controls();
    std::optional<std::array<double, 2>> range;
    std::vector<Scene::Choice> chosen(cells_.size());
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        if (!cells_[i]->ready) {
            continue;
        }
        Scene& scene = *cells_[i]->scene;
        std::vector<bool> seen;
        for (const auto& zone : scene.field()->zones) {
            const auto items = zones_->findItems(qt(zone.name), Qt::MatchExactly);
            seen.push_back(!items.isEmpty() && items.front()->checkState() == Qt::Checked);
        }
        scene.set_visible(seen);
        const auto& zones = scene.field()->zones;
        const bool surfaces = std::any_of(zones.begin(), zones.end(), [](const auto& zone) {
            return zone.surface && zone.surface->GetNumberOfCells() > 0;
        });
        cells_[i]->empty = scene.bounds() ? ""
                           : surfaces     ? "   (nothing to show: tick zones on the left)"
                                          : "   (nothing to show: this file has no surfaces)";
        scene.mirror(mirror_->isChecked());
        scene.show_edges(edges_->isChecked());
        scene.set_ground(palette().base().color().lightness() < 128);
        for (const auto& choice : scene.choices()) {
            chosen[i] = qt(choice.label) == array_->currentText() ? choice : chosen[i];
        }
        if (const auto own = scene.range_of(chosen[i], whole_range_->isChecked())) {
            range =
                range ? std::array<double, 2>{std::min((*range)[0], (*own)[0]), std::max((*range)[1], (*own)[1])} : own;
        }
    }
    range = state().fields.range ? state().fields.range : range;
    range_shown_->setText(range && array_->currentText() != "(plain)"
                              ? QString("%1 to %2").arg((*range)[0], 0, 'g', 4).arg((*range)[1], 0, 'g', 4)
                              : QString());
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        if (cells_[i]->ready) {
            cells_[i]->scene->colour_by(chosen[i], range.value_or(std::array<double, 2>{0, 1}));
        }
    }
    look_from(state().fields.camera);
    for (const auto& cell : cells_) {
        if (cell->ready) {
            cell->scene->render();
        }
    }
    show_differences();
}

void FieldsPanel::show_differences() {
    std::vector<std::size_t> wanted;
    std::string key;
    const bool on = state().fields.difference && !cells_.empty() && cells_.front()->ready;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        Cell& cell = *cells_[i];
        const bool as_difference = on && i > 0 && cell.ready;
        cell.scene->widget()->setVisible(!as_difference);
        cell.difference->setVisible(as_difference);
        cell.title->setText(cell.source.title + (as_difference ? QString("  less the first") : cell.empty));
        key += cell.source.id + "\n";
        if (as_difference) {
            wanted.push_back(i);
        }
    }
    std::string array;
    for (const auto& choice : wanted.empty() ? std::vector<Scene::Choice>{} : cells_.front()->scene->choices()) {
        array = qt(choice.label) == array_->currentText() ? choice.name : array;
    }
    if (wanted.empty()) {
        differences_of_.clear();
        jobs_.cancel("differences");
        return;
    }
    for (const double end : state().fields.range.value_or(std::array<double, 2>{0, 0})) {
        key += core::format_number(end) + " ";
    }
    key += array;
    if (key == differences_of_) {
        return;
    }
    differences_of_ = key;
    for (const std::size_t i : wanted) {
        cells_[i]->difference->show_text(array.empty() ? "Choose what the difference is of: Colour by" : "…");
    }
    if (!array.empty()) {
        draw_differences(wanted, array);
    }
}

/// All in one job, so that they have one range of colours.
void FieldsPanel::draw_differences(const std::vector<std::size_t>& cells, const std::string& array) {
    postproc::ViewOptions options;
    if (!session().folder.empty()) {
        options.forward = postproc::axis_from(session().study.forward);
        options.up = postproc::axis_from(session().study.up);
        options.symmetry = session().study.symmetry;
    }
    options.zones = cells_.front()->source.zones;
    if (const auto& range = state().fields.range) {
        options.ranges = {{"difference", {(*range)[0], (*range)[1]}}};
    }
    std::vector<std::shared_ptr<const postproc::Field>> fields;
    for (const std::size_t i : cells) {
        fields.push_back(cells_[i]->field);
    }
    jobs_.start("differences", "differences of " + qt(array),
                [this, cells, fields, first = cells_.front()->field, array, options,
                 key = differences_of_](core::Progress& progress) {
                    const auto drawn = differences_to(*first, fields, array, options, progress);
                    return [this, cells, drawn, key] {
                        for (std::size_t k = 0; k < cells.size() && key == differences_of_; ++k) {
                            FittedPicture& place = *cells_[cells[k]]->difference;
                            if (drawn[k].image.isNull()) {
                                place.show_text(drawn[k].said);
                            } else {
                                place.show_image(drawn[k].image);
                            }
                            place.setToolTip(drawn[k].said);
                        }
                    };
                });
}

std::size_t FieldsPanel::differences() const {
    return static_cast<std::size_t>(std::count_if(cells_.begin(), cells_.end(), [](const auto& cell) {
        return cell->difference->isVisible() && !cell->difference->image.isNull();
    }));
}

void FieldsPanel::look_from(const std::string& camera) {
    Cell* cell = first_ready();
    if (cell != nullptr && camera != camera_) {
        camera_ = camera;
        std::optional<std::array<double, 6>> box;  // around the bodies of all cells: they have one camera
        for (const auto& one : cells_) {
            const auto own = one->ready ? one->scene->bounds() : std::nullopt;
            for (std::size_t i = 0; own && box && i < 6; i += 2) {
                (*box)[i] = std::min((*box)[i], (*own)[i]);
                (*box)[i + 1] = std::max((*box)[i + 1], (*own)[i + 1]);
            }
            box = box ? box : own;
        }
        cell->scene->look_from(camera, session().folder.empty() ? "+x" : session().study.forward,
                               session().folder.empty() ? "+z" : session().study.up, box);
    }
}

void FieldsPanel::fill_loads(const std::vector<Source>& sources) {
    std::vector<const cases::CaseLoads*> loads;
    QStringList names;
    for (const auto& source : sources) {
        for (const auto& one : session().results.case_loads) {
            if ("case/" + one.name == source.id) {
                loads.push_back(&one);
                names.push_back(qt(one.name));
            }
        }
    }
    loads_->setVisible(!loads.empty());
    loads_->clear();
    loads_->setRowCount(static_cast<int>(loads.size()));
    loads_->setColumnCount(static_cast<int>(2 * quantities.size()));
    loads_->setVerticalHeaderLabels(names);
    QStringList titles;
    for (const auto& [name, title] : quantities) {
        titles << title << "less the first";
    }
    loads_->setHorizontalHeaderLabels(titles);
    for (int row = 0; row < loads_->rowCount(); ++row) {
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            const double first = loads.front()->value(quantities[q].first);
            const double value = loads[static_cast<std::size_t>(row)]->value(quantities[q].first);
            const auto put = [&](std::size_t column, double number, bool there) {
                auto* item = new QTableWidgetItem(there && std::isfinite(number)
                                                      ? qt(core::format_number(number, 4)).replace('-', QChar(0x2212))
                                                      : QString("–"));
                item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
                loads_->setItem(row, static_cast<int>(column), item);
            };
            put(2 * q, value, true);
            put(2 * q + 1, value - first, row > 0);
        }
    }
    loads_->resizeColumnsToContents();
}

bool FieldsPanel::has_picture() const { return first_ready() != nullptr; }

QImage FieldsPanel::sheet() const {
    std::vector<std::pair<QString, QImage>> pictures;
    for (const auto& cell : cells_) {
        if (cell->difference->isVisible() && !cell->difference->image.isNull()) {
            pictures.emplace_back(cell->title->text(),
                                  cell->difference->image.scaled(cells_.front()->scene->widget()->size(),
                                                                 Qt::KeepAspectRatio, Qt::SmoothTransformation));
        } else if (cell->ready) {
            const std::string png = cell->scene->png();
            pictures.emplace_back(cell->source.title, QImage::fromData(reinterpret_cast<const uchar*>(png.data()),
                                                                       static_cast<int>(png.size())));
        }
    }
    if (pictures.empty()) {
        return {};
    }
    const int columns = pictures.size() <= 1 ? 1 : pictures.size() <= 4 ? 2 : 3;
    const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
    const QSize one = pictures.front().second.size();
    constexpr int caption = 26;
    QImage sheet(columns * one.width(), rows * (one.height() + caption), QImage::Format_RGB32);
    sheet.fill(palette().color(QPalette::Base));
    QPainter painter(&sheet);
    painter.setPen(palette().color(QPalette::Text));
    for (int i = 0; i < static_cast<int>(pictures.size()); ++i) {
        const QPoint at(i % columns * one.width(), i / columns * (one.height() + caption));
        painter.drawText(QRect(at, QSize(one.width(), caption)).adjusted(8, 0, -8, 0), Qt::AlignLeft | Qt::AlignVCenter,
                         pictures[static_cast<std::size_t>(i)].first);
        painter.drawImage(at + QPoint(0, caption), pictures[static_cast<std::size_t>(i)].second);
    }
    return sheet;
}

void FieldsPanel::export_picture(const std::filesystem::path& path) {
    if (path.extension() != ".png") {
        throw core::UsageError("format", "a 3D view is written as .png only");
    }
    QImage picture = sheet();
    picture.setText("Description", array_->currentText() + ", " + range_shown_->text());
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    picture.save(&buffer, "PNG");
    core::write_file(path, bytes.toStdString());
}

bool FieldsPanel::has_table() const { return loads_->rowCount() > 0; }

void FieldsPanel::export_table(const std::filesystem::path& path) {
    core::Table table;
    std::vector<std::string> names;
    std::vector<std::vector<double>> values(quantities.size());
    for (const auto& source : wanted()) {
        for (const auto& one : session().results.case_loads) {
            if ("case/" + one.name == source.id) {
                names.push_back(one.name);
                for (std::size_t q = 0; q < quantities.size(); ++q) {
                    values[q].push_back(one.value(quantities[q].first));
                }
            }
        }
    }
    table.add_text("case", names);
    for (std::size_t q = 0; q < quantities.size(); ++q) {
        table.add_numbers(quantities[q].first, q == 2 ? "N m" : "N", values[q]);
    }
    core::write_csv(path, table);
}

}  // namespace underbody::studio
