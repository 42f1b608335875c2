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
#include <cctype>
#include <cstring>
#include <optional>

#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/csv_rows.h"
#include "postproc/importers/importer.h"
#include "postproc/importers/understood.h"
#include "postproc/surface_check.h"

namespace underbody::postproc {

namespace {

using core::InputError;
using core::Place;
using core::Problem;
using Severity = Problem::Severity;

std::string_view without_bom(std::string_view text) {
    return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
}

/// A line without white space and the separators that spreadsheets put behind it.
std::string_view bare(std::string_view line) {
    line = core::trimmed(line);
    while (!line.empty() && (line.back() == ',' || line.back() == ';')) {
        line = core::trimmed(line.substr(0, line.size() - 1));
    }
    return line;
}

/// "name" of "[Name]", "" when the line is no section line.
std::string section_word(std::string_view line) {
    const std::string_view text = bare(line);
    if (text.size() < 3 || text.front() != '[' || text.back() != ']' || text.substr(1).find('[') != std::string_view::npos) {
        return {};
    }
    return core::lower_case(core::trimmed(text.substr(1, text.size() - 2)));
}

bool is_known_section(const std::string& word) {
    static constexpr std::array words = {"name", "parameters", "spatial fields", "data", "faces", "lines"};
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// What a header cell says.
struct HeaderCell {
    std::string name;
    std::string unit;
    bool has_unit = false;
    const char* at = nullptr;
};

HeaderCell header_cell(std::string_view text) {
    HeaderCell cell;
    cell.at = text.data();
    std::string_view trimmed = core::trimmed(text);
    if (trimmed.size() > 1 && trimmed.front() == '"' && trimmed.back() == '"') {
        trimmed = core::trimmed(trimmed.substr(1, trimmed.size() - 2));
    }
    const auto open = trimmed.rfind('[');
    if (open != std::string_view::npos && trimmed.back() == ']') {
        cell.name = core::trimmed(trimmed.substr(0, open));
        cell.unit = core::trimmed(trimmed.substr(open + 1, trimmed.size() - open - 2));
        cell.has_unit = !cell.unit.empty();
    } else {
        cell.name = trimmed;
    }
    return cell;
}

/// CFX writes C, F, R for temperatures, where UDUNITS reads coulomb, farad and a gas constant; pounds per square
/// foot it knows only spelt out.
std::string readable_unit(const std::string& unit) {
    if (unit == "C") {
        return "degC";
    }
    if (unit == "F") {
        return "degF";
    }
    if (unit == "R") {
        return "degR";
    }
    if (unit == "psf") {
        return "lbf ft^-2";
    }
    return unit;
}

int coordinate_index(const std::string& name) {
    std::string key = core::lower_case(name);
    if (key.starts_with("initial ")) {
        key = std::string(core::trimmed(std::string_view(key).substr(8)));
    }
    return key.size() == 1 && key[0] >= 'x' && key[0] <= 'z' ? key[0] - 'x' : -1;
}

/// One column of a block: what it becomes.
struct Plan {
    HeaderCell cell;
    int coordinate = -1;
    std::string array;    ///< canonical name, "" when the column is skipped
    int component = 0;
    std::string unit;     ///< SI
    core::Conversion conversion;
};

struct Section {
    std::string word;
    std::string_view body;  ///< behind the section line, up to the next one
    const char* at = nullptr;
};

struct Block {
    std::string name;
    const char* name_at = nullptr;
    bool named = false;  ///< by a [Name] line, which may be empty
    std::vector<Section> sections;
};

class Reader {
public:
    Reader(const std::filesystem::path& path, const ReadOptions& options, core::Progress& progress)
        : file_(path), options_(options), progress_(progress), text_(without_bom(file_.bytes())) {
        field_.files = {path.string()};
        field_.format = "CFD-Post CSV";
    }

    Field read() {
        const std::vector<Block> blocks = find_blocks();
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
        return std::move(field_);
    }

    [[nodiscard]] std::string understood() const {
        if (names_.empty()) {
            return "sections of CFD-Post, no list of zones yet";
        }
        std::string text = std::to_string(names_.size()) + (names_.size() == 1 ? " zone (" : " zones (") + listed(names_) + ")";
        for (const auto& zone : field_.zones) {
            text += (&zone == &field_.zones.front() ? "; read " : ", ") + zone.name + " with " + std::to_string(zone.surface->GetNumberOfPoints()) + " nodes, " +
                    std::to_string(zone.surface->GetNumberOfPolys()) + " faces";
        }
        return text;
    }

private:
    Place place_of(const char* at, bool with_column = true) const {
        const std::string_view before(file_.bytes().data(), static_cast<std::size_t>(at - file_.bytes().data()));
        const auto line = std::count(before.begin(), before.end(), '\n') + 1;
        const auto start = before.rfind('\n');
        Place place{field_.files[0], line, {}, {}};
        if (with_column) {
            place.column = static_cast<std::int64_t>(start == std::string_view::npos ? before.size() : before.size() - start - 1) + 1;
        }
        return place;
    }

    template <typename F>
    auto parsed(F&& parse) const {
        try {
            return parse();
        } catch (const RowError& error) {
            throw InputError("parse", error.message, place_of(error.at), error.hint);
        }
    }

    void note(Severity severity, std::string message, Place place) {
        field_.problems.push_back({severity, std::move(message), std::move(place)});
    }

    std::string_view line_at(const char* p) const {
        const char* end = text_.data() + text_.size();
        const void* found = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
        return {p, static_cast<std::size_t>((found == nullptr ? end : static_cast<const char*>(found)) - p)};
    }

    /// The next line, from `p` on, that begins a section; the end of the text when there is none.
    const char* next_section(const char* p) const {
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

    std::vector<Block> find_blocks() {
        std::vector<Block> blocks;
        const char* end = text_.data() + text_.size();
        const char* p = next_section(text_.data());
        while (p < end) {
            progress_.check();
            const std::string_view line = line_at(p);
            Section section{section_word(line), {}, p};
            const char* body = std::min(end, line.data() + line.size() + 1);
            p = next_section(body);
            section.body = {body, static_cast<std::size_t>(p - body)};
            if (section.word == "name") {
                blocks.push_back({std::string(first_line(section.body)), section.at, true, {}});
            } else if (blocks.empty()) {
                blocks.push_back({"", section.at, false, {}});  // a profile whose [Name] was cut away
            }
            if (!is_known_section(section.word)) {
                note(Severity::warning, "section [" + section.word + "] is not known and was left out", place_of(section.at, false));
            } else if (section.word != "name") {
                blocks.back().sections.push_back(section);
            }
        }
        check_names(blocks);
        return blocks;
    }

    static std::string_view first_line(std::string_view body) {
        for (const auto line : core::split(body, '\n')) {
            const std::string_view text = bare(line);
            if (!text.empty() && text.front() != '#') {
                return text;
            }
        }
        return {};
    }

    void check_names(std::vector<Block>& blocks) const {
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            if (blocks[i].name.empty()) {
                if (blocks[i].named) {
                    throw InputError("zone", "[Name] without a name", place_of(blocks[i].name_at, false));
                }
                blocks[i].name = std::filesystem::path(field_.files[0]).stem().string();
            }
            for (std::size_t j = 0; j < i; ++j) {
                if (blocks[j].name == blocks[i].name) {
                    throw InputError("zone", "two zones are called '" + blocks[i].name + "'", place_of(blocks[i].name_at, false),
                                     "the first stands in line " + std::to_string(*place_of(blocks[j].name_at).line));
                }
            }
        }
    }

    void read_block(const Block& block, bool last) {
        const Section* data = nullptr;
        const Section* faces = nullptr;
        const Section* lines = nullptr;
        std::optional<std::size_t> stated_rows;
        for (const auto& section : block.sections) {
            const Section** slot = section.word == "data" ? &data : section.word == "faces" ? &faces : section.word == "lines" ? &lines : nullptr;
            if (slot != nullptr && *slot != nullptr) {
                throw InputError("parse", "zone '" + block.name + "' has a second [" + section.word + "]", place_of(section.at, false));
            }
            if (slot != nullptr) {
                *slot = &section;
            } else if (section.word == "parameters") {
                stated_rows = read_parameters(block.name, section.body);
            }
        }
        if (data == nullptr) {
            throw InputError("parse", "zone '" + block.name + "' has no [Data]", place_of(block.name_at, false), "the file is cut short or damaged");
        }
        Zone zone;
        zone.name = block.name;
        zone.id = static_cast<int>(field_.zones.size()) + 1;
        zone.surface = vtkSmartPointer<vtkPolyData>::New();
        zone.normals_into_fluid = false;
        const std::size_t rows = read_data(*data, zone);
        if (stated_rows && *stated_rows != rows) {
            throw InputError("parse", "zone '" + block.name + "' has " + std::to_string(rows) + " rows, its parameter Nnodes says " +
                             std::to_string(*stated_rows), place_of(data->at, false), "the file is cut short or damaged");
        }
        read_connectivity(faces, lines, rows, last, zone);
        check_tail(block, last);
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

    char separator_of(std::string_view header) const {
        std::array<std::size_t, 3> counts{};
        static constexpr std::array<char, 3> separators = {',', ';', '\t'};
        for (std::size_t i = 0; i < separators.size(); ++i) {
            counts[i] = static_cast<std::size_t>(std::count(header.begin(), header.end(), separators[i]));
        }
        return separators[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin())];
    }

    std::size_t read_data(const Section& section, Zone& zone) {
        const char* p = section.body.data();
        const char* end = p + section.body.size();
        std::string_view header;
        while (p < end) {
            const std::string_view line = line_at(p);
            p = line.data() + line.size() + 1;
            if (const auto text = bare(line); !text.empty() && text.front() != '#') {
                header = line.substr(0, static_cast<std::size_t>(text.data() + text.size() - line.data()));
                break;
            }
        }
        if (header.empty()) {
            throw InputError("parse", "[Data] of zone '" + zone.name + "' is empty", place_of(section.at, false), "the file is cut short");
        }
        const char separator = separator_of(header);
        std::vector<Plan> plans = plan_columns(header, separator, zone.name);
        const std::string_view block(std::min(p, end), static_cast<std::size_t>(end - std::min(p, end)));
        refuse_decimal_commas(block, separator);
        return fill(block, separator, plans, zone);
    }

    void refuse_decimal_commas(std::string_view block, char separator) const {
        const std::string_view line = first_line(block);
        if (separator == ',' || line.empty()) {
            return;
        }
        for (const auto cell : core::split(line, separator)) {
            std::string text(core::trimmed(cell));
            if (const auto comma = text.find(','); comma != std::string::npos) {
                text[comma] = '.';
                if (core::parse_number(text)) {
                    throw InputError("parse", "'" + std::string(core::trimmed(cell)) + "' has a decimal comma", place_of(cell.data()),
                                     "a spreadsheet saved this file in its own language: export it again from CFD-Post, "
                                     "or save it with decimal points and commas between the columns");
                }
            }
        }
    }

    std::vector<Plan> plan_columns(std::string_view header, char separator, const std::string& zone) {
        std::vector<Plan> plans;
        for (const auto text : core::split(header, separator)) {
            Plan plan;
            plan.cell = header_cell(text);
            if (plan.cell.name.empty()) {
                throw InputError("parse", "a column of zone '" + zone + "' has no name", place_of(text.data()));
            }
            for (const auto& [name, unit] : options_.units) {
                if (!plan.cell.has_unit && core::lower_case(name) == core::lower_case(plan.cell.name)) {
                    plan.cell.unit = unit;
                    plan.cell.has_unit = true;
                }
            }
            plans.push_back(std::move(plan));
        }
        const bool plain = std::any_of(plans.begin(), plans.end(), [](const Plan& p) { return p.cell.name.size() == 1 && coordinate_index(p.cell.name) >= 0; });
        for (std::size_t i = 0; i < plans.size(); ++i) {
            const bool repeated = std::any_of(plans.begin(), plans.begin() + static_cast<std::ptrdiff_t>(i), [&](const Plan& p) {
                return core::lower_case(p.cell.name) == core::lower_case(plans[i].cell.name);
            });
            if (repeated) {
                note(Severity::note, "column '" + plans[i].cell.name + "' is repeated: the first one counts", place_of(plans[i].cell.at));
                continue;
            }
            const int coordinate = coordinate_index(plans[i].cell.name);
            if (coordinate >= 0 && (!plain || plans[i].cell.name.size() == 1)) {
                plan_coordinate(plans[i], coordinate);
            } else if (core::lower_case(plans[i].cell.name) != "node number") {
                plan_array(plans[i]);
            }
        }
        join_components(plans);
        note_mixed_units(plans);
        return plans;
    }

    void plan_coordinate(Plan& plan, int coordinate) {
        std::string unit = plan.cell.unit;
        if (!plan.cell.has_unit) {
            unit = options_.length_unit;
            if (unit.empty()) {
                throw InputError("unit", "coordinate '" + plan.cell.name + "' has no unit", place_of(plan.cell.at),
                                 "say it with --length-unit mm (or m, inch, ...)");
            }
        }
        plan.coordinate = coordinate;
        plan.conversion = core::conversion(unit, "m", place_of(plan.cell.at));
        plan.unit = "m";
    }

    void plan_array(Plan& plan) {
        const Place place = place_of(plan.cell.at);
        CanonicalName canonical = canonical_name(plan.cell.name);
        if (vector_component(canonical.name + "_x")) {
            canonical.name += "_magnitude";  // CFX calls the size of a vector by the vector's name
        }
        const std::string& dimension = canonical.unit;
        const std::string unit = readable_unit(plan.cell.unit);
        if (!dimension.empty() && !plan.cell.has_unit && dimension != "1") {
            if (canonical.name == "pressure" || canonical.name.starts_with("wall_shear")) {
                throw InputError("unit", "column '" + plan.cell.name + "' has no unit", place,
                                 "say it with --unit \"" + plan.cell.name + "=" + dimension + "\"");
            }
            note(Severity::warning, "column '" + plan.cell.name + "' has no unit: kept as a pure number", place);
            plan.array = plan.cell.name;
            plan.unit = "1";
            return;
        }
        plan.array = canonical.name;
        if (!dimension.empty()) {
            plan.conversion = core::conversion(plan.cell.has_unit ? unit : "1", dimension, place);
            plan.unit = dimension;
        } else if (!plan.cell.has_unit) {
            plan.unit = "1";
        } else if (core::is_unit(unit)) {
            plan.unit = core::si_unit(unit, place);
            plan.conversion = core::conversion(unit, plan.unit, place);
        } else {
            note(Severity::warning, "unit '" + unit + "' of column '" + plan.cell.name + "' is not known: values are kept as they are", place);
            plan.unit = unit;
        }
    }

    /// Three columns x, y, z of a vector become one array; two columns of one meaning keep their own names.
    static void join_components(std::vector<Plan>& plans) {
        for (std::size_t i = 0; i < plans.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                if (!plans[i].array.empty() && plans[j].array == plans[i].array) {
                    plans[i].array = plans[i].cell.name;
                }
            }
        }
        for (auto& plan : plans) {
            const auto component = vector_component(plan.array);
            if (!component) {
                continue;
            }
            std::array<Plan*, 3> found{};
            for (auto& other : plans) {
                const auto of = vector_component(other.array);
                if (of && of->vector == component->vector) {
                    found[static_cast<std::size_t>(of->index)] = &other;
                }
            }
            if (found[0] != nullptr && found[1] != nullptr && found[2] != nullptr) {
                for (std::size_t k = 0; k < 3; ++k) {
                    found[k]->array = component->vector;
                    found[k]->component = static_cast<int>(k);
                }
            }
        }
    }

    void note_mixed_units(const std::vector<Plan>& plans) {
        const Plan* first = nullptr;
        for (const auto& plan : plans) {
            if (plan.coordinate < 0) {
                continue;
            }
            if (first != nullptr && first->cell.unit != plan.cell.unit) {
                note(Severity::warning, "coordinates have different units: '" + first->cell.name + "' in " + first->cell.unit + ", '" +
                     plan.cell.name + "' in " + plan.cell.unit + "; each was converted by its own", place_of(plan.cell.at));
            }
            first = first == nullptr ? &plan : first;
        }
    }

    bool wanted(const Plan& plan) const {
        if (options_.arrays.empty()) {
            return true;
        }
        return std::any_of(options_.arrays.begin(), options_.arrays.end(), [&](const std::string& name) {
            return core::lower_case(name) == core::lower_case(plan.cell.name) || core::lower_case(name) == core::lower_case(plan.array);
        });
    }

    std::size_t fill(std::string_view block, char separator, const std::vector<Plan>& plans, Zone& zone) {
        const RowPlan rows = plan_rows(block, separator, plans.size(), false, progress_);
        const auto room = static_cast<vtkIdType>(rows.capacity());
        const std::array<bool, 3> has = coordinates_in(plans);
        vtkNew<vtkDoubleArray> coordinates;
        if (has[0] && has[1]) {
            coordinates->SetNumberOfComponents(3);
            coordinates->SetNumberOfTuples(room);
            if (!has[2]) {
                std::fill_n(coordinates->GetPointer(0), 3 * room, 0.0);
                field_.dimension = 2;
            }
        }
        std::vector<vtkSmartPointer<vtkDoubleArray>> arrays;
        std::vector<ColumnTarget> targets;
        for (const auto& plan : plans) {
            ColumnTarget target{nullptr, 1, plan.conversion.scale, plan.conversion.offset};
            if (plan.coordinate >= 0 && has[0] && has[1]) {
                target.base = coordinates->GetPointer(plan.coordinate);
                target.stride = 3;
            } else if (!plan.array.empty() && wanted(plan)) {
                auto array = array_for(plan, plans, room, arrays, zone);
                target.base = array->GetPointer(plan.component);
                target.stride = static_cast<std::size_t>(array->GetNumberOfComponents());
            } else if (plan.coordinate >= 0) {
                Plan radial = plan;  // a coordinate of a profile that has no place in space
                radial.array = plan.cell.name;
                target.base = array_for(radial, plans, room, arrays, zone)->GetPointer(0);
            }
            targets.push_back(target);
        }
        const NumberRows read = parsed([&] { return parse_numbers(rows, separator, targets, progress_); });
        if (read.rows == 0) {
            throw InputError("parse", "[Data] of zone '" + zone.name + "' has no rows", place_of(block.data(), false), "the file is cut short");
        }
        report_missing(read, plans, zone);
        attach(read.rows, coordinates, arrays, zone);
        return read.rows;
    }

    static std::array<bool, 3> coordinates_in(const std::vector<Plan>& plans) {
        std::array<bool, 3> has{};
        for (const auto& plan : plans) {
            if (plan.coordinate >= 0) {
                has[static_cast<std::size_t>(plan.coordinate)] = true;
            }
        }
        return has;
    }

    static vtkSmartPointer<vtkDoubleArray> array_for(const Plan& plan, const std::vector<Plan>& plans, vtkIdType room,
                                                     std::vector<vtkSmartPointer<vtkDoubleArray>>& arrays, Zone& zone) {
        for (const auto& array : arrays) {
            if (plan.array == array->GetName()) {
                return array;
            }
        }
        const auto components = std::count_if(plans.begin(), plans.end(), [&](const Plan& p) { return p.array == plan.array; });
        auto array = vtkSmartPointer<vtkDoubleArray>::New();
        array->SetName(plan.array.c_str());
        array->SetNumberOfComponents(components == 3 ? 3 : 1);
        array->SetNumberOfTuples(room);
        arrays.push_back(array);
        zone.arrays.push_back({plan.array, plan.unit, plan.cell.name, plan.cell.unit, Location::nodes, components == 3 ? 3 : 1});
        return array;
    }

    void report_missing(const NumberRows& read, const std::vector<Plan>& plans, const Zone& zone) {
        for (std::size_t c = 0; c < plans.size(); ++c) {
            if (read.missing[c] == 0) {
                continue;
            }
            const Place place = place_of(read.first_missing[c]);
            if (plans[c].coordinate >= 0) {
                throw InputError("missing", "coordinate '" + plans[c].cell.name + "' has no value here", place);
            }
            note(Severity::warning, "zone '" + zone.name + "': " + std::to_string(read.missing[c]) + " of " + std::to_string(read.rows) +
                 " values of '" + plans[c].cell.name + "' are missing, the first one here", place);
        }
    }

    void attach(std::size_t rows, vtkDoubleArray* coordinates, const std::vector<vtkSmartPointer<vtkDoubleArray>>& arrays, Zone& zone) {
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

    void read_connectivity(const Section* faces, const Section* lines, std::size_t rows, bool last, Zone& zone) {
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

    vtkSmartPointer<vtkCellArray> read_indices(const Section& section, std::size_t least, std::size_t nodes, const std::string& zone) {
        const char separator = separator_of(first_line(section.body));
        const RowPlan plan = plan_rows(section.body, separator, 1, true, progress_);
        vtkNew<vtkTypeInt64Array> offsets;
        vtkNew<vtkTypeInt64Array> connectivity;
        offsets->SetNumberOfValues(static_cast<vtkIdType>(plan.capacity() + 1));
        connectivity->SetNumberOfValues(static_cast<vtkIdType>(plan.entries()));
        const IndexRows read = parsed([&] {
            return parse_indices(plan, separator, least, offsets->GetPointer(0), connectivity->GetPointer(0), progress_);
        });
        if (read.rows == 0) {
            throw InputError("parse", "[" + section.word + "] of zone '" + zone + "' is empty", place_of(section.at, false), "the file is cut short");
        }
        if (read.largest >= static_cast<Index>(nodes)) {
            throw InputError("range", "node " + std::to_string(read.largest) + " is missing: zone '" + zone + "' has " +
                             std::to_string(nodes) + " nodes, numbered from 0 to " + std::to_string(nodes - 1),
                             place_of(read.largest_at), read.smallest == 1 && read.largest == static_cast<Index>(nodes)
                             ? "the numbers seem to begin at 1: CFD-Post begins at 0" : "");
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
    Place place_of_row(const Section& section, std::size_t index) const {
        std::size_t row = 0;
        for (const auto line : core::split(section.body, '\n')) {
            const std::string_view text = bare(line);
            if (!text.empty() && text.front() != '#' && row++ == index) {
                return place_of(line.data(), false);
            }
        }
        return place_of(section.at, false);
    }

    void check_faces(const Section& section, std::size_t rows, bool last, Zone& zone) {
        const SurfaceCheck check = check_surface(*zone.surface, progress_);
        if (check.zero_area > 0) {
            note(Severity::error, "zone '" + zone.name + "': " + std::to_string(check.zero_area) + " face" + (check.zero_area > 1 ? "s have" : " has") +
                 " no area, the first one here", place_of_row(section, check.first_zero_area));
        }
        if (check.unused_nodes > 0) {
            const std::string message = "zone '" + zone.name + "': " + std::to_string(check.unused_nodes) + " of " + std::to_string(rows) + " nodes belong to no face";
            if (last && 200 * check.unused_nodes > rows) {
                throw InputError("parse", message + ": the file is cut short", place_of(text_.data() + text_.size() - 1, false), "export it again");
            }
            note(Severity::warning, message, place_of(section.at, false));
        }
        if (check.edges.inconsistent > 0) {
            const std::size_t turned = make_consistent(*zone.surface, progress_);
            note(Severity::warning, "zone '" + zone.name + "': neighbouring faces run opposite ways; " + std::to_string(turned) + " were turned to agree",
                 place_of(section.at, false));
        }
        if (check.edges.non_manifold > 0) {
            note(Severity::warning, "zone '" + zone.name + "': " + std::to_string(check.edges.non_manifold) + " edges have more than two faces",
                 place_of(section.at, false));
        }
    }

    /// A last line without its end may be whole (an editor) or the place where a copy broke off.
    void check_tail(const Block& block, bool last) {
        if (!last || text_.empty() || text_.back() == '\n') {
            return;
        }
        const char* tail = text_.data() + text_.size() - 1;
        const auto start = text_.rfind('\n');
        const auto before = start == std::string_view::npos || start == 0 ? start : text_.rfind('\n', start - 1);
        if (block.sections.back().word == "data" && before != std::string_view::npos) {
            const auto last_value = [](std::string_view line) {
                const auto comma = line.find_last_of(",;\t");
                return core::trimmed(comma == std::string_view::npos ? line : line.substr(comma + 1));
            };
            const auto cut = last_value(bare(text_.substr(start + 1)));
            const auto whole = last_value(bare(text_.substr(before + 1, start - before - 1)));
            if (whole.find_first_of("eE") != std::string_view::npos && cut.find_first_of("eE") == std::string_view::npos && cut.size() < whole.size()) {
                throw InputError("parse", "the file ends in the middle of the number '" + std::string(cut) + "'", place_of(tail), "the file is cut short: export it again");
            }
        }
        note(Severity::warning, "the file does not end with a line end: it may be cut short", place_of(tail, false));
    }

    void note_surfaces_without_faces() {
        const bool some = std::any_of(field_.zones.begin(), field_.zones.end(), [](const Zone& z) { return z.surface->GetNumberOfPolys() > 0; });
        for (const auto& zone : field_.zones) {
            if (zone.kind == ZoneKind::points) {
                note(some ? Severity::warning : Severity::note, "zone '" + zone.name + "' has no [Faces]: points only, without areas no forces",
                     {field_.files[0], {}, {}, {}});
            }
        }
    }

    core::MappedFile file_;
    const ReadOptions& options_;
    core::Progress& progress_;
    std::string_view text_;
    Field field_;
    std::vector<std::string> names_;  ///< of all blocks
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
