// Which way boundary faces look, found from the volume cells behind them.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "postproc/importers/mesh/element_zone.h"

namespace underbody::postproc {

/// The faces of some surfaces that are also faces of a volume with the same numbering of nodes.
class BoundaryFaces {
public:
    BoundaryFaces(const std::vector<const ElementPart*>& surfaces, const ElementPart& volume);

    /// Turns the faces of a surface so that their right-hand normals point into the volume. True if every face has one
    /// cell behind it, or a quarter of them have and those agree on the order of the whole; a face between two cells
    /// has no side, unless the surface is one of two that lie there (`two_sided`): then it stays as it is. A surface
    /// that is not settled so is left as it was. Lines bound a plane volume: they have it on their left.
    bool turn_into_volume(ElementPart& surface, const Buffer<double>& points, bool two_sided = false) const;

    /// The faces of a surface that lie between two cells, turned round: its other side. Without points.
    [[nodiscard]] ElementPart other_side(const ElementPart& surface) const;

    /// Places of the cells at a face among the volume's elements, -1 for none: between two cells first the one that its
    /// right-hand normal points into.
    [[nodiscard]] std::array<std::int64_t, 2> cells_at(const std::int64_t* nodes, std::size_t count,
                                                       const Buffer<double>& points) const;

private:
    /// Corners of a face, sorted (the four lowest), tell it from others.
    struct Key {
        std::int64_t nodes[4] = {-1, -1, -1, -1};
        bool operator==(const Key& other) const = default;
    };
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };
    static Key key_of(const std::int64_t* nodes, std::size_t count);
    void note(const std::int64_t* nodes, std::size_t count, std::size_t cell, std::size_t stream = 0);

    struct Cell {
        std::int64_t place = -1;  ///< -1: none
        std::size_t stream = 0;   ///< where a polyhedron's faces begin in `polyhedra`
    };
    struct Behind {
        Cell one;
        Cell other;  ///< that shares the face
        [[nodiscard]] bool between() const { return other.place >= 0; }
    };
    [[nodiscard]] int turn_toward(const Cell& cell, const std::int64_t* nodes, std::size_t count,
                                  const Buffer<double>& points) const;
    [[nodiscard]] Behind behind(const std::int64_t* nodes, std::size_t count) const;

    const ElementPart& volume_;
    std::unordered_map<Key, Behind, Hash> cells_;
};

/// Turns the faces of surfaces into a volume with nodes of its own, told by their places (the same numbers, as of one
/// file). True for those where BoundaryFaces::turn_into_volume is, and every node has its place in the volume. One look
/// at the volume serves all surfaces.
std::vector<bool> turn_into_volume(const std::vector<ElementPart*>& surfaces, const ElementPart& volume);

/// The same with several volumes: true for the surfaces that lie at one of them alone. Between two, fluid and solid,
/// neither side is the fluid's for sure.
std::vector<bool> turn_into_one_volume(const std::vector<ElementPart*>& surfaces,
                                       const std::vector<const ElementPart*>& volumes, core::Progress& progress);

}  // namespace underbody::postproc
