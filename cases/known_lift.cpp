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

const std::string lift_quantity = "lift_force";

KnownLift by_surrogate(const LearnedLoads& known, std::vector<double> at) {
    KnownLift lift;
    lift.basis = KnownLift::Basis::surrogate;
    lift.learned = surrogate_basis(known.spec, known.solved, at);
    lift.design = std::move(at);
    return lift;
}

/// Conditions that were not varied are those of the runs.
Conditions held_at(const LearnedLoads& known, double pitch, double speed) {
    Conditions held;
    held.set("pitch", pitch);
    held.set("speed", speed);
    if (known.spec.jet.any()) {
        held.set(known.spec.jet.quantity, known.spec.jet.values.front());
    }
    return held;
}

/// Lift over the gap; over nothing where one gap was computed.
core::Table lift_over_gap(const LearnedLoads& known, const KnownLift& lift, double pitch, double speed) {
    const auto axes = known.spec.gaps.size() > 1 ? std::vector<std::string>{"gap"} : std::vector<std::string>{};
    return surrogate_points(known.spec, lift.design, {known.find(lift_quantity)}, axes, held_at(known, pitch, speed));
}

/// The lift over the gap of one variant.
bool is_lift_of(const TableSpec& table, const NamedShape& shape) {
    const auto variant = table.where.text("variant");
    return variant && (*variant == shape.name || *variant == shape.file.stem().string());
}

}  // namespace

std::shared_ptr<const LearnedLoads> lift_surrogate(const Study& study, std::string& why, core::Progress& progress) {
    if (!study.design) {
        return nullptr;
    }
    if (std::find(study.design->quantities.begin(), study.design->quantities.end(), lift_quantity) ==
        study.design->quantities.end()) {
        why = "[design] does not compute lift_force";
        return nullptr;
    }
    const Design design = Design::open(study);
    try {
        return learned_loads(design, {lift_quantity}, progress);
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
        case Basis::surrogate:
            return learned.words();
        case Basis::nearest_shape:
            break;
    }
    return "CFD of " + of + ", the nearest shape" + (changed_since ? ", as it was when its cases were computed" : "") +
           "; not CFD of this one";
}

KnownLift known_lift(const Study& study, const std::vector<NamedShape>& shapes, const LearnedLoads* surrogate,
                     const geometry::BodyShape& shape) {
    KnownLift nearest;
    double least = std::numeric_limits<double>::infinity();
    const std::string hash = geometry::shape_hash(shape);
    for (const auto& table : study.tables) {
        if (!table.shape.empty() || table.quantity != lift_quantity || table.axes != std::vector<std::string>{"gap"}) {
            continue;
        }
        for (const NamedShape& known : shapes) {
            if (!is_lift_of(table, known)) {
                continue;
            }
            const bool exact = known.of_its_cases && geometry::shape_hash(known.shape) == hash;
            const double away = exact ? -1 : distance_of_shapes(known.shape, shape);
            if (away < least) {
                least = away;
                nearest.basis = exact ? KnownLift::Basis::this_shape : KnownLift::Basis::nearest_shape;
                nearest.table = &table;
                nearest.of = known.name;
                nearest.changed_since = !known.of_its_cases;
            }
        }
    }
    if (nearest.basis != KnownLift::Basis::this_shape && surrogate != nullptr) {
        if (auto at = varied_numbers(surrogate->spec, surrogate->base, shape); !at.empty()) {
            return by_surrogate(*surrogate, std::move(at));
        }
    }
    return nearest;
}

core::Figure surrogate_lift_figure(const LearnedLoads& known, const KnownLift& lift, double pitch, double speed) {
    const auto given = [&](const char* name, const std::vector<double>& values, double wanted, const char* unit) {
        const double at = values.size() > 1 ? wanted : values.front();
        return std::string(name) + " " +
               core::format_number(core::convert(at, unit == std::string("deg") ? "rad" : unit, unit), 4) + " " + unit +
               (values.size() > 1 ? "" : " (the only one that was computed)");
    };
    const core::Table points = lift_over_gap(known, lift, pitch, speed);
    const auto [low, high] = std::minmax_element(points.numbers("gap").begin(), points.numbers("gap").end());
    core::Figure figure;
    figure.title = lift.words();
    figure.caption =
        given("pitch", known.spec.pitches, pitch, "deg") + ", " + given("speed", known.spec.speeds, speed, "m/s");
    figure.x = {"gap", "mm", 0, 0, *high > 5 * *low};
    figure.y = {"lift", "N"};
    core::FigureCurve curve;
    curve.name = "surrogate";
    curve.colour = core::palette(0);
    curve.dashed = !lift.learned.run;
    core::FigureBand band;
    band.name = "two standard deviations";
    const auto* sigma = points.find(lift_quantity + "_sigma");
    for (std::size_t i = 0; i < points.rows(); ++i) {
        const double value = points.numbers(lift_quantity)[i], two = sigma == nullptr ? 0 : 2 * sigma->numbers[i];
        curve.x.push_back(1000 * points.numbers("gap")[i]);
        curve.y.push_back(value);
        band.lower.push_back(value - two);
        band.upper.push_back(value + two);
    }
    band.x = curve.x;
    if (points.rows() > 1) {
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

tables::ForceTable surrogate_lift_table(const LearnedLoads& known, const KnownLift& lift, double pitch, double speed) {
    core::Table points = lift_over_gap(known, lift, pitch, speed);
    if (points.rows() == 1) {
        throw core::InputError("missing", "the search of [design] computed its shapes at one gap alone", {},
                               "give it several: gap = [\"2 mm\", \"5 mm\", \"10 mm\"]");
    }
    points.source = lift.words();
    tables::FitOptions options;
    options.axes = {"gap"};
    options.kind = tables::FitOptions::Kind::interpolation;
    return tables::ForceTable::fit(points, lift_quantity, options);
}

double surrogate_speed(const LearnedLoads& known, double speed) {
    return known.spec.speeds.size() > 1 ? speed : known.spec.speeds.front();
}

}  // namespace underbody::cases
