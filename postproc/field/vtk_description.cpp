#include "postproc/field/vtk_description.h"

#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace underbody::postproc {

namespace {

using nlohmann::json;

constexpr int version = 1;
constexpr std::array kinds = {ZoneKind::wall,     ZoneKind::inlet,     ZoneKind::outlet,   ZoneKind::symmetry,
                              ZoneKind::periodic, ZoneKind::interface, ZoneKind::interior, ZoneKind::farfield,
                              ZoneKind::fluid,    ZoneKind::solid,     ZoneKind::line,     ZoneKind::points,
                              ZoneKind::other};
constexpr std::array locations = {Location::nodes, Location::faces, Location::cells};
using Pressure = PressureReference::Kind;
constexpr std::array<std::pair<Pressure, const char*>, 3> pressures = {
    {{Pressure::gauge, "gauge"}, {Pressure::absolute, "absolute"}, {Pressure::unknown, "unknown"}}};

json json_of(const ArrayInfo& info) {
    return {{"name", info.name},
            {"unit", info.unit},
            {"original_name", info.original_name},
            {"original_unit", info.original_unit},
            {"on", to_string(info.on)},
            {"components", info.components}};
}

json json_of(const DescribedZone& described) {
    const Zone& zone = described.zone;
    json arrays = json::array();
    for (const auto& info : zone.arrays) {
        arrays.push_back(json_of(info));
    }
    return {{"name", zone.name},
            {"id", zone.id},
            {"kind", to_string(zone.kind)},
            {"original_kind", zone.original_kind},
            {"normals_into_fluid", zone.normals_into_fluid},
            {"surface", described.surface},
            {"mark", described.mark},
            {"points", described.points},
            {"cells", described.cells},
            {"arrays", arrays}};
}

json json_of(const Field& field) {
    json whole = {
        {"version", version}, {"format", field.format}, {"writer", field.writer}, {"dimension", field.dimension}};
    for (const auto& [kind, word] : pressures) {
        if (field.pressure.kind == kind) {
            whole["pressure"] = {{"kind", word}, {"operating_pressure", field.pressure.operating_pressure}};
        }
    }
    if (field.density) {
        whole["density"] = *field.density;
    }
    whole["metadata"] = json::array();
    for (const auto& [key, value] : field.metadata) {
        whole["metadata"].push_back({key, value});
    }
    return whole;
}

/// By the word that it is written as; the last of `all` for any other.
template <typename Value, std::size_t size>
Value by_word(const std::array<Value, size>& all, const std::string& word, Value other) {
    for (const Value value : all) {
        if (to_string(value) == word) {
            return value;
        }
    }
    return other;
}

DescribedZone zone_from(const json& entry) {
    DescribedZone described;
    described.zone.name = entry.at("name").get<std::string>();
    described.zone.id = entry.at("id").get<int>();
    described.zone.kind = by_word(kinds, entry.at("kind").get<std::string>(), ZoneKind::unknown);
    described.zone.original_kind = entry.at("original_kind").get<std::string>();
    described.zone.normals_into_fluid = entry.at("normals_into_fluid").get<bool>();
    described.surface = entry.at("surface").get<bool>();
    described.mark = entry.at("mark").get<int>();
    described.points = entry.at("points").get<long long>();
    described.cells = entry.at("cells").get<long long>();
    for (const auto& info : entry.at("arrays")) {
        described.zone.arrays.push_back(
            {info.at("name").get<std::string>(), info.at("unit").get<std::string>(),
             info.at("original_name").get<std::string>(), info.at("original_unit").get<std::string>(),
             by_word(locations, info.at("on").get<std::string>(), Location::nodes), info.at("components").get<int>()});
    }
    return described;
}

Description description_from(const json& whole) {
    Description description;
    Field& field = description.field;
    field.format = whole.at("format").get<std::string>();
    field.writer = whole.at("writer").get<std::string>();
    field.dimension = whole.at("dimension").get<int>() == 2 ? 2 : 3;
    for (const auto& [kind, word] : pressures) {
        if (whole.at("pressure").at("kind").get<std::string>() == word) {
            field.pressure = {kind, whole.at("pressure").at("operating_pressure").get<double>()};
        }
    }
    if (whole.contains("density")) {
        field.density = whole.at("density").get<double>();
    }
    for (const auto& entry : whole.at("metadata")) {
        field.metadata.emplace_back(entry.at(0).get<std::string>(), entry.at(1).get<std::string>());
    }
    for (const auto& entry : whole.at("zones")) {
        description.zones.push_back(zone_from(entry));
    }
    return description;
}

}  // namespace

namespace {

vtkSmartPointer<vtkAbstractArray> array_of(const std::string& text, bool as_bytes) {
    if (as_bytes) {
        auto bytes = vtkSmartPointer<vtkUnsignedCharArray>::New();
        bytes->SetNumberOfValues(static_cast<vtkIdType>(text.size()));
        std::copy(text.begin(), text.end(), bytes->GetPointer(0));
        return bytes;
    }
    auto strings = vtkSmartPointer<vtkStringArray>::New();
    strings->InsertNextValue(text);
    return strings;
}

std::optional<std::string> text_of(vtkAbstractArray* array) {
    if (auto* strings = vtkStringArray::SafeDownCast(array); strings != nullptr && strings->GetNumberOfValues() == 1) {
        return std::string(strings->GetValue(0));
    }
    if (auto* bytes = vtkUnsignedCharArray::SafeDownCast(array); bytes != nullptr && bytes->GetNumberOfValues() > 0) {
        return std::string(bytes->GetPointer(0), bytes->GetPointer(0) + bytes->GetNumberOfValues());
    }
    return std::nullopt;
}

}  // namespace

void describe_in(vtkDataObject& data, const Field& field, const std::vector<DescribedZone>& zones, bool as_bytes) {
    json whole = json_of(field);
    whole["zones"] = json::array();
    for (const auto& zone : zones) {
        whole["zones"].push_back(json_of(zone));
    }
    // One sign a byte: VTK's readers and writers of XML treat others in their own ways.
    const auto array = array_of(whole.dump(-1, ' ', true, json::error_handler_t::replace), as_bytes);
    array->SetName(description_name);
    data.GetFieldData()->AddArray(array);
}

std::optional<Description> description_in(vtkDataObject& data) {
    const auto text = text_of(data.GetFieldData()->GetAbstractArray(description_name));
    if (!text) {
        return std::nullopt;
    }
    try {
        const json whole = json::parse(*text);
        if (whole.at("version").get<int>() != version) {
            return std::nullopt;
        }
        Description description = description_from(whole);
        const bool sound = !description.zones.empty() && std::isfinite(description.field.pressure.operating_pressure) &&
                           (!description.field.density ||
                            (std::isfinite(*description.field.density) && *description.field.density > 0));
        return sound ? std::optional(std::move(description)) : std::nullopt;
    } catch (const json::exception&) {
        return std::nullopt;
    }
}

}  // namespace underbody::postproc
