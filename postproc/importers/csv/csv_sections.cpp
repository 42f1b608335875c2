#include "postproc/importers/csv/csv_sections.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <unordered_map>

#include "core/text.h"

namespace underbody::postproc {

using core::InputError;
using core::Place;

std::string_view without_bom(std::string_view text) { return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text; }

std::string_view bare(std::string_view line) {
    line = core::trimmed(line);
    while (!line.empty() && (line.back() == ',' || line.back() == ';')) {
        line = core::trimmed(line.substr(0, line.size() - 1));
    }
    return line;
}

std::string_view first_line(std::string_view body) {
    while (!body.empty()) {
        const std::size_t end = std::min(body.find('\n'), body.size());
        const std::string_view text = bare(body.substr(0, end));
        if (!text.empty() && text.front() != '#') {
            return text;
        }
        body.remove_prefix(std::min(end + 1, body.size()));
    }
    return {};
}

std::string section_word(std::string_view line) {
    const std::string_view text = bare(line);
    if (text.size() < 3 || text.front() != '[' || text.back() != ']' ||
        text.substr(1).find('[') != std::string_view::npos) {
        return {};
    }
    return core::lower_case(core::trimmed(text.substr(1, text.size() - 2)));
}

bool is_known_section(const std::string& word) {
    static constexpr std::array words = {"name", "parameters", "spatial fields", "data", "faces", "lines"};
    return std::find(words.begin(), words.end(), word) != words.end();
}

char separator_of(std::string_view header) {
    std::array<std::size_t, 3> counts{};
    static constexpr std::array<char, 3> separators = {',', ';', '\t'};
    for (std::size_t i = 0; i < separators.size(); ++i) {
        counts[i] = static_cast<std::size_t>(std::count(header.begin(), header.end(), separators[i]));
    }
    return separators[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin())];
}

Place CsvText::place_of(const char* at, bool with_column) const {
    if (last_place_.start == nullptr) {
        last_place_.start = file_.bytes().data();
    }
    const char* known = last_place_.start;
    const auto between = std::count(std::min(at, known), std::max(at, known), '\n');
    if (between > 0) {
        last_place_.number += at < known ? -between : between;
        const char* begin = file_.bytes().data();
        const auto before = std::string_view(begin, static_cast<std::size_t>(at - begin)).rfind('\n');
        last_place_.start = before == std::string_view::npos ? begin : begin + before + 1;
    }
    Place place{name_, last_place_.number, {}, {}};
    if (with_column) {
        place.column = at - last_place_.start + 1;
    }
    return place;
}

std::string_view CsvText::line_at(const char* p) const {
    const char* end = text_.data() + text_.size();
    const void* found = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
    return {p, static_cast<std::size_t>((found == nullptr ? end : static_cast<const char*>(found)) - p)};
}

/// The next line, from `p` on, that begins a section; the end of the text when there is none.
const char* CsvText::next_section(const char* p) const {
    const char* end = text_.data() + text_.size();
    while (p < end) {
        const void* found = std::memchr(p, '[', static_cast<std::size_t>(end - p));
        if (found == nullptr) {
            return end;
        }
        const char* open = static_cast<const char*>(found);
        const char* start = open;
        while (start > text_.data() && (start[-1] == ' ' || start[-1] == '\t' || start[-1] == '\r')) {
            --start;
        }
        if ((start == text_.data() || start[-1] == '\n') && !section_word(line_at(open)).empty()) {
            return start;
        }
        p = open + 1;
    }
    return end;
}

std::vector<CsvBlock> CsvText::blocks(core::Problems& problems, core::Progress& progress) const {
    std::vector<CsvBlock> blocks;
    const char* end = text_.data() + text_.size();
    const char* p = next_section(text_.data());
    while (p < end) {
        progress.check();
        const std::string_view line = line_at(p);
        CsvSection section{section_word(line), {}, p};
        const char* body = std::min(end, line.data() + line.size() + 1);
        p = next_section(body);
        section.body = {body, static_cast<std::size_t>(p - body)};
        if (section.word == "name") {
            blocks.push_back({std::string(first_line(section.body)), section.at, true, {}});
        } else if (blocks.empty()) {
            blocks.push_back({"", section.at, false, {}});  // a profile whose [Name] was cut away
        }
        if (!is_known_section(section.word)) {
            problems.push_back({core::Problem::Severity::warning,
                                "section [" + section.word + "] is not known and was left out",
                                place_of(section.at, false)});
        } else if (section.word != "name") {
            blocks.back().sections.push_back(section);
        }
    }
    check_names(blocks);
    return blocks;
}

void CsvText::check_names(std::vector<CsvBlock>& blocks) const {
    std::unordered_map<std::string, const char*> places;
    for (auto& block : blocks) {
        if (block.name.empty()) {
            if (block.named) {
                throw InputError("zone", "[Name] without a name", place_of(block.name_at, false));
            }
            block.name = std::filesystem::path(name_).stem().string();
        }
        const auto [first, is_new] = places.emplace(block.name, block.name_at);
        if (!is_new) {
            throw InputError(
                "zone", "two zones are called '" + block.name + "'", place_of(block.name_at, false),
                "the first stands in line " + std::to_string(*place_of(first->second).line) +
                    ": give one of them another name below its [Name], or export them into files of their own");
        }
    }
}

}  // namespace underbody::postproc
