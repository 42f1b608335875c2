#include "postproc/importers/mesh/face_orientation.h"

#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <map>
#include <utility>

namespace underbody::postproc {

namespace {

using Faces = std::vector<std::vector<int>>;

const Faces& faces_of(unsigned char type) {
    static const Faces tetrahedron = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    static const Faces pyramid = {{0, 1, 2, 3}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    static const Faces wedge = {{0, 1, 2}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    static const Faces hexahedron = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    static const Faces triangle = {{0, 1}, {1, 2}, {2, 0}};
    static const Faces quadrangle = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    static const Faces none;
    switch (type) {
        case VTK_TETRA:
            return tetrahedron;
        case VTK_PYRAMID:
            return pyramid;
        case VTK_WEDGE:
            return wedge;
        case VTK_HEXAHEDRON:
            return hexahedron;
        case VTK_TRIANGLE:
            return triangle;
        case VTK_QUAD:
            return quadrangle;
        default:
            return none;
    }
}

using Vector = std::array<double, 3>;

Vector mean_of(const std::int64_t* nodes, std::size_t count, const Buffer<double>& points) {
    Vector sum{};
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += points[static_cast<std::size_t>(3 * nodes[i]) + k] / static_cast<double>(count);
        }
    }
    return sum;
}

Vector normal_of(const std::int64_t* nodes, std::size_t count, const Buffer<double>& points) {
    Vector sum{};
    const double* a = points.data() + 3 * nodes[0];
    for (std::size_t i = 1; i + 1 < count; ++i) {
        const double* b = points.data() + 3 * nodes[i];
        const double* c = points.data() + 3 * nodes[i + 1];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t m = (k + 1) % 3;
            const std::size_t n = (k + 2) % 3;
            sum[k] += (b[m] - a[m]) * (c[n] - a[n]) - (b[n] - a[n]) * (c[m] - a[m]);
        }
    }
    return sum;
}

/// What a line in a plane across z has on its left.
Vector left_of(const std::int64_t* nodes, const Buffer<double>& points) {
    const double* a = points.data() + 3 * nodes[0];
    const double* b = points.data() + 3 * nodes[1];
    return {a[1] - b[1], b[0] - a[0], 0};
}

/// The faces of one polyhedron with a sense each, so that all look out of it. The centre of a concave cell may lie on
/// the wrong side of a face: faces that share an edge run along it opposite ways, and the volume is positive.
class OrientedCell {
public:
    /// `stream`: number of faces, then per face its number of nodes and these.
    OrientedCell(const std::int64_t* stream, const Buffer<double>& points) {
        const std::int64_t count = *stream++;
        for (std::int64_t f = 0; f < count; ++f) {
            const std::int64_t corners = *stream++;
            faces_.push_back({stream, static_cast<std::size_t>(corners)});
            stream += corners;
        }
        orient();
        if (!senses_.empty() && volume(points) < 0) {
            for (int& sense : senses_) {
                sense = -sense;
            }
        }
    }

    /// +1 if the corners go round the face so that it looks out of the cell, -1 if into it, 0 if nobody knows.
    [[nodiscard]] int sense_of(const std::int64_t* nodes, std::size_t count) const {
        std::vector<std::int64_t> wanted(nodes, nodes + count);
        std::sort(wanted.begin(), wanted.end());
        for (std::size_t f = 0; f < senses_.size(); ++f) {
            std::vector<std::int64_t> own(faces_[f].first, faces_[f].first + faces_[f].second);
            std::sort(own.begin(), own.end());
            if (own == wanted) {
                const bool same = follows(f, nodes[0], nodes[1]);
                return same == follows(f, nodes[1], nodes[0]) ? 0 : same ? senses_[f] : -senses_[f];
            }
        }
        return 0;
    }

private:
    /// Does `b` come right behind `a` in a face?
    [[nodiscard]] bool follows(std::size_t face, std::int64_t a, std::int64_t b) const {
        const auto& [nodes, count] = faces_[face];
        for (std::size_t i = 0; i < count; ++i) {
            if (nodes[i] == a && nodes[(i + 1) % count] == b) {
                return true;
            }
        }
        return false;
    }

