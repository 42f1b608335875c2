#include "cases/shape_loads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "cases/design.h"
#include "cases/design_file.h"
#include "core/counted.h"
#include "core/text.h"
#include "geometry/body/variants.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::cases {

using tables::SearchVariable;
using tables::Surrogate;

namespace {

/// Points along one axis where a table has one, two, three or more of them.
constexpr std::array<std::size_t, 3> steps_of = {60, 30, 12};
/// The axis that forces bend along most; the others are learned from a few values.
constexpr const char* finest_axis = "gap";
constexpr std::size_t other_steps = 8;

std::vector<double> grid_of(const SearchVariable& v, std::size_t axes) {
    const std::size_t most = steps_of[std::min(axes, steps_of.size()) - 1];
    const std::size_t steps = axes == 1 || v.name == finest_axis ? most : other_steps;
    std::vector<double> grid;
    for (std::size_t i = 0; i <= steps; ++i) {
        grid.push_back(v.unscaled(static_cast<double>(i) / static_cast<double>(steps)));
    }
    return grid;
}

/// The shape of the search that is most like it: at its own varied numbers, where there is one.
geometry::BodyShape counterpart(const LearnedLoads& known, const geometry::BodyShape& shape) {
    try {
        std::vector<double> at;
        for (const SearchVariable& v : known.spec.variables) {
            at.push_back(geometry::parameter(shape, v.name));
        }
        return shape_at(known.spec, known.base, at);
    } catch (const core::Error&) {
        return known.base;
    }
}

std::string how_it_differs(const LearnedLoads& known, const geometry::BodyShape& shape) {
    const geometry::BodyShape searched = counterpart(known, shape);
    std::string most;
    double largest = 0;
    for (const auto& name : geometry::parameter_names()) {
        const bool here = geometry::has_part_of(shape, name.name), there = geometry::has_part_of(searched, name.name);
        if (here != there) {
            return std::string(here ? "it has a " : "it has no ") + name.name.substr(0, name.name.find('.'));
        }
        const auto& varied = known.spec.variables;
        if (!here || name.unit.empty() ||
            std::any_of(varied.begin(), varied.end(), [&](const SearchVariable& v) { return v.name == name.name; })) {
            continue;
        }
        const double a = geometry::parameter(shape, name.name), b = geometry::parameter(searched, name.name);
        const double size = std::max(std::abs(a), std::abs(b));
        if (size > 0 && std::isfinite(size) && std::abs(a - b) / size > std::max(1.0001 * largest, 1e-6)) {
            largest = std::abs(a - b) / size;
            most = name.name + " is " + geometry::shown_value(a, name.unit, 6) + ", " +
                   geometry::shown_value(b, name.unit, 6) + " in the search";
        }
    }
    return most.empty() ? "a choice of it, or a number that follows another, is not as in the search" : most;
}

}  // namespace

double distance_of_shapes(const geometry::BodyShape& a, const geometry::BodyShape& b) {
    double sum = (a.base == b.base ? 0 : 1) + (a.protrusion.has_value() == b.protrusion.has_value() ? 0 : 1) +
                 (a.nozzle.has_value() == b.nozzle.has_value() ? 0 : 1) +
                 (a.tail_plate.has_value() == b.tail_plate.has_value() ? 0 : 1);
    sum += a.protrusion && b.protrusion && a.protrusion->profile != b.protrusion->profile ? 1 : 0;
    for (const auto& name : geometry::parameter_names()) {
        if (name.unit.empty() || !geometry::has_part_of(a, name.name) || !geometry::has_part_of(b, name.name)) {
            continue;
        }
        const double x = geometry::parameter(a, name.name);
        const double y = geometry::parameter(b, name.name);
        const double size = std::max(std::abs(x), std::abs(y));
        sum += size > 0 && std::isfinite(size) ? std::abs(x - y) / size : 0;
    }
    return sum;
}

std::vector<double> varied_numbers(const DesignSpec& spec, const geometry::BodyShape& base,
                                   const geometry::BodyShape& shape) {
    std::vector<double> at;
    for (const auto& variable : spec.variables) {
        const bool there = geometry::has_part_of(shape, variable.name);
        // A protrusion of no height is none (shape_at): what else is varied of it changes nothing.
        const bool of_none = !there && variable.name.starts_with("protrusion.") && base.protrusion;
        if (!there && !of_none) {
            return {};
        }
        at.push_back(there                                  ? geometry::parameter(shape, variable.name)
                     : variable.name == "protrusion.height" ? 0
                                                            : geometry::parameter(base, variable.name));
    }
    try {
        // Files of shapes hold nine digits.
        return distance_of_shapes(shape_at(spec, base, at), shape) < 1e-6 ? at : std::vector<double>{};
    } catch (const core::Error&) {
        return {};
    }
}

const Surrogate* LearnedLoads::find(const std::string& quantity) const {
    const auto found = std::find_if(surrogates.begin(), surrogates.end(),
                                    [&](const Surrogate& one) { return one.quantity() == quantity; });
    return found == surrogates.end() ? nullptr : &*found;
}

std::shared_ptr<const LearnedLoads> learned_loads(const Design& design, const std::vector<std::string>& quantities,
                                                  core::Progress& progress) {
    LearnedLoads known{design.spec(), geometry::read_shape(design.spec().shape), {}, {}};
    for (const std::string& quantity : quantities.empty() ? design.spec().quantities : quantities) {
        known.surrogates.push_back(design.surrogate(quantity, progress));
    }
    std::set<std::vector<double>> shapes;
    for (const DesignRun& run : design.runs()) {
        const bool learned =
            run.usable() && std::any_of(known.surrogates.begin(), known.surrogates.end(),
                                        [&](const Surrogate& s) { return run.loads.contains(s.quantity()); });
        if (learned) {
            shapes.emplace(run.at.begin(), run.at.begin() + static_cast<std::ptrdiff_t>(known.spec.variables.size()));
        }
    }
    known.solved.assign(shapes.begin(), shapes.end());
    return std::make_shared<const LearnedLoads>(std::move(known));
}

