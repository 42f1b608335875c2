#include "postproc/importers/mesh/face_mesh.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <string_view>

#include "core/parallel.h"
#include "postproc/importers/import_context.h"

namespace underbody::postproc {

namespace {

struct Code {
    int code;
    const char* type;
};

constexpr std::array codes = {
    Code{2, "interior"},      Code{3, "wall"},        Code{4, "pressure-inlet"},     Code{5, "pressure-outlet"},
    Code{7, "symmetry"},      Code{8, "shadow"},      Code{9, "pressure-far-field"}, Code{0xa, "velocity-inlet"},
    Code{0xc, "periodic"},    Code{0xe, "fan"},       Code{0x14, "mass-flow-inlet"}, Code{0x18, "interface"},
    Code{0x19, "overset"},    Code{0x1f, "parent"},   Code{0x24, "outflow"},         Code{0x25, "axis"},
    Code{0x3f0, "interface"}, Code{0x3f4, "periodic"}};

constexpr std::pair<std::string_view, ZoneKind> kinds[] = {
    {"wall", ZoneKind::wall},
    {"pressure-inlet", ZoneKind::inlet},
    {"velocity-inlet", ZoneKind::inlet},
    {"mass-flow-inlet", ZoneKind::inlet},
    {"inlet-vent", ZoneKind::inlet},
    {"intake-fan", ZoneKind::inlet},
    {"pressure-outlet", ZoneKind::outlet},
    {"outlet-vent", ZoneKind::outlet},
    {"exhaust-fan", ZoneKind::outlet},
    {"mass-flow-outlet", ZoneKind::outlet},
    {"outflow", ZoneKind::outlet},
    {"symmetry", ZoneKind::symmetry},
    {"axis", ZoneKind::symmetry},
    {"periodic", ZoneKind::periodic},
    {"shadow", ZoneKind::periodic},
    {"periodic-shadow", ZoneKind::periodic},
    {"interface", ZoneKind::interface},
    {"overset", ZoneKind::interface},
    {"interior", ZoneKind::interior},
    {"parent", ZoneKind::interior},
    {"pressure-far-field", ZoneKind::farfield},
    {"fluid", ZoneKind::fluid},
    {"solid", ZoneKind::solid},
    {"fan", ZoneKind::other},
    {"porous-jump", ZoneKind::other},
    {"radiator", ZoneKind::other},
};

std::string text(std::uint64_t value) { return std::to_string(value); }

[[noreturn]] void refuse(const FaceMesh& mesh, const std::string& what) {
    throw core::InputError("format", what, {mesh.file, {}, {}, {}}, "the mesh is damaged or incomplete");
}

std::string zone_words(const FaceMesh& mesh, int zone) {
    const ZoneLabel* label = mesh.label(zone);
    return "zone " + std::to_string(zone) + (label != nullptr ? " (" + label->name + ")" : "");
}

/// Nearly every mesh is sound: one look at all numbers tells, and only a bad one is looked for face by face.
bool within(const Buffer<std::uint32_t>& numbers, std::uint32_t least, std::uint64_t most, core::Progress& progress) {
    constexpr std::size_t at_once = std::size_t{1} << 18;
    std::atomic<bool> all = true;
    core::parallel_blocks(
        numbers.size(), at_once,
        [&](std::size_t begin, std::size_t end) {
            std::uint32_t low = 0xffffffffU;
            std::uint32_t high = 0;
            for (std::size_t i = begin; i < end; ++i) {
                low = std::min(low, numbers[i]);
                high = std::max(high, numbers[i]);
            }
            if (low < least || high > most) {
                all = false;
            }
        },
        progress);
    return all;
}

void check_nodes(const FaceMesh& mesh, const FaceBlock& block, core::Progress& progress) {
    if (within(block.nodes, 1, mesh.nodes, progress)) {
        return;
    }
    for (std::size_t face = 0; face < block.count; ++face) {
        const std::uint32_t begin = block.begin_of(face);
        for (std::uint32_t k = begin; k < begin + block.size_of(face); ++k) {
            if (block.nodes[k] == 0 || block.nodes[k] > mesh.nodes) {
                refuse(mesh, "face " + text(block.first + face) + " of " + zone_words(mesh, block.zone) +
                                 " names node " + text(block.nodes[k]) + ", but there are " + text(mesh.nodes));
            }
        }
    }
}

void check_beside(const FaceMesh& mesh, const FaceBlock& block, core::Progress& progress) {
    for (const auto* beside : {&block.c0, &block.c1}) {
        if (within(*beside, 0, mesh.cells, progress)) {
            continue;
        }
        for (std::size_t face = 0; face < beside->size(); ++face) {
            if ((*beside)[face] > mesh.cells) {
                refuse(mesh, "face " + text(block.first + face) + " of " + zone_words(mesh, block.zone) +
                                 " names cell " + text((*beside)[face]) + ", but there are " + text(mesh.cells));
            }
        }
    }
}

/// How many places the blocks hold together; none may go beyond those that the file declares.
template <typename Block>
std::uint64_t counted(const FaceMesh& mesh, const std::vector<Block>& blocks, std::uint64_t declared,
                      const std::string& what) {
    std::uint64_t sum = 0;
    for (const auto& block : blocks) {
        sum += block.count;
        if (block.first == 0 || block.first + block.count - 1 > declared) {
            refuse(mesh, "the " + what + " " + text(block.first) + " to " + text(block.first + block.count - 1) +
                             " of " + zone_words(mesh, block.zone) + " go beyond the " + text(declared) +
                             " that the file declares");
        }
    }
    std::vector<std::pair<std::uint64_t, std::size_t>> in_order;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        if (blocks[i].count > 0) {
            in_order.emplace_back(blocks[i].first, i);
        }
    }
    std::sort(in_order.begin(), in_order.end());
    for (std::size_t i = 1; i < in_order.size(); ++i) {
        const auto& before = blocks[in_order[i - 1].second];
        if (before.first + before.count > in_order[i].first) {
            refuse(mesh, "the " + what + " of " + zone_words(mesh, before.zone) + " and " +
                             zone_words(mesh, blocks[in_order[i].second].zone) + " have numbers in common, from " +
                             text(in_order[i].first) + " on");
        }
    }
    return sum;
}

/// Do the ranges of the zones fit the numbers that the file declares?
void check_ranges(const FaceMesh& mesh, bool surfaces_only) {
    constexpr std::uint64_t most = 0x7fffffffULL;
    if (mesh.dimension != 2 && mesh.dimension != 3) {
        refuse(mesh, "the file does not say whether the mesh is 2-D or 3-D");
    }
    if (mesh.nodes > most || mesh.faces > most || mesh.cells > most) {
        refuse(mesh, "more than 2^31 nodes, faces or cells: " + text(mesh.nodes) + ", " + text(mesh.faces) + ", " +
                         text(mesh.cells));
    }
    if (mesh.nodes == 0 || mesh.faces == 0) {
        refuse(mesh,
               "the mesh has " + text(mesh.nodes) + " nodes and " + text(mesh.faces) + " faces: is it cut short?");
    }
    const std::uint64_t faces = counted(mesh, mesh.face_blocks, mesh.faces, "faces");
    if (!surfaces_only && faces != mesh.faces) {
        refuse(mesh, "the file declares " + text(mesh.faces) + " faces but its zones hold " + text(faces));
    }
    const std::uint64_t cells = counted(mesh, mesh.cell_blocks, mesh.cells, "cells");
    if (cells != mesh.cells) {
        refuse(mesh, "the file declares " + text(mesh.cells) + " cells but its zones hold " + text(cells));
    }
}

}  // namespace

