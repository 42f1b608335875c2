// Cells out of faces.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/parallel.h"
#include "postproc/importers/face_mesh.h"

namespace underbody::postproc {

namespace {

// VTK's numbers, so that this file needs none of its headers.
enum : unsigned char {
    vtk_empty = 0,
    vtk_triangle = 5,
    vtk_polygon = 7,
    vtk_quad = 9,
    vtk_tetra = 10,
    vtk_hexahedron = 12,
    vtk_wedge = 13,
    vtk_pyramid = 14,
    vtk_polyhedron = 42
};

constexpr std::size_t block_of_cells = 8192;

/// One face as a cell sees it.
struct View {
    const std::uint32_t* nodes;
    std::uint32_t size;
    bool inward;  ///< the normal of the stored node order points into the cell

    /// Node i in an order whose normal points into (or out of) the cell.
    [[nodiscard]] std::uint32_t node(std::uint32_t i, bool into) const {
        return nodes[into == inward ? i : size - 1 - i];
    }
    [[nodiscard]] bool has(std::uint32_t n) const { return std::find(nodes, nodes + size, n) != nodes + size; }
};

struct Vector {
    double x = 0, y = 0, z = 0;
};

/// What is kept while the cells of one block are built.
struct Scratch {
    std::vector<View> faces;
    std::vector<std::uint32_t> nodes;
};

/// The neighbour of `node` in a face that is not `other`; 0 when the edge is not in the face.
std::uint32_t across(const View& face, std::uint32_t node, std::uint32_t other) {
    for (std::uint32_t i = 0; i < face.size; ++i) {
        if (face.nodes[i] == node) {
            const std::uint32_t next = face.nodes[(i + 1) % face.size];
            const std::uint32_t before = face.nodes[(i + face.size - 1) % face.size];
            return next == other ? before : before == other ? next : 0;
        }
    }
    return 0;
}

/// Fills the nodes above a base polygon of `sides` edges (hexahedron, wedge); false if the faces are not such a prism.
bool raise(const std::vector<View>& faces, std::size_t base, std::uint32_t sides, std::uint32_t* out) {
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t a = out[i];
        const std::uint32_t b = out[(i + 1) % sides];
        std::uint32_t top = 0;
        for (std::size_t f = 0; f < faces.size() && top == 0; ++f) {
            if (f != base && faces[f].size == 4 && faces[f].has(b)) {
                top = across(faces[f], a, b);
            }
        }
        if (top == 0) {
            return false;
        }
        out[sides + i] = top;
    }
    // The last face must be the lid: exactly the raised nodes.
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (f == base || faces[f].size != sides) {
            continue;
        }
        bool lid = true;
        for (std::uint32_t i = 0; i < sides; ++i) {
            lid = lid && faces[f].has(out[sides + i]);
        }
        if (lid) {
            std::array<std::uint32_t, 8> all{};
            std::copy_n(out, 2 * sides, all.begin());
            std::sort(all.begin(), all.begin() + 2 * sides);
            return std::adjacent_find(all.begin(), all.begin() + 2 * sides) == all.begin() + 2 * sides;
        }
    }
    return false;
}

std::size_t first_of_size(const std::vector<View>& faces, std::uint32_t size) {
    std::size_t f = 0;
    while (f < faces.size() && faces[f].size != size) {
        ++f;
    }
    return f;
}

/// The node of `face` that is none of the `count` in `known`; 0: all are known.
std::uint32_t other_node(const View& face, const std::uint32_t* known, std::uint32_t count) {
    for (std::uint32_t i = 0; i < face.size; ++i) {
        if (std::find(known, known + count, face.nodes[i]) == known + count) {
            return face.nodes[i];
        }
    }
    return 0;
}

/// Is every face made of these nodes only?
bool only(const std::vector<View>& faces, const std::uint32_t* nodes, std::uint32_t count) {
    return std::all_of(faces.begin(), faces.end(),
                       [&](const View& face) { return other_node(face, nodes, count) == 0; });
}

constexpr int fluent_polyhedron = 7;

