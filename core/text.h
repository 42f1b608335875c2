// Numbers and words out of text and back, independent of the locale.
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace underbody::core {

/// The text without white space at its ends.
std::string_view trimmed(std::string_view text);

/// The parts between the separators; empty parts are kept.
std::vector<std::string_view> split(std::string_view text, char separator);
/// The parts would outlive a text that nobody holds.
template <std::same_as<std::string> Text>
std::vector<std::string_view> split(Text&& text, char separator) = delete;

std::string lower_case(std::string_view text);

/// The number that the whole text (but for white space) holds; nothing if it holds anything else.
/// A leading '+' is allowed; "nan" and "inf" are numbers: the caller decides about finiteness.
std::optional<double> parse_number(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

/// Shortest text that reads back to the same double; '.' as decimal point in every locale.
std::string format_number(double value);

/// `digits` significant digits, for people.
std::string format_number(double value, int digits);

/// `text` fit for HTML or XML text and attributes: & < > " ' escaped.
std::string escape_html(std::string_view text);

std::string base64(std::string_view bytes);

}  // namespace underbody::core
