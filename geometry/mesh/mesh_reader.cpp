#include "geometry/mesh/mesh_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <unordered_map>

#include "core/error.h"
#include "core/file.h"
#include "core/ply_file.h"
#include "core/text.h"
#include "core/units.h"
#include "geometry/mesh/mesh_file.h"
#include "geometry/mesh/vtp_reader.h"

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

Vec3 point(Words& words, const core::Place& place) {
    Vec3 p;
    p.x = number(words.next(), place);
    p.y = number(words.next(), place);
    p.z = number(words.next(), place);
    return p;
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
            const Vec3 p = point(words, place);
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

/// Points of a face: counted from 1, or backwards from the last one so far.
std::vector<std::int32_t> obj_face(Words& words, std::size_t points, const core::Place& place) {
    std::vector<std::int32_t> corners;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
        const std::optional<long long> index = core::parse_integer(word.substr(0, word.find('/')));
        if (!index || *index == 0) {
            throw core::InputError("parse", "'" + std::string(word) + "' is not a point of a face", place);
        }
        corners.push_back(static_cast<std::int32_t>(*index > 0 ? *index - 1 : static_cast<long long>(points) + *index));
    }
    return corners;
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
            mesh.points.push_back(point(words, place));
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
            add_polygon(mesh, obj_face(words, mesh.points.size(), place), patch, place);
        }
    }
    return mesh;
}

// PLY
// ------------------------------------------------------------------------------------------------------------------

SurfaceMesh read_ply(std::string_view bytes, const std::string& file) {
    const core::PlyFile ply = core::read_ply(bytes, file);
    SurfaceMesh mesh;
    for (const std::string& comment : ply.comments) {
        Words words(comment);
        if (words.next() == "patch") {
            words.next();  // its number, which is its place in the order
            mesh.patch_names.emplace_back(words.rest_of_line());
        }
    }
    const auto [x, y, z] = core::ply_points(ply, file);
    for (std::size_t i = 0; i < x.size(); ++i) {
        mesh.points.push_back({x[i], y[i], z[i]});
    }
    const core::PlyProperty* corners = core::ply_corners(ply, file);
    if (corners == nullptr) {
        return mesh;
    }
    const core::PlyElement& faces = *ply.find("face");
    const core::PlyProperty* patches = faces.find("patch");
    for (std::size_t i = 0; i < faces.count; ++i) {
        const double patch = patches != nullptr && !patches->list ? patches->values[i] : 0;
        if (!(patch >= 0 && patch <= 10000) || patch != std::floor(patch)) {
            throw core::InputError("index", faces.item(i) + " is of patch " + core::format_number(patch),
                                   {file, {}, {}, {}});
        }
        while (patch >= static_cast<double>(mesh.patch_names.size())) {
            mesh.patch_names.push_back("patch_" + std::to_string(mesh.patch_names.size() + 1));
        }
        const std::vector<std::int32_t> polygon(
            corners->values.begin() + static_cast<std::ptrdiff_t>(corners->list_begin[i]),
            corners->values.begin() + static_cast<std::ptrdiff_t>(corners->list_begin[i + 1]));
        add_polygon(mesh, polygon, static_cast<std::int32_t>(patch), {file, {}, {}, {}});
    }
    return mesh;
}

double metres_per_unit(const std::filesystem::path& path, const std::optional<std::string>& unit) {
    if (!unit) {
        throw core::InputError("unit", "the file does not say in what unit its lengths are",
                               {path.string(), {}, {}, {}}, "say it with option 'unit mm' (or m, cm, in)");
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

SurfaceMesh read_stl(std::string_view bytes, const std::string& file) {
    if (is_ascii_stl(bytes)) {
        return read_ascii_stl(bytes, file);
    }
    if (bytes.size() < 84) {
        throw core::InputError("truncated",
                               "a binary STL has at least 84 bytes, this one " + std::to_string(bytes.size()),
                               at_byte(file, bytes.size()), "the file was cut short: write it again");
    }
    return read_binary_stl(bytes, file);
}

/// Of each triangle, one that stands for all that hang together over edges flatter than an angle.
std::vector<std::size_t> smooth_parts(const SurfaceMesh& mesh, double feature_angle) {
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
    for (std::size_t t = 0; t < count; ++t) {
        root[t] = find(t);
    }
    return root;
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
            mesh = read_stl(bytes, mapped.name());
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
    const std::vector<std::size_t> root = smooth_parts(mesh, feature_angle);
    struct Part {
        std::size_t root;
        double area = 0;
        Vec3 vector;
    };
    std::unordered_map<std::size_t, Part> parts;
    for (std::size_t t = 0; t < root.size(); ++t) {
        Part& part = parts.try_emplace(root[t], Part{root[t], 0, {}}).first->second;
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
    for (std::size_t t = 0; t < root.size(); ++t) {
        mesh.patch[t] = index[root[t]];
    }
}

}  // namespace underbody::geometry
