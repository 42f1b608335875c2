#include "postproc/importers/openfoam_forces.h"

#include <algorithm>
#include <map>

#include "core/file.h"
#include "core/text.h"

namespace underbody::postproc {

namespace {

namespace fs = std::filesystem;
using Triple = ForceHistory::Triple;

/// Numbers of a line; brackets only group them.
std::vector<double> numbers_in(std::string_view line, const std::string& file, std::int64_t number) {
    std::string plain(line);
    std::replace_if(plain.begin(), plain.end(), [](char c) { return c == '(' || c == ')' || c == '\t' || c == '\r' || c == ','; }, ' ');
    std::vector<double> values;
    for (const auto word : core::split(plain, ' ')) {
        if (word.empty()) {
            continue;
        }
        const auto value = core::parse_number(word);
        if (!value) {
            throw core::InputError("format", "expected numbers, found '" + std::string(word.substr(0, 40)) + "'", {file, number, {}, {}});
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
        const bool fits = !values.empty() && values.size() == 1 + 3 * groups && (both ? groups == 4 || groups == 6 : groups == 3 || groups == 4);
        if (!fits) {
            throw core::InputError("format", "a row of " + std::to_string(values.size()) + " numbers, which is no time with its forces", {mapped.name(), number, {}, {}},
                                   heading.empty() ? "the line of headings '# Time ...' is missing" : "");
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

/// The words of `patches ( ... )` within the entry `name { ... }` of a dictionary; empty when it is not there.
std::vector<std::string> patches_of(const fs::path& dictionary, const std::string& name) {
    std::error_code ignored;
    if (!fs::is_regular_file(dictionary, ignored)) {
        return {};
    }
    std::string text;
    for (const auto line : core::split(core::read_file(dictionary), '\n')) {
        text += std::string(line.substr(0, line.find("//"))) + ' ';
    }
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
        const std::size_t open = text.find_first_not_of(" \t\r\"", at + name.size());
        if (open == std::string::npos || text[open] != '{') {
            continue;
        }
        const std::size_t patches = text.find("patches", open);
        const std::size_t close = text.find('}', open);
        if (patches == std::string::npos || patches > close) {
            return {};
        }
        const std::size_t first = text.find('(', patches);
        // Patterns hold brackets of their own: the list ends with the bracket before the semicolon.
        const std::size_t semicolon = text.find(';', patches);
        const std::size_t last = semicolon == std::string::npos ? semicolon : text.rfind(')', semicolon);
        if (first == std::string::npos || last == std::string::npos || first > last) {
            return {};
        }
        std::vector<std::string> words;
        for (const auto word : core::split(std::string_view(text).substr(first + 1, last - first - 1), ' ')) {
            std::string bare(core::trimmed(word));
            std::erase(bare, '"');
            if (!bare.empty()) {
                words.push_back(bare);
            }
        }
        return words;
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

/// "force.dat" and what later runs from the same start wrote beside it, "force_0.dat", oldest first: the endings behind the
/// stem, ".dat" or "_0.dat".
std::vector<std::string> endings_of(const fs::path& folder, const std::string& stem) {
    std::vector<std::string> endings;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (entry.is_regular_file() && name.starts_with(stem) && name.ends_with(".dat") && (name.size() == stem.size() + 4 || name[stem.size()] == '_')) {
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
    for (const auto& entry : fs::directory_iterator(root)) {
        if (entry.is_directory()) {
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
