// A face mesh with its values becomes zones with VTK data. The values: zone_values.h.
#include <vtkCellData.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>

#include "core/counted.h"
#include "core/text.h"
#include "postproc/importers/fluent/fluent_settings.h"
#include "postproc/importers/fluent/fluent_variables.h"
#include "postproc/importers/mesh/face_cells.h"
#include "postproc/importers/mesh/face_mesh.h"
#include "postproc/importers/mesh/vtk_arrays.h"
#include "postproc/importers/mesh/zone_values.h"

namespace underbody::postproc {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

class Assembly {
public:
    Assembly(FaceMesh& mesh, std::vector<ValueBlock>& values, const ReadOptions& options, core::Progress& progress)
        : mesh_(mesh),
          values_(values),
          zone_values_(values, mesh.file, mesh.dimension, options, progress),
          options_(options),
          progress_(progress) {}

    void add_volumes(Field& field);
    void add_surfaces(Field& field);

private:
    struct Element {
        std::size_t block = 0;
        std::size_t face = 0;
        bool flipped = false;
    };

    [[nodiscard]] Zone named_zone(int id, int code, bool cells) const;
    [[nodiscard]] Buffer<double> picked_points(Buffer<std::int32_t>& nodes, Buffer<std::int64_t>& stream, bool last);
    [[nodiscard]] bool turned(const FaceBlock& block, std::size_t face, bool wall) const;
    [[nodiscard]] std::vector<Element> elements_of(const std::vector<std::size_t>& blocks, bool wall,
                                                   std::size_t& too_small) const;
    [[nodiscard]] double face_area(const Element& element) const;
    [[nodiscard]] std::vector<Element> usable_elements(Zone& zone, int id, const std::vector<std::size_t>& blocks,
                                                       core::Problems& problems) const;
    void add_surface(Field& field, int id, const std::vector<std::size_t>& blocks);
    void take_pressure_of_cells(Zone& zone, const std::vector<Element>& elements, core::Problems& problems) const;
    [[nodiscard]] std::uint64_t hidden_within(const CellBlock& block) const;

