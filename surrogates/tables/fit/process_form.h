// What a Gaussian process of a force table sees: coordinates, known laws, sizes. For the files of this room only.
//
// Known laws (docs/physics.md sections 4.4 and 5.2): force ~ speed^2 and ~ jet voltage^2 (the process then models force
// over that square); film terms ~ 1/h^2 and 1/h^3 over a gap axis; a constant free-stream value at large gaps, to which
// the rest decays with a power of the gap; gaps that span decades act through their logarithm.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "surrogates/tables/fit/gaussian_process.h"
#include "surrogates/tables/points/set_points.h"

namespace underbody::tables {

/// How raw set points and forces become the numbers that the process sees.
struct Form {
    std::vector<bool> logarithmic;    ///< per axis
    std::vector<double> start, span;  ///< of the coordinate
    std::vector<bool> squared;        ///< per axis: force grows with its square
    std::vector<double> reference;    ///< per axis: the square counts from here
    std::optional<std::size_t> film;  ///< axis with 1/h^2 and 1/h^3
    double film_gap = 1;
    std::optional<std::size_t>
        decay;  ///< gap axis along which the force decays to its free-stream value, the process as h^-decay_power
    double decay_power = 0;
    double decay_gap = 1;
    double offset = 0, size = 1;  ///< of force over squares

    [[nodiscard]] double coordinate(std::size_t k, double x) const {
        return ((logarithmic[k] ? std::log(x) : x) - start[k]) / span[k];
    }
    [[nodiscard]] double coordinate_slope(std::size_t k, double x) const {
        return (logarithmic[k] ? 1 / x : 1) / span[k];
    }
    [[nodiscard]] double factor(const std::vector<double>& x) const {
        double product = 1;
        for (std::size_t k = 0; k < x.size(); ++k) {
            product *= squared[k] ? std::pow(x[k] / reference[k], 2) : 1;
        }
        return product;
    }
    [[nodiscard]] double amplitude(const std::vector<double>& x) const {
        return decay ? std::pow(x[*decay] / decay_gap, -decay_power) : 1;
    }
    [[nodiscard]] std::size_t trends() const { return film ? 3 : 1; }
    void trend(const std::vector<double>& x, double* h) const {
        h[0] = 1;
        if (film) {
            const double r = film_gap / x[*film];
            h[1] = r * r;
            h[2] = r * r * r;
        }
    }
    /// Words for the laws in use, each after a comma.
    [[nodiscard]] std::string text(const std::vector<TableAxis>& axes) const;
};

/// The points `rows` as a process sees them; sets offset and size of the form.
GpData data_of(const SetPoints& points, const std::vector<std::size_t>& rows, Form& form);

/// The forms worth trying for these axes and this quantity; the first one uses no law.
std::vector<Form> candidate_forms(const SetPoints& points);

}  // namespace underbody::tables
