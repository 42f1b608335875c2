#include "surrogates/tables/analysis/continuation.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/analysis/figures.h"
#include "surrogates/tables/analysis/zero_lines.h"

namespace underbody::tables {

namespace {

/// Net force over gap and parameter.
class NetForce {
public:
    NetForce(const ForceTable& table, const ContinuationOptions& options) : table_(table), options_(options) {
        axis_ = options.base.axis.empty() && table.axes().size() == 1
                    ? 0
                    : axis_index(table, options.base.axis.empty() ? "gap" : options.base.axis);
        Held held = options.base.held;
        for (std::size_t k = 0; k < table.axes().size(); ++k) {
            if (table.axes()[k].name == options.parameter && k != axis_) {
                parameter_axis_ = k;
                held.emplace_back(options.parameter, options.lower);
            }
        }
        point_ = held_point(table, axis_, held);
        free_ = 1U << axis_ | (parameter_axis_ != none ? 1U << parameter_axis_ : 0);
        const bool weight = options.parameter == "net_weight";
        const auto* known = core::find_quantity(options.parameter);
        if (!weight && parameter_axis_ == none && (known == nullptr || options.parameter == table.axes()[axis_].name)) {
            throw core::UsageError(
                "parameter", "'" + options.parameter + "' is no parameter to continue along", {},
                core::did_you_mean(options.parameter, {"net_weight", "speed", "jet_voltage", "pitch"}));
        }
        if (!weight && parameter_axis_ == none &&
            (!(options.reference > 0) || !std::isfinite(options.reference) || !std::isfinite(options.exponent))) {
            throw core::UsageError(
                "range", "the reference of " + options.parameter + " must be positive, and the exponent a number");
        }
        unit = weight ? "N" : parameter_axis_ != none ? table.axes()[parameter_axis_].unit : known->unit;
        if (parameter_axis_ != none) {
            const auto& a = table.axes()[parameter_axis_];
            const double room = 1e-9 * (a.upper - a.lower);
            if (options.lower < a.lower - room || options.upper > a.upper + room) {
                throw core::UsageError("range", "the table covers " + a.name + " from " +
                                                    core::format_number(a.lower, 6) + " to " +
                                                    core::format_number(a.upper, 6) + " " + a.unit + " only");
            }
        }
    }

