#include "postproc/importers/reports/openfoam_forces.h"

#include <algorithm>
#include <map>

#include "core/file.h"
#include "core/inputs.h"
#include "core/text.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;
using Triple = ForceHistory::Triple;

/// Numbers of a line; brackets only group them.
std::vector<double> numbers_in(std::string_view line, const std::string& file, std::int64_t number) {
    std::string plain(line);
    std::replace_if(
        plain.begin(), plain.end(), [](char c) { return c == '(' || c == ')' || c == '\t' || c == '\r' || c == ','; },
        ' ');
    std::vector<double> values;
    for (const auto word : core::split(plain, ' ')) {
        if (word.empty()) {
            continue;
        }
        const auto value = core::parse_number(word);
        if (!value) {
            throw core::InputError("format", "expected numbers, found '" + std::string(word.substr(0, 40)) + "'",
                                   {file, number, {}, {}});
        }
        values.push_back(*value);
    }
    return values;
}

/// Which triple of a row is what.
struct Layout {
    enum class Kind { total_first, forces_and_moments } kind = Kind::total_first;
    std::size_t parts = 2;  ///< pressure, viscous and perhaps porous
};

struct Row {
    Triple pressure{}, viscous{}, pressure_moment{}, viscous_moment{};
};

/// One file by time.
struct Part {
    std::map<double, Row> rows;
    Triple centre{};
    bool moments = false;
};

Triple triple_at(const std::vector<double>& values, std::size_t group) {
    const std::size_t first = 1 + 3 * group;
    return {values[first], values[first + 1], values[first + 2]};
}

Part read_part(const fs::path& path) {
    const core::MappedFile mapped(path);
    Part part;
    std::string heading;
    std::int64_t number = 0;
    for (const auto raw : core::split(mapped.bytes(), '\n')) {
        ++number;
        const auto line = core::trimmed(raw);
        if (line.empty()) {
            continue;
        }
        if (line.front() == '#') {
            const std::string text(line);
            if (text.find("CofR") != std::string::npos && text.find(':') != std::string::npos) {
                const auto at = numbers_in(text.substr(text.find(':') + 1), mapped.name(), number);
                if (at.size() == 3) {
                    part.centre = {at[0], at[1], at[2]};
                }
            }
            heading = text.find("Time") != std::string::npos ? text : heading;
            continue;
        }
        const auto values = numbers_in(line, mapped.name(), number);
        const bool both = heading.find("moment") != std::string::npos;  // "forces(pressure viscous porous) moment(...)"
        const std::size_t groups = (values.size() - 1) / 3;
        const bool fits = !values.empty() && values.size() == 1 + 3 * groups &&
                          (both ? groups == 4 || groups == 6 : groups == 3 || groups == 4);
        if (!fits) {
            throw core::InputError(
                "format", "a row of " + std::to_string(values.size()) + " numbers, which is no time with its forces",
                {mapped.name(), number, {}, {}}, heading.empty() ? "the line of headings '# Time ...' is missing" : "");
        }
        Row row;
        row.pressure = triple_at(values, both ? 0 : 1);
        row.viscous = triple_at(values, both ? 1 : 2);
        if (both) {
            row.pressure_moment = triple_at(values, groups / 2);
            row.viscous_moment = triple_at(values, groups / 2 + 1);
            part.moments = true;
        }
        part.rows[values[0]] = row;
    }
    return part;
}

/// Words, "quoted texts" (with their first quote, so that they are no punctuation) and { } ( ) ; of a dictionary
/// without its comments. A bracket within a word is part of it, as in OpenFOAM.
std::vector<std::string> tokens_of(std::string_view text) {
    std::vector<std::string> tokens;
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    for (std::size_t i = 0; i < text.size();) {
        if (blank(text[i])) {
            ++i;
        } else if (text.substr(i, 2) == "//") {
            i = std::min(text.find('\n', i), text.size());
        } else if (text.substr(i, 2) == "/*") {
            const std::size_t end = text.find("*/", i + 2);
            i = end == std::string_view::npos ? text.size() : end + 2;
        } else if (text[i] == '"') {
            const std::size_t end = std::min(text.find('"', i + 1), text.size());
            tokens.emplace_back(text.substr(i, end - i));
            i = std::min(end + 1, text.size());
        } else if (std::string_view("{}();").find(text[i]) != std::string_view::npos) {
            tokens.emplace_back(1, text[i++]);
        } else {
            const std::size_t first = i;
            for (int open = 0; i < text.size() && !blank(text[i]) &&
                               std::string_view("{};\"").find(text[i]) == std::string_view::npos;
                 ++i) {
                open += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
                if (open < 0 || (open > 0 && text.substr(first, i - first) == "patches")) {
                    break;
                }
            }
            tokens.emplace_back(text.substr(first, i - first));
        }
    }
    return tokens;
}

