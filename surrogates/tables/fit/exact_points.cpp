#include "surrogates/tables/fit/exact_points.h"

#include <algorithm>
#include <vector>

#include "core/text.h"
#include "surrogates/tables/fit/force_table_impl.h"

namespace underbody::tables {

namespace {

/// An exported table holds the sentence of what it was made from.
std::string told_before(const ForceTable& table, std::string begin) {
    begin[0] = 'T';
    for (std::string line : table.impl().told) {
        if (line.starts_with(begin)) {
            line[0] = 't';
            return line;
        }
    }
    return {};
}

bool warned_of_scatter(const ForceTable& table) {
    return std::any_of(table.remarks().begin(), table.remarks().end(), [](const core::Problem& remark) {
        return remark.severity == core::Problem::Severity::warning &&
               remark.message.starts_with("the points state no errors but scatter");
    });
}

}  // namespace

std::string unstated_errors(const ForceTable& table) {
    const core::Table& points = table.points();
    const std::string begin = "the points of " + table.quantity() + " state no errors";
    if (std::string told = told_before(table, begin); !told.empty()) {
        return told;
    }
    if (points.rows() == 0 || points.find(table.quantity() + "_sigma") != nullptr) {
        return {};
    }
    if (table.point_scatter() > 0) {
        return warned_of_scatter(table) ? ""
                                        : begin + ": what they scatter by about the fit, about " +
                                              core::format_number(table.point_scatter(), 2) + " " + table.unit() +
                                              ", is taken as their error";
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
        return {};  // sampled from a model
    }
    return begin + " and are taken as exact: errors are those of the curve between them alone";
}

bool says_exact(const std::string& sentence) { return sentence.find("taken as exact") != std::string::npos; }

}  // namespace underbody::tables
