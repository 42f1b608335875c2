#include "postproc/loads/report_summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/utf8.h"
#include "postproc/field/problems_json.h"

namespace underbody::postproc {

namespace {

nlohmann::json of_monitor(const Monitor& monitor, const std::vector<std::optional<IterationScatter>>& scatter) {
    nlohmann::json columns = nlohmann::json::array();
    for (std::size_t c = 0; c < monitor.columns.size(); ++c) {
        nlohmann::json column = {{"name", core::as_utf8(monitor.columns[c])}, {"values", monitor.values[c]}};
        if (scatter[c]) {
            column["tail"] = *scatter[c];
        }
        columns.push_back(std::move(column));
    }
    return {{"title", core::as_utf8(monitor.title)}, {"columns", columns}};
}

nlohmann::json of_plot(const Plot& plot) {
    nlohmann::json curves = nlohmann::json::array();
    for (const auto& curve : plot.curves) {
        curves.push_back({{"name", core::as_utf8(curve.name)}, {"x", curve.x}, {"y", curve.y}});
    }
    return {{"title", core::as_utf8(plot.title)},
            {"x_label", core::as_utf8(plot.x_label)},
            {"y_label", core::as_utf8(plot.y_label)},
            {"curves", curves}};
}

nlohmann::json of_forces(const ForceReport& report) {
    nlohmann::json rows = nlohmann::json::array();
    for (const auto& row : report.rows) {
        rows.push_back({{"zone", core::as_utf8(row.zone)},
                        {"pressure", row.pressure},
                        {"viscous", row.viscous},
                        {"total", row.total}});
    }
    nlohmann::json json = {
        {"kind", report.moments ? "moments" : "forces"}, {"direction", report.direction}, {"rows", rows}};
    if (report.moments) {
        json["centre"] = report.centre;
    }
    return json;
}

}  // namespace

std::optional<ReportSummary> summarise_report(const std::filesystem::path& path) {
    const ReportKinds kinds = report_kinds(path);
    if (!kinds.any()) {
        return {};
    }
    ReportSummary summary;
    summary.file = path.string();
    if (kinds.plot) {
        summary.plot = read_plot(path);
    }
    if (kinds.forces) {
        summary.forces = read_force_reports(path);
    }
    if (kinds.monitor) {
        summary.monitor = read_monitor(path);
        summary.problems = summary.monitor->problems;
        for (std::size_t c = 0; c < summary.monitor->columns.size(); ++c) {
            const auto& values = summary.monitor->values[c];
            const bool whole =
                std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
            summary.scatter.push_back(c > 0 && whole && values.size() >= 8 ? std::optional(iteration_scatter(values))
                                                                           : std::nullopt);
        }
    }
    return summary;
}

void to_json(nlohmann::json& json, const ReportSummary& summary) {
    json = {{"file", summary.file}, {"problems", json_of(summary.problems)}};
    if (summary.monitor) {
        json["monitor"] = of_monitor(*summary.monitor, summary.scatter);
    }
    if (summary.plot) {
        json["plot"] = of_plot(*summary.plot);
    }
    if (!summary.forces.empty()) {
        nlohmann::json reports = nlohmann::json::array();
        for (const auto& report : summary.forces) {
            reports.push_back(of_forces(report));
        }
        json["force_reports"] = reports;
    }
}

}  // namespace underbody::postproc
