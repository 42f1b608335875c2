#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>

#include "core/parallel.h"
#include "core/text.h"
#include "postproc/importers/fluent/fluent_hdf5.h"
#include "postproc/importers/hdf5/hdf5_file.h"
#include "postproc/importers/hdf5/hdf5_rows.h"
#include "postproc/importers/import_context.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

std::string number(std::uint64_t value) { return std::to_string(value); }

/// One of the numbered parts that an array is stored in, by ids.
struct Part {
    std::string path;
    std::uint64_t first = 1;
    std::uint64_t count = 0;
};

class Reader {
public:
    Reader(const fs::path& path, const ReadOptions& options, core::Progress& progress)
        : file_(path), rows_(file_), options_(options), progress_(progress) {
        mesh_.file = path.string();
    }

    FaceMesh read_mesh();
    FluentSettings read_settings() const;
    [[nodiscard]] std::string understood() const {
        return number(mesh_.nodes) + " nodes, " + number(mesh_.faces) + " faces, " + number(mesh_.cells) + " cells" +
               listed_zones(mesh_);
    }

private:
    [[noreturn]] void refuse(const std::string& path, const std::string& what) const {
        throw core::InputError("format", path + ": " + what, {file_.name(), {}, {}, {}},
                               "the file is damaged or incomplete");
    }
    /// The corners of the faces of one zone, as far as their numbers are known, and where in the file they lie.
    struct Corners {
        struct Piece {
            std::string path;
            std::uint64_t first = 0, count = 0;
            std::uint64_t place = 0;  ///< among the zone's
        };
        std::uint64_t faces = 0, count = 0;
        std::vector<Piece> pieces;

        void note(const std::string& path, std::uint64_t first, std::uint64_t some) {
            if (pieces.empty() || pieces.back().path != path) {
                pieces.push_back({path, first, 0, count});
            }
            pieces.back().count += some;
        }
        void add(FaceBlock& block, const std::uint32_t* sizes, std::size_t some);
    };
    [[nodiscard]] std::uint64_t count(const std::string& name) const;
    [[nodiscard]] std::vector<Part> parts(const std::string& path) const;
    void take_codes(const Part& part, std::int64_t kind, const Buffer<std::uint32_t>& codes);
    void check_faces_there(const std::vector<Part>& cuts) const;
    [[nodiscard]] std::vector<std::string> zone_names(const std::string& path, std::size_t zones) const;
    void read_nodes();
    [[nodiscard]] std::vector<std::uint32_t> places_of_used_nodes();
    void read_cells();
    void read_faces();  ///< but for their nodes: these are noted to be read
    void cut_faces(const Part& part, std::vector<Corners>& corners);
    void read_beside(const std::string& side);
    void read_labels();
    void read_trees();

    Hdf5File file_;
    Hdf5Rows rows_;
    const ReadOptions& options_;
    core::Progress& progress_;
    FaceMesh mesh_;
    const std::string root_ = "/meshes/1";
};

std::uint64_t Reader::count(const std::string& name) const {
    const auto value = file_.attribute(root_, name);
    if (!value || *value < 0) {
        refuse(root_, "its attribute " + name + " is missing");
    }
    // Each node, face and cell has a number of four bytes at least, deflated as far as that goes.
    constexpr std::uint64_t largest_ratio = 1032;
    if (static_cast<std::uint64_t>(*value) / largest_ratio > file_.bytes()) {
        refuse(root_, name + " is " + std::to_string(*value) + ", more than a file of " + number(file_.bytes()) +
                          " bytes can hold");
    }
    return static_cast<std::uint64_t>(*value);
}

