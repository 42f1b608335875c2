// CFX and CFD-Post CSV: [Name] blocks with [Data] and, when exported with connectivity, [Faces] or [Lines].
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTypeInt64Array.h>

#include <algorithm>
#include <array>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "core/counted.h"
#include "core/text.h"
#include "postproc/field/surface_check.h"
#include "postproc/importers/csv/csv_columns.h"
#include "postproc/importers/csv/csv_rows.h"
#include "postproc/importers/csv/csv_sections.h"
#include "postproc/importers/csv/csv_tail.h"
#include "postproc/importers/import_context.h"
#include "postproc/importers/importer.h"

namespace underbody::postproc {

namespace {

using core::InputError;
using core::Place;
using core::Problem;
using Severity = Problem::Severity;

class Reader {
public:
    Reader(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress)
        : text_(path), options_(options), progress_(progress) {
        field_.files = {path.string()};
        field_.format = "CFD-Post CSV";
    }

    Field read() {
        const std::vector<CsvBlock> blocks = text_.blocks(field_.problems, progress_);
        if (blocks.empty()) {
            throw InputError("format", "the file holds no block of data", {field_.files[0], {}, {}, {}},
                             "an export of CFD-Post has [Name] and [Data] sections");
        }
        for (const auto& block : blocks) {
            names_.push_back(block.name);
        }
        std::size_t done = 0;
        for (const auto& block : blocks) {
            progress_.report(static_cast<double>(done++) / static_cast<double>(blocks.size()), "reading " + block.name);
            progress_.check();
            if (matches_any(options_.zones, block.name)) {
                read_block(block, &block == &blocks.back());
            }
        }
        if (field_.zones.empty()) {
            throw InputError("zone", "no zone of the file fits the pattern", {field_.files[0], {}, {}, {}},
                             core::did_you_mean(options_.zones.front(), names_));
        }
        note_surfaces_without_faces();
        settle_dimension();
        return std::move(field_);
    }

    [[nodiscard]] std::string understood() const {
        if (names_.empty()) {
            return "sections of CFD-Post, no list of zones yet";
        }
        std::string text =
            std::to_string(names_.size()) + (names_.size() == 1 ? " zone (" : " zones (") + listed(names_) + ")";
        for (const auto& zone : field_.zones) {
            text += (&zone == &field_.zones.front() ? "; read " : ", ") + zone.name + " with " +
                    std::to_string(zone.surface->GetNumberOfPoints()) + " nodes, " +
                    std::to_string(zone.surface->GetNumberOfPolys()) + " faces";
        }
        return text;
    }

private:
    template <typename F>
    auto parsed(F&& parse) const {
        try {
            return parse();
        } catch (const RowError& error) {
            throw InputError("parse", error.message, text_.place_of(error.at), error.hint);
        }
    }

    void note(Severity severity, std::string message, Place place) {
        field_.problems.push_back({severity, std::move(message), std::move(place)});
    }

    void read_block(const CsvBlock& block, bool last) {
        const CsvSection* data = nullptr;
        const CsvSection* faces = nullptr;
        const CsvSection* lines = nullptr;
        std::optional<std::size_t> stated_rows;
        for (const auto& section : block.sections) {
            const CsvSection** slot = section.word == "data"    ? &data
                                      : section.word == "faces" ? &faces
                                      : section.word == "lines" ? &lines
                                                                : nullptr;
            if (slot != nullptr && *slot != nullptr) {
                throw InputError("parse", "zone '" + block.name + "' has a second [" + section.word + "]",
                                 text_.place_of(section.at, false));
            }
            if (slot != nullptr) {
                *slot = &section;
            } else if (section.word == "parameters") {
                stated_rows = read_parameters(block.name, section.body);
            }
        }
        if (data == nullptr) {
            throw InputError("parse", "zone '" + block.name + "' has no [Data]", text_.place_of(block.name_at, false),
                             "the file is cut short or damaged");
        }
        Zone zone;
        zone.name = block.name;
        zone.id = static_cast<int>(field_.zones.size()) + 1;
        zone.surface = vtkSmartPointer<vtkPolyData>::New();
        zone.normals_into_fluid = false;
        const std::size_t rows = read_data(*data, zone);
        if (stated_rows && *stated_rows != rows) {
            throw InputError("parse",
                             "zone '" + block.name + "' has " + std::to_string(rows) +
                                 " rows, its parameter Nnodes says " + std::to_string(*stated_rows),
                             text_.place_of(data->at, false), "the file is cut short or damaged");
        }
        read_connectivity(faces, lines, rows, last, zone);
        check_tail(block, zone, last);
        field_.zones.push_back(std::move(zone));
    }

