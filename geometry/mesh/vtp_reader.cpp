#include "geometry/mesh/vtp_reader.h"

#include <cmath>
#include <cstring>
#include <optional>

#include "core/error.h"
#include "core/text.h"

namespace underbody::geometry {

namespace {

class Reader {
public:
    Reader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

    SurfaceMesh read() {
        const std::string root = tag("<VTKFile", 0);
        if (root.empty() || attribute(root, "type") != "PolyData") {
            fail("parse", "this is no VTK XML file of poly data", 0);
        }
        if (!attribute(root, "compressor").empty()) {
            fail("format", "the arrays are compressed", 0,
                 "write the file without compression, or as .stl, .obj or .ply");
        }
        wide_ = attribute(root, "header_type") == "UInt64";
        const std::size_t appended = bytes_.find("<AppendedData");
        if (appended != std::string_view::npos) {
            if (attribute(tag("<AppendedData", appended), "encoding") != "raw") {
                fail("format", "appended data that is not raw", appended, "write the file with raw appended data");
            }
            raw_ = bytes_.find('_', bytes_.find('>', appended)) + 1;
        }
        text_end_ = appended == std::string_view::npos ? bytes_.size() : appended;
        SurfaceMesh mesh;
        const std::vector<double> xyz = array_in("<Points", "");
        for (std::size_t i = 0; i + 2 < xyz.size(); i += 3) {
            if (!std::isfinite(xyz[i] + xyz[i + 1] + xyz[i + 2])) {
                fail("number", "a coordinate is not a finite number", bytes_.find("<Points"));
            }
            mesh.points.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
        }
        const std::vector<double> connectivity = array_in("<Polys", "connectivity"),
                                  offsets = array_in("<Polys", "offsets");
        std::vector<double> patch;
        if (bytes_.substr(0, text_end_).find("Name=\"patch\"") != std::string_view::npos) {
            patch = array_in("<CellData", "patch");
        }
        cells(mesh, connectivity, offsets, patch);
        names(mesh);
        return mesh;
    }

private:
    [[noreturn]] void fail(const char* kind, const std::string& what, std::size_t byte,
                           const std::string& hint = {}) const {
        throw core::InputError(kind, what, {file_, {}, {}, static_cast<std::int64_t>(std::min(byte, bytes_.size()))},
                               hint);
    }
    [[nodiscard]] std::string tag(std::string_view name, std::size_t from) const {
        const std::size_t start = bytes_.find(name, from),
                          end = start == std::string_view::npos ? start : bytes_.find('>', start);
        return end == std::string_view::npos ? std::string() : std::string(bytes_.substr(start, end - start + 1));
    }
    static std::string attribute(const std::string& tag, const std::string& name) {
        const std::size_t start = tag.find(" " + name + "=\"");
        if (start == std::string::npos) {
            return {};
        }
        const std::size_t from = start + name.size() + 3;
        return tag.substr(from, tag.find('"', from) - from);
    }

    std::vector<double> array_in(std::string_view section, const std::string& name) {
        const std::size_t start = bytes_.find(section), end = bytes_.find("</" + std::string(section.substr(1)), start);
        if (start == std::string_view::npos || end == std::string_view::npos) {
            fail("missing", "there is no " + std::string(section) + "> in it", bytes_.size());
        }
        for (std::size_t at = bytes_.find("<DataArray", start); at < end; at = bytes_.find("<DataArray", at + 1)) {
            const std::string head = tag("<DataArray", at);
            if (name.empty() || attribute(head, "Name") == name) {
                return values(head, at + head.size());
            }
        }
        fail("missing", std::string(section) + "> has no array '" + name + "'", start);
    }

    std::vector<double> values(const std::string& head, std::size_t body) const {
        const std::string format = attribute(head, "format"), type = attribute(head, "type");
        if (format == "appended") {
            const std::optional<double> offset = core::parse_number(attribute(head, "offset"));
            if (!offset || raw_ == 0) {
                fail("parse", "an appended array without its data", body);
            }
            return raw(type, raw_ + static_cast<std::size_t>(*offset));
        }
        const std::string_view text = bytes_.substr(body, bytes_.find('<', body) - body);
        if (format == "ascii") {
            std::vector<double> list;
            std::size_t at = 0;
            while (at < text.size()) {
                const std::size_t start = text.find_first_not_of(" \t\r\n", at);
                if (start == std::string_view::npos) {
                    break;
                }
                at = std::min(text.find_first_of(" \t\r\n", start), text.size());
                const std::optional<double> value = core::parse_number(text.substr(start, at - start));
                if (!value) {
                    fail("parse", "'" + std::string(text.substr(start, at - start)) + "' is not a number",
                         body + start);
                }
                list.push_back(*value);
            }
            return list;
        }
        fail("format", "an array in the form '" + format + "'", body,
             "write the file as ASCII or with raw appended data");
    }

