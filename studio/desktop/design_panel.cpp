#include "studio/desktop/design_panel.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QEvent>
#include <QHeaderView>
#include <QInputDialog>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTableWidget>
#include <QTimer>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/side_by_side.h"
#include "studio/figures/render.h"

namespace underbody::studio {

DesignPanel::DesignPanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
    setObjectName("design");
    rest_ = new QTimer(this);
    rest_->setSingleShot(true);
    rest_->setInterval(120);
    connect(rest_, &QTimer::timeout, this, &DesignPanel::ask_rest);
    map_rest_ = new QTimer(this);
    map_rest_->setSingleShot(true);
    map_rest_->setInterval(120);
    connect(map_rest_, &QTimer::timeout, this, &DesignPanel::ask_map);
    build();
}

DesignPanel::~DesignPanel() = default;

void DesignPanel::build() {
    auto* all = new QHBoxLayout(this);
    all->setContentsMargins(4, 4, 4, 4);
    auto* views = new QSplitter(Qt::Vertical);
    all->addWidget(views, 1);
    upper_ = new QSplitter(Qt::Horizontal);
    auto* body = new QWidget;
    body_place_ = new QVBoxLayout(body);
    body_place_->setContentsMargins(0, 0, 0, 0);
    body->setMinimumSize(200, 160);
    section_ = new PlotView(this);
    body_cell_ = new ViewCell(*this, "body", "Body", body);
    build_view_tools();
    section_cell_ = new ViewCell(*this, "section", "Section", section_);
    upper_->addWidget(body_cell_);
    upper_->addWidget(section_cell_);
    lift_plot_ = new PlotView(this);
    map_plot_ = new PlotView(this);
    for (auto* plot : {lift_plot_, map_plot_}) {
        plot->set_least({260, 270});  // title, a legend of three lines and the axis take 150 of it
    }
    constexpr int room = 800;  // px: narrower ones are all legend
    views->addWidget(upper_);
    lift_or_map_ = new SideBySide(new ViewCell(*this, "lift", "Lift", lift_plot_), "Lift",
                                  new ViewCell(*this, "map", "Stability map", map_plot_), "Stability map", room);
    views->addWidget(lift_or_map_);
    connect(lift_or_map_->tabs(), &QTabBar::currentChanged, this, [this](int tab) {
        desk_.act({"show", tab == 1 ? "map" : "lift"});
    });
    views->setStretchFactor(0, 1);
    views->setStretchFactor(1, 1);
    views->setSizes({400, 400});
    auto* side = new QWidget;
    side->setFixedWidth(390);
    all->addWidget(side);
    auto* column = new QVBoxLayout(side);
    column->setContentsMargins(0, 0, 0, 0);
    build_side(*column);
    connect(section_, &PlotView::hovered, this, &Panel::remark);
    connect(lift_plot_, &PlotView::hovered, this, &Panel::remark);
    connect(map_plot_, &PlotView::hovered, this, &Panel::remark);
    connect(&desk_, &Desk::sought, this, &DesignPanel::find_row);
}

/// With the first body: an empty window needs no OpenGL, whose software renderer takes 70 MB.
void DesignPanel::make_scene() {
    scene_ = std::make_unique<Scene>(body_place_->parentWidget());
    scene_->widget()->installEventFilter(this);
    scene_->on_hover = scene_->on_pick = [this](const Scene::Picked& found) { Q_EMIT remark(found.text); };
    body_place_->addWidget(scene_->widget());
    keep_turns();
}