    std::optional<std::size_t> read_parameters(const std::string& zone, std::string_view body) {
        std::optional<std::size_t> nodes;
        for (const auto line : core::split(body, '\n')) {
            const std::string_view text = bare(line);
            const auto equals = text.find('=');
            if (text.empty() || text.front() == '#' || equals == std::string_view::npos) {
                continue;
            }
            const std::string key(core::trimmed(text.substr(0, equals)));
            const std::string_view value = core::trimmed(text.substr(equals + 1));
            field_.metadata.emplace_back(zone + ": " + key, std::string(value));
            const auto count = core::parse_integer(value);
            if (core::lower_case(key) == "nnodes" && count && *count >= 0) {
                nodes = static_cast<std::size_t>(*count);
            }
        }
        return nodes;
    }

    // ---- [Data] ----

    std::size_t read_data(const CsvSection& section, Zone& zone) {
        const char* p = section.body.data();
        const char* end = p + section.body.size();
        std::string_view header;
        while (p < end) {
            const std::string_view line = text_.line_at(p);
            p = line.data() + line.size() + 1;
            if (const auto text = bare(line); !text.empty() && text.front() != '#') {
                header = line.substr(0, static_cast<std::size_t>(text.data() + text.size() - line.data()));
                break;
            }
        }
        if (header.empty()) {
            throw InputError("parse", "[Data] of zone '" + zone.name + "' is empty", text_.place_of(section.at, false),
                             "the file is cut short");
        }
        const char separator = separator_of(header);
        core::Problems found;
        const std::vector<CsvColumn> plans = plan_columns(header, separator, zone.name, text_, options_, found);
        for (auto& problem : found) {
            if (said_.insert(problem.message).second) {
                field_.problems.push_back(std::move(problem));
            }
        }
        const std::string_view block(std::min(p, end), static_cast<std::size_t>(end - std::min(p, end)));
        refuse_decimal_commas(block, separator);
        return fill(block, separator, plans, zone);
    }

    void refuse_decimal_commas(std::string_view block, char separator) const {
        const std::string_view line = separator == ',' ? std::string_view() : first_line(block);
        if (line.empty()) {
            return;
        }
        for (const auto cell : core::split(line, separator)) {
            std::string text(core::trimmed(cell));
            if (const auto comma = text.find(','); comma != std::string::npos) {
                text[comma] = '.';
                if (core::parse_number(text)) {
                    throw InputError(
                        "parse", "'" + std::string(core::trimmed(cell)) + "' has a decimal comma",
                        text_.place_of(cell.data()),
                        "a spreadsheet saved this file in its own language: export it again from CFD-Post, "
                        "or save it with decimal points and commas between the columns");
                }
            }
        }
    }

    std::size_t fill(std::string_view block, char separator, const std::vector<CsvColumn>& plans, Zone& zone) {
        const RowPlan rows = plan_rows(block, separator, plans.size(), false, progress_);
        const auto room = static_cast<vtkIdType>(rows.capacity());
        const std::array<bool, 3> has = coordinates_in(plans);
        const bool placed = has[0] && has[1];
        vtkNew<vtkDoubleArray> coordinates;
        if (placed) {
            coordinates->SetNumberOfComponents(3);
            coordinates->SetNumberOfTuples(room);
            (has[2] ? solid_ : flat_).push_back(zone.name);
            if (!has[2]) {
                std::fill_n(coordinates->GetPointer(0), 3 * room, 0.0);
            }
        }
        Arrays arrays;
        std::vector<ColumnTarget> targets;
        for (const auto& plan : plans) {
            ColumnTarget target{nullptr, 1, plan.conversion.scale, plan.conversion.offset};
            if (plan.coordinate >= 0 && placed) {
                target.base = coordinates->GetPointer(plan.coordinate);
                target.stride = 3;
            } else if (!plan.array.empty()) {
                target.base = arrays.place_for(plan, room, !has[2], zone);
                target.stride = plan.component < 0 ? 1 : 3;
            }
            targets.push_back(target);
        }
        const NumberRows read = parsed([&] { return parse_numbers(rows, separator, targets, progress_); });
        if (read.rows == 0) {
            throw InputError("parse", "[Data] of zone '" + zone.name + "' has no rows",
                             text_.place_of(block.data(), false), "the file is cut short");
        }
        report_missing(read, plans, zone);
        attach(read.rows, coordinates, arrays.in_order, zone);
        return read.rows;
    }

