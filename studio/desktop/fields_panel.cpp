#include "studio/desktop/fields_panel.h"

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPainter>
#include <QSplitter>
#include <QStackedLayout>
#include <algorithm>
#include <cmath>

#include "cases/case_loads.h"
#include "core/error.h"
#include "core/file.h"
#include "core/table.h"
#include "core/text.h"
#include "postproc/field/field.h"
#include "postproc/loads/loads.h"
#include "postproc/views/views.h"
#include "studio/desktop/compare_numbers.h"
#include "studio/desktop/compare_sheet.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

constexpr std::size_t most_cells = 6;

struct DrawnDifference {
    QImage image;
    QString said;  ///< the caption, or why there is no picture
};

/// Each less the first, in one range of colours.
std::vector<DrawnDifference> differences_to(const postproc::Field& first,
                                            const std::vector<std::shared_ptr<const postproc::Field>>& fields,
                                            const std::string& array, const postproc::ViewOptions& options,
                                            core::Progress& progress) {
    std::vector<const postproc::Field*> others;
    for (const auto& field : fields) {
        others.push_back(field.get());
    }
    std::vector<DrawnDifference> drawn;
    for (const auto& one : postproc::difference_views(first, others, array, options, progress)) {
        drawn.push_back(one.view
                            ? DrawnDifference{QImage::fromData(reinterpret_cast<const uchar*>(one.view->png.data()),
                                                               static_cast<int>(one.view->png.size())),
                                              qt(one.view->caption)}
                            : DrawnDifference{{}, qt(one.why)});
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
    empty_ = new QLabel("Choose one to six cases in the tree on the left (Ctrl+click adds one), or drop CFD files");
    empty_->setAlignment(Qt::AlignCenter);
    empty_->setWordWrap(true);
    stack_->addWidget(empty_);
    auto* cells = new QWidget;
    grid_ = new QGridLayout(cells);
    grid_->setContentsMargins(0, 0, 0, 0);
    grid_->setSpacing(3);
    stack_->addWidget(cells);
    auto* halves = new QSplitter(Qt::Vertical);
    halves->addWidget(middle);
    numbers_ = new CompareNumbers(desk_, halves);
    halves->addWidget(numbers_);
    halves->setStretchFactor(0, 4);
    halves->setStretchFactor(1, 0);
    halves->setSizes({640, 130});
    right->addWidget(halves, 1);
    connect(numbers_, &CompareNumbers::remark, this, &Panel::remark);
    if (!Scene::possible()) {
        empty_->setText(
            "The 3D view needs OpenGL 3.2, which this display does not offer.\n"
            "On a server, start the program under Xvfb with the package libgl1-mesa-dri installed.");
    }
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
    const int columns = sheet_columns(sources.size());
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        grid_->removeWidget(cells_[i]->box);
        cells_[i]->box->setVisible(i < sources.size());
        if (i < sources.size()) {
            grid_->addWidget(cells_[i]->box, static_cast<int>(i) / columns, static_cast<int>(i) % columns);
        } else {
            cells_[i]->ready = false;
            cells_[i]->source = {};
            cells_[i]->field.reset();
            cells_[i]->loads.reset();
        }
    }
}

void FieldsPanel::draw_again(bool) {
    if (!Scene::possible()) {
        return;
    }
    const auto sources = wanted();
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
            cell.loads.reset();
            cell.no_loads.clear();
            read(i);
        }
        all_ready = all_ready && cell.ready;
    }
    show_numbers();
    if (all_ready && !sources.empty()) {
        recolour();
    }
}

void FieldsPanel::show_numbers() {
    std::vector<ComparedCase> cases;
    for (const auto& cell : cells_) {
        if (!cell->source.id.empty()) {
            const std::string& id = cell->source.id;
            const std::string name = id.starts_with("case/") ? id.substr(5) : cell->source.file.filename().string();
            cases.push_back({id, name, cell->loads, cell->no_loads});
        }
    }
    numbers_->show_cases(std::move(cases), state().fields.difference);
}

namespace {

/// The loads of a field that was read, with their running integral; why there are none.
struct FieldLoads {
    std::shared_ptr<const postproc::LoadsResult> loads;
    std::string why;
};

FieldLoads loads_of(const postproc::Field& field, postproc::LoadsOptions options, core::Progress& progress) {
    options.stations = 80;
    try {
        return {std::make_shared<const postproc::LoadsResult>(postproc::loads(field, options, progress)), {}};
    } catch (const core::InputError& error) {
        return {nullptr, error.message() + (error.hint().empty() ? "" : "; " + error.hint())};
    } catch (const core::UsageError& error) {
        return {nullptr, error.message()};
    }
}

}  // namespace

