#include "studio/desktop/problems_panel.h"

#include <QAction>
#include <QApplication>
#include <QBoxLayout>
#include <QClipboard>
#include <QHeaderView>
#include <QLabel>
#include <QRegularExpression>
#include <QStyle>
#include <QTime>
#include <QTimer>
#include <QToolButton>
#include <algorithm>
#include <filesystem>

namespace underbody::studio {

namespace {

constexpr int whole_text = Qt::UserRole + 1;  ///< of a column that shows less of it

/// The name of a file without its folders, with what stands behind it: "lift.csv:3:2".
QString without_folders(const QString& place) { return place.section('/', -1); }

/// A file of a temporary folder means nothing to anybody by its folder.
QString without_temporary_folders(QString text) {
    const QString temporary = QString::fromStdString(std::filesystem::temp_directory_path().string());
    return text.replace(QRegularExpression(QRegularExpression::escape(temporary) + "/(?:[^\\s/'\"]+/)+"), "");
}

/// Tables of a study's model stand in a folder of their own each time that it is read.
bool same_place(const QString& a, const QString& b) {
    const QString temporary = QString::fromStdString(std::filesystem::temp_directory_path().string()) + "/";
    return a == b || (a.startsWith(temporary) && b.startsWith(temporary) && a.section('/', -1) == b.section('/', -1));
}

}  // namespace

ProblemList::ProblemList(QWidget* parent) : QTreeWidget(parent) {
    setObjectName("problems");
    setColumnCount(4);
    setHeaderLabels({"time", "what", "where", "what to do"});
    setRootIsDecorated(false);
    setAlternatingRowColors(true);
    setTextElideMode(Qt::ElideRight);
    header()->setStretchLastSection(false);
    header()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
    header()->setSectionResizeMode(1, QHeaderView::Stretch);
    header()->resizeSection(2, 170);
    header()->resizeSection(3, 210);
    setColumnHidden(3, true);
    setAccessibleName("Problems");
    setSelectionMode(QAbstractItemView::ExtendedSelection);
    auto* copy = new QAction("&Copy all", this);
    connect(copy, &QAction::triggered, this, [this] { QApplication::clipboard()->setText(text()); });
    auto* clear_all = new QAction("C&lear", this);
    connect(clear_all, &QAction::triggered, this, [this] {
        clear();
        Q_EMIT counted(count_ = 0);
    });
    without_notes_ = new QAction("&Warnings and errors only", this);
    without_notes_->setCheckable(true);
    connect(without_notes_, &QAction::toggled, this, [this] {
        for (int i = 0; i < topLevelItemCount(); ++i) {
            hide_note(*topLevelItem(i));
        }
    });
    addActions({without_notes_, copy, clear_all});
    setContextMenuPolicy(Qt::ActionsContextMenu);
}

void ProblemList::hide_note(QTreeWidgetItem& item) {
    const bool note = item.data(0, Qt::UserRole).toInt() == static_cast<int>(core::Problem::Severity::note);
    item.setHidden(note && without_notes_->isChecked());
}

void ProblemList::add(const core::Problem& problem, const QString& said_hint) {
    // Errors of a step are one text, with what to do on its own line.
    const QStringList parts = QString::fromStdString(problem.message).split("\n  hint: ");
    const QString hint = said_hint.isEmpty() ? parts.value(1) : said_hint;
    const QString place = QString::fromStdString(problem.place.text());
    const QString message = parts.front();
    for (int i = topLevelItemCount() - 1; i >= std::max(0, topLevelItemCount() - 200); --i) {
        QTreeWidgetItem* known = topLevelItem(i);
        if (known->data(0, Qt::UserRole).toInt() == static_cast<int>(problem.severity) &&
            same_place(known->data(2, whole_text).toString(), place) &&
            known->data(1, whole_text).toString() == message) {
            known->setText(0, QTime::currentTime().toString("HH:mm:ss"));
            return;
        }
    }
    append(problem.severity, message, place, hint);
}

void ProblemList::append(core::Problem::Severity severity, const QString& message, const QString& place,
                         const QString& hint) {
    using Severity = core::Problem::Severity;
    constexpr int most = 2000;
    while (topLevelItemCount() >= most) {
        delete takeTopLevelItem(0);
    }
    auto* item = new QTreeWidgetItem(this);
    const auto icon = severity == Severity::error     ? QStyle::SP_MessageBoxCritical
                      : severity == Severity::warning ? QStyle::SP_MessageBoxWarning
                                                      : QStyle::SP_MessageBoxInformation;
    item->setIcon(0, style()->standardIcon(icon));
    item->setText(0, QTime::currentTime().toString("HH:mm:ss"));
    item->setText(1, without_temporary_folders(message));
    item->setText(2, without_folders(place));
    item->setText(3, without_temporary_folders(hint));
    const QStringList whole = {message, place, hint};
    for (int column = 1; column < 4; ++column) {
        item->setData(column, whole_text, whole[column - 1]);
        item->setToolTip(column, whole[column - 1]);
    }
    item->setData(0, Qt::UserRole, static_cast<int>(severity));
    hide_note(*item);
    if (!hint.isEmpty()) {
        setColumnHidden(3, false);  // until then the sentences have its room
    }
    scrollToItem(item);
    if (severity != Severity::note) {
        Q_EMIT counted(++count_);
    }
}

void ProblemList::note(const QString& text) { append(core::Problem::Severity::note, text, {}, {}); }

QString ProblemList::text() const {
    QString result;
    for (int i = 0; i < topLevelItemCount(); ++i) {
        const QTreeWidgetItem* item = topLevelItem(i);
        result += item->text(0);
        for (int column = 1; column < 4; ++column) {
            result += "\t" + item->data(column, whole_text).toString();
        }
        result += "\n";
    }
    return result;
}

Banner::Banner(QWidget* parent) : QFrame(parent) {
    setObjectName("banner");
    setStyleSheet("QFrame#banner { border: 2px solid #d55e00; border-radius: 4px; background: palette(window); }");
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(10, 6, 6, 6);
    auto* icon = new QLabel;
    icon->setPixmap(style()->standardIcon(QStyle::SP_MessageBoxWarning).pixmap(24, 24));
    row->addWidget(icon, 0, Qt::AlignTop);
    text_ = new QLabel;
    text_->setObjectName("said");
    text_->setWordWrap(true);
    text_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    row->addWidget(text_, 1);
    auto* close = new QToolButton;
    close->setText("×");
    close->setAutoRaise(true);
    close->setToolTip("Close this message (it stays in the list of problems)");
    connect(close, &QToolButton::clicked, this, &QWidget::hide);
    row->addWidget(close, 0, Qt::AlignTop);
    taken_ = new QTimer(this);
    taken_->setSingleShot(true);
    taken_->setInterval(500);
    connect(taken_, &QTimer::timeout, this, [this] { setAttribute(Qt::WA_TransparentForMouseEvents, false); });
    parent->installEventFilter(this);
    hide();
}

bool Banner::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::Resize && isVisible()) {
        lay();
    }
    return QFrame::eventFilter(watched, event);
}

