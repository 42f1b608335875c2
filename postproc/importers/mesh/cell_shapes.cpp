#include "postproc/importers/mesh/cell_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace underbody::postproc {

namespace {

struct Vector {
    double x = 0, y = 0, z = 0;
};
Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double norm(const Vector& a) { return std::sqrt(dot(a, a)); }

/// Where `node` stands among the first `count` of `nodes`; `count`: nowhere.
template <std::uint32_t count>
std::uint32_t place_among(const std::uint32_t* nodes, std::uint32_t node) {
    std::uint32_t place = count;
    for (std::uint32_t i = 0; i < count; ++i) {
        place = nodes[i] == node ? i : place;
    }
    return place;
}

/// Does a ring of places go round once, forward (+1) or backward (-1)? 0: neither.
template <std::uint32_t count>
int sense_of(const std::uint32_t* places) {
    bool forward = true;
    bool backward = true;
    for (std::uint32_t k = 0; k < count; ++k) {
        const std::uint32_t here = places[k];
        const std::uint32_t next = places[(k + 1) % count];
        forward = forward && next == (here + 1) % count;
        backward = backward && here == (next + 1) % count;
    }
    return forward ? 1 : backward ? -1 : 0;
}

/// Fills the nodes above a base polygon of `sides` edges (hexahedron, wedge): each other face but the lid stands on one
/// edge of the base. False if the faces are no such prism. `sound`: all faces look the way the base makes them expect
/// (`base_looks_in`: the order of the base in `out` is the one that looks into the cell).
template <std::uint32_t sides>
bool raise(const std::vector<FaceView>& faces, std::size_t base, bool base_looks_in, std::uint32_t* out, bool& sound) {
    std::uint32_t* const above = out + sides;
    std::fill_n(above, sides, 0U);
    const FaceView* lid = nullptr;
    unsigned edges = 0;
    sound = true;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const FaceView& face = faces[f];
        if (f == base) {
            continue;
        }
        std::array<std::uint32_t, 4> places{};
        unsigned inside = 0;
        for (std::uint32_t k = 0; k < 4 && face.size == 4; ++k) {
            places[k] = place_among<sides>(out, face.nodes[k]);
            inside += places[k] < sides ? 1 : 0;
        }
        if (inside == 0 && face.size == sides && lid == nullptr) {
            lid = &face;
            continue;
        }
        if (inside != 2) {
            return false;
        }
        std::uint32_t k = 0;
        while (k < 4 && (places[k] == sides || places[(k + 1) % 4] == sides)) {
            ++k;
        }
        if (k == 4) {
            return false;
        }
        const std::uint32_t p = places[k];
        const std::uint32_t q = places[(k + 1) % 4];
        const bool forward = (p + 1) % sides == q;
        if (!forward && (q + 1) % sides != p) {
            return false;
        }
        edges |= 1U << (forward ? p : q);
        sound = sound && forward == (base_looks_in != face.inward);
        for (const auto& [place, node] :
             {std::pair{p, face.nodes[(k + 3) % 4]}, std::pair{q, face.nodes[(k + 2) % 4]}}) {
            if (above[place] != 0 && above[place] != node) {
                return false;
            }
            above[place] = node;
        }
    }
    if (lid == nullptr || edges != (1U << sides) - 1) {
        return false;
    }
    std::array<std::uint32_t, sides> places{};
    for (std::uint32_t k = 0; k < sides; ++k) {
        places[k] = place_among<sides>(above, lid->nodes[k]);
    }
    const int sense =
        std::find(places.begin(), places.end(), sides) == places.end() ? sense_of<sides>(places.data()) : 0;
    sound = sound && (sense > 0) == (base_looks_in != lid->inward);
    return sense != 0;
}

std::size_t first_of_size(const std::vector<FaceView>& faces, std::uint32_t size) {
    std::size_t f = 0;
    while (f < faces.size() && faces[f].size != size) {
        ++f;
    }
    return f;
}

