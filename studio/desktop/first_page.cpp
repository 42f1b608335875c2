#include "studio/desktop/first_page.h"

#include <QBoxLayout>
#include <QCoreApplication>
#include <QCryptographicHash>
#include <QDir>
#include <QFileInfo>
#include <QLabel>
#include <QToolButton>

#include "studio/desktop/icon.h"

namespace underbody::studio {

QString shipped_study() {
    const QString here = QCoreApplication::applicationDirPath();
    // Installed beside the program, or in the source tree that it was built in.
    for (const char* place :
         {"/../share/underbody/cases/evie", "/../share/doc/underbody/cases/evie", "/../../../cases/evie"}) {
        if (QFileInfo::exists(here + place + "/study.toml")) {
            return QDir(here + place).canonicalPath();
        }
    }
    return {};
}

FirstPage::FirstPage(QWidget* parent) : QWidget(parent) {
    setObjectName("first_page");
    auto* column = new QVBoxLayout(this);
    column->addStretch(1);
    auto* title = new QLabel("<h2>Underbody Studio</h2>");
    title->setAlignment(Qt::AlignCenter);
    column->addWidget(title);
    grid_ = new QGridLayout;
    auto* middle = new QHBoxLayout;
    middle->addStretch(1);
    middle->addLayout(grid_);
    middle->addStretch(1);
    column->addLayout(middle);
    auto* drop = new QLabel(
        "Drop a study, CFD files or a SHAPE.toml here, or open a study with Ctrl+O, files with Ctrl+Shift+O");
    drop->setAlignment(Qt::AlignCenter);
    drop->setMargin(26);
    drop->setFrameShape(QFrame::StyledPanel);
    auto* row = new QHBoxLayout;
    row->addStretch(1);
    row->addWidget(drop, 2);
    row->addStretch(1);
    column->addSpacing(20);
    column->addLayout(row);
    column->addStretch(2);
}

QString FirstPage::picture_of(const QString& pictures, const QString& study) {
    return pictures + "/" + QCryptographicHash::hash(study.toUtf8(), QCryptographicHash::Md5).toHex() + ".png";
}

void FirstPage::show_recent(const QStringList& folders, const QString& pictures) {
    while (auto* item = grid_->takeAt(0)) {
        delete item->widget();
        delete item;
    }
    QStringList all = folders.mid(0, 7);
    const QString shipped = shipped_study();
    if (!shipped.isEmpty() && !all.contains(shipped)) {
        all.append(shipped);
    }
    for (int i = 0; i < all.size(); ++i) {
        auto* button = new QToolButton;
        const QPixmap picture(picture_of(pictures, all[i]));
        button->setIcon(picture.isNull() ? program_icon() : QIcon(picture));
        button->setIconSize(picture.isNull() ? QSize(72, 72) : QSize(200, 125));
        button->setText(all[i] == shipped ? "The shipped study: EVIE" : QDir(all[i]).dirName());
        button->setToolTip(all[i]);
        button->setAccessibleName("Open " + all[i]);
        button->setToolButtonStyle(Qt::ToolButtonTextUnderIcon);
        button->setMinimumSize(220, 160);
        button->setEnabled(QFileInfo::exists(all[i] + "/study.toml"));
        connect(button, &QToolButton::clicked, this, [this, folder = all[i]] { Q_EMIT chosen(folder); });
        grid_->addWidget(button, i / 4, i % 4);
    }
}

}  // namespace underbody::studio