/// Type of a 3-D cell and, for the standard ones, its nodes in VTK's order.
unsigned char standard_cell(const std::vector<View>& faces, std::array<std::uint32_t, 8>& out) {
    std::size_t triangles = 0;
    std::size_t quads = 0;
    for (const auto& face : faces) {
        triangles += face.size == 3 ? 1 : 0;
        quads += face.size == 4 ? 1 : 0;
    }
    const std::size_t count = faces.size();
    if (triangles + quads != count) {
        return vtk_polyhedron;
    }
    if (count == 6 && quads == 6) {
        for (std::uint32_t i = 0; i < 4; ++i) {
            out[i] = faces[0].node(i, true);
        }
        return raise(faces, 0, 4, out.data()) ? vtk_hexahedron : vtk_polyhedron;
    }
    if (count == 5 && triangles == 2) {
        const std::size_t base = first_of_size(faces, 3);
        for (std::uint32_t i = 0; i < 3; ++i) {
            out[i] = faces[base].node(i, false);  // VTK's wedge: the first triangle looks outward
        }
        return raise(faces, base, 3, out.data()) ? vtk_wedge : vtk_polyhedron;
    }
    const bool pyramid = count == 5 && quads == 1;
    if (pyramid || (count == 4 && triangles == 4)) {
        const std::uint32_t sides = pyramid ? 4 : 3;
        const std::size_t base = first_of_size(faces, sides);
        for (std::uint32_t i = 0; i < sides; ++i) {
            out[i] = faces[base].node(i, true);
        }
        out[sides] = other_node(faces[base == 0 ? 1 : 0], out.data(), sides);
        const bool good = out[sides] != 0 && only(faces, out.data(), sides + 1);
        return !good ? vtk_polyhedron : pyramid ? vtk_pyramid : vtk_tetra;
    }
    return vtk_polyhedron;
}

void unique_nodes(Scratch& scratch) {
    scratch.nodes.clear();
    for (const auto& face : scratch.faces) {
        scratch.nodes.insert(scratch.nodes.end(), face.nodes, face.nodes + face.size);
    }
    std::sort(scratch.nodes.begin(), scratch.nodes.end());
    scratch.nodes.erase(std::unique(scratch.nodes.begin(), scratch.nodes.end()), scratch.nodes.end());
}

/// The edges of a 2-D cell as one ring, counter-clockwise when the cell lies as the file says; false if they do not
/// close.
bool ring(Scratch& scratch) {
    // (-dy, dx) of n0 -> n1 points into the cell: the cell lies to the left, so the stored order runs
    // counter-clockwise.
    const std::size_t count = scratch.faces.size();
    scratch.nodes.clear();
    if (count < 3) {
        return false;
    }
    std::uint32_t at = scratch.faces[0].node(0, true);
    for (std::size_t step = 0; step < count; ++step) {
        scratch.nodes.push_back(at);
        std::size_t next = 0;
        while (next < count && (scratch.faces[next].size != 2 || scratch.faces[next].node(0, true) != at)) {
            ++next;
        }
        if (next == count) {
            return false;
        }
        at = scratch.faces[next].node(1, true);
    }
    return at == scratch.nodes.front();
}

/// Volume and the size of the summed area vector, with the total area.
struct Measure {
    double volume = 0;
    double area = 0;
    double opening = 0;
};

Vector point(const FaceMesh& mesh, std::uint32_t node) {
    const double* p = mesh.points.data() + 3 * (static_cast<std::size_t>(node) - 1);
    return {p[0], p[1], p[2]};
}

