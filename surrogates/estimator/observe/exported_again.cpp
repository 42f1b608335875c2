#include "surrogates/estimator/observe/exported_again.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "surrogates/dynamics/model/force_tables.h"
#include "surrogates/tables/exports/export.h"

namespace underbody::estimator {

namespace {

constexpr std::size_t rows_shown = 9;      ///< along the first axis
constexpr std::size_t points_alone = 401;  ///< of a table with one axis
constexpr std::size_t points_each = 13;    ///< of every axis where there are several

/// Evenly spaced over the common range of both tables.
std::vector<double> line(const tables::TableAxis& a, const tables::TableAxis& b, std::size_t count) {
    const double low = std::max(a.lower, b.lower), high = std::min(a.upper, b.upper);
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) {
        values.push_back(low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1));
    }
    return values;
}

ExportedAgain::Quantity compared(const tables::ForceTable& before, const tables::ForceTable& after,
                                 const std::vector<double>& middle) {
    ExportedAgain::Quantity one;
    one.name = before.quantity();
    one.unit = before.unit();
    const std::size_t axes = before.axes().size();
    std::vector<std::vector<double>> lines;
    std::size_t count = 1;
    for (std::size_t k = 0; k < axes; ++k) {
        lines.push_back(line(before.axes()[k], after.axes()[k], axes == 1 ? points_alone : points_each));
        count *= lines.back().size();
    }
    std::vector<double> point(axes);
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t rest = i;
        for (std::size_t k = 0; k < axes; ++k) {
            point[k] = lines[k][rest % lines[k].size()];
            rest /= lines[k].size();
        }
        const double was = before.value(point.data()), is = after.value(point.data());
        if (one.at.empty() || std::abs(is - was) > one.largest_change) {
            one.largest_change = std::abs(is - was);
            one.at = point;
            one.before_there = was;
            one.after_there = is;
        }
    }
    one.along = line(before.axes().front(), after.axes().front(), rows_shown);
    point = middle;
    for (const double place : one.along) {
        point[0] = place;
        one.before.push_back(before.value(point.data()));
        one.after.push_back(after.value(point.data()));
    }
    return one;
}

}  // namespace

std::string export_format_of(const std::filesystem::path& file) {
    std::string endings;
    for (const tables::ExportFormat& format : tables::export_formats()) {
        if (file.extension() == format.ending) {
            return format.name;
        }
        endings += (endings.empty() ? "" : ", ") + format.ending;
    }
    throw core::UsageError("format", "'" + file.string() + "' ends like no export", {}, "end it in " + endings);
}

ExportedAgain export_again(const dynamics::Model& before, const dynamics::Model& after,
                           const std::filesystem::path& folder, const std::string& name, bool overwrite,
                           core::Progress& progress) {
    ExportedAgain again;
    again.format = export_format_of(name);
    const dynamics::ForceTables declared = dynamics::force_tables(before, {}, progress);
    dynamics::ForceTablesOptions same_axes;
    for (const tables::TableAxis& axis : declared.tables.front().axes()) {
        same_axes.axes.push_back({axis.name, {}, {}});
        again.axes.push_back(axis.name);
        again.units.push_back(axis.unit);
    }
    const dynamics::ForceTables found = dynamics::force_tables(after, same_axes, progress);
    again.remarks = found.remarks;
    for (std::size_t k = 0; k < again.axes.size(); ++k) {
        const tables::TableAxis &a = declared.tables.front().axes()[k], &b = found.tables.front().axes()[k];
        again.middle.push_back(0.5 * (std::max(a.lower, b.lower) + std::min(a.upper, b.upper)));
    }
    for (const tables::ForceTable& table : declared.tables) {
        const auto other = std::find_if(found.tables.begin(), found.tables.end(),
                                        [&](const auto& one) { return one.quantity() == table.quantity(); });
        if (other != found.tables.end()) {
            again.quantities.push_back(compared(table, *other, again.middle));
        }
    }
    tables::ExportOptions options;
    options.name = tables::identifier(std::filesystem::path(name).stem().string());
    options.overwrite = overwrite;
    if (const auto centre = before.vehicle.base_centre(); !std::isnan(centre[2])) {
        options.lever = centre;
    }
    const auto write = [&](const std::vector<tables::ForceTable>& list, const std::filesystem::path& file) {
        std::filesystem::create_directories(file.parent_path());
        return tables::export_tables(list, again.format, file, options, progress).files;
    };
    again.before = write(declared.tables, folder / "declared" / name);
    again.after = write(found.tables, folder / name);
    return again;
}

std::vector<core::ReportTable> ExportedAgain::tables() const {
    std::vector<core::ReportTable> all;
    for (const Quantity& one : quantities) {
        core::ReportTable table;
        table.title = one.name + " as exported, before and after";
        table.header = {axes.front() + " [" + units.front() + "]", "before [" + one.unit + "]",
                        "after [" + one.unit + "]", "change [" + one.unit + "]"};
        for (std::size_t i = 0; i < one.along.size(); ++i) {
            table.rows.push_back({core::format_number(one.along[i], 4), core::format_number(one.before[i], 4),
                                  core::format_number(one.after[i], 4),
                                  core::format_number(one.after[i] - one.before[i], 3)});
        }
        std::string place;
        for (std::size_t k = 0; k < axes.size(); ++k) {
            place += (k == 0 ? "" : ", ") + axes[k] + " " + core::format_number(one.at[k], 4) + " " + units[k];
        }
        table.note = one.largest_change > 0
                         ? "Largest change " + core::format_number(one.largest_change, 3) + " " + one.unit + " at " +
                               place + " (" + core::format_number(one.before_there, 4) + " to " +
                               core::format_number(one.after_there, 4) + ")."
                         : "Both are the same: what was found is not part of this force (see the remarks).";
        for (std::size_t k = 1; k < axes.size(); ++k) {
            table.note +=
                " The table above is for " + axes[k] + " " + core::format_number(middle[k], 4) + " " + units[k] + ".";
        }
        if (&one == &quantities.front()) {
            table.links = {
                {"declared/" + before.front().filename().string(), "the file with the model as declared"},
                {after.front().filename().string(), "the file with the model as found: it takes the other's place"}};
        }
        all.push_back(std::move(table));
    }
    return all;
}

void to_json(nlohmann::json& json, const ExportedAgain& again) {
    const auto names = [](const std::vector<std::filesystem::path>& files) {
        std::vector<std::string> list;
        for (const std::filesystem::path& file : files) {
            list.push_back(file.string());
        }
        return list;
    };
    json = {{"format", again.format}, {"before", names(again.before)}, {"after", names(again.after)}};
    json["quantities"] = nlohmann::json::array();
    for (const ExportedAgain::Quantity& one : again.quantities) {
        nlohmann::json at;
        for (std::size_t k = 0; k < again.axes.size(); ++k) {
            at[again.axes[k]] = one.at[k];
        }
        json["quantities"].push_back(
            {{"quantity", one.name},
             {"unit", one.unit},
             {"largest_change", one.largest_change},
             {"at", at},
             {"before", one.before_there},
             {"after", one.after_there},
             {"along", {{again.axes.front(), one.along}, {"before", one.before}, {"after", one.after}}}});
    }
    json["remarks"] = nlohmann::json::array();
    for (const core::Problem& problem : again.remarks) {
        json["remarks"].push_back(problem.message);
    }
}

}  // namespace underbody::estimator
