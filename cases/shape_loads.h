// Loads of one shape over gap, pitch, speed or jet, by the surrogates of a search: points of a force table like those
// of CFD cases.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cases/asked_points.h"
#include "cases/conditions.h"
#include "cases/design_spec.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/table.h"
#include "geometry/body/body_shape.h"
#include "surrogates/tables/search/surrogate.h"

namespace underbody::cases {

class Design;

/// What was learned of some loads, and of which shapes.
struct LearnedLoads {
    DesignSpec spec;
    geometry::BodyShape base;
    std::vector<tables::Surrogate> surrogates;  ///< one a quantity
    std::vector<std::vector<double>> solved;    ///< SI, numbers of the shapes that were learned from

    [[nodiscard]] const tables::Surrogate* find(const std::string& quantity) const;
};

/// `quantities` empty: all that [design] computes. Throws core::InputError: too few runs, a quantity that it does not
/// compute (with the nearest).
std::shared_ptr<const LearnedLoads> learned_loads(const Design& design, const std::vector<std::string>& quantities,
                                                  core::Progress& progress = core::Progress::none());

/// The varied numbers of a shape that differs from the searched one in them and their ties alone, SI; empty for any
/// other.
std::vector<double> varied_numbers(const DesignSpec& spec, const geometry::BodyShape& base,
                                   const geometry::BodyShape& shape);
/// How far two shapes are from each other: the sum of the differences of their parameters, each over the larger of the
/// two; parts and words that only one has count as one.
double distance_of_shapes(const geometry::BodyShape& a, const geometry::BodyShape& b);

/// What loads of a shape by surrogates rest on.
struct SurrogateBasis {
    std::size_t shapes = 0;  ///< that were learned from
    bool run = false;        ///< this shape is one of them
    std::string outside;     ///< varied numbers beyond the range that was searched
    /// "surrogate over the 28 shapes of the search; not CFD of this one"
    [[nodiscard]] std::string words() const;
};
SurrogateBasis surrogate_basis(const DesignSpec& spec, const std::vector<std::vector<double>>& solved,
                               const std::vector<double>& at);

/// Points over `axes` (conditions that take several values in [design]) of the quantities of `of`, with one standard
/// deviation each; conditions that are no axis are columns of one value: `held` of those that vary, the others as they
/// were computed. `at` as varied_numbers has it. Nothing is refused: beyond the ranges it extrapolates.
core::Table surrogate_points(const DesignSpec& spec, const std::vector<double>& at,
                             const std::vector<const tables::Surrogate*>& of, const std::vector<std::string>& axes,
                             const Conditions& held);

/// The same with everything checked: throws core::InputError where the shape is not of the searched family (with the
/// number that differs most), a condition is not known, has no value or one beyond the range that was computed. The
/// table's comments say what it rests on and how the surrogates do on shapes left out.
core::Table shape_points(const LearnedLoads& known, const geometry::BodyShape& shape, const AskedPoints& asked);

}  // namespace underbody::cases
