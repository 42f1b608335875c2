#include "studio/desktop/case_points.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/text.h"
#include "core/units.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {

constexpr std::size_t most_pitches = 8;  ///< more colours are not told apart

const std::vector<double>* numbers_of(const core::Table& loads, const std::string& name) {
    const auto* column = loads.find(name);
    return column == nullptr || column->is_text() ? nullptr : &column->numbers;
}

/// Rows with gap and lift, by their pitch in degrees.
std::map<double, std::vector<std::size_t>> rows_by_pitch(const core::Table& loads) {
    std::map<double, std::vector<std::size_t>> rows;
    const auto* gaps = numbers_of(loads, "gap");
    const auto* lifts = numbers_of(loads, "lift_force");
    const auto* pitches = numbers_of(loads, "pitch");
    for (std::size_t row = 0; gaps != nullptr && lifts != nullptr && row < loads.rows(); ++row) {
        if (std::isfinite((*gaps)[row]) && std::isfinite((*lifts)[row])) {
            const double pitch = pitches == nullptr ? 0 : core::convert((*pitches)[row], "rad", "deg");
            rows[std::round(1e6 * pitch) / 1e6].push_back(row);
        }
    }
    return rows;
}

}  // namespace

core::Figure lift_of_cases(const core::Table& loads) {
    const auto rows = rows_by_pitch(loads);
    core::Figure figure;
    figure.title = "lift of the cases over the gap";
    figure.x = {"gap", "mm", 0, 0, false};
    figure.y = {"lift force", "N", 0, 0, false};
    double least = INFINITY, most = -INFINITY;
    for (const auto& [pitch, those] : rows) {
        const bool one_colour = rows.size() > most_pitches;
        if (figure.points.empty() || !one_colour) {
            core::FigurePoints points;
            points.name = one_colour || rows.size() < 2 ? "" : "pitch " + core::format_number(pitch, 4) + "°";
            points.colour = core::palette(figure.points.size());
            figure.points.push_back(points);
        }
        for (const std::size_t row : those) {
            const double gap = 1000 * loads.find("gap")->numbers[row];
            least = std::min(least, gap);
            most = std::max(most, gap);
            figure.points.back().x.push_back(gap);
            figure.points.back().y.push_back(loads.find("lift_force")->numbers[row]);
        }
    }
    figure.x.logarithmic = least > 0 && least < most && tables::spans_decades(least, most);
    return figure;
}

std::string table_of_cases(const core::Table& loads) {
    const auto rows = rows_by_pitch(loads);
    if (rows.empty()) {
        return {};
    }
    std::string text = "[[table]]\nname = \"lift\"\nquantity = \"lift_force\"\naxes = [\"gap\"]";
    if (rows.size() > 1) {  // the pitch that has most gaps
        const auto most = std::max_element(
            rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
        text += "\nwhere = { pitch = \"" + core::format_number(most->first, 4) + " deg\" }";
    }
    return text;
}

}  // namespace underbody::studio
