// A history that a solver writes: columns against iterations or time steps.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace underbody::postproc {

/// What a table of coefficients says of them (OpenFOAM's forceCoeffs): force = coefficient 1/2 density speed^2 area,
/// moment that times the length.
struct MonitorCoefficients {
    std::optional<double> density, speed, area, length;                     ///< kg/m^3, m/s, m^2, m
    std::optional<std::array<double, 3>> centre;                            ///< m, of the moments
    std::vector<std::pair<std::string, std::array<double, 3>>> directions;  ///< liftDir, dragDir, pitchAxis ...
};

/// A table of histories: the first column counts iterations or time steps, every other one is a quantity.
/// Units are the solver's: these files do not state any.
struct Monitor {
    std::string file;
    std::string title;
    std::vector<std::string> columns;
    std::vector<std::vector<double>> values;  ///< one list a column, all of the same length
    core::Problems problems;                  ///< restarts that repeat iterations, values that are not finite
    std::optional<MonitorCoefficients> coefficients{};

    /// nullptr when there is no such column.
    [[nodiscard]] const std::vector<double>* find(const std::string& column) const;
};

/// Rows of a monitor by their first number; of those of one number the last counts.
class MonitorRows {
public:
    void add(std::vector<double> row);
    [[nodiscard]] bool empty() const { return rows_.empty(); }
    /// Gives `monitor`, whose columns have names, their values, and says what repeats and what is not finite.
    void into(Monitor& monitor) const;

private:
    std::map<double, std::vector<double>> rows_;
    std::size_t repeated_ = 0;
};

/// The note that goes with rows that repeat.
core::Problem repeated_rows(std::size_t rows, const std::string& file);

}  // namespace underbody::postproc