/// Divergence theorem, each face at the mean of its nodes (both cells beside a warped face see the same), about the
/// cell's own first node for precision. In 2-D the edges do the same for the area.
Measure measure(const FaceMesh& mesh, const std::vector<View>& faces) {
    Measure result;
    const Vector origin = point(mesh, faces[0].nodes[0]);
    Vector sum;
    for (const auto& face : faces) {
        const Vector a = point(mesh, face.node(0, false));
        const Vector ra{a.x - origin.x, a.y - origin.y, a.z - origin.z};
        if (mesh.dimension == 2) {
            if (face.size != 2) {
                continue;
            }
            const Vector b = point(mesh, face.node(1, false));
            const double nx = -(b.y - a.y);  // out of the cell: the cell lies to the right of the outward order
            const double ny = b.x - a.x;
            result.volume += (ra.x * nx + ra.y * ny) / 2;
            result.area += std::hypot(nx, ny);
            sum = {sum.x + nx, sum.y + ny, 0};
            continue;
        }
        Vector n;
        Vector mean = ra;
        for (std::uint32_t i = 1; i < face.size; ++i) {
            const Vector b = point(mesh, face.node(i, false));
            mean = {mean.x + b.x - origin.x, mean.y + b.y - origin.y, mean.z + b.z - origin.z};
            if (i + 1 == face.size) {
                break;
            }
            const Vector c = point(mesh, face.node(i + 1, false));
            const Vector u{b.x - a.x, b.y - a.y, b.z - a.z};
            const Vector v{c.x - a.x, c.y - a.y, c.z - a.z};
            n = {n.x + (u.y * v.z - u.z * v.y) / 2, n.y + (u.z * v.x - u.x * v.z) / 2,
                 n.z + (u.x * v.y - u.y * v.x) / 2};
        }
        result.volume += (mean.x * n.x + mean.y * n.y + mean.z * n.z) / (3 * face.size);
        result.area += std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        sum = {sum.x + n.x, sum.y + n.y, sum.z + n.z};
    }
    result.opening = std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
    return result;
}

struct Sizes {
    std::uint32_t connectivity = 0;
};

/// Type and sizes of a cell whose faces are in `scratch`; its nodes stay in `scratch.nodes` (VTK's order).
/// What the file calls a polyhedron stays one, even if it has the faces of a hexahedron.
unsigned char shape(int dimension, bool polyhedron, Scratch& scratch, Sizes& sizes) {
    if (scratch.faces.empty()) {
        return vtk_empty;
    }
    unsigned char type = vtk_empty;
    if (dimension == 2) {
        if (!ring(scratch)) {
            return vtk_empty;
        }
        const auto count = scratch.nodes.size();
        type = count == 3 ? vtk_triangle : count == 4 ? vtk_quad : vtk_polygon;
    } else {
        std::array<std::uint32_t, 8> nodes{};
        type = polyhedron ? static_cast<unsigned char>(vtk_polyhedron) : standard_cell(scratch.faces, nodes);
        if (type == vtk_polyhedron) {
            unique_nodes(scratch);
        } else {
            const std::size_t count = type == vtk_hexahedron ? 8 : type == vtk_wedge ? 6 : type == vtk_pyramid ? 5 : 4;
            scratch.nodes.assign(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(count));
        }
    }
    sizes.connectivity = static_cast<std::uint32_t>(scratch.nodes.size());
    return type;
}

/// Number of faces, then per face its number of nodes and these, in an order whose normal points outward.
void append_polyhedron(const Scratch& scratch, std::vector<std::int64_t>& stream) {
    stream.push_back(static_cast<std::int64_t>(scratch.faces.size()));
    for (const auto& face : scratch.faces) {
        stream.push_back(face.size);
        for (std::uint32_t k = 0; k < face.size; ++k) {
            stream.push_back(static_cast<std::int64_t>(face.node(k, false)) - 1);
        }
    }
}

bool in_ranges(const std::vector<IdRange>& ranges, std::uint64_t id) {
    return std::any_of(ranges.begin(), ranges.end(), [&](const IdRange& r) { return id >= r.first && id <= r.last; });
}

/// Ranges that touch a block; usually none, which is then quickly known for each face.
std::vector<IdRange> touching(const std::vector<IdRange>& ranges, const FaceBlock& block) {
    std::vector<IdRange> result;
    for (const auto& range : ranges) {
        if (range.last >= block.first && range.first < block.first + block.count) {
            result.push_back(range);
        }
    }
    return result;
}

}  // namespace

