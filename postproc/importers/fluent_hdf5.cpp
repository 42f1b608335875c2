// Fluent's common fluids format: .msh.h5, .cas.h5, .dat.h5.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/text.h"
#include "postproc/importers/face_mesh.h"
#include "postproc/importers/fluent_settings.h"
#include "postproc/importers/fluent_text.h"
#include "postproc/importers/fluent_variables.h"
#include "postproc/importers/hdf5_file.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/partner.h"
#include "postproc/importers/understood.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;

std::string number(std::uint64_t value) { return std::to_string(value); }

/// The name at the end of a path, written on whatever system.
std::string file_name_in(const std::string& path) {
    const std::string text(core::trimmed(path));
    return text.substr(text.find_last_of("/\\") + 1);
}

/// One of the numbered parts that an array is stored in, by ids.
struct Part {
    std::string path;
    std::uint64_t first = 1;
    std::uint64_t count = 0;
};

class Reader {
public:
    Reader(const fs::path& path, const ReadOptions& options, core::Progress& progress)
        : file_(path), options_(options), progress_(progress) {
        mesh_.file = path.string();
    }

    FaceMesh read_mesh();
    FluentSettings read_settings() const;
    [[nodiscard]] std::string understood() const {
        std::string text = number(mesh_.nodes) + " nodes, " + number(mesh_.faces) + " faces, " + number(mesh_.cells) + " cells";
        for (std::size_t i = 0; i < std::min<std::size_t>(mesh_.labels.size(), 12); ++i) {
            text += (i == 0 ? ", zones " : ", ") + mesh_.labels[i].name;
        }
        return text;
    }

private:
    [[noreturn]] void refuse(const std::string& path, const std::string& what) const {
        throw core::InputError("format", path + ": " + what, {file_.name(), {}, {}, {}},
                               "the file is damaged or incomplete");
    }
    [[nodiscard]] std::uint64_t count(const std::string& name) const;
    [[nodiscard]] std::vector<Part> parts(const std::string& path) const;
    void read_nodes();
    [[nodiscard]] std::vector<std::uint32_t> places_of_used_nodes();
    void read_cells();
    void read_faces();
    void cut_faces(const Part& part);
    static void note_equal_sizes(FaceBlock& block);
    void read_beside(const std::string& side);
    void read_labels();
    void read_trees();

    Hdf5File file_;
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
        if (*first < 1 || *last + 1 < *first || *last > 0x7fffffffLL) {
            refuse(inner, "ids " + std::to_string(*first) + " to " + std::to_string(*last));
        }
        result.push_back({inner, static_cast<std::uint64_t>(*first), static_cast<std::uint64_t>(*last - *first + 1)});
    }
    return result;
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
    read_nodes();
    read_trees();
    read_labels();
    hide_generated_faces(mesh_);
    check_mesh(mesh_, options_.surfaces_only, progress_);
    return std::move(mesh_);
}

