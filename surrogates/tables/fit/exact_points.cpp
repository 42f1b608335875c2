#include "surrogates/tables/fit/exact_points.h"

#include <vector>

namespace underbody::tables {

std::string exact_points(const ForceTable& table) {
    const core::Table& points = table.points();
    if (points.rows() == 0 || points.find(table.quantity() + "_sigma") != nullptr) {
        return {};
    }
    std::vector<double> first;
    for (const TableAxis& axis : table.axes()) {
        const auto* column = points.find(axis.name);
        if (column == nullptr || column->numbers.empty()) {
            return {};
        }
        first.push_back(column->numbers.front());
    }
    if (table.sampling_error() > 0 || table.sigma(first.data()) > 0) {
        return {};  // sampled from a model, or a fit that found out how far its points scatter
    }
    return "the points of " + table.quantity() +
           " state no errors and are taken as exact: errors are those of the curve between them alone";
}

}  // namespace underbody::tables