/// The words of `patches ( ... )` in the entry that opens with the brace at `at`, not those of dictionaries within it.
std::vector<std::string> patches_in(const std::vector<std::string>& tokens, std::size_t at) {
    int depth = 0;
    for (std::size_t i = at; i + 1 < tokens.size(); ++i) {
        depth += tokens[i] == "{" ? 1 : tokens[i] == "}" ? -1 : 0;
        if (depth == 0) {
            break;
        }
        if (depth != 1 || tokens[i] != "patches" || tokens[i + 1] != "(") {
            continue;
        }
        std::vector<std::string> words;
        for (std::size_t k = i + 2; k < tokens.size() && tokens[k] != ")"; ++k) {
            if (tokens[k].front() == '$') {
                return {};  // stands elsewhere
            }
            words.push_back(tokens[k].front() == '"' ? tokens[k].substr(1) : tokens[k]);
        }
        return words;
    }
    return {};
}

/// The patches of the entry `name { ... }` of a dictionary; empty when they are not there.
std::vector<std::string> patches_of(const fs::path& dictionary, const std::string& name) {
    std::error_code ignored;
    if (!fs::is_regular_file(dictionary, ignored)) {
        return {};
    }
    const std::vector<std::string> tokens = tokens_of(core::read_file(dictionary));
    for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
        if ((tokens[i] == name || tokens[i] == '"' + name) && tokens[i + 1] == "{") {
            auto words = patches_in(tokens, i + 1);
            if (!words.empty()) {
                return words;
            }
        }
    }
    return {};
}

/// Folders named after a time, oldest first.
std::vector<fs::path> times_in(const fs::path& folder) {
    std::vector<std::pair<double, fs::path>> times;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const auto time = core::parse_number(entry.path().filename().string());
        if (entry.is_directory() && time) {
            times.emplace_back(*time, entry.path());
        }
    }
    std::sort(times.begin(), times.end());
    std::vector<fs::path> result;
    for (auto& [time, path] : times) {
        result.push_back(std::move(path));
    }
    return result;
}

/// "force.dat" and what later runs from the same start wrote beside it, "force_0.dat", oldest first: the endings behind
/// the stem, ".dat" or "_0.dat".
std::vector<std::string> endings_of(const fs::path& folder, const std::string& stem) {
    std::vector<std::string> endings;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (entry.is_regular_file() && name.starts_with(stem) && name.ends_with(".dat") &&
            (name.size() == stem.size() + 4 || name[stem.size()] == '_')) {
            endings.push_back(name.substr(stem.size()));
        }
    }
    // '.' stands before '_', and of several runs the number says which came later.
    std::sort(endings.begin(), endings.end(), [](const std::string& a, const std::string& b) {
        return std::pair(a.size(), a) < std::pair(b.size(), b);
    });
    return endings;
}

/// Forces of one start, with the moments that stand in a file of their own; one part a run.
std::vector<Part> read_start(const fs::path& folder, ForceHistory& history) {
    std::vector<Part> parts;
    for (const std::string stem : {"forces", "force"}) {
        for (const auto& ending : endings_of(folder, stem)) {
            Part part = read_part(folder / (stem + ending));
            history.files.push_back((folder / (stem + ending)).string());
            const fs::path apart = folder / ("moment" + ending);
            if (stem == "force" && fs::is_regular_file(apart)) {
                const Part moments = read_part(apart);
                history.files.push_back(apart.string());
                part.centre = moments.centre;
                part.moments = true;
                std::erase_if(part.rows, [&](const auto& entry) { return !moments.rows.contains(entry.first); });
                for (auto& [time, row] : part.rows) {
                    const Row& moment = moments.rows.at(time);
                    row.pressure_moment = moment.pressure;
                    row.viscous_moment = moment.viscous;
                }
            }
            parts.push_back(std::move(part));
        }
    }
    return parts;
}

}  // namespace

std::vector<ForceHistory> read_openfoam_forces(const fs::path& case_folder) {
    std::vector<ForceHistory> histories;
    const fs::path root = case_folder / "postProcessing";
    std::error_code ignored;
    if (!fs::is_directory(root, ignored)) {
        return histories;
    }
    std::vector<fs::path> objects;
    core::note_names(root, "*");
    for (const auto& entry : fs::directory_iterator(root)) {
        if (entry.is_directory()) {
            core::note_names(entry.path(), "*");
            objects.push_back(entry.path());
        }
    }
    std::sort(objects.begin(), objects.end());
    for (const auto& object : objects) {
        ForceHistory history;
        history.name = object.filename().string();
        std::map<double, Row> rows;
        bool moments = true;
        for (const auto& start : times_in(object)) {
            for (Part& part : read_start(start, history)) {
                if (part.rows.empty()) {
                    continue;
                }
                rows.erase(rows.lower_bound(part.rows.begin()->first), rows.end());
                rows.merge(part.rows);
                history.centre = part.centre;
                moments = moments && part.moments;
            }
        }
        if (rows.empty()) {
            continue;
        }
        for (const auto& [time, row] : rows) {
            history.time.push_back(time);
            history.pressure_force.push_back(row.pressure);
            history.viscous_force.push_back(row.viscous);
            if (moments) {
                history.pressure_moment.push_back(row.pressure_moment);
                history.viscous_moment.push_back(row.viscous_moment);
            }
        }
        history.patches = patches_of(case_folder / "system" / "controlDict", history.name);
        histories.push_back(std::move(history));
    }
    return histories;
}

}  // namespace underbody::postproc
