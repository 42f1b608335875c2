// Under which conditions a case was computed: gap, pitch, speed, variant and words of the user's own.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace underbody::cases {

/// Conditions of a case or a selection: numbers in SI, and words ("variant" = "ellipse").
struct Conditions {
    std::vector<std::pair<std::string, double>> numbers;
    std::vector<std::pair<std::string, std::string>> texts;
    /// Of numbers that are no quantity the program knows: the user's own words.
    struct OwnUnit {
        std::string name;
        std::string si;       ///< of the number
        std::string written;  ///< as the user wrote it
    };
    std::vector<OwnUnit> own_units;

    /// Sets a number, in place of one of that name; `written`: the unit that it was written in, of a word of the
    /// user's own.
    void set(const std::string& name, double value, const std::string& written = {});
    /// SI unit of a number of that name: the known quantity's, the one that the user gave it, else "1".
    [[nodiscard]] std::string unit(const std::string& name) const;
    /// The unit to show it in: gap in mm, pitch in deg, the user's own words as written.
    [[nodiscard]] std::string shown_unit(const std::string& name) const;
    [[nodiscard]] std::optional<double> number(const std::string& name) const;
    [[nodiscard]] std::optional<std::string> text(const std::string& name) const;
    /// True if every condition of `wanted` holds here (numbers to 1e-9 relative); a text with a unit ("3 mm") is held
    /// against a number in its unit.
    [[nodiscard]] bool satisfies(const Conditions& wanted) const;
    /// "ellipse, gap 5 mm, pitch 0 deg" for people.
    [[nodiscard]] std::string label() const;
};

/// A number as people write it where that reads back as the same number ("12.345 deg"), else in SI with all its digits.
std::string written(double value, const std::string& unit);
/// "pitch=2 deg,variant=ellipse": what conditions_from reads as the same conditions, words that hold a comma or an
/// equal sign excepted.
std::string text_of(const Conditions& conditions);

/// SI unit of a number in the conditions of a case: of a known quantity, and of the density of its water; none: a word
/// of the user's own.
std::optional<std::string> condition_unit(const std::string& name);

/// "variant=ellipse, gap=5mm", as on the command line: known quantities with units (SI without), other words as they
/// are. Throws core::UsageError: a part that is not name=value, a unit of another dimension, a name given twice.
Conditions conditions_from(const std::string& text);

}  // namespace underbody::cases
