// PLY: elements (vertices, faces, whatever else the header names) and their properties, ASCII and binary.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace underbody::core {

/// The values that one property has in all items of its element.
struct PlyProperty {
    std::string name;
    bool list = false;
    std::vector<double> values;  ///< a number an item; of a list all items' values one after the other
    std::vector<std::size_t>
        list_begin;  ///< of a list: item i holds values[list_begin[i]] to before values[list_begin[i + 1]]
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;

    [[nodiscard]] const PlyProperty* find(std::string_view property) const;
    /// "vertex 17 of 300", for messages; `item` counts from 0.
    [[nodiscard]] std::string item(std::size_t item) const;
};

struct PlyFile {
    std::vector<PlyElement> elements;
    std::vector<std::string> comments;  ///< in the header's order, without the word "comment"

    [[nodiscard]] const PlyElement* find(std::string_view element) const;
};

/// The three coordinates of the vertices; they are finite and of one length.
struct PlyPoints {
    const std::vector<double>& x;
    const std::vector<double>& y;
    const std::vector<double>& z;
};

/// Everything in a PLY file's bytes; `file` is its name for messages. Memory stays within 12 times the file's size.
/// Throws InputError with the line (header, ASCII) or the byte (binary): "format" for what is no PLY, "parse" for a
/// header or a number that makes no sense, "truncated" when the file ends before its elements do.
PlyFile read_ply(std::string_view bytes, const std::string& file);

/// Throws InputError "format" when there are no vertices with x, y and z, "number" when one is not finite.
PlyPoints ply_points(const PlyFile& ply, const std::string& file);

/// The faces' corners: numbers of vertices, each checked to exist; nullptr when the file has no faces.
/// Throws InputError "index" for a corner that is no vertex and for a face of fewer than three.
const PlyProperty* ply_corners(const PlyFile& ply, const std::string& file);

}  // namespace underbody::core
