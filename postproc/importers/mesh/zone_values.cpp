#include "postproc/importers/mesh/zone_values.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "postproc/importers/mesh/array_names.h"
#include "postproc/importers/mesh/variable_reading.h"
#include "postproc/importers/mesh/vtk_arrays.h"

namespace underbody::postproc {

namespace {

constexpr double not_there = std::numeric_limits<double>::quiet_NaN();

/// Traction on the body, out of the force of the wall on the fluid.
void to_traction(Buffer<double>& forces, int components, const std::vector<double>& areas) {
    const auto n = static_cast<std::size_t>(components);
    for (std::size_t i = 0; i < areas.size(); ++i) {
        for (std::size_t k = 0; k < n; ++k) {
            forces[i * n + k] = areas[i] > 0 ? -forces[i * n + k] / areas[i] : 0;
        }
    }
}

/// Three components out of two, the third 0.
Buffer<double> widened(const Buffer<double>& values) {
    Buffer<double> result(values.size() / 2 * 3);
    for (std::size_t i = 0; i < values.size() / 2; ++i) {
        result[3 * i] = values[2 * i];
        result[3 * i + 1] = values[2 * i + 1];
        result[3 * i + 2] = 0;
    }
    return result;
}

/// The caller states another unit than the file.
void take_as(ArrayInfo& info, Buffer<double>& values, const VariableReading& reading) {
    info.name = reading.name;
    info.unit = reading.unit;
    info.original_unit = reading.original_unit;
    for (double& value : values) {
        value = reading.convert(value);
    }
}

/// Behind the names of a phase that is not the mixture.
std::string phase_suffix(int phase) { return phase == 1 ? "" : ".phase-" + std::to_string(phase); }

}  // namespace

void add_cell_array(Zone& zone, vtkCellData& data, ArrayInfo info, Buffer<double>&& values) {
    auto array = given_to_vtk<vtkDoubleArray>(std::move(values), info.components);
    array->SetName(info.name.c_str());
    name_tensor_components(*array);
    data.AddArray(array);
    zone.arrays.push_back(std::move(info));
}

/// From where to where the ids of a zone go. Its blocks may come in any order: the ends of the list do not tell.
struct ZoneValues::Span {
    std::uint64_t first = 1, last = 0;
    bool gapless = false;  ///< and in order
};

ZoneValues::Span ZoneValues::span_of(const Ids& ids) {
    Span span;
    if (ids.empty()) {
        return span;
    }
    span.first = ids[0];
    span.last = ids[ids.size() - 1];
    span.gapless = true;
    for (std::size_t i = 1; i < ids.size() && ids.listed(); ++i) {
        span.gapless = span.gapless && ids[i] == ids[i - 1] + 1;
        span.first = std::min(span.first, ids[i]);
        span.last = std::max(span.last, ids[i]);
    }
    return span;
}

/// One variable of one zone, gathered from its blocks.
struct ZoneValues::Gathered {
    Buffer<double> values;
    int components = 1;
    std::uint64_t found = 0;
    ArrayInfo info{};
};

struct ZoneValues::Key {
    std::string variable;
    int phase = 1;
    CanonicalName canonical{};
    bool operator<(const Key& o) const { return std::tie(phase, variable) < std::tie(o.phase, o.variable); }
};

ZoneValues::Gathered ZoneValues::gather(const Key& key, int zone, bool on_cells, const Ids& ids, const Span& span) {
    Gathered result;
    if (ids.empty()) {
        return result;
    }
    const auto [first, last, gapless] = span;
    for (auto& block : values_) {
        const bool ours = block.on_cells == on_cells && block.variable == key.variable && block.phase == key.phase &&
                          (block.zone == 0 || block.zone == zone) && block.count > 0 && block.first <= last &&
                          block.first + block.count > first;
        if (!ours) {
            continue;
        }
        const auto n = static_cast<std::size_t>(block.components);
        const std::uint64_t from = std::max(first, block.first);
        const std::uint64_t to = std::min(last + 1, block.first + block.count);
        if (gapless && result.values.empty() && block.first == first && block.count == ids.size()) {
            result = {std::move(block.values), block.components, block.count, {}};
            block.count = 0;  // taken: no other zone has these ids
            return result;
        }
        if (result.values.empty()) {
            result.components = block.components;
            result.values.grow_to(ids.size() * n);
            if (!gapless || to - from < ids.size()) {
                result.values.fill(not_there);
            }
        }
        if (block.components != result.components) {
            continue;
        }
        if (gapless) {
            std::copy_n(block.values.data() + (from - block.first) * n, (to - from) * n,
                        result.values.data() + (from - first) * n);
            result.found += to - from;
            continue;
        }
        for (std::size_t i = 0; i < ids.size(); ++i) {
            if (ids[i] >= block.first && ids[i] < block.first + block.count) {
                std::copy_n(block.values.data() + (ids[i] - block.first) * n, n, result.values.data() + i * n);
                ++result.found;
            }
        }
    }
    return result;
}

/// The variables that a zone may have, in the order of the file.
std::vector<ZoneValues::Key> ZoneValues::keys_of(const Zone& zone, bool on_cells) const {
    std::vector<Key> keys;
    std::set<Key> seen;
    for (const auto& block : values_) {
        if (block.on_cells == on_cells && (block.zone == 0 || block.zone == zone.id)) {
            Key key{
                block.variable, block.phase,
                block.canonical.empty() ? canonical_name(block.variable) : CanonicalName{block.canonical, block.unit}};
            if (seen.insert(key).second) {
                keys.push_back(std::move(key));
            }
        }
    }
    return keys;
}

/// Arrays of one phase, each under a name of its own, components joined.
void ZoneValues::add_phase(Zone& zone, vtkCellData& data, std::vector<Gathered>&& arrays, const std::string& phase,
                           core::Problems& problems) const {
    std::vector<ArrayPlan> plans;
    for (const auto& array : arrays) {
        plans.push_back({array.info.original_name, array.info.name, array.components});
    }
    settle_names(plans, place_, problems);
    join_components(plans, dimension_, options_, place_, problems);
    struct Vector {
        ArrayInfo info;
        std::size_t count = 0;
        std::array<const Buffer<double>*, 3> parts{};
    };
    std::map<std::string, Vector> vectors;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        ArrayInfo info = arrays[i].info;
        info.name = plans[i].name + phase;
        if (plans[i].component < 0) {
            add_cell_array(zone, data, std::move(info), std::move(arrays[i].values));
            continue;
        }
        info.components = 3;
        auto& vector = vectors[info.name];
        vector.parts[static_cast<std::size_t>(plans[i].component)] = &arrays[i].values;
        if (vector.count == 0) {
            vector.count = arrays[i].values.size();
            vector.info = std::move(info);
        } else {
            vector.info.original_name += ", " + info.original_name;
        }
    }
    for (auto& [name, vector] : vectors) {
        add_cell_array(zone, data, std::move(vector.info), interleaved(vector.parts, vector.count));
    }
}

