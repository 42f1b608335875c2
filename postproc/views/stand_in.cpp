#include "postproc/views/stand_in.h"

#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace underbody::postproc {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr vtkIdType asked_every = 65536;  ///< faces between two looks whether it was cancelled

/// Calls visit(a, b, c, face) for each triangle of the faces, polygons as fans.
template <class Visit>
void each_triangle(vtkPolyData& surface, core::Progress& progress, Visit visit) {
    const vtkIdType before = surface.GetNumberOfVerts() + surface.GetNumberOfLines();  // cell data count those first
    auto faces = vtk::TakeSmartPointer(surface.GetPolys()->NewIterator());
    for (faces->GoToFirstCell(); !faces->IsDoneWithTraversal(); faces->GoToNextCell()) {
        const vtkIdType face = faces->GetCurrentCellId();
        if (face % asked_every == 0) {
            progress.check();
        }
        vtkIdType count = 0;
        const vtkIdType* corners = nullptr;
        faces->GetCurrentCell(count, corners);
        for (vtkIdType i = 2; i < count; ++i) {
            visit(corners[0], corners[i - 1], corners[i], before + face);
        }
    }
}

/// What is known of the points within one cube. Places are in cubes, from its middle.
struct Cluster {
    Matrix3d planes = Matrix3d::Zero();
    Vector3d right_side = Vector3d::Zero();
    Vector3d sum = Vector3d::Zero(), rim_sum = Vector3d::Zero();
    Vector3d middle = Vector3d::Zero();  ///< in cubes, from the corner of all
    int points = 0, rim_points = 0;

    /// A plane through `at` whose normal is as long as the root of its weight.
    void add_plane(const Vector3d& normal, const Vector3d& at) {
        planes += normal * normal.transpose();
        right_side += normal * normal.dot(at - middle);
    }
    /// Where the planes meet; along what they leave open, in the middle of the points.
    [[nodiscard]] Vector3d place() const {
        const Vector3d mean = rim_points > 0 ? Vector3d(rim_sum / rim_points) : Vector3d(sum / std::max(1, points));
        const Eigen::SelfAdjointEigenSolver<Matrix3d> own(planes);
        const Vector3d rest = right_side - planes * mean;
        Vector3d moved = mean;
        for (int i = 2; i >= 0; --i) {  // the stiffest first; what would lead far away is left out
            const double stiffness = own.eigenvalues()[i];
            if (stiffness > 1e-4 * own.eigenvalues()[2]) {
                const Vector3d next =
                    moved + own.eigenvectors().col(i) * (own.eigenvectors().col(i).dot(rest) / stiffness);
                moved = next.allFinite() && next.cwiseAbs().maxCoeff() < 1 ? next : moved;
            }
        }
        return middle + moved;
    }
};

class Clustering {
public:
    Clustering(vtkPolyData& surface, double size, core::Progress& progress) : surface_(surface), progress_(progress) {
        std::array<double, 6> box{};
        surface.GetPoints()->GetBounds(box.data());
        corner_ = {box[0], box[2], box[4]};
        const auto fits = [&] {
            double all = 1;
            for (std::size_t i = 0; i < 3; ++i) {
                counts_[i] = static_cast<std::int64_t>(std::floor((box[2 * i + 1] - box[2 * i]) / size)) + 1;
                all *= static_cast<double>(counts_[i]);
            }
            return all < 5e7;
        };
        while (!fits()) {
            size *= 1.25;
        }
        size_ = size;
        read_points();
        find_rim();
        lay_planes();
    }

    vtkSmartPointer<vtkPolyData> result() {
        vtkNew<vtkPoints> points;
        points->SetDataTypeToFloat();
        points->SetNumberOfPoints(static_cast<vtkIdType>(clusters_.size()));
        for (std::size_t i = 0; i < clusters_.size(); ++i) {
            const Vector3d at = corner_ + size_ * clusters_[i].place();
            points->SetPoint(static_cast<vtkIdType>(i), at.data());
        }
        vtkNew<vtkCellArray> faces;
        faces->AllocateEstimate(static_cast<vtkIdType>(kept_.size()), 3);
        for (const auto& one : kept_) {
            faces->InsertNextCell(3, one.corners.data());
        }
        auto fewer = vtkSmartPointer<vtkPolyData>::New();
        fewer->SetPoints(points);
        fewer->SetPolys(faces);
        copy_values(*fewer);
        return fewer;
    }

private:
    struct Kept {
        std::array<vtkIdType, 3> corners;
        vtkIdType face;
    };

