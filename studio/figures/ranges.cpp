#include "studio/figures/ranges.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace underbody::studio {

namespace {

/// Smallest interval that holds what it was shown.
class Extent {
public:
    explicit Extent(bool positive_only) : positive_only_(positive_only) {}

    void add(double value) {
        if (std::isfinite(value) && (!positive_only_ || value > 0)) {
            lower_ = std::min(lower_, value);
            upper_ = std::max(upper_, value);
        }
    }
    void add(const std::vector<double>& values) {
        for (const double value : values) {
            add(value);
        }
    }

    [[nodiscard]] AxisRange padded(double margin) const {
        if (!(lower_ <= upper_)) {
            return positive_only_ ? AxisRange{0.1, 10} : AxisRange{0, 1};
        }
        if (positive_only_) {
            const double pad = std::max(std::log(upper_ / lower_) * margin, upper_ > lower_ ? 0.0 : 0.5);
            return {lower_ * std::exp(-pad), upper_ * std::exp(pad)};
        }
        double pad = (upper_ - lower_) * margin;
        if (!(upper_ - lower_ > 1e-12 * std::max(std::abs(lower_), std::abs(upper_)))) {
            pad = lower_ != 0 ? 0.1 * std::abs(lower_) : 1;
        }
        // A gap or a time that is never negative does not get a margin below zero.
        return {lower_ >= 0 ? std::max(0.0, lower_ - pad) : lower_ - pad,
                upper_ <= 0 ? std::min(0.0, upper_ + pad) : upper_ + pad};
    }

private:
    bool positive_only_;
    double lower_ = std::numeric_limits<double>::infinity();
    double upper_ = -std::numeric_limits<double>::infinity();
};

template <class Grids>
bool has_grid(const Grids& grids) {
    return std::any_of(grids.begin(), grids.end(), [](const auto& grid) { return grid.columns > 0 && grid.rows > 0; });
}

/// The range that the maker of the figure asked for, when it makes sense.
bool given(const core::FigureAxis& axis, AxisRange& range) {
    if (!(axis.lower < axis.upper) || !std::isfinite(axis.lower) || !std::isfinite(axis.upper) ||
        (axis.logarithmic && axis.lower <= 0)) {
        return false;
    }
    range = {axis.lower, axis.upper};
    return true;
}

}  // namespace

AxisRange x_range(const core::Figure& figure) {
    AxisRange range;
    if (given(figure.x, range)) {
        return range;
    }
    if (!figure.bars.empty()) {
        return {0.4, static_cast<double>(bar_labels(figure).size()) + 0.6};
    }
    Extent extent(figure.x.logarithmic);
    for (const auto& map : figure.maps) {
        extent.add(std::vector{map.x_lower, map.x_upper});
    }
    for (const auto& classes : figure.classes) {
        extent.add(std::vector{classes.x_lower, classes.x_upper});
    }
    if (has_grid(figure.maps) || has_grid(figure.classes)) {
        return extent.padded(0);
    }
    for (const auto& curve : figure.curves) {
        extent.add(curve.x);
    }
    for (const auto& band : figure.bands) {
        extent.add(band.x);
    }
    for (const auto& points : figure.points) {
        extent.add(points.x);
    }
    for (const auto& arrows : figure.arrows) {
        extent.add(arrows.x);
    }
    for (const auto& line : figure.lines) {
        if (line.vertical) {
            extent.add(line.at);
        }
    }
    for (const auto& note : figure.notes) {
        extent.add(note.x);
    }
    return extent.padded(0.04);
}

AxisRange y_range(const core::Figure& figure) {
    AxisRange range;
    if (given(figure.y, range)) {
        return range;
    }
    Extent extent(figure.y.logarithmic);
    for (const auto& map : figure.maps) {
        extent.add(std::vector{map.y_lower, map.y_upper});
    }
    for (const auto& classes : figure.classes) {
        extent.add(std::vector{classes.y_lower, classes.y_upper});
    }
    if (has_grid(figure.maps) || has_grid(figure.classes)) {
        return extent.padded(0);
    }
    for (const auto& curve : figure.curves) {
        extent.add(curve.y);
    }
    for (const auto& band : figure.bands) {
        extent.add(band.lower);
        extent.add(band.upper);
    }
    for (const auto& points : figure.points) {
        extent.add(points.y);
        for (std::size_t i = 0; i < std::min(points.y.size(), points.y_error.size()); ++i) {
            extent.add(points.y[i] - points.y_error[i]);
            extent.add(points.y[i] + points.y_error[i]);
        }
    }
    for (const auto& bars : figure.bars) {
        extent.add(0.0);
        extent.add(bars.values);
        for (std::size_t i = 0; i < std::min(bars.values.size(), bars.errors.size()); ++i) {
            extent.add(bars.values[i] - bars.errors[i]);
            extent.add(bars.values[i] + bars.errors[i]);
        }
    }
    for (const auto& arrows : figure.arrows) {
        extent.add(arrows.y);
    }
    for (const auto& line : figure.lines) {
        if (!line.vertical) {
            extent.add(line.at);
        }
    }
    for (const auto& note : figure.notes) {
        extent.add(note.y);
    }
    return extent.padded(0.06);
}

AxisRange colour_range(const core::FigureMap& map) {
    AxisRange range{map.lower, map.upper};
    if (!(map.lower < map.upper)) {
        Extent extent(false);
        extent.add(map.values);
        range = extent.padded(0);
    }
    if (map.diverging) {
        const double size = std::max(std::abs(range.lower), std::abs(range.upper));
        range = {-size, size};
    }
    return range;
}

std::vector<std::string> bar_labels(const core::Figure& figure) {
    std::vector<std::string> labels;
    for (const auto& bars : figure.bars) {
        for (const auto& label : bars.labels) {
            if (std::find(labels.begin(), labels.end(), label) == labels.end()) {
                labels.push_back(label);
            }
        }
    }
    return labels;
}

}  // namespace underbody::studio