void ZoneValues::add_to(Zone& zone, vtkCellData& data, const Ids& ids, bool on_cells, const std::vector<double>& areas,
                        core::Problems& problems) {
    std::map<int, std::vector<Gathered>> phases;
    const Span span = span_of(ids);
    for (const auto& key : keys_of(zone, on_cells)) {
        progress_.check();
        const bool shear = key.canonical.name == "wall_shear_force";
        const bool wanted = is_wanted(options_, key.variable, key.canonical.name, phase_suffix(key.phase)) ||
                            (shear && matches_any(options_.arrays, "wall_shear" + phase_suffix(key.phase)));
        Gathered found = wanted ? gather(key, zone.id, on_cells, ids, span) : Gathered{};
        if (found.found == 0) {
            continue;
        }
        if (found.found < ids.size()) {
            problems.push_back({core::Problem::Severity::warning,
                                key.variable + " covers " + std::to_string(found.found) + " of the " +
                                    std::to_string(ids.size()) + (on_cells ? " cells" : " faces") + " of zone " +
                                    zone.name + "; the others are not-a-number",
                                place_});
        }
        if (found.components == 2 && (shear || vector_component(key.canonical.name + "_x"))) {
            found.values = widened(found.values);
            found.components = 3;
        }
        found.info = {
            key.canonical.name, key.canonical.unit, key.variable, "", on_cells ? Location::cells : Location::faces,
            found.components};
        const std::string unit = settled_unit(key.variable, key.canonical.unit, options_, place_, problems);
        if (unit != key.canonical.unit) {
            take_as(found.info, found.values, quantity_in(key.variable, canonical_name(key.variable), unit, place_));
        }
        if (found.info.name == "wall_shear_force" && !on_cells && areas.size() == ids.size()) {
            to_traction(found.values, found.components, areas);
            found.info.name = "wall_shear";
            found.info.unit = "Pa";
            found.info.original_unit = "N";
        }
        phases[key.phase].push_back(std::move(found));
    }
    for (auto& [phase, arrays] : phases) {
        add_phase(zone, data, std::move(arrays), phase_suffix(phase), problems);
    }
}

}  // namespace underbody::postproc
