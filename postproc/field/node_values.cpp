#include "postproc/field/node_values.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <unordered_map>

#include "core/error.h"
#include "core/parallel.h"
#include "postproc/field/cell_geometry.h"
#include "postproc/field/field.h"
#include "postproc/field/surface_arrays.h"

namespace underbody::postproc {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t block = 4096;

/// Where a boundary zone touches the cells.
struct Boundary {
    const Zone* zone = nullptr;
    Rows faces;                              ///< by the zone's own nodes; of a plane case its lines
    std::vector<Index> owner;                ///< cell behind each face, -1: none of these
    std::vector<Vector> centre;              ///< of each face
    std::vector<std::vector<Index>> places;  ///< grid nodes at each node of the zone
};

/// Places by their exact coordinates: zones share the points of their volume.
struct SamePlace {
    std::size_t operator()(const std::array<double, 3>& p) const {
        std::size_t hash = 0;
        for (const double x : p) {
            std::uint64_t bits = 0;
            const double plain = x + 0.0;  // no minus zero
            std::memcpy(&bits, &plain, sizeof bits);
            hash = (hash ^ bits) * 0x9E3779B97F4A7C15ULL;
            hash ^= hash >> 29;
        }
        return hash;
    }
};

/// A gradient in the making by weighted least squares; directions that nothing is known of stay flat.
class Fit {
public:
    explicit Fit(int components) : right_(Eigen::Matrix3Xd::Zero(3, components)) {}

    template <typename Difference>
    void add(const Vector& along, Difference&& difference) {
        const Vector3d step(along.data());
        const double square = step.squaredNorm();
        if (!(square > 0)) {
            return;
        }
        const double weight = 1 / square;
        matrix_ += weight * step * step.transpose();
        for (Eigen::Index k = 0; k < right_.cols(); ++k) {
            right_.col(k) += weight * difference(static_cast<int>(k)) * step;
        }
    }

    /// Each column the gradient of one component.
    [[nodiscard]] Eigen::Matrix3Xd gradients() const {
        constexpr double nothing =
            1e-3;  // of the best known direction: a plane case, a single layer of cells, a flat surface
        const double trace = matrix_.trace();
        const double determinant = matrix_.determinant();
        if (determinant > 10 * nothing * trace * trace * trace / 27) {
            return matrix_.inverse() * right_;
        }
        const Eigen::SelfAdjointEigenSolver<Matrix3d> solved(matrix_);
        const Vector3d& values = solved.eigenvalues();
        Vector3d inverse = Vector3d::Zero();
        for (int k = 0; k < 3; ++k) {
            if (values[k] > nothing * values[2]) {
                inverse[k] = 1 / values[k];
            }
        }
        return solved.eigenvectors() * inverse.asDiagonal() * solved.eigenvectors().transpose() * right_;
    }

private:
    Matrix3d matrix_ = Matrix3d::Zero();
    Eigen::Matrix3Xd right_;
};

}  // namespace

class NodeValues::Carrier {
public:
    template <typename Data>
    explicit Carrier(Data& data) : data_(data), geometry_(data) {}

    void know(const std::vector<const Zone*>& zones) {
        std::unordered_map<std::array<double, 3>, std::vector<Index>, SamePlace>
            at;  // grid nodes at the boundaries' places
        const auto key = [](const double* x) { return std::array<double, 3>{x[0], x[1], x[2]}; };
        std::vector<std::vector<double>> own(zones.size());
        std::vector<std::span<const double>> places;
        for (std::size_t z = 0; z < zones.size(); ++z) {
            places.push_back(values_of(*zones[z]->surface->GetPoints()->GetData(), own[z]));
            for (std::size_t i = 0; i < places[z].size(); i += 3) {
                at.try_emplace(key(places[z].data() + i));
            }
        }
        for (std::size_t i = 0; i < geometry_.nodes() && !at.empty(); ++i) {
            if (const auto found = at.find(geometry_.point(static_cast<Index>(i))); found != at.end()) {
                found->second.push_back(static_cast<Index>(i));
            }
        }
        for (std::size_t z = 0; z < zones.size(); ++z) {
            Boundary boundary;
            boundary.zone = zones[z];
            boundary.faces = rows_of(zones[z]->surface->GetNumberOfPolys() > 0 ? *zones[z]->surface->GetPolys()
                                                                               : *zones[z]->surface->GetLines());
            for (std::size_t i = 0; i < places[z].size(); i += 3) {
                boundary.places.push_back(at.at(key(places[z].data() + i)));
            }
            for (std::size_t f = 0; f < boundary.faces.count(); ++f) {
                boundary.owner.push_back(owner_of(boundary.faces[f], boundary.places));
                std::vector<Vector> corners;
                for (const Index node : boundary.faces[f]) {
                    corners.push_back(key(places[z].data() + 3 * node));
                }
                boundary.centre.push_back(centre_of_polygon(corners));
            }
            boundaries_.push_back(std::move(boundary));
        }
    }

