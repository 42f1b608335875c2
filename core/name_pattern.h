// File-name patterns that carry conditions: 'fields/{variant}-h{gap:mm}-p{pitch:deg}.csv'.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/table.h"

namespace underbody::core {

/// `{name}` stands for text, `{name:unit}` for a number in that unit; `*` and `?` as in a shell.
/// A `{name}` matches the shortest text that lets the rest fit; a number the most digits, sign, point and exponent.
class NamePattern {
public:
    /// Throws UsageError for an unclosed brace, an empty name, an unknown unit, a unit of another dimension than
    /// the known quantity has, or a name that occurs twice.
    explicit NamePattern(std::string pattern);

    struct Match {
        std::vector<std::pair<std::string, double>> numbers;  ///< SI
        std::vector<std::pair<std::string, std::string>> texts;
    };
    /// Nothing when the whole text does not fit.
    [[nodiscard]] std::optional<Match> match(const std::string& text) const;

    struct Found {
        std::filesystem::path path;
        Match match;
        bool folder = false;
    };
    /// All files that fit, by their texts, then by their numbers, then by name; the pattern may have several folders.
    /// `root` is where a relative pattern starts.
    [[nodiscard]] std::vector<Found> files(const std::filesystem::path& root = ".") const;
    /// The same, with the folders that fit.
    [[nodiscard]] std::vector<Found> files_and_folders(const std::filesystem::path& root = ".") const;

    /// Files (and, when asked for, folders) that would fit if every `{name:unit}` took any text ("run-h5O.csv",
    /// "run-h10-old.csv"), by name: what `files` passes over is seldom meant to be left out.
    [[nodiscard]] std::vector<std::filesystem::path> near_misses(const std::filesystem::path& root = ".",
                                                                 bool folders = false) const;

    /// Why a near miss does not fit: "'5mm' is no number: write {gap:mm}mm where the names carry the unit".
    [[nodiscard]] std::string why_not(const std::filesystem::path& path, const std::filesystem::path& root = ".") const;

    /// True when the text has a brace, `*` or `?`.
    static bool is_pattern(const std::string& text);

    /// Names of all braces, in order; `number` tells which carry a unit.
    struct Part {
        enum class Kind { literal, text, number, any, one } kind = Kind::literal;
        std::string value;  ///< literal text, or the name
        std::string unit;   ///< written unit of a number
    };
    [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }

private:
    std::vector<Found> files_of(const std::vector<Part>& parts, const std::filesystem::path& root,
                                bool folders = false) const;

    std::string pattern_;
    std::vector<Part> parts_;
};

}  // namespace underbody::core
