#include "studio/desktop/body_panel.h"

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QShortcut>
#include <QSignalBlocker>
#include <QStackedLayout>
#include <algorithm>

#include "core/error.h"
#include "core/file.h"
#include "postproc/field/field.h"
#include "postproc/loads/body_zones.h"
#include "studio/desktop/jobs.h"
#include "studio/desktop/qt_text.h"
#include "studio/desktop/scene.h"

namespace underbody::studio {

namespace {

/// Zones that are the body: those of the case's patterns, else what may be a wall but not the ground.
bool is_body(const postproc::Field& field, const postproc::Zone& zone, const std::vector<std::string>& patterns) {
    if (!patterns.empty()) {
        return postproc::matches_any(patterns, zone.name);
    }
    std::vector<const postproc::Zone*> said_otherwise;
    const auto walls = postproc::possible_walls(field, said_otherwise);
    return std::find(walls.begin(), walls.end(), &zone) != walls.end() && !postproc::matches("*ground*", zone.name);
}

}  // namespace

BodyPanel::BodyPanel(Jobs& jobs, QWidget* parent) : Panel(jobs, parent) {
    setObjectName("body");
    build();
}

BodyPanel::~BodyPanel() = default;

void BodyPanel::build() {
    auto* all = new QHBoxLayout(this);
    auto* left = new QVBoxLayout;
    all->addLayout(left, 0);
    title_ = new QLabel;
    title_->setWordWrap(true);
    title_->setStyleSheet("font-weight: bold");
    left->addWidget(title_);
    left->addWidget(new QLabel("Colour by"));
    array_ = new QComboBox;
    array_->setToolTip("Which array of the field colours the surface");
    left->addWidget(array_);
    whole_range_ = new QCheckBox("whole range of colours");
    whole_range_->setToolTip(
        "Off: colours span the 1st to the 99th hundredth of the values, so that single points at an\n"
        "edge do not take all the colours");
    left->addWidget(whole_range_);
    edges_ = new QCheckBox("mesh lines");
    left->addWidget(edges_);
    mirror_ = new QCheckBox("mirror half model");
    left->addWidget(mirror_);
    left->addWidget(new QLabel("Zones"));
    zones_ = new QListWidget;
    zones_->setToolTip("Ticked zones are drawn, and set the range of the colours");
    left->addWidget(zones_, 1);
    auto* views = new QGridLayout;
    const std::vector<std::tuple<QString, QString, QString>> buttons = {{"&Underbody", "bottom", "U"},
                                                                        {"&Top", "top", "T"},
                                                                        {"&Side", "side", "S"},
                                                                        {"F&ront", "front", "R"},
                                                                        {"&Oblique", "iso", "O"}};
    int place = 0;
    for (const auto& [text, view, key] : buttons) {
        auto* button = new QPushButton(text);
        button->setToolTip("Look from there (" + key + ")");
        views->addWidget(button, place / 2, place % 2);
        ++place;
        connect(button, &QPushButton::clicked, this, [this, v = view] { look_from(v); });
        auto* shortcut = new QShortcut(QKeySequence(key), this);
        shortcut->setContext(Qt::WidgetWithChildrenShortcut);
        connect(shortcut, &QShortcut::activated, this, [this, v = view] { look_from(v); });
    }
    left->addLayout(views);
    for (auto* widget : std::initializer_list<QWidget*>{array_, zones_}) {
        widget->setFixedWidth(210);
    }
    title_->setFixedWidth(210);

    stack_ = new QStackedLayout;
    all->addLayout(stack_, 1);
    empty_ = new QLabel("Choose a case in the tree on the left");
    empty_->setAlignment(Qt::AlignCenter);
    empty_->setWordWrap(true);
    stack_->addWidget(empty_);
    if (Scene::possible()) {
        scene_ = std::make_unique<Scene>(this);
        scene_->on_pick = [this](const QString& text) { Q_EMIT remark(text); };
        stack_->addWidget(scene_->widget());
    } else {
        empty_->setText(
            "The 3D view needs OpenGL 3.2, which this display does not offer.\n"
            "On a server, start the program under Xvfb with the package libgl1-mesa-dri installed.");
    }
    connect(array_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] {
        kept_array_ = array_->currentText();
        recolour();
    });
    connect(whole_range_, &QCheckBox::toggled, this, [this] { recolour(); });
    connect(edges_, &QCheckBox::toggled, this, [this] { recolour(); });
    connect(mirror_, &QCheckBox::toggled, this, [this] { recolour(); });
    connect(zones_, &QListWidget::itemChanged, this, [this] { recolour(); });
}

