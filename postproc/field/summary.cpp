#include "postproc/field/summary.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "postproc/field/problems_json.h"
#include "postproc/field/surface_arrays.h"

namespace underbody::postproc {

namespace {

vtkDataArray* find_array(const Zone& zone, const ArrayInfo& info) {
    vtkDataSet* set = zone.volume != nullptr ? static_cast<vtkDataSet*>(zone.volume) : zone.surface.Get();
    if (set == nullptr) {
        return nullptr;
    }
    vtkFieldData* data =
        info.on == Location::nodes ? static_cast<vtkFieldData*>(set->GetPointData()) : set->GetCellData();
    if (auto* array = data->GetArray(info.name.c_str())) {
        return array;
    }
    return set->GetFieldData()->GetArray(info.name.c_str());
}

void take_range(vtkDataArray& array, ArraySummary& summary) {
    std::vector<double> own;
    const auto values = values_of(array, own);
    const auto components = static_cast<std::size_t>(array.GetNumberOfComponents());
    for (std::size_t i = 0; i + components <= values.size(); i += components) {
        double value = values[i];
        if (components > 1) {
            double square = 0;
            for (std::size_t k = 0; k < components; ++k) {
                square += values[i + k] * values[i + k];
            }
            value = std::sqrt(square);
        }
        if (std::isfinite(value)) {
            summary.min = std::min(summary.min, value);
            summary.max = std::max(summary.max, value);
        } else {
            ++summary.missing;
        }
    }
}

void add_array(const Zone& zone, const ArrayInfo& info, std::vector<ArraySummary>& arrays) {
    auto found = std::find_if(arrays.begin(), arrays.end(), [&](const ArraySummary& a) {
        return a.name == info.name && a.components == info.components;
    });
    if (found == arrays.end()) {
        ArraySummary summary;
        summary.name = info.name;
        summary.unit = info.unit;
        summary.components = info.components;
        summary.min = std::numeric_limits<double>::infinity();
        summary.max = -summary.min;
        summary.original_name = info.original_name;
        summary.original_unit = info.original_unit;
        arrays.push_back(std::move(summary));
        found = arrays.end() - 1;
    }
    const std::string on = to_string(info.on);
    if (found->on.find(on) == std::string::npos) {
        found->on += (found->on.empty() ? "" : ", ") + on;
    }
    found->zones.push_back(zone.name);
    if (auto* array = find_array(zone, info)) {
        for (int k = 0; k < array->GetNumberOfComponents() && array->HasAComponentName() &&
                        found->component_names.size() < static_cast<std::size_t>(info.components);
             ++k) {
            found->component_names.emplace_back(array->GetComponentName(k) != nullptr ? array->GetComponentName(k)
                                                                                      : "");
        }
        take_range(*array, *found);
    }
}

ZoneSummary summarise(const Zone& zone) {
    ZoneSummary summary;
    summary.name = zone.name;
    summary.id = zone.id;
    summary.kind = to_string(zone.kind);
    summary.original_kind = zone.original_kind;
    vtkPointSet* set = zone.volume != nullptr ? static_cast<vtkPointSet*>(zone.volume) : zone.surface.Get();
    if (set == nullptr) {
        return summary;
    }
    summary.points = static_cast<std::size_t>(set->GetNumberOfPoints());
    if (zone.volume != nullptr) {
        summary.cells = static_cast<std::size_t>(zone.volume->GetNumberOfCells());
    } else {
        summary.faces = static_cast<std::size_t>(zone.surface->GetNumberOfPolys() + zone.surface->GetNumberOfStrips());
        if (summary.faces == 0) {
            summary.faces = static_cast<std::size_t>(zone.surface->GetNumberOfLines());
        }
    }
    if (summary.points == 0) {
        auto* rows = zone.arrays.empty() ? nullptr : find_array(zone, zone.arrays.front());
        summary.points = rows == nullptr ? 0 : static_cast<std::size_t>(rows->GetNumberOfTuples());
    } else {
        std::array<double, 6> bounds{};
        set->GetPoints()->GetBounds(bounds.data());
        for (std::size_t k = 0; k < 3; ++k) {
            summary.lower[k] = bounds[2 * k];
            summary.upper[k] = bounds[2 * k + 1];
        }
    }
    return summary;
}

}  // namespace

FieldSummary summarise(const Field& field) {
    FieldSummary summary;
    summary.file = field.files.empty() ? "" : field.files.front();
    summary.format = field.format;
    summary.writer = field.writer;
    summary.dimension = field.dimension;
    using Kind = PressureReference::Kind;
    summary.pressure_reference = field.pressure.kind == Kind::gauge      ? "gauge"
                                 : field.pressure.kind == Kind::absolute ? "absolute"
                                                                         : "unknown";
    summary.operating_pressure = field.pressure.operating_pressure;
    summary.metadata = field.metadata;
    summary.problems = field.problems;
    for (const auto& zone : field.zones) {
        summary.zones.push_back(summarise(zone));
        summary.points += summary.zones.back().points;
        summary.faces += summary.zones.back().faces;
        summary.cells += summary.zones.back().cells;
        for (const auto& info : zone.arrays) {
            add_array(zone, info, summary.arrays);
        }
    }
    for (auto& array : summary.arrays) {
        if (array.min > array.max) {  // nothing but missing values
            array.min = array.max = std::numeric_limits<double>::quiet_NaN();
        }
    }
    return summary;
}

void to_json(nlohmann::json& json, const FieldSummary& summary) {
    json = {{"file", summary.file},
            {"format", summary.format},
            {"writer", summary.writer},
            {"dimension", summary.dimension},
            {"points", summary.points},
            {"faces", summary.faces},
            {"cells", summary.cells},
            {"pressure_reference",
             {{"kind", summary.pressure_reference}, {"operating_pressure", summary.operating_pressure}}},
            {"problems", json_of(summary.problems)}};
    json["zones"] = nlohmann::json::array();
    for (const auto& zone : summary.zones) {
        json["zones"].push_back({{"name", zone.name},
                                 {"id", zone.id},
                                 {"kind", zone.kind},
                                 {"original_kind", zone.original_kind},
                                 {"points", zone.points},
                                 {"faces", zone.faces},
                                 {"cells", zone.cells},
                                 {"bounding_box", {zone.lower, zone.upper}}});
    }
    json["arrays"] = nlohmann::json::array();
    for (const auto& array : summary.arrays) {
        json["arrays"].push_back({{"name", array.name},
                                  {"unit", array.unit},
                                  {"on", array.on},
                                  {"components", array.components},
                                  {"min", array.min},
                                  {"max", array.max},
                                  {"missing", array.missing},
                                  {"zones", array.zones},
                                  {"original_name", array.original_name},
                                  {"original_unit", array.original_unit}});
        if (!array.component_names.empty()) {
            json["arrays"].back()["component_names"] = array.component_names;
        }
    }
    json["points_counted"] = "zone by zone: points of several zones count in each of them";
    json["metadata"] = nlohmann::json::object();
    for (const auto& [key, value] : summary.metadata) {
        json["metadata"][key] = value;
    }
}

}  // namespace underbody::postproc