void Reader::read_nodes() {
    progress_.report(0.1, "reading nodes");
    const auto pieces = parts(root_ + "/nodes/coords");
    std::uint64_t found = 0;
    std::uint64_t last = 0;
    for (const auto& part : pieces) {
        const auto shape = file_.shape(part.path);
        if (shape.size() != 2 || shape[0] != part.count || (shape[1] != 2 && shape[1] != 3)) {
            refuse(part.path, "its size does not fit its ids");
        }
        found += part.count;
        last = std::max(last, part.first + part.count - 1);
    }
    if (found != mesh_.nodes || last != mesh_.nodes) {
        refuse(root_ + "/nodes", "the mesh has " + number(mesh_.nodes) + " nodes, " + number(found) + " are there, up to " +
                                     number(last));
    }
    const std::vector<std::uint32_t> places = options_.surfaces_only ? places_of_used_nodes() : std::vector<std::uint32_t>();
    mesh_.points.grow_to(3 * mesh_.nodes);
    constexpr std::uint64_t at_once = std::uint64_t{1} << 16;
    Buffer<double> raw;
    for (const auto& part : pieces) {
        const std::size_t width = file_.shape(part.path)[1];
        if (width == 3 && places.empty()) {
            file_.reals(part.path, 0, part.count, mesh_.points.data() + 3 * (part.first - 1));
            continue;
        }
        for (std::uint64_t done = 0; done < part.count; done += at_once) {
            progress_.check();
            const std::uint64_t some = std::min(at_once, part.count - done);
            raw.grow_to(some * width);
            file_.reals(part.path, done, some, raw.data());
            for (std::uint64_t i = 0; i < some; ++i) {
                const std::uint64_t node = part.first - 1 + done + i;
                const std::uint64_t place = places.empty() ? node : places[node];
                if (place >= mesh_.nodes) {
                    continue;
                }
                double* out = mesh_.points.data() + 3 * place;
                std::copy_n(raw.data() + i * width, width, out);
                out[2] = width == 2 ? 0 : out[2];
            }
        }
    }
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
                refuse(root_ + "/faces", "a face of zone " + std::to_string(block.zone) + " names node " + number(node) +
                                             " of " + number(mesh_.nodes));
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
    const std::string joined_names = file_.text(topology + "name");
    const auto names = core::split(joined_names, ';');
    if (first.size() != ids.size() || last.size() != ids.size()) {
        refuse(topology, "its lists differ in length");
    }
    for (std::size_t i = 0; i < ids.size(); ++i) {
        constexpr std::uint32_t solid = 17;
        CellBlock block;
        block.zone = static_cast<int>(ids[i] & 0x7fffffffU);
        block.first = first[i];
        block.count = last[i] >= first[i] ? last[i] - first[i] + 1 : 0;
        block.element = i < element.size() ? static_cast<int>(std::min<std::uint32_t>(element[i], 255)) : 0;
        if (block.count > mesh_.cells || block.first == 0) {
            refuse(topology, "cells beyond the " + number(mesh_.cells) + " of the mesh");
        }
        mesh_.labels.push_back({block.zone, i < type.size() && type[i] == solid ? "solid" : "fluid",
                                i < names.size() ? std::string(core::trimmed(names[i])) : ""});
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
}

void Reader::read_faces() {
    const std::string topology = root_ + "/faces/zoneTopology/";
    const auto ids = file_.numbers(topology + "id");
    const auto first = file_.numbers(topology + "minId");
    const auto last = file_.numbers(topology + "maxId");
    const auto type = file_.numbers(topology + "zoneType");
    const std::string joined_names = file_.text(topology + "name");
    const auto names = core::split(joined_names, ';');
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
        mesh_.labels.push_back(
            {block.zone, type_of_code(block.kind), i < names.size() ? std::string(core::trimmed(names[i])) : ""});
        if (!(options_.surfaces_only && is_inner_code(block.kind)) && block.count > 0) {
            mesh_.face_blocks.push_back(std::move(block));
        }
    }
    std::sort(mesh_.face_blocks.begin(), mesh_.face_blocks.end(),
              [](const FaceBlock& a, const FaceBlock& b) { return a.first < b.first; });
    progress_.report(0.2, "reading faces");
    for (const auto& part : parts(root_ + "/faces/nodes")) {
        progress_.check();
        cut_faces(part);
    }
    for (const auto& block : mesh_.face_blocks) {
        if (block.offsets.size() != block.count + 1) {
            refuse(root_ + "/faces/nodes", "the faces of zone " + std::to_string(block.zone) + " are missing");
        }
    }
    for (auto& block : mesh_.face_blocks) {
        note_equal_sizes(block);
    }
    read_beside("c0");
    read_beside("c1");
}