std::vector<Part> Reader::parts(const std::string& path) const {
    std::vector<Part> result;
    for (const auto& child : file_.children(path)) {
        const std::string inner = path + "/" + child;
        const auto first = file_.attribute(inner, "minId");
        const auto last = file_.attribute(inner, "maxId");
        if (!first || !last) {
            continue;
        }
        if (*first < 1 || *last > 0x7fffffffLL || *last + 1 < *first) {
            refuse(inner, "ids " + std::to_string(*first) + " to " + std::to_string(*last));
        }
        result.push_back({inner, static_cast<std::uint64_t>(*first), static_cast<std::uint64_t>(*last - *first + 1)});
    }
    std::sort(result.begin(), result.end(), [](const Part& a, const Part& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < result.size(); ++i) {
        if (result[i].first < result[i - 1].first + result[i - 1].count) {
            refuse(result[i].path, "its ids begin at " + number(result[i].first) + ", those of " + result[i - 1].path +
                                       " end behind that");
        }
    }
    return result;
}

/// One string for all zones, "inlet;outlet", as Fluent writes it, or one for each.
std::vector<std::string> Reader::zone_names(const std::string& path, std::size_t zones) const {
    std::vector<std::string> names = file_.texts(path);
    if (names.size() != zones || zones == 1) {
        const std::string joined = std::accumulate(names.begin(), names.end(), std::string());
        names.clear();
        for (const std::string_view name : core::split(joined, ';')) {
            names.emplace_back(name);
        }
    }
    for (auto& name : names) {
        name = std::string(core::trimmed(name));
    }
    return names;
}

FaceMesh Reader::read_mesh() {
    if (!file_.has(root_)) {
        refuse(root_, "there is no mesh in this file");
    }
    mesh_.dimension = static_cast<int>(file_.attribute(root_, "dimension").value_or(0));
    mesh_.nodes = count("nodeCount");
    mesh_.faces = count("faceCount");
    mesh_.cells = count("cellCount");
    read_cells();
    read_faces();
    read_trees();
    read_labels();
    hide_generated_faces(mesh_);
    if (options_.surfaces_only) {
        read_nodes();
    } else {
        // Cells are put together from what lies beside the faces: no need to wait for the nodes. Of two errors that of
        // the nodes is told, whichever came first.
        std::exception_ptr wrong_faces;
        const auto gather = [&] {
            try {
                gather_cell_faces(mesh_, progress_);
            } catch (...) {
                wrong_faces = std::current_exception();
            }
        };
        core::parallel_for(
            2, [&](std::size_t part) { part == 0 ? read_nodes() : gather(); }, progress_);
        if (wrong_faces) {
            std::rethrow_exception(wrong_faces);
        }
    }
    check_mesh(mesh_, options_.surfaces_only, progress_);
    return std::move(mesh_);
}

void Reader::read_nodes() {
    progress_.report(0.1, "reading nodes");
    const auto pieces = parts(root_ + "/nodes/coords");
    std::uint64_t found = 0;
    std::uint64_t last = 0;
    for (const auto& part : pieces) {
        const auto shape = file_.backed_shape(part.path);
        if (shape.size() != 2 || shape[0] != part.count || (shape[1] != 2 && shape[1] != 3)) {
            refuse(part.path, "its size does not fit its ids");
        }
        found += part.count;
        last = std::max(last, part.first + part.count - 1);
    }
    if (found != mesh_.nodes || last != mesh_.nodes) {
        refuse(root_ + "/nodes", "the mesh has " + number(mesh_.nodes) + " nodes, " + number(found) +
                                     " are there, up to " + number(last));
    }
    std::vector<std::uint32_t> places;
    if (options_.surfaces_only) {
        rows_.read(progress_);  // the faces
        places = places_of_used_nodes();
    }
    mesh_.points.grow_to(3 * mesh_.nodes);
    for (const auto& part : pieces) {
        const std::size_t width = file_.shape(part.path)[1];
        if (width == 3 && places.empty()) {
            rows_.add(part.path, 0, part.count, mesh_.points.data() + 3 * (part.first - 1));
            continue;
        }
        std::uint64_t node = part.first - 1;
        each_row(file_, part.path, progress_, [&](const double* coordinates, std::size_t nodes) {
            for (std::size_t i = 0; i < nodes; ++i, ++node) {
                const std::uint64_t place = places.empty() ? node : places[node];
                if (place >= mesh_.nodes) {
                    continue;
                }
                double* out = mesh_.points.data() + 3 * place;
                std::copy_n(coordinates + i * width, width, out);
                out[2] = width == 2 ? 0 : out[2];
            }
            return true;
        });
    }
    rows_.read(progress_);
    for (const double x : mesh_.points) {
        if (!std::isfinite(x)) {
            refuse(root_ + "/nodes", "a coordinate that is not a number");
        }
    }
    for (const std::string& where :
         {std::string("/"), std::string("/meshes"), root_, root_ + "/nodes", root_ + "/nodes/coords"}) {
        if (const auto unit = file_.text_attribute(where, "units")) {
            mesh_.length_unit = *unit;
            mesh_.length_unit_known = true;
        }
    }
}

/// Of a surface only its own nodes are kept: the faces get the numbers that these have among themselves.
/// The list says where a node of the file goes; beyond the number of nodes: nowhere.
std::vector<std::uint32_t> Reader::places_of_used_nodes() {
    constexpr std::uint32_t nowhere = 0xffffffffU;
    std::vector<std::uint32_t> places(mesh_.nodes, nowhere);
    for (const auto& block : mesh_.face_blocks) {
        for (const std::uint32_t node : block.nodes) {
            if (node == 0 || node > mesh_.nodes) {
                refuse(root_ + "/faces", "a face of zone " + std::to_string(block.zone) + " names node " +
                                             number(node) + " of " + number(mesh_.nodes));
            }
            places[node - 1] = 0;
        }
    }
    std::uint32_t used = 0;
    for (auto& place : places) {
        place = place == nowhere ? nowhere : used++;
    }
    for (auto& block : mesh_.face_blocks) {
        for (auto& node : block.nodes) {
            node = places[node - 1] + 1;
        }
    }
    mesh_.declared_nodes = mesh_.nodes;
    mesh_.nodes = used;
    return places;
}

/// Codes of mixed zones: they tell polyhedra that look like hexahedra. `codes` is empty where all cells are of one
/// kind.
void Reader::take_codes(const Part& part, std::int64_t kind, const Buffer<std::uint32_t>& codes) {
    const bool mixed = !codes.empty();
    for (auto& block : mesh_.cell_blocks) {
        const std::uint64_t from = std::max(block.first, part.first);
        const std::uint64_t to = std::min(block.first + block.count, part.first + part.count);
        if (from >= to) {
            continue;
        }
        if (!mixed) {
            block.element = block.element == 0 ? static_cast<int>(kind & 255) : block.element;
            continue;
        }
        if (block.elements.empty()) {
            block.elements.grow_to(block.count);
            block.elements.fill(0);
        }
        for (std::uint64_t id = from; id < to; ++id) {
            block.elements[id - block.first] =
                static_cast<unsigned char>(std::min<std::uint32_t>(codes[id - part.first], 255));
        }
    }
}

void Reader::read_cells() {
    const std::string topology = root_ + "/cells/zoneTopology/";
    if (mesh_.cells == 0 && !file_.has(topology + "id")) {
        return;
    }
    const auto ids = file_.numbers(topology + "id");
    const auto first = file_.numbers(topology + "minId");
    const auto last = file_.numbers(topology + "maxId");
    const auto element =
        file_.has(topology + "cellType") ? file_.numbers(topology + "cellType") : Buffer<std::uint32_t>();
    const auto type = file_.has(topology + "zoneType") ? file_.numbers(topology + "zoneType") : Buffer<std::uint32_t>();
    const auto names = zone_names(topology + "name", ids.size());
    if (first.size() != ids.size() || last.size() != ids.size()) {
        refuse(topology, "its lists differ in length");
    }
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        constexpr std::uint32_t solid = 17;
        constexpr std::uint32_t parent_type = 32;
        CellBlock block;
        block.zone = static_cast<int>(ids[i] & 0x7fffffffU);
        block.first = first[i];
        block.count = last[i] >= first[i] ? last[i] - first[i] + 1 : 0;
        block.element = i < element.size() ? static_cast<int>(std::min<std::uint32_t>(element[i], 255)) : 0;
        block.parents = i < type.size() && type[i] == parent_type;
        total += block.count;
        if (total > mesh_.cells || block.first == 0) {
            refuse(topology, "cells beyond the " + number(mesh_.cells) + " of the mesh");
        }
        mesh_.labels.push_back(
            {block.zone, i < type.size() && type[i] == solid ? "solid" : "fluid", i < names.size() ? names[i] : ""});
        mesh_.cell_blocks.push_back(std::move(block));
    }
    if (options_.surfaces_only) {
        return;
    }
    // Codes of mixed zones: they tell polyhedra that look like hexahedra.
    for (const auto& part : parts(root_ + "/cells/ctype")) {
        const auto kind = file_.attribute(part.path, "elementType").value_or(0);
        const bool mixed = kind == 0 && file_.has(part.path + "/cell-types");
        const auto codes = mixed ? file_.numbers(part.path + "/cell-types") : Buffer<std::uint32_t>();
        if (mixed && codes.size() != part.count) {
            refuse(part.path, "its size does not fit its ids");
        }
        take_codes(part, kind, codes);
    }
}