    FaceMesh& mesh_;
    const std::vector<ValueBlock>& values_;
    ZoneValues zone_values_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::vector<std::int32_t> place_of_node_;  ///< only for the nodes of the zone at hand
};

Zone Assembly::named_zone(int id, int code, bool cells) const {
    Zone zone;
    zone.id = id;
    const ZoneLabel* label = mesh_.label(id);
    zone.original_kind = label != nullptr && !label->type.empty() ? label->type : cells ? "fluid" : type_of_code(code);
    zone.name = label != nullptr && !label->name.empty() ? label->name : zone.original_kind + "-" + std::to_string(id);
    zone.kind = kind_of_type(zone.original_kind);
    return zone;
}

/// Which of so many nodes are used; small enough to stay near the processor.
class UsedNodes {
public:
    explicit UsedNodes(std::size_t nodes) : words_((nodes + 63) / 64) {}
    void mark(std::int32_t node) { words_[static_cast<std::size_t>(node) / 64] |= std::uint64_t{1} << (node % 64); }
    [[nodiscard]] std::size_t count() const {
        std::size_t sum = 0;
        for (const std::uint64_t word : words_) {
            sum += static_cast<std::size_t>(std::popcount(word));
        }
        return sum;
    }
    /// Calls `act(node)` in order of the nodes.
    template <typename Act>
    void each(Act&& act) const {
        for (std::size_t w = 0; w < words_.size(); ++w) {
            for (std::uint64_t word = words_[w]; word != 0; word &= word - 1) {
                act(64 * w + static_cast<std::size_t>(std::countr_zero(word)));
            }
        }
    }

private:
    std::vector<std::uint64_t> words_;
};

/// The points that `nodes` (from 0) use, in order of their ids; `nodes` and the polyhedra's `stream` become places
/// among these. The `last` zone may take the mesh's own.
Buffer<double> Assembly::picked_points(Buffer<std::int32_t>& nodes, Buffer<std::int64_t>& stream, bool last) {
    UsedNodes used(mesh_.nodes);
    for (const std::int32_t node : nodes) {
        used.mark(node);
    }
    const std::size_t count = used.count();
    Buffer<double> points;
    if (count == mesh_.nodes) {
        if (last) {
            return std::move(mesh_.points);
        }
        points.grow_to(mesh_.points.size());
        std::copy(mesh_.points.begin(), mesh_.points.end(), points.begin());
        return points;
    }
    place_of_node_.resize(mesh_.nodes);
    points.grow_to(3 * count);
    std::int32_t place = 0;
    used.each([&](std::size_t node) {
        std::copy_n(mesh_.points.data() + 3 * node, 3, points.data() + 3 * static_cast<std::size_t>(place));
        place_of_node_[node] = place++;
    });
    for (auto& node : nodes) {
        node = place_of_node_[static_cast<std::size_t>(node)];
    }
    for (std::size_t i = 0; i < stream.size();) {
        for (std::int64_t faces = stream[i++]; faces > 0; --faces) {
            for (std::int64_t corners = stream[i++]; corners > 0; --corners, ++i) {
                stream[i] = place_of_node_[static_cast<std::size_t>(stream[i])];
            }
        }
    }
    return points;
}

/// The stored normal points into c0. Must it be turned to point into the fluid?
bool Assembly::turned(const FaceBlock& block, std::size_t face, bool wall) const {
    const std::uint32_t c0 = block.c0[face];
    const std::uint32_t c1 = block.c1.empty() ? 0 : block.c1[face];
    if (c0 == 0 || c1 == 0) {
        return c0 == 0 && c1 != 0;
    }
    return wall && mesh_.is_solid(c0) && !mesh_.is_solid(c1);
}

std::vector<Assembly::Element> Assembly::elements_of(const std::vector<std::size_t>& blocks, bool wall,
                                                     std::size_t& too_small) const {
    std::vector<Element> elements;
    for (const std::size_t b : blocks) {
        const FaceBlock& block = mesh_.face_blocks[b];
        std::vector<IdRange> hidden;
        for (const auto& range : mesh_.hidden_faces) {
            if (range.last >= block.first && range.first < block.first + block.count) {
                hidden.push_back(range);
            }
        }
        const std::uint32_t least = mesh_.dimension == 2 ? 2 : 3;
        for (std::size_t face = 0; face < block.count; ++face) {
            const std::uint64_t id = block.first + face;
            const bool parent = std::any_of(hidden.begin(), hidden.end(),
                                            [&](const IdRange& r) { return id >= r.first && id <= r.last; });
            if (parent) {
                continue;
            }
            if (block.size_of(face) < least) {
                ++too_small;
                continue;
            }
            elements.push_back({b, face, turned(block, face, wall)});
        }
    }
    return elements;
}

double Assembly::face_area(const Element& element) const {
    const FaceBlock& block = mesh_.face_blocks[element.block];
    const std::uint32_t* nodes = block.nodes.data() + block.begin_of(element.face);
    const std::uint32_t size = block.size_of(element.face);
    const auto at = [&](std::uint32_t i) { return mesh_.points.data() + 3 * (static_cast<std::size_t>(nodes[i]) - 1); };
    if (mesh_.dimension == 2) {
        return std::hypot(at(1)[0] - at(0)[0], at(1)[1] - at(0)[1]);
    }
    std::array<double, 3> sum{};
    for (std::uint32_t i = 1; i + 1 < size; ++i) {
        std::array<double, 3> u{};
        std::array<double, 3> v{};
        for (std::size_t k = 0; k < 3; ++k) {
            u[k] = at(i)[k] - at(0)[k];
            v[k] = at(i + 1)[k] - at(0)[k];
        }
        sum[0] += u[1] * v[2] - u[2] * v[1];
        sum[1] += u[2] * v[0] - u[0] * v[2];
        sum[2] += u[0] * v[1] - u[1] * v[0];
    }
    return std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / 2;
}

vtkSmartPointer<vtkUnstructuredGrid> grid_of(CellArrays&& cells, Buffer<double>&& coordinates) {
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    grid->SetPoints(points_from(std::move(coordinates)));
    vtkNew<vtkCellArray> array;
    array->SetData(given_to_vtk<vtkTypeInt32Array>(std::move(cells.offsets)),
                   given_to_vtk<vtkTypeInt32Array>(std::move(cells.connectivity)));
    const auto types = given_to_vtk<vtkUnsignedCharArray>(std::move(cells.types));
    if (cells.face_locations.empty()) {
        grid->SetCells(types, array);
    } else {
        grid->SetCells(types, array, given_to_vtk<vtkIdTypeArray>(std::move(cells.face_locations)),
                       given_to_vtk<vtkIdTypeArray>(std::move(cells.face_stream)));
    }
    return grid;
}

namespace {

/// Cells of a type that there is not: the mesh may be damaged.
void note_strange_cells(const CellBlock& block, const std::string& zone, const core::Place& place,
                        core::Problems& problems) {
    constexpr int last_known = 7;  // polyhedra
    const int strange =
        block.elements.empty() ? block.element : *std::max_element(block.elements.begin(), block.elements.end());
    if (strange > last_known) {
        problems.push_back({core::Problem::Severity::warning,
                            "cells of zone '" + zone + "' are said to be of type " + std::to_string(strange) +
                                ", and there are 0 to 7: is the mesh damaged? They are put together from their faces",
                            place});
    }
}

}  // namespace

void Assembly::add_volumes(Field& field) {
    std::vector<const CellBlock*> wanted;
    for (const auto& block : mesh_.cell_blocks) {
        if (!block.parents && block.count > 0 && matches_any(options_.zones, named_zone(block.zone, 0, true).name)) {
            wanted.push_back(&block);
        }
    }
    if (wanted.empty()) {
        return;
    }
    if (mesh_.cell_faces.starts.empty()) {
        gather_cell_faces(mesh_, progress_);
    }
    const CellBuilder builder(mesh_);
    const core::Place place{mesh_.file, {}, {}, {}};
    for (const CellBlock* block : wanted) {
        note_strange_cells(*block, named_zone(block->zone, 0, true).name, place, field.problems);
        const bool last = block == wanted.back();
        Zone zone = named_zone(block->zone, 0, true);
        progress_.report(0.7, "building " + zone.name);
        CellArrays cells = builder.build(*block, progress_);
        const auto note = [&](std::uint64_t count, const char* one, const char* several) {
            if (count > 0) {
                field.problems.push_back(
                    {core::Problem::Severity::warning,
                     core::counted(count, "cell") + " of zone " + zone.name + (count == 1 ? one : several), place});
            }
        };
        note(cells.inverted, " has no positive volume", " have no positive volume");
        note(cells.open, " is not closed by its faces", " are not closed by their faces");
        note(block->count - cells.types.size() - hidden_within(*block), " has no faces and is left out",
             " have no faces and are left out");
        field.metadata.emplace_back((mesh_.dimension == 2 ? "area of " : "volume of ") + zone.name,
                                    core::format_number(cells.volume));
        if (last) {
            mesh_.face_blocks.clear();
            mesh_.cell_faces = {};
        }
        const Ids ids = std::move(cells.ids);
        auto coordinates = picked_points(cells.connectivity, cells.face_stream, last);
        zone.volume = grid_of(std::move(cells), std::move(coordinates));
        zone_values_.add_to(zone, *zone.volume->GetCellData(), ids, true, {}, field.problems);
        field.zones.push_back(std::move(zone));
    }
}

/// The faces of a boundary zone that can be drawn; notes what is left out. A wall of solids alone is made a solid's.
std::vector<Assembly::Element> Assembly::usable_elements(Zone& zone, int id, const std::vector<std::size_t>& blocks,
                                                         core::Problems& problems) const {
    std::size_t too_small = 0;
    auto elements = elements_of(blocks, zone.kind == ZoneKind::wall, too_small);
    if (too_small > 0 && zone.kind == ZoneKind::interface && elements.empty()) {
        problems.push_back({core::Problem::Severity::warning,
                            "the faces of interface '" + zone.name +
                                "' have no corners in the file, only the cells beside them: it is left out",
                            {mesh_.file, {}, {}, {}}});
        return {};
    }
    if (too_small > 0) {
        problems.push_back({core::Problem::Severity::error,
                            core::counted(too_small, "face") + " of zone '" + zone.name +
                                (too_small == 1 ? "' has fewer corners than a face can have, and is left out"
                                                : "' have fewer corners than a face can have, and are left out") +
                                ": is the mesh damaged?",
                            {mesh_.file, {}, {}, {}}});
    }
    if (elements.empty()) {
        problems.push_back(
            {core::Problem::Severity::note, "zone " + zone.name + " has no faces", {mesh_.file, {}, {}, {}}});
        return {};
    }
    if (zone.kind == ZoneKind::wall && mesh_.bounds_solids(id)) {
        zone.kind = ZoneKind::solid;
        problems.push_back({core::Problem::Severity::note,
                            "wall '" + zone.name + "' bounds solids alone: no fluid acts on it",
                            {mesh_.file, {}, {}, {}}});
    }
    return elements;
}

void Assembly::add_surface(Field& field, int id, const std::vector<std::size_t>& blocks) {
    Zone zone = named_zone(id, mesh_.face_blocks[blocks.front()].kind, false);
    if (!matches_any(options_.zones, zone.name)) {
        return;
    }
    const std::vector<Element> elements = usable_elements(zone, id, blocks, field.problems);
    if (elements.empty()) {
        return;
    }
    std::size_t corners = 0;
    for (const auto& element : elements) {
        corners += mesh_.face_blocks[element.block].size_of(element.face);
    }
    Buffer<std::uint64_t> listed(elements.size());
    Buffer<std::int32_t> offsets(elements.size() + 1);
    Buffer<std::int32_t> connectivity(corners);
    std::vector<double> areas(elements.size());
    std::size_t at = 0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
        const auto& [b, face, flipped] = elements[i];
        const FaceBlock& block = mesh_.face_blocks[b];
        const std::uint32_t* nodes = block.nodes.data() + block.begin_of(face);
        const std::uint32_t size = block.size_of(face);
        listed[i] = block.first + face;
        areas[i] = face_area(elements[i]);
        offsets[i] = static_cast<std::int32_t>(at);
        for (std::uint32_t k = 0; k < size; ++k) {
            connectivity[at++] = static_cast<std::int32_t>(nodes[flipped ? size - 1 - k : k]) - 1;
        }
    }
    offsets[elements.size()] = static_cast<std::int32_t>(at);
    const Ids ids(std::move(listed));
    Buffer<std::int64_t> no_stream;
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    zone.surface->SetPoints(points_from(picked_points(connectivity, no_stream, false)));
    vtkNew<vtkCellArray> array;
    array->SetData(given_to_vtk<vtkTypeInt32Array>(std::move(offsets)),
                   given_to_vtk<vtkTypeInt32Array>(std::move(connectivity)));
    if (mesh_.dimension == 2) {
        zone.surface->SetLines(array);
    } else {
        zone.surface->SetPolys(array);
    }
    zone_values_.add_to(zone, *zone.surface->GetCellData(), ids, false, areas, field.problems);
    if (zone.kind == ZoneKind::wall && zone.find("pressure") == nullptr) {
        take_pressure_of_cells(zone, elements, field.problems);
    }
    field.zones.push_back(std::move(zone));
}