    /// Senses from face to face across the edges; none where the faces do not close.
    void orient() {
        std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::pair<std::size_t, int>>> edges;
        for (std::size_t f = 0; f < faces_.size(); ++f) {
            const auto& [nodes, count] = faces_[f];
            for (std::size_t i = 0; i < count; ++i) {
                const std::int64_t a = nodes[i];
                const std::int64_t b = nodes[(i + 1) % count];
                edges[std::minmax(a, b)].emplace_back(f, a < b ? 1 : -1);
            }
        }
        std::vector<std::vector<std::pair<std::size_t, int>>> beside(faces_.size());
        for (const auto& [edge, two] : edges) {
            if (two.size() != 2) {
                return;
            }
            const int turned = two[0].second == two[1].second ? -1 : 1;
            beside[two[0].first].emplace_back(two[1].first, turned);
            beside[two[1].first].emplace_back(two[0].first, turned);
        }
        std::vector<int> senses(faces_.size(), 0);
        std::vector<std::size_t> next;
        if (!faces_.empty()) {
            senses[0] = 1;
            next.push_back(0);
        }
        while (!next.empty()) {
            const std::size_t face = next.back();
            next.pop_back();
            for (const auto& [other, turned] : beside[face]) {
                if (senses[other] == 0) {
                    senses[other] = senses[face] * turned;
                    next.push_back(other);
                } else if (senses[other] != senses[face] * turned) {
                    return;
                }
            }
        }
        if (std::find(senses.begin(), senses.end(), 0) == senses.end()) {
            senses_ = std::move(senses);
        }
    }

    [[nodiscard]] double volume(const Buffer<double>& points) const {
        const double* origin = points.data() + 3 * faces_[0].first[0];
        double sum = 0;
        for (std::size_t f = 0; f < faces_.size(); ++f) {
            const Vector normal = normal_of(faces_[f].first, faces_[f].second, points);
            const Vector centre = mean_of(faces_[f].first, faces_[f].second, points);
            for (std::size_t k = 0; k < 3; ++k) {
                sum += senses_[f] * normal[k] * (centre[k] - origin[k]);
            }
        }
        return sum;
    }

    std::vector<std::pair<const std::int64_t*, std::size_t>> faces_;
    std::vector<int> senses_;
};

}  // namespace

std::size_t BoundaryFaces::Hash::operator()(const Key& key) const {
    std::uint64_t hash = 1469598103934665603ULL;
    for (const std::int64_t node : key.nodes) {
        hash = (hash ^ static_cast<std::uint64_t>(node)) * 1099511628211ULL;
    }
    return hash ^ (hash >> 29);
}

BoundaryFaces::Key BoundaryFaces::key_of(const std::int64_t* nodes, std::size_t count) {
    std::array<std::int64_t, 64> sorted{};
    const std::size_t used = std::min(count, sorted.size());
    std::copy_n(nodes, used, sorted.begin());
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(used));
    Key key;
    std::copy_n(sorted.begin(), std::min<std::size_t>(used, 4), key.nodes);
    return key;
}

void BoundaryFaces::note(const std::int64_t* nodes, std::size_t count, std::size_t cell, std::size_t stream) {
    const auto found = cells_.find(key_of(nodes, count));
    if (found != cells_.end()) {
        (found->second.one.place < 0 ? found->second.one : found->second.other) = {static_cast<std::int64_t>(cell),
                                                                                   stream};
    }
}

BoundaryFaces::BoundaryFaces(const std::vector<const ElementPart*>& surfaces, const ElementPart& volume)
    : volume_(volume) {
    for (const ElementPart* surface : surfaces) {
        for (std::size_t i = 0; i < surface->elements(); ++i) {
            const auto count = static_cast<std::size_t>(surface->offsets[i + 1] - surface->offsets[i]);
            cells_.emplace(key_of(surface->nodes.data() + surface->offsets[i], count), Behind{});
        }
    }
    std::size_t stream = 0;
    std::vector<std::int64_t> corners;
    for (std::size_t cell = 0; cell < volume.elements(); ++cell) {
        const std::int64_t* nodes = volume.nodes.data() + volume.offsets[cell];
        if (volume.types[cell] == VTK_POLYHEDRON) {
            const std::size_t begin = stream;
            for (std::int64_t faces = volume.polyhedra[stream++]; faces > 0; --faces) {
                const auto count = static_cast<std::size_t>(volume.polyhedra[stream++]);
                note(volume.polyhedra.data() + stream, count, cell, begin);
                stream += count;
            }
            continue;
        }
        for (const auto& face : faces_of(volume.types[cell])) {
            corners.clear();
            for (const int corner : face) {
                corners.push_back(nodes[corner]);
            }
            note(corners.data(), corners.size(), cell);
        }
    }
}

