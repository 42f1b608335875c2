#include "surrogates/dynamics/model/table_notes.h"

#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/text.h"

namespace underbody::dynamics {

std::vector<std::string> fit_lines(const Model& model) {
    std::vector<std::string> lines;
    for (const ForceSource& source : model.forces) {
        lines.push_back(source.quantity + " of " + source.table_file + ": " + source.table.kind() + " through " +
                        core::counted(source.table.points().rows(), "point"));
    }
    return lines;
}

nlohmann::json fits_json(const Model& model) {
    nlohmann::json list = nlohmann::json::array();
    for (const ForceSource& source : model.forces) {
        nlohmann::json remarks = nlohmann::json::array();
        for (const core::Problem& remark : source.table.remarks()) {
            remarks.push_back(remark.message);
        }
        list.push_back({{"quantity", source.quantity},
                        {"table", source.table_file},
                        {"kind", source.table.kind()},
                        {"points", source.table.points().rows()},
                        {"remarks", remarks}});
    }
    return list;
}

core::Problems held_outside(const Model& model, const Conditions& held) {
    core::Problems found;
    for (const ForceSource& source : model.forces) {
        for (std::size_t k = 0; k < source.axes.size(); ++k) {
            const Channel channel = source.axes[k];
            const tables::TableAxis& axis = source.table.axes()[k];
            if (!held.has(channel) || (held[channel] >= axis.lower && held[channel] <= axis.upper)) {
                continue;
            }
            found.push_back(
                {core::Problem::Severity::warning,
                 axis.name + " " + core::format_number(held[channel], 6) + " " + axis.unit + " is outside the " +
                     source.quantity + " table " + source.table_file + ", which covers " +
                     core::format_number(axis.lower, 6) + " to " + core::format_number(axis.upper, 6) + " " +
                     axis.unit + ": its end value is held, the force is that at " +
                     core::format_number(held[channel] < axis.lower ? axis.lower : axis.upper, 6) + " " + axis.unit,
                 {source.table_path.string(), {}, {}, {}}});
        }
    }
    return found;
}

}  // namespace underbody::dynamics
