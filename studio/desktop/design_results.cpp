// Design: the card of results now and before, and what is known of the lift.
#include <QBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QTableWidget>
#include <cmath>
#include <utility>

#include "cases/body_of_case.h"
#include "core/text.h"
#include "core/units.h"
#include "studio/desktop/design_panel.h"
#include "studio/desktop/parameter_row.h"
#include "studio/desktop/plot_view.h"
#include "studio/desktop/qt_text.h"
#include "surrogates/tables/analysis/equilibria.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::studio {

namespace {

QString shown(double value, double factor, int digits, const char* unit) {
    return std::isfinite(value)
               ? qt(core::format_number(factor * value, digits)).replace('-', QChar(0x2212)) + " " + unit
               : QString("–");
}

struct Result {
    QString name;
    QString (*of)(const LiveBody& body);
};

QString added(const LiveBody& body, std::size_t k, double factor, const char* unit) {
    return body.added_mass        ? shown(body.added_mass->matrix[k][k], factor, 4, unit)
           : body.contact.empty() ? QString("…")
                                  : QString("touches");
}

const std::vector<Result>& results() {
    static const std::vector<Result> all = {
        {"volume", [](const LiveBody& b) { return shown(b.mass.volume, 1e6, 6, "cm³"); }},
        {"buoyancy", [](const LiveBody& b) { return shown(b.mass.buoyancy(), 1, 5, "N"); }},
        {"area", [](const LiveBody& b) { return shown(b.mass.area, 1e4, 5, "cm²"); }},
        {"base area", [](const LiveBody& b) { return shown(b.base_area, 1e4, 5, "cm²"); }},
        {"centroid height", [](const LiveBody& b) { return shown(b.mass.centroid.z, 1e3, 5, "mm"); }},
        {"clearance", [](const LiveBody& b) { return shown(b.clearance.smallest, 1e3, 4, "mm"); }},
        {"certificate",
         [](const LiveBody& b) {
             return !b.certificate ? QString("…") : b.certificate->passed() ? QString("passed") : QString("FAILED");
         }},
        {"added mass surge", [](const LiveBody& b) { return added(b, 0, 1, "kg"); }},
        {"added mass heave", [](const LiveBody& b) { return added(b, 2, 1, "kg"); }},
        {"added inertia pitch", [](const LiveBody& b) { return added(b, 4, 1e3, "g m²"); }},
    };
    return all;
}

}  // namespace

/// What is known of the lift at the gap, and where it carries the net weight; of another shape it is said so.
std::vector<std::array<QString, 2>> DesignPanel::lift_rows() const {
    const QString none = "–";
    QString lift = none, stable = none, kick = none;
    const double gap = state().design.gap;
    if (table_ && table_->axes().size() == 1) {
        const auto& axis = table_->axes().front();
        if (gap >= axis.lower && gap <= axis.upper) {
            const auto at = table_->at({&gap, 1});
            lift = studio::shown(at.value, 1, 3, "") +
                   (at.sigma > 0 ? "± " + studio::shown(at.sigma, 1, 2, "N") : QString("N"));
        }
        if (const auto weight = net_weight()) {
            tables::EquilibriumOptions options;
            options.net_weight = *weight;
            options.virtual_mass = lift_.table->virtual_mass;
            const tables::Equilibrium* nearest = nullptr;
            const auto found = tables::equilibria(*table_, options);
            QStringList gaps;
            for (const auto& one : found.all) {
                if (one.stability == tables::Stability::stable) {
                    gaps << qt(core::format_number(1e3 * one.gap, 3));
                    nearest =
                        nearest == nullptr || std::abs(one.gap - gap) < std::abs(nearest->gap - gap) ? &one : nearest;
                }
            }
            stable = gaps.isEmpty() ? QString("none") : gaps.join(", ") + " mm";
            kick = nearest != nullptr && options.virtual_mass > 0
                       ? studio::shown(nearest->kick_velocity, 1e3, 3, "mm/s")
                       : none;
        }
    }
    const QString of = lift_.basis == cases::KnownLift::Basis::this_shape || !table_ ? "" : " (nearest)";
    return {{"lift" + of, lift}, {"stable gaps" + of, stable}, {"largest kick" + of, kick}};
}