/// Gives each zone its share of a part of the faces; faces that nobody wants are not read. A zone may lie in several
/// parts.
void Reader::cut_faces(const Part& part) {
    const auto shape = file_.shape(part.path + "/nnodes");
    const auto nodes = file_.shape(part.path + "/nodes");
    if (shape.size() != 1 || shape[0] != part.count || nodes.size() != 1) {
        refuse(part.path, "its size does not fit its ids");
    }
    std::uint64_t at = 0;
    std::uint64_t id = part.first;
    std::vector<std::uint32_t> sizes;
    // The corners of the faces from `from` on, with what came before them in `sum`.
    const auto corners_of = [&](std::uint64_t from, std::uint64_t count, std::uint64_t sum) {
        sizes.resize(count);
        file_.numbers(part.path + "/nnodes", from - part.first, count, sizes.data());
        for (const std::uint32_t size : sizes) {
            sum += size;
        }
        if (sum > nodes[0] - std::min(at, nodes[0])) {
            refuse(part.path, "faces up to " + number(from + count - 1) + " want more nodes than there are");
        }
        return sum;
    };
    constexpr std::uint64_t at_once = std::uint64_t{1} << 18;
    for (auto& block : mesh_.face_blocks) {
        const std::uint64_t end = std::min(block.first + block.count, part.first + part.count);
        if (end <= id || block.first >= part.first + part.count) {
            continue;
        }
        while (id < block.first) {
            const std::uint64_t some = std::min(at_once, block.first - id);
            at += corners_of(id, some, 0);
            id += some;
        }
        if (block.offsets.empty()) {
            block.offsets.push(0);
        }
        if (block.offsets.size() != id - block.first + 1) {
            refuse(part.path, "the faces of zone " + std::to_string(block.zone) + " are not in order");
        }
        const std::size_t before = block.nodes.size();
        std::uint64_t corners = 0;
        std::size_t next = block.offsets.size();
        block.offsets.grow_to(next + (end - id));
        for (std::uint64_t from = id; from < end; from += at_once) {
            const std::uint64_t sum = corners_of(from, std::min(at_once, end - from), corners);
            if (before + sum > 0xffffffffULL) {
                refuse(part.path, "too many corners");
            }
            std::uint64_t place = before + corners;
            for (const std::uint32_t size : sizes) {
                place += size;
                block.offsets[next++] = static_cast<std::uint32_t>(place);
            }
            corners = sum;
        }
        block.nodes.grow_to(before + corners);
        file_.numbers(part.path + "/nodes", at, corners, block.nodes.data() + before);
        at += corners;
        id = end;
    }
}

/// Zones whose faces all have so many corners need no list of where each begins.
void Reader::note_equal_sizes(FaceBlock& block) {
    const std::uint32_t size = block.count > 0 ? block.offsets[1] : 0;
    std::uint32_t differs = 0;
    for (std::size_t face = 0; face < block.count; ++face) {
        differs |= (block.offsets[face + 1] - block.offsets[face]) ^ size;
    }
    if (differs == 0 && size > 0) {
        block.per_face = size;
        block.offsets.clear();
    }
}