/// The faces of each zone must all be in some part of the lists.
void Reader::check_faces_there(const std::vector<Part>& cuts) const {
    for (const auto& block : mesh_.face_blocks) {
        std::uint64_t there = 0;
        for (const auto& part : cuts) {
            const std::uint64_t from = std::max(block.first, part.first);
            const std::uint64_t to = std::min(block.first + block.count, part.first + part.count);
            there += from < to ? to - from : 0;
        }
        if (there < block.count) {
            refuse(root_ + "/faces/nodes", "the faces of zone " + std::to_string(block.zone) + " are missing");
        }
    }
}

void Reader::read_faces() {
    const std::string topology = root_ + "/faces/zoneTopology/";
    const auto ids = file_.numbers(topology + "id");
    const auto first = file_.numbers(topology + "minId");
    const auto last = file_.numbers(topology + "maxId");
    const auto type = file_.numbers(topology + "zoneType");
    const auto names = zone_names(topology + "name", ids.size());
    if (first.size() != ids.size() || last.size() != ids.size() || type.size() != ids.size()) {
        refuse(topology, "its lists differ in length");
    }
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        FaceBlock block;
        block.zone = static_cast<int>(ids[i] & 0x7fffffffU);
        block.kind = static_cast<int>(std::min<std::uint32_t>(type[i], 0xffff));
        block.first = first[i];
        block.count = last[i] >= first[i] ? last[i] - first[i] + 1 : 0;
        total += block.count;
        if (block.first == 0 || block.first + block.count - 1 > mesh_.faces || total > mesh_.faces) {
            refuse(topology, "faces beyond the " + number(mesh_.faces) + " of the mesh");
        }
        mesh_.labels.push_back({block.zone, type_of_code(block.kind), i < names.size() ? names[i] : ""});
        if (!(options_.surfaces_only && is_inner_code(block.kind)) && block.count > 0) {
            mesh_.face_blocks.push_back(std::move(block));
        }
    }
    std::sort(mesh_.face_blocks.begin(), mesh_.face_blocks.end(),
              [](const FaceBlock& a, const FaceBlock& b) { return a.first < b.first; });
    progress_.report(0.2, "reading faces");
    const auto cuts = parts(root_ + "/faces/nodes");
    check_faces_there(cuts);
    for (const auto& part : cuts) {
        (void)file_.backed_shape(part.path + "/nnodes");
    }
    std::vector<Corners> corners(mesh_.face_blocks.size());
    for (const auto& part : cuts) {
        cut_faces(part, corners);
    }
    read_beside("c0");
    read_beside("c1");
    rows_.read(progress_);
    for (std::size_t b = 0; b < corners.size(); ++b) {
        Buffer<std::uint32_t>& nodes = mesh_.face_blocks[b].nodes;
        nodes.grow_to(corners[b].count);
        for (const auto& piece : corners[b].pieces) {
            rows_.add(piece.path, piece.first, piece.count, nodes.data() + piece.place);
        }
    }
}

