#include "postproc/shells.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "postproc/places.h"

namespace underbody::postproc {

namespace {

/// Sets of nodes that are joined two by two.
class NodeSets {
public:
    explicit NodeSets(std::size_t nodes) : parent_(nodes) { std::iota(parent_.begin(), parent_.end(), std::uint32_t{0}); }

    std::uint32_t find(std::uint32_t node) {
        while (parent_[node] != node) {
            node = parent_[node] = parent_[parent_[node]];
        }
        return node;
    }
    /// Joins all nodes of a face; how many sets fewer there are then.
    template <typename Number>
    std::size_t join(const Number* nodes, std::size_t count) {
        std::size_t joined = 0;
        std::uint32_t root = count > 0 ? find(static_cast<std::uint32_t>(nodes[0])) : 0;
        for (std::size_t i = 1; i < count; ++i) {
            const auto node = static_cast<std::uint32_t>(nodes[i]);
            const std::uint32_t other = find(node);
            if (other != root) {
                const auto [low, high] = std::minmax(root, other);
                parent_[high] = low;
                root = low;
                ++joined;
            }
            parent_[node] = root;  // the way is short next time
        }
        return joined;
    }

private:
    std::vector<std::uint32_t> parent_;
};

double size_of(const SurfaceArrays& surface) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        for (std::size_t i = k; i < surface.points().size(); i += 3) {
            low = std::min(low, surface.points()[i]);
            high = std::max(high, surface.points()[i]);
        }
        square += (high - low) * (high - low);
    }
    return std::sqrt(square);
}

}  // namespace

std::vector<std::uint32_t> connected_parts(const SurfaceArrays& surface) {
    const auto offsets = surface.offsets();
    const auto nodes = surface.connectivity();
    NodeSets sets(surface.nodes());
    std::size_t parts = surface.nodes();
    for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
        parts -= sets.join(nodes.data() + offsets[f], static_cast<std::size_t>(offsets[f + 1] - offsets[f]));
    }
    if (parts > 1) {
        Places places(1e-6 * size_of(surface));
        std::vector<std::uint32_t> first;  // node at each place
        for (std::size_t node = 0; node < surface.nodes() && parts > 1; ++node) {
            const auto place = static_cast<std::size_t>(places.number(surface.points().data() + 3 * node));
            if (place == first.size()) {
                first.push_back(static_cast<std::uint32_t>(node));
            }
            const std::uint32_t both[] = {first[place], static_cast<std::uint32_t>(node)};
            parts -= sets.join(both, 2);
        }
    }
    if (parts <= 1) {
        return {};
    }
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(surface.nodes(), none);
    std::vector<std::uint32_t> part(surface.faces(), 0);
    std::uint32_t count = 0;
    for (std::size_t f = 0; f < part.size(); ++f) {
        if (offsets[f] == offsets[f + 1]) {
            continue;
        }
        std::uint32_t& own = number[sets.find(static_cast<std::uint32_t>(nodes[static_cast<std::size_t>(offsets[f])]))];
        own = own == none ? count++ : own;
        part[f] = own;
    }
    return count > 1 ? part : std::vector<std::uint32_t>{};  // points without faces are parts of nothing
}

vtkSmartPointer<vtkPolyData> surface_of_faces(vtkPolyData& surface, const SurfaceArrays& arrays, std::span<const std::size_t> faces) {
    auto result = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> cells;
    result->GetPointData()->CopyAllocate(surface.GetPointData());
    result->GetCellData()->CopyAllocate(surface.GetCellData());
    const vtkIdType before = surface.GetNumberOfVerts() + surface.GetNumberOfLines();  // their values come first
    std::vector<vtkIdType> place(arrays.nodes(), -1);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const std::size_t face = faces[i];
        cells->InsertNextCell(static_cast<int>(arrays.offsets()[face + 1] - arrays.offsets()[face]));
        for (auto k = static_cast<std::size_t>(arrays.offsets()[face]); k < static_cast<std::size_t>(arrays.offsets()[face + 1]); ++k) {
            const auto node = static_cast<std::size_t>(arrays.connectivity()[k]);
            if (place[node] < 0) {
                place[node] = points->InsertNextPoint(arrays.points().data() + 3 * node);
                result->GetPointData()->CopyData(surface.GetPointData(), static_cast<vtkIdType>(node), place[node]);
            }
            cells->InsertCellPoint(place[node]);
        }
        result->GetCellData()->CopyData(surface.GetCellData(), before + static_cast<vtkIdType>(face), static_cast<vtkIdType>(i));
    }
    result->SetPoints(points);
    result->SetPolys(cells);
    return result;
}

}  // namespace underbody::postproc
