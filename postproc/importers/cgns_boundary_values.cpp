#include "postproc/importers/cgns_boundary_values.h"

#include <algorithm>
#include <unordered_map>

namespace underbody::postproc {

namespace {

/// Which of a condition's vertices each node of the zone is, in the order in which the file names them.
std::unordered_map<std::int64_t, std::size_t> order_of_vertices(const CgnsCondition& condition, const CgnsZone& zone) {
    std::unordered_map<std::int64_t, std::size_t> order;
    const auto indices = static_cast<std::size_t>(condition.indices);
    const auto& numbers = condition.numbers;
    const auto node_of = [&](const std::array<std::int64_t, 3>& at) { return (at[2] * zone.nodes[1] + at[1]) * zone.nodes[0] + at[0]; };
    if (!condition.range) {
        for (std::size_t i = 0; i + indices <= numbers.size(); i += indices) {
            std::array<std::int64_t, 3> at{};
            for (std::size_t k = 0; k < indices; ++k) {
                at[k] = numbers[i + k] - 1;
            }
            order.emplace(node_of(at), i / indices);
        }
        return order;
    }
    std::array<std::int64_t, 3> low{};
    std::array<std::int64_t, 3> high{};
    for (std::size_t k = 0; k < indices; ++k) {
        std::tie(low[k], high[k]) = std::minmax(numbers[k] - 1, numbers[indices + k] - 1);
    }
    std::array<std::int64_t, 3> at{};
    std::size_t count = 0;
    for (at[2] = low[2]; at[2] <= high[2]; ++at[2]) {
        for (at[1] = low[1]; at[1] <= high[1]; ++at[1]) {
            for (at[0] = low[0]; at[0] <= high[0]; ++at[0]) {
                order.emplace(node_of(at), count++);
            }
        }
    }
    return order;
}

}  // namespace

std::optional<PartValues> values_on(const CgnsSurface& surface, const std::vector<std::int64_t>& nodes, const CgnsZone& zone, const CgnsBoundaryValues& stated) {
    const CgnsCondition& condition = *surface.condition;
    const std::size_t faces = surface.part.elements();
    const std::size_t count = stated.values.size();
    if (count == 1) {
        PartValues values{stated.variable, false, 1, Buffer<double>(faces)};
        values.values.fill(stated.values[0]);
        return values;
    }
    const bool as_many = static_cast<double>(count) == condition.named();
    if (condition.where == CgnsCondition::Where::faces && as_many && surface.entries.size() == faces) {
        PartValues values{stated.variable, false, 1, Buffer<double>(faces)};
        for (std::size_t i = 0; i < faces; ++i) {
            values.values[i] = stated.values[static_cast<std::size_t>(surface.entries[i])];
        }
        return values;
    }
    if (condition.where != CgnsCondition::Where::vertices || stated.at_faces || !as_many) {
        return {};
    }
    PartValues values{stated.variable, true, 1, Buffer<double>(nodes.size())};
    const auto order = order_of_vertices(condition, zone);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const auto found = order.find(nodes[i]);
        if (found == order.end()) {
            return {};
        }
        values.values[i] = stated.values[found->second];
    }
    return values;
}

}  // namespace underbody::postproc
