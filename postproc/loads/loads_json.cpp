// Loads as JSON and as table rows; the keys are those of the interfaces.
#include <nlohmann/json.hpp>

#include "postproc/field/problems_json.h"
#include "postproc/loads/loads.h"

namespace underbody::postproc {

namespace {

nlohmann::json json_of(const Wrench& wrench) { return {{"force", wrench.force}, {"moment", wrench.moment}}; }

nlohmann::json json_of(const NamedLoads& loads) {
    return {{"lift_force", loads.lift_force},     {"drag_force", loads.drag_force},   {"side_force", loads.side_force},
            {"pitch_moment", loads.pitch_moment}, {"roll_moment", loads.roll_moment}, {"yaw_moment", loads.yaw_moment}};
}

nlohmann::json json_of(const ZoneLoads& zone) {
    Wrench total;
    for (std::size_t k = 0; k < 3; ++k) {
        total.force[k] = zone.pressure.force[k] + zone.viscous.force[k];
        total.moment[k] = zone.pressure.moment[k] + zone.viscous.moment[k];
    }
    return {{"name", zone.name},
            {"faces", zone.faces},
            {"area", zone.area},
            {"area_vector", zone.area_vector},
            {"force", total.force},
            {"moment", total.moment},
            {"pressure", json_of(zone.pressure)},
            {"viscous", json_of(zone.viscous)},
            {"turned", zone.turned}};
}

}  // namespace

void to_json(nlohmann::json& json, const LoadsResult& result) {
    json = json_of(result.named);
    json["file"] = result.file;
    if (result.time) {
        json["time"] = *result.time;
    }
    json["force"] = result.total.force;
    json["moment"] = result.total.moment;
    json["reference"] = result.reference;
    json["reference_from"] = result.reference_from;
    json["pressure"] = json_of(result.pressure);
    json["pressure"].update(json_of(result.named_pressure));
    json["viscous"] = json_of(result.viscous);
    json["viscous"].update(json_of(result.named_viscous));
    json["area"] = result.area;
    json["extent"] = result.extent;
    json["length"] = result.length;
    json["closure"] = result.closure;
    json["force_per_reference_pascal"] = result.force_per_reference_pascal;
    if (!result.depth.empty()) {
        json["depth"] = result.depth;
    }
    json["values_from"] = result.values_from;
    json["orientation"] = result.orientation;
    json["zones"] = nlohmann::json::array();
    for (const auto& zone : result.zones) {
        json["zones"].push_back(json_of(zone));
    }
    json["left_out"] = nlohmann::json::array();
    for (const auto& zone : result.left_out) {
        json["left_out"].push_back({{"name", zone.name}, {"why", zone.why}});
    }
    json["centre_of_pressure"] = nullptr;
    if (result.centre_of_pressure) {
        json["centre_of_pressure"] = *result.centre_of_pressure;
    }
    json["coefficients"] = nullptr;
    if (result.coefficients) {
        const auto& c = *result.coefficients;
        json["coefficients"] = {{"lift", c.lift},       {"drag", c.drag},     {"pitch_moment", c.pitch_moment},
                                {"density", c.density}, {"speed", c.speed},   {"length", c.length},
                                {"width", c.width},     {"height", c.height}, {"lengths_from", c.lengths_from}};
    }
    if (!result.stations.empty()) {
        json["stations"] = nlohmann::json::array();
        for (const auto& station : result.stations) {
            nlohmann::json entry = json_of(station.behind);
            entry["position"] = station.position;
            json["stations"].push_back(std::move(entry));
        }
    }
    json["problems"] = json_of(result.problems);
}

std::vector<LoadsColumn> table_row(const LoadsResult& result) {
    std::vector<LoadsColumn> row = {{"lift_force", "N", result.named.lift_force},
                                    {"drag_force", "N", result.named.drag_force},
                                    {"side_force", "N", result.named.side_force},
                                    {"pitch_moment", "N m", result.named.pitch_moment},
                                    {"roll_moment", "N m", result.named.roll_moment},
                                    {"yaw_moment", "N m", result.named.yaw_moment},
                                    {"lift_pressure", "N", result.named_pressure.lift_force},
                                    {"lift_viscous", "N", result.named_viscous.lift_force},
                                    {"drag_pressure", "N", result.named_pressure.drag_force},
                                    {"drag_viscous", "N", result.named_viscous.drag_force},
                                    {"closure", "1", result.closure}};
    return row;
}

std::vector<LoadsColumn> table_columns(const LoadsResult& result) {
    std::vector<LoadsColumn> columns = table_row(result);
    if (result.coefficients) {
        columns.push_back({"lift_coefficient", "1", result.coefficients->lift});
        columns.push_back({"drag_coefficient", "1", result.coefficients->drag});
        columns.push_back({"pitch_moment_coefficient", "1", result.coefficients->pitch_moment});
    }
    for (std::size_t k = 0; k < 3; ++k) {
        columns.push_back({std::string("reference_") + "xyz"[k], "m", result.reference[k]});
    }
    columns.push_back({"reference_length", "m", result.length});
    return columns;
}

}  // namespace underbody::postproc