BoundaryFaces::Behind BoundaryFaces::behind(const std::int64_t* nodes, std::size_t count) const {
    const auto found = cells_.find(key_of(nodes, count));
    return found == cells_.end() ? Behind{} : found->second;
}

std::array<std::int64_t, 2> BoundaryFaces::cells_at(const std::int64_t* nodes, std::size_t count,
                                                    const Buffer<double>& points) const {
    const Behind found = behind(nodes, count);
    if (found.between() && turn_toward(found.one, nodes, count, points) < 0) {
        return {found.other.place, found.one.place};
    }
    return {found.one.place, found.other.place};
}

ElementPart BoundaryFaces::other_side(const ElementPart& surface) const {
    ElementPart side;
    side.name = surface.name + "-shadow";
    side.kind = surface.kind;
    side.original_kind = surface.original_kind;
    for (std::size_t i = 0; i < surface.elements(); ++i) {
        const auto first = surface.nodes.begin() + static_cast<std::ptrdiff_t>(surface.offsets[i]);
        const auto end = surface.nodes.begin() + static_cast<std::ptrdiff_t>(surface.offsets[i + 1]);
        if (first != end && behind(&*first, static_cast<std::size_t>(end - first)).between()) {
            const std::vector<std::int64_t> turned(std::make_reverse_iterator(end), std::make_reverse_iterator(first));
            side.add(surface.types[i], turned.data(), turned.size());
        }
    }
    return side;
}

/// +1 if the right-hand normal of a face points into a cell at it, -1 if out of it, 0 if nobody knows.
int BoundaryFaces::turn_toward(const Cell& at, const std::int64_t* nodes, std::size_t count,
                               const Buffer<double>& points) const {
    if (at.place < 0 || count < 2) {
        return 0;
    }
    const auto cell = static_cast<std::size_t>(at.place);
    if (volume_.types[cell] == VTK_POLYHEDRON) {
        return -OrientedCell(volume_.polyhedra.data() + at.stream, points).sense_of(nodes, count);
    }
    const Vector inside = mean_of(volume_.nodes.data() + volume_.offsets[cell],
                                  static_cast<std::size_t>(volume_.offsets[cell + 1] - volume_.offsets[cell]), points);
    const Vector here = mean_of(nodes, count, points);
    const Vector normal = count == 2 ? left_of(nodes, points) : normal_of(nodes, count, points);
    double toward = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        toward += normal[k] * (inside[k] - here[k]);
    }
    return toward > 0 ? 1 : toward < 0 ? -1 : 0;
}

bool BoundaryFaces::turn_into_volume(ElementPart& surface, const Buffer<double>& points, bool two_sided) const {
    constexpr int either = 2;
    std::vector<int> turns;  // -1: the face looks out of the volume, 0: nobody knows, either: into it on both sides
    for (std::size_t i = 0; i < surface.elements(); ++i) {
        const std::int64_t* nodes = surface.nodes.data() + surface.offsets[i];
        const auto count = static_cast<std::size_t>(surface.offsets[i + 1] - surface.offsets[i]);
        const Behind found = behind(nodes, count);
        turns.push_back(!found.between() ? turn_toward(found.one, nodes, count, points) : two_sided ? either : 0);
    }
    const auto known = [&](int turn) { return static_cast<std::size_t>(std::count(turns.begin(), turns.end(), turn)); };
    const bool all = known(0) == 0;
    const bool agreed = (known(1) == 0 || known(-1) == 0) && 4 * (known(1) + known(-1)) >= turns.size();
    if (turns.empty() || (!all && !agreed)) {
        return false;
    }
    for (std::size_t i = 0; i < surface.elements(); ++i) {
        if (turns[i] < 0 || (turns[i] != either && !all && known(-1) > 0)) {
            std::reverse(surface.nodes.begin() + static_cast<std::ptrdiff_t>(surface.offsets[i]),
                         surface.nodes.begin() + static_cast<std::ptrdiff_t>(surface.offsets[i + 1]));
        }
    }
    return true;
}

