// TOML files with units, strict: a key that nobody asked for is an error that names it and the nearest known one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace underbody::core {

/// A table of a TOML file. Cheap to copy; copies share the record of which keys were asked for.
///
///     TomlTable root = read_toml("model.toml");
///     TomlTable vehicle = root.table("vehicle");
///     double mass = vehicle.quantity("mass", "kg");
///     root.finish();      // throws when a key was never asked for
class TomlTable {
public:
    [[nodiscard]] bool has(std::string_view key) const;
    /// Number (SI) or string with a unit, in `unit_si`. Throws InputError: missing, not finite, wrong dimension.
    [[nodiscard]] double quantity(std::string_view key, std::string_view unit_si) const;
    [[nodiscard]] double quantity_or(std::string_view key, std::string_view unit_si, double fallback) const;
    [[nodiscard]] std::optional<double> find_quantity(std::string_view key, std::string_view unit_si) const;
    /// An array of quantities: ["1 mm", "2 mm"] or [0.001, 0.002].
    [[nodiscard]] std::vector<double> quantities(std::string_view key, std::string_view unit_si) const;
    [[nodiscard]] std::string string(std::string_view key) const;
    [[nodiscard]] std::string string_or(std::string_view key, std::string fallback) const;
    /// One of `choices`; throws with the nearest one otherwise.
    [[nodiscard]] std::string choice(std::string_view key, const std::vector<std::string>& choices,
                                     std::optional<std::string> fallback = {}) const;
    [[nodiscard]] std::vector<std::string> strings(std::string_view key) const;
    [[nodiscard]] bool boolean_or(std::string_view key, bool fallback) const;
    [[nodiscard]] std::int64_t integer_or(std::string_view key, std::int64_t fallback) const;
    /// Sub-table; throws when it is missing. `table_or_empty` gives an empty one.
    [[nodiscard]] TomlTable table(std::string_view key) const;
    [[nodiscard]] TomlTable table_or_empty(std::string_view key) const;
    /// [[key]]: none when missing.
    [[nodiscard]] std::vector<TomlTable> tables(std::string_view key) const;
    /// All keys in the file's order (marks nothing as asked for).
    [[nodiscard]] std::vector<std::string> keys() const;
    /// True if the value is a string; used where a key may be a name or a table.
    [[nodiscard]] bool is_string(std::string_view key) const;
    [[nodiscard]] bool is_table(std::string_view key) const;
    [[nodiscard]] bool is_array(std::string_view key) const;
    [[nodiscard]] bool is_number(std::string_view key) const;

    /// Place of the key, or of the table when the key is missing or empty.
    [[nodiscard]] Place place(std::string_view key = {}) const;
    /// "vehicle.mass" for messages.
    [[nodiscard]] std::string path_of(std::string_view key) const;
    /// A path in the file, relative to the file's folder.
    [[nodiscard]] std::filesystem::path file(std::string_view key) const;
    [[nodiscard]] std::filesystem::path folder() const;

    /// Says that a key is known although nobody reads it here.
    void accept(std::string_view key) const;
    /// Throws InputError for the first key, here or below, that was never asked for.
    void finish() const;

    struct Shared;
    TomlTable(std::shared_ptr<Shared> shared, const void* node, std::string path);

private:
    const void* value(std::string_view key) const;
    std::shared_ptr<Shared> shared_;
    const void* node_;
    std::string path_;
};

/// Throws InputError with line and column when the file does not parse.
TomlTable read_toml(const std::filesystem::path& path);
TomlTable read_toml_text(std::string_view text, const std::string& source, const std::filesystem::path& folder = ".");

/// `text` as a TOML string with quotes.
std::string toml_string(std::string_view text);

}  // namespace underbody::core