/// The node of `face` that is none of the `count` in `known`; 0: all are known.
std::uint32_t other_node(const FaceView& face, const std::uint32_t* known, std::uint32_t count) {
    for (std::uint32_t i = 0; i < face.size; ++i) {
        if (std::find(known, known + count, face.nodes[i]) == known + count) {
            return face.nodes[i];
        }
    }
    return 0;
}

/// Is every face made of these nodes only?
bool only(const std::vector<FaceView>& faces, const std::uint32_t* nodes, std::uint32_t count) {
    return std::all_of(faces.begin(), faces.end(),
                       [&](const FaceView& face) { return other_node(face, nodes, count) == 0; });
}

/// Type of a 3-D cell and, for the standard ones, its nodes in VTK's order.
unsigned char standard_cell(const std::vector<FaceView>& faces, std::array<std::uint32_t, 8>& out,
                            bool& sound_hexahedron) {
    std::size_t triangles = 0;
    std::size_t quads = 0;
    for (const auto& face : faces) {
        triangles += face.size == 3 ? 1 : 0;
        quads += face.size == 4 ? 1 : 0;
    }
    const std::size_t count = faces.size();
    if (triangles + quads != count) {
        return vtk_polyhedron;
    }
    if (count == 6 && quads == 6) {
        for (std::uint32_t i = 0; i < 4; ++i) {
            out[i] = faces[0].node(i, true);
        }
        return raise<4>(faces, 0, true, out.data(), sound_hexahedron) ? vtk_hexahedron : vtk_polyhedron;
    }
    if (count == 5 && triangles == 2) {
        const std::size_t base = first_of_size(faces, 3);
        for (std::uint32_t i = 0; i < 3; ++i) {
            out[i] = faces[base].node(i, false);  // VTK's wedge: the first triangle looks outward
        }
        bool unused = false;
        return raise<3>(faces, base, false, out.data(), unused) ? vtk_wedge : vtk_polyhedron;
    }
    const bool pyramid = count == 5 && quads == 1;
    if (pyramid || (count == 4 && triangles == 4)) {
        const std::uint32_t sides = pyramid ? 4 : 3;
        const std::size_t base = first_of_size(faces, sides);
        for (std::uint32_t i = 0; i < sides; ++i) {
            out[i] = faces[base].node(i, true);
        }
        out[sides] = other_node(faces[base == 0 ? 1 : 0], out.data(), sides);
        const bool good = out[sides] != 0 && only(faces, out.data(), sides + 1);
        return !good ? vtk_polyhedron : pyramid ? vtk_pyramid : vtk_tetra;
    }
    return vtk_polyhedron;
}

void unique_nodes(CellShape& cell) {
    cell.nodes.clear();
    for (const auto& face : cell.faces) {
        cell.nodes.insert(cell.nodes.end(), face.nodes, face.nodes + face.size);
    }
    std::sort(cell.nodes.begin(), cell.nodes.end());
    cell.nodes.erase(std::unique(cell.nodes.begin(), cell.nodes.end()), cell.nodes.end());
}

/// The edges of a 2-D cell as one ring, counter-clockwise when the cell lies as the file says; false if they do not
/// close.
bool ring(CellShape& cell) {
    // (-dy, dx) of n0 -> n1 points into the cell: the cell lies to the left, so the stored order runs
    // counter-clockwise.
    const std::size_t count = cell.faces.size();
    cell.nodes.clear();
    if (count < 3) {
        return false;
    }
    std::uint32_t at = cell.faces[0].node(0, true);
    for (std::size_t step = 0; step < count; ++step) {
        cell.nodes.push_back(at);
        std::size_t next = 0;
        while (next < count && (cell.faces[next].size != 2 || cell.faces[next].node(0, true) != at)) {
            ++next;
        }
        if (next == count) {
            return false;
        }
        at = cell.faces[next].node(1, true);
    }
    return at == cell.nodes.front();
}

Vector point(const double* points, std::uint32_t node) {
    const double* p = points + 3 * (static_cast<std::size_t>(node) - 1);
    return {p[0], p[1], p[2]};
}

