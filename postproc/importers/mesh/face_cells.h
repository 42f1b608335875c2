// Cells out of the faces of a mesh, as VTK wants them.
#pragma once

#include <cstdint>
#include <vector>

#include "postproc/importers/mesh/buffer.h"
#include "postproc/importers/mesh/face_mesh.h"

namespace underbody::postproc {

/// Ids of the faces or cells of a zone, in their order there.
class Ids {
public:
    Ids() = default;
    /// `count` ids that follow one another.
    Ids(std::uint64_t first, std::size_t count) : first_(first), size_(count) {}
    explicit Ids(Buffer<std::uint64_t>&& list) : size_(list.size()), list_(std::move(list)) {}

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] bool listed() const { return !list_.empty(); }
    std::uint64_t operator[](std::size_t i) const { return list_.empty() ? first_ + i : list_[i]; }

private:
    std::uint64_t first_ = 1;
    std::size_t size_ = 0;
    Buffer<std::uint64_t> list_;
};

/// One unstructured block of VTK arrays that cells are built from.
struct CellArrays {
    Buffer<unsigned char> types;
    Buffer<std::int32_t> offsets;         ///< cells + 1
    Buffer<std::int32_t> connectivity;    ///< node ids from 0
    Buffer<std::int64_t> face_locations;  ///< per cell, -1 but for polyhedra; empty when there are none
    Buffer<std::int64_t> face_stream;
    Ids ids;                     ///< of the cells that were built
    double volume = 0;           ///< by the divergence theorem over the faces (2-D: area)
    std::uint64_t inverted = 0;  ///< cells whose volume is not positive
    std::uint64_t open = 0;      ///< cells whose faces do not close
};

struct CellShape;

/// Builds the cells of one zone after another.
class CellBuilder {
public:
    /// The mesh must have passed `check_mesh`, have its `cell_faces` and outlive this.
    explicit CellBuilder(const FaceMesh& mesh);
    /// The cells of one zone; hidden ones and those without faces are left out.
    [[nodiscard]] CellArrays build(const CellBlock& block, core::Progress& progress) const;

private:
    struct Tally;
    void gather(std::uint64_t cell, CellShape& shape) const;
    [[nodiscard]] std::uint32_t common_corners(const CellBlock& cells) const;
    bool build_alike(const CellBlock& cells, std::uint32_t corners, CellArrays& out, core::Progress& progress) const;
    [[nodiscard]] CellArrays build_any(const CellBlock& cells, core::Progress& progress) const;
    void check_corners(std::uint64_t corners) const;

    const FaceMesh& mesh_;
    std::vector<std::uint32_t> slots_;  ///< place of the first face of each block among those of all
    std::vector<bool> hidden_cells_;    ///< empty: none
};

}  // namespace underbody::postproc