    [[nodiscard]] vtkSmartPointer<vtkDoubleArray> of(const std::string& name) const {
        auto* in_cells = data_.GetCellData()->GetArray(name.c_str());
        if (in_cells == nullptr ||
            static_cast<std::size_t>(in_cells->GetNumberOfTuples()) != geometry_.cells().count()) {
            throw core::InputError("missing", "no values of '" + name + "' in the cells");
        }
        std::vector<double> own;
        const Values values{values_of(*in_cells, own), in_cells->GetNumberOfComponents()};
        const Slopes slopes = slopes_of(values);
        auto result = vtkSmartPointer<vtkDoubleArray>::New();
        result->SetName(name.c_str());
        result->SetNumberOfComponents(values.components);
        result->SetNumberOfTuples(static_cast<vtkIdType>(geometry_.nodes()));
        double* out = result->GetPointer(0);
        const bool never_negative = values.components == 1 && std::none_of(values.data.begin(), values.data.end(),
                                                                           [](double v) { return v < 0; });
        core::parallel_blocks(geometry_.nodes(), block, [&](std::size_t from, std::size_t to) {
            for (std::size_t node = from; node < to; ++node) {
                for (int k = 0; k < values.components; ++k) {
                    const double value = mean_around(node, values, slopes, k);
                    out[node * static_cast<std::size_t>(values.components) + static_cast<std::size_t>(k)] =
                        never_negative && value < 0 ? 0 : value;
                }
            }
        });
        take_from_boundaries(name, values, slopes, out);
        return result;
    }

private:
    struct Values {
        std::span<const double> data;
        int components;
        [[nodiscard]] std::size_t at(Index cell, int k) const {
            return static_cast<std::size_t>(cell) * static_cast<std::size_t>(components) + static_cast<std::size_t>(k);
        }
        [[nodiscard]] double operator()(Index cell, int k) const { return data[at(cell, k)]; }
    };

    /// By component of each cell.
    struct Slopes {
        std::vector<double> gradients;  ///< three numbers each
        std::vector<double> low, high;  ///< of the cell and those around it
        explicit Slopes(std::size_t count) : gradients(3 * count), low(count), high(count) {}
    };

    /// The cell that has all nodes of a face.
    [[nodiscard]] Index owner_of(std::span<const Index> face, const std::vector<std::vector<Index>>& places) const {
        if (face.empty()) {
            return -1;
        }
        const auto has = [&](Index cell, Index node) {
            const auto nodes = geometry_.cells()[static_cast<std::size_t>(cell)];
            const auto& same = places[static_cast<std::size_t>(node)];
            return std::any_of(same.begin(), same.end(),
                               [&](Index at) { return std::find(nodes.begin(), nodes.end(), at) != nodes.end(); });
        };
        for (const Index first : places[static_cast<std::size_t>(face[0])]) {
            for (const Index cell : geometry_.around()[static_cast<std::size_t>(first)]) {
                if (std::all_of(face.begin(), face.end(), [&](Index node) { return has(cell, node); })) {
                    return cell;
                }
            }
        }
        return -1;
    }

    /// The array on the faces of a boundary, if it is there as in the cells.
    static std::optional<Values> on_faces(const Boundary& boundary, const std::string& name, int components,
                                          std::vector<double>& own) {
        auto* array = boundary.zone->surface->GetCellData()->GetArray(name.c_str());
        if (array == nullptr || array->GetNumberOfComponents() != components ||
            static_cast<std::size_t>(array->GetNumberOfTuples()) != boundary.owner.size()) {
            return {};
        }
        return Values{values_of(*array, own), components};
    }

    [[nodiscard]] Slopes slopes_of(const Values& values) const {
        Slopes slopes(geometry_.cells().count() * static_cast<std::size_t>(values.components));
        core::parallel_blocks(geometry_.cells().count(), block, [&](std::size_t from, std::size_t to) {
            for (std::size_t c = from; c < to; ++c) {
                const auto cell = static_cast<Index>(c);
                Fit fit(values.components);
                for (int k = 0; k < values.components; ++k) {
                    slopes.low[values.at(cell, k)] = slopes.high[values.at(cell, k)] = values(cell, k);
                }
                for (const Index node : geometry_.cells()[c]) {
                    for (const Index other :
                         geometry_.around()[static_cast<std::size_t>(node)]) {  // who shares more nodes counts more
                        if (other != cell && std::isfinite(values(other, 0))) {
                            for (int k = 0; k < values.components; ++k) {
                                double& low = slopes.low[values.at(cell, k)];
                                double& high = slopes.high[values.at(cell, k)];
                                low = std::min(low, values(other, k));
                                high = std::max(high, values(other, k));
                            }
                            fit.add(plus(geometry_.centre(other), geometry_.centre(cell), -1),
                                    [&](int k) { return values(other, k) - values(cell, k); });
                        }
                    }
                }
                const Eigen::Matrix3Xd gradient = fit.gradients();
                std::copy_n(gradient.data(), gradient.size(), slopes.gradients.data() + 3 * values.at(cell, 0));
            }
        });
        return slopes;
    }

