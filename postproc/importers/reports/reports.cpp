#include "postproc/importers/reports/reports.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/file.h"
#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/reports/cfx_output.h"
#include "postproc/importers/reports/openfoam_log.h"
#include "postproc/importers/reports/openfoam_table.h"
#include "postproc/importers/reports/report_words.h"
#include "postproc/importers/reports/residual_history.h"

namespace underbody::postproc {

ReportText::ReportText(const std::filesystem::path& path) : file_(path), bytes_(file_.bytes()) {
    bytes_.remove_prefix(bytes_.starts_with("\xEF\xBB\xBF") ? 3 : 0);
    if (bytes_.find('\r') != std::string_view::npos && bytes_.find('\n') == std::string_view::npos) {
        own_ = bytes_;
        std::replace(own_.begin(), own_.end(), '\r', '\n');
    }
}

std::vector<std::string> words_of(std::string_view line) {
    std::vector<std::string> words;
    std::string word;
    bool quoted = false;
    bool in_number = false;
    const auto finish = [&](bool keep_empty) {
        if (!word.empty() || keep_empty) {
            words.push_back(word);
        }
        word.clear();
    };
    for (const char c : line) {
        if (c == '"') {
            if (quoted) {
                finish(true);
            }
            quoted = !quoted;
        } else if (quoted) {
            word += c;
        } else if (c == '(' && core::lower_case(word).ends_with("nan")) {
            word += c;  // "-nan(ind)"
            in_number = true;
        } else if (in_number && c == ')') {
            word += c;
            in_number = false;
        } else if (c == ' ' || c == '\t' || c == ',' || c == '(' || c == ')' || c == '\r') {
            finish(false);
        } else {
            word += c;
        }
    }
    finish(false);
    return words;
}

std::optional<double> number_of(std::string_view word) {
    if (const auto value = core::parse_number(word)) {
        return value;
    }
    const std::string lower = core::lower_case(word);
    if (lower == "nan" || lower == "-nan" || lower.starts_with("nan(") || lower.starts_with("-nan(") ||
        lower.find("#ind") != std::string::npos || lower.find("#qnan") != std::string::npos) {
        return std::nan("");
    }
    if (lower.find("#inf") != std::string::npos) {
        return HUGE_VAL;
    }
    // Fortran drops the letter where the exponent has three digits: "1.0-101".
    const std::size_t sign = word.find_last_of("+-");
    if (sign != std::string_view::npos && sign > 0 && std::isdigit(static_cast<unsigned char>(word[sign - 1])) != 0) {
        return core::parse_number(std::string(word.substr(0, sign)) + "e" + std::string(word.substr(sign)));
    }
    return {};
}

std::optional<std::vector<double>> numbers_of(const std::vector<std::string>& words) {
    std::vector<double> numbers;
    for (const auto& word : words) {
        const auto value = number_of(word);
        if (!value) {
            return {};
        }
        numbers.push_back(*value);
    }
    return numbers.empty() ? std::nullopt : std::optional(std::move(numbers));
}

namespace {

constexpr std::size_t most_columns = 4096;
constexpr const char* unnamed_steps = "Iteration";

/// "  iter  continuity  x-velocity ...  time/iter": the names between.
bool is_residual_header(const std::vector<std::string>& words) {
    return words.size() > 2 && words[0] == "iter" && words[1] == "continuity";
}

/// The table of residuals that a transcript interrupts with messages. A header of other names (the energy switched on,
/// a report added) goes on with these.
Monitor read_transcript(const std::string& file, std::string_view bytes) {
    ResidualHistory residuals(file);
    std::vector<std::string> columns;
    std::size_t repeated = 0;
    for (const auto line : core::split(bytes, '\n')) {
        auto words = words_of(line);
        if (is_residual_header(words)) {
            if (words.back() == "time/iter") {
                words.pop_back();
            }
            columns = std::move(words);
            continue;
        }
        if (columns.empty() || words.size() < columns.size()) {
            continue;
        }
        words.resize(columns.size());
        const auto row = numbers_of(words);
        if (!row || !core::parse_integer(words[0])) {
            continue;
        }
        repeated += residuals.at() && (*row)[0] <= *residuals.at() ? 1 : 0;
        residuals.begin((*row)[0]);
        for (std::size_t c = 1; c < columns.size(); ++c) {
            residuals.add(columns[c], (*row)[c]);
        }
    }
    Monitor monitor = residuals.finish("iter");
    if (repeated > 0) {
        monitor.problems.insert(monitor.problems.begin(), repeated_rows(repeated, file));
    }
    return monitor;
}

/// "12" in quotation marks and nothing else is a title, whatever number it may look like.
bool is_quoted_title(std::string_view line, const std::vector<std::string>& words) {
    return words.size() == 1 && line.front() == '"';
}

/// Names of the columns of a table, from the lines before its first row.
void name_columns(Monitor& monitor, const std::vector<std::vector<std::string>>& heads, std::size_t columns,
                  std::int64_t number) {
    const std::string& file = monitor.file;
    for (const auto& head : heads) {
        if (head.size() == columns) {
            monitor.columns = head;
        } else if (head.size() == 1 && monitor.title.empty()) {
            monitor.title = head[0];
        }
    }
    if (monitor.columns.empty() && columns == 2) {
        monitor.columns = {unnamed_steps, heads.empty() || heads.back().empty() ? "value" : heads.back().back()};
    }
    if (monitor.columns.empty()) {
        fail_in_line(file, number, "a row of " + std::to_string(columns) + " numbers without their names");
    }
}

void finish(Monitor& monitor, MonitorRows& rows, std::string_view bytes, std::int64_t number) {
    const std::string& file = monitor.file;
    if (rows.empty()) {
        throw core::InputError("format", "there is no table of numbers in this file", {file, {}, {}, {}});
    }
    if (bytes.back() != '\n') {
        monitor.problems.push_back({core::Problem::Severity::warning,
                                    "the file does not end with a line end: its last row may be cut short",
                                    {file, number, {}, {}}});
    }
    rows.into(monitor);
    const auto& steps = monitor.values.front();
    if (monitor.columns.front() == unnamed_steps &&
        std::any_of(steps.begin(), steps.end(), [](double step) { return step != std::floor(step); })) {
        monitor.columns.front() = "Time";  // no run counts in fractions
    }
}

/// `begun`: a row was found whose columns have names.
Monitor read_table(const std::string& file, std::string_view bytes, bool* begun = nullptr) {
    Monitor monitor;
    monitor.file = file;
    MonitorRows rows;
    std::int64_t number = 0;
    std::vector<std::vector<std::string>> heads;
    for (const auto raw : core::split(bytes, '\n')) {
        ++number;
        const auto line = core::trimmed(raw);
        if (line.empty() || line.front() == '#') {
            continue;
        }
        auto words = words_of(line);
        if (words.size() > most_columns) {
            fail_in_line(file, number, "a line with more than " + std::to_string(most_columns) + " columns");
        }
        auto row = numbers_of(words);
        if (!row || is_quoted_title(line, words)) {
            // A head; after a restart it may come again.
            if (rows.empty() || line.front() == '"' || line.front() == '(') {
                if (rows.empty()) {
                    heads.push_back(std::move(words));
                }
                if (heads.size() > 16) {
                    fail_in_line(file, number, "no table begins within the first lines");
                }
                continue;
            }
            fail_in_line(file, number, "expected numbers, found '" + std::string(line.substr(0, 40)) + "'");
        }
        if (rows.empty()) {
            name_columns(monitor, heads, row->size(), number);
        }
        if (row->size() != monitor.columns.size()) {
            fail_in_line(file, number,
                         "a row of " + std::to_string(row->size()) + " numbers where there are " +
                             std::to_string(monitor.columns.size()) + " columns");
        }
        if (std::isnan((*row)[0])) {
            fail_in_line(file, number, "a row without its iteration");
        }
        rows.add(std::move(*row));
        if (begun != nullptr) {
            *begun = monitor.columns.size() > 1 && !heads.empty();
        }
    }
    finish(monitor, rows, bytes, number);
    return monitor;
}

std::array<double, 3> triple_after(std::string_view line, std::size_t at) {
    std::array<double, 3> result{};
    const std::size_t open = line.find('(', at);
    const std::size_t close = line.find(')', open == std::string_view::npos ? 0 : open);
    if (open != std::string_view::npos && close != std::string_view::npos) {
        const auto numbers = numbers_of(words_of(line.substr(open, close - open)));
        for (std::size_t k = 0; numbers && k < std::min<std::size_t>(3, numbers->size()); ++k) {
            result[k] = (*numbers)[k];
        }
    }
    return result;
}

/// "Forces", "Forces - Direction Vector (1 0 0)", "Moments - Moment Center (0 0 0) Moment Axis (0 0 1)", "Force vector:
/// (1 0 0)", "Moment Center: (0 0 0)".
std::optional<ForceReport> report_begun_by(std::string_view line) {
    const bool now =
        line == "Forces" || line == "Moments" || line.starts_with("Forces - ") || line.starts_with("Moments - ");
    const bool before = line.starts_with("Force vector") || line.starts_with("Moment Center");
    if (!now && !before) {
        return {};
    }
    ForceReport report;
    report.moments = line.starts_with("Moment");
    if (report.moments) {
        report.centre = triple_after(line, line.find("Center"));
        report.direction = triple_after(line, std::min(line.find("Axis"), line.size()));
    } else {
        report.direction = triple_after(line, std::min(line.find('('), line.size()));
    }
    return report;
}

double scale_of_unit(std::string_view text, bool moments, const core::Place& place) {
    std::string unit(core::trimmed(text));
    const std::string lower = core::lower_case(unit);
    const std::string si = moments ? "N m" : "N";
    unit = lower == "n" ? "N" : lower == "n-m" || lower == "n m" ? "N m" : unit;
    std::replace(unit.begin(), unit.end(), '-', ' ');
    return core::conversion(unit, si, place).scale;
}

/// "Forces (n)      Coefficients", "Forces [lbf]", "Moments (n-m)": what makes SI of the numbers below.
double scale_of_header(std::string_view line, bool moments, const core::Place& place) {
    const std::size_t open = line.find_first_of("([");
    const std::size_t close = line.find_first_of(")]");
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) {
        return 1;
    }
    return scale_of_unit(line.substr(open + 1, close - open - 1), moments, place);
}

/// Layouts of old put the unit under each of the three heads: "n   n   n".
bool is_line_of_units(const std::vector<std::string>& words) {
    return words.size() == 3 && words[0] == words[1] && words[1] == words[2] && !number_of(words[0]);
}

/// Six numbers, or six triples, at the end of a line that begins with a zone's name.
void add_row(std::vector<ForceReport>& reports, std::size_t first, std::string_view line, double scale) {
    auto words = words_of(line);
    for (const std::size_t per_entry : {std::size_t{3}, std::size_t{1}}) {
        const std::size_t count = 6 * per_entry;
        if (words.size() <= count) {
            continue;
        }
        const auto numbers = numbers_of({words.end() - static_cast<std::ptrdiff_t>(count), words.end()});
        if (!numbers) {
            continue;
        }
        std::string zone;
        for (std::size_t i = 0; i + count < words.size(); ++i) {
            zone += (i > 0 ? " " : "") + words[i];
        }
        zone = core::lower_case(zone) == "net" ? "Net" : zone;
        if (per_entry == 3 && reports.size() < first + 3) {
            for (std::size_t k = reports.size() - first; k < 3; ++k) {
                reports.push_back(reports[first]);
            }
            for (std::size_t k = 0; k < 3; ++k) {
                reports[first + k].direction = {};
                reports[first + k].direction[k] = 1;
            }
        }
        for (std::size_t k = 0; k < per_entry; ++k) {
            const auto at = [&](std::size_t i) { return (*numbers)[i * per_entry + k]; };
            reports[first + k].rows.push_back({zone, scale * at(0), scale * at(1), scale * at(2), at(3), at(4), at(5)});
        }
        return;
    }
}

}  // namespace

