// The text of a CFD-Post export, cut into blocks and sections.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/progress.h"

namespace underbody::postproc {

/// Without the mark of UTF-8 that some editors put in front.
std::string_view without_bom(std::string_view text);
/// A line without white space and the separators that spreadsheets put behind it.
std::string_view bare(std::string_view line);
/// The first line that is neither empty nor a comment, bare; "" if there is none.
std::string_view first_line(std::string_view body);
/// "name" of "[Name]", "" when the line is no section line.
std::string section_word(std::string_view line);
bool is_known_section(const std::string& word);
/// What stands between the columns: the most frequent of comma, semicolon and tab.
char separator_of(std::string_view header);

struct CsvSection {
    std::string word;       ///< "data"
    std::string_view body;  ///< behind the section line, up to the next one
    const char* at = nullptr;
};

struct CsvBlock {
    std::string name;
    const char* name_at = nullptr;
    bool named = false;  ///< by a [Name] line, which may be empty
    std::vector<CsvSection> sections;
};

/// The file, mapped: pointers and views into it live as long as this.
class CsvText {
public:
    explicit CsvText(const std::filesystem::path& path)
        : file_(path), name_(path.string()), text_(without_bom(file_.bytes())) {}

    [[nodiscard]] std::string_view text() const { return text_; }
    /// Lines are counted from where the last place was: cheap for places near each other. Not for several threads at
    /// once.
    [[nodiscard]] core::Place place_of(const char* at, bool with_column = true) const;
    [[nodiscard]] std::string_view line_at(const char* p) const;
    /// Sections that are not known are told and left out. Throws InputError where zones have no name or share one.
    [[nodiscard]] std::vector<CsvBlock> blocks(core::Problems& problems, core::Progress& progress) const;

private:
    [[nodiscard]] const char* next_section(const char* p) const;
    void check_names(std::vector<CsvBlock>& blocks) const;

    /// A line whose number is known.
    struct Line {
        const char* start = nullptr;
        std::int64_t number = 1;
    };

    core::MappedFile file_;
    std::string name_;
    std::string_view text_;
    mutable Line last_place_;
};

}  // namespace underbody::postproc
