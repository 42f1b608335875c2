#include "postproc/importers/reports/cfx_output.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "core/units.h"
#include "postproc/importers/reports/report_words.h"
#include "postproc/importers/reports/residual_history.h"

namespace underbody::postproc {

namespace {

constexpr std::string_view outer_loop = "OUTER LOOP ITERATION =";
constexpr std::string_view coefficient_loop = "COEFFICIENT LOOP ITERATION =";
constexpr std::string_view time_step = "TIME STEP =";
constexpr std::string_view group_words = "Domain Group:";
constexpr std::string_view on_walls = "on walls";

/// The cells of "| U-Mom | 0.99 | 1.2E-03 | ... |"; none when the line is no row of a table.
std::vector<std::string> cells_of(std::string_view line) {
    std::vector<std::string> cells;
    if (line.size() < 2 || line.front() != '|' || line.back() != '|') {
        return cells;
    }
    for (const auto cell : core::split(line.substr(1, line.size() - 2), '|')) {
        cells.emplace_back(core::trimmed(cell));
    }
    return cells;
}

/// The whole number behind "OUTER LOOP ITERATION =".
std::optional<long long> number_behind(std::string_view line, std::string_view words) {
    if (!line.starts_with(words)) {
        return {};
    }
    const auto rest = core::trimmed(line.substr(words.size()));
    return core::parse_integer(rest.substr(0, rest.find_first_of(" \t(")));
}

using Triple = std::array<double, 3>;

/// One of the four tables: forces or moments, by pressure or by shear.
struct WallTable {
    std::int64_t line = 0;  ///< of its title; 0: not there
    std::vector<std::pair<std::string, Triple>> rows;
    std::vector<std::string> groups;  ///< the domain group of each row; empty where the table names none
};

struct Kind {
    bool moment = false;
    bool viscous = false;
};

/// "|  Pressure Force On Walls  |".
std::optional<Kind> table_begun_by(std::string_view line) {
    const auto cells = cells_of(line);
    if (cells.size() != 1) {
        return {};
    }
    const std::string title = core::lower_case(cells[0]);
    const bool pressure = title.starts_with("pressure") || title.starts_with("normal");
    const bool viscous = title.starts_with("viscous") || title.starts_with("tangential");
    const bool moment = title.find(" moment") != std::string::npos || title.find(" torque") != std::string::npos;
    if ((!pressure && !viscous) || !title.ends_with(on_walls) ||
        (!moment && title.find(" force") == std::string::npos)) {
        return {};
    }
    return Kind{moment, viscous};
}

/// What makes newtons of the run's solution units: "Mass Units = [lb]" and the like.
struct SolutionUnits {
    double mass = 1, length = 1, time = 1;

    void take(std::string_view line, const core::Place& place) {
        for (const auto& [key, si, scale] :
             {std::tuple{"Mass Units", "kg", &mass}, std::tuple{"Length Units", "m", &length},
              std::tuple{"Time Units", "s", &time}}) {
            const auto open = line.find('[');
            const auto close = line.find(']');
            if (line.starts_with(key) && open != std::string_view::npos && close != std::string_view::npos &&
                open < close) {
                *scale =
                    core::conversion(std::string(core::trimmed(line.substr(open + 1, close - open - 1))), si, place)
                        .scale;
            }
        }
    }
    [[nodiscard]] double force() const { return mass * length / (time * time); }
};

class Forces {
public:
    explicit Forces(std::string file) : file_(std::move(file)) {}

    void line(std::string_view text, std::int64_t number) {
        units_.take(text, {file_, number, {}, {}});
        if (const auto kind = table_begun_by(text)) {
            table_ = &tables_[kind->moment ? 1 : 0][kind->viscous ? 1 : 0];
            *table_ = {number, {}, {}};  // a later summary counts
            domain_group_.clear();
            group_ = Triple{};
            largest_ = 0;
            ruled_ = false;
            wrapped_.clear();
            return;
        }
        if (table_ == nullptr || text.empty()) {
            return;
        }
        const bool rule = text.front() == '+' || text.front() == '=';
        if (rule) {
            table_ = table_->rows.empty() ? table_ : nullptr;
            return;
        }
        if (text.starts_with(group_words)) {
            if (const auto name = core::trimmed(text.substr(group_words.size()));
                !name.empty() && !name.starts_with("Totals")) {
                domain_group_ = name;
            }
        }
        row(text, number);
    }