/// The sizes of some more faces of a zone. If all its faces have so many corners, no list of where each begins is made.
void Reader::Corners::add(FaceBlock& block, const std::uint32_t* sizes, std::size_t some) {
    std::uint64_t sum = 0;
    std::uint32_t differs = 0;
    block.per_face = faces == 0 ? sizes[0] : block.per_face;
    for (std::size_t i = 0; i < some; ++i) {
        sum += sizes[i];
        differs |= sizes[i] ^ block.per_face;
    }
    if (block.offsets.empty() && differs == 0 && block.per_face > 0) {
        faces += some;
        count += sum;
        return;
    }
    if (block.offsets.empty()) {
        block.offsets.grow_to(block.count + 1);
        for (std::uint64_t face = 0; face <= faces; ++face) {
            block.offsets[face] = static_cast<std::uint32_t>(face * block.per_face);
        }
    }
    block.per_face = 0;
    for (std::size_t i = 0; i < some; ++i) {
        count += sizes[i];
        block.offsets[++faces] = static_cast<std::uint32_t>(count);
    }
}

/// Finds each zone's share of a part of the faces; the nodes of faces that nobody wants are not read. A zone may lie in
/// several parts. One wrong size would move all faces behind it: all of them are added up.
void Reader::cut_faces(const Part& part, std::vector<Corners>& corners) {
    const auto shape = file_.shape(part.path + "/nnodes");
    const auto nodes = file_.backed_shape(part.path + "/nodes");
    if (shape.size() != 1 || shape[0] != part.count || nodes.size() != 1) {
        refuse(part.path, "its size does not fit its ids");
    }
    std::uint64_t id = part.first;
    std::uint64_t at = 0;  // of the corners of the next face among the part's nodes
    std::size_t b = 0;
    const auto take = [&](const std::uint32_t* sizes, std::size_t count) {
        for (std::size_t i = 0; i < count;) {
            while (b < corners.size() && mesh_.face_blocks[b].first + mesh_.face_blocks[b].count <= id) {
                ++b;
            }
            if (b == corners.size()) {  // nobody wants these, but their corners must be those that are left
                at += std::accumulate(sizes + i, sizes + count, std::uint64_t{0});
                return true;
            }
            FaceBlock& block = mesh_.face_blocks[b];
            const bool wanted = block.first <= id;
            const std::uint64_t left = wanted ? block.first + block.count - id : block.first - id;
            const std::size_t some = std::min<std::uint64_t>(count - i, left);
            const std::uint64_t sum = std::accumulate(sizes + i, sizes + i + some, std::uint64_t{0});
            if (sum > nodes[0] - at) {
                refuse(part.path, "faces up to " + number(id + some - 1) + " want more nodes than there are");
            }
            if (wanted) {
                if (corners[b].faces != id - block.first) {
                    refuse(part.path, "the faces of zone " + std::to_string(block.zone) + " are not in order");
                }
                if (corners[b].count + sum > 0xffffffffULL) {
                    refuse(part.path, "too many corners");
                }
                corners[b].note(part.path + "/nodes", at, sum);
                corners[b].add(block, sizes + i, some);
            }
            at += sum;
            id += some;
            i += some;
        }
        return true;
    };
    each_row(file_, part.path + "/nnodes", progress_, take);
    if (at != nodes[0]) {
        refuse(part.path,
               "its faces have " + number(at) + " corners together, and " + number(nodes[0]) + " nodes are there");
    }
}

