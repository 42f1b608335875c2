// What the readers of solvers' text reports share: words, numbers, and how they refuse a line.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/file.h"

namespace underbody::postproc {

/// The text of a report, whatever its line ends: without a mark of its coding, lone carriage returns made ends of
/// lines.
class ReportText {
public:
    explicit ReportText(const std::filesystem::path& path);
    [[nodiscard]] std::string_view bytes() const { return own_.empty() ? bytes_ : std::string_view(own_); }
    [[nodiscard]] const std::string& name() const { return file_.name(); }

private:
    core::MappedFile file_;
    std::string_view bytes_;
    std::string own_;
};

/// The words of a line: quoted ones whole; blanks, tabs, commas and brackets between.
std::vector<std::string> words_of(std::string_view line);

/// A number as solvers write it, with "nan(ind)" and "1.#INF" among them.
std::optional<double> number_of(std::string_view word);

/// All words as numbers; nothing when one is none, or there are no words.
std::optional<std::vector<double>> numbers_of(const std::vector<std::string>& words);

[[noreturn]] inline void fail_in_line(const std::string& file, std::int64_t line, const std::string& what) {
    throw core::InputError("format", what, {file, line, {}, {}});
}

}  // namespace underbody::postproc
