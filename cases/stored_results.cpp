// What the store holds of a study, for opening it without computing anything.
#include <nlohmann/json.hpp>

#include "cases/engine.h"

namespace underbody::cases {

namespace {

class Reader {
public:
    explicit Reader(const std::filesystem::path& file) : store_(file) {}

    void document(StudyResults& results, const std::string& kind, const std::string& name) {
        if (const auto value = store_.latest(kind, name)) {
            results.documents.emplace_back(kind + "/" + name, *value);
        }
    }

    /// A picture is kept as one line of JSON and the PNG behind it.
    void picture(StudyResults& results, const std::string& kind, const std::string& name) {
        if (const auto value = store_.latest(kind, name)) {
            const std::size_t end = value->find('\n');
            results.documents.emplace_back(kind + "/" + name, value->substr(0, end));
            results.pictures.emplace_back(kind + "/" + name, value->substr(end + 1));
        }
    }

    std::optional<std::string> value(const std::string& kind, const std::string& name) { return store_.latest(kind, name); }

private:
    Store store_;
};

void read_loads(const Study& study, Reader& reader, StudyResults& results) {
    std::vector<std::pair<const Case*, nlohmann::json>> done;
    for (const auto& entry : study.cases) {
        if (const auto value = reader.value("loads", entry.name)) {
            results.documents.emplace_back("loads/" + entry.name, *value);
            done.emplace_back(&entry, nlohmann::json::parse(*value));
        }
    }
    results.loads = loads_table(study, done);
}

}  // namespace

StudyResults stored_results(const Study& study, const RunOptions& options) {
    StudyResults results;
    const auto file = options.store.empty() ? study.folder() / ".underbody" / "store.sqlite" : options.store;
    if (!std::filesystem::exists(file)) {
        return results;
    }
    Reader reader(file);
    read_loads(study, reader, results);
    for (const auto& body : study.bodies) {
        reader.document(results, "body", body.name);
        reader.picture(results, "body picture", body.name);
    }
    for (const auto& spec : study.pictures) {
        for (const Case* entry : study.select(spec.where)) {
            for (const auto& view : spec.views) {
                reader.picture(results, "picture", spec.name + "/" + entry->name + "/" + view);
            }
        }
    }
    for (const auto& mesh : study.mesh_uncertainties) {
        reader.document(results, "mesh", mesh.name);
        reader.picture(results, "figure", "mesh/" + mesh.name);
    }
    for (const auto& spec : study.verifications) {
        reader.document(results, "verify", spec.name);
    }
    for (const auto& table : study.tables) {
        reader.document(results, "table", table.name);
        reader.picture(results, "figure", "table/" + table.name);
    }
    for (const auto& compare : study.comparisons) {
        reader.document(results, "compare", compare.name);
        reader.picture(results, "figure", "compare/" + compare.name);
    }
    for (const auto& region : study.regions) {
        reader.document(results, "region", region.name);
        reader.picture(results, "figure", "region/" + region.name);
    }
    for (const auto& spec : study.measurements) {
        reader.document(results, "residual", spec.name);
        for (int i = 0; i < 8; ++i) {
            reader.picture(results, "figure", "residual/" + spec.name + "/" + std::to_string(i));
        }
        if (const auto packed = reader.value("discovery", spec.name)) {
            const auto files = nlohmann::json::parse(*packed).at("files");
            if (files.contains("discovery.json")) {
                results.documents.emplace_back("discovery/" + spec.name, files.at("discovery.json").get<std::string>());
            }
        }
    }
    if (study.thesis) {
        reader.document(results, "thesis", "thesis");
    }
    if (study.thesis_dynamics) {
        reader.document(results, "thesis", "dynamics");
    }
    return results;
}

}  // namespace underbody::cases