CellBuilder::CellBuilder(const FaceMesh& mesh, core::Progress& progress) : mesh_(mesh) {
    for (const auto& range : mesh.hidden_cells) {
        hidden_cells_.resize(mesh.cells + 1);
        for (std::uint64_t id = range.first; id <= std::min(range.last, mesh.cells); ++id) {
            hidden_cells_[id] = true;
        }
    }
    // Children of a mesh interface are seen by the flux only; the cells end at the faces the mesh was made with.
    std::vector<IdRange> left_out = mesh.hidden_faces;
    left_out.insert(left_out.end(), mesh.interface_children.begin(), mesh.interface_children.end());
    const auto each = [&](const auto& use) {
        std::uint32_t slot = 0;
        for (const auto& block : mesh.face_blocks) {
            progress.check();
            const auto skipped = touching(left_out, block);
            const bool whole = skipped.empty();
            for (std::size_t face = 0; face < block.count && !is_hidden_code(block.kind); ++face) {
                if (block.size_of(face) < 2 || (!whole && in_ranges(skipped, block.first + face))) {
                    continue;
                }
                use(block.c0[face], 2 * (slot + static_cast<std::uint32_t>(face)));
                if (!block.c1.empty()) {
                    use(block.c1[face], 2 * (slot + static_cast<std::uint32_t>(face)) + 1);
                }
            }
            slot += static_cast<std::uint32_t>(block.count);
        }
    };
    std::uint32_t slot = 0;
    for (const auto& block : mesh.face_blocks) {
        slots_.push_back(slot);
        slot += static_cast<std::uint32_t>(block.count);
    }
    // Counting sort: cell 0 ("none") collects what belongs to nobody.
    starts_.grow_to(mesh.cells + 2);
    starts_.fill(0);
    each([&](std::uint32_t cell, std::uint32_t) { ++starts_[cell + 1]; });
    starts_[1] = 0;
    for (std::size_t cell = 2; cell < starts_.size(); ++cell) {
        starts_[cell] += starts_[cell - 1];
    }
    uses_.grow_to(starts_[mesh.cells + 1]);
    each([&](std::uint32_t cell, std::uint32_t use) {
        if (cell != 0) {
            uses_[starts_[cell]++] = use;
        }
    });
    for (std::size_t cell = starts_.size() - 1; cell > 0; --cell) {
        starts_[cell] = starts_[cell - 1];
    }
    starts_[0] = 0;
}

