#include "cases/engine.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cases/code_version.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"

namespace underbody::cases {

namespace fs = std::filesystem;

Key::Key(const std::string& kind, const std::vector<std::string>& rooms) {
    add(kind).add(code_versions().at("core"));
    for (const auto& room : rooms) {
        add(code_versions().at(room));
    }
}

Key& Key::add(const std::string& part) {
    parts_ += std::to_string(part.size()) + ":" + part;
    return *this;
}

Key& Key::add(double part) { return add(core::format_number(part)); }

Key& Key::add(const Conditions& conditions) {
    for (const auto& [name, value] : conditions.numbers) {
        add(name).add(value);
    }
    for (const auto& [name, value] : conditions.texts) {
        add(name).add(value);
    }
    return *this;
}

std::string Key::digest() const { return core::content_hash(parts_); }

namespace {
fs::path store_file(const Study& study, const RunOptions& options) {
    return options.store.empty() ? study.folder() / ".underbody" / "store.sqlite" : options.store;
}
}  // namespace

Engine::Engine(const Study& the_study, const RunOptions& the_options, core::Progress& the_progress)
    : study(the_study), options(the_options), progress(the_progress), store_(store_file(the_study, the_options)) {}

std::optional<std::string> Engine::make(const std::string& kind, const std::string& name, const Key& key,
                                        const std::function<std::string()>& work) {
    progress.check();
    StepResult step{kind, name, true, {}};
    const std::string digest = key.digest();
    std::optional<std::string> value = store_.find(digest);
    if (!value) {
        step.reused = false;
        try {
            value = work();
            store_.put(digest, kind, name, *value);
        } catch (const core::Cancelled&) {
            throw;
        } catch (const core::SystemError& error) {
            if (error.kind() != "display") {
                throw;  // no disk, no store: nothing that the next step would fare better with
            }
            step.error = error.what();
        } catch (const core::Error& error) {
            step.error = error.what();
        }
    }
    const std::lock_guard lock(mutex_);
    ++(!step.error.empty() ? results.failed : step.reused ? results.reused : results.computed);
    results.steps.push_back(std::move(step));
    return value;
}

void Engine::figure(const std::string& name, const Key& key, const std::function<core::Figure()>& work) {
    if (!options.renderer) {
        return;
    }
    Key with_renderer = Key("figure", {"studio/figures"});
    with_renderer.add(key.digest()).add(name);
    // Captions travel with the picture: JSON head, then the PNG.
    const auto value = make("figure", name, with_renderer, [&] {
        const core::Figure figure = work();
        return nlohmann::json({{"title", figure.title}, {"caption", figure.caption}}).dump() + "\n" + options.renderer(figure);
    });
    if (value) {
        unpack("figure/" + name, *value);
    }
}

void Engine::picture(const std::string& kind, const std::string& name, const Key& key, const std::function<std::string()>& work) {
    if (!options.pictures) {
        return;
    }
    Key of_picture(kind, {"postproc"});
    of_picture.add(key.digest()).add(name);
    if (const auto value = make(kind, name, of_picture, work)) {
        unpack(kind + "/" + name, *value);
    }
}

void Engine::unpack(const std::string& name, const std::string& value) {
    const std::size_t end = value.find('\n');
    add_document(name, value.substr(0, end));
    add_picture(name, value.substr(end + 1));
}

std::string Engine::hash_of(const fs::path& file) {
    {
        const std::lock_guard lock(mutex_);
        const auto known = hashes_.find(file);
        if (known != hashes_.end()) {
            return known->second;
        }
    }
    std::string hash = core::content_hash_of_file(file);
    const std::lock_guard lock(mutex_);
    return hashes_.emplace(file, std::move(hash)).first->second;
}

std::string Engine::hash_of_folder(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
        if (entry.is_regular_file(error)) {
            files.push_back(entry.path());
        }
    }
    if (error) {
        throw core::InputError("file", "cannot be read: " + error.message(), {folder.string(), {}, {}, {}});
    }
    std::sort(files.begin(), files.end());
    core::Hasher hasher;
    for (const auto& file : files) {
        hasher.add(file.lexically_relative(folder).generic_string()).add(hash_of(file));
    }
    return hasher.digest();
}

void Engine::add_document(const std::string& key, const std::string& json) {
    const std::lock_guard lock(mutex_);
    results.documents.emplace_back(key, json);
}

void Engine::add_picture(const std::string& key, const std::string& png) {
    const std::lock_guard lock(mutex_);
    results.pictures.emplace_back(key, png);
}

void Engine::fail(const std::string& kind, const std::string& name, const std::string& what) {
    const std::lock_guard lock(mutex_);
    results.steps.push_back({kind, name, false, what});
    ++results.failed;
}

fs::path Engine::report_file() const {
    return options.report.empty() ? study.folder() / "report" / "index.html" : options.report;
}

fs::path Engine::report_folder() const {
    const fs::path file = report_file();
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

void Engine::write_if_changed(const fs::path& file, const std::string& bytes) {
    std::error_code ignored;
    if (fs::file_size(file, ignored) == bytes.size() && core::read_file(file) == bytes) {
        return;
    }
    core::write_file(file, bytes);
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

StudyResults run_study(const Study& study, const RunOptions& options, core::Progress& progress) {
    Engine engine(study, options, progress);
    struct Stage {
        double at;
        const char* what;
        void (*run)(Engine&);
    };
    static constexpr Stage stages[] = {
        {0.00, "bodies", run_bodies},          {0.05, "loads", run_loads},
        {0.25, "pictures", run_pictures},      {0.40, "mesh uncertainty", run_meshes},
        {0.42, "verification", run_verifications}, {0.45, "force tables", run_tables},
        {0.55, "comparison", run_comparisons}, {0.60, "stability maps", run_regions},
        {0.75, "measurements", run_measurements}, {0.90, "thesis", run_thesis},            {0.97, "report", write_report},
    };
    for (const auto& stage : stages) {
        progress.report(stage.at, stage.what);
        stage.run(engine);
    }
    progress.report(1, "done");
    engine.results.report = engine.report_file();
    return std::move(engine.results);
}

void to_json(nlohmann::json& json, const StudyResults& results) {
    json = {{"computed", results.computed}, {"reused", results.reused}, {"failed", results.failed}};
    json["report"] = results.report.string();
    json["steps"] = nlohmann::json::array();
    for (const auto& step : results.steps) {
        nlohmann::json entry = {{"kind", step.kind}, {"name", step.name}, {"reused", step.reused}};
        if (!step.error.empty()) {
            entry["error"] = step.error;
        }
        json["steps"].push_back(std::move(entry));
    }
    json["results"] = nlohmann::json::object();
    for (const auto& [key, text] : results.documents) {
        if (!key.starts_with("figure/")) {
            json["results"][key] = nlohmann::json::parse(text, nullptr, false);
        }
    }
}

}  // namespace underbody::cases