    void read_points() {
        const vtkIdType count = surface_.GetNumberOfPoints();
        places_.resize(static_cast<std::size_t>(count));
        of_point_.resize(places_.size());
        std::vector<std::int32_t> known(static_cast<std::size_t>(counts_[0] * counts_[1] * counts_[2]), -1);
        for (std::size_t p = 0; p < places_.size(); ++p) {
            if (p % asked_every == 0) {
                progress_.check();
            }
            Vector3d at;
            surface_.GetPoint(static_cast<vtkIdType>(p), at.data());
            at = (at - corner_) / size_;
            places_[p] = at.cast<float>();
            std::array<std::int64_t, 3> cube{};
            for (int i = 0; i < 3; ++i) {
                const auto k = static_cast<std::size_t>(i);
                cube[k] = std::clamp(static_cast<std::int64_t>(at[i]), std::int64_t{0}, counts_[k] - 1);
            }
            auto& id = known[static_cast<std::size_t>((cube[2] * counts_[1] + cube[1]) * counts_[0] + cube[0])];
            if (id < 0) {
                id = static_cast<std::int32_t>(clusters_.size());
                clusters_.emplace_back();
                clusters_.back().middle =
                    Vector3d(static_cast<double>(cube[0]), static_cast<double>(cube[1]), static_cast<double>(cube[2])) +
                    Vector3d::Constant(0.5);
            }
            of_point_[p] = id;
            Cluster& cluster = clusters_[static_cast<std::size_t>(id)];
            cluster.sum += at - cluster.middle;
            ++cluster.points;
        }
    }

    /// Around a point within the surface each neighbour is once the next corner and once the one before; on a rim the
    /// first and the last are not.
    void find_rim() {
        std::vector<std::int64_t> balance(places_.size(), 0);
        const auto corner = [&](vtkIdType at, vtkIdType next, vtkIdType before) {
            balance[static_cast<std::size_t>(at)] += next - before;
        };
        each_triangle(surface_, progress_, [&](vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType) {
            corner(a, b, c);
            corner(b, c, a);
            corner(c, a, b);
        });
        on_rim_.resize(places_.size());
        std::size_t count = 0;
        for (std::size_t p = 0; p < places_.size(); ++p) {
            on_rim_[p] = balance[p] != 0;
            count += on_rim_[p] ? 1 : 0;
        }
        if (3 * count > places_.size()) {  // faces that share no points, or look anywhere: nothing is known of rims
            on_rim_.assign(places_.size(), false);
            return;
        }
        for (std::size_t p = 0; p < places_.size(); ++p) {
            if (on_rim_[p]) {
                Cluster& cluster = cluster_of(static_cast<vtkIdType>(p));
                cluster.rim_sum += places_[p].cast<double>() - cluster.middle;
                ++cluster.rim_points;
            }
        }
    }