namespace {

struct PlaceHash {
    std::size_t operator()(const Vector& place) const {
        std::uint64_t hash = 1469598103934665603ULL;
        for (const double x : place) {
            hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15ULL;  // -0 is 0
        }
        return hash ^ (hash >> 29);
    }
};

Vector place_of(const Buffer<double>& points, std::size_t node) {
    return {points[3 * node], points[3 * node + 1], points[3 * node + 2]};
}

using Places = std::unordered_map<Vector, std::int64_t, PlaceHash>;

/// The places of the surfaces' nodes, each with the volume's node there, -1 for none.
Places places_in_volume(const std::vector<ElementPart*>& surfaces, const ElementPart& volume) {
    Places places;
    for (const ElementPart* surface : surfaces) {
        for (std::size_t i = 0; i < surface->points.size() / 3; ++i) {
            places.emplace(place_of(surface->points, i), -1);
        }
    }
    for (std::size_t i = 0; i < volume.points.size() / 3; ++i) {
        if (const auto found = places.find(place_of(volume.points, i)); found != places.end()) {
            found->second = static_cast<std::int64_t>(i);
        }
    }
    return places;
}

/// The faces of a surface with the volume's numbers of nodes; none when a node has no place there, or an element is no
/// plain face.
ElementPart in_numbers_of_volume(const ElementPart& surface, const Places& places) {
    ElementPart faces;
    const bool plain = std::all_of(surface.types.begin(), surface.types.end(), [](unsigned char type) {
        return type == VTK_TRIANGLE || type == VTK_QUAD || type == VTK_POLYGON;
    });
    for (const std::int64_t node : surface.nodes) {
        const std::int64_t number = plain ? places.at(place_of(surface.points, static_cast<std::size_t>(node))) : -1;
        if (number < 0) {
            return {};
        }
        faces.nodes.push_back(number);
    }
    faces.types = surface.types;
    faces.offsets = surface.offsets;
    return faces;
}

}  // namespace

std::vector<bool> turn_into_volume(const std::vector<ElementPart*>& surfaces, const ElementPart& volume) {
    const Places places = places_in_volume(surfaces, volume);
    std::vector<ElementPart> faces;
    for (const ElementPart* surface : surfaces) {
        faces.push_back(in_numbers_of_volume(*surface, places));
    }
    std::vector<const ElementPart*> parts;
    for (const auto& part : faces) {
        parts.push_back(&part);
    }
    const BoundaryFaces boundary(parts, volume);
    std::vector<bool> settled;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        ElementPart& surface = *surfaces[s];
        const std::vector<std::int64_t> before = faces[s].nodes;
        settled.push_back(boundary.turn_into_volume(faces[s], volume.points));
        for (std::size_t i = 0; settled.back() && i < surface.elements(); ++i) {
            const auto first = static_cast<std::ptrdiff_t>(surface.offsets[i]);
            const auto end = static_cast<std::ptrdiff_t>(surface.offsets[i + 1]);
            if (!std::equal(before.begin() + first, before.begin() + end, faces[s].nodes.begin() + first)) {
                std::reverse(surface.nodes.begin() + first, surface.nodes.begin() + end);
            }
        }
    }
    return settled;
}

std::vector<bool> turn_into_one_volume(const std::vector<ElementPart*>& surfaces,
                                       const std::vector<const ElementPart*>& volumes, core::Progress& progress) {
    std::vector<int> sides(surfaces.size(), 0);
    for (const ElementPart* volume : volumes) {
        progress.check();
        const auto settled = surfaces.empty() ? std::vector<bool>() : turn_into_volume(surfaces, *volume);
        for (std::size_t s = 0; s < settled.size(); ++s) {
            sides[s] += settled[s] ? 1 : 0;
        }
    }
    std::vector<bool> one;
    for (const int count : sides) {
        one.push_back(count == 1);
    }
    return one;
}

}  // namespace underbody::postproc
