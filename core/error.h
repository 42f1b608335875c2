// Errors that a person can act on: what is wrong, where, the value, what to do.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace underbody::core {

/// Where in a file something was found. Lines and columns count from 1, bytes from 0.
struct Place {
    std::string file;
    std::optional<std::int64_t> line;
    std::optional<std::int64_t> column;
    std::optional<std::int64_t> byte;

    /// "path:12:3", "path (byte 4096)", or "" when nothing is known.
    [[nodiscard]] std::string text() const;
};

/// Every failure that is not a defect of the program. `what()` is the whole message: place, problem and hint.
class Error : public std::runtime_error {
public:
    Error(std::string kind, std::string message, Place place = {}, std::string hint = {});

    /// Short machine-readable word: "unit", "parse", "range", "missing", ...
    [[nodiscard]] const std::string& kind() const { return kind_; }
    [[nodiscard]] const std::string& message() const { return message_; }
    [[nodiscard]] const Place& place() const { return place_; }
    /// What the reader of the message can do about it; may be empty.
    [[nodiscard]] const std::string& hint() const { return hint_; }

private:
    std::string kind_;
    std::string message_;
    Place place_;
    std::string hint_;
};

/// The input (a file, a value in it) is wrong: exit code 3.
class InputError : public Error {
public:
    using Error::Error;
};

/// The command line is wrong: exit code 2.
class UsageError : public Error {
public:
    using Error::Error;
};

/// The machine failed us: disk full, no permission, no display: exit code 3, nothing half-written.
class SystemError : public Error {
public:
    using Error::Error;
};

/// The user cancelled (Ctrl-C, a button): exit code 130.
class Cancelled : public Error {
public:
    Cancelled() : Error("cancelled", "cancelled") {}
};

/// One finding in a file that does not stop the reading of it.
struct Problem {
    enum class Severity { note, warning, error };
    Severity severity = Severity::warning;
    std::string message;
    Place place;
};

/// What a reader or a check found on its way; the caller decides whether to show, log or refuse.
using Problems = std::vector<Problem>;

/// The name among `known` that a mistyped `name` most likely stands for; empty when none is near.
/// Distance is Damerau-Levenshtein without case, at most a third of the length.
std::string nearest_name(const std::string& name, const std::vector<std::string>& known);

/// "did you mean 'X'?" when some known name is near, else "known: A, B, C" (at most 24 names), else "".
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known);

}  // namespace underbody::core