    void lay_planes() {
        std::unordered_set<std::uint64_t> seen;
        each_triangle(surface_, progress_, [&](vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType face) {
            const std::array<vtkIdType, 3> points = {a, b, c};
            std::array<Vector3d, 3> at;
            for (std::size_t i = 0; i < 3; ++i) {
                at[i] = places_[static_cast<std::size_t>(points[i])].cast<double>();
            }
            const Vector3d across = (at[1] - at[0]).cross(at[2] - at[0]);
            const double area = across.norm();
            if (!(area > 0)) {
                return;
            }
            for (const auto point : points) {
                cluster_of(point).add_plane(across / std::sqrt(area), at[0]);
            }
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t next = (i + 1) % 3;
                if (on_rim_[static_cast<std::size_t>(points[i])] && on_rim_[static_cast<std::size_t>(points[next])]) {
                    // Weighs as much as a strip as wide as the edge is long.
                    const Vector3d wall = (at[next] - at[i]).cross(across / area);
                    cluster_of(points[i]).add_plane(wall, at[i]);
                    cluster_of(points[next]).add_plane(wall, at[i]);
                }
            }
            keep(points, face, seen);
        });
    }

    void keep(const std::array<vtkIdType, 3>& points, vtkIdType face, std::unordered_set<std::uint64_t>& seen) {
        std::array<vtkIdType, 3> ids{};
        for (std::size_t i = 0; i < 3; ++i) {
            ids[i] = of_point_[static_cast<std::size_t>(points[i])];
        }
        if (ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0]) {
            return;
        }
        std::rotate(ids.begin(), std::min_element(ids.begin(), ids.end()), ids.end());
        std::uint64_t key = 0;
        for (const auto id : ids) {
            key = key << 21U ^ static_cast<std::uint64_t>(id);  // two millions of clusters are more than are made
        }
        if (seen.insert(key).second) {
            kept_.push_back({ids, face});
        }
    }

    void copy_values(vtkPolyData& fewer) const {
        for (int i = 0; i < surface_.GetPointData()->GetNumberOfArrays(); ++i) {
            if (auto* values = surface_.GetPointData()->GetArray(i);
                values != nullptr && values->GetName() != nullptr) {
                fewer.GetPointData()->AddArray(means(*values));
            }
        }
        for (int i = 0; i < surface_.GetCellData()->GetNumberOfArrays(); ++i) {
            auto* values = surface_.GetCellData()->GetArray(i);
            if (values == nullptr || values->GetName() == nullptr) {
                continue;
            }
            auto some = like(*values, kept_.size());
            for (std::size_t k = 0; k < kept_.size(); ++k) {
                for (int c = 0; c < values->GetNumberOfComponents(); ++c) {
                    some->SetComponent(static_cast<vtkIdType>(k), c, values->GetComponent(kept_[k].face, c));
                }
            }
            fewer.GetCellData()->AddArray(some);
        }
    }

    static vtkSmartPointer<vtkFloatArray> like(vtkDataArray& values, std::size_t count) {
        auto array = vtkSmartPointer<vtkFloatArray>::New();
        array->SetName(values.GetName());
        array->SetNumberOfComponents(values.GetNumberOfComponents());
        array->SetNumberOfTuples(static_cast<vtkIdType>(count));
        array->Fill(0);
        return array;
    }

    [[nodiscard]] vtkSmartPointer<vtkFloatArray> means(vtkDataArray& values) const {
        const int components = values.GetNumberOfComponents();
        auto array = like(values, clusters_.size());
        float* sums = array->GetPointer(0);
        for (std::size_t p = 0; p < places_.size(); ++p) {
            const auto id = static_cast<std::size_t>(of_point_[p]);
            for (int c = 0; c < components; ++c) {
                sums[id * static_cast<std::size_t>(components) + static_cast<std::size_t>(c)] +=
                    static_cast<float>(values.GetComponent(static_cast<vtkIdType>(p), c) / clusters_[id].points);
            }
        }
        return array;
    }

    Cluster& cluster_of(vtkIdType point) {
        return clusters_[static_cast<std::size_t>(of_point_[static_cast<std::size_t>(point)])];
    }

    vtkPolyData& surface_;
    core::Progress& progress_;
    Vector3d corner_;
    double size_ = 1;
    std::array<std::int64_t, 3> counts_{};
    std::vector<Eigen::Vector3f> places_;  ///< in cubes, from the corner of all
    std::vector<std::int32_t> of_point_;
    std::vector<bool> on_rim_;
    std::vector<Cluster> clusters_;
    std::vector<Kept> kept_;
};

}  // namespace

double stand_in_size(const std::vector<vtkPolyData*>& surfaces, std::size_t faces) {
    double area = 0;
    for (auto* surface : surfaces) {
        each_triangle(*surface, core::Progress::none(), [&](vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType) {
            Vector3d at[3];
            surface->GetPoint(a, at[0].data());
            surface->GetPoint(b, at[1].data());
            surface->GetPoint(c, at[2].data());
            area += 0.5 * (at[1] - at[0]).cross(at[2] - at[0]).norm();
        });
    }
    // A surface that lies anywhere to the cubes crosses one and a half of them on each square of their side, with two
    // faces each.
    return std::sqrt(3 * area / static_cast<double>(std::max<std::size_t>(1, faces)));
}

vtkSmartPointer<vtkPolyData> stand_in(vtkPolyData& surface, double size, core::Progress& progress) {
    if (surface.GetNumberOfPoints() == 0 || !(size > 0)) {
        return vtkSmartPointer<vtkPolyData>::New();
    }
    return Clustering(surface, size, progress).result();
}

vtkSmartPointer<vtkPolyData> with_normals(vtkPolyData& surface) {
    vtkNew<vtkFloatArray> normals;
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
    normals->SetNumberOfTuples(surface.GetNumberOfPoints());
    normals->Fill(0);
    float* sums = normals->GetPointer(0);
    each_triangle(surface, core::Progress::none(), [&](vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType) {
        std::array<Vector3d, 3> at;
        surface.GetPoint(a, at[0].data());
        surface.GetPoint(b, at[1].data());
        surface.GetPoint(c, at[2].data());
        const Eigen::Vector3f across = (at[1] - at[0]).cross(at[2] - at[0]).cast<float>();
        for (const vtkIdType corner : {a, b, c}) {
            Eigen::Map<Eigen::Vector3f>(sums + 3 * corner) += across;
        }
    });
    for (vtkIdType i = 0; i < surface.GetNumberOfPoints(); ++i) {
        Eigen::Map<Eigen::Vector3f> normal(sums + 3 * i);
        const float length = normal.norm();
        normal = length > 0 ? Eigen::Vector3f(normal / length) : Eigen::Vector3f(0, 0, 1);
    }
    auto same = vtkSmartPointer<vtkPolyData>::New();
    same->ShallowCopy(&surface);
    same->GetPointData()->SetNormals(normals);
    return same;
}

}  // namespace underbody::postproc
