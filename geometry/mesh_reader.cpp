#include "geometry/mesh_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <sstream>
#include <unordered_map>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/mesh_file.h"
#include "geometry/vtp_reader.h"

namespace underbody::geometry {

namespace {

core::Place at_byte(const std::string& file, std::size_t byte) {
    return {file, {}, {}, static_cast<std::int64_t>(byte)};
}
core::Place at_line(const std::string& file, std::size_t line) {
    return {file, static_cast<std::int64_t>(line), {}, {}};
}

struct PointHash {
    std::size_t operator()(const Vec3& p) const {
        const auto mix = [](std::uint64_t h, double v) {
            return (h ^ std::bit_cast<std::uint64_t>(v + 0.0)) * 0x9e3779b97f4a7c15ull;
        };
        const std::uint64_t h = mix(mix(mix(1469598103934665603ull, p.x), p.y), p.z);
        return h ^ (h >> 29);
    }
};

class Joined {
public:
    explicit Joined(SurfaceMesh& mesh) : mesh_(mesh) {}
    std::int32_t operator()(Vec3 p) {
        p = p + Vec3{};  // -0 and 0 are one place
        const auto [found, fresh] = number_.emplace(p, static_cast<std::int32_t>(mesh_.points.size()));
        if (fresh) {
            mesh_.points.push_back(p);
        }
        return found->second;
    }

private:
    SurfaceMesh& mesh_;
    std::unordered_map<Vec3, std::int32_t, PointHash> number_;
};

[[noreturn]] void not_finite(const core::Place& place) {
    throw core::InputError("number", "a coordinate is not a finite number", place, "a mesh of finite coordinates");
}

SurfaceMesh read_binary_stl(std::string_view bytes, const std::string& file) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, 4);
    const std::size_t wanted = 84 + 50ull * count;
    if (bytes.size() < wanted) {
        throw core::InputError("truncated",
                               "binary STL of " + std::to_string(count) + " triangles needs " + std::to_string(wanted) +
                                   " bytes and has " + std::to_string(bytes.size()),
                               at_byte(file, bytes.size()), "the file was cut short: write it again");
    }
    SurfaceMesh mesh;
    mesh.patch_names = {"surface"};
    Joined joined(mesh);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::size_t start = 84 + 50ull * i;
        float v[9];
        std::memcpy(v, bytes.data() + start + 12, sizeof v);
        Triangle t{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 p{v[3 * k], v[3 * k + 1], v[3 * k + 2]};
            if (!std::isfinite(p.x + p.y + p.z)) {
                not_finite(at_byte(file, start + 12 + 12 * k));
            }
            t[k] = joined(p);
        }
        mesh.triangles.push_back(t);
        mesh.patch.push_back(0);
    }
    return mesh;
}

// Words of a text file with the line each stands on.
class Words {
public:
    explicit Words(std::string_view text) : text_(text) {}
    std::string_view next() {
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
            line_ += text_[at_++] == '\n';
        }
        const std::size_t start = at_;
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) == 0) {
            ++at_;
        }
        return text_.substr(start, at_ - start);
    }
    std::string_view rest_of_line() {
        const std::size_t start = at_;
        while (at_ < text_.size() && text_[at_] != '\n') {
            ++at_;
        }
        return core::trimmed(text_.substr(start, at_ - start));
    }
    [[nodiscard]] std::size_t line() const { return line_; }
    [[nodiscard]] bool done() const { return at_ >= text_.size(); }

private:
    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
};

double number(std::string_view word, const core::Place& place) {
    const std::optional<double> value = core::parse_number(word);
    if (!value) {
        throw core::InputError("parse", "'" + std::string(word) + "' is not a number", place);
    }
    if (!std::isfinite(*value)) {
        not_finite(place);
    }
    return *value;
}

SurfaceMesh read_ascii_stl(std::string_view text, const std::string& file) {
    SurfaceMesh mesh;
    Joined joined(mesh);
    Words words(text);
    Triangle t{};
    std::size_t corners = 0;
    bool in_solid = false;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
        if (word == "solid") {
            std::string name(words.rest_of_line());
            mesh.patch_names.push_back(name.empty() ? "solid_" + std::to_string(mesh.patch_names.size() + 1) : name);
            in_solid = true;
        } else if (word == "endsolid") {
            words.rest_of_line();
            in_solid = false;
        } else if (word == "vertex") {
            const core::Place place = at_line(file, words.line());
            Vec3 p;
            p.x = number(words.next(), place);
            p.y = number(words.next(), place);
            p.z = number(words.next(), place);
            if (corners >= 3 || !in_solid) {
                throw core::InputError("parse", "a vertex outside a triangle of three", place);
            }
            t[corners++] = joined(p);
        } else if (word == "endfacet") {
            if (corners != 3) {
                throw core::InputError("parse", "a facet of " + std::to_string(corners) + " vertices",
                                       at_line(file, words.line()));
            }
            mesh.triangles.push_back(t);
            mesh.patch.push_back(static_cast<std::int32_t>(mesh.patch_names.size() - 1));
            corners = 0;
        } else if (word == "facet") {
            words.rest_of_line();
        } else if (word != "outer" && word != "loop" && word != "endloop") {
            throw core::InputError("parse", "'" + std::string(word.substr(0, 40)) + "' is no word of an ASCII STL",
                                   at_line(file, words.line()));
        }
    }
    if (in_solid) {
        throw core::InputError("truncated", "the file ends inside a solid", at_byte(file, text.size()),
                               "the file was cut short: write it again");
    }
    return mesh;
}

