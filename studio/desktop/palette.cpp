#include "studio/desktop/palette.h"

#include <QBoxLayout>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QTableWidget>
#include <algorithm>
#include <tuple>

#include "geometry/body/variants.h"
#include "studio/desktop/qt_text.h"

namespace underbody::studio {

namespace {

struct Entry {
    QString text;
    QString hint;
    std::function<void()> take;  ///< none: `line` is put into the line to be written on
    QString line = {};
    QString verb = {};     ///< of an action: told while its line is written
    bool example = false;  ///< told then only
};

QString plain(const QAction& action) { return action.text().remove('&').remove(" …"); }

std::vector<Entry> entries(Desk& desk, const QList<QAction*>& actions) {
    std::vector<Entry> all;
    for (QAction* action : actions) {
        if (!action->text().isEmpty() && action->isEnabled() && action->menu() == nullptr) {
            all.push_back({plain(*action), action->shortcut().toString(), [action] { action->trigger(); }});
        }
    }
    const auto things = [&](const char* kind, const auto& list) {
        for (const auto& one : list) {
            const std::string id = std::string(kind) + "/" + one.name;
            all.push_back({qt(one.name), kind, [&desk, id] { desk.act({"select", id}); }});
        }
    };
    const auto& study = desk.session().study;
    for (const auto& name : shape_names(desk.state(), desk.session())) {
        all.push_back({qt(name), "shape", [&desk, name] { desk.act({"shape", name}); }});
    }
    things("case", study.cases);
    things("table", study.tables);
    things("region", study.regions);
    things("measurement", study.measurements);
    for (const auto& parameter : geometry::parameter_names()) {
        if (!parameter.unit.empty() && !shown_shape(desk.state(), desk.session()).empty()) {
            all.push_back({qt(parameter.name), "number of the shape", [&desk, name = parameter.name] {
                               desk.act({"workspace", "design"});
                               Q_EMIT desk.sought(qt(name));
                           }});
        }
    }
    for (const auto& kind : action_kinds()) {
        const QString verb = qt(kind.verb);
        all.push_back({qt(kind.verb + " " + kind.arguments).trimmed(), qt(kind.meaning), {}, verb + " ", verb});
        if (qt(kind.example) != verb) {
            all.push_back({qt(kind.example), "an example, to be changed", {}, qt(kind.example), verb, true});
        }
    }
    return all;
}

class Palette : public QDialog {
public:
    Palette(QWidget* parent, Desk& desk, const QList<QAction*>& actions)
        : QDialog(parent), desk_(desk), entries_(entries(desk, actions)) {
        setObjectName("palette");
        setWindowTitle("Find a command, a case, a parameter");
        setAttribute(Qt::WA_DeleteOnClose);
        resize(620, 420);
        auto* column = new QVBoxLayout(this);
        line_ = new QLineEdit;
        line_->setPlaceholderText("Type to find; or a whole line: set 'protrusion.height=2 mm'");
        line_->setAccessibleName("Command");
        line_->installEventFilter(this);
        list_ = new QListWidget;
        list_->setAccessibleName("Found");
        column->addWidget(line_);
        column->addWidget(list_, 1);
        connect(line_, &QLineEdit::textChanged, this, &Palette::fill);
        connect(line_, &QLineEdit::returnPressed, this, &Palette::take);
        connect(list_, &QListWidget::itemActivated, this, &Palette::take);
        fill();
    }

protected:
    bool eventFilter(QObject* watched, QEvent* event) override {
        if (event->type() == QEvent::KeyPress) {
            auto* key = static_cast<QKeyEvent*>(event);
            const int by = key->key() == Qt::Key_Down ? 1 : key->key() == Qt::Key_Up ? -1 : 0;
            if (by != 0) {
                list_->setCurrentRow(std::clamp(list_->currentRow() + by, 0, list_->count() - 1));
                return true;
            }
        }
        return QDialog::eventFilter(watched, event);
    }

private:
    /// What fits; while the line of an action is written, first what it takes and an example.
    void fill() {
        list_->clear();
        const QString verb = line_->text().contains(' ') ? line_->text().section(' ', 0, 0) : QString();
        const QStringList parts = line_->text().split(' ', Qt::SkipEmptyParts);
        const auto of_line = [&](const Entry& entry) { return !verb.isEmpty() && entry.verb == verb; };
        const auto fits = [&](const Entry& entry) {
            const QString whole = entry.text + " " + entry.hint;
            return !entry.example && std::all_of(parts.begin(), parts.end(), [&](const QString& part) {
                return whole.contains(part, Qt::CaseInsensitive);
            });
        };
        for (const bool first : {true, false}) {
            for (std::size_t i = 0; i < entries_.size() && list_->count() < 200; ++i) {
                if (first ? of_line(entries_[i]) : !of_line(entries_[i]) && fits(entries_[i])) {
                    add(i);
                }
            }
        }
        list_->setCurrentRow(0);
    }

