#include "studio/desktop/pictures_panel.h"

#include <QBoxLayout>
#include <QEvent>
#include <QLabel>
#include <QListWidget>
#include <QScrollArea>
#include <QSignalBlocker>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

namespace {

/// Title and caption that the store keeps beside a plot; "" when there are none.
QString caption_of(const cases::StudyResults& results, const std::string& key) {
    const auto* text = results.document(key);
    const auto document = text != nullptr ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    return document.is_object() ? qt(document.value("caption", "")) : QString();
}

}  // namespace

PicturesPanel::PicturesPanel(Jobs& jobs, QWidget* parent) : Panel(jobs, parent) {
    setObjectName("pictures");
    auto* row = new QHBoxLayout(this);
    list_ = new QListWidget;
    list_->setFixedWidth(270);
    list_->setTextElideMode(Qt::ElideMiddle);
    row->addWidget(list_);
    auto* column = new QVBoxLayout;
    row->addLayout(column, 1);
    area_ = new QScrollArea;
    area_->setWidgetResizable(true);
    area_->setFrameShape(QFrame::NoFrame);
    picture_ = new QLabel("Open a study");
    picture_->setAlignment(Qt::AlignCenter);
    area_->setWidget(picture_);
    area_->viewport()->installEventFilter(this);
    column->addWidget(area_, 1);
    caption_ = new QLabel;
    caption_->setWordWrap(true);
    caption_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    column->addWidget(caption_);
    connect(list_, &QListWidget::currentRowChanged, this, [this] { choose(); });
}

void PicturesPanel::show_session(const SessionPointer& session) {
    session_ = session;
    const QString kept = list_->currentItem() != nullptr ? list_->currentItem()->text() : QString();
    {
        const QSignalBlocker quiet(list_);
        list_->clear();
        for (const auto& [key, png] : session->results.pictures) {
            auto* item = new QListWidgetItem(qt(key).replace("/", " · "), list_);
            item->setData(Qt::UserRole, qt(key));
            item->setToolTip(item->text());
        }
        const auto found = list_->findItems(kept, Qt::MatchExactly);
        list_->setCurrentRow(found.isEmpty() || kept.isEmpty() ? 0 : list_->row(found.front()));
    }
    choose();
}

void PicturesPanel::show_case(const cases::Case& chosen) {
    for (int i = 0; i < list_->count(); ++i) {
        if (list_->item(i)->data(Qt::UserRole).toString().contains("/" + qt(chosen.name) + "/")) {
            list_->setCurrentRow(i);
            return;
        }
    }
}

void PicturesPanel::choose() {
    whole_ = {};
    caption_->clear();
    if (list_->currentItem() == nullptr) {
        picture_->setPixmap({});
        picture_->setText("No pictures of this study are computed yet: Study > Compute what changed (Ctrl+R)");
        return;
    }
    const std::string key = list_->currentItem()->data(Qt::UserRole).toString().toStdString();
    if (const auto* png = session_->results.picture(key)) {
        whole_.loadFromData(reinterpret_cast<const uchar*>(png->data()), static_cast<uint>(png->size()), "PNG");
    }
    caption_->setText(caption_of(session_->results, key));
    fit();
}

void PicturesPanel::fit() {
    if (!whole_.isNull()) {
        const QSize room = area_->viewport()->size();
        picture_->setPixmap(
            whole_.scaled(room.boundedTo(whole_.size()), Qt::KeepAspectRatio, Qt::SmoothTransformation));
    }
}

/// The room for the picture changes after the panel itself has been resized, and first when its tab is shown.
bool PicturesPanel::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::Resize) {
        fit();
    }
    return Panel::eventFilter(watched, event);
}

bool PicturesPanel::has_picture() const { return !whole_.isNull(); }

void PicturesPanel::export_picture(const std::filesystem::path& path) {
    if (path.extension() != ".png") {
        throw core::UsageError("format", "a stored picture is written as .png only");
    }
    const auto* png = session_->results.picture(list_->currentItem()->data(Qt::UserRole).toString().toStdString());
    core::write_file(path, png != nullptr ? *png : std::string());
}

void PicturesPanel::demonstrate() { list_->setCurrentRow(std::min(list_->count() - 1, 3)); }

}  // namespace underbody::studio
