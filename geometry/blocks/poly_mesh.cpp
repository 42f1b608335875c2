#include "geometry/blocks/poly_mesh.h"

#include <algorithm>
#include <stdexcept>

#include "core/error.h"

namespace underbody::geometry {

namespace {

/// Faces of a hexahedron, normals outward.
constexpr std::array<std::array<std::size_t, 4>, 6> hex_faces = {
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};

Quad sorted(Quad q) {
    std::sort(q.begin(), q.end());
    return q;
}

struct HalfFace {
    Quad key;
    std::int32_t cell;   // -1 - patch for a name
    std::int32_t which;  // face of the cell
};

struct Inner {
    std::int32_t owner, neighbour, which;
};

struct Outer {
    std::int32_t patch, cell, which;
};

Quad corners_of(const Hexahedron& cell, std::int32_t which) {
    Quad q;
    for (std::size_t c = 0; c < 4; ++c) {
        q[c] = cell[hex_faces[static_cast<std::size_t>(which)][c]];
    }
    return q;
}

/// All faces of all cells and all names, grouped by corners: a counting sort by the smallest corner, then small sorts.
std::vector<HalfFace> grouped_faces(const HexMesh& mesh) {
    std::vector<HalfFace> all;
    all.reserve(6 * mesh.cells.size() + mesh.named.size());
    for (std::size_t cell = 0; cell < mesh.cells.size(); ++cell) {
        for (std::int32_t which = 0; which < 6; ++which) {
            all.push_back({sorted(corners_of(mesh.cells[cell], which)), static_cast<std::int32_t>(cell), which});
        }
    }
    for (const auto& face : mesh.named) {
        all.push_back({sorted(face.corners), -1 - face.patch, 0});
    }
    std::vector<std::size_t> start(mesh.points.size() + 1, 0);
    for (const HalfFace& face : all) {
        ++start[static_cast<std::size_t>(face.key[0]) + 1];
    }
    for (std::size_t i = 1; i < start.size(); ++i) {
        start[i] += start[i - 1];
    }
    std::vector<HalfFace> grouped(all.size());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (const HalfFace& face : all) {
        grouped[next[static_cast<std::size_t>(face.key[0])]++] = face;
    }
    for (std::size_t i = 0; i + 1 < start.size(); ++i) {
        std::sort(
            grouped.begin() + static_cast<std::ptrdiff_t>(start[i]),
            grouped.begin() + static_cast<std::ptrdiff_t>(start[i + 1]),
            [](const HalfFace& a, const HalfFace& b) { return a.key != b.key ? a.key < b.key : a.cell < b.cell; });
    }
    return grouped;
}

}  // namespace

const PolyMesh::Patch& PolyMesh::patch(const std::string& name) const {
    std::vector<std::string> names;
    for (const Patch& p : patches) {
        if (p.name == name) {
            return p;
        }
        names.push_back(p.name);
    }
    throw core::InputError("name", "the mesh has no patch '" + name + "'", {}, core::did_you_mean(name, names));
}

namespace {

/// Faces between two cells and faces of patches, each in the order of the file.
struct SortedFaces {
    std::vector<Inner> inner;
    std::vector<Outer> outer;
};

SortedFaces sorted_faces(const HexMesh& mesh) {
    const std::vector<HalfFace> all = grouped_faces(mesh);
    SortedFaces faces;
    auto& [inner, outer] = faces;
    inner.reserve(3 * mesh.cells.size());
    for (std::size_t i = 0; i < all.size();) {
        std::size_t end = i + 1;
        while (end < all.size() && all[end].key == all[i].key) {
            ++end;
        }
        std::size_t cell = i;  // names sort before cells
        while (cell < end && all[cell].cell < 0) {
            ++cell;
        }
        if (end - cell > 2) {
            throw std::logic_error("a face of three cells");
        }
        if (end - cell == 2 && cell > i && all[i].cell == -1 - mesh.sheet && mesh.sheet >= 0) {
            outer.push_back({mesh.sheet, all[cell].cell, all[cell].which});
            outer.push_back({mesh.sheet, all[cell + 1].cell, all[cell + 1].which});
        } else if (end - cell == 2) {  // a name inside the domain says nothing
            inner.push_back({all[cell].cell, all[cell + 1].cell, all[cell].which});
        } else if (cell == i) {
            throw std::logic_error("a boundary face of no patch");
        } else if (end > cell) {
            outer.push_back({-1 - all[i].cell, all[cell].cell, all[cell].which});
        }
        i = end;
    }
    std::sort(inner.begin(), inner.end(), [](const Inner& a, const Inner& b) {
        return a.owner != b.owner ? a.owner < b.owner : a.neighbour < b.neighbour;
    });
    std::sort(outer.begin(), outer.end(), [](const Outer& a, const Outer& b) {
        return a.patch != b.patch ? a.patch < b.patch : a.cell != b.cell ? a.cell < b.cell : a.which < b.which;
    });
    return faces;
}

}  // namespace

PolyMesh faces_of(const HexMesh& mesh) {
    const SortedFaces faces = sorted_faces(mesh);
    const std::vector<Outer>& outer = faces.outer;
    PolyMesh poly;
    poly.points = mesh.points;
    poly.cells = mesh.cells.size();
    for (const Inner& f : faces.inner) {
        poly.faces.push_back(corners_of(mesh.cells[static_cast<std::size_t>(f.owner)], f.which));
        poly.owner.push_back(f.owner);
        poly.neighbour.push_back(f.neighbour);
    }
    for (std::size_t p = 0; p < mesh.patch_names.size(); ++p) {
        const auto of_patch = [p](const Outer& f) { return f.patch == static_cast<std::int32_t>(p); };
        const auto first = std::find_if(outer.begin(), outer.end(), of_patch);
        const auto count = std::count_if(outer.begin(), outer.end(), of_patch);
        if (count > 0) {
            poly.patches.push_back({mesh.patch_names[p], poly.faces.size(), static_cast<std::size_t>(count)});
        }
        for (auto f = first; f != outer.end() && of_patch(*f); ++f) {
            poly.faces.push_back(corners_of(mesh.cells[static_cast<std::size_t>(f->cell)], f->which));
            poly.owner.push_back(f->cell);
        }
    }
    return poly;
}

}  // namespace underbody::geometry
