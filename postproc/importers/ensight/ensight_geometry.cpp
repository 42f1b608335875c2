#include "postproc/importers/ensight/ensight_geometry.h"

#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"

namespace underbody::postproc {

namespace {

struct Kind {
    const char* name;
    unsigned char type;
    int nodes;
};

constexpr std::array kinds = {Kind{"point", VTK_VERTEX, 1},
                              Kind{"bar2", VTK_LINE, 2},
                              Kind{"bar3", VTK_QUADRATIC_EDGE, 3},
                              Kind{"tria3", VTK_TRIANGLE, 3},
                              Kind{"tria6", VTK_QUADRATIC_TRIANGLE, 6},
                              Kind{"quad4", VTK_QUAD, 4},
                              Kind{"quad8", VTK_QUADRATIC_QUAD, 8},
                              Kind{"tetra4", VTK_TETRA, 4},
                              Kind{"tetra10", VTK_QUADRATIC_TETRA, 10},
                              Kind{"pyramid5", VTK_PYRAMID, 5},
                              Kind{"pyramid13", VTK_QUADRATIC_PYRAMID, 13},
                              Kind{"penta6", VTK_WEDGE, 6},
                              Kind{"penta15", VTK_QUADRATIC_WEDGE, 15},
                              Kind{"hexa8", VTK_HEXAHEDRON, 8},
                              Kind{"hexa20", VTK_QUADRATIC_HEXAHEDRON, 20},
                              Kind{"nsided", VTK_POLYGON, 0},
                              Kind{"nfaced", VTK_POLYHEDRON, 0}};

const Kind* find_kind(const std::string& name) {
    for (const auto& kind : kinds) {
        if (name == kind.name) {
            return &kind;
        }
    }
    return nullptr;
}

std::string first_word(const std::string& line) { return line.substr(0, line.find_first_of(" \t")); }

bool has_word(const std::string& line, const char* word) { return line.find(word) != std::string::npos; }

}  // namespace

std::string EnsightGeometry::understood() const {
    std::string text = std::to_string(parts.size()) + " parts";
    std::size_t shown = 0;
    for (const auto& [number, part] : parts) {
        if (shown++ == 12) {
            return text + " ...";
        }
        text += (shown == 1 ? ": " : ", ") + part.elements.name + " (" +
                std::to_string(part.elements.points.size() / 3) + " nodes, " +
                std::to_string(part.elements.elements()) + " elements)";
    }
    return text;
}

bool EnsightGeometry::ends_here(const std::string& line) { return core::lower_case(line).starts_with("end time step"); }

void EnsightGeometry::read() {
    if (coding_ != EnsightCoding::text) {
        in_.line();
    }
    if (step_ >= 0) {
        in_.to_step(step_);
    }
    // Two lines of description, which may be blank; then how nodes and elements are numbered.
    std::string line = in_.line();
    for (int lines = 0; lines < 4 && !core::lower_case(line).starts_with("node id"); ++lines) {
        if (!core::lower_case(line).starts_with("begin time step")) {
            description += (description.empty() || line.empty() ? "" : "; ") + line;
        }
        line = in_.line();
    }
    for (auto* ids : {&node_ids_, &element_ids_}) {
        const std::string lower = core::lower_case(line);
        if (lower.find(" id") == std::string::npos) {
            in_.fail("expected 'node id' or 'element id', found '" + line.substr(0, 40) + "'");
        }
        *ids = lower.find("given") != std::string::npos || lower.find("ignore") != std::string::npos;
        line = in_.line();
    }
    if (core::lower_case(line).starts_with("extents")) {
        std::array<double, 6> extents{};
        in_.reals(extents.data(), 6);
        line = in_.line();
    }
    while (!ends_here(line)) {
        progress_.check();
        if (core::lower_case(first_word(line)) != "part") {
            in_.fail("expected 'part', found '" + line.substr(0, 40) + "'");
        }
        const std::int64_t number = in_.part_number(parts.empty());
        if (parts.contains(number)) {
            in_.fail("part " + std::to_string(number) + " is there twice");
        }
        pending_.clear();
        part(number);
        if (pending_.empty()) {
            return;
        }
        line = pending_;
    }
}

void EnsightGeometry::coordinates(EnsightPart& part, std::uint64_t nodes) {
    part.elements.points.grow_to(3 * nodes);
    Buffer<double> column(nodes);
    for (std::size_t k = 0; k < 3; ++k) {
        in_.reals(column.data(), nodes);
        for (std::size_t i = 0; i < nodes; ++i) {
            if (!std::isfinite(column[i])) {
                in_.fail("part '" + part.elements.name + "' has a coordinate that is not a number");
            }
            part.elements.points[3 * i + k] = column[i];
        }
    }
}

void EnsightGeometry::part(std::int64_t number) {
    EnsightPart& part = parts[number];
    part.elements.id = static_cast<int>(number);
    part.elements.name = in_.line_as_it_is();
    if (part.elements.name.empty()) {
        part.elements.name = "part " + std::to_string(number);
    }
    const std::string what = core::lower_case(in_.line());
    if (first_word(what) == "block") {
        block(part, what);
    } else if (first_word(what) == "coordinates") {
        const std::uint64_t nodes = in_.count("nodes");
        in_.check_room(3 * nodes, "coordinates");
        std::vector<std::int64_t> ids;
        if (node_ids_) {
            in_.integers(ids, nodes);
        }
        coordinates(part, nodes);
    } else {
        in_.fail("expected 'coordinates' or 'block', found '" + what.substr(0, 40) + "'");
    }
    while (!in_.at_end()) {
        progress_.check();
        const std::string line = in_.line();
        std::string name = core::lower_case(first_word(line));
        if (name == "part" || ends_here(line)) {
            pending_ = line;
            return;
        }
        const bool ghost = name.starts_with("g_");
        name = ghost ? name.substr(2) : name;
        const Kind* kind = part.block ? nullptr : find_kind(name);
        if (kind == nullptr) {
            in_.fail("elements of unknown kind '" + line.substr(0, 40) + "' in part '" + part.elements.name + "'");
        }
        elements(part, kind->name, kind->type, kind->nodes, ghost);
    }
}

// ---- structured blocks ----

void EnsightGeometry::block_coordinates(EnsightPart& part, const std::string& line, const std::int64_t* size) {
    const auto nodes = static_cast<std::uint64_t>(size[0] * size[1] * size[2]);
    if (!has_word(line, "uniform") && !has_word(line, "rectilinear")) {
        in_.check_room(3 * nodes, "coordinates");
        coordinates(part, nodes);
        return;
    }
    if (nodes > most_nodes_) {
        in_.fail("a block of " + std::to_string(nodes) + " nodes, more than the variables of the case have values for");
    }
    std::array<std::vector<double>, 3> axes;
    if (has_word(line, "uniform")) {
        std::array<double, 6> numbers{};  // origin, then steps
        in_.reals(numbers.data(), 6);
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::int64_t i = 0; i < size[k]; ++i) {
                axes[k].push_back(numbers[k] + static_cast<double>(i) * numbers[3 + k]);
            }
        }
    } else {
        for (std::size_t k = 0; k < 3; ++k) {
            axes[k].resize(static_cast<std::size_t>(size[k]));
            in_.reals(axes[k].data(), axes[k].size());
        }
    }
    part.elements.points.grow_to(3 * nodes);
    double* out = part.elements.points.data();
    for (const double z : axes[2]) {
        for (const double y : axes[1]) {
            for (const double x : axes[0]) {
                if (!std::isfinite(x + y + z)) {
                    in_.fail("part '" + part.elements.name + "' has a coordinate that is not a number");
                }
                *out++ = x;
                *out++ = y;
                *out++ = z;
            }
        }
    }
}

