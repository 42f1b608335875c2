// Where a table has no data, for consumers that know nothing but straight lines between points.
#include <cmath>

#include "surrogates/tables/exports/export_grid.h"

namespace underbody::tables {

Steps no_data_steps(const ExportGrid& grid) {
    const std::size_t n = grid.axes.size();
    Steps steps;
    std::vector<std::vector<double>> middle(n);  // of the cell that a point belongs to; not a number outside
    std::size_t count = 1;
    for (std::size_t k = 0; k < n; ++k) {
        const ExportAxis& axis = grid.axes[k];
        std::vector<double> lines{axis.lower};
        for (const double x : grid.support.empty() ? std::vector<double>{} : grid.support.lines()[k]) {
            if (x > axis.lower && x < axis.upper) {
                lines.push_back(x);
            }
        }
        lines.push_back(axis.upper);
        std::vector<double> points{std::nextafter(axis.lower, -INFINITY), axis.lower};
        middle[k].push_back(NAN);
        for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
            const bool last = i + 2 == lines.size();
            points.push_back(last ? axis.upper : std::nextafter(lines[i + 1], -INFINITY));
            points.push_back(last ? std::nextafter(axis.upper, INFINITY) : lines[i + 1]);
            middle[k].insert(middle[k].end(), 2, 0.5 * (lines[i] + lines[i + 1]));
        }
        middle[k].push_back(NAN);
        count *= points.size();
        steps.points.push_back(std::move(points));
    }
    steps.value.resize(count);
    for (std::size_t node = 0; node < count; ++node) {
        double at[max_axes];
        std::size_t rest = node;
        bool outside = false;
        for (std::size_t k = n; k-- > 0;) {
            at[k] = middle[k][rest % middle[k].size()];
            rest /= middle[k].size();
            outside = outside || std::isnan(at[k]);
        }
        steps.value[node] = outside || (!grid.support.empty() && grid.support.no_data(at)) ? 1 : 0;
    }
    return steps;
}

}  // namespace underbody::tables