void DesignPanel::show_card() {
    const auto lift = lift_rows();
    card_->setRowCount(static_cast<int>(results().size() + lift.size()));
    auto* model = card_->model();
    const bool silent = model->blockSignals(true);  // each cell that changes would measure all columns
    for (int row = 0; row < card_->rowCount(); ++row) {
        const auto at = static_cast<std::size_t>(row);
        const Result* body = at < lift.size() ? nullptr : &results()[at - lift.size()];  // lift is seen first
        const QString name = body == nullptr ? lift[at][0] : body->name;
        const QString now = body == nullptr ? lift[at][1] : shown_ ? body->of(*shown_) : QString();
        const QString was = body != nullptr && before_ ? body->of(*before_) : QString();
        const QStringList cells = {name, now, was};
        for (int column = 0; column < 3; ++column) {
            auto* item = card_->item(row, column);
            if (item == nullptr) {
                item = new QTableWidgetItem;
                item->setTextAlignment(column == 0 ? Qt::AlignLeft | Qt::AlignVCenter
                                                   : Qt::AlignRight | Qt::AlignVCenter);
                card_->setItem(row, column, item);
            }
            item->setText(cells[column]);
            item->setToolTip(cells[column]);
            QFont font = card_->font();
            font.setBold(column == 1 && !was.isEmpty() && now != was);
            item->setFont(font);
        }
    }
    model->blockSignals(silent);
    Q_EMIT model->dataChanged(model->index(0, 0), model->index(card_->rowCount() - 1, 2));
    const auto* rows = card_->verticalHeader();
    card_->setMaximumHeight(card_->horizontalHeader()->sizeHint().height() + rows->length() + 2 * card_->frameWidth());
    card_->updateGeometry();
    if (!shown_) {
        return;
    }
    QString text = QString("%1 triangles").arg(shown_->mesh.triangles.size());
    if (!shown_->certificate) {
        text += ", while moving";
    } else if (!shown_->certificate->passed() && !shown_->certificate->faults.empty()) {
        text += ": " + qt(shown_->certificate->faults.front().what);
    }
    state_label_->setText(text + (shown_->contact.empty() ? "" : "; " + qt(shown_->contact)));
}

/// The body of the pinned state, or as it stands in the file: once a whole one is known.
void DesignPanel::make_before() {
    const DesignView& design = state().design;
    try {
        const bool pinned = design.before_shape == name_;
        const auto shape = shape_with(state(), session(), name_, pinned ? design.before : ShapeChanges{});
        const std::string key = key_of(shape);
        if (key == key_of(shape_)) {
            before_.reset();
            return;
        }
        if (before_ && key_of(before_->shape) == key && before_->added_mass && before_->placement.gap == design.gap &&
            before_->placement.pitch == design.pitch) {
            return;
        }
        before_ = remembered(key);
        if (!before_ && !jobs_.busy("design before")) {
            jobs_.start(
                "design before", "the body before",
                [this, shape, at = placement(), key](core::Progress& progress) {
                    const auto body = std::make_shared<LiveBody>(resting_body(shape, at, progress));
                    add_added_mass(*body, progress);
                    return [this, body, key] {
                        take(body, key);
                        before_ = body;
                        show_card();
                        draw_section();
                        show_view(false);
                    };
                },
                true);
        }
    } catch (const core::Error&) {
        before_.reset();
    }
}

/// The surrogate over the shapes of the study's search: fitted once for what is stored.
void DesignPanel::learn() {
    if (learned_ == desk_.session_pointer()) {
        return;
    }
    learned_ = desk_.session_pointer();
    surrogate_.reset();
    no_surrogate_.clear();
    if (!session().study.design) {
        return;
    }
    jobs_.start("design surrogate", "surrogate over the shapes of the search",
                [this, session = learned_](core::Progress& progress) {
                    std::string why;
                    const auto surrogate = cases::lift_surrogate(session->study, why, progress);
                    return [this, session, surrogate, why] {
                        if (session == learned_) {
                            surrogate_ = surrogate;
                            no_surrogate_ = why;
                            show_lift();
                        }
                    };
                });
}