CellArrays CellBuilder::build(const CellBlock& cells, core::Progress& progress) const {
    const auto gather = [&](std::uint64_t cell, Scratch& scratch) {
        scratch.faces.clear();
        if (!hidden_cells_.empty() && hidden_cells_[cell]) {
            return;
        }
        std::size_t block = 0;
        for (std::uint32_t k = starts_[cell]; k < starts_[cell + 1]; ++k) {
            const std::uint32_t slot = uses_[k] / 2;
            if (slot < slots_[block] || (block + 1 < slots_.size() && slot >= slots_[block + 1])) {
                block =
                    static_cast<std::size_t>(std::upper_bound(slots_.begin(), slots_.end(), slot) - slots_.begin()) - 1;
            }
            const FaceBlock& faces = mesh_.face_blocks[block];
            const std::size_t face = slot - slots_[block];
            scratch.faces.push_back(
                {faces.nodes.data() + faces.begin_of(face), faces.size_of(face), uses_[k] % 2 == 0});
        }
    };
    const auto polyhedron = [&](std::size_t i) {
        return (cells.elements.empty() ? cells.element : cells.elements[i]) == fluent_polyhedron;
    };
    const std::size_t count = cells.count;
    Buffer<unsigned char> types(count);
    Buffer<std::uint32_t> lengths(count);
    const std::size_t blocks = (count + block_of_cells - 1) / block_of_cells;
    struct Part {
        std::uint64_t cells = 0, connectivity = 0, stream = 0, inverted = 0, open = 0;
        double volume = 0;
        std::vector<std::int32_t> nodes;  ///< of the block's cells, until they find their place
        std::vector<std::int64_t> faces;
    };
    std::vector<Part> parts(blocks);
    // Cells are built by blocks, whatever the number of threads, and then put one block after another.
    core::parallel_blocks(
        count, block_of_cells,
        [&](std::size_t begin, std::size_t end) {
            Scratch scratch;
            Part part;
            part.nodes.reserve(8 * (end - begin));
            for (std::size_t i = begin; i < end; ++i) {
                gather(cells.first + i, scratch);
                Sizes sizes;
                types[i] = shape(mesh_.dimension, polyhedron(i), scratch, sizes);
                lengths[i] = sizes.connectivity;
                if (scratch.faces.empty()) {
                    continue;
                }
                const Measure m = measure(mesh_, scratch.faces);
                part.volume += m.volume;
                part.inverted += !(m.volume > 0) ? 1 : 0;
                part.open += !(m.opening <= 1e-6 * m.area) ? 1 : 0;
                if (types[i] == vtk_empty) {
                    continue;
                }
                ++part.cells;
                for (const std::uint32_t node : scratch.nodes) {
                    part.nodes.push_back(static_cast<std::int32_t>(node) - 1);
                }
                if (types[i] == vtk_polyhedron) {
                    append_polyhedron(scratch, part.faces);
                }
            }
            part.connectivity = part.nodes.size();
            part.stream = part.faces.size();
            parts[begin / block_of_cells] = std::move(part);
        },
        progress);
    CellArrays out;
    std::vector<Part> starts(blocks);
    Part total;
    for (std::size_t b = 0; b < blocks; ++b) {
        starts[b].cells = total.cells;
        starts[b].connectivity = total.connectivity;
        starts[b].stream = total.stream;
        total.cells += parts[b].cells;
        total.connectivity += parts[b].connectivity;
        total.stream += parts[b].stream;
        out.volume += parts[b].volume;
        out.inverted += parts[b].inverted;
        out.open += parts[b].open;
    }
    if (total.connectivity > 0x7fffffffULL) {
        throw core::InputError("format", "a zone with more than 2^31 corners", {mesh_.file, {}, {}, {}});
    }
    out.types.grow_to(total.cells);
    out.ids.grow_to(total.cells);
    out.offsets.grow_to(total.cells + 1);
    out.connectivity.grow_to(total.connectivity);
    out.face_stream.grow_to(total.stream);
    out.face_locations.grow_to(total.stream > 0 ? total.cells : 0);
    out.offsets[total.cells] = static_cast<std::int32_t>(total.connectivity);
    core::parallel_blocks(
        count, block_of_cells,
        [&](std::size_t begin, std::size_t end) {
            const Part& start = starts[begin / block_of_cells];
            Part& part = parts[begin / block_of_cells];
            std::copy(part.nodes.begin(), part.nodes.end(), out.connectivity.data() + start.connectivity);
            std::copy(part.faces.begin(), part.faces.end(), out.face_stream.data() + start.stream);
            std::size_t cell = start.cells;
            std::uint64_t connectivity = start.connectivity;
            std::uint64_t stream = 0;
            for (std::size_t i = begin; i < end; ++i) {
                if (types[i] == vtk_empty) {
                    continue;
                }
                out.types[cell] = types[i];
                out.ids[cell] = cells.first + i;
                out.offsets[cell] = static_cast<std::int32_t>(connectivity);
                connectivity += lengths[i];
                if (!out.face_locations.empty()) {
                    out.face_locations[cell] =
                        types[i] == vtk_polyhedron ? static_cast<std::int64_t>(start.stream + stream) : -1;
                }
                if (types[i] == vtk_polyhedron) {
                    for (std::int64_t faces = part.faces[stream++]; faces > 0; --faces) {
                        stream += static_cast<std::uint64_t>(part.faces[stream]) + 1;
                    }
                }
                ++cell;
            }
            part = Part{};
        },
        progress);
    return out;
}

}  // namespace underbody::postproc
