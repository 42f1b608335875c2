#include "postproc/importers/cgns/cgns_boundary_values.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "postproc/importers/cgns/cgns_block.h"

namespace underbody::postproc {

namespace {

/// Which of a condition's vertices each node of the zone is, in the order in which the file names them.
std::unordered_map<std::int64_t, std::size_t> order_of_vertices(const CgnsCondition& condition, const CgnsZone& zone) {
    std::unordered_map<std::int64_t, std::size_t> order;
    const auto indices = static_cast<std::size_t>(condition.indices);
    const auto& numbers = condition.numbers;
    const auto node_of = [&](const std::array<std::int64_t, 3>& at) {
        return (at[2] * zone.nodes[1] + at[1]) * zone.nodes[0] + at[0];
    };
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

/// The faces of a block by their nodes, in the order in which a condition names them.
std::vector<std::int64_t> entries_in_block(const CgnsFile& file, const CgnsZone& zone, const CgnsSurface& surface,
                                           const std::vector<std::int64_t>& nodes, const CgnsCondition& places) {
    const auto key_of = [](const ElementPart& part, std::size_t face, const auto& node_of) {
        std::vector<std::int64_t> key;
        for (std::int64_t i = part.offsets[face]; i < part.offsets[face + 1]; ++i) {
            key.push_back(node_of(part.nodes[static_cast<std::size_t>(i)]));
        }
        std::sort(key.begin(), key.end());
        return key;
    };
    const BlockFaces named = faces_of_block(file, zone, places);
    std::map<std::vector<std::int64_t>, std::int64_t> order;
    for (std::size_t i = 0; i < named.surface.entries.size(); ++i) {
        order.emplace(key_of(named.surface.part, i, [](std::int64_t node) { return node; }), named.surface.entries[i]);
    }
    std::vector<std::int64_t> entries;
    for (std::size_t i = 0; i < surface.part.elements(); ++i) {
        const auto found = order.find(
            key_of(surface.part, i, [&](std::int64_t node) { return nodes[static_cast<std::size_t>(node)]; }));
        if (found == order.end()) {
            return {};
        }
        entries.push_back(found->second);
    }
    return entries;
}

/// The elements that a condition names by their numbers.
std::vector<std::int64_t> entries_of_elements(const CgnsSurface& surface, const CgnsCondition& places) {
    const auto number_of = [](const CgnsCondition& condition, std::int64_t entry) {
        return condition.range ? std::min(condition.numbers[0], condition.numbers[1]) + entry
                               : condition.numbers[static_cast<std::size_t>(entry)];
    };
    std::unordered_map<std::int64_t, std::int64_t> order;
    for (std::size_t i = 0; !places.range && i < places.numbers.size(); ++i) {
        order.emplace(places.numbers[i], static_cast<std::int64_t>(i));
    }
    std::vector<std::int64_t> entries;
    for (const std::int64_t entry : surface.entries) {
        const std::int64_t number = number_of(*surface.condition, entry);
        const auto found = order.find(number);
        const std::int64_t place = places.range           ? number - std::min(places.numbers[0], places.numbers[1])
                                   : found == order.end() ? -1
                                                          : found->second;
        if (place < 0 || static_cast<double>(place) >= places.named()) {
            return {};
        }
        entries.push_back(place);
    }
    return entries;
}

/// By face of a surface: which of the faces that `places` names; empty where these are not all among them.
std::vector<std::int64_t> entries_among(const CgnsFile& file, const CgnsZone& zone, const CgnsSurface& surface,
                                        const std::vector<std::int64_t>& nodes, const CgnsCondition& places) {
    if (places.where != CgnsCondition::Where::faces ||
        (places.range && places.numbers.size() != 2 * static_cast<std::size_t>(places.indices))) {
        return {};
    }
    return zone.structured ? entries_in_block(file, zone, surface, nodes, places)
                           : entries_of_elements(surface, places);
}

}  // namespace

std::optional<PartValues> values_on(const CgnsFile& file, const CgnsSurface& surface,
                                    const std::vector<std::int64_t>& nodes, const CgnsZone& zone,
                                    const CgnsBoundaryValues& stated) {
    const CgnsCondition& condition = stated.places ? *stated.places : *surface.condition;
    const std::size_t faces = surface.part.elements();
    const std::size_t count = stated.values.size();
    if (count == 1 && !stated.places) {
        PartValues values{stated.variable, false, 1, Buffer<double>(faces)};
        values.values.fill(stated.values[0]);
        return values;
    }
    if (static_cast<double>(count) != condition.named()) {
        return {};
    }
    if (condition.where == CgnsCondition::Where::faces) {
        const auto entries = stated.places ? entries_among(file, zone, surface, nodes, condition) : surface.entries;
        if (entries.size() != faces) {
            return {};
        }
        PartValues values{stated.variable, false, 1, Buffer<double>(faces)};
        for (std::size_t i = 0; i < faces; ++i) {
            values.values[i] = stated.values[static_cast<std::size_t>(entries[i])];
        }
        return values;
    }
    if (condition.where != CgnsCondition::Where::vertices || stated.at_faces ||
        (condition.range && condition.numbers.size() != 2 * static_cast<std::size_t>(condition.indices))) {
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