void add_polygon(SurfaceMesh& mesh, const std::vector<std::int32_t>& corners, std::int32_t patch,
                 const core::Place& place) {
    if (corners.size() < 3) {
        throw core::InputError("parse", "a face of " + std::to_string(corners.size()) + " corners", place);
    }
    for (const std::int32_t p : corners) {
        if (p < 0 || static_cast<std::size_t>(p) >= mesh.points.size()) {
            throw core::InputError(
                "index", "a face names point " + std::to_string(p + 1) + " of " + std::to_string(mesh.points.size()),
                place);
        }
    }
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
        mesh.triangles.push_back({corners[0], corners[k], corners[k + 1]});
        mesh.patch.push_back(patch);
    }
}

SurfaceMesh read_obj(std::string_view text, const std::string& file) {
    SurfaceMesh mesh;
    std::int32_t patch = -1;
    std::size_t line = 0;
    for (const std::string_view raw : core::split(text, '\n')) {
        ++line;
        const core::Place place = at_line(file, line);
        Words words(raw);
        const std::string_view kind = words.next();
        if (kind == "v") {
            Vec3 p;
            p.x = number(words.next(), place);
            p.y = number(words.next(), place);
            p.z = number(words.next(), place);
            mesh.points.push_back(p);
        } else if (kind == "g" || kind == "o") {
            const std::string name(words.rest_of_line());
            const auto found = std::find(mesh.patch_names.begin(), mesh.patch_names.end(), name);
            patch = static_cast<std::int32_t>(found - mesh.patch_names.begin());
            if (found == mesh.patch_names.end()) {
                mesh.patch_names.push_back(name);
            }
        } else if (kind == "f") {
            if (patch < 0) {
                mesh.patch_names.emplace_back("surface");
                patch = 0;
            }
            std::vector<std::int32_t> corners;
            for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
                const std::optional<long long> index = core::parse_integer(word.substr(0, word.find('/')));
                if (!index || *index == 0) {
                    throw core::InputError("parse", "'" + std::string(word) + "' is not a point of a face", place);
                }
                corners.push_back(static_cast<std::int32_t>(
                    *index > 0 ? *index - 1 : static_cast<long long>(mesh.points.size()) + *index));
            }
            add_polygon(mesh, corners, patch, place);
        }
    }
    return mesh;
}

// PLY
// ------------------------------------------------------------------------------------------------------------------

struct PlyProperty {
    std::string name, type, count_type;  // count_type: of a list
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;
};

class PlyValues {
public:
    PlyValues(std::string_view bytes, std::size_t start, bool binary, std::string file)
        : bytes_(bytes), at_(start), binary_(binary), words_(bytes.substr(start)), file_(std::move(file)) {}