void Banner::lay() {
    constexpr int widest = 760, apart = 10;  // px
    const QRect room = parentWidget()->rect().adjusted(apart, apart, -apart, -apart);
    const int wide = std::min(room.width(), widest);
    const int high = std::min(
        room.height(), layout()->hasHeightForWidth() ? layout()->totalHeightForWidth(wide) : sizeHint().height());
    setGeometry(room.center().x() - wide / 2, room.bottom() - high, wide, high);
    raise();
}

void Banner::appear(const QString& text) {
    text_->setText(text);
    if (!isVisible()) {
        setAttribute(Qt::WA_TransparentForMouseEvents, true);
        taken_->start();
    }
    show();
    lay();
}

void Banner::show_error(const QString& what, const QString& message, const QString& hint) {
    QString text = "<b>" + what.toHtmlEscaped() + "</b><br>" + message.toHtmlEscaped();
    if (!hint.isEmpty()) {
        text += "<br><i>" + hint.toHtmlEscaped() + "</i>";
    }
    appear(text);
}

void Banner::show_note(const QString& text) { appear(text.toHtmlEscaped()); }

Told tell(const std::exception_ptr& error) {
    Told told;
    told.problem.severity = core::Problem::Severity::error;
    try {
        std::rethrow_exception(error);
    } catch (const core::Error& known) {
        told.problem.message = known.message();
        told.problem.place = known.place();
        told.hint = QString::fromStdString(known.hint());
        const std::string place = known.place().text();
        told.message = QString::fromStdString((place.empty() ? "" : place + ": ") + known.message());
    } catch (const std::exception& defect) {
        told.problem.message = std::string("defect of the program: ") + defect.what();
        told.message = QString::fromStdString(told.problem.message);
        told.hint = "please report it with the list of problems";
    } catch (...) {
        told.problem.message = "defect of the program: an unknown exception";
        told.message = QString::fromStdString(told.problem.message);
    }
    return told;
}

}  // namespace underbody::studio
