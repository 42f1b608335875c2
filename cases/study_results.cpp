// What a run of a study gives, and how it is told as JSON.
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/store.h"
#include "cases/study.h"
#include "core/batch_problems.h"

namespace underbody::cases {

double CaseLoads::value(const std::string& quantity) const {
    for (const auto& one : values) {
        if (one.name == quantity) {
            return one.value;
        }
    }
    return std::nan("");
}

const std::string* StudyResults::document(const std::string& key) const {
    for (const auto& [name, text] : documents) {
        if (name == key) {
            return &text;
        }
    }
    return nullptr;
}

const std::string* StudyResults::picture(const std::string& key) const {
    for (const auto& [name, bytes] : pictures) {
        if (name == key) {
            return &bytes;
        }
    }
    return nullptr;
}

std::string StudyResults::loads_document(const CaseLoads& one) const {
    return store != nullptr && one.id != 0 ? store->value(one.id).value_or("") : "";
}

core::Problems StudyResults::gathered_warnings(bool each) const {
    core::BatchProblems all(each);
    for (const auto& one : case_loads) {
        all.add(one.file, one.warnings);
    }
    return all.gathered();
}

std::string to_string(StepState state) {
    switch (state) {
        case StepState::computed:
            return "computed";
        case StepState::unchanged:
            return "unchanged";
        case StepState::failed:
            return "failed";
        case StepState::changed:
            return "changed";
        case StepState::missing:
            break;
    }
    return "not run";
}

void to_json(nlohmann::json& json, const StudyResults& results) {
    json = {{"computed", results.computed}, {"reused", results.reused}, {"failed", results.failed}};
    json["report"] = results.report.string();
    json["notes"] = results.notes;
    json["warnings"] = nlohmann::json::array();
    for (const auto& problem : results.gathered_warnings(true)) {
        json["warnings"].push_back({{"file", problem.place.file}, {"message", problem.message}});
    }
    json["steps"] = nlohmann::json::array();
    for (const auto& step : results.steps) {
        nlohmann::json entry = {{"kind", step.kind},
                                {"name", step.name},
                                {"reused", step.state == StepState::unchanged},
                                {"state", to_string(step.state)}};
        if (!step.error.empty()) {
            entry["error"] = step.error;
        }
        json["steps"].push_back(std::move(entry));
    }
    json["results"] = nlohmann::json::object();
    for (const auto& loads : results.case_loads) {
        const std::string text = results.loads_document(loads);
        if (!text.empty()) {
            json["results"]["loads/" + loads.name] = nlohmann::json::parse(text, nullptr, false);
        }
    }
    for (const auto& [key, text] : results.documents) {
        if (!key.starts_with("figure/") && !key.starts_with("found-model/")) {
            json["results"][key] = nlohmann::json::parse(text, nullptr, false);
        }
    }
}

}  // namespace underbody::cases