/// The edges of a 2-D cell do for its area what faces do for a volume.
CellSize plane_size(const CellShape& cell, const double* points) {
    CellSize result;
    const Vector origin = point(points, cell.faces[0].nodes[0]);
    Vector sum;
    for (const auto& face : cell.faces) {
        if (face.size != 2) {
            continue;
        }
        const Vector a = point(points, face.node(0, false)) - origin;
        const Vector b = point(points, face.node(1, false)) - origin;
        const Vector out{a.y - b.y, b.x - a.x, 0};  // the cell lies to the right of the outward order
        result.volume += (a.x * out.x + a.y * out.y) / 2;
        result.area += std::hypot(out.x, out.y);
        sum = sum + out;
    }
    result.opening = norm(sum);
    return result;
}

/// From the eight nodes alone, each fetched once. The area vector of a quad is half the product of its diagonals.
CellSize hexahedron_size(const CellShape& cell, const double* points) {
    static constexpr std::array<std::array<int, 4>, 6> outward = {
        {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
    std::array<Vector, 8> p;
    const Vector origin = point(points, cell.nodes[0]);
    for (std::size_t i = 0; i < 8; ++i) {
        p[i] = point(points, cell.nodes[i]) - origin;
    }
    double sum = 0;
    for (const auto& [a, b, c, d] : outward) {
        const auto at = [&](int i) { return p[static_cast<std::size_t>(i)]; };
        sum += dot(at(a) + at(b) + at(c) + at(d), cross(at(c) - at(a), at(d) - at(b)));
    }
    CellSize result;
    result.volume = sum / 24;  // a half, a quarter, a third
    return result;
}

}  // namespace

void recognise(CellShape& cell, int dimension, bool called_polyhedron) {
    cell.type = vtk_empty;
    cell.sound_hexahedron = false;
    if (cell.faces.empty()) {
        return;
    }
    if (dimension == 2) {
        if (ring(cell)) {
            cell.type = cell.nodes.size() == 3 ? vtk_triangle : cell.nodes.size() == 4 ? vtk_quad : vtk_polygon;
        }
        return;
    }
    std::array<std::uint32_t, 8> nodes{};
    cell.type = called_polyhedron ? static_cast<unsigned char>(vtk_polyhedron)
                                  : standard_cell(cell.faces, nodes, cell.sound_hexahedron);
    if (cell.type == vtk_polyhedron) {
        cell.sound_hexahedron = false;
        unique_nodes(cell);
    } else {
        const std::ptrdiff_t count = cell.type == vtk_hexahedron ? 8
                                     : cell.type == vtk_wedge    ? 6
                                     : cell.type == vtk_pyramid  ? 5
                                                                 : 4;
        cell.nodes.assign(nodes.begin(), nodes.begin() + count);
    }
}

CellSize size_of(const CellShape& cell, const double* points, int dimension) {
    if (dimension == 2) {
        return plane_size(cell, points);
    }
    if (cell.sound_hexahedron) {
        return hexahedron_size(cell, points);
    }
    CellSize result;
    const Vector origin = point(points, cell.faces[0].nodes[0]);
    Vector opening;
    for (const auto& face : cell.faces) {
        const Vector first = point(points, face.nodes[0]) - origin;
        Vector mean = first;
        Vector normal;  // of the stored order, twice the area
        Vector before;
        for (std::uint32_t i = 1; i < face.size; ++i) {
            const Vector here = point(points, face.nodes[i]) - origin;
            mean = mean + here;
            const Vector arm = here - first;
            normal = i > 1 ? normal + cross(before, arm) : normal;
            before = arm;
        }
        const double outward = face.inward ? -0.5 : 0.5;
        normal = {outward * normal.x, outward * normal.y, outward * normal.z};
        result.volume += dot(mean, normal) / (3 * face.size);
        result.area += norm(normal);
        opening = opening + normal;
    }
    result.opening = norm(opening);
    return result;
}

}  // namespace underbody::postproc
