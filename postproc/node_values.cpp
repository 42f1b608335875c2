#include "postproc/node_values.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
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
#include "postproc/field.h"
#include "postproc/surface_arrays.h"

namespace underbody::postproc {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t block = 4096;

std::vector<Index> integers(vtkDataArray& array) {
    std::vector<Index> result(static_cast<std::size_t>(array.GetNumberOfValues()));
    if (auto* wide = vtkArrayDownCast<vtkCellArray::ArrayType64>(&array)) {
        std::copy_n(wide->GetPointer(0), result.size(), result.begin());
    } else if (auto* narrow = vtkArrayDownCast<vtkCellArray::ArrayType32>(&array)) {
        std::copy_n(narrow->GetPointer(0), result.size(), result.begin());
    }
    return result;
}

/// Rows of numbers, one after the other.
struct Rows {
    std::vector<Index> offsets{0};  ///< one more than rows
    std::vector<Index> values;

    [[nodiscard]] std::size_t count() const { return offsets.size() - 1; }
    [[nodiscard]] std::span<const Index> operator[](std::size_t row) const {
        return {values.data() + offsets[row], static_cast<std::size_t>(offsets[row + 1] - offsets[row])};
    }
};

Rows rows_of(vtkCellArray& cells) {
    Rows rows;
    if (cells.GetNumberOfCells() > 0) {
        rows.offsets = integers(*cells.GetOffsetsArray());
        rows.values = integers(*cells.GetConnectivityArray());
    }
    return rows;
}

/// For each node the cells that have it.
Rows turned_round(const Rows& cells, std::size_t nodes) {
    Rows result;
    result.offsets.assign(nodes + 1, 0);
    for (const Index node : cells.values) {
        ++result.offsets[static_cast<std::size_t>(node) + 1];
    }
    for (std::size_t i = 0; i < nodes; ++i) {
        result.offsets[i + 1] += result.offsets[i];
    }
    result.values.resize(cells.values.size());
    std::vector<Index> next(result.offsets.begin(), result.offsets.end() - 1);
    for (std::size_t c = 0; c < cells.count(); ++c) {
        for (const Index node : cells[c]) {
            result.values[static_cast<std::size_t>(next[static_cast<std::size_t>(node)]++)] = static_cast<Index>(c);
        }
    }
    return result;
}

/// The faces of VTK's linear cells by their nodes; -1 ends a triangle early.
using Faces = std::span<const std::array<int, 4>>;
Faces faces_of(int type) {
    static constexpr std::array<std::array<int, 4>, 4> tetra = {{{0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}, {0, 2, 1, -1}}};
    static constexpr std::array<std::array<int, 4>, 6> hexahedron = {{{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
    static constexpr std::array<std::array<int, 4>, 6> voxel = {{{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}};
    static constexpr std::array<std::array<int, 4>, 5> wedge = {{{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
    static constexpr std::array<std::array<int, 4>, 5> pyramid = {{{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};
    switch (type) {
        case VTK_TETRA: return tetra;
        case VTK_HEXAHEDRON: return hexahedron;
        case VTK_VOXEL: return voxel;
        case VTK_WEDGE: return wedge;
        case VTK_PYRAMID: return pyramid;
        default: return {};
    }
}

/// Centre of gravity in the making: pieces with their sizes, about a point near by.
struct Centre {
    Vector3d sum = Vector3d::Zero();
    double size = 0;
    void add(const Vector3d& at, double much) {
        sum += much * at;
        size += much;
    }
    [[nodiscard]] Vector3d place(const Vector3d& otherwise) const { return size > 0 ? Vector3d(sum / size) : otherwise; }
};

/// Where a boundary zone touches the cells.
struct Boundary {
    const Zone* zone = nullptr;
    Rows faces;                              ///< by the zone's own nodes; of a plane case its lines
    std::vector<Index> owner;                ///< cell behind each face, -1: none of these
    std::vector<Vector3d> centre;            ///< of each face
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
    void add(const Vector3d& step, Difference&& difference) {
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
        constexpr double nothing = 1e-3;  // of the best known direction: a plane case, a single layer of cells, a flat surface
        const double trace = matrix_.trace();
        const double determinant = matrix_.determinant();
        if (determinant > 10 * nothing * trace * trace * trace / 27) {
            return matrix_.inverse() * right_;
        }
        const Eigen::SelfAdjointEigenSolver<Matrix3d> solved(matrix_);
        const Vector3d values = solved.eigenvalues();
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
    Carrier(vtkPointSet& data, vtkCellArray& cells) : data_(data), cells_(rows_of(cells)) {
        if (data.GetPoints() != nullptr) {
            points_ = values_of(*data.GetPoints()->GetData(), own_points_);
        }
        around_ = turned_round(cells_, points_.size() / 3);
    }

    void find_centres(vtkUnstructuredGrid& grid) {
        centres_.resize(cells_.count());
        opening_.assign(around_.count(), Vector3d::Zero());
        size_.assign(around_.count(), 0);
        for (std::size_t c = 0; c < cells_.count(); ++c) {
            centres_[c] = centre_of(grid, c);
        }
    }

    void find_centres() {
        centres_.resize(cells_.count());
        for (std::size_t c = 0; c < cells_.count(); ++c) {
            centres_[c] = centre_of_polygon(cells_[c], [&](Index node) { return point(node); });
        }
    }

    void know(const std::vector<const Zone*>& zones) {
        std::unordered_map<std::array<double, 3>, std::vector<Index>, SamePlace> at;  // grid nodes at the boundaries' places
        const auto key = [](const double* x) { return std::array<double, 3>{x[0], x[1], x[2]}; };
        std::vector<std::vector<double>> own(zones.size());
        std::vector<std::span<const double>> places;
        for (std::size_t z = 0; z < zones.size(); ++z) {
            places.push_back(values_of(*zones[z]->surface->GetPoints()->GetData(), own[z]));
            for (std::size_t i = 0; i < places[z].size(); i += 3) {
                at.try_emplace(key(places[z].data() + i));
            }
        }
        for (std::size_t i = 0; 3 * i < points_.size() && !at.empty(); ++i) {
            if (const auto found = at.find(key(points_.data() + 3 * i)); found != at.end()) {
                found->second.push_back(static_cast<Index>(i));
            }
        }
        for (std::size_t z = 0; z < zones.size(); ++z) {
            Boundary boundary;
            boundary.zone = zones[z];
            boundary.faces = rows_of(zones[z]->surface->GetNumberOfPolys() > 0 ? *zones[z]->surface->GetPolys() : *zones[z]->surface->GetLines());
            for (std::size_t i = 0; i < places[z].size(); i += 3) {
                boundary.places.push_back(at.at(key(places[z].data() + i)));
            }
            for (std::size_t f = 0; f < boundary.faces.count(); ++f) {
                boundary.owner.push_back(owner_of(boundary.faces[f], boundary.places));
                boundary.centre.push_back(centre_of_polygon(boundary.faces[f], [&](Index node) { return Vector3d(places[z].data() + 3 * node); }));
            }
            boundaries_.push_back(std::move(boundary));
        }
    }

    [[nodiscard]] vtkSmartPointer<vtkDoubleArray> of(const std::string& name) const {
        auto* in_cells = data_.GetCellData()->GetArray(name.c_str());
        if (in_cells == nullptr || static_cast<std::size_t>(in_cells->GetNumberOfTuples()) != cells_.count()) {
            throw core::InputError("missing", "no values of '" + name + "' in the cells");
        }
        std::vector<double> own;
        const Values values{values_of(*in_cells, own), in_cells->GetNumberOfComponents()};
        const Slopes slopes = slopes_of(values);
        auto result = vtkSmartPointer<vtkDoubleArray>::New();
        result->SetName(name.c_str());
        result->SetNumberOfComponents(values.components);
        result->SetNumberOfTuples(static_cast<vtkIdType>(around_.count()));
        double* out = result->GetPointer(0);
        const bool never_negative = values.components == 1 && std::none_of(values.data.begin(), values.data.end(), [](double v) { return v < 0; });
        core::parallel_blocks(around_.count(), block, [&](std::size_t from, std::size_t to) {
            for (std::size_t node = from; node < to; ++node) {
                for (int k = 0; k < values.components; ++k) {
                    const double value = mean_around(node, values, slopes, k);
                    out[node * static_cast<std::size_t>(values.components) + static_cast<std::size_t>(k)] = never_negative && value < 0 ? 0 : value;
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
        [[nodiscard]] std::size_t at(Index cell, int k) const { return static_cast<std::size_t>(cell) * static_cast<std::size_t>(components) + static_cast<std::size_t>(k); }
        [[nodiscard]] double operator()(Index cell, int k) const { return data[at(cell, k)]; }
    };

    /// By component of each cell.
    struct Slopes {
        std::vector<double> gradients;  ///< three numbers each
        std::vector<double> low, high;  ///< of the cell and those around it
        explicit Slopes(std::size_t count) : gradients(3 * count), low(count), high(count) {}
    };

    [[nodiscard]] Vector3d point(Index node) const { return Vector3d(points_.data() + 3 * node); }

    template <typename Point>
    static Vector3d centre_of_polygon(std::span<const Index> nodes, Point&& at) {
        if (nodes.empty()) {
            return Vector3d::Constant(nan);
        }
        Vector3d mean = Vector3d::Zero();
        for (const Index node : nodes) {
            mean += at(node) / static_cast<double>(nodes.size());
        }
        Centre centre;
        for (std::size_t i = 0; i < nodes.size() && nodes.size() > 3; ++i) {
            const Vector3d a = at(nodes[i]);
            const Vector3d b = at(nodes[(i + 1) % nodes.size()]);
            centre.add((mean + a + b) / 3, (a - mean).cross(b - mean).norm());
        }
        return centre.place(mean);
    }

    /// A side of a cell, for the nodes on it: around a node with cells on all sides these sum to nothing.
    void note_side(std::span<const Index> nodes, const Vector3d& outward) {
        for (const Index node : nodes) {
            opening_[static_cast<std::size_t>(node)] += outward;
            size_[static_cast<std::size_t>(node)] += outward.norm();
        }
    }

    /// Of a cell that can be seen whole from the mean of its nodes.
    [[nodiscard]] Vector3d centre_of(vtkUnstructuredGrid& grid, std::size_t cell) {
        const auto nodes = cells_[cell];
        const int type = grid.GetCellType(static_cast<vtkIdType>(cell));
        if (type == VTK_TRIANGLE || type == VTK_QUAD || type == VTK_POLYGON) {
            const Vector3d centre = centre_of_polygon(nodes, [&](Index node) { return point(node); });
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                const std::array<Index, 2> edge = {nodes[i], nodes[(i + 1) % nodes.size()]};
                const Vector3d along = point(edge[1]) - point(edge[0]);
                note_side(edge, (point(edge[0]) - centre).cross(along)[2] < 0 ? Vector3d(-along) : along);
            }
            return centre;
        }
        Vector3d mean = Vector3d::Zero();
        for (const Index node : nodes) {
            mean += point(node) / static_cast<double>(nodes.size());
        }
        Centre centre;
        const auto add_face = [&](std::span<const Index> face) {
            Vector3d middle = Vector3d::Zero();
            for (const Index node : face) {
                middle += point(node) / static_cast<double>(face.size());
            }
            Vector3d area = Vector3d::Zero();
            for (std::size_t i = 0; i < face.size(); ++i) {
                const Vector3d a = point(face[i]);
                const Vector3d b = point(face[(i + 1) % face.size()]);
                centre.add((mean + middle + a + b) / 4, std::abs((middle - mean).dot((a - mean).cross(b - mean))));
                area += (a - middle).cross(b - middle);
            }
            note_side(face, area.dot(middle - mean) < 0 ? Vector3d(-area) : area);
        };
        if (type == VTK_POLYHEDRON) {
            vtkIdType faces = 0;
            const vtkIdType* stream = nullptr;
            grid.GetFaceStream(static_cast<vtkIdType>(cell), faces, stream);
            for (vtkIdType f = 0; f < faces; ++f) {
                const std::vector<Index> face(stream + 1, stream + 1 + *stream);
                add_face(face);
                stream += 1 + *stream;
            }
        } else {
            for (const auto& local : faces_of(type)) {
                std::array<Index, 4> face{};
                std::size_t count = 0;
                for (; count < 4 && local[count] >= 0; ++count) {
                    face[count] = nodes[static_cast<std::size_t>(local[count])];
                }
                add_face({face.data(), count});
            }
        }
        return centre.place(mean);
    }

    /// The cell that has all nodes of a face.
    [[nodiscard]] Index owner_of(std::span<const Index> face, const std::vector<std::vector<Index>>& places) const {
        if (face.empty()) {
            return -1;
        }
        const auto has = [&](Index cell, Index node) {
            const auto nodes = cells_[static_cast<std::size_t>(cell)];
            const auto& same = places[static_cast<std::size_t>(node)];
            return std::any_of(same.begin(), same.end(), [&](Index at) { return std::find(nodes.begin(), nodes.end(), at) != nodes.end(); });
        };
        for (const Index first : places[static_cast<std::size_t>(face[0])]) {
            for (const Index cell : around_[static_cast<std::size_t>(first)]) {
                if (std::all_of(face.begin(), face.end(), [&](Index node) { return has(cell, node); })) {
                    return cell;
                }
            }
        }
        return -1;
    }

    /// The array on the faces of a boundary, if it is there as in the cells.
    static std::optional<Values> on_faces(const Boundary& boundary, const std::string& name, int components, std::vector<double>& own) {
        auto* array = boundary.zone->surface->GetCellData()->GetArray(name.c_str());
        if (array == nullptr || array->GetNumberOfComponents() != components || static_cast<std::size_t>(array->GetNumberOfTuples()) != boundary.owner.size()) {
            return {};
        }
        return Values{values_of(*array, own), components};
    }

    [[nodiscard]] Slopes slopes_of(const Values& values) const {
        Slopes slopes(cells_.count() * static_cast<std::size_t>(values.components));
        core::parallel_blocks(cells_.count(), block, [&](std::size_t from, std::size_t to) {
            for (std::size_t c = from; c < to; ++c) {
                const auto cell = static_cast<Index>(c);
                Fit fit(values.components);
                for (int k = 0; k < values.components; ++k) {
                    slopes.low[values.at(cell, k)] = slopes.high[values.at(cell, k)] = values(cell, k);
                }
                for (const Index node : cells_[c]) {
                    for (const Index other : around_[static_cast<std::size_t>(node)]) {  // who shares more nodes counts more
                        if (other != cell && std::isfinite(values(other, 0))) {
                            for (int k = 0; k < values.components; ++k) {
                                double& low = slopes.low[values.at(cell, k)];
                                double& high = slopes.high[values.at(cell, k)];
                                low = std::min(low, values(other, k));
                                high = std::max(high, values(other, k));
                            }
                            fit.add(centres_[static_cast<std::size_t>(other)] - centres_[c], [&](int k) { return values(other, k) - values(cell, k); });
                        }
                    }
                }
                const Eigen::Matrix3Xd gradient = fit.gradients();
                std::copy_n(gradient.data(), gradient.size(), slopes.gradients.data() + 3 * values.at(cell, 0));
            }
        });
        return slopes;
    }

    static double along(const Slopes& slopes, const Values& values, Index cell, int k, const Vector3d& step) {
        const double* g = slopes.gradients.data() + 3 * values.at(cell, k);
        return g[0] * step[0] + g[1] * step[1] + g[2] * step[2];
    }

    /// At the boundary no further outside the cells around the node than these and the next ones differ among themselves.
    [[nodiscard]] double mean_around(std::size_t node, const Values& values, const Slopes& slopes, int k) const {
        constexpr double far = std::numeric_limits<double>::infinity();
        double sum = 0;
        int count = 0;
        std::array<double, 2> near = {far, -far};
        std::array<double, 2> wide = {far, -far};
        for (const Index cell : around_[node]) {
            const double value = values(cell, k);
            if (!std::isfinite(value)) {
                continue;
            }
            sum += value + along(slopes, values, cell, k, point(static_cast<Index>(node)) - centres_[static_cast<std::size_t>(cell)]);
            ++count;
            near = {std::min(near[0], value), std::max(near[1], value)};
            wide = {std::min(wide[0], slopes.low[values.at(cell, k)]), std::max(wide[1], slopes.high[values.at(cell, k)])};
        }
        // With cells on all sides the node lies among their middles, and its value among theirs.
        const bool inside = !size_.empty() && opening_[node].norm() < 1e-9 * size_[node];
        const double room = inside ? 0 : wide[1] - wide[0];
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
                        const auto nodes = cells_[static_cast<std::size_t>(cell)];
                        if (std::find(nodes.begin(), nodes.end(), at) == nodes.end()) {
                            continue;  // the other side of a baffle
                        }
                        Sum& sum = sums[at];
                        if (sum.value.empty() || (holds && !sum.wall)) {  // at the edge of an inlet the wall holds the water
                            sum = {std::vector<double>(static_cast<std::size_t>(values.components), 0), 0, holds};
                        }
                        if (sum.wall != holds) {
                            continue;
                        }
                        ++sum.count;
                        for (int k = 0; k < values.components; ++k) {
                            sum.value[static_cast<std::size_t>(k)] += (*known)(face, k) + (holds ? 0 : along(slopes, values, cell, k, point(at) - boundary.centre[f]));
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
    Rows cells_;
    Rows around_;
    std::span<const double> points_;
    std::vector<double> own_points_;
    std::vector<Vector3d> centres_;
    std::vector<Vector3d> opening_;  ///< of a grid, by node, see `note_side`
    std::vector<double> size_;
    std::vector<Boundary> boundaries_;
};

NodeValues::NodeValues(vtkUnstructuredGrid& grid, const std::vector<const Zone*>& boundaries) : carrier_(std::make_unique<Carrier>(grid, *grid.GetCells())) {
    carrier_->find_centres(grid);
    carrier_->know(boundaries);
}

NodeValues::NodeValues(vtkPolyData& surface) : carrier_(std::make_unique<Carrier>(surface, *surface.GetPolys())) { carrier_->find_centres(); }

NodeValues::~NodeValues() = default;

vtkSmartPointer<vtkDoubleArray> NodeValues::of(const std::string& name) const { return carrier_->of(name); }

}  // namespace underbody::postproc
