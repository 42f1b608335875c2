// A surface as plain arrays, for loops that have no time for virtual calls.
#pragma once

#include <span>
#include <vector>

class vtkCellArray;
class vtkDataArray;
class vtkPolyData;

namespace underbody::postproc {

using Index = long long;  ///< VTK's 64-bit integer

/// Views into VTK's own memory where its types allow (double, 64-bit), copies otherwise. Lives shorter than its source.
class SurfaceArrays {
public:
    explicit SurfaceArrays(vtkPolyData& surface);

    [[nodiscard]] std::size_t faces() const { return offsets_.empty() ? 0 : offsets_.size() - 1; }
    [[nodiscard]] std::size_t nodes() const { return points_.size() / 3; }
    [[nodiscard]] std::span<const double> points() const { return points_; }   ///< x, y, z by node
    [[nodiscard]] std::span<const Index> offsets() const { return offsets_; }  ///< one more than faces
    [[nodiscard]] std::span<const Index> connectivity() const { return connectivity_; }

private:
    std::span<const double> points_;
    std::span<const Index> offsets_;
    std::span<const Index> connectivity_;
    std::vector<double> own_points_;
    std::vector<Index> own_offsets_;
    std::vector<Index> own_connectivity_;
};

/// The values of an array as doubles, tuple after tuple: VTK's memory if it is a double array, else a copy in `own`.
std::span<const double> values_of(vtkDataArray& array, std::vector<double>& own);

}  // namespace underbody::postproc
