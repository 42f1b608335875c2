#include "postproc/importers/mesh/element_zone.h"

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>

#include "core/counted.h"
#include "postproc/importers/mesh/array_names.h"
#include "postproc/importers/mesh/variable_reading.h"
#include "postproc/importers/mesh/vtk_arrays.h"

namespace underbody::postproc {

namespace {

int dimension_of(unsigned char type) {
    switch (type) {
        case VTK_VERTEX:
            return 0;
        case VTK_LINE:
        case VTK_QUADRATIC_EDGE:
            return 1;
        case VTK_TRIANGLE:
        case VTK_QUAD:
        case VTK_POLYGON:
        case VTK_QUADRATIC_TRIANGLE:
        case VTK_QUADRATIC_QUAD:
            return 2;
        default:
            return 3;
    }
}

/// Orders of nodes that turn a linear cell inside out.
const std::vector<int>* turned_order(unsigned char type) {
    static const std::vector<int> tetrahedron = {0, 2, 1, 3};
    static const std::vector<int> pyramid = {0, 3, 2, 1, 4};
    static const std::vector<int> wedge = {0, 2, 1, 3, 5, 4};
    static const std::vector<int> hexahedron = {4, 5, 6, 7, 0, 1, 2, 3};
    switch (type) {
        case VTK_TETRA:
            return &tetrahedron;
        case VTK_PYRAMID:
            return &pyramid;
        case VTK_WEDGE:
            return &wedge;
        case VTK_HEXAHEDRON:
            return &hexahedron;
        default:
            return nullptr;
    }
}

/// Six times the signed volume of one or several tetrahedra that lie in the cell.
double signed_volume(const double* points, const std::int64_t* n, unsigned char type) {
    const auto tetrahedron = [&](int a, int b, int c, int d) {
        std::array<std::array<double, 3>, 3> e{};
        const int ends[3] = {b, c, d};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                e[i][k] = points[3 * n[ends[i]] + static_cast<std::int64_t>(k)] -
                          points[3 * n[a] + static_cast<std::int64_t>(k)];
            }
        }
        return (e[0][1] * e[1][2] - e[0][2] * e[1][1]) * e[2][0] + (e[0][2] * e[1][0] - e[0][0] * e[1][2]) * e[2][1] +
               (e[0][0] * e[1][1] - e[0][1] * e[1][0]) * e[2][2];
    };
    switch (type) {
        case VTK_TETRA:
            return tetrahedron(0, 1, 2, 3);
        case VTK_PYRAMID:
            return tetrahedron(0, 1, 2, 4) + tetrahedron(0, 2, 3, 4);
        // VTK's wedge has its first triangle look outward.
        case VTK_WEDGE:
            return -(tetrahedron(0, 1, 2, 3) + tetrahedron(1, 2, 3, 4) + tetrahedron(2, 3, 4, 5));
        case VTK_HEXAHEDRON:
            return tetrahedron(0, 1, 3, 4) + tetrahedron(1, 2, 3, 6) + tetrahedron(1, 6, 4, 5) +
                   tetrahedron(3, 4, 6, 7) + tetrahedron(1, 3, 4, 6);
        default:
            return 1;
    }
}

/// The elements of one dimension out of a part, with the places they had.
struct Chosen {
    std::vector<std::size_t> places;
    std::size_t left_out = 0;
};

Chosen choose(const ElementPart& part, int dimension) {
    Chosen chosen;
    for (std::size_t i = 0; i < part.elements(); ++i) {
        if (dimension_of(part.types[i]) == dimension) {
            chosen.places.push_back(i);
        } else {
            ++chosen.left_out;
        }
    }
    return chosen;
}

