#include "cases/design_points.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/file.h"
#include "core/lines.h"
#include "core/mistyped.h"
#include "core/text.h"
#include "core/units.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

/// Cells of a line; quotes keep separators, two quotes are one.
std::vector<std::string> cells_of(std::string_view line, char separator) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
            cells.back() += line[++i];
        } else if (line[i] == '"') {
            quoted = !quoted;
        } else if (line[i] == separator && !quoted) {
            cells.emplace_back();
        } else {
            cells.back() += line[i];
        }
    }
    for (auto& cell : cells) {
        cell = std::string(core::trimmed(cell));
    }
    return cells;
}

/// "P1", "P12": what Workbench calls a parameter.
bool is_id(const std::string& text) {
    return text.size() > 1 && text.front() == 'P' &&
           std::all_of(text.begin() + 1, text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// "P1 - gap [mm]", "P1", "gap [mm]".
DesignParameter parameter_of(const std::string& cell) {
    DesignParameter parameter;
    std::string rest = cell;
    if (const auto open = rest.rfind('['); open != std::string::npos && rest.back() == ']') {
        parameter.unit = std::string(core::trimmed(std::string_view(rest).substr(open + 1, rest.size() - open - 2)));
        rest = std::string(core::trimmed(std::string_view(rest).substr(0, open)));
    }
    const auto dash = rest.find(" - ");
    if (dash != std::string::npos && is_id(rest.substr(0, dash))) {
        parameter.id = rest.substr(0, dash);
        parameter.name = std::string(core::trimmed(std::string_view(rest).substr(dash + 3)));
    } else if (is_id(rest)) {
        parameter.id = rest;
    } else {
        parameter.name = rest;
    }
    return parameter;
}

/// Workbench's words for units that UDUNITS calls otherwise.
std::string unit_of(const std::string& unit) {
    static const std::map<std::string, std::string> other = {
        {"C", "degC"}, {"F", "degF"}, {"rev min^-1", "rpm"}, {"dimensionless", "1"}, {"", ""}};
    const auto found = other.find(unit);
    return found == other.end() ? unit : found->second;
}

/// The quantity that a name stands for among those who set up such cases; empty: none.
std::string usual_quantity(const std::string& name) {
    const std::string key = core::plain_name(name);
    return condition_unit(key) ? key : core::other_name_of(key, core::Likeness::certain);
}

bool is_result(const std::string& name) {
    const std::string key = core::plain_name(name);
    return key.ends_with("_op") || key.ends_with("_force") || key.ends_with("_moment") || key == "lift" ||
           key == "drag" || key.starts_with("report_");
}

class Reader {
public:
    Reader(fs::path file, const std::map<std::string, std::string>& mapping)
        : file_(std::move(file)), mapping_(mapping) {}

    DesignPoints read() {
        std::string text = core::read_file(file_);
        text.erase(0, text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
        core::for_each_line(text, [this](std::int64_t number, std::string_view line) {
            if (line.front() == '#') {
                remember_names(line.substr(1));
            } else if (header_.empty()) {
                read_header(line, number);
            } else {
                read_row(line, number);
            }
        });
        if (header_.empty() || rows_.empty()) {
            throw core::InputError("format", "there is no table of design points in this file",
                                   {file_.string(), {}, {}, {}},
                                   "Workbench writes one by 'Export Table Data as CSV' of its Table of Design Points");
        }
        choose_conditions();
        return std::move(result_);
    }

private:
    struct Row {
        std::string name;
        std::int64_t line;
        std::vector<double> values;
    };

    [[nodiscard]] core::Place at(std::int64_t line) const { return {file_.string(), line, {}, {}}; }

    /// "# ,P1 - gap [mm],P2 - speed [m s^-1]"
    void remember_names(std::string_view comment) {
        for (const char separator : {',', ';'}) {
            for (const auto& cell : cells_of(comment, separator)) {
                const DesignParameter parameter = parameter_of(cell);
                if (!parameter.id.empty() && !parameter.name.empty()) {
                    named_[parameter.id] = parameter;
                }
            }
        }
    }

    void read_header(std::string_view line, std::int64_t number) {
        separator_ = line.find(';') != std::string_view::npos && line.find(',') == std::string_view::npos ? ';' : ',';
        header_ = cells_of(line, separator_);
        if (header_.size() < 2) {
            throw core::InputError(
                "format",
                "a line with the names of the parameters is expected, found '" + std::string(line.substr(0, 40)) + "'",
                at(number), "Name,P1,P2 or Name,P1 - gap [mm],P2 - speed [m s^-1]");
        }
        for (std::size_t c = 1; c < header_.size(); ++c) {
            DesignParameter parameter = parameter_of(header_[c]);
            if (const auto known = named_.find(parameter.id); known != named_.end() && parameter.name.empty()) {
                parameter = known->second;
            }
            if (!parameter.id.empty() && !seen_.insert(parameter.id).second) {
                throw core::InputError("duplicate", "the parameter " + parameter.id + " stands twice in the header",
                                       at(number));
            }
            result_.parameters.push_back(std::move(parameter));
        }
    }

    void read_row(std::string_view line, std::int64_t number) {
        auto cells = cells_of(line, separator_);
        while (cells.size() > header_.size() && cells.back().empty()) {
            cells.pop_back();
        }
        if (cells.size() != header_.size()) {
            throw core::InputError("format",
                                   "a row of " + std::to_string(cells.size()) + " cells where the header has " +
                                       std::to_string(header_.size()),
                                   at(number));
        }
        if (rows_.empty() && core::lower_case(cells.front()) == "units") {
            for (std::size_t c = 1; c < cells.size(); ++c) {
                auto& unit = result_.parameters[c - 1].unit;
                unit = unit.empty() ? cells[c] : unit;
            }
            return;
        }
        Row row{cells.front(), number, {}};
        for (std::size_t c = 1; c < cells.size(); ++c) {
            if (separator_ == ';') {
                std::replace(cells[c].begin(), cells[c].end(), ',', '.');
            }
            // Results of a point that was not updated are empty, or marked.
            const auto value = core::parse_number(cells[c]);
            row.values.push_back(value.value_or(std::nan("")));
            if (!value && !cells[c].empty()) {
                texts_[{rows_.size(), c - 1}] = cells[c];
            }
        }
        rows_.push_back(std::move(row));
    }

    [[nodiscard]] std::string label(const DesignParameter& parameter) const {
        return "'" + parameter.id + (parameter.id.empty() || parameter.name.empty() ? "" : " - ") + parameter.name +
               "'";
    }

    [[nodiscard]] std::optional<std::string> mapped(const DesignParameter& parameter) const {
        for (const auto& [key, value] : mapping_) {
            if ((!key.empty() && key == parameter.id) || key == parameter.name) {
                return value;
            }
        }
        return {};
    }

    [[nodiscard]] bool varies(std::size_t column) const {
        return std::any_of(rows_.begin(), rows_.end(),
                           [&](const Row& row) { return row.values[column] != rows_.front().values[column]; });
    }

    void choose_conditions() {
        check_mapping();
        std::vector<std::string> unknown;
        std::vector<std::string> left_out;
        for (std::size_t c = 0; c < result_.parameters.size(); ++c) {
            DesignParameter& parameter = result_.parameters[c];
            if (auto told = mapped(parameter)) {
                const DesignParameter meant = parameter_of(*told);
                parameter.quantity = meant.name;
                parameter.unit = meant.unit.empty() ? parameter.unit : meant.unit;
            } else if (!is_result(parameter.name)) {
                parameter.quantity = usual_quantity(parameter.name);
            }
            if (parameter.quantity.empty() && !mapped(parameter)) {
                const bool matters = !is_result(parameter.name) && mapping_.empty() && varies(c);
                (matters ? unknown : left_out).push_back(label(parameter));
            }
        }
        std::map<std::string, std::string> taken;
        for (const auto& parameter : result_.parameters) {
            const auto [other, fresh] = taken.emplace(parameter.quantity, label(parameter));
            if (!fresh && !parameter.quantity.empty()) {
                throw core::InputError(
                    "duplicate", other->second + " and " + label(parameter) + " are both " + parameter.quantity,
                    {file_.string(), {}, {}, {}},
                    "say which one is: parameters = { P1 = \"" + parameter.quantity + "\", P2 = \"\" }");
            }
        }
        if (!unknown.empty()) {
            throw core::InputError(
                "name",
                "it is not known which quantity " + joined(unknown) +
                    (unknown.size() == 1 ? " is, and it varies" : " are, and they vary") + " from point to point",
                {file_.string(), {}, {}, {}},
                "say it for each: parameters = { P1 = \"gap\", P2 = \"\" }, where nothing leaves a parameter out");
        }
        if (!left_out.empty()) {
            result_.notes.push_back({core::Problem::Severity::note,
                                     "no conditions of the cases: " + joined(left_out),
                                     {file_.string(), {}, {}, {}}});
        }
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            add_point(row);
        }
    }

    void check_mapping() const {
        for (const auto& [key, value] : mapping_) {
            std::vector<std::string> known;
            bool found = false;
            for (const auto& parameter : result_.parameters) {
                found = found || key == parameter.id || key == parameter.name;
                known.push_back(parameter.id.empty() ? parameter.name : parameter.id);
            }
            if (!found) {
                throw core::InputError("name", "the table of design points has no parameter '" + key + "'",
                                       {file_.string(), {}, {}, {}}, core::did_you_mean(key, known));
            }
        }
    }

    void add_point(std::size_t row) {
        const Row& from = rows_[row];
        DesignPoint point;
        point.name = from.name;
        const auto digit = from.name.find_first_of("0123456789");
        const std::string_view rest =
            digit == std::string::npos ? std::string_view() : std::string_view(from.name).substr(digit);
        const auto number = core::parse_integer(rest.substr(0, rest.find_first_not_of("0123456789")));
        if (!number) {
            throw core::InputError("format", "'" + from.name + "' is no name of a design point", at(from.line),
                                   "DP 0, DP 1, ... are");
        }
        point.number = static_cast<int>(*number);
        if (result_.find(point.number) != nullptr) {
            throw core::InputError("duplicate", "'" + from.name + "' stands twice in the table", at(from.line));
        }
        for (std::size_t c = 0; c < result_.parameters.size(); ++c) {
            const DesignParameter& parameter = result_.parameters[c];
            if (parameter.quantity.empty()) {
                continue;
            }
            if (const auto text = texts_.find({row, c}); text != texts_.end()) {
                throw core::InputError("parse",
                                       "'" + text->second + "' is no number: " + label(parameter) + " of " + from.name,
                                       at(from.line));
            }
            if (std::isnan(from.values[c])) {
                throw core::InputError("missing", label(parameter) + " of " + from.name + " is missing", at(from.line));
            }
            point.conditions.set(parameter.quantity, in_si(parameter, from.values[c], from.line),
                                 unit_of(parameter.unit));
        }
        result_.points.push_back(std::move(point));
    }

    [[nodiscard]] double in_si(const DesignParameter& parameter, double value, std::int64_t line) const {
        const auto known = condition_unit(parameter.quantity);
        const std::string unit = unit_of(parameter.unit);
        const std::string si = known.value_or("1");
        if (unit.empty() && si != "1") {
            throw core::InputError(
                "unit", label(parameter) + " has no unit", at(line),
                "say it where the parameter is named: " + (parameter.id.empty() ? parameter.name : parameter.id) +
                    " = \"" + parameter.quantity + " [" + si + "]\"");
        }
        if (!known && !unit.empty() && !core::is_unit(unit)) {
            throw core::InputError("unit", "'" + parameter.unit + "' of " + label(parameter) + " is no known unit",
                                   at(line));
        }
        if (unit.empty()) {
            return value;
        }
        return core::convert(value, unit, known ? si : core::si_unit(unit), at(line));
    }

    static std::string joined(const std::vector<std::string>& texts) {
        std::string all;
        for (const auto& text : texts) {
            all += (all.empty() ? "" : ", ") + text;
        }
        return all;
    }

    fs::path file_;
    const std::map<std::string, std::string>& mapping_;
    DesignPoints result_;
    std::map<std::string, DesignParameter> named_;  ///< by id, from the comments
    std::set<std::string> seen_;
    std::vector<std::string> header_;
    std::vector<Row> rows_;
    std::map<std::pair<std::size_t, std::size_t>, std::string> texts_;  ///< cells that are no numbers
    char separator_ = ',';
};

}  // namespace

namespace {

/// Of a word of the user's own; else nothing.
std::string written_unit(const Conditions& conditions, const std::string& name) {
    return condition_unit(name) ? "" : conditions.shown_unit(name);
}

}  // namespace

const DesignPoint* DesignPoints::find(int number) const {
    const auto found =
        std::find_if(points.begin(), points.end(), [&](const DesignPoint& point) { return point.number == number; });
    return found == points.end() ? nullptr : &*found;
}

DesignPoints read_design_points(const fs::path& file, const std::map<std::string, std::string>& mapping) {
    return Reader(file, mapping).read();
}

DesignPointCases::DesignPointCases(const core::TomlTable& table) {
    const core::TomlTable parameters = table.table_or_empty("parameters");
    if (!table.has("design_points")) {
        if (table.has("parameters")) {
            throw core::InputError("missing", "parameters belong to a table of design points, and there is none",
                                   table.place("parameters"), "design_points = \"points.csv\"");
        }
        return;
    }
    std::map<std::string, std::string> mapping;
    for (const auto& key : parameters.keys()) {
        mapping[key] = parameters.string(key);
    }
    place_ = table.place("files");
    points_ = read_design_points(table.file("design_points"), mapping);
    if (table.string("files").find("{design_point}") == std::string::npos) {
        throw core::InputError("missing", "the pattern does not say where the number of the design point stands",
                               place_, "files = \"NAME_files/dp{design_point}/FFF/Fluent/*.dat.h5\"");
    }
}

bool DesignPointCases::take(Case& entry) {
    if (!points_) {
        return true;
    }
    const std::string text = entry.conditions.text("design_point").value_or("");
    std::erase_if(entry.conditions.texts, [](const auto& condition) { return condition.first == "design_point"; });
    const auto number = core::parse_integer(text);
    const DesignPoint* point = number ? points_->find(static_cast<int>(*number)) : nullptr;
    if (point == nullptr) {
        without_point_.push_back(entry.file.string());
        return false;
    }
    const auto [other, fresh] = files_.emplace(point->number, entry.file);
    if (!fresh) {
        throw core::InputError("duplicate",
                               "design point " + std::to_string(point->number) +
                                   " has two files: " + other->second.string() + " and " + entry.file.string(),
                               place_, "make the pattern fit one of them");
    }
    for (const auto& number_of : point->conditions.numbers) {
        entry.conditions.set(number_of.first, number_of.second, written_unit(point->conditions, number_of.first));
    }
    entry.name = "dp" + std::to_string(point->number);
    return true;
}

void DesignPointCases::finish(core::Problems& notes) const {
    if (!points_) {
        return;
    }
    notes.insert(notes.end(), points_->notes.begin(), points_->notes.end());
    std::vector<std::string> without_file;
    for (const auto& point : points_->points) {
        if (!files_.contains(point.number)) {
            without_file.push_back(point.name);
        }
    }
    const auto say = [&](const std::vector<std::string>& names, const std::string& what) {
        std::string list;
        for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 5); ++i) {
            list += (i > 0 ? ", " : "") + names[i];
        }
        if (!names.empty()) {
            notes.push_back({core::Problem::Severity::warning,
                             std::to_string(names.size()) + what + list + (names.size() > 5 ? ", ..." : ""), place_});
        }
    };
    say(without_file, " design points have no file: ");
    say(without_point_, " files are of no point of the table and left out: ");
}

}  // namespace underbody::cases