std::string SurrogateBasis::words() const {
    std::string text = "surrogate over the " + core::counted(shapes, "shape") + " of the search";
    text += run ? ", this shape is one of them" : "; not CFD of this one";
    return text + (outside.empty() ? "" : "; extrapolated: " + outside + " beyond the searched range");
}

SurrogateBasis surrogate_basis(const DesignSpec& spec, const std::vector<std::vector<double>>& solved,
                               const std::vector<double>& at) {
    SurrogateBasis basis;
    basis.shapes = solved.size();
    basis.run = std::any_of(solved.begin(), solved.end(), [&](const auto& one) {  // rounded as their file has them
        return std::equal(one.begin(), one.end(), at.begin(),
                          [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::max(std::abs(b), 1e-9); });
    });
    for (std::size_t i = 0; i < at.size(); ++i) {
        const auto& variable = spec.variables[i];
        const double rounding = 1e-9 * (variable.upper - variable.lower);
        if (at[i] < variable.lower - rounding || at[i] > variable.upper + rounding) {
            basis.outside += (basis.outside.empty() ? "" : ", ") + variable.name;
        }
    }
    return basis;
}

core::Table surrogate_points(const DesignSpec& spec, const std::vector<double>& at,
                             const std::vector<const Surrogate*>& of, const std::vector<std::string>& axes,
                             const Conditions& held) {
    const std::vector<SearchVariable> conditions = conditions_of(spec);
    std::vector<std::vector<double>> grids;
    std::size_t rows = 1;
    for (const SearchVariable& v : conditions) {
        grids.push_back(has(axes, v.name) ? grid_of(v, axes.size())
                                          : std::vector<double>{held.number(v.name).value_or(v.lower)});
        rows *= grids.back().size();
    }
    std::vector<std::vector<double>> columns(conditions.size(), std::vector<double>(rows));
    std::vector<std::vector<double>> values(of.size(), std::vector<double>(rows)), sigmas = values;
    std::vector<double> x = at;
    x.resize(at.size() + conditions.size());
    for (std::size_t row = 0; row < rows; ++row) {
        std::size_t rest = row;
        for (std::size_t c = conditions.size(); c-- > 0;) {
            x[at.size() + c] = columns[c][row] = grids[c][rest % grids[c].size()];
            rest /= grids[c].size();
        }
        for (std::size_t q = 0; q < of.size(); ++q) {
            const tables::SurrogatePrediction p = of[q]->at(x);
            values[q][row] = p.value;
            sigmas[q][row] = p.sigma;
        }
    }
    core::Table points;
    for (std::size_t c = 0; c < conditions.size(); ++c) {
        points.add_numbers(conditions[c].name, conditions[c].unit, std::move(columns[c]),
                           geometry::shown_unit(conditions[c].unit));
    }
    for (const auto& [name, value] : only_values(spec)) {
        const std::string unit = core::find_quantity(name)->unit;
        points.add_numbers(name, unit, std::vector<double>(rows, value), geometry::shown_unit(unit));
    }
    for (std::size_t q = 0; q < of.size(); ++q) {
        points.add_numbers(of[q]->quantity(), of[q]->unit(), std::move(values[q]));
        if (*std::min_element(sigmas[q].begin(), sigmas[q].end()) > 0) {
            points.add_numbers(of[q]->quantity() + "_sigma", of[q]->unit(), std::move(sigmas[q]));
        }
    }
    return points;
}

core::Table shape_points(const LearnedLoads& known, const geometry::BodyShape& shape, const AskedPoints& asked) {
    check_asked(known.spec, asked);
    const std::vector<double> at = varied_numbers(known.spec, known.base, shape);
    if (at.empty()) {
        throw core::InputError("shape", "the surrogates know nothing of this shape: " + how_it_differs(known, shape),
                               {},
                               "a shape that differs from " + known.spec.shape.filename().string() +
                                   " in the varied numbers of [design] alone");
    }
    std::vector<const Surrogate*> of;
    for (const Surrogate& one : known.surrogates) {
        if (asked.quantities.empty() || has(asked.quantities, one.quantity())) {
            of.push_back(&one);
        }
    }
    std::vector<std::string> axes = asked.axes;
    if (axes.empty()) {
        for (const SearchVariable& condition : conditions_of(known.spec)) {
            axes.push_back(condition.name);
        }
        std::erase_if(axes, [&](const std::string& name) { return asked.held.number(name).has_value(); });
    }
    if (axes.empty()) {
        throw core::InputError("missing", "the search of [design] computed its shapes at one condition alone", {},
                               "give it several: gap = [\"2 mm\", \"5 mm\", \"10 mm\"]");
    }
    core::Table points = surrogate_points(known.spec, at, of, axes, asked.held);
    const SurrogateBasis basis = surrogate_basis(known.spec, known.solved, at);
    const bool doubtful = !basis.run || !basis.outside.empty();
    points.comments.push_back((doubtful ? std::string(tables::warning_comment) : std::string()) + "loads of '" +
                              shape.name + "' by a " + basis.words());
    for (const Surrogate* one : of) {
        const auto& check = one->check();
        points.comments.push_back(one->quantity() + ": on shapes left out the surrogate errs by " +
                                  core::format_number(check.root_mean_square, 3) + " " + one->unit() + ", " +
                                  core::format_number(100 * check.inside_95, 3) + " % lie inside its 95 % band");
    }
    return points;
}

}  // namespace underbody::cases