    std::vector<double> raw(const std::string& type, std::size_t at) const {
        const std::size_t header = wide_ ? 8 : 4;
        if (at + header > bytes_.size()) {
            fail("truncated", "the file ends before its arrays do", bytes_.size(),
                 "the file was cut short: write it again");
        }
        std::uint64_t size = 0;
        std::memcpy(&size, bytes_.data() + at, header);
        at += header;
        if (size > bytes_.size() - at) {
            fail("truncated", "an array of " + std::to_string(size) + " bytes runs beyond the end of the file",
                 bytes_.size(), "the file was cut short: write it again");
        }
        if (type == "Float64") return typed<double>(at, size);
        if (type == "Float32") return typed<float>(at, size);
        if (type == "Int64") return typed<std::int64_t>(at, size);
        if (type == "Int32") return typed<std::int32_t>(at, size);
        if (type == "UInt8") return typed<std::uint8_t>(at, size);
        fail("format", "an array of the type '" + type + "'", at);
    }

    template <class T>
    std::vector<double> typed(std::size_t at, std::uint64_t size) const {
        std::vector<double> list(size / sizeof(T));
        for (std::size_t i = 0; i < list.size(); ++i) {
            T value;
            std::memcpy(&value, bytes_.data() + at + i * sizeof(T), sizeof(T));
            list[i] = static_cast<double>(value);
        }
        return list;
    }

    void cells(SurfaceMesh& mesh, const std::vector<double>& connectivity, const std::vector<double>& offsets,
               const std::vector<double>& patch) const {
        double start = 0;
        for (std::size_t i = 0; i < offsets.size(); ++i) {
            if (!(offsets[i] >= start + 3) || offsets[i] > static_cast<double>(connectivity.size())) {
                fail("index", "polygon " + std::to_string(i) + " has no three corners", bytes_.find("<Polys"));
            }
            const auto from = static_cast<std::size_t>(start), to = static_cast<std::size_t>(offsets[i]);
            for (std::size_t k = from; k < to; ++k) {
                if (!(connectivity[k] >= 0 && connectivity[k] < static_cast<double>(mesh.points.size()))) {
                    fail("index", "polygon " + std::to_string(i) + " names a point that is not there",
                         bytes_.find("<Polys"));
                }
            }
            for (std::size_t k = from + 1; k + 1 < to; ++k) {
                mesh.triangles.push_back({static_cast<std::int32_t>(connectivity[from]),
                                          static_cast<std::int32_t>(connectivity[k]),
                                          static_cast<std::int32_t>(connectivity[k + 1])});
                mesh.patch.push_back(
                    i < patch.size() && patch[i] >= 0 && patch[i] < 10000 ? static_cast<std::int32_t>(patch[i]) : 0);
            }
            start = offsets[i];
        }
    }

    // Names as characters with a zero after each, as VTK writes strings in ASCII.
    void names(SurfaceMesh& mesh) const {
        const std::size_t start = bytes_.substr(0, text_end_).find("Name=\"patch_names\"");
        if (start != std::string_view::npos) {
            std::string name;
            for (const double c : values(" format=\"ascii\"", bytes_.find('>', start) + 1)) {
                if (c == 0) {
                    mesh.patch_names.push_back(name);
                    name.clear();
                } else {
                    name += static_cast<char>(c);
                }
            }
        }
        std::int32_t largest = 0;
        for (const std::int32_t p : mesh.patch) {
            largest = std::max(largest, p);
        }
        while (static_cast<std::size_t>(largest) >= mesh.patch_names.size()) {
            mesh.patch_names.push_back("patch_" + std::to_string(mesh.patch_names.size() + 1));
        }
    }

    std::string_view bytes_;
    std::string file_;
    bool wide_ = false;
    std::size_t raw_ = 0, text_end_ = 0;
};

}  // namespace

SurfaceMesh read_vtp(std::string_view bytes, const std::string& file) { return Reader(bytes, file).read(); }

}  // namespace underbody::geometry