    double operator()(double gap, double parameter, double* slope = nullptr) {
        point_[axis_] = gap;
        double weight = options_.base.net_weight;
        double scale = options_.base.scale;
        if (options_.parameter == "net_weight") {
            weight = parameter;
        } else if (parameter_axis_ != none) {
            point_[parameter_axis_] = parameter;
        } else {
            scale *= std::pow(std::abs(parameter / options_.reference), options_.exponent);
        }
        std::array<double, max_axes> s{};
        const double v =
            scale * table_.value_by_policy(point_.data(), slope != nullptr ? s.data() : nullptr, free_) - weight;
        if (slope != nullptr) {
            *slope = scale * s[axis_];
        }
        return v;
    }
    [[nodiscard]] std::size_t axis() const { return axis_; }
    std::string unit;

private:
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    const ForceTable& table_;
    const ContinuationOptions& options_;
    std::size_t axis_ = 0;
    std::size_t parameter_axis_ = none;
    unsigned free_ = 0;
    std::vector<double> point_;
};

std::vector<double> spaced(double low, double high, int steps) {
    std::vector<double> x;
    for (int i = 0; i <= steps; ++i) {
        x.push_back(i == steps ? high : low + (high - low) * i / steps);
    }
    return x;
}

/// Where between two points of a branch the slope of the force vanishes on the curve: Newton on (force, slope) = 0 by
/// differences.
Fold fold_between(NetForce& f, const BranchPoint& a, const BranchPoint& b, double h_scale, double p_scale) {
    double h = 0.5 * (a.gap + b.gap);
    double p = 0.5 * (a.parameter + b.parameter);
    const double dh = 1e-6 * h_scale;
    const double dp = 1e-6 * p_scale;
    for (int i = 0; i < 40; ++i) {
        double s = 0, s_h = 0, s_p = 0, s_b = 0;
        const double v = f(h, p, &s);
        const double v_p = (f(h, p + dp, &s_p) - f(h, p - dp, &s_b)) / (2 * dp);
        const double slope_p = (s_p - s_b) / (2 * dp);
        f(h + dh, p, &s_h);
        f(h - dh, p, &s_b);
        const double slope_h = (s_h - s_b) / (2 * dh);
        const double det = s * slope_p - v_p * slope_h;
        if (det == 0) {
            break;
        }
        const double step_h = (v * slope_p - v_p * s) / det;
        const double step_p = (s * s - v * slope_h) / det;
        const double reach = std::max(std::abs(step_h) / (2 * std::abs(b.gap - a.gap) + dh),
                                      std::abs(step_p) / (2 * std::abs(b.parameter - a.parameter) + 1e3 * dp));
        const double share = reach > 1 ? 1 / reach : 1;
        h -= share * step_h;
        p -= share * step_p;
        if (std::abs(step_h) < 1e-12 * h_scale && std::abs(step_p) < 1e-12 * p_scale) {
            break;
        }
    }
    return {p, h};
}

}  // namespace

EquilibriumCurve continue_equilibria(const ForceTable& table, const ContinuationOptions& options,
                                     core::Progress& progress) {
    if (!(options.lower < options.upper)) {
        throw core::UsageError("range", "the range of " + options.parameter + " has its ends swapped or no width");
    }
    require_lift(table);
    NetForce force(table, options);
    const TableAxis& axis = table.axes()[force.axis()];
    std::vector<double> gaps = axis.lower > 0 && axis.upper / axis.lower > 4
                                   ? std::vector<double>{}
                                   : spaced(axis.lower, axis.upper, options.steps);
    for (int i = 0; gaps.size() <= static_cast<std::size_t>(options.steps); ++i) {
        gaps.push_back(i == options.steps
                           ? axis.upper
                           : axis.lower * std::pow(axis.upper / axis.lower, static_cast<double>(i) / options.steps));
    }
    EquilibriumCurve curve;
    curve.parameter = options.parameter;
    curve.parameter_unit = force.unit;
    curve.axis = axis.name;
    curve.axis_unit = axis.unit;
    const auto net = [&force](double gap, double parameter) { return force(gap, parameter); };
    for (const auto& line : zero_lines(net, gaps, spaced(options.lower, options.upper, options.steps), progress)) {
        Branch branch;
        for (const auto& [gap, parameter] : line) {
            double slope = 0;
            force(gap, parameter, &slope);
            branch.push_back({parameter, gap, 0 - slope, slope < 0 ? Stability::stable : Stability::unstable});
        }
        // At an end of the table, or on a stretch without slope, the curve touches the flat: no fold, if it does not go
        // through.
        double steepest = 0;
        for (const auto& b : branch) {
            steepest = std::max(steepest, std::abs(b.stiffness));
        }
        for (std::size_t i = 0; i < branch.size() && branch.size() > 1; ++i) {
            if (std::abs(branch[i].stiffness) <= 1e-12 * steepest) {
                branch[i].stability = branch[i == 0 ? 1 : i - 1].stability;
            }
        }
        for (std::size_t i = 0; i + 1 < branch.size(); ++i) {
            if (branch[i].stability != branch[i + 1].stability) {
                curve.folds.push_back(fold_between(force, branch[i], branch[i + 1], axis.upper - axis.lower,
                                                   options.upper - options.lower));
            }
        }
        curve.branches.push_back(std::move(branch));
    }
    std::sort(curve.folds.begin(), curve.folds.end(),
              [](const Fold& a, const Fold& b) { return a.parameter < b.parameter; });
    return curve;
}

core::Figure continuation_figure(const ForceTable& table, const EquilibriumCurve& curve) {
    core::Figure figure;
    figure.title = "equilibria against " + curve.parameter;
    figure.x = {curve.parameter, curve.parameter_unit, 0, 0, false};
    const TableAxis& axis = table.axes()[axis_index(table, curve.axis)];
    figure.y = {curve.axis, shown_unit(table, curve.axis), 0, 0,
                axis.name == "gap" && spans_decades(axis.lower, axis.upper)};
    const auto shown = core::conversion(curve.axis_unit, figure.y.unit);
    bool named[2] = {false, false};
    for (const auto& branch : curve.branches) {
        for (std::size_t i = 0; i < branch.size();) {
            core::FigureCurve part;
            const bool stable = branch[i].stability == Stability::stable;
            std::size_t j = i;
            while (j < branch.size() && (branch[j].stability == Stability::stable) == stable) {
                part.x.push_back(branch[j].parameter);
                part.y.push_back(shown(branch[j].gap));
                ++j;
            }
            part.name = named[stable] ? "" : stable ? "stable" : "unstable";
            named[stable] = true;
            part.colour = core::palette(stable ? 2 : 5);
            part.dashed = !stable;
            figure.curves.push_back(std::move(part));
            i = j;
        }
    }
    core::FigurePoints folds;
    folds.name = "fold";
    folds.shape = core::FigurePoints::Shape::diamond;
    for (const auto& f : curve.folds) {
        folds.x.push_back(f.parameter);
        folds.y.push_back(shown(f.gap));
    }
    if (!folds.x.empty()) {
        figure.points.push_back(std::move(folds));
    }
    return figure;
}

void to_json(nlohmann::json& json, const EquilibriumCurve& curve) {
    json = nlohmann::json{{"parameter", curve.parameter},
                          {"parameter_unit", curve.parameter_unit},
                          {"axis", curve.axis},
                          {"axis_unit", curve.axis_unit}};
    json["folds"] = nlohmann::json::array();
    for (const auto& f : curve.folds) {
        json["folds"].push_back({{curve.parameter, f.parameter}, {curve.axis, f.gap}});
    }
    json["branches"] = nlohmann::json::array();
    for (const auto& branch : curve.branches) {
        nlohmann::json list = nlohmann::json::array();
        for (const auto& b : branch) {
            list.push_back({{curve.parameter, b.parameter},
                            {curve.axis, b.gap},
                            {"stiffness", b.stiffness},
                            {"stable", b.stability == Stability::stable}});
        }
        json["branches"].push_back(std::move(list));
    }
}

}  // namespace underbody::tables
