#include "cases/accept.h"

#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "cases/study_text.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/own_files.h"
#include "core/text.h"

namespace underbody::cases {

namespace fs = std::filesystem;

namespace {

const MeasurementSpec& measurement_named(const Study& study, const std::string& name) {
    std::vector<std::string> names;
    for (const auto& spec : study.measurements) {
        names.push_back(spec.name);
        if (spec.name == name) {
            return spec;
        }
    }
    throw core::UsageError("missing", "the study has no [[measurement]] '" + name + "'", {},
                           core::did_you_mean(name, names));
}

using Files = std::map<std::string, std::string>;  ///< name -> text

/// Of the last report beside the study, whose verdict must be the stored one.
Files files_in_report(const Study& study, const std::string& measurement, const std::string& sentence) {
    const fs::path folder = study.folder() / "report" / "discovery" / measurement;
    const fs::path said = folder / "discovery.json";
    if (!fs::exists(folder / "model.toml") || !fs::exists(said) ||
        nlohmann::json::parse(core::read_file(said), nullptr, false).value("sentence", "") != sentence) {
        throw core::InputError("stale", "the report of the discovery is not there, or of another result",
                               {said.string(), {}, {}, {}}, "run the study, with its report");
    }
    Files files;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name == "model.toml" || (entry.path().extension() == ".csv" && name != "next-experiment.csv")) {
            files[name] = core::read_file(entry.path());
        }
    }
    return files;
}

/// The model that was found with the tables it names: out of the store, wherever the report lies.
Files found_files(const Study& study, const StudyResults& results, const std::string& measurement,
                  std::string& sentence) {
    static_cast<void>(measurement_named(study, measurement));
    const std::string* stored = results.document("discovery/" + measurement);
    if (stored == nullptr) {
        throw core::InputError("missing", "nothing was discovered of the measurement '" + measurement + "'", {},
                               "discover = true in its [[measurement]], then run the study");
    }
    const auto document = nlohmann::json::parse(*stored);
    sentence = document.value("sentence", "");
    if (document.value("verdict", "") == "none") {
        throw core::InputError("nothing", "the model of '" + measurement + "' lacks nothing: " + sentence);
    }
    if (const std::string* files = results.document("found-model/" + measurement)) {
        auto all = nlohmann::json::parse(*files).get<Files>();
        if (all.contains("model.toml")) {
            return all;
        }
    }
    return files_in_report(study, measurement, sentence);
}

/// The files in a folder of their own that lasts as long as the program: the same files, the same folder.
fs::path folder_of(const Files& files) {
    static const core::TemporaryFolder all;
    const fs::path folder = all.path() / core::content_hash(nlohmann::json(files).dump());
    static std::mutex alone;
    const std::lock_guard<std::mutex> lock(alone);
    for (const auto& [name, text] : files) {
        if (!fs::exists(folder / name)) {
            core::write_file(folder / name, text);
        }
    }
    return folder;
}

/// The model of a map with the study's tables in it, as `study run` writes it: a measurement that was judged by it
/// found what the map lacks, and the found model has these tables already.
bool is_model_of_map(const Study& study, const RegionSpec& spec, const fs::path& model) {
    return !spec.forces.empty() && same_place(model, study.folder() / "report" / "models" / spec.name / "model.toml");
}

}  // namespace

fs::path accepted_model(const std::string& measurement) { return fs::path("models") / measurement / "model.toml"; }

bool same_place(const fs::path& a, const fs::path& b) {
    return fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
}

Accepted accept_model(const Study& study, const StudyResults& results, const std::string& measurement) {
    Accepted accepted;
    const Files found = found_files(study, results, measurement, accepted.sentence);
    accepted.model = accepted_model(measurement);
    for (const auto& [name, text] : found) {
        accepted.files.emplace_back(accepted.model.parent_path() / name, text);
    }
    const fs::path old = measurement_named(study, measurement).model;
    accepted.study_text = core::read_file(study.folder() / "study.toml");
    const auto take = [&](const char* kind, const std::string& name) {
        accepted.study_text = with_value(accepted.study_text, kind, name, "model", accepted.model.generic_string());
        accepted.users.push_back(std::string(kind) + " '" + name + "'");
    };
    for (const auto& spec : study.measurements) {
        if (same_place(spec.model, old)) {
            take("measurement", spec.name);
        }
    }
    for (const auto& spec : study.regions) {
        if (same_place(spec.model, old)) {
            take("region", spec.name);
        } else if (is_model_of_map(study, spec, old)) {
            take("region", spec.name);
            accepted.study_text = with_value(accepted.study_text, "region", spec.name, "forces", "[]");
        }
    }
    return accepted;
}

void write_accepted(const Study& study, const Accepted& accepted) {
    const core::ReplacingAllowed of_the_user;  // who asked for it
    for (const auto& [file, text] : accepted.files) {
        core::write_file(study.folder() / file, text);
    }
    static_cast<void>(Study::from_text(accepted.study_text, study.folder() / "study.toml"));
    core::write_file(study.folder() / "study.toml", accepted.study_text);
}

Study with_accepted(const Study& study, const StudyResults& results, const std::string& measurement) {
    std::string sentence;
    const fs::path found = folder_of(found_files(study, results, measurement, sentence)) / "model.toml";
    const fs::path old = measurement_named(study, measurement).model;
    Study changed = study;
    for (auto& spec : changed.measurements) {
        spec.model = same_place(spec.model, old) ? found : spec.model;
    }
    for (auto& spec : changed.regions) {
        if (is_model_of_map(study, spec, old)) {
            spec.forces.clear();
            spec.model = found;
        }
        spec.model = same_place(spec.model, old) ? found : spec.model;
    }
    return changed;
}

}  // namespace underbody::cases
