#include "studio/desktop/catalogue.h"

#include <QBoxLayout>
#include <QDialog>
#include <QLineEdit>
#include <QListWidget>
#include <QSplitter>
#include <QTextBrowser>

#include "core/text.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"
#include "surrogates/dynamics/model/effect.h"

namespace underbody::studio {

namespace {

QString page(const dynamics::EffectInfo& info) {
    QString text = QString("<h2>%1</h2><p><code>%2</code></p><p style='font-size: large'><b>%3</b></p>")
                       .arg(html(info.title), html(info.name), html(info.formula));
    const char* seen = info.seen_in == dynamics::SeenIn::both          ? "time series and static measurements"
                       : info.seen_in == dynamics::SeenIn::time_series ? "time series"
                                                                       : "static measurements";
    text += QString("<p>Seen in %1.</p>").arg(seen);
    if (!info.depends_on.empty()) {
        QString names;
        for (const auto& name : info.depends_on) {
            names += (names.isEmpty() ? "" : ", ") + html(name);
        }
        text += "<p>Depends on " + names + ".</p>";
    }
    if (!info.parameters.empty()) {
        text +=
            "<table cellpadding=4 cellspacing=0 border=1 style='border-collapse: collapse'>"
            "<tr><th align=left>parameter</th><th align=left>unit</th><th align=left>between</th>"
            "<th align=left>typical</th><th align=left>meaning</th></tr>";
        for (const auto& one : info.parameters) {
            text += QString("<tr><td><code>%1</code></td><td>%2</td><td>%3 … %4</td><td>%5</td><td>%6</td></tr>")
                        .arg(html(one.name), html(pretty_unit(one.unit)), html(core::format_number(one.lower, 3)),
                             html(core::format_number(one.upper, 3)), html(core::format_number(one.typical, 3)),
                             html(one.meaning));
        }
        text += "</table>";
    }
    text += QString("<p>Source: %1</p>").arg(html(info.source));
    text += QString("<p>In a model file:</p><pre>[[effect]]\nname = \"%1\"\n").arg(html(info.name));
    for (const auto& one : info.parameters) {
        if (!one.shape) {
            const QString unit = one.unit == "1" || one.unit == "parameter" ? "" : " " + html(one.unit);
            text += html(one.name) +
                    QString(" = { value = \"%1%2\" }\n").arg(html(core::format_number(one.typical, 3)), unit);
        }
    }
    return text + "</pre>";
}

}  // namespace

void show_effect_catalogue(QWidget* parent) {
    auto* dialog = new QDialog(parent);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setObjectName("catalogue");
    dialog->setWindowTitle("Effects that a model may lack");
    dialog->resize(980, 620);
    auto* column = new QVBoxLayout(dialog);
    auto* filter = new QLineEdit;
    filter->setPlaceholderText("Filter effects by name, formula or what they depend on");
    filter->setClearButtonEnabled(true);
    column->addWidget(filter);
    auto* halves = new QSplitter;
    column->addWidget(halves, 1);
    auto* list = new QListWidget;
    auto* text = new QTextBrowser;
    text->setOpenExternalLinks(true);
    halves->addWidget(list);
    halves->addWidget(text);
    halves->setStretchFactor(1, 1);
    halves->setSizes({260, 700});
    for (const auto* effect : dynamics::effects()) {
        const auto& info = effect->info();
        auto* item = new QListWidgetItem(QString::fromStdString(info.title), list);
        item->setToolTip(QString::fromStdString(info.name));
        item->setData(Qt::UserRole, page(info));
    }
    QObject::connect(list, &QListWidget::currentItemChanged, text, [text](QListWidgetItem* item) {
        text->setHtml(item != nullptr ? item->data(Qt::UserRole).toString() : "");
    });
    QObject::connect(filter, &QLineEdit::textChanged, list, [list](const QString& wanted) {
        for (int i = 0; i < list->count(); ++i) {
            QListWidgetItem* item = list->item(i);
            item->setHidden(!item->text().contains(wanted, Qt::CaseInsensitive) &&
                            !item->data(Qt::UserRole).toString().contains(wanted, Qt::CaseInsensitive));
        }
    });
    list->setCurrentRow(0);
    dialog->show();
}

}  // namespace underbody::studio
