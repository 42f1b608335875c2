#include "studio/desktop/case_points.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "cases/gap_groups.h"
#include "surrogates/tables/analysis/figures.h"

namespace underbody::studio {

namespace {

constexpr std::size_t most_groups = 8;  ///< more colours are not told apart

}  // namespace

core::Figure lift_of_cases(const cases::Study& study, const cases::StudyResults& results) {
    std::vector<const cases::CaseLoads*> drawn;
    std::vector<const cases::Conditions*> conditions;
    for (const auto& loads : results.case_loads) {
        const auto& entry = study.cases[loads.entry].conditions;
        if (entry.number("gap") && std::isfinite(loads.value("lift_force"))) {
            drawn.push_back(&loads);
            conditions.push_back(&entry);
        }
    }
    std::vector<cases::GapGroup> groups = cases::gap_groups(conditions);
    const auto by_one_number = [&groups](const cases::GapGroup& one) {
        const auto& numbers = one.held.numbers;
        return numbers.size() == 1 && one.held.texts.empty() &&
               numbers.front().first == groups.front().held.numbers.front().first;
    };
    if (!groups.empty() && groups.front().held.numbers.size() == 1 &&
        std::all_of(groups.begin(), groups.end(), by_one_number)) {
        std::sort(groups.begin(), groups.end(), [](const cases::GapGroup& a, const cases::GapGroup& b) {
            return a.held.numbers < b.held.numbers;  // as a legend is read
        });
    }
    core::Figure figure;
    figure.title = "lift of the cases over the gap";
    figure.x = {"gap", "mm", 0, 0, false};
    figure.y = {"lift force", "N", 0, 0, false};
    double least = INFINITY, most = -INFINITY;
    for (const cases::GapGroup& group : groups) {
        const bool one_colour = groups.size() > most_groups;
        if (figure.points.empty() || !one_colour) {
            core::FigurePoints points;
            points.name = one_colour || groups.size() < 2 ? "" : group.held.label();
            points.colour = core::palette(figure.points.size());
            figure.points.push_back(points);
        }
        for (const std::size_t i : group.cases) {
            const double gap = 1000 * conditions[i]->number("gap").value();
            least = std::min(least, gap);
            most = std::max(most, gap);
            figure.points.back().x.push_back(gap);
            figure.points.back().y.push_back(drawn[i]->value("lift_force"));
        }
    }
    figure.x.logarithmic = least > 0 && least < most && tables::spans_decades(least, most);
    return figure;
}

}  // namespace underbody::studio
