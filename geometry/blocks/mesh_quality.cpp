#include "geometry/blocks/mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/angle.h"
#include "core/counted.h"
#include "core/text.h"

namespace underbody::geometry {

namespace {

using core::degree;

struct FaceGeometry {
    Vec3 centre, area;
};

/// By triangles about the mean of the corners, each with its weight.
FaceGeometry face_geometry(const PolyMesh& mesh, const Quad& face) {
    const auto corner = [&](std::size_t c) -> const Vec3& { return mesh.points[static_cast<std::size_t>(face[c])]; };
    const Vec3 middle = 0.25 * (corner(0) + corner(1) + corner(2) + corner(3));
    Vec3 sum_area, sum_centre;
    double sum = 0;
    for (std::size_t c = 0; c < 4; ++c) {
        const Vec3 &p = corner(c), &q = corner((c + 1) % 4);
        const Vec3 n = cross(q - p, middle - p);
        const double a = norm(n);
        sum_area += n;
        sum += a;
        sum_centre += a * (p + q + middle);
    }
    return {sum > 0 ? sum_centre / (3 * sum) : middle, 0.5 * sum_area};
}

struct Cells {
    std::vector<Vec3> centre;
    std::vector<double> volume;
    std::vector<Vec3> open;   // sum of area vectors
    std::vector<Vec3> areas;  // sum of their sizes by component
};

Cells cells_of(const PolyMesh& mesh, const std::vector<FaceGeometry>& faces) {
    Cells cells{std::vector<Vec3>(mesh.cells), std::vector<double>(mesh.cells, 0.0), std::vector<Vec3>(mesh.cells),
                std::vector<Vec3>(mesh.cells)};
    std::vector<Vec3> middle(mesh.cells);
    std::vector<int> count(mesh.cells, 0);
    const auto each = [&](const auto& act) {
        for (std::size_t f = 0; f < faces.size(); ++f) {
            act(static_cast<std::size_t>(mesh.owner[f]), faces[f], 1.0);
            if (f < mesh.inner_faces()) {
                act(static_cast<std::size_t>(mesh.neighbour[f]), faces[f], -1.0);
            }
        }
    };
    each([&](std::size_t c, const FaceGeometry& face, double sign) {
        middle[c] += face.centre;
        ++count[c];
        cells.open[c] += sign * face.area;
        cells.areas[c] += {std::abs(face.area.x), std::abs(face.area.y), std::abs(face.area.z)};
    });
    for (std::size_t c = 0; c < mesh.cells; ++c) {
        middle[c] *= 1.0 / count[c];
    }
    each([&](std::size_t c, const FaceGeometry& face, double sign) {
        const double pyramid = sign * dot(face.area, face.centre - middle[c]);
        cells.centre[c] += pyramid * (0.75 * face.centre + 0.25 * middle[c]);
        cells.volume[c] += pyramid;
    });
    for (std::size_t c = 0; c < mesh.cells; ++c) {
        cells.centre[c] = cells.volume[c] != 0 ? cells.centre[c] / cells.volume[c] : middle[c];
        cells.volume[c] /= 3;
    }
    return cells;
}

/// How far the line from `from` along `way` misses the face's centre, over the size of the face in that direction.
double skewness(const PolyMesh& mesh, std::size_t f, const FaceGeometry& face, const Vec3& from, const Vec3& way,
                double share) {
    const Vec3 to_face = face.centre - from;
    const double along = dot(face.area, way);
    const Vec3 miss = to_face - (dot(face.area, to_face) / (along != 0 ? along : 1e-300)) * way;
    const double size = norm(miss);
    if (size == 0) {
        return 0;
    }
    double extent = share * norm(way);
    for (const std::int32_t p : mesh.faces[f]) {
        extent = std::max(extent, std::abs(dot(miss, mesh.points[static_cast<std::size_t>(p)] - face.centre)) / size);
    }
    return size / extent;
}

/// The centres of the faces that are worst.
struct WorstFaces {
    Vec3 skewed, inverted;
};

void measure_cells(MeshQuality& q, const Cells& cells) {
    q.smallest_volume = HUGE_VAL;
    for (std::size_t c = 0; c < cells.volume.size(); ++c) {
        q.volume += cells.volume[c];
        q.smallest_volume = std::min(q.smallest_volume, cells.volume[c]);
        if (!(cells.volume[c] > 0)) {
            q.where = q.negative_volumes++ == 0 ? cells.centre[c] : q.where;
        }
        const Vec3 &open = cells.open[c], &area = cells.areas[c];
        q.cell_openness = std::max(
            {q.cell_openness, std::abs(open.x) / area.x, std::abs(open.y) / area.y, std::abs(open.z) / area.z});
    }
}

void measure_inner_faces(MeshQuality& q, const PolyMesh& mesh, const std::vector<FaceGeometry>& faces,
                         const Cells& cells, WorstFaces& worst) {
    double cosines = 0, worst_cosine = 1;
    for (std::size_t f = 0; f < mesh.inner_faces(); ++f) {
        const Vec3& from = cells.centre[static_cast<std::size_t>(mesh.owner[f])];
        const Vec3 way = cells.centre[static_cast<std::size_t>(mesh.neighbour[f])] - from;
        const double cosine =
            std::clamp(dot(way, faces[f].area) / std::max(1e-300, norm(way) * norm(faces[f].area)), -1.0, 1.0);
        cosines += cosine;
        worst_cosine = std::min(worst_cosine, cosine);
        q.severe_non_orthogonality += cosine < std::cos(70 * degree) ? 1 : 0;
        if (cosine <= 0) {
            worst.inverted = q.inverted_faces++ == 0 ? faces[f].centre : worst.inverted;
        }
        const double skew = skewness(mesh, f, faces[f], from, way, 0.2);
        if (skew > q.largest_skewness) {
            q.largest_skewness = skew;
            worst.skewed = faces[f].centre;
        }
    }
    q.largest_non_orthogonality = std::acos(worst_cosine);
    q.mean_non_orthogonality = std::acos(cosines / std::max<double>(1, static_cast<double>(mesh.inner_faces())));
}

void measure_boundary(MeshQuality& q, const PolyMesh& mesh, const std::vector<FaceGeometry>& faces, const Cells& cells,
                      WorstFaces& worst) {
    Vec3 open;
    double boundary = 0;
    for (std::size_t f = mesh.inner_faces(); f < faces.size(); ++f) {
        const Vec3& from = cells.centre[static_cast<std::size_t>(mesh.owner[f])];
        const Vec3 normal = unit(faces[f].area);
        const double skew = skewness(mesh, f, faces[f], from, dot(normal, faces[f].centre - from) * normal, 0.4);
        if (skew > q.largest_skewness) {
            q.largest_skewness = skew;
            worst.skewed = faces[f].centre;
        }
        open += faces[f].area;
        boundary += norm(faces[f].area);
    }
    q.boundary_openness = norm(open) / boundary;
}

/// Distance of the body's walls from the centres of the cells on them.
void measure_wall_distance(MeshQuality& q, const PolyMesh& mesh, const std::vector<FaceGeometry>& faces,
                           const Cells& cells, const std::vector<std::string>& body_walls) {
    double area = 0;
    q.wall_distance_smallest = HUGE_VAL;
    for (const std::string& name : body_walls) {
        const auto& patch = mesh.patch(name);
        for (std::size_t f = patch.first; f < patch.first + patch.count; ++f) {
            const double size = norm(faces[f].area);
            const double distance =
                dot(faces[f].area, faces[f].centre - cells.centre[static_cast<std::size_t>(mesh.owner[f])]) / size;
            q.wall_distance_smallest = std::min(q.wall_distance_smallest, distance);
            q.wall_distance_largest = std::max(q.wall_distance_largest, distance);
            q.wall_distance_mean += size * distance;
            area += size;
        }
    }
    q.wall_distance_mean /= area > 0 ? area : 1;
}

}  // namespace

MeshQuality measure(const PolyMesh& mesh, const std::vector<std::string>& body_walls) {
    std::vector<FaceGeometry> faces;
    faces.reserve(mesh.faces.size());
    for (const Quad& face : mesh.faces) {
        faces.push_back(face_geometry(mesh, face));
    }
    const Cells cells = cells_of(mesh, faces);
    MeshQuality q;
    q.cells = mesh.cells;
    q.faces = mesh.faces.size();
    q.points = mesh.points.size();
    measure_cells(q, cells);
    WorstFaces worst;
    measure_inner_faces(q, mesh, faces, cells, worst);
    measure_boundary(q, mesh, faces, cells, worst);
    measure_wall_distance(q, mesh, faces, cells, body_walls);
    q.where = q.negative_volumes > 0 ? q.where : q.inverted_faces > 0 ? worst.inverted : worst.skewed;
    return q;
}

std::string fault_of(const MeshQuality& q) {
    const std::string place = " near (" + core::format_number(1000 * q.where.x, 4) + ", " +
                              core::format_number(1000 * q.where.y, 4) + ", " +
                              core::format_number(1000 * q.where.z, 4) + ") mm";
    if (q.negative_volumes > 0) {
        return core::counted(q.negative_volumes, "cell is", "cells are") + " turned inside out," + place;
    }
    if (q.inverted_faces > 0) {
        return core::counted(q.inverted_faces, "face is turned against its cells",
                             "faces are turned against their cells") +
               "," + place;
    }
    if (q.largest_non_orthogonality > largest_allowed_non_orthogonality) {
        return "a face stands " + core::format_number(q.largest_non_orthogonality / degree, 3) +
               " degrees off the line between its cells (at most " +
               core::format_number(largest_allowed_non_orthogonality / degree, 3) + ")";
    }
    if (q.largest_skewness > largest_allowed_skewness) {
        return "a skewness of " + core::format_number(q.largest_skewness, 3) + " (at most " +
               core::format_number(largest_allowed_skewness, 3) + ")," + place;
    }
    if (q.cell_openness > 1e-6 || q.boundary_openness > 1e-9) {
        return "the mesh does not close";
    }
    return {};
}

void to_json(nlohmann::json& json, const MeshQuality& q) {
    json = {{"cells", q.cells},
            {"faces", q.faces},
            {"points", q.points},
            {"volume", q.volume},
            {"smallest_volume", q.smallest_volume},
            {"negative_volumes", q.negative_volumes},
            {"largest_non_orthogonality", q.largest_non_orthogonality},
            {"mean_non_orthogonality", q.mean_non_orthogonality},
            {"severe_non_orthogonality", q.severe_non_orthogonality},
            {"inverted_faces", q.inverted_faces},
            {"largest_skewness", q.largest_skewness},
            {"cell_openness", q.cell_openness},
            {"boundary_openness", q.boundary_openness},
            {"wall_distance_smallest", q.wall_distance_smallest},
            {"wall_distance_mean", q.wall_distance_mean},
            {"wall_distance_largest", q.wall_distance_largest}};
}

}  // namespace underbody::geometry
