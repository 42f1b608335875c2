#include "studio/desktop/fields_panel.h"

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPushButton>
#include <QScrollArea>
#include <QSplitter>
#include <QStackedLayout>
#include <QStyle>
#include <QToolButton>
#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "core/table.h"
#include "postproc/field/field.h"
#include "postproc/loads/loads.h"
#include "studio/desktop/compare_numbers.h"
#include "studio/desktop/compare_sheet.h"
#include "studio/desktop/fitted_picture.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/rolled.h"
#include "studio/desktop/state/action_parts.h"
#include "studio/figures/render.h"

namespace underbody::studio {

namespace {

/// Of what is seen, and to where the colours run where that is farther.
QString said_of_range(const std::array<double, 2>& range) {
    const QString said = QString("%1 to %2").arg(range[0], 0, 'g', 4).arg(range[1], 0, 'g', 4);
    const double most = std::max(-range[0], range[1]);
    return is_around_zero(range) && -range[0] != range[1] ? said + QString(", colours ±%1").arg(most, 0, 'g', 4) : said;
}

}  // namespace

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
    auto* rolled = new QScrollArea;  // a small window is not made larger by its controls
    rolled->setWidget(new Held(side));
    rolled->setWidgetResizable(true);
    rolled->setFrameShape(QFrame::NoFrame);
    rolled->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    rolled->setFixedWidth(side->width() + style()->pixelMetric(QStyle::PM_ScrollBarExtent));
    all->addWidget(rolled);
    auto* right = new QVBoxLayout;
    all->addLayout(right, 1);
    fields_ = new QWidget;
    stack_ = new QStackedLayout(fields_);
    empty_ = new QLabel("Choose one to six cases in the tree on the left (Ctrl+click adds one), or drop CFD files");
    empty_->setAlignment(Qt::AlignCenter);
    empty_->setWordWrap(true);
    stack_->addWidget(empty_);
    auto* cells = new QWidget;
    grid_ = new QGridLayout(cells);
    grid_->setContentsMargins(0, 0, 0, 0);
    grid_->setSpacing(3);
    stack_->addWidget(cells);
    choice_said_ = new QLabel;
    choice_said_->setWordWrap(true);
    choice_said_->hide();
    right->addWidget(choice_said_);
    auto* halves = new QSplitter(Qt::Vertical);
    halves->addWidget(fields_);
    numbers_ = new CompareNumbers(desk_, halves);
    halves->addWidget(numbers_);
    halves->setStretchFactor(0, 4);
    halves->setStretchFactor(1, 0);
    halves->setSizes({640, 130});
    right->addWidget(halves, 1);
    build_probe(*right);
    connect(numbers_, &CompareNumbers::remark, this, &Panel::remark);
    connect(numbers_, &QTabWidget::currentChanged, this, [this, halves] {
        constexpr int for_curves = 250, for_rows = 130;  // px; rows roll, curves do not
        const QList<int> now = halves->sizes();
        if (numbers_->shows_curves() ? now[1] < for_curves : now[1] == for_curves) {
            const int wanted = numbers_->shows_curves() ? for_curves : for_rows;
            halves->setSizes({now[0] + now[1] - wanted, wanted});
        }
    });
}