void DesignPanel::build_side(QVBoxLayout& side) {
    choice_ = new QComboBox;
    choice_->setAccessibleName("Shape");
    connect(choice_, QOverload<int>::of(&QComboBox::activated), this, [this] {
        desk_.act({"shape", choice_->currentText().toStdString()});
    });
    side.addWidget(choice_);
    auto* area = parameter_area_ = new QScrollArea;
    area->setWidgetResizable(true);
    area->setFrameShape(QFrame::NoFrame);
    area->setMinimumHeight(170);  // some rows, also on a laptop
    auto* inside = new QWidget;
    parameter_column_ = new QVBoxLayout(inside);
    parameter_column_->setContentsMargins(0, 0, 6, 0);
    parameter_column_->setSpacing(1);
    area->setWidget(inside);
    auto* parts = new QSplitter(Qt::Vertical);  // numbers above, results below
    parts->setChildrenCollapsible(false);
    side.addWidget(parts, 1);
    auto* numbers = new QWidget;
    auto* upper = new QVBoxLayout(numbers);
    upper->setContentsMargins(0, 0, 0, 0);
    upper->addWidget(area, 1);
    parts->addWidget(numbers);
    make_rows();
    auto* buttons = new QHBoxLayout;
    auto* keep = new QPushButton("&Keep …");
    auto* reset = new QPushButton("&As in the file");
    keep->setToolTip("Keeps the changed shape as a variant of its own");
    auto* pin = new QPushButton("&Pin as before");
    pin->setToolTip("The column `before` holds what is now (Ctrl+D)");
    buttons->addWidget(keep);
    buttons->addWidget(reset);
    buttons->addWidget(pin);
    auto* cfd = new QPushButton("CF&D …");
    cfd->setToolTip("Adds the shape as it is now to the study's sweep, and says first what its cases cost");
    buttons->addWidget(cfd);
    connect(cfd, &QPushButton::clicked, this, &DesignPanel::cfd_wanted);
    upper->addLayout(buttons);
    connect(keep, &QPushButton::clicked, this, [this] {
        const QString name = QInputDialog::getText(this, "Keep as variant", "Name of the new shape", QLineEdit::Normal,
                                                   qt(name_) + "-2");
        if (!name.isEmpty()) {
            desk_.act({"keep", name.toStdString()});
        }
    });
    connect(reset, &QPushButton::clicked, this, [this] { desk_.act({"reset"}); });
    connect(pin, &QPushButton::clicked, this, [this] { desk_.act({"pin"}); });
    card_ = new QTableWidget(0, 3);
    card_->setAccessibleName("Results now and before");
    card_->setHorizontalHeaderLabels({"result", "now", "before"});
    card_->verticalHeader()->hide();
    card_->verticalHeader()->setDefaultSectionSize(19);
    card_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    card_->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
    for (const int whole : {0, 1}) {  // in bold, too
        card_->horizontalHeader()->setSectionResizeMode(whole, QHeaderView::ResizeToContents);
    }
    card_->setMinimumHeight(130);
    parts->addWidget(card_);
    parts->setStretchFactor(0, 1);
    parts->setStretchFactor(1, 1);
    parts->setSizes({300, 240});
    state_label_ = new QLabel;
    state_label_->setWordWrap(true);
    side.addWidget(state_label_);
    lift_label_ = new QLabel;
    lift_label_->setWordWrap(true);
    side.addWidget(lift_label_);
    map_label_ = new QLabel;
    map_label_->setWordWrap(true);
    side.addWidget(map_label_);
}

geometry::Placement DesignPanel::placement() const { return {state().design.gap, state().design.pitch, 0}; }

std::string DesignPanel::key_of(const geometry::BodyShape& shape) const {
    return geometry::shape_hash(shape) + " " + core::format_number(state().design.gap) + " " +
           core::format_number(state().design.pitch);
}

std::shared_ptr<const LiveBody> DesignPanel::remembered(const std::string& key) const {
    for (const auto& known : cache_) {
        if (known.key == key) {
            return known.body;
        }
    }
    return nullptr;
}

void DesignPanel::draw_again(bool fresh) {
    lift_or_map_->show_right(state().design.map);
    lift_or_map_->want(shows("lift"), shows("map"));
    body_cell_->setVisible(shows("body"));
    section_cell_->setVisible(shows("section"));
    upper_->setVisible(shows("body") || shows("section"));
    const QSignalBlocker quiet(choice_);
    choice_->clear();
    for (const auto& name : shape_names(state(), session())) {
        choice_->addItem(qt(name));
    }
    const std::string name = shown_shape(state(), session());
    setEnabled(!name.empty());
    if (name.empty()) {
        shown_.reset();
        section_->show_text("This study has no [[body]]; drop a SHAPE.toml on the window");
        lift_plot_->show_text("");
        map_plot_->show_text("");
        map_label_->clear();
        return;
    }
    choice_->setCurrentText(qt(name));
    try {
        shape_ = shape_of(state(), session(), name);
    } catch (const core::Error& error) {
        section_->show_text(qt(error.what()));
        return;
    }
    show_groups();
    if (name != name_) {
        ranges_.clear();
        ranges_of_.clear();
        name_ = name;
    }
    if (ranges_.empty() || fresh) {  // results that come in while a study is computed change no limit
        ask_ranges();
    }
    fill_rows(name, shape_);
    make_before();
    const std::string key = key_of(shape_);
    if (key != key_ || !shown_) {
        key_ = key;
        if (const auto known = remembered(key)) {
            jobs_.cancel("design rest");
            rest_->stop();
            show_body(known);
        } else {
            jobs_.cancel("design rest");  // of a body before: it would keep the next one waiting
            if (jobs_.busy("design ranges")) {
                jobs_.cancel("design ranges");
                ranges_of_.clear();  // asked for again at rest
            }
            ask_move();
            rest_->start();
        }
    } else {
        draw_section();
        show_view(false);
    }
    show_lift();  // and the card
}