/// The last resort for a wall whose faces have no pressure of their own.
void Assembly::take_pressure_of_cells(Zone& zone, const std::vector<Element>& elements,
                                      core::Problems& problems) const {
    Buffer<double> values(elements.size());
    values.fill(missing);
    std::size_t found = 0;
    for (const auto& block : values_) {
        if (!block.on_cells || block.variable != pressure_variable || block.phase != 1 || block.components != 1) {
            continue;
        }
        for (std::size_t i = 0; i < elements.size(); ++i) {
            const FaceBlock& faces = mesh_.face_blocks[elements[i].block];
            const std::size_t face = elements[i].face;
            const std::uint32_t cell = elements[i].flipped ? faces.c1[face] : faces.c0[face];
            if (cell >= block.first && cell < block.first + block.count) {
                values[i] = block.values[cell - block.first];
                ++found;
            }
        }
    }
    if (found == 0) {
        return;
    }
    problems.push_back({core::Problem::Severity::warning,
                        "zone " + zone.name + " has no pressure on its faces: that of the cells beside it is taken" +
                            (found < elements.size() ? ", for " + std::to_string(found) + " of its " +
                                                           std::to_string(elements.size()) + " faces"
                                                     : ""),
                        {mesh_.file, {}, {}, {}}});
    add_cell_array(zone, *zone.surface->GetCellData(), {"pressure", "Pa", pressure_variable, "", Location::cells, 1},
                   std::move(values));
}

