#include "cases/known_lift.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cases/design.h"
#include "core/counted.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/body/variants.h"

namespace underbody::cases {

namespace {

/// How far two shapes are from each other: the sum of the differences of their parameters, each over the larger of the
/// two; parts and words that only one has count as one.
double distance(const geometry::BodyShape& a, const geometry::BodyShape& b) {
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

/// The varied numbers of a shape when it differs from the searched one in them and their ties alone.
std::vector<double> design_of(const LiftSurrogate& known, const geometry::BodyShape& shape) {
    std::vector<double> at;
    for (const auto& variable : known.spec.variables) {
        if (!geometry::has_part_of(shape, variable.name)) {
            return {};
        }
        at.push_back(geometry::parameter(shape, variable.name));
    }
    try {
        // Files of shapes hold nine digits.
        return distance(shape_at(known.spec, known.base, at), shape) < 1e-6 ? at : std::vector<double>{};
    } catch (const core::Error&) {
        return {};
    }
}

KnownLift by_surrogate(const LiftSurrogate& known, std::vector<double> at) {
    KnownLift lift;
    lift.basis = KnownLift::Basis::surrogate;
    lift.shapes = known.solved.size();
    for (const auto& solved : known.solved) {
        bool same = true;
        for (std::size_t i = 0; i < at.size(); ++i) {
            same = same && std::abs(solved[i] - at[i]) <= 1e-6 * std::max(std::abs(at[i]), 1e-9);
        }
        lift.run = lift.run || same;
    }
    for (std::size_t i = 0; i < at.size(); ++i) {
        const auto& variable = known.spec.variables[i];
        if (at[i] < variable.lower || at[i] > variable.upper) {
            lift.outside += (lift.outside.empty() ? "" : ", ") + variable.name;
        }
    }
    lift.design = std::move(at);
    return lift;
}

constexpr int curve_steps = 60;  ///< of a curve over the gap

/// Where the surrogate is asked for a shape.
struct Asked {
    std::vector<double> at;  ///< one a variable of the surrogate
    std::size_t gap = 0;     ///< which of them is the gap; the number of variables where one gap was computed
};

Asked asked_at(const LiftSurrogate& known, const KnownLift& lift, double pitch, double speed) {
    const auto& variables = known.surrogate.variables();
    Asked asked{lift.design, variables.size()};
    for (std::size_t v = known.spec.variables.size(); v < variables.size(); ++v) {
        asked.gap = variables[v].name == "gap" ? v : asked.gap;
        asked.at.push_back(variables[v].name == "gap"     ? known.spec.gaps.front()
                           : variables[v].name == "pitch" ? pitch
                           : variables[v].name == "speed" ? speed
                                                          : known.spec.jet.values.front());
    }
    return asked;
}

/// The lift over the gap of one variant.
bool is_lift_of(const TableSpec& table, const NamedShape& shape) {
    const auto variant = table.where.text("variant");
    return variant && (*variant == shape.name || *variant == shape.file.stem().string());
}

}  // namespace

std::shared_ptr<const LiftSurrogate> lift_surrogate(const Study& study, std::string& why, core::Progress& progress) {
    if (!study.design) {
        return nullptr;
    }
    const Design design = Design::open(study);
    try {
        auto surrogates = design.surrogates(progress);
        const auto lift = surrogates.find("lift_force");
        if (lift == surrogates.end()) {
            why = "[design] does not compute lift_force";
            return nullptr;
        }
        return std::make_shared<const LiftSurrogate>(LiftSurrogate{
            design.spec(), geometry::read_shape(design.spec().shape), lift->second, design.known().solved});
    } catch (const core::InputError& error) {  // too few runs yet
        why = error.message();
        return nullptr;
    }
}

std::string KnownLift::words() const {
    switch (basis) {
        case Basis::nothing:
            return "no CFD of any shape like this one is known";
        case Basis::this_shape:
            return "CFD of this shape (" + of + ")";
        case Basis::surrogate: {
            std::string text = "surrogate over the " + core::counted(shapes, "shape") + " of the search";
            text += run ? ", this shape is one of them" : "; not CFD of this one";
            return text + (outside.empty() ? "" : "; extrapolated: " + outside + " beyond the searched range");
        }
        case Basis::nearest_shape:
            break;
    }
    return "CFD of " + of + ", the nearest shape; not CFD of this one";
}

KnownLift known_lift(const Study& study, const std::vector<NamedShape>& shapes, const LiftSurrogate* surrogate,
                     const geometry::BodyShape& shape) {
    KnownLift nearest;
    double least = std::numeric_limits<double>::infinity();
    const std::string hash = geometry::shape_hash(shape);
    for (const auto& table : study.tables) {
        if (table.quantity != "lift_force" || table.axes != std::vector<std::string>{"gap"}) {
            continue;
        }
        for (const NamedShape& known : shapes) {
            if (!is_lift_of(table, known)) {
                continue;
            }
            const bool exact = geometry::shape_hash(known.shape) == hash;
            const double away = exact ? -1 : distance(known.shape, shape);
            if (away < least) {
                least = away;
                nearest.basis = exact ? KnownLift::Basis::this_shape : KnownLift::Basis::nearest_shape;
                nearest.table = &table;
                nearest.of = known.name;
            }
        }
    }
    if (nearest.basis != KnownLift::Basis::this_shape && surrogate != nullptr) {
        if (auto at = design_of(*surrogate, shape); !at.empty()) {
            return by_surrogate(*surrogate, std::move(at));
        }
    }
    return nearest;
}

core::Figure surrogate_lift_figure(const LiftSurrogate& known, const KnownLift& lift, double pitch, double speed) {
    const auto& variables = known.surrogate.variables();
    auto [x, gap] = asked_at(known, lift, pitch, speed);
    const auto given = [&](const char* name, const std::vector<double>& values, double wanted, const char* unit) {
        const double at = values.size() > 1 ? wanted : values.front();
        return std::string(name) + " " +
               core::format_number(core::convert(at, unit == std::string("deg") ? "rad" : unit, unit), 4) + " " + unit +
               (values.size() > 1 ? "" : " (the only one that was computed)");
    };
    core::Figure figure;
    figure.title = lift.words();
    figure.caption =
        given("pitch", known.spec.pitches, pitch, "deg") + ", " + given("speed", known.spec.speeds, speed, "m/s");
    figure.x = {"gap", "mm", 0, 0, gap < variables.size() && variables[gap].upper > 5 * variables[gap].lower};
    figure.y = {"lift", "N"};
    core::FigureCurve curve;
    curve.name = "surrogate";
    curve.colour = core::palette(0);
    curve.dashed = !lift.run;
    core::FigureBand band;
    band.name = "two standard deviations";
    const bool along = gap < variables.size();
    for (int i = 0; i <= (along ? curve_steps : 0); ++i) {
        if (along) {
            x[gap] = variables[gap].unscaled(i / double{curve_steps});
        }
        const auto p = known.surrogate.at(x);
        curve.x.push_back(1000 * (along ? x[gap] : known.spec.gaps.front()));
        curve.y.push_back(p.value);
        band.lower.push_back(p.value - 2 * p.sigma);
        band.upper.push_back(p.value + 2 * p.sigma);
    }
    band.x = curve.x;
    if (along) {
        figure.bands.push_back(band);
        figure.curves.push_back(curve);
    } else {
        figure.points.push_back({"surrogate, the one gap that was computed",
                                 curve.x,
                                 curve.y,
                                 {0.25 * (band.upper[0] - band.lower[0])},
                                 core::palette(0)});
    }
    return figure;
}

tables::ForceTable surrogate_lift_table(const LiftSurrogate& known, const KnownLift& lift, double pitch, double speed) {
    auto [x, gap] = asked_at(known, lift, pitch, speed);
    const auto& variables = known.surrogate.variables();
    if (gap == variables.size()) {
        throw core::InputError("missing", "the search of [design] computed its shapes at one gap alone", {},
                               "give it several: gap = [\"2 mm\", \"5 mm\", \"10 mm\"]");
    }
    std::vector<double> gaps, lifts, sigmas;
    for (int i = 0; i <= curve_steps; ++i) {
        x[gap] = variables[gap].unscaled(i / double{curve_steps});
        const auto p = known.surrogate.at(x);
        gaps.push_back(x[gap]);
        lifts.push_back(p.value);
        sigmas.push_back(p.sigma);
    }
    core::Table points;
    points.source = lift.words();
    points.add_numbers("gap", "m", gaps);
    points.add_numbers("lift_force", "N", lifts);
    if (*std::min_element(sigmas.begin(), sigmas.end()) > 0) {
        points.add_numbers("lift_force_sigma", "N", sigmas);
    }
    tables::FitOptions options;
    options.axes = {"gap"};
    options.kind = tables::FitOptions::Kind::interpolation;
    return tables::ForceTable::fit(points, "lift_force", options);
}

double surrogate_speed(const LiftSurrogate& known, double speed) {
    return known.spec.speeds.size() > 1 ? speed : known.spec.speeds.front();
}

}  // namespace underbody::cases