    /// The arrays of a block.
    struct Arrays {
        std::vector<vtkSmartPointer<vtkDoubleArray>> in_order;
        std::unordered_map<std::string, std::size_t> vectors;  ///< places in it, and in those of the zone, by name

        /// Where the values of a column begin. In a plane case vectors may lack a column: they are 0 there.
        double* place_for(const CsvColumn& plan, vtkIdType room, bool plane, Zone& zone) {
            const int components = plan.component < 0 ? 1 : 3;
            const auto [found, is_new] = vectors.emplace(plan.array, in_order.size());
            if (is_new) {
                auto array = vtkSmartPointer<vtkDoubleArray>::New();
                array->SetName(plan.array.c_str());
                array->SetNumberOfComponents(components);
                array->SetNumberOfTuples(room);
                in_order.push_back(array);
                zone.arrays.push_back({plan.array, plan.si_unit, plan.name, plan.unit, Location::nodes, components});
                if (components == 3 && plane) {
                    std::fill_n(array->GetPointer(0), 3 * room, 0.0);
                }
            } else {
                zone.arrays[found->second].original_name += ", " + plan.name;
            }
            return in_order[found->second]->GetPointer(std::max(plan.component, 0));
        }
    };

    void report_missing(const NumberRows& read, const std::vector<CsvColumn>& plans, const Zone& zone) {
        for (std::size_t c = 0; c < plans.size(); ++c) {
            if (read.missing[c] == 0) {
                continue;
            }
            const Place place = text_.place_of(read.first_missing[c]);
            if (plans[c].coordinate >= 0) {
                throw InputError("missing", "coordinate '" + plans[c].name + "' has no value here", place);
            }
            note(Severity::warning,
                 "zone '" + zone.name + "': " + std::to_string(read.missing[c]) + " of " + std::to_string(read.rows) +
                     " values of '" + plans[c].name + "' " +
                     (read.missing[c] == 1 ? "is missing, here" : "are missing, the first one here"),
                 place);
        }
    }

    void attach(std::size_t rows, vtkDoubleArray* coordinates,
                const std::vector<vtkSmartPointer<vtkDoubleArray>>& arrays, Zone& zone) {
        const auto count = static_cast<vtkIdType>(rows);
        const bool placed = coordinates->GetNumberOfTuples() > 0;
        if (placed) {
            coordinates->Resize(count);
            coordinates->SetNumberOfTuples(count);
            vtkNew<vtkPoints> points;
            points->SetDataTypeToDouble();
            points->SetData(coordinates);
            zone.surface->SetPoints(points);
        }
        for (const auto& array : arrays) {
            array->Resize(count);
            array->SetNumberOfTuples(count);
            if (placed) {
                zone.surface->GetPointData()->AddArray(array);
            } else {
                zone.surface->GetFieldData()->AddArray(array);
            }
        }
        zone.kind = placed ? ZoneKind::points : ZoneKind::other;
        zone.original_kind = placed ? "points" : "profile without coordinates";
    }

    // ---- [Faces], [Lines] ----

