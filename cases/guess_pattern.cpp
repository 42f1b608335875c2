#include "cases/guess_pattern.h"

#include <algorithm>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "core/name_pattern.h"
#include "core/units.h"

namespace underbody::cases {

namespace {

/// A piece of a name between separators: a condition with its number, or a word.
struct Token {
    std::string before;     ///< separators
    std::string word;       ///< of a condition: what stands before the number
    std::string condition;  ///< "gap"; empty: a word
    std::string unit;       ///< as it is to be read
    std::string behind;     ///< unit as it stands in the name
};

struct Known {
    const char* words;  ///< between bars
    const char* condition;
    const char* unit;
};
constexpr Known known_words[] = {{"|h|g|gap|height|clearance|", "gap", "mm"},
                                 {"|p|a|pitch|alpha|aoa|theta|trim|", "pitch", "deg"},
                                 {"|u|v|speed|vel|velocity|", "speed", "m/s"},
                                 {"|t|time|", "time", "s"},
                                 {"|jet|volt|voltage|", "jet_voltage", "V"}};

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::optional<Token> condition_in(const std::string& piece) {
    static const std::regex form(R"(([A-Za-z]+)=?([-+]?\d+(?:\.\d+)?)([A-Za-z]*))");
    std::smatch match;
    if (!std::regex_match(piece, match, form)) {
        return {};
    }
    const std::string word = lower(match[1].str());
    const std::string behind = match[3].str();
    for (const auto& known : known_words) {
        if (std::string(known.words).find("|" + word + "|") == std::string::npos) {
            continue;
        }
        const std::string own = behind == "ms" ? "m/s" : behind;  // a name cannot hold the stroke
        const bool fits = !behind.empty() && core::is_unit(own) && core::same_dimension(own, known.unit);
        if (!behind.empty() && !fits) {
            return {};
        }
        const std::string text = match[1].str() + (piece.find('=') == std::string::npos ? "" : "=");
        return Token{{}, text, known.condition, fits ? own : known.unit, behind};
    }
    return {};
}

std::vector<Token> tokens_of(const std::string& name) {
    // A minus before a digit and behind a letter ("p-2") is a sign; a point between digits is of the number.
    static const std::regex piece(R"([A-Za-z]+=?[-+]?\d+(?:\.\d+)?[A-Za-z]*(?![A-Za-z0-9])|[A-Za-z0-9]+)");
    std::vector<Token> tokens;
    std::size_t at = 0;
    for (auto i = std::sregex_iterator(name.begin(), name.end(), piece); i != std::sregex_iterator(); ++i) {
        const std::string text = i->str();
        const auto begin = static_cast<std::size_t>(i->position());
        const bool ending = begin > 0 && name[begin - 1] == '.' && begin + text.size() == name.size();  // ".h5"
        const auto condition = ending ? std::nullopt : condition_in(text);
        Token token = condition.value_or(Token{{}, text, {}, {}, {}});
        token.before = name.substr(at, begin - at);
        at = begin + text.size();
        tokens.push_back(std::move(token));
    }
    tokens.push_back({name.substr(at), {}, {}, {}, {}});
    return tokens;
}

/// What names must share to be of one pattern.
std::string skeleton(const std::vector<Token>& tokens) {
    std::string text;
    for (const auto& token : tokens) {
        text += token.before + (token.condition.empty() ? "\x01" : token.word + "\x02" + token.behind);
    }
    return text;
}

bool are_meshes(const std::set<std::string>& words) {
    static const std::set<std::string> sizes = {"coarse", "medium", "fine", "finer", "finest", "coarser", "coarsest"};
    return std::all_of(words.begin(), words.end(), [](const std::string& word) { return sizes.contains(lower(word)); });
}

std::string pattern_of(const std::vector<std::vector<Token>>& names) {
    std::string pattern;
    std::set<std::string> taken;
    for (std::size_t i = 0; i < names.front().size(); ++i) {
        const Token& first = names.front()[i];
        pattern += first.before;
        if (!first.condition.empty()) {
            pattern += first.word;
            pattern += taken.insert(first.condition).second ? "{" + first.condition + ":" + first.unit + "}" : "*";
            pattern += first.behind;
            continue;
        }
        std::set<std::string> words;
        for (const auto& tokens : names) {
            words.insert(tokens[i].word);
        }
        if (words.size() == 1) {
            pattern += first.word;
            continue;
        }
        const std::string base = are_meshes(words) ? "mesh" : "variant";
        std::string name = base;
        for (int number = 2; !taken.insert(name).second; ++number) {
            name = base + std::to_string(number);
        }
        pattern += "{" + name + "}";
    }
    return pattern;
}

/// ".cas" files beside their ".dat" are parts of the same case.
void drop_case_files(std::vector<std::string>& names) {
    const std::set<std::string> all(names.begin(), names.end());
    std::erase_if(names, [&](std::string name) {
        const auto at = name.rfind(".cas");
        return at != std::string::npos && all.contains(name.replace(at, 4, ".dat"));
    });
}

}  // namespace

GuessedPattern guess_pattern(std::vector<std::string> names) {
    drop_case_files(names);
    std::map<std::string, std::vector<std::vector<Token>>> groups;
    for (const auto& name : names) {
        auto tokens = tokens_of(name);
        const std::string key = skeleton(tokens);
        groups[key].push_back(std::move(tokens));
    }
    const auto most = std::max_element(groups.begin(), groups.end(),
                                       [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    GuessedPattern guessed;
    if (most == groups.end()) {
        return guessed;
    }
    guessed.pattern = pattern_of(most->second);
    const core::NamePattern pattern(guessed.pattern);
    for (const auto& name : names) {
        (pattern.match(name) ? guessed.fitting : guessed.others).push_back(name);
    }
    return guessed;
}

}  // namespace underbody::cases
