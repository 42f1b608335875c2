#include "core/batch_problems.h"

#include <algorithm>
#include <cctype>
#include <set>

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
    for (Problem problem : problems) {
        const std::string words = std::to_string(static_cast<int>(problem.severity)) + without_numbers(problem.message);
        auto kind = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& known) { return known.words == words; });
        if (kind == kinds_.end()) {
            kind = kinds_.insert(kinds_.end(), {words, {}});
        }
        if (problem.place.file.empty()) {
            problem.place.file = file;
        }
        kind->problems.push_back(std::move(problem));
    }
}

Problems BatchProblems::gathered(bool each) const {
    Problems all;
    for (const auto& kind : kinds_) {
        if (each) {
            all.insert(all.end(), kind.problems.begin(), kind.problems.end());
            continue;
        }
        std::set<std::string> files;
        for (const auto& problem : kind.problems) {
            files.insert(problem.place.file);
        }
        all.push_back(kind.problems.front());
        if (files.size() > 1) {
            all.back().message += " (and alike in " + std::to_string(files.size() - 1) +
                                  (files.size() == 2 ? " other file)" : " other files)");
        }
    }
    return all;
}

}  // namespace underbody::core