    void read_connectivity(const CsvSection* faces, const CsvSection* lines, std::size_t rows, bool last, Zone& zone) {
        const bool placed = zone.kind == ZoneKind::points;
        if (lines != nullptr && placed) {
            zone.surface->SetLines(read_indices(*lines, 2, rows, zone.name));
            zone.kind = ZoneKind::line;
            zone.original_kind = "line";
        }
        if (faces != nullptr && placed) {
            vtkSmartPointer<vtkCellArray> cells = read_indices(*faces, 3, rows, zone.name);
            zone.surface->SetPolys(cells);
            zone.kind = ZoneKind::unknown;
            zone.original_kind = "surface";
            check_faces(*faces, rows, last, zone);
        } else if (placed && lines == nullptr) {
            vtkNew<vtkCellArray> vertices;  // one cell of all points, so that they can be drawn
            vertices->InsertNextCell(static_cast<int>(rows));
            for (std::size_t i = 0; i < rows; ++i) {
                vertices->InsertCellPoint(static_cast<vtkIdType>(i));
            }
            zone.surface->SetVerts(vertices);
        }
    }

    vtkSmartPointer<vtkCellArray> read_indices(const CsvSection& section, std::size_t least, std::size_t nodes,
                                               const std::string& zone) {
        const char separator = separator_of(first_line(section.body));
        const RowPlan plan = plan_rows(section.body, separator, 1, true, progress_);
        vtkNew<vtkTypeInt64Array> offsets;
        vtkNew<vtkTypeInt64Array> connectivity;
        offsets->SetNumberOfValues(static_cast<vtkIdType>(plan.capacity() + 1));
        connectivity->SetNumberOfValues(static_cast<vtkIdType>(plan.entries()));
        const IndexRows read = parsed([&] {
            return parse_indices(plan, separator, least, offsets->GetPointer(0), connectivity->GetPointer(0),
                                 progress_);
        });
        if (read.rows == 0) {
            throw InputError("parse", "[" + section.word + "] of zone '" + zone + "' is empty",
                             text_.place_of(section.at, false), "the file is cut short");
        }
        if (read.largest >= static_cast<Index>(nodes)) {
            throw InputError("range",
                             "node " + std::to_string(read.largest) + " is missing: zone '" + zone + "' has " +
                                 std::to_string(nodes) + " nodes, numbered from 0 to " + std::to_string(nodes - 1),
                             text_.place_of(read.largest_at),
                             read.smallest == 1 && read.largest == static_cast<Index>(nodes)
                                 ? "the numbers seem to begin at 1: CFD-Post begins at 0"
                                 : "");
        }
        offsets->Resize(static_cast<vtkIdType>(read.rows + 1));
        offsets->SetNumberOfValues(static_cast<vtkIdType>(read.rows + 1));
        connectivity->Resize(static_cast<vtkIdType>(read.entries));
        connectivity->SetNumberOfValues(static_cast<vtkIdType>(read.entries));
        auto cells = vtkSmartPointer<vtkCellArray>::New();
        cells->SetData(offsets, connectivity);
        return cells;
    }

    /// Line of the `index`-th face, found again for a message.
    Place place_of_row(const CsvSection& section, std::size_t index) const {
        std::size_t row = 0;
        for (const auto line : core::split(section.body, '\n')) {
            const std::string_view text = bare(line);
            if (!text.empty() && text.front() != '#' && row++ == index) {
                return text_.place_of(line.data(), false);
            }
        }
        return text_.place_of(section.at, false);
    }

    void check_faces(const CsvSection& section, std::size_t rows, bool last, Zone& zone) {
        const SurfaceCheck check = check_surface(*zone.surface, progress_);
        if (check.zero_area > 0) {
            note(Severity::error,
                 "zone '" + zone.name + "': " + std::to_string(check.zero_area) + " face" +
                     (check.zero_area > 1 ? "s have" : " has") + " no area, the first one here",
                 place_of_row(section, check.first_zero_area));
        }
        if (check.unused_nodes > 0) {
            const std::string message =
                "zone '" + zone.name + "': " + core::counted_of(check.unused_nodes, rows, "node", "belongs", "belong") +
                " to no face";
            if (last && 200 * check.unused_nodes > rows) {
                throw InputError("parse", message + ": the file is cut short",
                                 text_.place_of(text_.text().data() + text_.text().size() - 1, false),
                                 "export it again");
            }
            note(Severity::warning, message, text_.place_of(section.at, false));
        }
        if (check.edges.inconsistent > 0) {
            const std::size_t turned = make_consistent(*zone.surface, progress_);
            note(Severity::warning,
                 "zone '" + zone.name + "': neighbouring faces run opposite ways; " + std::to_string(turned) +
                     " were turned to agree",
                 text_.place_of(section.at, false));
        }
        if (check.edges.non_manifold > 0) {
            note(Severity::warning,
                 "zone '" + zone.name + "': " + core::counted(check.edges.non_manifold, "edge has", "edges have") +
                     " more than two faces",
                 text_.place_of(section.at, false));
        }
    }