/// Cells, corners first: a surface shows quadratic elements by their corners.
vtkSmartPointer<vtkCellArray> cells_of(const ElementPart& part, const std::vector<std::size_t>& places, bool corners) {
    auto cells = vtkSmartPointer<vtkCellArray>::New();
    for (const std::size_t i : places) {
        auto count = static_cast<vtkIdType>(part.offsets[i + 1] - part.offsets[i]);
        if (corners) {
            const unsigned char type = part.types[i];
            count = type == VTK_QUADRATIC_TRIANGLE ? 3
                    : type == VTK_QUADRATIC_QUAD   ? 4
                    : type == VTK_QUADRATIC_EDGE   ? 2
                                                   : count;
        }
        cells->InsertNextCell(static_cast<int>(count));
        for (vtkIdType k = 0; k < count; ++k) {
            cells->InsertCellPoint(part.nodes[static_cast<std::size_t>(part.offsets[i]) + static_cast<std::size_t>(k)]);
        }
    }
    return cells;
}

vtkSmartPointer<vtkUnstructuredGrid> grid_of(ElementPart& part, const std::vector<std::size_t>& places) {
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    grid->SetPoints(points_from(std::move(part.points)));
    Buffer<unsigned char> types(places.size());
    Buffer<std::int64_t> locations(part.polyhedra.empty() ? 0 : places.size());
    Buffer<std::int64_t> stream(part.polyhedra.size());
    std::copy(part.polyhedra.begin(), part.polyhedra.end(), stream.begin());
    std::size_t at = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        types[i] = part.types[places[i]];
        if (locations.empty()) {
            continue;
        }
        locations[i] = -1;
        if (types[i] == VTK_POLYHEDRON) {
            locations[i] = static_cast<std::int64_t>(at);
            for (std::int64_t faces = stream[at++]; faces > 0; --faces) {
                at += static_cast<std::size_t>(stream[at]) + 1;
            }
        }
    }
    const auto cells = cells_of(part, places, false);
    if (locations.empty()) {
        grid->SetCells(given_to_vtk<vtkUnsignedCharArray>(std::move(types)), cells);
    } else {
        grid->SetCells(given_to_vtk<vtkUnsignedCharArray>(std::move(types)), cells,
                       given_to_vtk<vtkIdTypeArray>(std::move(locations)),
                       given_to_vtk<vtkIdTypeArray>(std::move(stream)));
    }
    return grid;
}

struct Named {
    ArrayInfo info;
    Buffer<double> values;
    bool on_nodes = true;
};

/// What the values of a part on its nodes, or on its elements, become.
class Naming {
public:
    Naming(const std::string& file, const ReadOptions& options, core::Problems& problems)
        : place_{file, {}, {}, {}}, options_(options), problems_(problems) {}

    /// Of `count` nodes or elements; in SI, components joined. Throws InputError where there are more or fewer values.
    std::vector<Named> named(std::vector<PartValues*> values, Location on, std::size_t count, const std::string& zone,
                             int dimension) {
        std::vector<VariableReading> readings;
        std::vector<ArrayPlan> plans;
        for (const PartValues* entry : values) {
            readings.push_back(reading_of(*entry));
            plans.push_back({readings.back().own, readings.back().name, entry->components});
        }
        settle_names(plans, place_, problems_);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!is_wanted(options_, values[i]->variable, plans[i].name)) {
                plans[i].name.clear();
            }
        }
        join_components(plans, dimension, options_, place_, problems_);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!plans[i].name.empty()) {
                check_count(*values[i], count, zone);
                convert(values[i]->values, readings[i].convert);
            }
        }
        std::vector<Named> arrays;
        std::map<std::string, std::size_t> vectors;  // places in them
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (plans[i].name.empty()) {
                continue;
            }
            PartValues& entry = *values[i];
            ArrayInfo info{plans[i].name,   readings[i].unit, entry.variable, readings[i].original_unit, on,
                           entry.components};
            if (plans[i].component < 0) {
                arrays.push_back({std::move(info), std::move(entry.values), on == Location::nodes});
                continue;
            }
            const auto [found, is_new] = vectors.emplace(plans[i].name, arrays.size());
            if (is_new) {
                info.components = 3;
                arrays.push_back({std::move(info), interleaved(parts_of(plans[i].name, plans, values), count),
                                  on == Location::nodes});
            } else {
                arrays[found->second].info.original_name += ", " + entry.variable;
            }
        }
        return arrays;
    }