void Assembly::add_surfaces(Field& field) {
    std::vector<int> order;
    std::map<int, std::vector<std::size_t>> zones;
    for (std::size_t b = 0; b < mesh_.face_blocks.size(); ++b) {
        const FaceBlock& block = mesh_.face_blocks[b];
        if (is_inner_code(block.kind) || is_hidden_code(block.kind)) {
            continue;
        }
        auto& list = zones[block.zone];
        if (list.empty()) {
            order.push_back(block.zone);
        }
        list.push_back(b);
    }
    for (const int id : order) {
        progress_.check();
        add_surface(field, id, zones[id]);
    }
}

std::uint64_t Assembly::hidden_within(const CellBlock& block) const {
    std::uint64_t count = 0;
    for (const auto& range : mesh_.hidden_cells) {
        const std::uint64_t first = std::max(range.first, block.first);
        const std::uint64_t last = std::min(range.last, block.first + block.count - 1);
        count += last >= first ? last - first + 1 : 0;
    }
    return count;
}

}  // namespace

Field field_from(FaceMesh&& mesh, std::vector<ValueBlock>&& values, const ReadOptions& options,
                 core::Progress& progress) {
    Field field;
    field.files.push_back(mesh.file);
    field.dimension = mesh.dimension;
    field.metadata.emplace_back("mesh", std::to_string(std::max(mesh.nodes, mesh.declared_nodes)) + " nodes, " +
                                            std::to_string(mesh.faces) + " faces, " + std::to_string(mesh.cells) +
                                            " cells");
    scale_lengths(mesh, options, field);
    Assembly assembly(mesh, values, options, progress);
    std::vector<Zone> surfaces;
    assembly.add_surfaces(field);
    surfaces.swap(field.zones);
    if (!options.surfaces_only) {
        assembly.add_volumes(field);
    }
    std::move(surfaces.begin(), surfaces.end(), std::back_inserter(field.zones));
    return field;
}

}  // namespace underbody::postproc