    [[nodiscard]] std::vector<ForceReport> finish() {
        for (auto& kind : tables_) {
            for (auto& table : kind) {
                tell_apart(table);
            }
        }
        std::vector<ForceReport> reports;
        for (const bool moments : {false, true}) {
            const auto& [pressure, viscous] = tables_[moments ? 1 : 0];
            if (pressure.line == 0 && viscous.line == 0) {
                continue;
            }
            const char* what = moments ? "moments" : "forces";
            const WallTable& there = pressure.line != 0 ? pressure : viscous;
            if (pressure.rows.size() != viscous.rows.size() || pressure.rows.empty()) {
                fail_in_line(file_, there.line,
                             std::string("the ") + what + " on the walls are incomplete: " +
                                 std::to_string(pressure.rows.size()) + " walls with a pressure part, " +
                                 std::to_string(viscous.rows.size()) + " with a viscous one");
            }
            add(reports, moments, pressure, viscous);
        }
        if (reports.empty()) {
            throw core::InputError("format", "there are no wall forces in this output of the solver",
                                   {file_, {}, {}, {}},
                                   "CFX writes them when a run ends; one that was stopped hard has none");
        }
        return reports;
    }

private:
    /// Walls of one name in several domain groups: "R1: Blade".
    static void tell_apart(WallTable& table) {
        std::vector<std::string> names;
        for (const auto& row : table.rows) {
            names.push_back(row.first);
        }
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (std::count(names.begin(), names.end(), names[i]) > 1) {
                table.rows[i].first = table.groups[i] + ": " + names[i];
            }
        }
    }

    void row(std::string_view text, std::int64_t number) {
        if (text.front() == '-' && text.find_first_not_of("- \t") == std::string_view::npos) {
            ruled_ = true;  // a total follows
            return;
        }
        auto words = words_of(text);
        const auto numbers = words.size() < 3 ? std::nullopt : numbers_of({words.end() - 3, words.end()});
        if (!numbers) {
            wrapped_ = std::string(text);  // a heading, or a name too long for its line
            return;
        }
        words.resize(words.size() - 3);
        while (!words.empty() && (words.back() == ":" || words.back().empty())) {
            words.pop_back();
        }
        std::string name = words.empty() ? wrapped_ : std::string();
        for (const auto& word : words) {
            name += (name.empty() ? "" : " ") + word;
        }
        if (name.ends_with(":")) {
            name.pop_back();
        }
        const Triple values = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
        const std::string lower = core::lower_case(name);
        if ((lower.ends_with("totals") || lower.ends_with("total")) &&
            (ruled_ || lower.starts_with("domain") || lower.starts_with("global"))) {
            check_total(lower.starts_with("global"), values, number);
            return;
        }
        if (name.empty() || lower.starts_with("domain group") || lower.starts_with("x-comp")) {
            fail_in_line(file_, number, "forces without the name of their wall");
        }
        auto found = std::find_if(table_->rows.begin(), table_->rows.end(), [&](const auto& r) {
            return r.first == name &&
                   table_->groups[static_cast<std::size_t>(&r - table_->rows.data())] == domain_group_;
        });
        if (found == table_->rows.end()) {
            found = table_->rows.insert(table_->rows.end(), {name, Triple{}});
            table_->groups.push_back(domain_group_);
        }
        for (std::size_t k = 0; k < 3; ++k) {
            found->second[k] += values[k];
            group_[k] += values[k];
            largest_ = std::max(largest_, std::abs(values[k]));
        }
        wrapped_.clear();
        ruled_ = false;
    }

    void check_total(bool global, const Triple& stated, std::int64_t number) {
        for (std::size_t k = 0; k < 3 && !global; ++k) {
            if (!(std::abs(stated[k] - group_[k]) <= 0.02 * std::max(largest_, std::abs(stated[k])))) {
                fail_in_line(file_, number,
                             "the walls above add up to " + core::format_number(group_[k], 5) + " along " +
                                 std::string(1, "xyz"[k]) + ", the total says " + core::format_number(stated[k], 5) +
                                 ": lines are missing or damaged");
            }
        }
        group_ = Triple{};
        ruled_ = false;
    }

