// CFD of one shape more: what it adds to the study and its [sweep], and what that costs.
#pragma once

#include <filesystem>
#include <limits>
#include <string>

#include "cases/study.h"
#include "geometry/body/body_shape.h"

namespace underbody::cases {

struct AskedCfd {
    std::string name;                  ///< of the new [[body]]
    std::filesystem::path shape_file;  ///< where the shape is to be written, absolute
    std::string shape_text;            ///< of that file
    std::string study_text;            ///< of study.toml with the body in it
    std::size_t cases = 0;             ///< that the sweep makes of this shape
    std::size_t solved = 0;            ///< cases of this sweep that the time is known from
    /// s of one core for all of them: so many times the median of the solved ones; NaN where none is solved.
    double seconds = std::numeric_limits<double>::quiet_NaN();

    /// "6 cases, about 40 min of one core (median of 12 solved here)"
    [[nodiscard]] std::string cost() const;
};

/// What asking for CFD of a shape would change; nothing is written. The shape goes to shapes/NAME.toml of the study. A
/// study without [sweep] gets one at this gap (m) and speed (m/s; none: that of the first case). Throws
/// core::InputError: there is such a body or file already, a shape that cannot be, a study.toml whose [sweep] cannot be
/// added to.
AskedCfd ask_for_cfd(const Study& study, const geometry::BodyShape& shape, const std::string& name, double gap,
                     std::optional<double> speed = {});

/// Writes the shape and study.toml.
void write_asked(const Study& study, const AskedCfd& asked);

}  // namespace underbody::cases