void DesignPanel::show_lift() {
    learn();
    if (std::exchange(named_of_, desk_.session_pointer()) != desk_.session_pointer()) {
        named_.clear();
        for (const auto& [name, shape] : session().shapes) {
            named_.push_back({name, session().shape_files.at(name), shape,
                              cases::is_of_its_cases(session().study, session().results, name)});
        }
    }
    lift_ = cases::known_lift(session().study, named_, surrogate_.get(), shape_);
    lift_label_->setText("Lift: " + qt(lift_.words()) +
                         (no_surrogate_.empty() ? QString() : ". The search of [design]: " + qt(no_surrogate_)));
    const bool surrogate = lift_.basis == cases::KnownLift::Basis::surrogate;
    speed_->setVisible(surrogate && surrogate_->spec.speeds.size() > 1);
    if (surrogate) {
        table_.reset();
        table_of_.clear();
        draw_lift();
    } else if (lift_.table == nullptr || session().results.loads.rows() == 0) {
        table_.reset();
        table_of_.clear();
        lift_plot_->show_text(lift_.table == nullptr ? "No lift of a shape like this one is known: ask for its CFD"
                                                     : "The loads are not computed yet: Ctrl+R");
    } else if (table_of_ != lift_.table->name || fitted_ != desk_.session_pointer()) {
        fit_lift();
    } else if (table_) {
        draw_lift();
    }
    show_card();
    show_map();
}

void DesignPanel::fit_lift() {
    table_of_ = lift_.table->name;
    fitted_ = desk_.session_pointer();
    table_.reset();
    jobs_.start(
        "design lift", "fitting " + qt(table_of_),
        [this, spec = *lift_.table, session = fitted_](core::Progress&) {
            const auto table = std::make_shared<const tables::ForceTable>(tables::ForceTable::fit(
                cases::table_points(spec, session->results), spec.quantity, cases::fit_options(spec)));
            return [this, table, name = spec.name] {
                if (table_of_ == name) {
                    table_ = table;
                    draw_lift();
                    show_card();
                }
            };
        },
        true);
}

std::optional<double> DesignPanel::net_weight() const {
    if (lift_.table == nullptr) {
        return {};
    }
    const auto view = state().tables.find(lift_.table->name);
    return view != state().tables.end() && view->second.net_weight ? view->second.net_weight : lift_.table->net_weight;
}

void DesignPanel::draw_lift() {
    core::Figure figure;
    if (lift_.basis == cases::KnownLift::Basis::surrogate) {
        figure = cases::surrogate_lift_figure(*surrogate_, lift_, state().design.pitch, state().design.speed);
    } else if (lift_.table != nullptr && table_) {
        tables::FigureOptions options;
        options.axis = "gap";
        if (const auto weight = net_weight()) {
            tables::EquilibriumOptions equilibria;
            equilibria.net_weight = *weight;
            equilibria.virtual_mass = lift_.table->virtual_mass;
            equilibria.axis = "gap";
            options.equilibria = equilibria;
        }
        figure = tables::curve_figure(*table_, options);
        figure.title = lift_.words();
        for (auto& points : figure.points) {  // the legend leaves its room to the curve
            points.name = points.name.starts_with("points") ? "" : points.name;
        }
        const bool exact = lift_.basis == cases::KnownLift::Basis::this_shape;
        for (auto& curve : figure.curves) {
            curve.dashed = curve.dashed || !exact;
            if (!curve.name.empty() && !exact) {
                curve.name += " (" + lift_.of + ", not this shape)";
            }
        }
    } else {
        return;
    }
    const double unit = core::convert(1, "m", figure.x.unit);
    figure.lines.push_back({true, state().design.gap * unit, "gap", {120, 120, 120, 255}, true});
    lift_plot_->show_figure(figure, true);
}

}  // namespace underbody::studio