void FieldsPanel::lay_out(const std::vector<Source>& sources) {
    while (cells_.size() < sources.size()) {
        auto cell = std::make_unique<Cell>();
        cell->box = new QWidget(grid_->parentWidget());  // without one it would be a window for a moment
        auto* column = new QVBoxLayout(cell->box);
        column->setContentsMargins(0, 0, 0, 0);
        cell->title = new QLabel;
        cell->title->setTextInteractionFlags(Qt::TextSelectableByMouse);
        cell->title->setWordWrap(true);
        cell->title->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);  // a long name widens no window
        column->addWidget(cell->title);
        cell->scene = std::make_unique<Scene>(cell->box);
        cell->scene->widget()->setMinimumSize(120, 100);
        const std::size_t index = cells_.size();
        cell->scene->on_hover = [this](const Scene::Picked& found) { Q_EMIT remark(found.text); };
        cell->scene->on_pick = [this, index](const Scene::Picked& found) { picked(index, found); };
        cell->scene->on_menu = [this, index](const Scene::Picked& found) {
            zone_menu(index, found.zone, QCursor::pos());
        };
        cell->scene->on_turn = [this] {
            for (const auto& one : cells_) {
                if (one->ready && one->box->isVisible()) {
                    one->scene->render();
                }
            }
        };
        cell->scene->on_turned = [this](const Scene::Pose& pose) { keep_turn(pose); };
        if (!cells_.empty()) {
            cell->scene->share_camera(*cells_.front()->scene);
        }
        column->addWidget(cell->scene->widget(), 1);
        cell->picture = new FittedPicture(cell->box);
        cell->picture->setSizePolicy(cell->scene->widget()->sizePolicy());  // else it left its room to the surfaces
        cell->picture->setMinimumSize(cell->scene->widget()->minimumSize());
        cell->picture->hide();
        column->addWidget(cell->picture, 1);
        cells_.push_back(std::move(cell));
    }
    const int columns = sheet_columns(sources.size());
    for (int column = 0; column < std::max(columns, grid_->columnCount()); ++column) {
        grid_->setColumnStretch(column, column < columns ? 1 : 0);
    }
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        grid_->removeWidget(cells_[i]->box);
        cells_[i]->box->setVisible(i < sources.size());
        if (i < sources.size()) {
            grid_->addWidget(cells_[i]->box, static_cast<int>(i) / columns, static_cast<int>(i) % columns);
        } else {
            cells_[i]->ready = cells_[i]->reading = false;
            cells_[i]->failed.clear();
            cells_[i]->source = {};
            cells_[i]->field.reset();
            cells_[i]->loads.reset();
        }
    }
}

void FieldsPanel::draw_again(bool) {
    if (by_hand_) {
        return;
    }
    auto sources = wanted();
    shared_ = title_by_difference(sources);
    stack_->setCurrentIndex(sources.empty() ? 0 : 1);
    choice_said_->setText(said_of_choice(sources));
    choice_said_->setHidden(choice_said_->text().isEmpty());
    lay_out(sources);
    bool all_ready = true;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        Cell& cell = *cells_[i];
        const auto stamp = core::stamp_of(sources[i].file);
        cell.title->setToolTip(sources[i].title + (shared_.isEmpty() ? QString() : "\nall: " + shared_));
        cell.source.title = sources[i].title;
        if (cell.source.key() != sources[i].key() || !(cell.stamp == stamp)) {
            cell.source = sources[i];
            cell.stamp = stamp;
            cell.loads.reset();
            cell.no_loads.clear();
            cell.failed.clear();
            cell.reading = true;
            read(i);
        }
        cell.title->setText(sources[i].title + cell.mark());
        all_ready = all_ready && (cell.ready || !cell.failed.isEmpty());
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
    fields_->setVisible(shows("fields"));
    numbers_->setVisible(numbers_->isVisibleTo(numbers_->parentWidget()) && shows("numbers"));
}

void FieldsPanel::taken(std::size_t index, const std::shared_ptr<const postproc::Field>& field,
                        const std::shared_ptr<const Scene::Prepared>& prepared) {
    Cell& cell = *cells_[index];
    const bool first = first_ready() == nullptr;
    cell.scene->show(prepared, first);
    cell.field = field;
    cell.ready = true;
    cell.reading = false;
    pictures_of_.clear();
    for (const auto& found : cell.scene->field()->problems) {
        Q_EMIT problem(found);
    }
    if (first || (session().folder.empty() && cell.shown != cell.source.id)) {
        camera_.clear();  // files from outside may be of any size
    }
    cell.shown = cell.source.id;
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
            if (const auto typed = state().fields.zones.find(zone.name);
                body_mode_->isChecked() && typed == state().fields.zones.end()) {
                seen.back() = true;  // what is chosen from is seen
            }
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
    tint_bodies();
    range = state().fields.range ? state().fields.range : range;
    range_now_ = range;
    keep_range_->setEnabled(range && !state().fields.range && array_->currentText() != "(plain)");
    for (const auto& choice : chosen) {
        unit_ = choice.name.empty() ? unit_ : qt(pretty_unit(choice.unit));
    }
    range_shown_->setText(range && array_->currentText() != "(plain)" ? said_of_range(*range) : QString());
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        if (cells_[i]->ready) {
            cells_[i]->scene->colour_by(chosen[i], range.value_or(std::array<double, 2>{0, 1}));
        }
    }
    check_names();
    offer_half();
    show_probe();
    look();
    for (const auto& cell : cells_) {
        if (cell->ready) {
            cell->scene->render();
        }
    }
    show_pictures();
}

