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

QString picture_title(const cases::StudyResults& results, const std::string& key) {
    const QStringList parts = qt(key).split('/');
    const auto* text = results.document(key);
    const auto document = text != nullptr ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    const QString title = document.is_object() ? qt(document.value("title", "")) : QString();
    if (title.isEmpty()) {
        return parts.mid(1).join(", ");
    }
    // Of whom: the case, or the table, map or measurement that it is made of.
    const QString of = parts.size() > 2 && parts.front() == "picture" ? parts[2] : parts.value(1);
    return of.isEmpty() || title.contains(of) ? title : title + ": " + of;
}

PicturesPanel::PicturesPanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
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
    list_->setAccessibleName("Pictures of the study");
    connect(list_, &QListWidget::currentRowChanged, this, [this](int chosen) {
        if (chosen >= 0) {
            desk_.act({"select", "picture/" + list_->item(chosen)->data(Qt::UserRole).toString().toStdString()});
        }
    });
}

void PicturesPanel::draw_again(bool fresh) {
    const QSignalBlocker quiet(list_);
    std::vector<std::string> keys;
    for (const auto& [key, png] : session().results.pictures) {
        keys.push_back(key);
    }
    if (fresh) {
        list_->clear();
        for (const auto& key : keys) {
            auto* item = new QListWidgetItem(picture_title(session().results, key), list_);
            item->setData(Qt::UserRole, qt(key));
            item->setToolTip(item->text());
        }
    }
    std::string wanted = state().current("picture", keys);
    const auto chosen = state().selected("case");
    if (!chosen.empty() && state().selected("picture").empty()) {  // the pictures of that case, when there are any
        for (const auto& key : keys) {
            wanted = key.find("/" + chosen.front() + "/") != std::string::npos ? key : wanted;
        }
    }
    for (int i = 0; i < list_->count(); ++i) {
        if (list_->item(i)->data(Qt::UserRole).toString().toStdString() == wanted) {
            list_->setCurrentRow(i);
        }
    }
    choose();
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
    if (const auto* png = session().results.picture(key)) {
        whole_.loadFromData(reinterpret_cast<const uchar*>(png->data()), static_cast<uint>(png->size()), "PNG");
    }
    caption_->setText(caption_of(session().results, key));
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
    const auto* png = session().results.picture(list_->currentItem()->data(Qt::UserRole).toString().toStdString());
    core::write_file(path, png != nullptr ? *png : std::string());
}

}  // namespace underbody::studio