/// One at a time, and the newest next: a slow body is not asked for twice.
void DesignPanel::ask_move() {
    if (moving_) {
        move_again_ = true;
        return;
    }
    moving_ = true;
    jobs_.start(
        "design move", "body",
        [this, shape = shape_, at = placement(), key = key_](core::Progress& progress) {
            const auto body = std::make_shared<const LiveBody>(moving_body(shape, at, progress));
            return [this, body, key] {
                const bool whole = shown_ && shown_->certificate && key_of(shown_->shape) == key;
                if (!whole) {
                    show_body(body);
                }
            };
        },
        true,
        [this] {
            moving_ = false;
            if (std::exchange(move_again_, false)) {
                ask_move();
            }
        });
}

bool DesignPanel::dragging() const {
    bool drag = gap_->dragging() || pitch_->dragging() || speed_->dragging();
    for (const auto& [name, row] : rows_) {
        drag = drag || row->dragging();
    }
    return drag;
}

void DesignPanel::ask_rest() {
    if (dragging()) {
        rest_->start();
        return;
    }
    ask_ranges();
    const auto known = remembered(key_);
    const bool whole = known && (known->added_mass || !known->contact.empty());
    if (whole || (rest_of_ == key_ && jobs_.busy("design rest"))) {
        return;
    }
    rest_of_ = key_;
    if (known) {  // its added mass was interrupted
        ask_added_mass(known, key_);
        return;
    }
    jobs_.start("design rest", "surface and certificate of " + qt(name_),
                [this, shape = shape_, at = placement(), key = key_](core::Progress& progress) {
                    const auto body = std::make_shared<const LiveBody>(resting_body(shape, at, progress));
                    return [this, body, key] {
                        ask_added_mass(body, key);
                        take(body, key);
                    };
                });
}

void DesignPanel::ask_added_mass(const std::shared_ptr<const LiveBody>& body, const std::string& key) {
    jobs_.start("design rest", "added mass of " + qt(name_), [this, body, key](core::Progress& progress) {
        const auto whole = std::make_shared<LiveBody>(*body);
        add_added_mass(*whole, progress);
        return [this, whole, key] { take(whole, key); };
    });
}

void DesignPanel::take(const std::shared_ptr<const LiveBody>& body, const std::string& key) {
    std::erase_if(cache_, [&](const Known& known) { return known.key == key; });
    cache_.push_front({key, body});
    if (cache_.size() > 24) {
        cache_.pop_back();
    }
    if (key == key_) {
        show_body(body);
    }
}

void DesignPanel::show_body(const std::shared_ptr<const LiveBody>& body) {
    const bool first = shown_ == nullptr;
    shown_ = body;
    if (body_place_->isEmpty()) {
        make_scene();
    }
    if (scene_) {
        scene_->set_ground(palette().base().color().lightness() < 128);
        scene_->show(body->drawn, first);
        scene_->colour_by({}, {0, 1});
        if (!fitted_view_ &&
            !state().design.turned) {  // the first ones come while the window still gives everything its place
            fit_view();
            fitted_view_ = body->certificate.has_value();
        }
        show_view(true);
    }
    draw_section();
    show_card();
    if (body->certificate && !body->added_mass && body->contact.empty() && !jobs_.busy("design rest")) {
        rest_->start();  // its added mass was interrupted
    }
}

/// The body before as a thin line behind the one that is shown.
void DesignPanel::draw_section() {
    if (!shown_) {
        return;
    }
    core::Figure figure = shown_->section;
    figure.title.clear();  // it stands over it, and leaves its room to the section
    section_cell_->set_title("Section of " + qt(name_) + (before_ ? " (before: thin)" : ""));
    if (before_) {
        for (core::FigureCurve curve : before_->section.curves) {
            if (curve.width >= 2) {  // the outline, not its dimensions
                curve.width = 0.8;
                curve.colour = core::palette(1);
                figure.curves.insert(figure.curves.begin(), curve);
            }
        }
    }
    section_->show_figure(figure, true);
}

void DesignPanel::fit_view() { scene_->look_from("iso", "+x", "+z"); }

/// A view that nobody has turned shows the body as large as its place lets it.
bool DesignPanel::eventFilter(QObject* watched, QEvent* event) {
    const auto untouched = [this] { return scene_ && !state().design.turned && !scene_->in_hand(); };
    if (event->type() == QEvent::Resize && shown_ && untouched()) {
        QTimer::singleShot(0, this, [this, untouched] {
            if (untouched()) {
                fit_view();
                scene_->render();
            }
        });
    }
    return Panel::eventFilter(watched, event);
}

void DesignPanel::export_picture(const std::filesystem::path& path) {
    core::Figure figure = section_->figure();
    figure.title = name_ + ": section";
    write_picture(figure, path);
}

}  // namespace underbody::studio
