#include "surrogates/discovery/correction_table.h"

#include <algorithm>

#include "core/table.h"
#include "core/units.h"
#include "surrogates/tables/fit/force_table.h"

namespace underbody::discovery {

namespace {

/// Grid lines over what was seen, and one on either side at which the correction has faded to nothing.
std::vector<double> fading_lines(double lower, double upper, std::size_t inside) {
    constexpr double fade = 0.1;  ///< of the range
    std::vector<double> lines{lower - fade * (upper - lower)};
    for (std::size_t i = 0; i < inside; ++i) {
        lines.push_back(lower + (upper - lower) * static_cast<double>(i) / static_cast<double>(inside - 1));
    }
    lines.push_back(upper + fade * (upper - lower));
    return lines;
}

}  // namespace

dynamics::EffectUse correction_table(const std::vector<std::string>& variables, const std::vector<double>& lower,
                                     const std::vector<double>& upper,
                                     const std::function<double(const double*)>& force, double largest) {
    const std::size_t inside = variables.size() == 1 ? 97 : 33;
    const std::size_t each = inside + 2;
    std::size_t count = 1;
    std::vector<std::vector<double>> lines;
    for (std::size_t v = 0; v < variables.size(); ++v) {
        count *= each;
        lines.push_back(fading_lines(lower[v], upper[v], inside));
    }
    std::vector<std::vector<double>> grid(variables.size(), std::vector<double>(count));
    std::vector<double> values(count), point(variables.size());
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t rest = i;
        bool faded = false;
        for (std::size_t v = 0; v < variables.size(); ++v) {
            const std::size_t line = rest % each;
            rest /= each;
            point[v] = grid[v][i] = lines[v][line];
            faded = faded || line == 0 || line + 1 == each;
        }
        values[i] = faded ? 0 : std::clamp(force(point.data()), -largest, largest);
    }
    core::Table table;
    table.source = "correction-lift_force.csv";
    for (std::size_t v = 0; v < variables.size(); ++v) {
        table.add_numbers(variables[v], core::find_quantity(variables[v])->unit, grid[v]);
    }
    table.add_numbers("lift_force", "N", values);
    dynamics::EffectUse use = dynamics::neutral_use("unknown");
    use.quantity = "lift_force";
    use.table = tables::ForceTable::fit(table, "lift_force");
    use.table_file = table.source;
    return use;
}

}  // namespace underbody::discovery