    void add(std::vector<ForceReport>& reports, bool moments, const WallTable& pressure,
             const WallTable& viscous) const {
        const double scale = units_.force() * (moments ? units_.length : 1);
        for (std::size_t k = 0; k < 3; ++k) {
            ForceReport report;
            report.moments = moments;
            report.direction[k] = 1;
            ReportedForce net{"Net", 0, 0, 0, 0, 0, 0};
            for (const auto& [name, p] : pressure.rows) {
                const auto other = std::find_if(viscous.rows.begin(), viscous.rows.end(),
                                                [&, wall = name](const auto& r) { return r.first == wall; });
                if (other == viscous.rows.end()) {
                    fail_in_line(file_, viscous.line, "wall '" + name + "' has no viscous part");
                }
                const double by_pressure = scale * p[k];
                const double by_shear = scale * other->second[k];
                report.rows.push_back({name, by_pressure, by_shear, by_pressure + by_shear, 0, 0, 0});
                net.pressure += by_pressure;
                net.viscous += by_shear;
            }
            net.total = net.pressure + net.viscous;
            report.rows.push_back(net);
            reports.push_back(std::move(report));
        }
    }

    std::string file_;
    SolutionUnits units_;
    std::array<std::array<WallTable, 2>, 2> tables_;  ///< forces, moments; pressure, viscous
    WallTable* table_ = nullptr;
    Triple group_{};      ///< sum of the rows since the last total
    double largest_ = 0;  ///< of the table's numbers
    std::string wrapped_;
    std::string domain_group_;
    bool ruled_ = false;  ///< the line before was one of dashes
};

/// Calls `act(line, number)` for every line, without the blanks around it.
template <typename Act>
void each_line(std::string_view text, Act&& act) {
    std::int64_t number = 0;
    while (!text.empty()) {
        const auto end = text.find('\n');
        act(core::trimmed(text.substr(0, end)), ++number);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
}

}  // namespace

bool has_cfx_iterations(std::string_view text) {
    return text.find(outer_loop) != std::string_view::npos || text.find(coefficient_loop) != std::string_view::npos;
}

bool has_cfx_forces(std::string_view text) {
    for (auto at = text.find("On Walls"); at != std::string_view::npos; at = text.find("On Walls", at + 1)) {
        const auto begin = text.rfind('\n', at);
        const auto from = begin == std::string_view::npos ? 0 : begin + 1;
        if (table_begun_by(core::trimmed(text.substr(from, text.find('\n', at) - from)))) {
            return true;
        }
    }
    return false;
}

Monitor read_cfx_iterations(const std::string& file, std::string_view text) {
    ResidualHistory residuals(file);
    bool transient = false;
    bool in_table = false;
    each_line(text, [&](std::string_view line, std::int64_t) {
        if (const auto step = number_behind(line, time_step)) {
            transient = true;
            residuals.begin(static_cast<double>(*step));
        } else if (const auto outer = number_behind(line, outer_loop)) {
            residuals.begin(static_cast<double>(*outer));
        }
        const auto cells = cells_of(line);
        if (cells.size() > 2 && cells[0] == "Equation" && cells[2].starts_with("RMS")) {
            in_table = residuals.at().has_value();
        } else if (cells.size() < 4) {
            // Rules stand between groups of equations, and boxes with notices may; anything else ends the table.
            in_table = in_table && (line.starts_with("+-") || cells.size() == 1);
        } else if (in_table) {
            const double missing = std::nan("");
            residuals.add(cells[0], number_of(cells[2]).value_or(missing));
            residuals.add(cells[0] + " max", number_of(cells[3]).value_or(missing));
        }
    });
    return residuals.finish(transient ? "Time Step" : "Iteration");
}

std::vector<ForceReport> read_cfx_forces(const std::string& file, std::string_view text) {
    Forces forces(file);
    each_line(text, [&](std::string_view line, std::int64_t number) { forces.line(line, number); });
    return forces.finish();
}

}  // namespace underbody::postproc