std::string FieldsPanel::seen_from(const FieldView& view) {
    return view.turned ? view.camera + " " + text_of(*view.turned) : view.camera;
}

void FieldsPanel::keep_turn(const Scene::Pose& pose) {
    FieldView turned = state().fields;
    turned.turned = action::pose_from(text_of(pose));
    camera_ = seen_from(turned);
    by_hand_ = true;
    desk_.act({"turn", "compare", text_of(pose)});
    by_hand_ = false;
    show_pictures();  // differences are seen from there, too
}

void FieldsPanel::look() {
    Cell* cell = first_ready();
    const FieldView& view = state().fields;
    if (cell != nullptr && seen_from(view) != camera_) {
        camera_ = seen_from(view);
        std::optional<std::array<double, 6>> box;  // around the bodies of all cells: they have one camera
        for (const auto& one : cells_) {
            const auto own = one->ready ? one->scene->bounds() : std::nullopt;
            for (std::size_t i = 0; own && box && i < 6; i += 2) {
                (*box)[i] = std::min((*box)[i], (*own)[i]);
                (*box)[i + 1] = std::max((*box)[i + 1], (*own)[i + 1]);
            }
            box = box ? box : own;
        }
        cell->scene->look_from(view.camera, session().folder.empty() ? "+x" : session().study.forward,
                               session().folder.empty() ? "+z" : session().study.up, box);
        if (view.turned) {
            cell->scene->set_pose(*view.turned);
        }
    }
}

bool FieldsPanel::has_picture() const { return first_ready() != nullptr; }

Sheet FieldsPanel::sheet() const {
    Sheet sheet;
    for (const auto& cell : cells_) {
        if (cell->picture->isVisible() && !cell->picture->image.isNull()) {
            sheet.cells.emplace_back(cell->title->text(), cell->picture->image);
        } else if (cell->ready && !cell->picture->isVisible()) {
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
    const std::map<std::string, QString> seen = {
        {"bottom", "from below"}, {"top", "from above"}, {"side", "from the side"}, {"front", "from ahead"}};
    const auto camera = seen.find(state().fields.camera);
    sheet.about += "seen " +
                   (state().fields.turned  ? QString("as turned by hand")
                    : camera == seen.end() ? QString("obliquely from below")
                                           : camera->second) +
                   "; colours " +
                   (state().fields.range         ? "on a range that was given"
                    : state().fields.whole_range ? "over the whole range"
                                                 : "from the 1st to the 99th hundredth of what is seen") +
                   ", the same for all";
    sheet.about += choice_said_->isHidden() ? QString() : "; " + choice_said_->text();
    sheet.rows = numbers_->rows();
    sheet.bold = numbers_->beyond();
    sheet.about += sheet.bold.empty() ? "" : "; bold: more than twice the joint standard deviation";
    sheet.about += shared_.isEmpty() ? QString() : "; all: " + shared_;
    return sheet;
}

void FieldsPanel::export_picture(const std::filesystem::path& path) { write_sheet(sheet(), path); }

QImage FieldsPanel::picture_to_copy() const { return has_picture() ? draw_sheet(sheet()) : QImage(); }

bool FieldsPanel::has_table() const { return numbers_->has_table(); }

void FieldsPanel::export_table(const std::filesystem::path& path) { core::write_csv(path, numbers_->table()); }

bool FieldsPanel::dark() const { return palette().base().color().lightness() < 128; }

}  // namespace underbody::studio
