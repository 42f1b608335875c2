#include "core/error.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace underbody::core {

std::string Place::text() const {
    std::string result = file;
    if (line) {
        result += ":" + std::to_string(*line);
        if (column) {
            result += ":" + std::to_string(*column);
        }
    }
    if (byte) {
        result += (result.empty() ? "byte " : " (byte ") + std::to_string(*byte) + (result.empty() ? "" : ")");
    }
    return result;
}

namespace {
std::string whole_message(const std::string& message, const Place& place, const std::string& hint) {
    const std::string where = place.text();
    std::string text = where.empty() ? message : where + ": " + message;
    if (!hint.empty()) {
        text += "\n  hint: " + hint;
    }
    return text;
}

std::string lower(std::string text) {
    for (char& c : text) {
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return text;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) {
        d[i][0] = i;
    }
    for (std::size_t j = 0; j <= b.size(); ++j) {
        d[0][j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t cost = a[i - 1] == b[j - 1] ? 0 : 1;
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + cost});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
            }
        }
    }
    return d[a.size()][b.size()];
}
}  // namespace

Error::Error(std::string kind, std::string message, Place place, std::string hint)
    : std::runtime_error(whole_message(message, place, hint)),
      kind_(std::move(kind)),
      message_(std::move(message)),
      place_(std::move(place)),
      hint_(std::move(hint)) {}

std::string nearest_name(const std::string& name, const std::vector<std::string>& known) {
    const std::string wanted = lower(name);
    std::string best;
    std::size_t best_distance = std::max<std::size_t>(1, wanted.size() / 3) + 1;
    for (const auto& candidate : known) {
        const std::size_t distance = edit_distance(wanted, lower(candidate));
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
    const std::string near = nearest_name(name, known);
    if (!near.empty()) {
        return "did you mean '" + near + "'?";
    }
    if (known.empty()) {
        return {};
    }
    std::string text = "known: ";
    constexpr std::size_t longest_list = 24;
    for (std::size_t i = 0; i < known.size() && i < longest_list; ++i) {
        text += (i == 0 ? "" : ", ") + known[i];
    }
    if (known.size() > longest_list) {
        text += ", ...";
    }
    return text;
}

}  // namespace underbody::core
