#include "postproc/importers/mesh/face_cells.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "core/parallel.h"
#include "postproc/importers/mesh/cell_shapes.h"

namespace underbody::postproc {

namespace {

constexpr std::size_t block_of_cells = 8192;
constexpr int fluent_polyhedron = 7;

/// Corners of a zone's cells when they are all of one of Fluent's kinds; 0: they differ, or are polyhedra.
std::uint32_t corners_of(int element) {
    static constexpr std::array<std::uint32_t, 7> corners = {0, 3, 4, 4, 8, 5, 6};
    return element > 0 && element < 7 ? corners[static_cast<std::size_t>(element)] : 0;
}

/// Number of faces, then per face its number of nodes and these, in an order whose normal points outward.
void append_polyhedron(const CellShape& cell, std::vector<std::int64_t>& stream) {
    stream.push_back(static_cast<std::int64_t>(cell.faces.size()));
    for (const auto& face : cell.faces) {
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

void gather_cell_faces(FaceMesh& mesh, core::Progress& progress) {
    check_cells_beside(mesh, progress);
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
    // Counting sort: cell 0 ("none") collects what belongs to nobody.
    Buffer<std::uint32_t> starts(mesh.cells + 2);
    starts.fill(0);
    each([&](std::uint32_t cell, std::uint32_t) { ++starts[cell + 1]; });
    starts[1] = 0;
    for (std::size_t cell = 2; cell < starts.size(); ++cell) {
        starts[cell] += starts[cell - 1];
    }
    Buffer<std::uint32_t> uses(starts[mesh.cells + 1]);
    each([&](std::uint32_t cell, std::uint32_t use) {
        if (cell != 0) {
            uses[starts[cell]++] = use;
        }
    });
    for (std::size_t cell = starts.size() - 1; cell > 0; --cell) {
        starts[cell] = starts[cell - 1];
    }
    starts[0] = 0;
    mesh.cell_faces = {std::move(starts), std::move(uses)};
    for (auto& block : mesh.face_blocks) {
        if (is_inner_code(block.kind)) {
            block.c0.clear();
            block.c1.clear();
        }
    }
}

CellBuilder::CellBuilder(const FaceMesh& mesh) : mesh_(mesh) {
    for (const auto& range : mesh.hidden_cells) {
        hidden_cells_.resize(mesh.cells + 1);
        for (std::uint64_t id = range.first; id <= std::min(range.last, mesh.cells); ++id) {
            hidden_cells_[id] = true;
        }
    }
    std::uint32_t slot = 0;
    for (const auto& block : mesh.face_blocks) {
        slots_.push_back(slot);
        slot += static_cast<std::uint32_t>(block.count);
    }
}

/// The faces of one cell; none for a hidden one.
void CellBuilder::gather(std::uint64_t cell, CellShape& shape) const {
    shape.faces.clear();
    if (!hidden_cells_.empty() && hidden_cells_[cell]) {
        return;
    }
    std::size_t block = 0;
    const auto& [starts, uses] = mesh_.cell_faces;
    for (std::uint32_t k = starts[cell]; k < starts[cell + 1]; ++k) {
        const std::uint32_t slot = uses[k] / 2;
        if (slot < slots_[block] || (block + 1 < slots_.size() && slot >= slots_[block + 1])) {
            block = static_cast<std::size_t>(std::upper_bound(slots_.begin(), slots_.end(), slot) - slots_.begin()) - 1;
        }
        const FaceBlock& faces = mesh_.face_blocks[block];
        const std::size_t face = slot - slots_[block];
        shape.faces.push_back({faces.nodes.data() + faces.begin_of(face), faces.size_of(face), uses[k] % 2 == 0});
    }
}

/// What is summed over cells, block by block, so that it does not depend on the threads.
struct CellBuilder::Tally {
    double volume = 0;
    std::uint64_t inverted = 0, open = 0;

    void add(const CellShape& cell, const FaceMesh& mesh) {
        if (cell.faces.empty()) {
            return;
        }
        const CellSize size = size_of(cell, mesh.points.data(), mesh.dimension);
        volume += size.volume;
        inverted += !(size.volume > 0) ? 1 : 0;
        open += !(size.opening <= 1e-6 * size.area) ? 1 : 0;
    }
    void into(CellArrays& out) const {
        out.volume += volume;
        out.inverted += inverted;
        out.open += open;
    }
};

CellArrays CellBuilder::build(const CellBlock& cells, core::Progress& progress) const {
    CellArrays out;
    const std::uint32_t corners = common_corners(cells);
    if (corners == 0 || !build_alike(cells, corners, out, progress)) {
        out = build_any(cells, progress);
    }
    return out;
}

/// How many corners each cell of the zone has, by what the file says or by some of them; 0: they differ, or some are
/// polyhedra or hidden.
std::uint32_t CellBuilder::common_corners(const CellBlock& cells) const {
    if (!cells.elements.empty() || !hidden_cells_.empty() || cells.element != 0 || cells.count == 0) {
        return cells.elements.empty() && hidden_cells_.empty() ? corners_of(cells.element) : 0;
    }
    constexpr std::uint64_t samples = 64;
    CellShape cell;
    std::size_t corners = 0;
    for (std::uint64_t i = 0; i < samples; ++i) {
        gather(cells.first + i * (cells.count - 1) / (samples - 1), cell);
        recognise(cell, mesh_.dimension, false);
        corners = i == 0 ? cell.nodes.size() : corners;
        if (cell.type == vtk_empty || cell.type == vtk_polyhedron || cell.nodes.size() != corners) {
            return 0;
        }
    }
    return static_cast<std::uint32_t>(corners);
}

/// Cells that all have so many corners find their place at once. False: some are of another kind.
bool CellBuilder::build_alike(const CellBlock& cells, std::uint32_t corners, CellArrays& out,
                              core::Progress& progress) const {
    const std::size_t count = cells.count;
    check_corners(count * corners);
    out.types.grow_to(count);
    out.ids = Ids(cells.first, count);
    out.offsets.grow_to(count + 1);
    out.connectivity.grow_to(count * corners);
    out.offsets[count] = static_cast<std::int32_t>(count * corners);
    std::vector<Tally> tallies((count + block_of_cells - 1) / block_of_cells);
    std::atomic<bool> alike = true;
    core::parallel_blocks(
        count, block_of_cells,
        [&](std::size_t begin, std::size_t end) {
            CellShape cell;
            Tally tally;
            std::int32_t* nodes = out.connectivity.data() + begin * corners;
            for (std::size_t i = begin; i < end && alike; ++i) {
                gather(cells.first + i, cell);
                recognise(cell, mesh_.dimension, false);
                if (cell.nodes.size() != corners || cell.type == vtk_empty || cell.type == vtk_polyhedron) {
                    alike = false;
                    return;
                }
                tally.add(cell, mesh_);
                for (const std::uint32_t node : cell.nodes) {
                    *nodes++ = static_cast<std::int32_t>(node) - 1;
                }
                out.types[i] = cell.type;
                out.offsets[i] = static_cast<std::int32_t>(i * corners);
            }
            tallies[begin / block_of_cells] = tally;
        },
        progress);
    if (!alike) {
        return false;
    }
    for (const auto& tally : tallies) {
        tally.into(out);
    }
    return true;
}

void CellBuilder::check_corners(std::uint64_t corners) const {
    if (corners > 0x7fffffffULL) {
        throw core::InputError("format", "a zone with more than 2^31 corners", {mesh_.file, {}, {}, {}});
    }
}

namespace {

/// What a block of cells gives: its part of the arrays, until it is known where they begin.
struct CellPart {
    std::uint64_t cells = 0, connectivity = 0, stream = 0;
    std::vector<std::int32_t> nodes;
    std::vector<std::int64_t> faces;
};

/// Where each block's part begins in the arrays; the last entry is behind all.
std::vector<CellPart> starts_of(const std::vector<CellPart>& parts) {
    std::vector<CellPart> starts(parts.size() + 1);
    for (std::size_t b = 0; b < parts.size(); ++b) {
        starts[b + 1].cells = starts[b].cells + parts[b].cells;
        starts[b + 1].connectivity = starts[b].connectivity + parts[b].connectivity;
        starts[b + 1].stream = starts[b].stream + parts[b].stream;
    }
    return starts;
}

/// Puts the part of the cells from `begin` to `end` where it belongs. `first` is the id of cell 0.
void put_part(CellArrays& out, const CellPart& part, const CellPart& start, std::size_t begin, std::size_t end,
              const Buffer<unsigned char>& types, const Buffer<std::uint32_t>& lengths, Buffer<std::uint64_t>& listed,
              std::uint64_t first) {
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
        if (!listed.empty()) {
            listed[cell] = first + i;
        }
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
}

}  // namespace

/// Cells of any kind are built by blocks, and then put one block after another.
CellArrays CellBuilder::build_any(const CellBlock& cells, core::Progress& progress) const {
    const auto polyhedron = [&](std::size_t i) {
        return (cells.elements.empty() ? cells.element : cells.elements[i]) == fluent_polyhedron;
    };
    const std::size_t count = cells.count;
    Buffer<unsigned char> types(count);
    Buffer<std::uint32_t> lengths(count);
    const std::size_t blocks = (count + block_of_cells - 1) / block_of_cells;
    std::vector<CellPart> parts(blocks);
    std::vector<Tally> tallies(blocks);
    core::parallel_blocks(
        count, block_of_cells,
        [&](std::size_t begin, std::size_t end) {
            CellShape cell;
            CellPart part;
            Tally tally;
            part.nodes.reserve(8 * (end - begin));
            for (std::size_t i = begin; i < end; ++i) {
                gather(cells.first + i, cell);
                recognise(cell, mesh_.dimension, polyhedron(i));
                types[i] = cell.type;
                lengths[i] = static_cast<std::uint32_t>(cell.nodes.size());
                tally.add(cell, mesh_);
                if (cell.type == vtk_empty) {
                    continue;
                }
                ++part.cells;
                for (const std::uint32_t node : cell.nodes) {
                    part.nodes.push_back(static_cast<std::int32_t>(node) - 1);
                }
                if (cell.type == vtk_polyhedron) {
                    append_polyhedron(cell, part.faces);
                }
            }
            part.connectivity = part.nodes.size();
            part.stream = part.faces.size();
            parts[begin / block_of_cells] = std::move(part);
            tallies[begin / block_of_cells] = tally;
        },
        progress);
    CellArrays out;
    for (const Tally& tally : tallies) {
        tally.into(out);
    }
    const std::vector<CellPart> starts = starts_of(parts);
    const CellPart& total = starts.back();
    check_corners(total.connectivity);
    out.types.grow_to(total.cells);
    Buffer<std::uint64_t> listed;
    listed.grow_to(total.cells < count ? total.cells : 0);
    out.offsets.grow_to(total.cells + 1);
    out.connectivity.grow_to(total.connectivity);
    out.face_stream.grow_to(total.stream);
    out.face_locations.grow_to(total.stream > 0 ? total.cells : 0);
    out.offsets[total.cells] = static_cast<std::int32_t>(total.connectivity);
    core::parallel_blocks(
        count, block_of_cells,
        [&](std::size_t begin, std::size_t end) {
            const std::size_t block = begin / block_of_cells;
            put_part(out, parts[block], starts[block], begin, end, types, lengths, listed, cells.first);
            parts[block] = CellPart{};
        },
        progress);
    out.ids = listed.empty() ? Ids(cells.first, total.cells) : Ids(std::move(listed));
    return out;
}

}  // namespace underbody::postproc