private:
    VariableReading reading_of(const PartValues& entry) {
        VariableReading reading = read_variable_name(entry.variable, options_, place_, problems_);
        if (entry.components == 1) {
            reading.name = named_as_scalar({reading.name, reading.unit}).name;
        }
        return reading;
    }

    static void convert(Buffer<double>& values, const core::Conversion& conversion) {
        if (!conversion.is_identity()) {
            std::for_each(values.begin(), values.end(), [&](double& value) { value = conversion(value); });
        }
    }

    void check_count(const PartValues& entry, std::size_t count, const std::string& zone) const {
        const std::size_t expected = count * static_cast<std::size_t>(entry.components);
        if (entry.values.size() != expected) {
            throw core::InputError("format",
                                   entry.variable + " has " + std::to_string(entry.values.size()) + " values on zone " +
                                       zone + ", which wants " + std::to_string(expected),
                                   place_);
        }
    }

    static std::array<const Buffer<double>*, 3> parts_of(const std::string& vector, const std::vector<ArrayPlan>& plans,
                                                         const std::vector<PartValues*>& values) {
        std::array<const Buffer<double>*, 3> parts{};
        for (std::size_t i = 0; i < plans.size(); ++i) {
            if (plans[i].name == vector && plans[i].component >= 0) {
                parts[static_cast<std::size_t>(plans[i].component)] = &values[i]->values;
            }
        }
        return parts;
    }

    core::Place place_;
    const ReadOptions& options_;
    core::Problems& problems_;
};

std::vector<Named> all_named(std::vector<PartValues>&& values, bool cells, std::size_t nodes, std::size_t elements,
                             const std::string& zone, int dimension, Naming naming) {
    std::array<std::vector<PartValues*>, 2> places;  // on elements, on nodes
    for (auto& entry : values) {
        places[entry.on_nodes ? 1 : 0].push_back(&entry);
    }
    std::vector<Named> arrays = naming.named(places[1], Location::nodes, nodes, zone, dimension);
    std::vector<Named> others =
        naming.named(places[0], cells ? Location::cells : Location::faces, elements, zone, dimension);
    std::move(others.begin(), others.end(), std::back_inserter(arrays));
    return arrays;
}

}  // namespace

int ElementPart::dimension() const {
    int most = 0;
    for (const unsigned char type : types) {
        most = std::max(most, dimension_of(type));
    }
    return most;
}

std::int64_t turn_inverted_cells(ElementPart& part) {
    // A writer's order is the same for all cells of a kind: most of their volumes tell it, whatever single cells do.
    std::array<double, 256> sums{};
    for (std::size_t i = 0; i < part.elements(); ++i) {
        if (turned_order(part.types[i]) != nullptr) {
            const double volume = signed_volume(part.points.data(), part.nodes.data() + part.offsets[i], part.types[i]);
            sums[part.types[i]] += volume > 0 ? 1 : volume < 0 ? -1 : 0;
        }
    }
    std::int64_t turned = 0;
    std::array<std::int64_t, 8> before{};
    for (std::size_t i = 0; i < part.elements(); ++i) {
        const auto* order = turned_order(part.types[i]);
        if (order == nullptr || sums[part.types[i]] >= 0) {
            continue;
        }
        std::int64_t* nodes = part.nodes.data() + part.offsets[i];
        std::copy_n(nodes, order->size(), before.begin());
        for (std::size_t k = 0; k < order->size(); ++k) {
            nodes[k] = before[static_cast<std::size_t>((*order)[k])];
        }
        ++turned;
    }
    return turned;
}

