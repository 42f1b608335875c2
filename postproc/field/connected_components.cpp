#include "postproc/field/connected_components.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "postproc/field/point_index.h"

namespace underbody::postproc {

namespace {

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

ConnectedFaces::ConnectedFaces(const SurfaceArrays& surface)
    : surface_(surface), sets_(surface.nodes()), used_(surface.nodes()) {
    const auto offsets = surface.offsets();
    const auto nodes = surface.connectivity();
    std::atomic<std::size_t> joined = 0;
    constexpr std::size_t at_once = std::size_t{1} << 16;
    core::parallel_blocks(surface.faces(), at_once, [&](std::size_t begin, std::size_t end) {
        std::size_t some = 0;
        for (std::size_t f = begin; f < end; ++f) {
            some += sets_.join(nodes.data() + offsets[f], static_cast<std::size_t>(offsets[f + 1] - offsets[f]));
        }
        joined += some;
    });
    parts_ = surface.nodes() - joined;
    if (parts_ > 1) {  // else all nodes hang together, and none is without a face
        std::vector<bool> used(surface.nodes(), false);
        for (const Index node : nodes) {
            used[static_cast<std::size_t>(node)] = true;
        }
        used_ = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
        parts_ -= surface.nodes() - used_;
    }
}

void ConnectedFaces::join_places() {
    Places places(1e-6 * size_of(surface_));
    std::vector<std::uint32_t> first;  // node at each place
    std::vector<bool> placed(surface_.nodes(), false);
    for (const Index node : surface_.connectivity()) {
        if (placed[static_cast<std::size_t>(node)]) {
            continue;
        }
        placed[static_cast<std::size_t>(node)] = true;
        const auto place = static_cast<std::size_t>(places.number(surface_.points().data() + 3 * node));
        if (place == first.size()) {
            first.push_back(static_cast<std::uint32_t>(node));
        }
        const std::uint32_t both[] = {first[place], static_cast<std::uint32_t>(node)};
        parts_ -= sets_.join(both, 2);
        if (parts_ == 1) {
            return;
        }
    }
}

std::vector<std::uint32_t> ConnectedFaces::parts() {
    if (parts_ > 1) {
        join_places();
    }
    if (parts_ <= 1) {
        return {};
    }
    const auto offsets = surface_.offsets();
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(surface_.nodes(), none);
    std::vector<std::uint32_t> part(surface_.faces(), 0);
    std::uint32_t count = 0;
    for (std::size_t f = 0; f < part.size(); ++f) {
        if (offsets[f] < offsets[f + 1]) {
            std::uint32_t& own = number[sets_.find(
                static_cast<std::uint32_t>(surface_.connectivity()[static_cast<std::size_t>(offsets[f])]))];
            own = own == none ? count++ : own;
            part[f] = own;
        }
    }
    return part;
}

vtkSmartPointer<vtkPolyData> surface_of_faces(vtkPolyData& surface, const SurfaceArrays& arrays,
                                              std::span<const std::size_t> faces) {
    auto result = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> cells;
    result->GetPointData()->CopyAllocate(surface.GetPointData());
    result->GetCellData()->CopyAllocate(surface.GetCellData());
    const vtkIdType before = surface.GetNumberOfVerts() + surface.GetNumberOfLines();  // their values come first
    const auto corners = [&](std::size_t face) {
        const auto first = static_cast<std::size_t>(arrays.offsets()[face]);
        return arrays.connectivity().subspan(first, static_cast<std::size_t>(arrays.offsets()[face + 1]) - first);
    };
    std::vector<Index> used;  // in order: a small part of a large surface takes no memory for all of it
    for (const std::size_t face : faces) {
        used.insert(used.end(), corners(face).begin(), corners(face).end());
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (std::size_t i = 0; i < used.size(); ++i) {
        points->InsertNextPoint(arrays.points().data() + 3 * used[i]);
        result->GetPointData()->CopyData(surface.GetPointData(), used[i], static_cast<vtkIdType>(i));
    }
    for (std::size_t i = 0; i < faces.size(); ++i) {
        cells->InsertNextCell(static_cast<int>(corners(faces[i]).size()));
        for (const Index node : corners(faces[i])) {
            cells->InsertCellPoint(std::lower_bound(used.begin(), used.end(), node) - used.begin());
        }
        result->GetCellData()->CopyData(surface.GetCellData(), before + static_cast<vtkIdType>(faces[i]),
                                        static_cast<vtkIdType>(i));
    }
    result->SetPoints(points);
    result->SetPolys(cells);
    return result;
}

}  // namespace underbody::postproc