postproc::LoadsOptions FieldsPanel::loads_options(const Source& source) const {
    for (const auto& one : session().study.cases) {
        if ("case/" + one.name == source.id) {
            return cases::loads_options(session().study, one);
        }
    }
    if (session().folder.empty()) {
        return {};
    }
    cases::Case outside;
    outside.file = source.file;
    return cases::loads_options(session().study, outside);
}

void FieldsPanel::read(std::size_t index) {
    const Source source = cells_[index]->source;
    jobs_.start(QString("field %1").arg(index), "reading " + qt(source.file.filename().string()),
                [this, index, source, mirror = session().study.symmetry,
                 options = loads_options(source)](core::Progress& progress) {
                    postproc::ReadOptions reading;
                    reading.surfaces_only = true;
                    auto field =
                        std::make_shared<const postproc::Field>(postproc::read_field(source.file, reading, progress));
                    const auto prepared = Scene::prepare(field, mirror);
                    const auto sum = loads_of(*field, options, progress);
                    return [this, index, source, field, prepared, sum] {
                        if (index < cells_.size() && cells_[index]->source.id == source.id) {
                            cells_[index]->loads = sum.loads;
                            cells_[index]->no_loads = sum.why;
                            taken(index, field, prepared);
                        }
                    };
                });
}

void FieldsPanel::taken(std::size_t index, const std::shared_ptr<const postproc::Field>& field,
                        const std::shared_ptr<const Scene::Prepared>& prepared) {
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
    show_numbers();
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
        scene.set_ground(dark());
        for (const auto& choice : scene.choices()) {
            chosen[i] = qt(choice.label) == array_->currentText() ? choice : chosen[i];
        }
        if (const auto own = scene.range_of(chosen[i], whole_range_->isChecked())) {
            range =
                range ? std::array<double, 2>{std::min((*range)[0], (*own)[0]), std::max((*range)[1], (*own)[1])} : own;
        }
    }
    range = state().fields.range ? state().fields.range : range;
    for (const auto& choice : chosen) {
        unit_ = choice.name.empty() ? unit_ : qt(pretty_unit(choice.unit));
    }
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
    key += array + " " + state().fields.camera;
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
    // Drawn as large as they are shown, so that their words keep their size.
    const QSize room = cells_.front()->scene->widget()->size() * devicePixelRatioF();
    options.width = std::max(480, room.width());
    options.height = std::max(320, room.height());
    options.text_size = std::clamp(560.0 / options.height, 1.0, 1.5);
    options.camera = state().fields.camera;
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

bool FieldsPanel::has_picture() const { return first_ready() != nullptr; }

Sheet FieldsPanel::sheet() const {
    Sheet sheet;
    for (const auto& cell : cells_) {
        if (cell->difference->isVisible() && !cell->difference->image.isNull()) {
            sheet.cells.emplace_back(cell->title->text(), cell->difference->image);
        } else if (cell->ready) {
            cell->scene->set_ground(false);
            const std::string png = cell->scene->png();
            sheet.cells.emplace_back(cell->source.title, QImage::fromData(reinterpret_cast<const uchar*>(png.data()),
                                                                          static_cast<int>(png.size())));
            cell->scene->set_ground(dark());
        }
    }
    sheet.title = array_->currentText();
    if (!range_shown_->text().isEmpty()) {
        sheet.title += " (" + unit_ + "), " + range_shown_->text();
    }
    sheet.about = desk_.has_study() ? qt(session().study.title) + ", " : QString();
    sheet.about += "seen from " + qt(state().fields.camera) + "; colours " +
                   (state().fields.range         ? "on a range that was given"
                    : state().fields.whole_range ? "over the whole range"
                                                 : "from the 1st to the 99th hundredth of what is seen") +
                   ", the same for all";
    sheet.rows = numbers_->rows();
    return sheet;
}

void FieldsPanel::export_picture(const std::filesystem::path& path) { write_sheet(sheet(), path); }

QImage FieldsPanel::picture_to_copy() const { return has_picture() ? draw_sheet(sheet()) : QImage(); }

bool FieldsPanel::has_table() const { return numbers_->has_table(); }

void FieldsPanel::export_table(const std::filesystem::path& path) { core::write_csv(path, numbers_->table()); }

bool FieldsPanel::dark() const { return palette().base().color().lightness() < 128; }

}  // namespace underbody::studio
