#include "cases/doubts.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/units.h"
#include "postproc/loads/uncertainty.h"

namespace underbody::cases {

std::vector<std::string> doubts_of_model(const Study& study, const StudyResults& results, const RegionSpec& region) {
    std::vector<std::string> doubts;
    for (const auto& spec : study.measurements) {
        const std::string* document = results.document("discovery/" + spec.name);
        if (document == nullptr || spec.model.lexically_normal() != region.model.lexically_normal()) {
            continue;
        }
        std::string lacks;
        const nlohmann::json found = nlohmann::json::parse(*document);
        for (const auto& effect : found.value("effects", nlohmann::json::array())) {
            lacks += (lacks.empty() ? "" : ", ") + effect.value("name", "");
        }
        if (!lacks.empty()) {
            doubts.push_back("The measured runs '" + spec.name + "' find this model incomplete: it lacks " + lacks +
                             ". The map is of the model as declared, without that.");
        }
    }
    return doubts;
}

std::vector<std::string> warnings_of(const MeasurementSpec& measurement, const StudyResults& results) {
    std::vector<std::string> warnings;
    const auto take = [&](const nlohmann::json& result) {
        for (const auto& problem : result.value("problems", nlohmann::json::array())) {
            std::string message = problem.at("message");
            if (problem.at("severity") == "warning" &&
                std::find(warnings.begin(), warnings.end(), message) == warnings.end()) {
                warnings.push_back(std::move(message));
            }
        }
    };
    if (const std::string* residual = results.document("residual/" + measurement.name)) {
        const auto found = nlohmann::json::parse(*residual);  // kept: what is iterated stands in it
        for (const auto& one : found.value("residuals", nlohmann::json::array())) {
            take(one);
        }
    }
    if (const std::string* discovery = results.document("discovery/" + measurement.name)) {
        take(nlohmann::json::parse(*discovery));
    }
    return warnings;
}

std::vector<std::string> warnings_of(const RegionSpec& region, const StudyResults& results) {
    const std::string* map = results.document("region/" + region.name);
    return map == nullptr ? std::vector<std::string>()
                          : nlohmann::json::parse(*map).at("beside_tables").get<std::vector<std::string>>();
}

std::vector<std::string> doubts_of_mesh(const TableSpec& table, const StudyResults& results) {
    const MeshResult* mesh = find_result(results.meshes, table.mesh_uncertainty);
    const auto* found = mesh == nullptr ? nullptr : mesh->find(table.quantity);
    if (found == nullptr || found->verdict != postproc::to_string(postproc::MeshVerdict::diverging)) {
        return {};
    }
    const auto* quantity = core::find_quantity(table.quantity);
    return {
        "Its error of " + core::format_number(found->standard_uncertainty, 2) + " " +
        (quantity == nullptr ? "" : quantity->unit) + " is of the mesh study '" + mesh->name +
        "', whose values are diverging: they move more from mesh to mesh the finer it is, so that their range is no "
        "bound of the error."};
}

}  // namespace underbody::cases