void Reader::read_beside(const std::string& side) {
    std::uint64_t found = 0;
    for (const auto& part : parts(root_ + "/faces/" + side)) {
        progress_.check();
        const auto shape = file_.shape(part.path);
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
                file_.numbers(part.path, from - part.first, to - from, target.data() + (from - block.first));
            }
        }
    }
    const bool whole = std::all_of(mesh_.face_blocks.begin(), mesh_.face_blocks.end(), [](const FaceBlock& block) { return block.c0.size() == block.count; });
    if (side == "c0" && (found < mesh_.faces || !whole)) {
        refuse(root_ + "/faces/c0", "the cells beside " + number(mesh_.faces - std::min(found, mesh_.faces)) + " faces are missing");
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

/// Values of a .dat.h5 for the zones that the mesh has.
class DataReader {
public:
    DataReader(const fs::path& path, const FaceMesh& mesh, const ReadOptions& options, core::Progress& progress)
        : file_(path), mesh_(mesh), options_(options), progress_(progress) {}

    std::vector<ValueBlock> read(FluentSettings& settings, core::Problems& problems);
    /// Of the first phase, the variables asked for.
    void add_cells(std::vector<ValueBlock>& values);

private:
    void read_variable(const std::string& group, const std::string& variable, bool on_cells, int phase);
    void keep(const std::string& path, ValueBlock&& whole);
    [[nodiscard]] std::uint64_t last_fluid_cell() const;
    [[noreturn]] void other_case(const std::string& what) const {
        throw core::InputError("mismatch", "these data belong to another case than " + mesh_.file + ": " + what,
                               {file_.name(), {}, {}, {}}, "give the case they were written with");
    }

    Hdf5File file_;
    const FaceMesh& mesh_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::vector<ValueBlock> values_;
    std::uint64_t most_cell_ = 0;
    std::uint64_t most_face_ = 0;
    bool any_ = false;
};

std::vector<ValueBlock> DataReader::read(FluentSettings& settings, core::Problems& problems) {
    const core::Place place{file_.name(), {}, {}, {}};
    for (const auto& phase : file_.children("/results/1")) {
        if (!phase.starts_with("phase-")) {
            continue;
        }
        const auto index = static_cast<int>(core::parse_integer(phase.substr(6)).value_or(1));
        for (const bool on_cells : {true, false}) {
            const std::string group = "/results/1/" + phase + (on_cells ? "/cells" : "/faces");
            for (const auto& variable : file_.children(group)) {
                if (variable != "fields") {
                    progress_.check();
                    read_variable(group + "/" + variable, variable, on_cells, index);
                }
            }
        }
    }
    if (!any_) {
        throw core::InputError("format", "there are no solution data in this file", place);
    }
    if (most_cell_ > 0 && most_cell_ < last_fluid_cell() && mesh_.hidden_cells.empty()) {
        other_case("its cells end at " + number(most_cell_) + ", the case has " + number(mesh_.cells));
    }
    settings.variables += file_.text("/settings/Data Variables");
    const std::string named = file_name_in(file_.text("/settings/Case File"));
    const std::string ours = fs::path(mesh_.file).filename().string();
    if (!named.empty() && named != ours) {
        problems.push_back(
            {core::Problem::Severity::note,
             "the data say they were written with '" + named + "'; counts and ids agree with '" + ours + "'", place});
    }
    return std::move(values_);
}

void DataReader::add_cells(std::vector<ValueBlock>& values) {
    const std::string group = "/results/1/phase-1/cells";
    for (const auto& variable : file_.children(group)) {
        if (variable != "fields" && wants_variable(options_, variable)) {
            read_variable(group + "/" + variable, variable, true, 1);
        }
    }
    std::move(values_.begin(), values_.end(), std::back_inserter(values));
}

/// A solid without an energy equation has no values at all.
std::uint64_t DataReader::last_fluid_cell() const {
    std::uint64_t last = 0;
    for (const auto& block : mesh_.cell_blocks) {
        const ZoneLabel* label = mesh_.label(block.zone);
        if (label == nullptr || label->type != "solid") {
            last = std::max(last, block.first + block.count - 1);
        }
    }
    return last;
}

void DataReader::read_variable(const std::string& group, const std::string& variable, bool on_cells, int phase) {
    for (const auto& child : file_.children(group)) {
        const std::string path = group + "/" + child;
        const auto first = file_.attribute(path, "minId");
        const auto last = file_.attribute(path, "maxId");
        const auto shape = file_.shape(path);
        if (!first || !last || shape.empty()) {
            continue;
        }
        any_ = true;
        const std::uint64_t limit = on_cells ? mesh_.cells : mesh_.faces;
        if (*first < 1 || *last + 1 < *first || static_cast<std::uint64_t>(*last) > limit) {
            other_case(path + " has ids " + std::to_string(*first) + " to " + std::to_string(*last) +
                       ", the case has " + number(limit) + (on_cells ? " cells" : " faces"));
        }
        auto& most = on_cells ? most_cell_ : most_face_;
        most = std::max(most, static_cast<std::uint64_t>(*last));
        if ((on_cells && options_.surfaces_only) || !wants_variable(options_, variable)) {
            continue;
        }
        ValueBlock block;
        block.variable = variable;
        block.on_cells = on_cells;
        block.phase = phase;
        block.first = static_cast<std::uint64_t>(*first);
        block.count = static_cast<std::uint64_t>(*last - *first + 1);
        block.components = shape.size() > 1 ? static_cast<int>(std::min<std::uint64_t>(shape[1], 1024)) : 1;
        if (shape[0] != block.count || (shape.size() > 1 && (shape[1] > 1024 || shape[1] == 0))) {
            throw core::InputError("format", path + ": its size does not fit its ids", {file_.name(), {}, {}, {}});
        }
        keep(path, std::move(block));
    }
}

/// On faces the inside of the mesh is by far the most and nobody looks at it: only the zones' shares are read.
void DataReader::keep(const std::string& path, ValueBlock&& whole) {
    const auto n = static_cast<std::size_t>(whole.components);
    if (whole.on_cells) {
        whole.values = file_.reals(path);
        values_.push_back(std::move(whole));
        return;
    }
    for (const auto& zone : mesh_.face_blocks) {
        const std::uint64_t from = std::max(whole.first, zone.first);
        const std::uint64_t to = std::min(whole.first + whole.count, zone.first + zone.count);
        if (is_inner_code(zone.kind) || from >= to) {
            continue;
        }
        ValueBlock part;
        part.variable = whole.variable;
        part.zone = zone.zone;
        part.phase = whole.phase;
        part.first = from;
        part.count = to - from;
        part.components = whole.components;
        part.values.grow_to(part.count * n);
        file_.reals(path, from - whole.first, part.count, part.values.data());
        values_.push_back(std::move(part));
    }
}

constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8);