/// The surface, lines or points of a zone.
void add_surface(Zone& zone, ElementPart& part, const Chosen& chosen, int dimension, int volume_dimension) {
    zone.surface = vtkSmartPointer<vtkPolyData>::New();
    const auto cells = cells_of(part, chosen.places, true);
    zone.surface->SetPoints(points_from(std::move(part.points)));
    if (dimension == 2) {
        zone.surface->SetPolys(cells);
    } else if (dimension == 1) {
        zone.surface->SetLines(cells);
        zone.kind = zone.kind == ZoneKind::unknown && volume_dimension == 3 ? ZoneKind::line : zone.kind;
    } else {
        zone.surface->SetVerts(cells);
        zone.kind = ZoneKind::points;
    }
}

Buffer<double> kept_values(const Buffer<double>& values, const std::vector<std::size_t>& places, std::size_t n) {
    Buffer<double> kept(places.size() * n);
    for (std::size_t i = 0; i < places.size(); ++i) {
        std::copy_n(values.data() + places[i] * n, n, kept.data() + i * n);
    }
    return kept;
}

Zone zone_from(ElementPart&& part, std::vector<PartValues>&& values, int volume_dimension, const ReadOptions& options,
               const std::string& file, core::Problems& problems) {
    Zone zone;
    zone.name = part.name;
    zone.id = part.id;
    zone.kind = part.kind;
    zone.original_kind = part.original_kind;
    zone.normals_into_fluid = false;
    const int dimension = part.dimension();
    const bool volume = dimension == volume_dimension && dimension >= 2;
    const Chosen chosen = choose(part, dimension);
    if (chosen.left_out > 0) {
        problems.push_back({core::Problem::Severity::warning,
                            "zone " + zone.name + ": " + core::counted(chosen.left_out, "element") +
                                " of lower dimension than the others " + (chosen.left_out == 1 ? "is" : "are") +
                                " left out",
                            {file, {}, {}, {}}});
    }
    if (zone.kind == ZoneKind::unknown && volume) {
        zone.kind = ZoneKind::fluid;
    }
    const std::size_t all_elements = part.elements();
    const std::size_t all_nodes = part.points.size() / 3;
    vtkDataSetAttributes* cell_data = nullptr;
    vtkDataSetAttributes* point_data = nullptr;
    if (volume) {
        turn_inverted_cells(part);
        zone.volume = grid_of(part, chosen.places);
        cell_data = zone.volume->GetCellData();
        point_data = zone.volume->GetPointData();
    } else {
        add_surface(zone, part, chosen, dimension, volume_dimension);
        cell_data = zone.surface->GetCellData();
        point_data = zone.surface->GetPointData();
    }
    for (auto& named : all_named(std::move(values), volume, all_nodes, all_elements, zone.name, volume_dimension,
                                 Naming(file, options, problems))) {
        const auto n = static_cast<std::size_t>(named.info.components);
        if (!named.on_nodes && chosen.left_out > 0) {
            named.values = kept_values(named.values, chosen.places, n);
        }
        auto array = given_to_vtk<vtkDoubleArray>(std::move(named.values), named.info.components);
        array->SetName(named.info.name.c_str());
        name_tensor_components(*array);
        (named.on_nodes ? point_data : cell_data)->AddArray(array);
        zone.arrays.push_back(std::move(named.info));
    }
    return zone;
}

void scale_parts(std::vector<ElementPart>& parts, const ReadOptions& options, Field& field) {
    const core::Place place{field.files.empty() ? std::string() : field.files.front(), {}, {}, {}};
    if (options.length_unit.empty()) {
        field.problems.push_back({core::Problem::Severity::note,
                                  "the file states no units; lengths are taken as metres (a length unit can be given)",
                                  place});
        field.metadata.emplace_back("length unit", "not stated, taken as m");
        return;
    }
    const double scale = core::conversion(options.length_unit, "m", place).scale;
    for (auto& part : parts) {
        for (double& x : part.points) {
            x *= scale;
        }
    }
}

}  // namespace underbody::postproc
