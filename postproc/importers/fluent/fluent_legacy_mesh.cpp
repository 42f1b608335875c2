#include <algorithm>
#include <cmath>
#include <limits>

#include "postproc/importers/fluent/fluent_legacy.h"
#include "postproc/importers/import_context.h"

namespace underbody::postproc {

namespace {

constexpr std::size_t most_settings_text = std::size_t{64} << 20;

enum class Coding { ascii, single_precision, double_precision };

class MeshReader {
public:
    MeshReader(ByteStream& in, bool surfaces_only, core::Progress& progress)
        : in_(in), text_(in), surfaces_only_(surfaces_only), progress_(progress), mesh_bytes_(in.most_left()) {
        result_.mesh.file = in.name();
    }

    LegacyMesh read() {
        telling(
            [&] {
                text_.skip_byte_order_mark();
                while (text_.next() >= 0) {
                    section();
                }
                finish();
            },
            [&] { return understood(); });
        return std::move(result_);
    }

private:
    void section();
    void known_section(std::uint64_t index, std::uint64_t base, Coding coding);
    bool is_declaration(const std::vector<std::uint64_t>& header, std::uint64_t& total, bool& declared);
    void nodes(std::uint64_t index, Coding coding);
    void cells(std::uint64_t index, Coding coding);
    void elements(CellBlock& block, std::uint64_t index, Coding coding);
    void faces(std::uint64_t index, Coding coding);
    void skip_faces(const FaceBlock& block, std::uint64_t numbers, std::uint64_t index, Coding coding);
    FaceBlock announced_faces(const std::vector<std::uint64_t>& header);
    void fixed_faces(FaceBlock& block, Coding coding);
    void mixed_faces(FaceBlock& block, Coding coding);
    template <typename Next>
    void mixed_faces_of(FaceBlock& block, std::uint64_t bytes, Next&& next);
    void skip_mixed_binary(std::uint64_t count);
    void zone_label();
    void tree(std::uint64_t index, Coding coding, std::vector<IdRange>& hidden);
    void interface_faces(std::uint64_t index, Coding coding);
    void unknown(std::uint64_t index, Coding coding);
    void finish();
    [[nodiscard]] std::string understood() const;

    /// `count` items of at least `least` bytes each must fit into what is left of the file.
    void check_room(std::uint64_t count, std::uint64_t least);
    void close(std::uint64_t index, Coding coding) {
        if (coding == Coding::ascii) {
            text_.close_plain_body();
        } else {
            text_.close_binary_body(index);
        }
    }