Monitor read_monitor(const std::filesystem::path& path) {
    const ReportText file(path);
    const std::string_view bytes = file.bytes();
    if (has_cfx_iterations(bytes)) {
        return read_cfx_iterations(file.name(), bytes);
    }
    if (has_openfoam_residuals(bytes)) {
        return read_openfoam_log(file.name(), bytes);
    }
    if (has_openfoam_table(bytes)) {
        return read_openfoam_table(file.name(), bytes);
    }
    // A transcript has the header of its residuals on a line of its own, further down.
    std::size_t lines = 0;
    for (const auto line : core::split(bytes.substr(0, std::size_t{4} << 20), '\n')) {
        if (is_residual_header(words_of(line)) && line.find(',') == std::string_view::npos) {
            return read_transcript(file.name(), bytes);
        }
        if (++lines > 200000) {
            break;
        }
    }
    return read_table(file.name(), bytes);
}

Plot read_plot(const std::filesystem::path& path) {
    const ReportText file(path);
    Plot plot;
    std::int64_t number = 0;
    bool open = false;
    for (const auto raw : core::split(file.bytes(), '\n')) {
        ++number;
        const auto line = core::trimmed(raw);
        if (line.empty()) {
            continue;
        }
        const auto words = words_of(line);
        if (line.starts_with("(title")) {
            plot.title = words.size() > 1 ? words[1] : "";
        } else if (line.starts_with("(labels")) {
            plot.x_label = words.size() > 1 ? words[1] : "";
            plot.y_label = words.size() > 2 ? words[2] : "";
        } else if (line.starts_with("((xy/key/label")) {
            if (open) {
                fail_in_line(file.name(), number, "a curve begins within another");
            }
            plot.curves.push_back({words.size() > 1 ? words[1] : "", {}, {}});
            open = true;
        } else if (line.front() == ')') {
            open = false;
        } else {
            const auto numbers = numbers_of(words);
            if (!open || !numbers || numbers->size() != 2) {
                fail_in_line(file.name(), number,
                             "expected two numbers of a curve, found '" + std::string(line.substr(0, 40)) + "'");
            }
            plot.curves.back().x.push_back((*numbers)[0]);
            plot.curves.back().y.push_back((*numbers)[1]);
        }
    }
    if (open) {
        fail_in_line(file.name(), number, "the file ends within a curve");
    }
    if (plot.curves.empty()) {
        throw core::InputError("format", "there are no curves in this file", {file.name(), {}, {}, {}});
    }
    return plot;
}

