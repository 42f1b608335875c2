// Fluent's "export / ascii": a table of points without surfaces, zones or units. What can be told is told.
#include <vtkCellType.h>

#include <algorithm>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "postproc/importers/import_context.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/mesh/element_zone.h"
#include "postproc/importers/reports/report_words.h"

namespace underbody::postproc {

namespace {

/// Words between blanks or commas.
std::vector<std::string_view> columns_of(std::string_view line) {
    std::vector<std::string_view> words;
    std::size_t at = 0;
    while (at < line.size()) {
        const std::size_t begin = line.find_first_not_of(" \t,\r", at);
        if (begin == std::string_view::npos) {
            break;
        }
        at = std::min(line.find_first_of(" \t,\r", begin), line.size());
        words.push_back(line.substr(begin, at - begin));
    }
    return words;
}

bool recognises(std::string_view head, const std::filesystem::path& /*path*/) {
    const auto words = columns_of(head.substr(0, std::min(head.find('\n'), head.size())));
    return words.size() > 2 && (words[0] == "nodenumber" || words[0] == "cellnumber");
}

using Columns = std::vector<std::vector<double>>;

void read_rows(const std::string& file, const std::vector<std::string_view>& lines, std::size_t names, Columns& columns,
               core::Progress& progress) {
    for (std::size_t i = 1; i < lines.size(); ++i) {
        if (core::trimmed(lines[i]).empty()) {
            continue;
        }
        const auto words = columns_of(lines[i]);
        const core::Place place{file, static_cast<std::int64_t>(i + 1), {}, {}};
        if (words.size() != names) {
            throw core::InputError(
                "format",
                std::to_string(words.size()) + " values where there are " + std::to_string(names) + " columns", place,
                "is the file cut short?");
        }
        for (std::size_t c = 0; c < words.size(); ++c) {
            const auto value = number_of(words[c]);
            if (!value) {
                throw core::InputError("parse", "'" + std::string(words[c]) + "' is not a number", place);
            }
            columns[c].push_back(*value);
        }
        if (i % 4096 == 0) {
            progress.check();
        }
    }
}

/// Puts coordinates into the part's points; the other columns are values.
std::vector<PartValues> take_columns(ElementPart& part, const std::vector<std::string_view>& names,
                                     const Columns& columns, const std::string& file, std::set<std::string>& seen) {
    const std::size_t count = columns[0].size();
    part.points.grow_to(3 * count);
    part.points.fill(0);
    std::vector<PartValues> values;
    bool located = false;
    for (std::size_t c = 1; c < names.size(); ++c) {
        const std::string name(names[c]);
        if (!seen.insert(name).second) {
            continue;  // coordinates come again where the user asked for them
        }
        const int axis = name == "x-coordinate" ? 0 : name == "y-coordinate" ? 1 : name == "z-coordinate" ? 2 : -1;
        if (axis >= 0) {
            located = true;
            for (std::size_t i = 0; i < count; ++i) {
                part.points[3 * i + static_cast<std::size_t>(axis)] = columns[c][i];
            }
            continue;
        }
        PartValues entry{name, true, 1, Buffer<double>(count)};
        std::copy(columns[c].begin(), columns[c].end(), entry.values.begin());
        values.push_back(std::move(entry));
    }
    if (!located) {
        throw core::InputError("format", "the table has no coordinates", {file, 1, {}, {}});
    }
    for (std::size_t i = 0; i < count; ++i) {
        const auto node = static_cast<std::int64_t>(i);
        part.add(VTK_VERTEX, &node, 1);
    }
    return values;
}

Field read(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress) {
    const core::MappedFile file(path);
    const auto lines = core::split(file.bytes(), '\n');
    const auto names = columns_of(lines.empty() ? std::string_view() : lines[0]);
    if (names.empty()) {
        throw core::InputError("format", "the first line names no columns", {file.name(), 1, {}, {}});
    }
    const bool cells = names[0] == "cellnumber";
    Columns columns(names.size());
    telling([&] { read_rows(file.name(), lines, names.size(), columns, progress); },
            [&] {
                return "columns " + listed(std::vector<std::string>(names.begin(), names.end())) + "; " +
                       std::to_string(columns.back().size()) + " whole rows";
            });
    Field field;
    field.format = "Fluent ASCII";
    field.files = {file.name()};
    std::vector<ElementPart> parts(1);
    ElementPart& part = parts[0];
    part.name = path.stem().string();
    part.kind = ZoneKind::points;
    const std::size_t count = columns[0].size();
    if (count == 0) {
        throw core::InputError("format", "the table has no rows", {file.name(), {}, {}, {}});
    }
    std::set<std::string> seen;
    std::vector<PartValues> values = take_columns(part, names, columns, file.name(), seen);
    scale_parts(parts, options, field);
    field.zones.push_back(zone_from(std::move(part), std::move(values), seen.contains("z-coordinate") ? 3 : 2, options,
                                    file.name(), field.problems));
    field.problems.push_back({core::Problem::Severity::warning,
                              std::string("points at ") + (cells ? "cell centres" : "nodes") +
                                  " without surfaces: forces cannot be integrated from this file",
                              {file.name(), {}, {}, {}}});
    return field;
}

}  // namespace

Importer fluent_ascii_importer() { return {"Fluent ASCII", recognises, read}; }

}  // namespace underbody::postproc