    /// A last line without its end may be whole (an editor) or the place where a copy broke off.
    void check_tail(const CsvBlock& block, const Zone& zone, bool last) {
        if (!last || text_.text().empty() || text_.text().back() == '\n') {
            return;
        }
        const char* tail = text_.text().data() + text_.text().size() - 1;
        const auto start = text_.text().rfind('\n');
        const auto before = start == std::string_view::npos || start == 0 ? start : text_.text().rfind('\n', start - 1);
        if (block.sections.back().word == "data" && before != std::string_view::npos) {
            const auto last_value = [](std::string_view line) {
                const auto comma = line.find_last_of(",;\t");
                return core::trimmed(comma == std::string_view::npos ? line : line.substr(comma + 1));
            };
            const auto cut = last_value(bare(text_.text().substr(start + 1)));
            const auto whole = last_value(bare(text_.text().substr(before + 1, start - before - 1)));
            if (whole.find_first_of("eE") != std::string_view::npos &&
                cut.find_first_of("eE") == std::string_view::npos && cut.size() < whole.size()) {
                throw InputError("parse", "the file ends in the middle of the number '" + std::string(cut) + "'",
                                 text_.place_of(tail), "the file is cut short: export it again");
            }
        }
        const bool faces = block.sections.back().word == "faces" && zone.surface->GetNumberOfPolys() > 0;
        const bool cut = faces && last_face_is_cut(*zone.surface, bare(text_.text().substr(start + 1)));
        note(cut ? Severity::error : Severity::warning,
             std::string("the file does not end with a line end: ") +
                 (cut ? "it is cut short within its last face, which its neighbours do not meet"
                      : "it may be cut short"),
             text_.place_of(tail, false));
    }

    void note_surfaces_without_faces() {
        const bool some = std::any_of(field_.zones.begin(), field_.zones.end(),
                                      [](const Zone& z) { return z.surface->GetNumberOfPolys() > 0; });
        for (const auto& zone : field_.zones) {
            if (zone.kind == ZoneKind::points) {
                note(some ? Severity::warning : Severity::note,
                     "zone '" + zone.name + "' has no [Faces]: points only, without areas no forces",
                     {field_.files[0], {}, {}, {}});
            }
        }
    }

    /// Coordinates x and y alone are those of a plane case, unless there is more in the file.
    void settle_dimension() {
        if (solid_.empty() && !flat_.empty()) {
            field_.dimension = 2;
        } else if (!flat_.empty()) {
            note(Severity::warning,
                 listed(flat_) + (flat_.size() > 1 ? " have" : " has") +
                     " no column Z beside zones that have one: taken to lie at z = 0",
                 {field_.files[0], {}, {}, {}});
        }
    }

    CsvText text_;
    const ReadOptions& options_;
    core::Progress& progress_;
    Field field_;
    std::vector<std::string> solid_, flat_;  ///< zones with and without z
    std::unordered_set<std::string> said_;   ///< of the columns: once a file, whatever the number of its blocks
    std::vector<std::string> names_;         ///< of all blocks
};

bool recognises(std::string_view head, const std::filesystem::path&) {
    for (const auto line : core::split(without_bom(head), '\n')) {
        const std::string_view text = bare(line);
        if (text.empty() || text.front() == '#') {
            continue;
        }
        return is_known_section(section_word(line));
    }
    return false;
}

Field read(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress) {
    Reader reader(path, options, progress);
    return telling([&] { return reader.read(); }, [&] { return reader.understood(); });
}

}  // namespace

Importer cfd_post_csv_importer() { return {"CFD-Post CSV", recognises, read}; }

}  // namespace underbody::postproc
