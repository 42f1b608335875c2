#include "core/batch_problems.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace underbody::core {

namespace {

/// The words of a message with '#' for each number.
std::string without_numbers(const std::string& text) {
    std::string words;
    for (std::size_t i = 0; i < text.size();) {
        const auto digit = [&](std::size_t at) {
            return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
        };
        if (!digit(i) && !((text[i] == '-' || text[i] == '.') && digit(i + 1))) {
            words += text[i++];
            continue;
        }
        words += '#';
        ++i;
        while (digit(i) || (i < text.size() && text[i] == '.' && digit(i + 1)) ||
               (i < text.size() && text[i] == 'e' && (digit(i + 1) || (i + 1 < text.size() && digit(i + 2))))) {
            i += text[i] == 'e' ? 2 : 1;
        }
    }
    return words;
}

}  // namespace

void BatchProblems::add(const std::string& file, const Problems& problems) {
    for (const auto& problem : problems) {
        auto kind = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& known) {  // as a rule, to the letter
            return known.last == problem.message && known.problems.front().severity == problem.severity;
        });
        if (kind == kinds_.end()) {
            const std::string words =
                std::to_string(static_cast<int>(problem.severity)) + without_numbers(problem.message);
            kind = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& known) { return known.words == words; });
            kind = kind == kinds_.end() ? kinds_.insert(kinds_.end(), {words, {}, {}, {}}) : kind;
            kind->last = problem.message;
        }
        const std::string& place = problem.place.file.empty() ? file : problem.place.file;
        kind->files.insert(place);
        if (each_ || kind->problems.empty()) {
            kind->problems.push_back(problem);
            kind->problems.back().place.file = place;
        }
    }
}

Problems BatchProblems::gathered() const {
    Problems all;
    for (const auto& kind : kinds_) {
        all.insert(all.end(), kind.problems.begin(), kind.problems.end());
        if (!each_ && kind.files.size() > 1) {
            all.back().message += " (and alike in " + std::to_string(kind.files.size() - 1) +
                                  (kind.files.size() == 2 ? " other file)" : " other files)");
        }
    }
    return all;
}

}  // namespace underbody::core