std::vector<ForceReport> read_force_reports(const std::filesystem::path& path) {
    const ReportText file(path);
    if (has_cfx_forces(file.bytes())) {
        return read_cfx_forces(file.name(), file.bytes());
    }
    std::vector<ForceReport> reports;
    std::size_t first = 0;
    std::int64_t number = 0;
    std::int64_t begins = 0;
    double scale = 1;
    bool reading = false;
    for (const auto raw : core::split(file.bytes(), '\n')) {
        ++number;
        const auto line = core::trimmed(raw);
        if (auto report = report_begun_by(line)) {
            first = reports.size();
            reports.push_back(std::move(*report));
            reading = true;
            begins = number;
            scale = 1;
        } else if (reading && (line.starts_with("Forces") || line.starts_with("Moments"))) {
            scale = scale_of_header(line, reports[first].moments, {file.name(), number, {}, {}});
        } else if (reading && !line.empty() && line.front() != '-') {
            const auto words = words_of(line);
            if (is_line_of_units(words) && words[0] != "force" && words[0] != "moment") {
                scale = scale_of_unit(words[0], reports[first].moments, {file.name(), number, {}, {}});
                continue;
            }
            add_row(reports, first, line, scale);
            reading = words.empty() || core::lower_case(words.front()) != "net";
        }
    }
    if (reading && !reports.empty() && !reports.back().rows.empty()) {
        fail_in_line(file.name(), number,
                     "the text ends within the report that begins in line " + std::to_string(begins) +
                         ": its net row is missing");
    }
    std::erase_if(reports, [](const ForceReport& report) { return report.rows.empty(); });
    if (reports.empty()) {
        throw core::InputError("format", "there is no force report in this file", {file.name(), {}, {}, {}});
    }
    return reports;
}

ReportKinds report_kinds(const std::filesystem::path& path) {
    const ReportText file(path);
    const std::string_view text = file.bytes().substr(0, std::size_t{16} << 20);
    ReportKinds kinds;
    if (text.empty() || text.substr(0, 65536).find('\0') != std::string_view::npos) {
        return kinds;
    }
    kinds.plot = text.find("((xy/key/label") != std::string_view::npos;
    kinds.forces = has_cfx_forces(text);
    kinds.monitor = has_cfx_iterations(text) || has_openfoam_residuals(text) || has_openfoam_table(text);
    for (const auto raw : core::split(text, '\n')) {
        const auto line = core::trimmed(raw);
        kinds.forces = kinds.forces || report_begun_by(line).has_value();
        kinds.monitor = kinds.monitor || (line.starts_with("iter") && is_residual_header(words_of(line)));
    }
    if (!kinds.any()) {
        bool begun = false;
        try {
            kinds.monitor =
                read_table(file.name(), text.substr(0, text.rfind('\n', 65536) + 1), &begun).columns.size() > 1;
        } catch (const core::InputError&) {
            kinds.monitor = begun;  // a damaged one: who reads it says in which line. Else some other text
        }
    }
    return kinds;
}

}  // namespace underbody::postproc
