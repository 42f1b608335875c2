// Explore: the stored pictures of the cases that are kept, one view of all, to be looked at beside each other.
#pragma once

#include <QIcon>
#include <QWidget>
#include <map>
#include <string>
#include <vector>

#include "studio/desktop/compare_sheet.h"
#include "studio/desktop/desk.h"

class QComboBox;
class QLabel;
class QListWidget;

namespace underbody::studio {

class CasePictures : public QWidget {
    Q_OBJECT
public:
    CasePictures(Desk& desk, QWidget* parent);
    /// One entry a case of which the study has the chosen picture (ExploreView::picture); what has none is counted.
    void show_cases(const std::vector<std::string>& names);
    [[nodiscard]] QListWidget* list() const { return list_; }
    [[nodiscard]] QComboBox* views() const { return views_; }
    [[nodiscard]] QString said() const;
    /// The pictures of the list in their full size, each with its case.
    [[nodiscard]] Sheet sheet() const;

Q_SIGNALS:
    /// The mouse is over the picture of that case; empty: over none.
    void hovered(const QString& name);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void ask_icons(const std::vector<std::string>& keys);

    Desk& desk_;
    QComboBox* views_ = nullptr;
    QListWidget* list_ = nullptr;
    QLabel* said_ = nullptr;
    SessionPointer shown_of_;
    std::vector<std::string> shown_;      ///< keys of the pictures in the list
    std::map<std::string, QIcon> icons_;  ///< by key, of this session
};

}  // namespace underbody::studio