bool BodyPanel::can_draw() const { return scene_ != nullptr && scene_->field() != nullptr; }

void BodyPanel::show_session(const SessionPointer& session) {
    const bool other = !session_ || session_->study.folder() != session->study.folder();
    session_ = session;
    mirror_->setEnabled(!session->study.symmetry.empty());
    if (other) {
        const QSignalBlocker quiet(mirror_);
        mirror_->setChecked(!session->study.symmetry.empty());
    }
    if (other && !session->study.cases.empty()) {
        first_ = true;
        // A picture from the start: the first case that the study itself wants pictures of, else the first of all.
        const cases::Case* chosen = &session->study.cases.front();
        for (const auto& picture : session->study.pictures) {
            if (const auto found = session->study.select(picture.where); !found.empty()) {
                chosen = found.front();
                break;
            }
        }
        show_case(*chosen);
    }
}

void BodyPanel::show_case(const cases::Case& chosen) {
    show_file(chosen.file, chosen.zones, qt(chosen.conditions.label()));
}

void BodyPanel::show_file(const std::filesystem::path& file, const std::vector<std::string>& zones,
                          const QString& title) {
    if (scene_ == nullptr) {
        return;
    }
    jobs_.start("body", "reading " + qt(file.filename().string()),
                [this, file, zones, title](core::Progress& progress) {
                    postproc::ReadOptions options;
                    options.surfaces_only = true;
                    auto field = std::make_shared<const postproc::Field>(postproc::read_field(file, options, progress));
                    return [this, field, zones, title] {
                        wanted_zones_ = zones;
                        title_->setText(title);
                        scene_->show(field, first_);
                        for (const auto& found : field->problems) {
                            Q_EMIT problem(found);
                        }
                        fill_zones();
                        fill_arrays();
                        stack_->setCurrentWidget(scene_->widget());
                        recolour();
                        if (first_) {
                            look_from("iso");
                            first_ = false;
                        }
                    };
                });
}

void BodyPanel::fill_zones() {
    const QSignalBlocker quiet(zones_);
    zones_->clear();
    for (const auto& zone : scene_->field()->zones) {
        auto* item = new QListWidgetItem(qt(zone.name), zones_);
        const bool drawn = zone.surface && zone.surface->GetNumberOfCells() > 0;
        item->setFlags(drawn ? Qt::ItemIsEnabled | Qt::ItemIsUserCheckable | Qt::ItemIsSelectable : Qt::NoItemFlags);
        item->setCheckState(drawn && is_body(*scene_->field(), zone, wanted_zones_) ? Qt::Checked : Qt::Unchecked);
        item->setToolTip(QString("%1, %2 faces")
                             .arg(qt(postproc::to_string(zone.kind)))
                             .arg(drawn ? static_cast<qlonglong>(zone.surface->GetNumberOfCells()) : 0));
    }
}

void BodyPanel::fill_arrays() {
    const QSignalBlocker quiet(array_);
    const QString wanted = kept_array_;
    array_->clear();
    for (const auto& choice : scene_->choices()) {
        array_->addItem(qt(choice.label));
    }
    array_->addItem("(plain)");
    const int kept = array_->findText(wanted);
    array_->setCurrentIndex(kept >= 0 ? kept : 0);
}

void BodyPanel::recolour() {
    if (!can_draw()) {
        return;
    }
    std::vector<bool> seen;
    for (int i = 0; i < zones_->count(); ++i) {
        seen.push_back(zones_->item(i)->checkState() == Qt::Checked);
    }
    const bool mirrored = mirror_->isEnabled() && mirror_->isChecked() && session_;
    scene_->mirror(mirrored ? session_->study.symmetry : "");
    scene_->set_visible(seen);
    scene_->show_edges(edges_->isChecked());
    Scene::Choice chosen;
    for (const auto& choice : scene_->choices()) {
        if (qt(choice.label) == array_->currentText()) {
            chosen = choice;
        }
    }
    scene_->colour_by(chosen, whole_range_->isChecked());
    scene_->render();
}

void BodyPanel::look_from(const QString& view) {
    if (can_draw()) {
        scene_->look_from(view.toStdString(), session_ ? session_->study.forward : "+x",
                          session_ ? session_->study.up : "+z");
        scene_->render();
    }
}

bool BodyPanel::has_picture() const { return can_draw(); }

void BodyPanel::export_picture(const std::filesystem::path& path) {
    if (path.extension() != ".png") {
        throw core::UsageError("format", "a 3D view is written as .png only");
    }
    core::write_file(path, scene_->png());
}

void BodyPanel::demonstrate() { look_from("bottom"); }

}  // namespace underbody::studio
