// What is known of the lift of a shape, and what that rests on: CFD of this very shape, else the surrogate over the
// shapes of a search, else the table of the shape most like it. Nothing else is offered: an ideal fluid misses the gap
// flow by a factor of five to twenty.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cases/shape_loads.h"
#include "cases/study.h"
#include "core/figure.h"
#include "core/progress.h"
#include "geometry/body/body_shape.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::cases {

struct NamedShape {
    std::string name;
    std::filesystem::path file;  ///< the word in the names of cases may be that of the file
    geometry::BodyShape shape;
    bool of_its_cases = true;  ///< false: the files of its cases hold another body (cases/body_of_case.h)
};

/// Of the lift alone. Empty for a study without [design], and where it has too few runs or none with lift; `why` says
/// so then. Throws core::InputError as Design::open.
std::shared_ptr<const LearnedLoads> lift_surrogate(const Study& study, std::string& why,
                                                   core::Progress& progress = core::Progress::none());

struct KnownLift {
    enum class Basis { nothing, this_shape, surrogate, nearest_shape };
    Basis basis = Basis::nothing;
    const TableSpec* table = nullptr;  ///< of this or of the nearest shape; of the study that was asked
    std::string of;                    ///< name of the shape that the table is of
    bool changed_since = false;        ///< that shape is no longer the body of its cases
    std::vector<double> design;        ///< SI: the varied numbers of the shape, for the surrogate
    SurrogateBasis learned;            ///< of a surrogate

    /// "CFD of ellipse, the nearest shape; not CFD of this one"
    [[nodiscard]] std::string words() const;
};

/// `shapes`: those that the study's tables may be of (`where = { variant = NAME }`). `surrogate` may be nullptr.
KnownLift known_lift(const Study& study, const std::vector<NamedShape>& shapes, const LearnedLoads* surrogate,
                     const geometry::BodyShape& shape);

/// Lift over the gap at a pitch (rad) and speed (m/s) for `known.design`, with a band of two standard deviations; one
/// point when one gap was computed. Conditions that were not varied are those of the runs: the caption says them.
core::Figure surrogate_lift_figure(const LearnedLoads& surrogate, const KnownLift& known, double pitch, double speed);

/// The same curve as a table over the gap, its errors one standard deviation. Throws core::InputError (missing) when
/// one gap was computed.
tables::ForceTable surrogate_lift_table(const LearnedLoads& surrogate, const KnownLift& known, double pitch,
                                        double speed);
/// The speed that a curve of the surrogate is at, m/s: `speed` where several were computed, else that of the runs.
double surrogate_speed(const LearnedLoads& surrogate, double speed);

}  // namespace underbody::cases