/// Hexahedra; quadrilaterals of a block one node thick, lines of one two nodes thin.
void EnsightGeometry::block_cells(EnsightPart& part, const std::int64_t* size, const std::vector<bool>& left_out) {
    std::vector<std::size_t> wide;
    for (std::size_t k = 0; k < 3; ++k) {
        if (size[k] > 1) {
            wide.push_back(k);
        }
    }
    const std::int64_t stride[3] = {1, size[0], size[0] * size[1]};
    const auto cells = [&](std::size_t k) { return std::max<std::int64_t>(1, size[k] - 1); };
    part.block_elements = static_cast<std::size_t>(cells(0) * cells(1) * cells(2));
    // Corners of the unit cell in the order of VTK, over the axes along which the block extends.
    static constexpr std::array<std::array<int, 3>, 8> corners = {
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    const std::size_t count = std::size_t{1} << wide.size();
    constexpr std::array<unsigned char, 4> types = {VTK_VERTEX, VTK_LINE, VTK_QUAD, VTK_HEXAHEDRON};
    std::array<std::int64_t, 8> nodes{};
    std::size_t cell = 0;
    for (std::int64_t k = 0; k < cells(2); ++k) {
        progress_.check();
        for (std::int64_t j = 0; j < cells(1); ++j) {
            for (std::int64_t i = 0; i < cells(0); ++i, ++cell) {
                if (!left_out.empty() && left_out[cell]) {
                    continue;
                }
                for (std::size_t c = 0; c < count; ++c) {
                    nodes[c] = i * stride[0] + j * stride[1] + k * stride[2];
                    for (std::size_t w = 0; w < wide.size(); ++w) {
                        nodes[c] += corners[c][w] * stride[wide[w]];
                    }
                }
                part.elements.add(types[wide.size()], nodes.data(), count);
                if (!left_out.empty()) {
                    part.kept.push_back(cell);
                }
            }
        }
    }
}

/// Nodes of a block along its three axes, of the range that is written.
std::vector<std::int64_t> EnsightGeometry::block_size(const std::string& line) {
    std::vector<std::int64_t> numbers;
    in_.integers(numbers, 3);
    if (has_word(line, "range")) {
        std::vector<std::int64_t> range;
        in_.integers(range, 6);
        for (std::size_t k = 0; k < 3; ++k) {
            if (range[2 * k] < 1 || range[2 * k + 1] < range[2 * k] || range[2 * k + 1] > numbers[k]) {
                in_.fail("the block's range " + std::to_string(range[2 * k]) + " to " +
                         std::to_string(range[2 * k + 1]) + " of " + std::to_string(numbers[k]));
            }
            numbers[k] = range[2 * k + 1] - range[2 * k] + 1;
        }
    }
    for (const std::int64_t n : numbers) {
        if (n < 1 || n > 0x7fffffff || numbers[0] * std::max<std::int64_t>(1, n) > 0x7fffffff) {
            in_.fail("a block of " + std::to_string(numbers[0]) + " x " + std::to_string(numbers[1]) + " x " +
                     std::to_string(numbers[2]) + " nodes");
        }
    }
    const std::int64_t* size = numbers.data();
    if (size[0] * size[1] > 0x7fffffff / size[2]) {
        in_.fail("a block of more than 2^31 nodes");
    }
    return numbers;
}

void EnsightGeometry::block(EnsightPart& part, const std::string& line) {
    part.block = true;
    const std::vector<std::int64_t> numbers = block_size(line);
    const std::int64_t* size = numbers.data();
    const auto nodes = static_cast<std::size_t>(size[0] * size[1] * size[2]);
    block_coordinates(part, line, size);
    const auto cells = [&](std::size_t k) { return static_cast<std::size_t>(std::max<std::int64_t>(1, size[k] - 1)); };
    std::vector<bool> left_out;
    std::vector<std::int64_t> flags;
    if (has_word(line, "iblanked")) {
        in_.integers(flags, nodes);
        left_out.assign(cells(0) * cells(1) * cells(2), false);
        for (std::size_t n = 0; n < nodes; ++n) {
            if (flags[n] != 0) {
                continue;
            }
            const std::size_t at[3] = {n % static_cast<std::size_t>(size[0]),
                                       n / static_cast<std::size_t>(size[0]) % static_cast<std::size_t>(size[1]),
                                       n / static_cast<std::size_t>(size[0] * size[1])};
            for (std::size_t c = 0; c < 8; ++c) {  // every cell around a node that is blanked
                const std::size_t i = at[0] - (c & 1);
                const std::size_t j = at[1] - (c >> 1 & 1);
                const std::size_t k = at[2] - (c >> 2 & 1);
                if (i < cells(0) && j < cells(1) && k < cells(2)) {
                    left_out[(k * cells(1) + j) * cells(0) + i] = true;
                }
            }
        }
    }
    if (has_word(line, "with_ghost")) {
        in_.line();  // "ghost_flags"
        const std::size_t all = cells(0) * cells(1) * cells(2);
        in_.integers(flags, all);
        left_out.resize(all);
        for (std::size_t i = 0; i < all; ++i) {
            left_out[i] = left_out[i] || flags[i] != 0;
        }
    }
    // A header may promise ids and blocks hold none.
    if (node_ids_ && in_.line_begins_with("node_ids")) {
        in_.line();
        in_.integers(flags, nodes);
    }
    if (element_ids_ && in_.line_begins_with("element_ids")) {
        in_.line();
        in_.integers(flags, cells(0) * cells(1) * cells(2));
    }
    block_cells(part, size, left_out);
}

// ---- lists of elements ----

void EnsightGeometry::check_nodes(std::vector<std::int64_t>& nodes, const ElementPart& part) {
    const auto most = static_cast<std::int64_t>(part.points.size() / 3);
    for (auto& node : nodes) {
        if (node < 1 || node > most) {
            in_.fail("an element of part '" + part.name + "' names node " + std::to_string(node) + " of " +
                     std::to_string(most));
        }
        --node;
    }
}

void EnsightGeometry::elements(EnsightPart& part, const std::string& kind, unsigned char type, int corners,
                               bool ghost) {
    const std::uint64_t count = in_.count("elements");
    std::vector<std::int64_t> ids;
    if (element_ids_) {
        in_.integers(ids, count);
    }
    part.runs.push_back({kind, part.elements.elements(), count, ghost});
    if (type == VTK_POLYGON) {
        return polygons(part, count, ghost);
    }
    if (type == VTK_POLYHEDRON) {
        return polyhedra(part, count, ghost);
    }
    in_.check_room(count * static_cast<std::uint64_t>(corners), "corners");
    std::vector<std::int64_t> nodes;
    in_.integers(nodes, count * static_cast<std::uint64_t>(corners));
    check_nodes(nodes, part.elements);
    for (std::size_t i = 0; i < count && !ghost; ++i) {
        part.elements.add(type, nodes.data() + i * static_cast<std::size_t>(corners),
                          static_cast<std::size_t>(corners));
    }
}

namespace {

std::uint64_t total(const std::vector<std::int64_t>& sizes, EnsightInput& in) {
    std::uint64_t sum = 0;
    for (const std::int64_t size : sizes) {
        if (size < 1) {
            in.fail("an element with " + std::to_string(size) + " corners or faces");
        }
        sum += static_cast<std::uint64_t>(size);
    }
    return sum;
}

}  // namespace

void EnsightGeometry::polygons(EnsightPart& part, std::uint64_t count, bool ghost) {
    std::vector<std::int64_t> sizes;
    std::vector<std::int64_t> nodes;
    in_.integers(sizes, count);
    in_.integers(nodes, total(sizes, in_));
    check_nodes(nodes, part.elements);
    std::size_t at = 0;
    for (const std::int64_t size : sizes) {
        if (!ghost) {
            part.elements.add(VTK_POLYGON, nodes.data() + at, static_cast<std::size_t>(size));
        }
        at += static_cast<std::size_t>(size);
    }
}

void EnsightGeometry::polyhedra(EnsightPart& part, std::uint64_t count, bool ghost) {
    std::vector<std::int64_t> faces;
    std::vector<std::int64_t> sizes;
    std::vector<std::int64_t> nodes;
    in_.integers(faces, count);
    in_.integers(sizes, total(faces, in_));
    in_.integers(nodes, total(sizes, in_));
    check_nodes(nodes, part.elements);
    std::size_t face = 0;
    std::size_t at = 0;
    for (const std::int64_t number : faces) {
        std::vector<std::int64_t> corners;
        std::vector<std::int64_t> stream = {number};
        for (std::int64_t f = 0; f < number; ++f, ++face) {
            stream.push_back(sizes[face]);
            for (std::int64_t k = 0; k < sizes[face]; ++k, ++at) {
                stream.push_back(nodes[at]);
                corners.push_back(nodes[at]);
            }
        }
        if (ghost) {
            continue;
        }
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        part.elements.add(VTK_POLYHEDRON, corners.data(), corners.size());
        part.elements.polyhedra.insert(part.elements.polyhedra.end(), stream.begin(), stream.end());
    }
}

}  // namespace underbody::postproc
