#include "postproc/field/surface_check.h"

#include <vtkCellArray.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "postproc/field/surface_arrays.h"

namespace underbody::postproc {

namespace {

constexpr std::size_t block = 65536;

/// Half edges sorted by their smaller node: for node n, entries [begin[n], begin[n + 1]) hold (larger node << 1 | way).
struct HalfEdges {
    std::vector<std::uint32_t> begin;
    std::vector<std::uint64_t> entries;
    std::vector<std::uint32_t> faces;  ///< of the entries, when asked for
};

template <typename F>
void for_half_edges(const SurfaceArrays& surface, F&& act) {
    const auto offsets = surface.offsets();
    const auto nodes = surface.connectivity();
    for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
        const auto first = static_cast<std::size_t>(offsets[f]);
        const auto last = static_cast<std::size_t>(offsets[f + 1]);
        Index a = first < last ? nodes[last - 1] : 0;
        for (std::size_t i = first; i < last; ++i) {
            const Index b = nodes[i];
            if (a != b) {  // a node named twice in a row is one node
                act(f, a, b);
            }
            a = b;
        }
    }
}

HalfEdges half_edges(const SurfaceArrays& surface, bool with_faces, core::Progress& progress) {
    HalfEdges edges;
    edges.begin.assign(surface.nodes() + 1, 0);
    for_half_edges(surface,
                   [&](std::size_t, Index a, Index b) { ++edges.begin[static_cast<std::size_t>(std::min(a, b)) + 1]; });
    for (std::size_t n = 0; n < surface.nodes(); ++n) {
        edges.begin[n + 1] += edges.begin[n];
    }
    progress.check();
    std::vector<std::uint32_t> place(edges.begin.begin(), edges.begin.end() - 1);
    edges.entries.resize(edges.begin.back());
    edges.faces.resize(with_faces ? edges.entries.size() : 0);
    for_half_edges(surface, [&](std::size_t f, Index a, Index b) {
        const std::uint32_t at = place[static_cast<std::size_t>(std::min(a, b))]++;
        edges.entries[at] = (static_cast<std::uint64_t>(std::max(a, b)) << 1) | (a < b ? 1U : 0U);
        if (with_faces) {
            edges.faces[at] = static_cast<std::uint32_t>(f);
        }
    });
    progress.check();
    return edges;
}

/// Whether numbers of 32 bits suffice; a surface beyond four thousand million edges is not examined.
bool fits(const SurfaceArrays& surface) {
    return surface.connectivity().size() < std::numeric_limits<std::uint32_t>::max();
}

SurfaceEdges count_edges(const SurfaceArrays& surface, core::Progress& progress) {
    if (!fits(surface)) {
        return {};
    }
    HalfEdges edges = half_edges(surface, false, progress);
    std::atomic<std::size_t> boundary{0};
    std::atomic<std::size_t> inconsistent{0};
    std::atomic<std::size_t> non_manifold{0};
    core::parallel_blocks(
        surface.nodes(), block,
        [&](std::size_t from, std::size_t to) {
            SurfaceEdges sum;
            for (std::size_t n = from; n < to; ++n) {
                std::uint64_t* first = edges.entries.data() + edges.begin[n];
                std::uint64_t* last = edges.entries.data() + edges.begin[n + 1];
                std::sort(first, last);
                while (first < last) {
                    std::uint64_t* next = first + 1;
                    while (next < last && (*next >> 1) == (*first >> 1)) {
                        ++next;
                    }
                    const auto count = next - first;
                    sum.boundary += count == 1 ? 1 : 0;
                    sum.non_manifold += count > 2 ? 1 : 0;
                    sum.inconsistent += count == 2 && first[0] == first[1] ? 1 : 0;
                    first = next;
                }
            }
            boundary += sum.boundary;
            inconsistent += sum.inconsistent;
            non_manifold += sum.non_manifold;
        },
        progress);
    return {boundary, inconsistent, non_manifold};
}

bool has_no_area(const SurfaceArrays& surface, std::size_t face) {
    const auto first = static_cast<std::size_t>(surface.offsets()[face]);
    const auto last = static_cast<std::size_t>(surface.offsets()[face + 1]);
    const auto nodes = surface.connectivity();
    const double* points = surface.points().data();
    const double* origin = points + 3 * nodes[first];
    double area[3] = {0, 0, 0};
    double size = 0;
    double a[3] = {0, 0, 0};
    for (std::size_t i = first + 1; i < last; ++i) {
        const double* p = points + 3 * nodes[i];
        const double b[3] = {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
        area[0] += a[1] * b[2] - a[2] * b[1];
        area[1] += a[2] * b[0] - a[0] * b[2];
        area[2] += a[0] * b[1] - a[1] * b[0];
        size += b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
        std::copy(b, b + 3, a);
    }
    return area[0] * area[0] + area[1] * area[1] + area[2] * area[2] <= 1e-24 * size * size;
}

}  // namespace

SurfaceCheck check_surface(vtkPolyData& polydata, core::Progress& progress) {
    const SurfaceArrays surface(polydata);
    SurfaceCheck check;
    check.edges = count_edges(surface, progress);
    const std::size_t blocks = (surface.faces() + block - 1) / block;
    std::vector<std::size_t> counts(blocks, 0);
    std::vector<std::size_t> firsts(blocks, 0);
    core::parallel_blocks(
        surface.faces(), block,
        [&](std::size_t from, std::size_t to) {
            for (std::size_t f = from; f < to; ++f) {
                if (has_no_area(surface, f) && counts[from / block]++ == 0) {
                    firsts[from / block] = f;
                }
            }
        },
        progress);
    for (std::size_t b = 0; b < blocks; ++b) {
        if (check.zero_area == 0 && counts[b] > 0) {
            check.first_zero_area = firsts[b];
        }
        check.zero_area += counts[b];
    }
    std::vector<std::uint8_t> used(surface.nodes(), 0);
    for (const auto node : surface.connectivity()) {
        used[static_cast<std::size_t>(node)] = 1;
    }
    check.unused_nodes = static_cast<std::size_t>(std::count(used.begin(), used.end(), std::uint8_t{0}));
    return check;
}

namespace {

struct Neighbour {
    std::uint32_t face;
    bool same_way;  ///< both run along their edge the same way: one of them must be turned
};

/// Neighbours over edges with just two faces, face by face.
void find_neighbours(HalfEdges& edges, std::size_t faces, std::vector<std::size_t>& begin,
                     std::vector<Neighbour>& neighbours) {
    struct Pair {
        std::uint32_t a, b;
        bool same_way;
    };
    std::vector<Pair> pairs;
    std::vector<std::uint32_t> order;
    for (std::size_t n = 0; n + 1 < edges.begin.size(); ++n) {
        order.clear();
        for (std::uint32_t i = edges.begin[n]; i < edges.begin[n + 1]; ++i) {
            order.push_back(i);
        }
        std::sort(order.begin(), order.end(), [&](auto x, auto y) { return edges.entries[x] < edges.entries[y]; });
        for (std::size_t i = 0; i < order.size();) {
            std::size_t j = i + 1;
            while (j < order.size() && (edges.entries[order[j]] >> 1) == (edges.entries[order[i]] >> 1)) {
                ++j;
            }
            if (j - i == 2) {
                pairs.push_back({edges.faces[order[i]], edges.faces[order[i + 1]],
                                 edges.entries[order[i]] == edges.entries[order[i + 1]]});
            }
            i = j;
        }
    }
    begin.assign(faces + 1, 0);
    for (const auto& pair : pairs) {
        ++begin[pair.a + 1];
        ++begin[pair.b + 1];
    }
    for (std::size_t f = 0; f < faces; ++f) {
        begin[f + 1] += begin[f];
    }
    std::vector<std::size_t> place(begin.begin(), begin.end() - 1);
    neighbours.resize(begin.back());
    for (const auto& pair : pairs) {
        neighbours[place[pair.a]++] = {pair.b, pair.same_way};
        neighbours[place[pair.b]++] = {pair.a, pair.same_way};
    }
}

void replace_polygons(vtkPolyData& polydata, const SurfaceArrays& surface, const std::vector<std::uint8_t>& turned) {
    vtkNew<vtkCellArray> cells;
    cells->Use64BitStorage();
    cells->AllocateExact(static_cast<vtkIdType>(surface.faces()),
                         static_cast<vtkIdType>(surface.connectivity().size()));
    std::vector<vtkIdType> ids;
    for (std::size_t f = 0; f < surface.faces(); ++f) {
        ids.assign(surface.connectivity().begin() + surface.offsets()[f],
                   surface.connectivity().begin() + surface.offsets()[f + 1]);
        if (turned[f] != 0) {
            std::reverse(ids.begin(), ids.end());
        }
        cells->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
    }
    polydata.SetPolys(cells);
    polydata.DeleteCells();
}

}  // namespace

std::size_t make_consistent(vtkPolyData& polydata, core::Progress& progress) {
    const SurfaceArrays surface(polydata);
    if (!fits(surface)) {
        return 0;
    }
    HalfEdges edges = half_edges(surface, true, progress);
    std::vector<std::size_t> begin;
    std::vector<Neighbour> neighbours;
    find_neighbours(edges, surface.faces(), begin, neighbours);
    constexpr std::uint8_t unseen = 2;
    std::vector<std::uint8_t> turned(surface.faces(), unseen);
    std::vector<std::uint32_t> open;
    for (std::size_t seed = 0; seed < surface.faces(); ++seed) {
        if (turned[seed] != unseen) {
            continue;
        }
        turned[seed] = 0;
        open.push_back(static_cast<std::uint32_t>(seed));
        while (!open.empty()) {
            const std::uint32_t face = open.back();
            open.pop_back();
            for (std::size_t i = begin[face]; i < begin[face + 1]; ++i) {
                const Neighbour& next = neighbours[i];
                if (turned[next.face] == unseen) {
                    turned[next.face] = static_cast<std::uint8_t>(turned[face] ^ (next.same_way ? 1 : 0));
                    open.push_back(next.face);
                }
            }
        }
        progress.check();
    }
    const auto count = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), std::uint8_t{1}));
    if (count > 0) {
        replace_polygons(polydata, surface, turned);
    }
    return count;
}

}  // namespace underbody::postproc
