#include "studio/desktop/case_pictures.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QEvent>
#include <QLabel>
#include <QListWidget>
#include <QSignalBlocker>

#include "core/counted.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

namespace {

constexpr std::size_t most_pictures = 60;  ///< more than somebody looks at side by side
const QSize icon_size(190, 143);

}  // namespace

CasePictures::CasePictures(Desk& desk, QWidget* parent)
    : QWidget(parent), desk_(desk), views_(new QComboBox), list_(new QListWidget), said_(new QLabel) {
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    auto* head = new QHBoxLayout;
    head->addWidget(views_);
    said_->setWordWrap(true);
    head->addWidget(said_, 1);
    column->addLayout(head);
    column->addWidget(list_, 1);
    views_->setAccessibleName("Picture of each case");
    list_->setAccessibleName("Pictures of the cases that are kept");
    list_->setViewMode(QListView::IconMode);
    list_->setIconSize(icon_size);
    list_->setResizeMode(QListView::Adjust);
    list_->setMovement(QListView::Static);
    list_->setUniformItemSizes(true);
    list_->setSelectionMode(QAbstractItemView::ExtendedSelection);
    connect(views_, QOverload<int>::of(&QComboBox::activated), this, [this] {
        desk_.act({"show", "pictures", views_->currentData().toString().toStdString()});
    });
    list_->setMouseTracking(true);
    list_->viewport()->installEventFilter(this);
    connect(list_, &QListWidget::itemEntered, this,
            [this](const QListWidgetItem* item) { Q_EMIT hovered(item->text()); });
    connect(list_, &QListWidget::viewportEntered, this, [this] { Q_EMIT hovered({}); });
    connect(list_, &QListWidget::itemSelectionChanged, this, [this] {
        Words words = {"select"};
        for (const auto* item : list_->selectedItems()) {
            words.push_back("case/" + item->text().toStdString());
        }
        if (words.size() > 1) {
            desk_.act(words);
        }
    });
}

bool CasePictures::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::Leave) {
        Q_EMIT hovered({});
    }
    return QWidget::eventFilter(watched, event);
}

QString CasePictures::said() const { return said_->text(); }

Sheet CasePictures::sheet() const {
    Sheet sheet;
    sheet.title = views_->currentText();
    sheet.about = qt(desk_.session().study.title);
    for (int i = 0; i < list_->count() && shown_of_ != nullptr; ++i) {
        const std::string& png = *shown_of_->results.picture(shown_[static_cast<std::size_t>(i)]);
        sheet.cells.emplace_back(list_->item(i)->text(), QImage::fromData(reinterpret_cast<const uchar*>(png.data()),
                                                                          static_cast<int>(png.size()), "PNG"));
    }
    return sheet;
}

void CasePictures::show_cases(const std::vector<std::string>& names) {
    const Session& session = desk_.session();
    const auto views = case_views(session);
    const std::string wanted = desk_.state().explore.picture;
    const QSignalBlocker quiet(views_);
    views_->clear();
    for (const auto& view : views) {
        views_->addItem(qt(view), qt(view));
    }
    views_->setCurrentIndex(std::max(0, views_->findData(qt(wanted))));
    views_->setEnabled(!views.empty());
    std::vector<std::string> keys, shown;
    std::size_t none = 0;
    for (const auto& name : names) {
        const std::string key = case_picture(session, views_->currentData().toString().toStdString(), name);
        if (key.empty()) {
            ++none;
        } else if (keys.size() < most_pictures) {
            keys.push_back(key);
            shown.push_back(name);
        }
    }
    if (views.empty()) {
        said_->setText(session.study.pictures.empty()
                           ? "The study draws no pictures of cases: [[picture]] in study.toml says of which"
                           : "No pictures of cases are computed yet: Study > Compute what changed (Ctrl+R)");
    } else {
        const std::size_t there = names.size() - none;
        said_->setText((there > keys.size() ? "the first " + QString::number(keys.size()) + " of " : QString()) +
                       qt(core::counted(there, "picture")) +
                       (none == 0 ? QString() : "; " + qt(core::counted(none, "case")) + " without this picture"));
    }
    if (shown_of_ != desk_.session_pointer()) {
        icons_.clear();
        shown_.clear();
    }
    const QSignalBlocker still(list_);
    if (shown_of_ != desk_.session_pointer() || shown_ != keys || static_cast<int>(keys.size()) != list_->count()) {
        list_->clear();
        for (std::size_t i = 0; i < keys.size(); ++i) {
            auto* item = new QListWidgetItem(qt(shown[i]), list_);
            const auto known = icons_.find(keys[i]);
            item->setIcon(known != icons_.end() ? known->second : QIcon());
            item->setSizeHint(icon_size + QSize(12, 30));
            item->setToolTip(item->text());
        }
        shown_ = keys;
        shown_of_ = desk_.session_pointer();
        ask_icons(keys);
    }
    const auto selected = desk_.state().selected("case");
    for (int i = 0; i < list_->count(); ++i) {
        const std::string name = list_->item(i)->text().toStdString();
        list_->item(i)->setSelected(std::find(selected.begin(), selected.end(), name) != selected.end());
    }
}

/// Made small beside the window: a picture takes some 10 ms to be read.
void CasePictures::ask_icons(const std::vector<std::string>& keys) {
    std::vector<std::string> missing;
    std::copy_if(keys.begin(), keys.end(), std::back_inserter(missing),
                 [this](const std::string& key) { return icons_.count(key) == 0; });
    if (missing.empty()) {
        return;
    }
    desk_.jobs().start(
        "case pictures", "pictures of cases",
        [this, missing, session = shown_of_](core::Progress& progress) {
            std::vector<std::pair<std::string, QImage>> images;
            for (const auto& key : missing) {
                progress.check();
                const std::string& png = *session->results.picture(key);
                const QImage whole =
                    QImage::fromData(reinterpret_cast<const uchar*>(png.data()), static_cast<int>(png.size()), "PNG");
                images.emplace_back(key, whole.scaled(icon_size, Qt::KeepAspectRatio, Qt::SmoothTransformation));
            }
            return [this, images, session] {
                if (shown_of_ != session) {
                    return;
                }
                for (const auto& [key, image] : images) {
                    icons_[key] = QIcon(QPixmap::fromImage(image));
                }
                const QSignalBlocker still(list_);
                for (int i = 0; i < list_->count(); ++i) {
                    list_->item(i)->setIcon(icons_[shown_[static_cast<std::size_t>(i)]]);
                }
            };
        },
        true);
}

}  // namespace underbody::studio
