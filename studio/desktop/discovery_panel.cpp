#include "studio/desktop/discovery_panel.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QEvent>
#include <QImage>
#include <QLabel>
#include <QPushButton>
#include <QRegularExpression>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QStyle>
#include <QTextBrowser>
#include <QTimer>
#include <QUrl>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "studio/desktop/catalogue.h"
#include "studio/desktop/qt_text.h"
#include "studio/figures/render.h"
#include "surrogates/discovery/wording.h"

namespace underbody::studio {

namespace {

using nlohmann::json;

/// Text or number of a key, for people; "" when it is not there.
QString value(const json& object, const char* key, int digits = 3) {
    const auto at = object.is_object() ? object.find(key) : object.end();
    if (!object.is_object() || at == object.end() || at->is_null()) {
        return {};
    }
    if (at->is_string()) {
        return html(at->get<std::string>()).replace("+-", "±");
    }
    return at->is_number() ? html(core::format_number(at->get<double>(), digits)) : html(at->dump());
}

/// A sentence of the library with its names as words: "coulomb friction".
QString prose(QString text) {
    static const QRegularExpression name("\\b[a-z]+(?:_[a-z]+)+\\b");
    for (auto match = name.match(text); match.hasMatch(); match = name.match(text)) {
        text.replace(match.capturedStart(), match.capturedLength(), match.captured().replace('_', ' '));
    }
    return text;
}

/// A number in the unit that people read it in: millimetres for what is given in metres.
struct Shown {
    double factor = 1;
    std::string unit;
};
Shown shown_in(const json& object) {
    const std::string unit = object.is_object() && object.contains("unit") && object["unit"].is_string()
                                 ? object["unit"].get<std::string>()
                                 : "";
    const double value = object.is_object() && object.contains("value") && object["value"].is_number()
                             ? std::abs(object["value"].get<double>())
                             : 1;
    return unit == "m"                               ? Shown{1000, "mm"}
           : unit == "m/s"                           ? Shown{1000, "mm/s"}
           : unit == "N" && value > 0 && value < 0.1 ? Shown{1000, "mN"}  // as the sentence above says it
                                                     : Shown{1, unit};
}

/// A white picture with dark lines on a dark page: light where it was dark, of the same hues.
QImage on_dark(const QImage& picture, const QColor& ground) {
    QImage image = picture.convertToFormat(QImage::Format_RGB32);
    const double low = ground.value(), share = (255 - low) / 255;
    for (int y = 0; y < image.height(); ++y) {
        auto* row = reinterpret_cast<QRgb*>(image.scanLine(y));
        for (int x = 0; x < image.width(); ++x) {
            const int r = qRed(row[x]), g = qGreen(row[x]), b = qBlue(row[x]);
            const int turned = 255 - std::max({r, g, b}) - std::min({r, g, b});
            const auto shade = [&](int value) { return static_cast<int>(low + share * (value + turned)); };
            row[x] = qRgb(shade(r), shade(g), shade(b));
        }
    }
    return image;
}

QString scaled(const json& object, const char* key, double factor, int digits) {
    const auto at = object.find(key);
    return at != object.end() && at->is_number() ? html(core::format_number(factor * at->get<double>(), digits))
                                                 : QString();
}

QString probability(const json& effect) {
    const double chance = effect.value("probability", std::nan(""));
    return std::isnan(chance) ? QString() : html(discovery::probability_text(chance));
}

QString parameters(const json& effect) {
    QString text;
    const json all = effect.value("parameters", json::object());
    for (const auto& [name, one] : all.items()) {
        const Shown shown = shown_in(one);
        text += (text.isEmpty() ? "" : "<br>") + html(name) + " = " + scaled(one, "value", shown.factor, 4);
        const QString sigma = scaled(one, "sigma", shown.factor, 2);
        text += (sigma.isEmpty() || sigma == "0" ? "" : " ± " + sigma) + " " + html(pretty_unit(shown.unit));
    }
    return text;
}

QString effect_rows(const json& effects, const char* last_key, const QString& last_title) {
    if (!effects.is_array() || effects.empty()) {
        return {};
    }
    QString text =
        "<table cellpadding=5 cellspacing=0 border=1 style='border-collapse: collapse' width='99%'>"
        "<tr><th align=left>effect</th><th align=left>parameters</th><th align=right>probability</th><th align=left>" +
        last_title + "</th></tr>";
    for (const auto& effect : effects) {
        text += "<tr><td><b>" + value(effect, "name").replace('_', ' ') + "</b></td><td>" + parameters(effect) +
                "</td><td align=right>" + probability(effect) + "</td><td>" + prose(value(effect, last_key)) +
                "</td></tr>";
    }
    return text + "</table>";
}

/// "" where there is none; infinite: in free run.
double horizon(const json& error) {
    return error.value("free_run", false) ? std::numeric_limits<double>::infinity() : error.value("horizon_s", 0.0);
}

/// `held_out`: which data all errors are of.
QString error_line(const json& error, const QString& held_out) {
    if (!error.is_object() || !error.contains("before")) {
        return {};
    }
    const Shown shown = shown_in(error);
    const auto interval = [&](const char* which) {
        const json& one = error.at(which);
        return scaled(one, "rmse", shown.factor, 3) + " (" + scaled(one, "low", shown.factor, 3) + " … " +
               scaled(one, "high", shown.factor, 3) + ")";
    };
    const bool other = error.contains("after") && error["after"] != error["before"];  // nothing was found: one number
    QString text = "<p>Error of " + prose(value(error, "channel")) + qt(discovery::horizon_text(horizon(error))) +
                   qt(discovery::error_is_on(held_out.toStdString())) +
                   (held_out.isEmpty() ? "" : " (" + held_out + ")") + ": <b>" + interval("before") + "</b>" +
                   (other ? " → <b>" + interval("after") + "</b> " : QString(" ")) + html(pretty_unit(shown.unit));
    if (error.contains("in_noise")) {
        text += "; in standard deviations of the noise " + value(error["in_noise"], "before", 3) +
                (other ? " → " + value(error["in_noise"], "after", 3) : QString());
    }
    return text + "</p>";
}

json list_in(const json& document, const char* key) {
    const bool there = document.is_object() && document.contains(key) && document[key].is_array();
    return there ? document[key] : json::array();
}

/// The chief error, and those of longer predictions and of other channels.
QString error_lines(const json& document) {
    const json chief = document.value("error", json::object());
    const QString held_out = value(chief, "held_out");
    const json all = list_in(document, "errors");
    QString text = all.empty() ? error_line(chief, held_out) : QString();
    for (const auto& one : all) {
        text += error_line(one, held_out);
    }
    for (const auto& one : list_in(document, "axes")) {
        const auto number = [&](const char* of, const char* key) {
            return one.value(of, json::object()).value(key, 0.0);
        };
        text +=
            "<p>" +
            prose(html(discovery::axis_text({one.value("quantity", ""), one.value("unit", ""), number("before", "mean"),
                                             number("before", "rms"), number("after", "mean"), number("after", "rms"),
                                             one.value("sigma", 0.0)}))) +
            "</p>";
    }
    return text;
}

/// What the command says of the data and of the verdict: warnings, or what only tells.
QString remarks(const json& document, bool notes) {
    QString rows;
    for (const auto& one : list_in(document, "problems")) {
        if ((one.value("severity", "warning") == "note") == notes) {
            rows += "<li>" + prose(value(one, "message")) + "</li>";
        }
    }
    return rows.isEmpty() ? QString()
                          : (notes ? "<h3>Remarks on the data</h3>" : "<p><b>What it is worth</b></p>") +
                                ("<ul>" + rows + "</ul>");
}

QString limits(const json& document) {
    std::vector<discovery::DetectionLimit> all;
    for (const auto& one : list_in(document, "detection_limits")) {
        const auto at = one.find("value");
        all.push_back({one.value("name", ""), one.value("parameter", ""),
                       at != one.end() && at->is_number() ? at->get<double>() : std::nan(""), one.value("unit", "")});
    }
    const auto text = discovery::limits_text(all);
    QString rows;
    for (const auto& one : text.lines) {
        rows += "<li>" + prose(html(one)).replace("+-", "±") + "</li>";
    }
    return rows.isEmpty() ? QString() : "<p>" + html(text.heading) + "</p><ul>" + rows + "</ul>";
}

QString page_of(const json& document) {
    if (!document.is_object()) {
        return "<p>The stored result cannot be read; compute it again (Ctrl+R).</p>";
    }
    const std::string verdict = document.value("verdict", "");
    const QString headline = value(document, "headline");
    QString page = headline.isEmpty() ? QString() : "<h2>" + prose(headline) + "</h2>";
    page += "<p>" + prose(value(document, "sentence")) + "</p>";
    page += remarks(document, false);
    page += error_lines(document);
    page += effect_rows(document.value("effects", json()), "evidence", "evidence");
    const QString rivals = effect_rows(document.value("alternatives", json()), "told_apart_by", "told apart by");
    page += rivals.isEmpty() ? "" : "<h3>What else it might be</h3>" + rivals;
    page += verdict == "none" ? limits(document) : QString();
    const json depends = document.value("depends_on", json::array());
    if (depends.is_array() && !depends.empty()) {
        QString names;
        for (const auto& name : depends) {
            names += (names.isEmpty() ? "" : ", ") + html(name.is_string() ? name.get<std::string>() : name.dump());
        }
        page += "<p>The residual depends on " + prose(names) + " (found without any named effect).</p>";
    }
    const QString next = value(document, "next_experiment");
    page += next.isEmpty() ? "" : "<h3>Next experiment</h3><p>" + prose(next) + "</p>";
    page += remarks(document, true);
    return page;
}

}  // namespace

QString discovery_page(const std::string& text) { return page_of(json::parse(text, nullptr, false)); }

DiscoveryPanel::DiscoveryPanel(Desk& desk, QWidget* parent) : Panel(desk, parent) {
    setObjectName("loop");
    auto* column = new QVBoxLayout(this);
    auto* row = new QHBoxLayout;
    column->addLayout(row);
    row->addWidget(new QLabel("Measurement"));
    choice_ = new QComboBox;
    choice_->setMinimumWidth(260);
    row->addWidget(choice_);
    accept_ = new QPushButton("&Accept");
    accept_->setToolTip(
        "The model that was found counts as the declared one, in Stability too; undone as anything else");
    row->addWidget(accept_);
    write_ = new QPushButton("&Write into the study …");
    write_->setToolTip("Copies the found model into the study and names it in study.toml; the old one stays");
    row->addWidget(write_);
    connect(accept_, &QPushButton::clicked, this, [this] {
        const std::string name = choice_->currentText().toStdString();
        desk_.act({state().accepted.contains(name) ? "unaccept" : "accept", name});
    });
    connect(write_, &QPushButton::clicked, this, [this] { Q_EMIT write_wanted(choice_->currentText()); });
    row->addStretch(1);
    auto* effects = new QPushButton("&Effects …");
    effects->setToolTip("Every effect that a model may lack");
    row->addWidget(effects);
    connect(effects, &QPushButton::clicked, this, [this] { show_catalogue(); });
    page_ = new QTextBrowser;
    page_->installEventFilter(this);
    column->addWidget(page_, 1);
    choice_->setAccessibleName("Measurement");
    connect(choice_, QOverload<int>::of(&QComboBox::activated), this, [this] {
        desk_.act({"select", "measurement/" + choice_->currentText().toStdString()});
    });
    page_->setHtml("<p style='color: gray'>Open a study with measurements</p>");
}

void DiscoveryPanel::draw_again(bool) {
    const QSignalBlocker quiet(choice_);
    std::vector<std::string> names;
    choice_->clear();
    for (const auto& measurement : session().study.measurements) {
        names.push_back(measurement.name);
        choice_->addItem(QString::fromStdString(measurement.name));
    }
    choice_->setCurrentText(QString::fromStdString(state().current("measurement", names)));
    show_measurement();
}

void DiscoveryPanel::show_measurement() {
    const std::string name = choice_->currentText().toStdString();
    accept_->setEnabled(false);
    write_->setEnabled(false);
    if (name.empty()) {
        page_->setHtml(desk_.has_study() ? "<p style='color: gray'>This study has no measurements</p>"
                                         : "<p style='color: gray'>Open a study with measurements</p>");
        return;
    }
    QString page = "<h1>" + html(name) + "</h1>";
    const auto* found = session().results.document("discovery/" + name);
    const auto* residual = session().results.document("residual/" + name);
    const bool accepted = state().accepted.contains(name);
    const bool verdict = shows("verdict");
    if (found != nullptr) {
        const json document = json::parse(*found, nullptr, false);
        const bool missing = document.is_object() && document.value("verdict", "none") != "none";
        accept_->setEnabled(missing || accepted);
        write_->setEnabled(missing);
        page += accepted ? "<p><b>Accepted: the found model counts as the declared one.</b></p>" : "";
        page += verdict ? page_of(document) : QString();
    } else if (residual != nullptr && verdict) {
        for (const auto& sentence : list_in(json::parse(*residual, nullptr, false), "sentences")) {
            page += sentence.is_string() ? "<p>" + prose(html(sentence.get<std::string>())) + "</p>" : QString();
        }
    } else if (residual == nullptr) {
        page += "<p>Not computed yet: Study &gt; Compute what changed (Ctrl+R).</p>";
    }
    drawn_for_ = page_->width();
    page += pictures_of(name);
    accept_->setText(accepted ? "&Take back" : "&Accept");
    const int rolled = name == shown_ ? page_->verticalScrollBar()->value() : 0;
    shown_ = name;
    page_->setHtml(page);
    page_->verticalScrollBar()->setValue(rolled);
}

/// Those that are fitted to the page as it is now; of another one they are made in a job, which shows the page again.
QString DiscoveryPanel::pictures_of(const std::string& name) {
    // As if it were rolled: the bar comes with the pictures.
    const int bar = style()->pixelMetric(QStyle::PM_ScrollBarExtent);
    const int width = std::min(std::max(300, drawn_for_ - bar - 24), 900);
    const QColor ground = palette().base().color();
    const Fitted wanted{desk_.session_pointer(), name, qRound(width * devicePixelRatioF()), ground};
    if (!shows("pictures")) {
        return {};
    }
    if (!(wanted == fitted_)) {
        jobs_.start(
            "loop pictures", "pictures of " + qt(name),
            [this, wanted](core::Progress& progress) {
                std::vector<std::pair<QString, QImage>> images;
                for (const auto& [key, png] : wanted.session->results.pictures) {
                    if (key.find(wanted.name) == std::string::npos ||
                        (key.find("residual") == std::string::npos && key.find("discovery") == std::string::npos)) {
                        continue;
                    }
                    progress.check();
                    const auto* bytes = reinterpret_cast<const uchar*>(png.data());
                    QImage image = QImage::fromData(bytes, static_cast<int>(png.size()));
                    if (wanted.ground.lightness() < 128) {
                        image = on_dark(image, wanted.ground);
                    }
                    images.emplace_back("picture://" + QString::fromStdString(key).toHtmlEscaped(),
                                        image.scaledToWidth(wanted.pixels, Qt::SmoothTransformation));
                }
                return [this, wanted, images = std::move(images)] {
                    fitted_ = wanted;
                    images_ = images;
                    show_measurement();
                };
            },
            true);
        return {};
    }
    QString page;
    for (const auto& [url, image] : images_) {
        page_->document()->addResource(QTextDocument::ImageResource, QUrl(url), image);
        page += QString("<p><img src='%1' width='%2'></p>").arg(url).arg(width);
    }
    return page;
}

/// Its pictures are as wide as the page: another width, other pictures.
bool DiscoveryPanel::eventFilter(QObject* watched, QEvent* event) {
    if (watched == page_ && event->type() == QEvent::Resize && page_->width() != drawn_for_) {
        QTimer::singleShot(0, this, [this] {
            if (isVisible() && page_->width() != drawn_for_) {
                show_measurement();
            }
        });
    }
    return Panel::eventFilter(watched, event);
}

bool DiscoveryPanel::has_picture() const { return choice_->count() > 0; }

void DiscoveryPanel::export_picture(const std::filesystem::path& path) {
    if (path.extension() != ".png") {
        throw core::UsageError("format", "this panel is written as .png only");
    }
    if (!page_->grab().save(QString::fromStdString(path.string()), "PNG")) {
        throw core::SystemError("write", "the picture could not be written", {path.string(), {}, {}, {}});
    }
}

void DiscoveryPanel::show_catalogue() { show_effect_catalogue(this); }

}  // namespace underbody::studio