    ByteStream& in_;
    FluentText text_;
    bool surfaces_only_;
    core::Progress& progress_;
    std::uint64_t mesh_bytes_;  ///< of the whole file, at most
    LegacyMesh result_;
    bool nodes_declared_ = false, faces_declared_ = false, cells_declared_ = false;
    std::uint64_t nodes_read_ = 0, faces_read_ = 0, cells_read_ = 0;
    std::vector<IdRange> node_ranges_;
    std::map<std::uint64_t, int> skipped_;
    std::uint64_t sections_ = 0;
};

std::string MeshReader::understood() const {
    const FaceMesh& mesh = result_.mesh;
    std::string text = std::to_string(sections_) + " sections";
    const auto add = [&](const char* what, std::uint64_t read, std::uint64_t all) {
        text += std::string(", ") + what + " " + std::to_string(read) + (all > 0 ? " of " + std::to_string(all) : "");
    };
    add("nodes", nodes_read_, mesh.nodes);
    add("faces", faces_read_, mesh.faces);
    add("cells", cells_read_, mesh.cells);
    return text + listed_zones(mesh);
}

void MeshReader::check_room(std::uint64_t count, std::uint64_t least) {
    if (count > in_.most_left() / std::max<std::uint64_t>(1, least)) {
        text_.fail("the header announces " + std::to_string(count) + " items of at least " + std::to_string(least) +
                   " bytes, but at most " + std::to_string(in_.most_left()) + " bytes are left");
    }
}

void MeshReader::section() {
    progress_.check();
    text_.set_section(0);
    text_.expect('(');
    const std::uint64_t index = text_.number(10);
    ++sections_;
    if (index == 0) {
        const std::string comment = text_.comment();
        for (const char* words :
             {"Units: Meters", "Units: Millimeters", "Units: Inches", "Units: Feet", "Units: Centimeters"}) {
            if (comment.find(words) != std::string::npos && !result_.mesh.length_unit_known) {
                result_.mesh.length_unit = words[7] == 'F' ? "foot" : words[7] == 'I' ? "inch" : words + 7;
                result_.mesh.length_unit[0] = static_cast<char>(std::tolower(result_.mesh.length_unit[0]));
                if (result_.mesh.length_unit.back() == 's') {
                    result_.mesh.length_unit.pop_back();
                }
            }
        }
        if (result_.settings.writer.empty() && comment.size() > 8) {
            const std::size_t first = comment.front() == '"' ? 1 : 0;
            result_.settings.writer =
                comment.substr(first, std::min(comment.find_last_of('"'), comment.size()) - first);
        }
        return;
    }
    const std::uint64_t family = index / 1000;
    const bool binary = (family == 2 || family == 3) && index >= 2000;
    const Coding coding = !binary ? Coding::ascii : family == 2 ? Coding::single_precision : Coding::double_precision;
    text_.set_section(index);
    known_section(index, binary ? index % 1000 : index, coding);
}

void MeshReader::known_section(std::uint64_t index, std::uint64_t base, Coding coding) {
    switch (base) {
        case 1: {
            std::string writer = text_.inside(512);
            std::erase(writer, '"');
            result_.settings.writer = writer.substr(std::min(writer.size(), writer.find_first_not_of(" \t\r\n")));
            return;
        }
        case 2: {
            const std::uint64_t dimension = text_.number(10);
            if (dimension != 2 && dimension != 3) {
                text_.fail("the dimension is " + std::to_string(dimension));
            }
            result_.mesh.dimension = static_cast<int>(dimension);
            text_.expect(')');
            return;
        }
        case 4:
            return text_.machine();
        case 10:
            return nodes(index, coding);
        case 12:
            return cells(index, coding);
        case 13:
            return faces(index, coding);
        case 37: {
            result_.settings.variables += text_.inside(most_settings_text);
            result_.mesh.length_unit = "m";
            result_.mesh.length_unit_known = true;
            return;
        }
        case 39:
        case 45:
            return zone_label();
        case 58:
            return tree(index, coding, result_.mesh.hidden_cells);
        case 59:
            return tree(index, coding, result_.mesh.hidden_faces);
        case 61:
            return interface_faces(index, coding);
        default:
            return unknown(index, coding);
    }
}

/// A section for zone 0 only declares how many there are in all.
bool MeshReader::is_declaration(const std::vector<std::uint64_t>& header, std::uint64_t& total, bool& declared) {
    if (header[0] != 0) {
        return false;
    }
    total = std::max(total, header[2]);
    declared = true;
    text_.expect(')');
    return true;
}

void MeshReader::nodes(std::uint64_t index, Coding coding) {
    auto& mesh = result_.mesh;
    const auto header = text_.header(16, 3);
    const std::uint64_t first = header[1];
    const std::uint64_t last = header[2];
    if (is_declaration(header, mesh.nodes, nodes_declared_)) {
        if (header.size() > 4 && mesh.dimension == 0 && (header[4] == 2 || header[4] == 3)) {
            mesh.dimension = static_cast<int>(header[4]);
        }
        return;
    }
    const std::uint64_t components = header.size() > 4 ? header[4] : static_cast<std::uint64_t>(mesh.dimension);
    if (components != 2 && components != 3) {
        text_.fail("nodes with " + std::to_string(components) + " coordinates");
    }
    if (first == 0 || last < first || (nodes_declared_ && last > mesh.nodes)) {
        text_.fail("nodes " + std::to_string(first) + " to " + std::to_string(last) + " of " +
                   std::to_string(mesh.nodes));
    }
    if (mesh.dimension == 0) {
        mesh.dimension = static_cast<int>(components);
    }
    const std::uint64_t count = last - first + 1;
    const std::uint64_t size = coding == Coding::ascii ? 2 : coding == Coding::single_precision ? 4 : 8;
    check_room(count * components - (coding == Coding::ascii ? 1 : 0), size);
    if (!nodes_declared_) {
        mesh.nodes = std::max(mesh.nodes, last);
    }
    // All nodes at once if that many can be in the file, else as they come.
    const std::uint64_t all = std::max(last, mesh.nodes <= in_.most_left() / size ? mesh.nodes : last);
    check_room(last - std::min(last, nodes_read_ + count), 1);
    if (mesh.points.size() < 3 * all) {
        mesh.points.grow_to(3 * all);
    }
    node_ranges_.push_back({first, last});
    text_.expect('(');
    double* out = mesh.points.data() + 3 * (first - 1);
    if (coding == Coding::ascii) {
        text_.reals(out, count * components);
    } else {
        text_.binary_reals(out, count * components, size);
    }
    for (std::uint64_t i = count; components == 2 && i-- > 0;) {  // pairs become triples in place
        out[3 * i + 2] = 0;
        out[3 * i + 1] = out[2 * i + 1];
        out[3 * i] = out[2 * i];
    }
    nodes_read_ += count;
    close(index, coding);
}

void MeshReader::cells(std::uint64_t index, Coding coding) {
    auto& mesh = result_.mesh;
    const auto header = text_.header(16, 4);
    if (is_declaration(header, mesh.cells, cells_declared_)) {
        return;
    }
    CellBlock block;
    block.zone = static_cast<int>(std::min<std::uint64_t>(header[0], std::numeric_limits<int>::max()));
    block.first = header[1];
    const std::uint64_t last = header[2];
    constexpr std::uint64_t parent_type = 0x20;
    block.parents = header[3] == parent_type;
    if (block.first == 0 || last + 1 < block.first || (cells_declared_ && last > mesh.cells)) {
        text_.fail("cells " + std::to_string(block.first) + " to " + std::to_string(last) + " of " +
                   std::to_string(mesh.cells));
    }
    block.count = last + 1 - block.first;
    mesh.cells = std::max(mesh.cells, last);
    cells_read_ += block.count;
    block.element = header.size() > 4 ? static_cast<int>(std::min<std::uint64_t>(header[4], 255)) : 0;
    if (!text_.accept(')')) {
        if (coding != Coding::ascii && text_.next() == 'E') {
            text_.close_binary_body(index);
        } else {
            elements(block, index, coding);
        }
    }
    mesh.cell_blocks.push_back(std::move(block));
}

/// Element codes of a mixed zone. Only the polyhedra matter: the faces say the rest, and better.
void MeshReader::elements(CellBlock& block, std::uint64_t index, Coding coding) {
    text_.expect('(');
    check_room(coding == Coding::ascii ? block.count / 2 : block.count, coding == Coding::ascii ? 1 : 4);
    block.elements.grow_to(block.count);
    for (std::size_t i = 0; i < block.count; ++i) {
        const std::uint32_t code = coding == Coding::ascii ? text_.hexadecimal() : text_.binary_integer();
        block.elements[i] = static_cast<unsigned char>(std::min<std::uint32_t>(code, 255));
    }
    close(index, coding);
}

/// Zone, kind and numbers of the faces that a section announces.
FaceBlock MeshReader::announced_faces(const std::vector<std::uint64_t>& header) {
    const auto& mesh = result_.mesh;
    if (header.size() < 5) {
        text_.fail("a header with too few numbers");
    }
    FaceBlock block;
    block.zone = static_cast<int>(std::min<std::uint64_t>(header[0], std::numeric_limits<int>::max()));
    block.kind = static_cast<int>(std::min<std::uint64_t>(header[3], 0xffff));
    block.first = header[1];
    const std::uint64_t last = header[2];
    const std::uint64_t shape = header[4];
    if (block.first == 0 || last + 1 < block.first || (faces_declared_ && last > mesh.faces)) {
        text_.fail("faces " + std::to_string(block.first) + " to " + std::to_string(last) + " of " +
                   std::to_string(mesh.faces));
    }
    if (shape != 0 && (shape < 2 || shape > 5)) {
        text_.fail("faces of unknown shape " + std::to_string(shape));
    }
    block.count = last + 1 - block.first;
    block.per_face = shape == 5 ? 0 : static_cast<std::uint32_t>(shape);
    return block;
}

void MeshReader::skip_faces(const FaceBlock& block, std::uint64_t numbers, std::uint64_t index, Coding coding) {
    if (coding == Coding::ascii) {
        text_.skip_plain_body();
    } else if (block.per_face != 0) {
        in_.skip(block.count * numbers * 4);
        text_.close_binary_body(index);
    } else {
        skip_mixed_binary(block.count);
        text_.close_binary_body(index);
    }
}

void MeshReader::faces(std::uint64_t index, Coding coding) {
    auto& mesh = result_.mesh;
    const auto header = text_.header(16, 3);
    if (is_declaration(header, mesh.faces, faces_declared_)) {
        return;
    }
    FaceBlock block = announced_faces(header);
    mesh.faces = std::max(mesh.faces, header[2]);
    if (!text_.accept('(')) {
        if (block.count > 0) {
            text_.fail("faces without a body");
        }
        text_.expect(')');
        return;
    }
    const std::uint64_t numbers = block.per_face != 0 ? block.per_face + 2 : 3;
    check_room(block.count * numbers - (coding == Coding::ascii && block.count > 0 ? 1 : 0),
               coding == Coding::ascii ? 2 : 4);
    faces_read_ += block.count;
    if (surfaces_only_ && is_inner_code(block.kind)) {
        skip_faces(block, numbers, index, coding);
        return;
    }
    block.c0.grow_to(block.count);
    block.c1.grow_to(block.count);
    if (block.per_face != 0) {
        fixed_faces(block, coding);
    } else {
        mixed_faces(block, coding);
    }
    close(index, coding);
    mesh.face_blocks.push_back(std::move(block));
}

void MeshReader::fixed_faces(FaceBlock& block, Coding coding) {
    const std::size_t n = block.per_face;
    block.nodes.grow_to(block.count * n);
    std::uint32_t* nodes = block.nodes.data();
    if (coding == Coding::ascii) {
        HexWords words(text_);
        for (std::size_t face = 0; face < block.count; ++face) {
            for (std::size_t k = 0; k < n; ++k) {
                *nodes++ = words.next();
            }
            block.c0[face] = words.next();
            block.c1[face] = words.next();
        }
        words.finish();
        return;
    }
    constexpr std::size_t at_once = 4096;
    std::vector<std::uint32_t> raw(at_once * (n + 2));
    for (std::size_t done = 0; done < block.count;) {
        const std::size_t part = std::min<std::size_t>(at_once, block.count - done);
        text_.binary_integers(raw.data(), part * (n + 2));
        const std::uint32_t* in = raw.data();
        for (std::size_t face = done; face < done + part; ++face) {
            nodes = std::copy_n(in, n, nodes);
            block.c0[face] = in[n];
            block.c1[face] = in[n + 1];
            in += n + 2;
        }
        done += part;
    }
}

void MeshReader::mixed_faces(FaceBlock& block, Coding coding) {
    block.offsets.grow_to(block.count + 1);
    if (coding == Coding::ascii) {
        HexWords words(text_);
        mixed_faces_of(block, 2, [&] { return words.next(); });
        words.finish();
    } else {
        mixed_faces_of(block, 4, [&] { return text_.binary_integer(); });
    }
}

template <typename Next>
void MeshReader::mixed_faces_of(FaceBlock& block, std::uint64_t bytes, Next&& next) {
    const std::uint64_t most = mesh_bytes_ / bytes;  // no face can have more corners than the file has numbers
    for (std::size_t face = 0; face < block.count; ++face) {
        const std::uint64_t size = next();
        if (size > most || block.nodes.size() + size > 0xffffffffULL) {
            text_.fail("face " + std::to_string(block.first + face) + " of zone " + std::to_string(block.zone) +
                       " announces " + std::to_string(size) + " corners, more than the bytes of the file can hold");
        }
        block.offsets[face] = static_cast<std::uint32_t>(block.nodes.size());
        for (std::uint64_t k = 0; k < size; ++k) {
            block.nodes.push(next());
        }
        block.c0[face] = next();
        block.c1[face] = next();
    }
    block.offsets[block.count] = static_cast<std::uint32_t>(block.nodes.size());
}

void MeshReader::skip_mixed_binary(std::uint64_t count) {
    for (std::uint64_t face = 0; face < count; ++face) {
        in_.skip(4 * (static_cast<std::uint64_t>(text_.binary_integer()) + 2));
    }
}

void MeshReader::zone_label() {
    const auto words = text_.words();
    if (words.size() < 3) {
        text_.fail("a zone without id, type or name");
    }
    ZoneLabel label;
    for (const char c : words[0]) {
        if (c < '0' || c > '9' || label.id > 100000000) {
            text_.fail("a zone id that is not a number: " + words[0]);
        }
        label.id = label.id * 10 + (c - '0');
    }
    label.type = words[1];
    label.name = words[2];
    text_.inside(0);  // conditions, if any
    if (result_.mesh.label(label.id) == nullptr) {
        result_.mesh.labels.push_back(std::move(label));
    }
}

void MeshReader::tree(std::uint64_t index, Coding coding, std::vector<IdRange>& hidden) {
    const auto header = text_.numbers(16);
    if (header.size() < 2 || header[0] == 0 || header[1] + 1 < header[0]) {
        text_.fail("a tree without its range of parents");
    }
    const std::uint64_t count = header[1] + 1 - header[0];
    text_.expect('(');
    if (coding == Coding::ascii) {
        check_room(count / 2, 1);
        text_.skip_plain_body();
    } else {
        check_room(count, 4);
        for (std::uint64_t i = 0; i < count; ++i) {
            in_.skip(4 * static_cast<std::uint64_t>(text_.binary_integer()));
        }
        text_.close_binary_body(index);
    }
    hidden.push_back({header[0], header[1]});
}

void MeshReader::interface_faces(std::uint64_t index, Coding coding) {
    const auto header = text_.numbers(16);
    if (header.size() < 2 || header[0] == 0 || header[1] + 1 < header[0]) {
        text_.fail("an interface without its range of faces");
    }
    const std::uint64_t count = header[1] + 1 - header[0];
    text_.expect('(');
    if (coding == Coding::ascii) {
        check_room(count, 2);
        text_.skip_plain_body();
    } else {
        check_room(count, 8);
        in_.skip(8 * count);
        text_.close_binary_body(index);
    }
    result_.mesh.interface_children.push_back({header[0], header[1]});
}

void MeshReader::unknown(std::uint64_t index, Coding coding) {
    ++skipped_[index];
    text_.skip_section(index, coding != Coding::ascii);
}

void MeshReader::finish() {
    auto& mesh = result_.mesh;
    text_.set_section(0);
    if (mesh.nodes == 0 && mesh.faces == 0 && mesh.cells == 0) {
        throw core::InputError("format", "there is no mesh in this file", {mesh.file, {}, {}, {}});
    }
    std::sort(node_ranges_.begin(), node_ranges_.end(),
              [](const IdRange& a, const IdRange& b) { return a.first < b.first; });
    std::uint64_t next = 1;
    for (const auto& range : node_ranges_) {
        if (range.first != next) {
            break;
        }
        next = range.last + 1;
    }
    if (next != mesh.nodes + 1 || nodes_read_ != mesh.nodes) {
        throw core::InputError("format",
                               "the file declares " + std::to_string(mesh.nodes) + " nodes but holds " +
                                   std::to_string(nodes_read_) + ", without gaps up to " + std::to_string(next - 1),
                               {mesh.file, {}, {}, {}});
    }
    for (std::size_t i = 0; i < 3 * mesh.nodes; ++i) {
        if (!std::isfinite(mesh.points[i])) {
            throw core::InputError("format",
                                   "node " + std::to_string(i / 3 + 1) + " has a coordinate that is not a number",
                                   {mesh.file, {}, {}, {}});
        }
    }
    hide_generated_faces(mesh);
    result_.settings.skipped = listed_sections(skipped_);
    check_mesh(mesh, surfaces_only_, progress_);
}

}  // namespace

LegacyMesh read_legacy_mesh(ByteStream& in, bool surfaces_only, core::Progress& progress) {
    return MeshReader(in, surfaces_only, progress).read();
}

}  // namespace underbody::postproc
