// Turns of a curve that its error bars do not support, named with the point that causes them.
#include <algorithm>
#include <cmath>

#include "core/counted.h"
#include "core/normal.h"
#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/fit/fit.h"

namespace underbody::tables {

namespace {

/// " (pitch 2 deg)": where a point lies along the other axes; empty with one axis.
std::string other_axes(const SetPoints& points, std::size_t along, std::size_t row) {
    std::string text;
    for (std::size_t k = 0; k < points.axes.size(); ++k) {
        if (k != along) {
            const core::Column* column = points.table.find(points.axes[k].name);
            const std::string unit = column->written_unit.empty() ? column->unit : column->written_unit;
            text += ", " + points.axes[k].name + " " +
                    core::format_number(core::convert(points.x[row][k], column->unit, unit), 6) + " " + unit;
        }
    }
    return text;
}

}  // namespace

core::Problems kinks(const SetPoints& points) {
    core::Problems found;
    if (!points.full_grid || !points.has_sigma()) {
        return found;
    }
    constexpr std::size_t most = 6;
    std::size_t count = 0;
    std::size_t stride = 1;
    for (std::size_t k = points.axes.size(); k-- > 0;) {
        const auto& x = points.axes[k].points;
        for (std::size_t node = 0; node < points.order.size(); ++node) {
            const std::size_t i = node / stride % x.size();
            if (i == 0 || i + 1 == x.size()) {
                continue;
            }
            const auto at = [&](std::size_t n) { return points.order[n]; };
            const std::size_t here = at(node), before = at(node - stride), after = at(node + stride);
            if (points.is_doubted(here) || points.is_doubted(before) || points.is_doubted(after)) {
                continue;  // that point is named already, and makes its neighbours turn
            }
            const double left = points.value[here] - points.value[before];
            const double right = points.value[after] - points.value[here];
            if (left * right >= 0) {
                continue;
            }
            const bool left_is_less = std::abs(left) < std::abs(right);
            const double joint = std::hypot(points.sigma[here], points.sigma[left_is_less ? before : after]);
            const double height = std::min(std::abs(left), std::abs(right));
            if (height >= core::beyond_sigmas * joint) {
                continue;
            }
            if (++count <= most) {
                const core::Column* column = points.table.find(points.axes[k].name);
                const std::string unit = column->written_unit.empty() ? column->unit : column->written_unit;
                found.push_back({core::Problem::Severity::warning,
                                 "the turn at " + points.axes[k].name + " " +
                                     core::format_number(core::convert(x[i], column->unit, unit), 6) + " " + unit +
                                     other_axes(points, k, here) + " (" + core::format_number(height, 3) + " " +
                                     points.unit +
                                     ") is not supported by the errors of the points: it is below twice their " +
                                     "joint error of " + core::format_number(joint, 3) + " " + points.unit,
                                 points.table.place(points.row[here], points.quantity)});
            }
        }
        stride *= x.size();
    }
    if (count > most) {
        found.push_back({core::Problem::Severity::warning,
                         "and " + core::counted(count - most, "more such turn"),
                         {points.table.source, {}, {}, {}}});
    }
    return found;
}

}  // namespace underbody::tables
