// The connected parts of a surface.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "postproc/field/surface_arrays.h"

namespace underbody::postproc {

/// Sets of nodes that are joined face by face, by several threads at once: a node's parent has a smaller number, and
/// only who turns a root into a child (compare and exchange) has joined two sets.
class NodeSets {
public:
    explicit NodeSets(std::size_t nodes) : parent_(nodes) {
        std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
    }

    std::uint32_t find(std::uint32_t node) {
        for (;;) {
            const std::uint32_t above = parent(node).load(std::memory_order_relaxed);
            const std::uint32_t two_above = parent(above).load(std::memory_order_relaxed);
            if (above == two_above) {
                return above;
            }
            parent(node).store(two_above, std::memory_order_relaxed);  // the way is shorter next time
            node = two_above;
        }
    }
    /// Joins all nodes of a face; how many sets fewer there are then.
    template <typename Number>
    std::size_t join(const Number* nodes, std::size_t count) {
        std::size_t joined = 0;
        std::uint32_t root = count > 0 ? find(static_cast<std::uint32_t>(nodes[0])) : 0;
        for (std::size_t i = 1; i < count; ++i) {
            std::uint32_t other = find(static_cast<std::uint32_t>(nodes[i]));
            while (other != root) {
                const std::uint32_t low = std::min(root, other);
                std::uint32_t high = std::max(root, other);
                const bool was_root = parent(high).compare_exchange_strong(high, low, std::memory_order_relaxed);
                joined += was_root ? 1 : 0;
                root = find(low);
                other = was_root ? root : find(high);
            }
        }
        return joined;
    }

private:
    [[nodiscard]] std::atomic_ref<std::uint32_t> parent(std::uint32_t node) {
        return std::atomic_ref<std::uint32_t>(parent_[node]);
    }

    std::vector<std::uint32_t> parent_;
};

/// How the faces of a surface hang together: those that have a node in common.
class ConnectedFaces {
public:
    /// The surface must outlive this.
    explicit ConnectedFaces(const SurfaceArrays& surface);

    /// Are there points that no face has?
    [[nodiscard]] bool leaves_points_out() const { return used_ < surface_.nodes(); }
    /// Which part each face belongs to, numbered from 0 in the order of the faces, where nodes in one place (to 1e-6 of
    /// the size of the surface) are one; empty: all of them are of one part.
    [[nodiscard]] std::vector<std::uint32_t> parts();

private:
    void join_places();

    const SurfaceArrays& surface_;
    NodeSets sets_;
    std::size_t used_ = 0;   ///< nodes of faces
    std::size_t parts_ = 0;  ///< of these
};

/// A surface of some faces, with the points that these use and the values of both. `arrays` are those of `surface`.
vtkSmartPointer<vtkPolyData> surface_of_faces(vtkPolyData& surface, const SurfaceArrays& arrays,
                                              std::span<const std::size_t> faces);

}  // namespace underbody::postproc