void Reader::read_beside(const std::string& side) {
    std::uint64_t found = 0;
    for (const auto& part : parts(root_ + "/faces/" + side)) {
        progress_.check();
        const auto shape = file_.backed_shape(part.path);
        if (shape.size() != 1 || shape[0] != part.count) {
            refuse(part.path, "its size does not fit its ids");
        }
        found += part.count;
        for (auto& block : mesh_.face_blocks) {
            const std::uint64_t from = std::max(block.first, part.first);
            const std::uint64_t to = std::min(block.first + block.count, part.first + part.count);
            if (from < to) {
                auto& target = side == "c0" ? block.c0 : block.c1;
                if (target.empty()) {
                    target.grow_to(block.count);
                    if (to - from < block.count) {
                        target.fill(0);
                    }
                }
                rows_.add(part.path, from - part.first, to - from, target.data() + (from - block.first));
            }
        }
    }
    const bool whole = std::all_of(mesh_.face_blocks.begin(), mesh_.face_blocks.end(),
                                   [](const FaceBlock& block) { return block.c0.size() == block.count; });
    if (side == "c0" && (found < mesh_.faces || !whole)) {
        refuse(root_ + "/faces/c0",
               "the cells beside " + number(mesh_.faces - std::min(found, mesh_.faces)) + " faces are missing");
    }
}

/// Adapted meshes keep the parents of what they split.
void Reader::read_trees() {
    for (const auto& part : parts(root_ + "/cells/tree")) {
        mesh_.hidden_cells.push_back({part.first, part.first + part.count - 1});
    }
    for (const auto& part : parts(root_ + "/faces/tree")) {
        mesh_.hidden_faces.push_back({part.first, part.first + part.count - 1});
    }
}

/// The texts of the legacy sections 39 know the types better than the codes do.
void Reader::read_labels() {
    const std::string text = file_.text("/settings/Thread Variables");
    for (std::size_t at = text.find("(39 ("); at != std::string::npos; at = text.find("(39 (", at + 1)) {
        const std::size_t end = std::min(text.find(')', at), text.size());
        std::vector<std::string> words;
        for (const auto word : core::split(std::string_view(text).substr(at + 5, end - at - 5), ' ')) {
            if (!word.empty()) {
                words.emplace_back(word);
            }
        }
        if (words.size() < 3) {
            continue;
        }
        for (auto& label : mesh_.labels) {
            if (core::parse_integer(words[0]) == label.id) {
                label.type = words[1];
                label.name = label.name.empty() ? words[2] : label.name;
            }
        }
    }
}

FluentSettings Reader::read_settings() const {
    FluentSettings settings;
    settings.writer = file_.text("/settings/Origin");
    settings.variables = file_.text("/settings/Rampant Variables");
    return settings;
}

}  // namespace

Hdf5Mesh read_hdf5_mesh(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    Reader reader(path, options, progress);
    Hdf5Mesh result;
    result.settings = reader.read_settings();
    result.mesh = telling([&] { return reader.read_mesh(); }, [&] { return reader.understood(); });
    return result;
}

}  // namespace underbody::postproc