    double read(const std::string& type) {
        if (!binary_) {
            const std::string_view word = words_.next();
            if (word.empty()) {
                cut_short();
            }
            return number(word, {file_, {}, {}, {}});
        }
        if (type == "char" || type == "int8") return take<std::int8_t>();
        if (type == "uchar" || type == "uint8") return take<std::uint8_t>();
        if (type == "short" || type == "int16") return take<std::int16_t>();
        if (type == "ushort" || type == "uint16") return take<std::uint16_t>();
        if (type == "int" || type == "int32") return take<std::int32_t>();
        if (type == "uint" || type == "uint32") return take<std::uint32_t>();
        if (type == "float" || type == "float32") return take<float>();
        if (type == "double" || type == "float64") return take<double>();
        throw core::InputError("parse", "'" + type + "' is no type of a PLY property", {file_, {}, {}, {}});
    }
    [[nodiscard]] core::Place place() const { return at_byte(file_, at_); }
    [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

private:
    template <class T>
    double take() {
        if (bytes_.size() - at_ < sizeof(T)) {
            cut_short();
        }
        T value;
        std::memcpy(&value, bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return static_cast<double>(value);
    }
    [[noreturn]] void cut_short() const {
        throw core::InputError("truncated", "the file ends before its elements do", at_byte(file_, bytes_.size()),
                               "the file was cut short: write it again");
    }
    std::string_view bytes_;
    std::size_t at_;
    bool binary_;
    Words words_;
    std::string file_;
};

struct PlyHeader {
    std::vector<PlyElement> elements;
    std::vector<std::string> patch_names;
    bool binary = false;
    std::size_t end = 0;
};

PlyHeader ply_header(std::string_view bytes, const std::string& file) {
    PlyHeader header;
    const std::size_t end = bytes.find("end_header");
    if (end == std::string_view::npos) {
        throw core::InputError("parse", "the PLY has no end_header", at_byte(file, bytes.size()));
    }
    header.end = bytes.find('\n', end) + 1;
    std::size_t line = 0;
    for (const std::string_view raw : core::split(bytes.substr(0, end), '\n')) {
        ++line;
        Words words(raw);
        const std::string_view kind = words.next();
        if (kind == "format") {
            const std::string format(words.next());
            header.binary = format == "binary_little_endian";
            if (format != "ascii" && !header.binary) {
                throw core::InputError("format", "PLY of the format '" + format + "'", at_line(file, line),
                                       "ascii and binary_little_endian are read");
            }
        } else if (kind == "element") {
            PlyElement element;
            element.name = words.next();
            element.count = static_cast<std::size_t>(std::max(0.0, number(words.next(), at_line(file, line))));
            header.elements.push_back(element);
        } else if (kind == "property" && !header.elements.empty()) {
            PlyProperty property;
            property.type = words.next();
            if (property.type == "list") {
                property.count_type = words.next();
                property.type = words.next();
            }
            property.name = words.next();
            header.elements.back().properties.push_back(property);
        } else if (kind == "comment" && words.next() == "patch") {
            words.next();
            header.patch_names.emplace_back(words.rest_of_line());
        }
    }
    return header;
}

SurfaceMesh read_ply(std::string_view bytes, const std::string& file) {
    const PlyHeader header = ply_header(bytes, file);
    PlyValues values(bytes, header.end, header.binary, file);
    SurfaceMesh mesh;
    mesh.patch_names = header.patch_names;
    for (const PlyElement& element : header.elements) {
        if (element.count > values.left()) {
            throw core::InputError("truncated",
                                   "the file states " + std::to_string(element.count) + " of '" + element.name +
                                       "' and is too short for them",
                                   at_byte(file, bytes.size()));
        }
        for (std::size_t i = 0; i < element.count; ++i) {
            Vec3 p;
            std::vector<std::int32_t> corners;
            std::int32_t patch = 0;
            for (const PlyProperty& property : element.properties) {
                if (!property.count_type.empty()) {
                    const double length = values.read(property.count_type);
                    for (double k = 0; k < length; ++k) {
                        corners.push_back(static_cast<std::int32_t>(values.read(property.type)));
                    }
                    continue;
                }
                const double value = values.read(property.type);
                if (property.name == "x") p.x = value;
                if (property.name == "y") p.y = value;
                if (property.name == "z") p.z = value;
                if (property.name == "patch") patch = static_cast<std::int32_t>(value);
            }
            if (element.name == "vertex") {
                if (!std::isfinite(p.x + p.y + p.z)) {
                    not_finite(values.place());
                }
                mesh.points.push_back(p);
            } else if (element.name == "face") {
                if (patch < 0 || patch > 10000) {
                    throw core::InputError("index", "a face of patch " + std::to_string(patch), values.place());
                }
                while (static_cast<std::size_t>(patch) >= mesh.patch_names.size()) {
                    mesh.patch_names.push_back("patch_" + std::to_string(mesh.patch_names.size() + 1));
                }
                add_polygon(mesh, corners, patch, values.place());
            }
        }
    }
    return mesh;
}

double metres_per_unit(const std::filesystem::path& path, const std::optional<std::string>& unit) {
    if (!unit) {
        throw core::InputError("unit", "the file does not say in what unit its lengths are",
                               {path.string(), {}, {}, {}}, "say it with --unit mm (or m, cm, in)");
    }
    const double scale = core::convert(1, *unit, "m");
    if (!(scale > 0)) {
        throw core::InputError("unit", "'" + *unit + "' is no unit of length");
    }
    return scale;
}

bool is_ascii_stl(std::string_view bytes) {
    // Binary files may begin with "solid" too: the stated count decides.
    if (bytes.size() >= 84) {
        std::uint32_t count = 0;
        std::memcpy(&count, bytes.data() + 80, 4);
        if (bytes.size() == 84 + 50ull * count) {
            return false;
        }
    }
    return bytes.substr(0, 5) == "solid" &&
           bytes.substr(0, std::min<std::size_t>(bytes.size(), 1000)).find('\0') == std::string_view::npos;
}

}  // namespace

SurfaceMesh read_mesh(const std::filesystem::path& path, const MeshReadOptions& options) {
    const MeshFormat format = mesh_format_of(path);
    const core::MappedFile mapped(path);
    const double scale = metres_per_unit(path, options.unit);
    const std::string_view bytes = mapped.bytes();
    SurfaceMesh mesh;
    switch (format) {
        case MeshFormat::stl_ascii:
        case MeshFormat::stl_binary:
            if (is_ascii_stl(bytes)) {
                mesh = read_ascii_stl(bytes, mapped.name());
            } else if (bytes.size() < 84) {
                throw core::InputError("truncated",
                                       "a binary STL has at least 84 bytes, this one " + std::to_string(bytes.size()),
                                       at_byte(mapped.name(), bytes.size()), "the file was cut short: write it again");
            } else {
                mesh = read_binary_stl(bytes, mapped.name());
            }
            break;
        case MeshFormat::obj:
            mesh = read_obj(bytes, mapped.name());
            break;
        case MeshFormat::ply:
            mesh = read_ply(bytes, mapped.name());
            break;
        case MeshFormat::vtp:
            mesh = read_vtp(bytes, mapped.name());
            break;
    }
    if (mesh.triangles.empty()) {
        throw core::InputError("empty", "there is no triangle in it", {mapped.name(), {}, {}, {}});
    }
    for (Vec3& p : mesh.points) {
        p *= scale;
    }
    std::vector<char> used(mesh.patch_names.size(), 0);
    for (const std::int32_t p : mesh.patch) {
        used.at(static_cast<std::size_t>(p)) = 1;
    }
    if (std::accumulate(used.begin(), used.end(), 0) < 2) {
        find_patches(mesh, options.feature_angle);
    }
    return mesh;
}

void find_patches(SurfaceMesh& mesh, double feature_angle) {
    const std::size_t count = mesh.triangles.size();
    std::vector<std::size_t> root(count);
    std::iota(root.begin(), root.end(), std::size_t{0});
    const auto find = [&](std::size_t i) {
        while (root[i] != i) {
            i = root[i] = root[root[i]];
        }
        return i;
    };
    struct Side {
        std::uint64_t edge;
        std::size_t triangle;
    };
    std::vector<Side> sides;
    for (std::size_t t = 0; t < count; ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto a = static_cast<std::uint32_t>(mesh.triangles[t][k]),
                       b = static_cast<std::uint32_t>(mesh.triangles[t][(k + 1) % 3]);
            sides.push_back({std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), t});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
    });
    const double limit = std::cos(feature_angle);
    // A flat base is told from a side that runs smoothly into it by lying exactly level.
    const auto level = [](const Vec3& n) { return n.z < 0 && std::hypot(n.x, n.y) < 5e-4 * -n.z; };
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        const Vec3 m = mesh.area_vector(sides[i].triangle), n = mesh.area_vector(sides[i + 1].triangle);
        if (sides[i].edge == sides[i + 1].edge && dot(m, n) >= limit * norm(m) * norm(n) && level(m) == level(n)) {
            root[find(sides[i].triangle)] = find(sides[i + 1].triangle);
        }
    }
    struct Part {
        std::size_t root;
        double area = 0;
        Vec3 vector;
    };
    std::unordered_map<std::size_t, Part> parts;
    for (std::size_t t = 0; t < count; ++t) {
        Part& part = parts.try_emplace(find(t), Part{find(t), 0, {}}).first->second;
        part.area += norm(mesh.area_vector(t));
        part.vector += mesh.area_vector(t);
    }
    std::vector<Part> order;
    for (const auto& [key, part] : parts) {
        order.push_back(part);
    }
    std::sort(order.begin(), order.end(),
              [](const Part& a, const Part& b) { return a.area != b.area ? a.area > b.area : a.root < b.root; });
    std::unordered_map<std::size_t, std::int32_t> index;
    mesh.patch_names.clear();
    bool base = false, hull = false;
    for (const Part& part : order) {
        index[part.root] = static_cast<std::int32_t>(mesh.patch_names.size());
        if (!base && part.vector.z < -0.98 * part.area) {
            mesh.patch_names.emplace_back("base");
            base = true;
        } else if (!hull) {
            mesh.patch_names.emplace_back("hull");
            hull = true;
        } else {
            mesh.patch_names.push_back("patch_" + std::to_string(mesh.patch_names.size() + 1));
        }
    }
    for (std::size_t t = 0; t < count; ++t) {
        mesh.patch[t] = index[find(t)];
    }
}

}  // namespace underbody::geometry