bool recognises(std::string_view head, const fs::path& path) {
    if (!head.starts_with(signature)) {
        return false;
    }
    try {
        const Hdf5File file(path);
        return file.has("/meshes/1") || file.has("/results/1");
    } catch (const core::InputError&) {
        // Cut short: who else writes such endings?
        const std::string name = core::lower_case(path.filename().string());
        return name.ends_with(".cas.h5") || name.ends_with(".dat.h5") || name.ends_with(".msh.h5");
    }
}

Field read(const fs::path& path, const ReadOptions& options, core::Progress& progress) {
    const bool has_mesh = Hdf5File(path).has("/meshes/1");
    fs::path mesh_path = path;
    fs::path data_path = options.companion;
    const bool asked_for = !has_mesh || !options.companion.empty();
    if (has_mesh && data_path.empty()) {
        data_path = partner_by_name(path, {".cas.h5"}, {".dat.h5"});
    }
    if (!has_mesh) {
        data_path = path;
        mesh_path = options.companion.empty() ? partner_by_name(path, {".dat.h5"}, {".cas.h5"}) : options.companion;
        if (mesh_path.empty()) {
            const std::string named = file_name_in(Hdf5File(path).text("/settings/Case File"));
            const fs::path beside = path.parent_path() / named;
            mesh_path = !named.empty() && fs::is_regular_file(beside) ? beside : fs::path();
        }
        if (mesh_path.empty()) {
            throw core::InputError("missing", "these are solution data without a mesh", {path.string(), {}, {}, {}},
                                   "give the case (.cas.h5) they belong to as the companion file");
        }
    }
    if (!data_path.empty()) {
        // The data are tried in a process of its own: now, while there is little memory that it would have to share.
        try {
            Hdf5File early(data_path);
        } catch (const core::InputError&) {
            // said below, where it is known whether the data were asked for
        }
    }
    Reader reader(mesh_path, options, progress);
    FluentSettings settings = reader.read_settings();
    FaceMesh mesh = telling([&] { return reader.read_mesh(); }, [&] { return reader.understood(); });
    if (!settings.variables.empty()) {
        mesh.length_unit = "m";
        mesh.length_unit_known = true;
    }
    core::Problems problems;
    std::vector<ValueBlock> values;
    bool with_data = false;
    if (!data_path.empty()) {
        progress.report(0.4, "reading " + data_path.filename().string());
        try {
            values = DataReader(data_path, mesh, options, progress).read(settings, problems);
            if (options.surfaces_only && wants_variable(options, "SV_P") && walls_lack_pressure(mesh, values)) {
                const ReadOptions again = for_pressure_of_cells(options);
                DataReader(data_path, mesh, again, progress).add_cells(values);
            }
            with_data = true;
        } catch (const core::InputError& error) {
            if (asked_for) {
                throw;
            }
            problems.push_back({core::Problem::Severity::error,
                                "the data beside this case are not used: " + error.message(), error.place()});
        }
    }
    Field field = field_from(std::move(mesh), std::move(values), options, progress);
    field.format = "Fluent HDF5";
    apply_settings(settings, with_data, field);
    if (with_data) {
        field.files.push_back(data_path.string());
    }
    field.problems.insert(field.problems.end(), problems.begin(), problems.end());
    return field;
}

}  // namespace

Importer fluent_hdf5_importer() { return {"Fluent HDF5", recognises, read}; }

}  // namespace underbody::postproc
