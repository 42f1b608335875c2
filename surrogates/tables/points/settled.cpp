#include "surrogates/tables/points/settled.h"

#include <algorithm>

#include "core/counted.h"

namespace underbody::tables {

namespace {

const core::Column* words(const core::Table& points, const char* name) {
    const auto* column = points.find(name);
    return column != nullptr && column->is_text() ? column : nullptr;
}

}  // namespace

std::vector<std::string> not_settled(const core::Table& points) {
    std::vector<std::string> names;
    const auto* settled = words(points, "settled");
    const auto* named = words(points, "case") != nullptr ? words(points, "case") : words(points, "file");
    for (std::size_t row = 0; settled != nullptr && row < points.rows(); ++row) {
        if (settled->text[row] == "not settled") {
            names.push_back(named != nullptr ? named->text[row] : "row " + std::to_string(row + 1));
        }
    }
    return names;
}

core::Problems unsettled_points(const core::Table& points) {
    const auto names = not_settled(points);
    if (names.empty()) {
        return {};
    }
    constexpr std::size_t most = 5;
    std::string list;
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i) {
        list += (i > 0 ? ", " : "") + names[i];
    }
    return {{core::Problem::Severity::warning,
             core::counted_of(names.size(), points.rows(), "point", "is of a solution that has",
                              "are of solutions that have") +
                 " not settled: " + list + (names.size() > most ? ", ..." : ""),
             {points.source, {}, {}, {}}}};
}

std::vector<std::string> settled_lines(const core::Table& points) {
    const auto* settled = words(points, "settled");
    if (settled == nullptr || points.rows() == 0) {
        return {};
    }
    const auto count = [&](const char* verdict) {
        return static_cast<std::size_t>(std::count(settled->text.begin(), settled->text.end(), verdict));
    };
    const std::size_t all = points.rows(), still = count("settled"), known = still + count("not settled");
    if (still == all) {
        return {"Every solution behind the points had settled"};
    }
    if (known == all) {
        return {};
    }
    return {"Whether " +
            (known == 0 ? std::string("the solutions")
                        : std::to_string(all - known) + " of the " + std::to_string(all) + " solutions") +
            " behind the points had settled is not known: no history of their loads or residuals stood beside them"};
}

}  // namespace underbody::tables
