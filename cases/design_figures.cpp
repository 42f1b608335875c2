// Pictures of a design search.
#include "cases/design_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/counted.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "geometry/body/body_figures.h"
#include "geometry/body/body_surface.h"
#include "geometry/mesh/slice.h"

namespace underbody::cases {

using core::Figure;
using geometry::shown_unit;
using tables::Candidate;
using tables::SearchVariable;
using tables::Surrogate;

namespace {

constexpr core::Colour grey{130, 130, 130, 255};

double shown(double value, const std::string& unit) { return core::convert(value, unit, shown_unit(unit)); }

std::string spaced(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

/// Of numbers of curves.
constexpr const char* below_zero = ". Below zero there is none, and it is missed by so much.";

/// What a plot calls a quantity.
std::string label(const std::string& quantity) {
    const auto* known = core::find_quantity(quantity);
    return known != nullptr && known->symbol.size() > 3 ? known->symbol : spaced(quantity);
}

}  // namespace

std::vector<OneAtATime> along(const LearnedNumber& number, std::vector<double> at, std::size_t variable,
                              std::size_t count) {
    std::vector<OneAtATime> result;
    for (std::size_t i = 0; i < count; ++i) {
        at[variable] = number.variables[variable].unscaled(static_cast<double>(i) / static_cast<double>(count - 1));
        const auto p = number.with_error(at);
        result.push_back({at[variable], p.value, p.sigma});
    }
    return result;
}

std::vector<double> middle_of(const std::vector<SearchVariable>& variables) {
    std::vector<double> middle;
    for (const SearchVariable& v : variables) {
        middle.push_back(v.unscaled(0.5));
    }
    return middle;
}

Figure left_out_figure(const Surrogate& surrogate) {
    const auto& check = surrogate.check();
    Figure figure;
    figure.title = label(surrogate.quantity()) + ": shapes left out";
    figure.caption =
        "Each shape's runs predicted from all other shapes, against what was computed; bars are two standard "
        "deviations. " +
        core::format_number(100 * check.inside_95, 3) + " % lie within 1.96 standard deviations.";
    figure.x = {"computed", surrogate.unit()};
    figure.y = {"predicted without the shape", surrogate.unit()};
    core::FigurePoints points;
    points.name = core::counted(check.points, "run") + " of " + core::counted(check.shapes, "shape");
    points.x = check.measured;
    points.y = check.predicted;
    for (const double s : check.sigma) {
        points.y_error.push_back(2 * s);
    }
    points.colour = core::palette(0);
    figure.points.push_back(points);
    const auto [low, high] = std::minmax_element(check.measured.begin(), check.measured.end());
    if (low != check.measured.end()) {
        core::FigureCurve line;
        line.name = "equal";
        line.x = {*low, *high};
        line.y = line.x;
        line.dashed = true;
        line.colour = {120, 120, 120, 255};
        figure.curves.push_back(line);
    }
    return figure;
}

Figure sensitivity_figure(const LearnedNumber& number, const tables::SobolIndices& indices) {
    Figure figure;
    figure.title = "What " + label(number.name) + " depends on";
    figure.caption =
        "Sobol's indices of the surrogate's mean over the ranges searched: a variable alone, and with all its "
        "interactions; bars are 95 % intervals of the sampling.";
    figure.y = {"share of the variance", ""};
    for (const bool total : {false, true}) {
        core::FigureBars bars;
        bars.name = total ? "with interactions" : "alone";
        bars.colour = core::palette(total ? 1 : 0);
        for (std::size_t v = 0; v < number.variables.size(); ++v) {
            const tables::SobolIndex& index = (total ? indices.total : indices.first)[v];
            bars.labels.push_back(spaced(number.variables[v].name));
            bars.values.push_back(index.value);
            bars.errors.push_back(0.5 * (index.upper - index.lower));
        }
        figure.bars.push_back(bars);
    }
    return figure;
}

Figure one_at_a_time_figure(const LearnedNumber& number, const std::vector<double>& at) {
    Figure figure;
    figure.title = label(number.name) + ", one number at a time";
    figure.caption = "The surrogate's mean along each variable, the others held at";
    const std::string unit(core::told_unit(number.unit));
    figure.x = {"share of the variable's range", "", 0, 1};
    figure.y = {label(number.name), unit};
    const auto& variables = number.variables;
    constexpr std::size_t points = 41;
    for (std::size_t v = 0; v < variables.size(); ++v) {
        core::FigureCurve curve;
        curve.name = spaced(variables[v].name);
        curve.colour = v % 8 == 7 ? grey : core::palette(v);  // yellow is no line on white
        curve.dashed = !variables[v].of_shape;
        std::vector<double> place = at;
        for (std::size_t i = 0; i < points; ++i) {  // the mean alone: errors of curves take a hundred times as long
            const double share = static_cast<double>(i) / static_cast<double>(points - 1);
            place[v] = variables[v].unscaled(share);
            curve.x.push_back(share);
            curve.y.push_back(core::convert(number.value(place), number.unit, unit));
        }
        figure.curves.push_back(curve);
        figure.caption +=
            (v > 0 ? ", " : " ") + spaced(variables[v].name) + " " + geometry::shown_value(at[v], variables[v].unit, 4);
    }
    figure.caption += number.of_curves ? below_zero : ". Dashed: conditions.";
    return figure;
}

namespace {

/// The unit in which people are told of a response, and how many of it make one of its SI unit.
struct ToldResponse {
    ToldResponse(const tables::DesignSearch& search, const tables::Response& response)
        : unit(core::told_unit(search.unit_of(response))), factor(core::convert(1, search.unit_of(response), unit)) {}
    std::string unit;
    double factor = 1;
};

}  // namespace

Figure convergence_figure(const Design& design, const tables::DesignSearch& search) {
    const auto& objective = search.problem().objectives.front();
    Figure figure;
    figure.title = "The search so far";
    figure.caption =
        "The first objective as the surrogate gives it for each design that was run, and the best of those "
        "that meet the limits.";
    figure.x = {"design", ""};
    figure.caption += objective.response.curve ? std::string(below_zero).substr(1) : "";
    const ToldResponse told(search, objective.response);
    figure.y = {spaced(objective.response.name), told.unit};
    core::FigurePoints points;
    points.name = "designs";
    points.colour = core::palette(0);
    core::FigureCurve best;
    best.name = "best";
    best.steps = true;
    best.colour = core::palette(1);
    std::vector<std::vector<double>> until;
    std::size_t number = 0;
    for (const PlannedDesign& d : design.plan()) {
        ++number;
        const bool run = std::any_of(design.runs().begin(), design.runs().end(),
                                     [&](const DesignRun& r) { return r.design == d.name && r.usable(); });
        if (!run) {
            continue;
        }
        until.push_back(d.at);
        const auto value = search.evaluate(objective.response, d.at);
        points.x.push_back(static_cast<double>(number));
        points.y.push_back(told.factor * value.value);
        points.y_error.push_back(told.factor * value.sigma);
        const double so_far = told.factor * search.best_of(until);
        if (!std::isnan(so_far)) {
            best.x.push_back(static_cast<double>(number));
            best.y.push_back(objective.sense == tables::Objective::Sense::maximise ? -so_far : so_far);
        }
    }
    figure.points.push_back(points);
    if (objective.sense != tables::Objective::Sense::target && best.x.size() > 1) {
        figure.curves.push_back(best);
    }
    return figure;
}

namespace {

/// Outlines in the plane of symmetry, m, of the designs among `front` that leave each other room in a picture of
/// `width` by `height`; each is a twelfth of the picture long. `per_x` and `per_y`: the axes' units over SI.
void draw_bodies(Figure& figure, const Design& design, const std::vector<Candidate>& front, double per_x, double per_y,
                 core::Progress& progress) {
    constexpr double length = 1 / 12.0, aspect = 1.86;  // of a picture's box, width over height
    const double width = figure.x.upper - figure.x.lower, height = figure.y.upper - figure.y.lower;
    std::vector<std::pair<double, double>> drawn;
    for (const Candidate& c : front) {
        const double x = per_x * c.objectives[0].value, y = per_y * c.objectives[1].value;
        const bool covered = std::any_of(drawn.begin(), drawn.end(), [&](const auto& other) {
            return std::abs(other.first - x) < 1.1 * length * width &&
                   std::abs(other.second - y) < 0.9 * length * aspect * height;
        });
        if (covered) {
            continue;
        }
        drawn.emplace_back(x, y);
        const geometry::SurfaceMesh body = geometry::make_surface(design.shape_at(c.at), {4000, 0.5}, progress);
        const geometry::Box box = geometry::bounding_box(body);
        const double scale = length / (box.upper.x - box.lower.x);
        const geometry::Vec3 middle = 0.5 * (box.lower + box.upper);
        for (const auto& loop : geometry::slice(body, geometry::Axis::y, 0)) {
            core::FigureCurve outline;
            outline.colour = {30, 30, 30, 255};
            outline.width = 1.2;
            for (const geometry::Vec3& p : loop) {
                outline.x.push_back(x + scale * width * (p.x - middle.x));
                outline.y.push_back(y + scale * aspect * height * (p.z - middle.z));
            }
            figure.curves.push_back(outline);
        }
    }
}

void fit_axis(core::FigureAxis& axis, const std::vector<core::FigurePoints>& points,
              std::vector<double> core::FigurePoints::*values, bool bars) {
    axis.lower = std::numeric_limits<double>::infinity();
    axis.upper = -axis.lower;
    for (const core::FigurePoints& some : points) {
        for (std::size_t i = 0; i < (some.*values).size(); ++i) {
            const double v = (some.*values)[i], bar = bars && i < some.y_error.size() ? some.y_error[i] : 0;
            axis.lower = std::min(axis.lower, v - bar);
            axis.upper = std::max(axis.upper, v + bar);
        }
    }
    const double room = axis.upper > axis.lower ? 0.06 * (axis.upper - axis.lower) : 1;
    axis.lower -= room;
    axis.upper += room;
}

}  // namespace

Figure front_figure(const Design& design, const tables::DesignSearch& search, const std::vector<Candidate>& front,
                    const std::vector<Candidate>& known, core::Progress& progress) {
    const auto& objectives = search.problem().objectives;
    Figure figure;
    figure.title = "What can be had together";
    figure.caption = objectives.size() == 2 ? "Designs of which none is better in both"
                                            : "Designs of which none is better in all " +
                                                  std::to_string(objectives.size()) + " objectives, over the first two";
    figure.caption +=
        ", by the surrogates; bars are one standard deviation. Outlines: sections of bodies at their "
        "points, nose to the right, where there is room.";
    if (objectives[0].response.curve || objectives[1].response.curve) {
        figure.caption += std::string(" Kicks and windows below zero: there is none.");
    }
    const ToldResponse first(search, objectives[0].response), second(search, objectives[1].response);
    figure.x = {spaced(objectives[0].response.name), first.unit};
    figure.y = {spaced(objectives[1].response.name), second.unit};
    const auto add = [&](const std::vector<Candidate>& designs, const std::string& name, core::Colour colour,
                         bool bars) {
        core::FigurePoints points;
        points.name = name;
        points.colour = colour;
        for (const Candidate& c : designs) {
            points.x.push_back(first.factor * c.objectives[0].value);
            points.y.push_back(second.factor * c.objectives[1].value);
            if (bars) {
                points.y_error.push_back(second.factor * c.objectives[1].sigma);
            }
        }
        figure.points.push_back(points);
    };
    add(known, "designs that were run", grey, false);
    add(front, "front", core::palette(1), true);
    fit_axis(figure.x, figure.points, &core::FigurePoints::x, false);
    fit_axis(figure.y, figure.points, &core::FigurePoints::y, true);
    draw_bodies(figure, design, front, first.factor, second.factor, progress);
    return figure;
}

core::Figure bodies_figure(const Design& design, const std::vector<Candidate>& designs, core::Progress& progress) {
    constexpr std::size_t most = 6;
    const std::size_t count = std::min(most, designs.size());
    std::vector<geometry::SurfaceMesh> surfaces;
    std::vector<geometry::NamedBody> bodies;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = count < 2 ? 0 : i * (designs.size() - 1) / (count - 1);
        surfaces.push_back(geometry::make_surface(design.shape_at(designs[at].at), {8000, 0.5}, progress));
        bodies.push_back({"front " + std::to_string(at + 1), nullptr});
    }
    for (std::size_t i = 0; i < count; ++i) {
        bodies[i].mesh = &surfaces[i];
    }
    core::Figure figure = geometry::sheet_figure(bodies, "Bodies of the front");
    figure.caption += " Numbers are rows of the table.";
    return figure;
}

Figure parallel_figure(const tables::DesignSearch& search, const std::vector<Candidate>& known,
                       const std::vector<Candidate>& front) {
    const auto& problem = search.problem();
    Figure figure;
    figure.title = "Designs as lines through their numbers";
    figure.caption =
        "Each line is a design: its numbers within their ranges, then the objectives as the surrogates give them. From "
        "the foot to the top:";
    figure.y = {"share of the range", "", -0.03, 1.03};
    core::FigureBars names;  // of no height: they carry the names of the axes
    const auto axis = [&](const std::string& name, double lower, double upper, const std::string& unit) {
        names.labels.push_back(spaced(name));
        names.values.push_back(0);
        const double x = static_cast<double>(names.labels.size());
        figure.lines.push_back({true, x, "", {190, 190, 190, 255}, false});
        figure.caption += (x > 1 ? ", " : " ") + spaced(name) + " " + geometry::shown_value(lower, unit, 3) + " to " +
                          geometry::shown_value(upper, unit, 3);
    };
    for (const SearchVariable& v : problem.variables) {
        axis(v.name, v.lower, v.upper, v.unit);
    }
    std::vector<std::pair<double, double>> range(problem.objectives.size(), {1e300, -1e300});
    for (const auto* designs : {&known, &front}) {
        for (const Candidate& c : *designs) {
            for (std::size_t k = 0; k < range.size(); ++k) {
                range[k] = {std::min(range[k].first, c.objectives[k].value),
                            std::max(range[k].second, c.objectives[k].value)};
            }
        }
    }
    for (std::size_t k = 0; k < range.size(); ++k) {
        const auto& response = problem.objectives[k].response;
        const ToldResponse told(search, response);
        axis(response.name, told.factor * range[k].first, told.factor * range[k].second, told.unit);
    }
    const auto add = [&](const std::vector<Candidate>& designs, const std::string& name, core::Colour colour,
                         double thickness) {
        for (const Candidate& c : designs) {
            core::FigureCurve line;
            line.name = &c == &designs.front() ? name : "";
            line.colour = colour;
            line.width = thickness;
            for (std::size_t v = 0; v < problem.variables.size(); ++v) {
                line.y.push_back(problem.variables[v].scaled(c.at[v]));
            }
            for (std::size_t k = 0; k < range.size(); ++k) {
                const double spread = range[k].second - range[k].first;
                line.y.push_back(spread > 0 ? (c.objectives[k].value - range[k].first) / spread : 0.5);
            }
            for (std::size_t i = 0; i < line.y.size(); ++i) {
                line.x.push_back(static_cast<double>(i + 1));
            }
            figure.curves.push_back(line);
        }
    };
    add(known, "designs that were run", {150, 150, 150, 140}, 1);
    add(front, "front", core::palette(1), 1.8);
    figure.caption += ".";
    figure.bars.push_back(names);
    return figure;
}

Figure coverage_figure(const Design& design, std::size_t x, std::size_t y) {
    const auto& variables = design.spec().variables;
    Figure figure;
    figure.title = "The plan over " + spaced(variables[x].name) + " and " + spaced(variables[y].name);
    const auto axis = [&](std::size_t v) {
        const SearchVariable& variable = variables[v];  // with room for the markers at its ends
        return core::FigureAxis{spaced(variable.name), shown_unit(variable.unit),
                                shown(variable.unscaled(-0.03), variable.unit),
                                shown(variable.unscaled(1.03), variable.unit), variable.logarithmic};
    };
    figure.x = axis(x);
    figure.y = axis(y);
    core::FigurePoints planned, typed, chosen, refused;
    planned.name = "plan";
    planned.colour = core::palette(0);
    typed.name = "typed";
    typed.colour = core::palette(2);
    typed.shape = core::FigurePoints::Shape::square;
    chosen.name = "chosen by the search";
    chosen.colour = core::palette(1);
    chosen.shape = core::FigurePoints::Shape::diamond;
    refused.name = "no such shape";
    refused.colour = core::palette(5);
    refused.shape = core::FigurePoints::Shape::cross;
    for (const PlannedDesign& d : design.plan()) {
        core::FigurePoints& to = d.state != "planned" ? refused
                                 : d.why == "plan"    ? planned
                                 : d.why == "typed"   ? typed
                                                      : chosen;
        to.x.push_back(shown(d.at[x], variables[x].unit));
        to.y.push_back(shown(d.at[y], variables[y].unit));
    }
    for (const auto& points : {planned, typed, chosen, refused}) {
        if (!points.x.empty()) {
            figure.points.push_back(points);
        }
    }
    return figure;
}

}  // namespace underbody::cases
