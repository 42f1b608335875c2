// What a file that a user writes may hold: one table of keys per format, which the strict reader, the templates, the
// hints of its errors and the pages in docs/files are made from.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/toml.h"

namespace underbody::core {

/// One key of a table of a TOML file.
struct FileKey {
    std::string name;  ///< as it is written; "*": any name (then `example` is a whole line)
    /// SI unit of a number ("m", "1"), or "text", "file", "true or false", "whole number", "list of m",
    /// or the words it may be: "ellipse | rectangle".
    std::string kind;
    std::string example;   ///< a TOML value that the reader takes as it stands
    std::string fallback;  ///< what holds when the key is left out; empty: the key must be there
    std::string meaning;   ///< one line
    /// Keys that stand together in place of another: the name of the key that they replace.
    std::string instead_of = {};
    [[nodiscard]] bool required() const { return fallback.empty() && name != "*" && instead_of.empty(); }
};

/// One table, by its path: "" (top of the file), "body", "mass.point[]" ([[mass.point]]), "force[].scale.*".
struct FileTable {
    std::string path;
    std::string meaning;
    std::vector<FileKey> keys;
    bool required = false;  ///< the file must hold it
    /// For tables that are usually written on one line in their parent: that line.
    std::string one_line = {};
};

/// A format. Tables stand in the order in which a template shows them.
struct FileFormat {
    std::string name;   ///< "shape"
    std::string file;   ///< "SHAPE.toml"
    std::string title;  ///< one line: what the file is
    std::vector<FileTable> tables;

    /// The table at a place in a file ("force[2].scale.speed"); nullptr when none is described there.
    [[nodiscard]] const FileTable* table(std::string_view place) const;
    /// A key there, or the entry "*"; nullptr when there is none.
    [[nodiscard]] const FileKey* key(std::string_view place, std::string_view of_name) const;
    /// True for a key or for the name of a table below the place.
    [[nodiscard]] bool knows(std::string_view place, std::string_view of_name) const;
    /// Names that may stand there: keys, and tables below; "*" is left out.
    [[nodiscard]] std::vector<std::string> names(std::string_view place) const;
    /// True where any name may stand.
    [[nodiscard]] bool takes_any_name(std::string_view place) const;
    /// What to do about a missing table: its heading and its required keys, or its line in `parent`; empty: none is
    /// described.
    [[nodiscard]] std::string how_to_add_table(std::string_view parent, std::string_view place) const;
};

/// Reads a file by its format (which must live for ever): a name that it does not know is an error at once, before any
/// value is read, with the nearest name that it does know; what is missing is told with the format's example; and a key
/// that the program asks for and the format does not describe, or describes in another unit, is a defect
/// (std::logic_error), so that the description cannot go stale.
TomlTable read_toml(const std::filesystem::path& path, const FileFormat& format);
TomlTable read_toml_text(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                         const FileFormat& format);

/// The heading of a table as a file has it: "mass.point[1]" -> "[[mass.point]]"; "" stays empty.
std::string heading_of(std::string_view place);

/// A commented file with every key: those that must be there stand as they are, the others behind '#'.
std::string template_text(const FileFormat& format);

/// The keys as Markdown tables, one section a table; for the pages in docs/files.
std::string markdown_keys(const FileFormat& format);

}  // namespace underbody::core
