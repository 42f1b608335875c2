// constant/polyMesh.
#include <algorithm>
#include <charconv>

#include "core/file.h"
#include "geometry/blocks/poly_mesh.h"

namespace underbody::geometry {

namespace {

namespace fs = std::filesystem;

class Text {
public:
    Text(const std::string& kind, const std::string& object, const std::string& note, std::size_t count) {
        text_ = "FoamFile\n{\n    version 2.0;\n    format ascii;\n    class " + kind + ";\n" +
                (note.empty() ? "" : "    note \"" + note + "\";\n") +
                "    location \"constant/polyMesh\";\n    object " + object + ";\n}\n\n" + std::to_string(count) +
                "\n(\n";
    }
    void reserve(std::size_t bytes) { text_.reserve(text_.size() + bytes); }
    template <class Number>
    void number(Number value) {
        char digits[32];
        std::to_chars_result end{};
        if constexpr (std::is_floating_point_v<Number>) {
            end = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 12);
        } else {
            end = std::to_chars(digits, digits + sizeof digits, value);
        }
        text_.append(digits, end.ptr);
    }
    void put(char c) { text_ += c; }
    void put(const char* words) { text_ += words; }
    std::string finished() {
        text_ += ")\n";
        return std::move(text_);
    }

private:
    std::string text_;
};

std::string points_text(const PolyMesh& mesh) {
    Text text("vectorField", "points", "", mesh.points.size());
    text.reserve(50 * mesh.points.size());
    for (const Vec3& p : mesh.points) {
        text.put('(');
        text.number(p.x);
        text.put(' ');
        text.number(p.y);
        text.put(' ');
        text.number(p.z);
        text.put(")\n");
    }
    return text.finished();
}

std::string faces_text(const PolyMesh& mesh) {
    Text text("faceList", "faces", "", mesh.faces.size());
    text.reserve(36 * mesh.faces.size());
    for (const Quad& face : mesh.faces) {
        text.put("4(");
        for (std::size_t c = 0; c < 4; ++c) {
            text.number(face[c]);
            text.put(c < 3 ? " " : ")\n");
        }
    }
    return text.finished();
}

std::string labels_text(const char* object, const std::vector<std::int32_t>& labels, const std::string& note) {
    Text text("labelList", object, note, labels.size());
    text.reserve(8 * labels.size());
    for (const std::int32_t label : labels) {
        text.number(label);
        text.put('\n');
    }
    return text.finished();
}

std::string kind_of(const std::string& patch, const std::vector<std::string>& openings) {
    const bool open = patch == "farfield" || std::find(openings.begin(), openings.end(), patch) != openings.end();
    return patch == "symmetry" ? "symmetryPlane" : open ? "patch" : "wall";
}

std::string boundary_text(const PolyMesh& mesh, const std::vector<std::string>& openings) {
    Text text("polyBoundaryMesh", "boundary", "", mesh.patches.size());
    for (const auto& patch : mesh.patches) {
        text.put(("    " + patch.name + "\n    {\n        type " + kind_of(patch.name, openings) +
                  ";\n        nFaces " + std::to_string(patch.count) + ";\n        startFace " +
                  std::to_string(patch.first) + ";\n    }\n")
                     .c_str());
    }
    return text.finished();
}

}  // namespace

std::vector<fs::path> write_poly_mesh(const PolyMesh& mesh, const fs::path& folder,
                                      const std::vector<std::string>& openings) {
    const fs::path to = folder / "constant" / "polyMesh";
    const std::string note = "nPoints:" + std::to_string(mesh.points.size()) + " nCells:" + std::to_string(mesh.cells) +
                             " nFaces:" + std::to_string(mesh.faces.size()) +
                             " nInternalFaces:" + std::to_string(mesh.inner_faces());
    std::vector<fs::path> files;
    const auto put = [&](const char* name, const std::string& text) {
        core::write_file(to / name, text);
        files.push_back(to / name);
    };
    put("points", points_text(mesh));
    put("faces", faces_text(mesh));
    put("owner", labels_text("owner", mesh.owner, note));
    put("neighbour", labels_text("neighbour", mesh.neighbour, note));
    put("boundary", boundary_text(mesh, openings));
    return files;
}

}  // namespace underbody::geometry