const ZoneLabel* FaceMesh::label(int zone) const {
    for (const auto& candidate : labels) {
        if (candidate.id == zone) {
            return &candidate;
        }
    }
    return nullptr;
}

bool FaceMesh::is_solid(std::uint32_t cell) const {
    for (const auto& block : cell_blocks) {
        if (cell >= block.first && cell < block.first + block.count) {
            const ZoneLabel* own = label(block.zone);
            return own != nullptr && own->type == "solid";
        }
    }
    return false;
}

bool FaceMesh::bounds_solids(int zone) const {
    bool any = std::any_of(labels.begin(), labels.end(), [](const ZoneLabel& label) { return label.type == "solid"; });
    for (const auto& block : face_blocks) {
        for (std::size_t i = 0; any && block.zone == zone && i < block.c0.size(); ++i) {
            const std::uint32_t c1 = block.c1.empty() ? 0 : block.c1[i];
            any = (block.c0[i] != 0 || c1 != 0) && (block.c0[i] == 0 || is_solid(block.c0[i])) &&
                  (c1 == 0 || is_solid(c1));
        }
    }
    return any;
}

std::string type_of_code(int code) {
    for (const auto& [number, type] : codes) {
        if (number == code) {
            return type;
        }
    }
    return "unknown";
}

ZoneKind kind_of_type(const std::string& type) {
    for (const auto& [word, kind] : kinds) {
        if (word == type) {
            return kind;
        }
    }
    return type.empty() || type == "unknown" ? ZoneKind::unknown : ZoneKind::other;
}

bool is_inner_code(int code) { return code == 2; }
bool is_hidden_code(int code) { return code == 0x1f; }

void hide_generated_faces(FaceMesh& mesh) {
    const bool has_parents = std::any_of(mesh.face_blocks.begin(), mesh.face_blocks.end(),
                                         [](const FaceBlock& block) { return block.kind == 0x18; });
    for (const auto& block : mesh.face_blocks) {
        if (has_parents && (block.kind == 0x3f0 || block.kind == 0x3f4) && block.count > 0) {
            mesh.interface_children.push_back({block.first, block.first + block.count - 1});
        }
    }
}

std::string listed_zones(const FaceMesh& mesh) {
    std::vector<std::string> names;
    for (const auto& label : mesh.labels) {
        names.push_back(label.name);
    }
    return names.empty() ? "" : ", zones " + listed(names);
}

void check_cells_beside(const FaceMesh& mesh, core::Progress& progress) {
    check_ranges(mesh, false);
    std::uint64_t sides = 0;
    for (const auto& block : mesh.face_blocks) {
        check_beside(mesh, block, progress);
        sides += block.c0.size() + block.c1.size();
    }
    if (mesh.cells > sides) {  // before memory is taken for so many
        refuse(mesh, "the file declares " + text(mesh.cells) + " cells, but its faces have only " + text(sides) +
                         " sides for them");
    }
}

void check_mesh(const FaceMesh& mesh, bool surfaces_only, core::Progress& progress) {
    check_ranges(mesh, surfaces_only);
    for (const auto& block : mesh.face_blocks) {
        check_beside(mesh, block, progress);
        check_nodes(mesh, block, progress);
    }
}

}  // namespace underbody::postproc
