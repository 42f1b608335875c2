#include "postproc/importers/face_orientation.h"

#include <vtkCellType.h>

#include <algorithm>
#include <array>

namespace underbody::postproc {

namespace {

using Faces = std::vector<std::vector<int>>;

const Faces& faces_of(unsigned char type) {
    static const Faces tetrahedron = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    static const Faces pyramid = {{0, 1, 2, 3}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    static const Faces wedge = {{0, 1, 2}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    static const Faces hexahedron = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    static const Faces triangle = {{0, 1}, {1, 2}, {2, 0}};
    static const Faces quadrangle = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    static const Faces none;
    switch (type) {
        case VTK_TETRA:
            return tetrahedron;
        case VTK_PYRAMID:
            return pyramid;
        case VTK_WEDGE:
            return wedge;
        case VTK_HEXAHEDRON:
            return hexahedron;
        case VTK_TRIANGLE:
            return triangle;
        case VTK_QUAD:
            return quadrangle;
        default:
            return none;
    }
}

using Vector = std::array<double, 3>;

Vector mean_of(const std::int64_t* nodes, std::size_t count, const Buffer<double>& points) {
    Vector sum{};
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += points[static_cast<std::size_t>(3 * nodes[i]) + k] / static_cast<double>(count);
        }
    }
    return sum;
}

Vector normal_of(const std::int64_t* nodes, std::size_t count, const Buffer<double>& points) {
    Vector sum{};
    const double* a = points.data() + 3 * nodes[0];
    for (std::size_t i = 1; i + 1 < count; ++i) {
        const double* b = points.data() + 3 * nodes[i];
        const double* c = points.data() + 3 * nodes[i + 1];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t m = (k + 1) % 3;
            const std::size_t n = (k + 2) % 3;
            sum[k] += (b[m] - a[m]) * (c[n] - a[n]) - (b[n] - a[n]) * (c[m] - a[m]);
        }
    }
    return sum;
}

}  // namespace

std::size_t BoundaryFaces::Hash::operator()(const Key& key) const {
    std::uint64_t hash = 1469598103934665603ULL;
    for (const std::int64_t node : key.nodes) {
        hash = (hash ^ static_cast<std::uint64_t>(node)) * 1099511628211ULL;
    }
    return hash ^ (hash >> 29);
}

BoundaryFaces::Key BoundaryFaces::key_of(const std::int64_t* nodes, std::size_t count) {
    std::array<std::int64_t, 64> sorted{};
    const std::size_t used = std::min(count, sorted.size());
    std::copy_n(nodes, used, sorted.begin());
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(used));
    Key key;
    std::copy_n(sorted.begin(), std::min<std::size_t>(used, 4), key.nodes);
    return key;
}

void BoundaryFaces::note(const std::int64_t* nodes, std::size_t count, std::size_t cell) {
    const auto found = cells_.find(key_of(nodes, count));
    if (found != cells_.end()) {
        found->second = static_cast<std::int64_t>(cell);
    }
}

BoundaryFaces::BoundaryFaces(const std::vector<ElementPart>& surfaces, const ElementPart& volume) : volume_(volume) {
    for (const auto& surface : surfaces) {
        for (std::size_t i = 0; i < surface.elements(); ++i) {
            const auto count = static_cast<std::size_t>(surface.offsets[i + 1] - surface.offsets[i]);
            cells_.emplace(key_of(surface.nodes.data() + surface.offsets[i], count), -1);
        }
    }
    std::size_t stream = 0;
    std::vector<std::int64_t> corners;
    for (std::size_t cell = 0; cell < volume.elements(); ++cell) {
        const std::int64_t* nodes = volume.nodes.data() + volume.offsets[cell];
        if (volume.types[cell] == VTK_POLYHEDRON) {
            for (std::int64_t faces = volume.polyhedra[stream++]; faces > 0; --faces) {
                const auto count = static_cast<std::size_t>(volume.polyhedra[stream++]);
                note(volume.polyhedra.data() + stream, count, cell);
                stream += count;
            }
            continue;
        }
        for (const auto& face : faces_of(volume.types[cell])) {
            corners.clear();
            for (const int corner : face) {
                corners.push_back(nodes[corner]);
            }
            note(corners.data(), corners.size(), cell);
        }
    }
}

std::int64_t BoundaryFaces::cell_behind(const std::int64_t* nodes, std::size_t count) const {
    const auto found = cells_.find(key_of(nodes, count));
    return found == cells_.end() ? -1 : found->second;
}

bool BoundaryFaces::turn_into_volume(ElementPart& surface, const Buffer<double>& points) const {
    bool all = true;
    for (std::size_t i = 0; i < surface.elements(); ++i) {
        std::int64_t* nodes = surface.nodes.data() + surface.offsets[i];
        const auto count = static_cast<std::size_t>(surface.offsets[i + 1] - surface.offsets[i]);
        const std::int64_t behind = cell_behind(nodes, count);
        if (behind < 0 || count < 3) {
            all = false;
            continue;
        }
        const auto cell = static_cast<std::size_t>(behind);
        const Vector inside =
            mean_of(volume_.nodes.data() + volume_.offsets[cell],
                    static_cast<std::size_t>(volume_.offsets[cell + 1] - volume_.offsets[cell]), points);
        const Vector here = mean_of(nodes, count, points);
        const Vector normal = normal_of(nodes, count, points);
        double toward = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            toward += normal[k] * (inside[k] - here[k]);
        }
        if (toward < 0) {
            std::reverse(nodes, nodes + count);
        }
    }
    return all && surface.elements() > 0;
}

}  // namespace underbody::postproc
