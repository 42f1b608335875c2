#include "geometry/mesh/mesh_file.h"

#include <bit>
#include <cstring>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace underbody::geometry {

static_assert(std::endian::native == std::endian::little, "the binary writers write the machine's own byte order");

namespace {

template <class T>
void append(std::string& out, const T& value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    out.append(bytes, sizeof(T));
}

std::string xyz(const Vec3& p) {
    return core::format_number(p.x) + " " + core::format_number(p.y) + " " + core::format_number(p.z);
}

std::string stl_binary(const SurfaceMesh& mesh, double scale) {
    std::string out(80, ' ');
    // Never begin with "solid": readers take that for the ASCII form.
    out.replace(0, 9, "underbody");
    append(out, static_cast<std::uint32_t>(mesh.triangles.size()));
    out.reserve(84 + 50 * mesh.triangles.size());
    const auto put = [&](const Vec3& v) {
        append(out, static_cast<float>(v.x));
        append(out, static_cast<float>(v.y));
        append(out, static_cast<float>(v.z));
    };
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Vec3 n = mesh.area_vector(i);
        put(norm(n) > 0 ? unit(n) : Vec3{});
        for (std::size_t k = 0; k < 3; ++k) {
            put(scale * mesh.corner(i, k));
        }
        append(out, std::uint16_t{0});
    }
    return out;
}

std::string stl_ascii(const SurfaceMesh& mesh, double scale) {
    std::string out;
    for (std::size_t patch = 0; patch < mesh.patch_names.size(); ++patch) {
        out += "solid " + mesh.patch_names[patch] + "\n";
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            if (static_cast<std::size_t>(mesh.patch[i]) != patch) {
                continue;
            }
            const Vec3 n = mesh.area_vector(i);
            out += "facet normal " + xyz(norm(n) > 0 ? unit(n) : Vec3{}) + "\nouter loop\n";
            for (std::size_t k = 0; k < 3; ++k) {
                out += "vertex " + xyz(scale * mesh.corner(i, k)) + "\n";
            }
            out += "endloop\nendfacet\n";
        }
        out += "endsolid " + mesh.patch_names[patch] + "\n";
    }
    return out;
}

std::string obj(const SurfaceMesh& mesh, double scale) {
    std::string out = "# underbody\n";
    for (const Vec3& p : mesh.points) {
        out += "v " + xyz(scale * p) + "\n";
    }
    for (std::size_t patch = 0; patch < mesh.patch_names.size(); ++patch) {
        out += "g " + mesh.patch_names[patch] + "\n";
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            if (static_cast<std::size_t>(mesh.patch[i]) == patch) {
                const Triangle& t = mesh.triangles[i];
                out += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " +
                       std::to_string(t[2] + 1) + "\n";
            }
        }
    }
    return out;
}

std::string ply(const SurfaceMesh& mesh, double scale) {
    std::string out = "ply\nformat binary_little_endian 1.0\n";
    for (std::size_t i = 0; i < mesh.patch_names.size(); ++i) {
        out += "comment patch " + std::to_string(i) + " " + mesh.patch_names[i] + "\n";
    }
    out += "element vertex " + std::to_string(mesh.points.size()) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
           std::to_string(mesh.triangles.size()) +
           "\nproperty list uchar int vertex_indices\nproperty int patch\nend_header\n";
    for (const Vec3& p : mesh.points) {
        append(out, scale * p);
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        append(out, std::uint8_t{3});
        append(out, mesh.triangles[i]);
        append(out, mesh.patch[i]);
    }
    return out;
}

// One array of the appended block: a 64-bit count of bytes, then the bytes.
template <class T>
std::string block(const std::vector<T>& values) {
    std::string out;
    append(out, std::uint64_t{values.size() * sizeof(T)});
    out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return out;
}

std::string vtp(const SurfaceMesh& mesh, double scale) {
    std::vector<Vec3> points = mesh.points;
    for (Vec3& p : points) {
        p *= scale;
    }
    std::vector<std::int64_t> connectivity, offsets;
    for (const Triangle& t : mesh.triangles) {
        connectivity.insert(connectivity.end(), t.begin(), t.end());
        offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    }
    std::string appended;
    const auto array = [&](const std::string& attributes, const std::string& bytes) {
        std::string line =
            "<DataArray " + attributes + " format=\"appended\" offset=\"" + std::to_string(appended.size()) + "\"/>\n";
        appended += bytes;
        return line;
    };
    std::string names;
    for (const std::string& name : mesh.patch_names) {
        for (const char c : name) {
            names += std::to_string(static_cast<int>(static_cast<unsigned char>(c))) + " ";
        }
        names += "0 ";
    }
    std::string out =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n"
        "<PolyData>\n<FieldData>\n<Array type=\"String\" Name=\"patch_names\" NumberOfTuples=\"" +
        std::to_string(mesh.patch_names.size()) + "\" format=\"ascii\">\n" + names +
        "\n</Array>\n</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(points.size()) +
        "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
        std::to_string(mesh.triangles.size()) + "\">\n";
    out += "<CellData Scalars=\"patch\">\n" + array("type=\"Int32\" Name=\"patch\"", block(mesh.patch)) +
           "</CellData>\n<Points>\n" +
           array("type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"", block(points)) + "</Points>\n<Polys>\n" +
           array("type=\"Int64\" Name=\"connectivity\"", block(connectivity)) +
           array("type=\"Int64\" Name=\"offsets\"", block(offsets)) +
           "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" + appended +
           "\n</AppendedData>\n</VTKFile>\n";
    return out;
}

}  // namespace

MeshFormat mesh_format_of(const std::filesystem::path& path) {
    const std::string ending = core::lower_case(path.extension().string());
    if (ending == ".stl") {
        return MeshFormat::stl_binary;
    }
    if (ending == ".obj") {
        return MeshFormat::obj;
    }
    if (ending == ".ply") {
        return MeshFormat::ply;
    }
    if (ending == ".vtp") {
        return MeshFormat::vtp;
    }
    throw core::UsageError("format", "'" + path.string() + "' names no surface format", {},
                           "known endings: .stl, .obj, .ply, .vtp");
}

std::string mesh_bytes(const SurfaceMesh& mesh, MeshFormat format, double scale) {
    switch (format) {
        case MeshFormat::stl_binary:
            return stl_binary(mesh, scale);
        case MeshFormat::stl_ascii:
            return stl_ascii(mesh, scale);
        case MeshFormat::obj:
            return obj(mesh, scale);
        case MeshFormat::ply:
            return ply(mesh, scale);
        case MeshFormat::vtp:
            return vtp(mesh, scale);
    }
    return {};
}

void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, MeshFormat format, double scale) {
    core::write_file(path, mesh_bytes(mesh, format, scale));
}

void write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, double scale) {
    write_mesh(mesh, path, mesh_format_of(path), scale);
}

}  // namespace underbody::geometry
