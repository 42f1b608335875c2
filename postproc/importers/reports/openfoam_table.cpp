#include "postproc/importers/reports/openfoam_table.h"

#include <algorithm>

#include "core/lines.h"
#include "core/text.h"
#include "postproc/importers/reports/report_words.h"

namespace underbody::postproc {

namespace {

/// Words between blanks; a bracket round several of them is taken off, that of "Cl(f)" is not.
std::vector<std::string> heads_in(std::string_view line) {
    std::string plain(line);
    std::replace(plain.begin(), plain.end(), '\t', ' ');
    std::vector<std::string> names;
    for (const auto word : core::split(plain, ' ')) {
        std::string name(core::trimmed(word));
        if (name.starts_with('(')) {
            name.erase(0, 1);
        }
        if (name.ends_with(')') && name.find('(') == std::string::npos) {
            name.pop_back();
        }
        if (!name.empty()) {
            names.push_back(std::move(name));
        }
    }
    return names;
}

/// "Time  forces(pressure viscous porous) moment(pressure viscous porous)", as written before v1906 and by the
/// Foundation.
std::vector<std::string> heads_of_groups(std::string_view line) {
    std::vector<std::string> names = {"Time"};
    for (std::size_t open = line.find('('); open != std::string_view::npos; open = line.find('(', open + 1)) {
        const std::size_t close = std::min(line.find(')', open), line.size());
        const std::size_t begin = line.find_last_of(" \t#", open) + 1;
        for (const auto part : core::split(line.substr(open + 1, close - open - 1), ' ')) {
            for (const char* axis : {"_x", "_y", "_z"}) {
                if (!core::trimmed(part).empty()) {
                    names.push_back(std::string(line.substr(begin, open - begin)) + "_" +
                                    std::string(core::trimmed(part)) + axis);
                }
            }
        }
    }
    return names;
}

bool is_head(std::string_view comment) {
    const auto words = heads_in(comment);
    return words.size() > 1 && words.front() == "Time" && words[1] != ":";
}

/// "# liftDir : (0 0 1)", "# Aref : 0.02".
void take_setting(std::string_view comment, MonitorCoefficients& settings) {
    const auto colon = comment.find(':');
    if (colon == std::string_view::npos) {
        return;
    }
    const std::string name(core::trimmed(comment.substr(0, colon)));
    const auto numbers = numbers_of(words_of(comment.substr(colon + 1)));
    if (numbers && numbers->size() == 1) {
        auto* target = name == "magUInf"  ? &settings.speed
                       : name == "lRef"   ? &settings.length
                       : name == "Aref"   ? &settings.area
                       : name == "rhoRef" ? &settings.density
                                          : nullptr;
        if (target != nullptr) {
            *target = numbers->front();
        }
    } else if (numbers && numbers->size() == 3) {
        const std::array<double, 3> triple = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
        if (name == "CofR") {
            settings.centre = triple;
        } else {
            settings.directions.emplace_back(name, triple);
        }
    }
}

/// "forces(pressure viscous)": a name that is of the whole bracket behind it.
bool has_groups(std::string_view heading) {
    for (std::size_t open = heading.find('('); open != std::string_view::npos; open = heading.find('(', open + 1)) {
        const std::size_t close = std::min(heading.find(')', open), heading.size());
        if (open > 0 && heading[open - 1] != ' ' && heading[open - 1] != '\t' &&
            heading.substr(open, close - open).find(' ') != std::string_view::npos) {
            return true;
        }
    }
    return false;
}

/// Which words of the first row are numbers; where the heads are one a vector, they become one a component.
std::vector<bool> columns_of(const std::vector<std::string>& words, std::vector<std::string>& heads) {
    if (heads.size() > 1 && words.size() == 1 + 3 * (heads.size() - 1)) {
        std::vector<std::string> whole = {heads.front()};
        for (std::size_t i = 1; i < heads.size(); ++i) {
            for (const char* axis : {"_x", "_y", "_z"}) {
                whole.push_back(heads[i] + axis);
            }
        }
        heads = std::move(whole);
    }
    std::vector<bool> numbers;
    for (const auto& word : words) {
        numbers.push_back(number_of(word).has_value());
    }
    return numbers;
}

}  // namespace

bool has_openfoam_table(std::string_view text) {
    std::size_t lines = 0;
    for (const auto raw : core::split(text.substr(0, 65536), '\n')) {
        const auto line = core::trimmed(raw);
        if (!line.empty() && line.front() != '#') {
            return false;
        }
        if (!line.empty() && is_head(line.substr(1))) {
            return true;
        }
        if (++lines > 100) {
            return false;
        }
    }
    return false;
}

namespace {

/// The numbers of a row, of the columns that have numbers.
std::vector<double> numbers_in_row(const std::string& file, std::int64_t number, const std::vector<std::string>& words,
                                   const std::vector<std::string>& heads, const std::vector<bool>& numeric) {
    if (words.size() != heads.size() || words.size() != numeric.size() || !numeric.front()) {
        fail_in_line(file, number,
                     "a row of " + std::to_string(words.size()) + " entries where there are " +
                         std::to_string(heads.size()) + " columns");
    }
    std::vector<double> row;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto value = numeric[i] ? number_of(words[i]) : std::nullopt;
        if (numeric[i] && !value) {
            fail_in_line(file, number, "expected a number, found '" + words[i].substr(0, 40) + "'");
        }
        if (value) {
            row.push_back(*value);
        }
    }
    return row;
}

}  // namespace

Monitor read_openfoam_table(const std::string& file, std::string_view text) {
    Monitor monitor;
    monitor.file = file;
    MonitorCoefficients settings;
    std::vector<std::string> heads;
    std::vector<bool> numeric;
    MonitorRows rows;
    core::for_each_line(text, [&](std::int64_t number, std::string_view line) {
        if (line.front() == '#') {
            const auto comment = core::trimmed(line.substr(1));
            if (is_head(comment)) {
                heads = has_groups(comment) ? heads_of_groups(comment) : heads_in(comment);
                numeric.clear();
            } else if (monitor.title.empty() && comment.find(':') == std::string_view::npos) {
                monitor.title = comment;
            }
            take_setting(comment, settings);
            return;
        }
        const auto words = words_of(line);
        if (numeric.empty()) {
            numeric = columns_of(words, heads);
        }
        std::vector<double> row = numbers_in_row(file, number, words, heads, numeric);
        rows.add(std::move(row));
    });
    if (rows.empty()) {
        throw core::InputError("format", "there is no row of numbers below the heading", {file, {}, {}, {}},
                               "the run has written none yet");
    }
    for (std::size_t i = 0; i < heads.size(); ++i) {
        if (numeric[i]) {
            monitor.columns.push_back(heads[i]);
        }
    }
    if (settings.area && settings.speed) {
        monitor.coefficients = std::move(settings);
    }
    rows.into(monitor);
    return monitor;
}

}  // namespace underbody::postproc