    static double along(const Slopes& slopes, const Values& values, Index cell, int k, const Vector& step) {
        const double* g = slopes.gradients.data() + 3 * values.at(cell, k);
        return g[0] * step[0] + g[1] * step[1] + g[2] * step[2];
    }

    /// At the boundary no further outside the cells around the node than these and the next ones differ among
    /// themselves.
    [[nodiscard]] double mean_around(std::size_t node, const Values& values, const Slopes& slopes, int k) const {
        constexpr double far = std::numeric_limits<double>::infinity();
        double sum = 0;
        int count = 0;
        std::array<double, 2> near = {far, -far};
        std::array<double, 2> wide = {far, -far};
        for (const Index cell : geometry_.around()[node]) {
            const double value = values(cell, k);
            if (!std::isfinite(value)) {
                continue;
            }
            sum += value + along(slopes, values, cell, k,
                                 plus(geometry_.point(static_cast<Index>(node)), geometry_.centre(cell), -1));
            ++count;
            near = {std::min(near[0], value), std::max(near[1], value)};
            wide = {std::min(wide[0], slopes.low[values.at(cell, k)]),
                    std::max(wide[1], slopes.high[values.at(cell, k)])};
        }
        // With cells on all sides the node lies among their middles, and its value among theirs.
        const double room = geometry_.inside(node) ? 0 : wide[1] - wide[0];
        return count == 0 ? nan : std::clamp(sum / count, near[0] - room, near[1] + room);
    }

    void take_from_boundaries(const std::string& name, const Values& values, const Slopes& slopes, double* out) const {
        struct Sum {
            std::vector<double> value;
            int count = 0;
            bool wall = false;
        };
        std::unordered_map<Index, Sum> sums;
        for (const auto& boundary : boundaries_) {
            std::vector<double> own;
            const auto known = on_faces(boundary, name, values.components, own);
            if (!known) {
                continue;
            }
            const bool holds = boundary.zone->kind == ZoneKind::wall && name == "velocity";
            for (std::size_t f = 0; f < boundary.owner.size(); ++f) {
                const Index cell = boundary.owner[f];
                const auto face = static_cast<Index>(f);
                if (cell < 0 || !std::isfinite((*known)(face, 0)) || !std::isfinite(values(cell, 0))) {
                    continue;
                }
                for (const Index node : boundary.faces[f]) {
                    for (const Index at : boundary.places[static_cast<std::size_t>(node)]) {
                        const auto nodes = geometry_.cells()[static_cast<std::size_t>(cell)];
                        if (std::find(nodes.begin(), nodes.end(), at) == nodes.end()) {
                            continue;  // the other side of a baffle
                        }
                        Sum& sum = sums[at];
                        if (sum.value.empty() ||
                            (holds && !sum.wall)) {  // at the edge of an inlet the wall holds the water
                            sum = {std::vector<double>(static_cast<std::size_t>(values.components), 0), 0, holds};
                        }
                        if (sum.wall != holds) {
                            continue;
                        }
                        ++sum.count;
                        for (int k = 0; k < values.components; ++k) {
                            sum.value[static_cast<std::size_t>(k)] +=
                                (*known)(face, k) + (holds ? 0
                                                           : along(slopes, values, cell, k,
                                                                   plus(geometry_.point(at), boundary.centre[f], -1)));
                        }
                    }
                }
            }
        }
        for (const auto& [node, sum] : sums) {
            for (std::size_t k = 0; k < sum.value.size(); ++k) {
                out[static_cast<std::size_t>(node) * sum.value.size() + k] = sum.value[k] / sum.count;
            }
        }
    }

    vtkPointSet& data_;
    CellGeometry geometry_;
    std::vector<Boundary> boundaries_;
};

NodeValues::NodeValues(vtkUnstructuredGrid& grid, const std::vector<const Zone*>& boundaries)
    : carrier_(std::make_unique<Carrier>(grid)) {
    carrier_->know(boundaries);
}

NodeValues::NodeValues(vtkPolyData& surface) : carrier_(std::make_unique<Carrier>(surface)) {}

NodeValues::~NodeValues() = default;

vtkSmartPointer<vtkDoubleArray> NodeValues::of(const std::string& name) const { return carrier_->of(name); }

}  // namespace underbody::postproc
