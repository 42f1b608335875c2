// What an empty window shows: the shipped study, the recent ones with their last picture, and where to drop files.
#pragma once

#include <QWidget>

class QGridLayout;

namespace underbody::studio {

class FirstPage : public QWidget {
    Q_OBJECT
public:
    explicit FirstPage(QWidget* parent);
    /// Folders of recent studies, newest first, and where their pictures lie (`picture_of`).
    void show_recent(const QStringList& folders, const QString& pictures);
    /// The file for the picture of a study in the folder of pictures.
    static QString picture_of(const QString& pictures, const QString& study);

Q_SIGNALS:
    void chosen(const QString& folder);

private:
    QGridLayout* grid_ = nullptr;
};

/// The study that comes with the program; empty when it is not installed.
QString shipped_study();

}  // namespace underbody::studio
