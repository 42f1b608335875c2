#include "surrogates/tables/fit/table_batch.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/fit/force_table_impl.h"
#include "surrogates/tables/fit/hull.h"
#include "surrogates/tables/fit/table_json.h"

namespace underbody::tables {

void values(const ForceTable& table, const double* points, std::size_t count, double* value, double* slope) noexcept {
    table.impl().surface.values(points, count, value, slope);
}

const Support* data_support(const ForceTable& table) { return table.impl().data_support(); }

double beyond_points(const ForceTable& table, const double* point) {
    return table.impl().hull ? table.impl().hull->distance(point) : 0;
}

/// A number without its unit is off by 57 (degrees) or 1,000 (mm); one beyond the axis by less was meant as it stands.
constexpr double far_outside = 5;
constexpr double mega_for_milli = 1e-9;

core::Problems outside_remarks(const ForceTable& table, const Held& held) {
    core::Problems remarks;
    for (const auto& [name, value] : held) {
        const auto& axes = table.axes();
        const auto axis =
            std::find_if(axes.begin(), axes.end(), [&n = name](const TableAxis& a) { return a.name == n; });
        if (axis == axes.end() || (value >= axis->lower && value <= axis->upper)) {
            continue;
        }
        const std::string unit = shown_unit(table, axis->name);
        const double beyond = std::max(axis->lower - value, value - axis->upper);
        std::string text = axis->name + " is outside the table by " +
                           core::format_number(core::convert(beyond, axis->unit, unit), 5) + " " + unit + ": " +
                           outside_words(axis->range);
        const double meant = core::convert(value, unit, axis->unit);
        const bool far = std::abs(value) > far_outside * std::max(std::abs(axis->lower), std::abs(axis->upper));
        if (far && meant >= axis->lower && meant <= axis->upper) {
            text += "; it is " + core::format_number(value, 6) + " " + axis->unit + " (a bare number is SI), and " +
                    core::format_number(value, 6) + " " + unit + " would lie inside";
        } else if (far && value * mega_for_milli >= axis->lower && value * mega_for_milli <= axis->upper) {
            text += "; with m (milli) for M (mega) it would lie inside";
        }
        remarks.push_back({core::Problem::Severity::warning, text, {table.source(), {}, {}, {}}});
    }
    return remarks;
}

}  // namespace underbody::tables