    void add(std::size_t entry) {
        const auto& [text, hint] = std::tie(entries_[entry].text, entries_[entry].hint);
        auto* item = new QListWidgetItem(text + (hint.isEmpty() ? "" : "   –   " + hint), list_);
        item->setData(Qt::UserRole, static_cast<int>(entry));
    }

    void take() {
        const QString text = line_->text(), typed = text.trimmed();
        const QString verb = typed.section(' ', 0, 0);
        const auto& kinds = action_kinds();
        const auto kind =
            std::find_if(kinds.begin(), kinds.end(), [&](const auto& one) { return qt(one.verb) == verb; });
        const auto* item = list_->currentItem();
        const Entry none;
        const Entry entry = item != nullptr ? entries_[item->data(Qt::UserRole).toUInt()] : none;
        const bool chosen = list_->currentRow() > 0;  // another one than the line finds first
        // A verb that takes more is written on; another Enter carries it out as it is.
        const bool whole = typed.contains(' ') || text.endsWith(' ') ||
                           (kind != kinds.end() && kind->arguments.empty() && !entry.take);
        if (kind != kinds.end() && whole && !chosen) {
            try {
                if (!desk_.act(words_of(typed.toStdString()))) {
                    return;
                }
            } catch (...) {
                Q_EMIT desk_.refused(verb, std::current_exception());
                return;
            }
            close();
        } else if (entry.take) {
            close();
            entry.take();
        } else if (!entry.line.isEmpty()) {
            line_->setText(entry.line);
            line_->setFocus();
        }
    }

    Desk& desk_;
    std::vector<Entry> entries_;
    QLineEdit* line_ = nullptr;
    QListWidget* list_ = nullptr;
};

}  // namespace

void show_palette(QWidget* parent, Desk& desk, const QList<QAction*>& actions) {
    auto* palette = new Palette(parent, desk, actions);
    palette->show();
}

void show_keys(QWidget* parent, const QList<QAction*>& actions) {
    auto* dialog = new QDialog(parent);
    dialog->setObjectName("keys");
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle("Keys");
    dialog->resize(460, 560);
    auto* column = new QVBoxLayout(dialog);
    auto* table = new QTableWidget(0, 2);
    table->setAccessibleName("Keys and what they do");
    table->setHorizontalHeaderLabels({"key", "does"});
    table->verticalHeader()->hide();
    table->horizontalHeader()->setStretchLastSection(true);
    table->setEditTriggers(QAbstractItemView::NoEditTriggers);
    const auto add = [&](const QString& key, const QString& text) {
        const int row = table->rowCount();
        table->insertRow(row);
        table->setItem(row, 0, new QTableWidgetItem(key));
        table->setItem(row, 1, new QTableWidgetItem(text));
    };
    for (const QAction* action : actions) {
        if (!action->shortcut().isEmpty()) {
            add(action->shortcut().toString(), plain(*action));
        }
    }
    add("Arrows, Enter, + and −, Home", "in a plot: move a mark that reads the coordinates, click, zoom, show all");
    add("Arrows, Delete", "in the lines of Explore: choose an axis, move the ends of its range, take it away");
    add("Ctrl+Left, Ctrl+Right", "in the lines of Explore: move the axis");
    add("Wheel, drag, double click", "in a plot: zoom, move, show all");
    add("Left, middle, right button", "in 3D: turn, move, zoom; a click reads the value");
    table->resizeColumnToContents(0);
    column->addWidget(table);
    dialog->show();
}

}  // namespace underbody::studio
