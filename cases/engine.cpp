#include "cases/engine.h"

#include <future>
#include <nlohmann/json.hpp>

#include "cases/code_version.h"
#include "cases/lock.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"

namespace underbody::cases {

namespace fs = std::filesystem;

Key::Key(const std::string& kind, const std::vector<std::string>& rooms) {
    options_.emplace_back("kind", kind);
    for (const char* room : {"core", "cases"}) {
        code_.emplace_back(room, code_versions().at(room));
    }
    for (const auto& room : rooms) {
        code_.emplace_back(room, code_versions().at(room));
    }
}

Key& Key::add(const std::string& label, const std::string& value) {
    options_.emplace_back(label, value);
    return *this;
}

Key& Key::add(const std::string& label, double value) { return add(label, core::format_number(value)); }

Key& Key::add(const std::string& label, const Conditions& conditions) {
    for (const auto& [name, value] : conditions.numbers) {
        add(label + "." + name, value);
    }
    for (const auto& [name, value] : conditions.texts) {
        add(label + "." + name, value);
    }
    for (const auto& own : conditions.own_units) {
        add(label + "." + own.name + " in", own.written);
    }
    return *this;
}

Key& Key::from(const Made& made) {
    through(made.kind, made.name);
    return add("made of " + made.kind + " '" + made.name + "'", made.identity);
}

Key& Key::through(const std::string& kind, const std::string& name) {
    from_.emplace_back(kind, name);
    return *this;
}

void add_units(Key& key, const Case& entry) {
    if (!entry.length_unit.empty()) {
        key.add("length_unit", entry.length_unit);
    }
    for (const auto& [variable, unit] : entry.units) {
        key.add("unit of " + variable, unit);
    }
}

std::string Key::digest() const {
    if (!digest_.empty()) {
        return digest_;
    }
    core::Hasher hasher;
    for (const auto* parts : {&code_, &options_}) {
        for (const auto& [label, value] : *parts) {
            hasher.add(label).add(value);
        }
        hasher.add("");
    }
    return hasher.digest();
}

std::string Key::about(const IdOf& id_of) const {
    nlohmann::json about = {
        {"code", nlohmann::json::object()}, {"options", nlohmann::json::object()}, {"from", nlohmann::json::array()}};
    for (const auto& [room, version] : code_) {
        about["code"][room] = version;
    }
    for (const auto& [label, value] : options_) {  // of several parts of one kind, such as the meshes of a study, all
        auto& told = about["options"][label];
        told = told.is_null() ? value : told.get<std::string>() + "; " + value;
    }
    for (const auto& [kind, name] : from_) {
        about["from"].push_back({{"kind", kind}, {"name", name}, {"id", id_of(kind, name)}});
    }
    return about.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

namespace {

std::string place_in_index(const std::string& kind, const std::string& name) { return kind + '\n' + name; }

}  // namespace

OpenedStore opened_store(const fs::path& folder, const RunOptions& options, bool look) {
    const fs::path file = options.store.empty() ? folder / ".underbody" / "store.sqlite" : options.store;
    OpenedStore opened;
    std::error_code error;
    if (!look || fs::exists(file, error)) {
        opened.store = std::make_shared<Store>(file, look ? Store::Access::read : Store::Access::write);
        opened.index = std::make_unique<StoredIndex>(*opened.store);
        opened.hashes = opened.store->file_hashes();
    }
    return opened;
}

Engine::Engine(const Study& the_study, const RunOptions& the_options, Mode the_mode, core::Progress& the_progress)
    : Engine(the_study, the_options, the_mode, the_progress,
             opened_store(the_study.folder(), the_options, the_mode == Mode::look)) {}

Engine::Engine(const Study& the_study, const RunOptions& the_options, Mode the_mode, core::Progress& the_progress,
               OpenedStore opened)
    : study(the_study),
      options(the_options),
      mode(the_mode),
      progress(the_progress),
      store_(std::move(opened.store)),
      states_(the_study.folder(), std::move(opened.hashes), the_mode == Mode::look),
      index_(std::move(opened.index)) {
    if (store_) {
        tell_version();
    }
}

void Engine::tell_version() {
    if (store_->found_version() == 1) {
        results.notes.push_back(
            "the store was written by Underbody 0.1.0, whose results do not record every file that they rest on: they "
            "are "
            "computed again, once; nothing in it is deleted");
    }
}

bool Engine::is_true(std::string_view packed_inputs) {
    return StoredInputs::all_of(packed_inputs,
                                [this](const StoredInputs::View& input) { return states_.still(input); });
}

std::optional<StoredResult> Engine::known(const std::string& kind, const std::string& name, const std::string& digest) {
    for (const auto* row = newest(kind, name); row != nullptr; row = row->older) {
        if (row->key == digest && is_true(row->inputs)) {
            return row->result();
        }
    }
    return std::nullopt;
}

const StoredIndex::Row* Engine::newest(const std::string& kind, const std::string& name) const {
    return index_ ? index_->newest(kind, name) : nullptr;
}

StoredResult Engine::make_now(const std::string& kind, const std::string& name, const std::string& digest,
                              const Key& key, const std::function<Value()>& work) {
    core::InputRecord read([this](const core::Input& input) { return states_.state_of(input); });
    std::optional<Value> value;
    {
        const core::RecordInputs scope(read);
        value = work();
    }
    StoredResult result;
    result.kind = kind;
    result.name = name;
    result.key = digest;
    result.summary = std::move(value->summary);
    for (auto& [input, state] : read.entries()) {
        result.inputs.push_back({input.kind, states_.stored_path(input.path), input.pattern, state});
    }
    const auto ids = [this](const std::string& of, const std::string& called) { return id_of(of, called); };
    result.id = store_->put(result, key.about(ids), value->bytes);
    return result;
}

/// The first digits of the identity of a result that this run got; empty when it got none.
std::string Engine::id_of(const std::string& kind, const std::string& name) {
    const std::lock_guard lock(mutex_);
    const auto found = ids_.find(place_in_index(kind, name));
    return found == ids_.end() ? std::string() : found->second;
}

std::optional<Made> Engine::make(const std::string& kind, const std::string& name, const Key& key,
                                 const std::function<Value()>& work, const std::string& shown, StepResult* told) {
    progress.check();
    const std::string digest = key.digest();
    std::optional<StoredResult> result = known(kind, name, digest);
    StepResult step{kind, shown.empty() ? name : shown, StepState::unchanged, {}};
    if (!result && mode == Mode::look) {
        const StoredIndex::Row* earlier = newest(kind, name);
        step.state = earlier != nullptr ? StepState::changed : StepState::missing;
        if (options.as_stored && earlier != nullptr) {
            result = earlier->result();
        }
    } else if (!result) {
        try {
            std::optional<Lock> lock;
            if (store_->writable()) {
                lock = lock_of_result(store_->file(), kind, name, progress);
            }
            for (auto& candidate : store_->results(kind, name, digest)) {  // another run may have made it meanwhile
                if (!result && is_true(candidate.inputs.packed())) {
                    result = std::move(candidate);
                }
            }
            if (!result) {
                step.state = StepState::computed;
                result = make_now(kind, name, digest, key, work);
            }
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
        step.state = step.error.empty() ? step.state : StepState::failed;
    }
    if (told != nullptr) {
        *told = step;
    }
    record(std::move(step));
    if (!result) {
        return std::nullopt;
    }
    Made made{kind, name, result->id, result->identity(), watcher_ ? result->summary : std::move(result->summary)};
    const std::string& called = shown.empty() ? name : shown;
    if (mode == Mode::compute || watcher_) {  // who only looks makes nothing that would name what it is made of
        const std::lock_guard lock(mutex_);
        ids_[place_in_index(kind, called)] = made.id_for_files();
        if (watcher_) {
            watcher_(called, *result);
        }
    }
    return made;
}

std::string Engine::value(const Made& made) {
    auto bytes = store_->value(made.id);
    if (!bytes) {
        throw core::SystemError(
            "store", made.kind + " '" + made.name + "' has left the store during this run: another run made it anew",
            {store_->file().string(), {}, {}, {}}, "run the study again");
    }
    return std::move(*bytes);
}

void Engine::record(StepResult step) {
    const std::lock_guard lock(mutex_);
    switch (step.state) {
        case StepState::computed:
            ++results.computed;
            break;
        case StepState::unchanged:
            ++results.reused;
            break;
        case StepState::failed:
            ++results.failed;
            break;
        case StepState::changed:
            ++results.changed;
            break;
        case StepState::missing:
            ++results.missing;
            break;
    }
    results.steps.push_back(std::move(step));
}

void Engine::figure(const std::string& name, const Key& key, const std::function<core::Figure()>& work) {
    if (!options.renderer && mode == Mode::compute) {
        return;
    }
    Key with_renderer = key;
    with_renderer.add("drawn by studio/figures", code_versions().at("studio/figures"));
    // Captions travel with the picture: JSON head, then the PNG.
    const auto made = make("figure", name, with_renderer, [&] {
        const core::Figure figure = work();
        return nlohmann::json({{"title", figure.title}, {"caption", figure.caption}}).dump() + "\n" +
               options.renderer(figure);
    });
    if (made) {
        unpack("figure/" + name, value(*made));
    }
}

void Engine::picture(const std::string& kind, const std::string& name, const Key& key,
                     const std::function<std::string()>& work) {
    if (!options.pictures) {
        return;
    }
    if (const auto made = make(kind, name, key, work)) {
        unpack(kind + "/" + name, value(*made));
    }
}

void Engine::unpack(const std::string& name, const std::string& value) {
    const std::size_t end = value.find('\n');
    add_document(name, value.substr(0, end));
    add_picture(name, value.substr(end + 1));
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
    const bool looking = mode == Mode::look;  // nothing was tried
    record({kind, name, looking ? StepState::missing : StepState::failed, looking ? std::string() : what});
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

void Engine::remember_files() {
    if (store_) {
        store_->remember(states_.learned());
    }
}

std::string digest_of(const core::Table& table) {
    core::Hasher hasher;
    for (const auto& column : table.columns()) {
        hasher.add(column.name).add(column.unit);
        for (const double value : column.numbers) {
            hasher.add(value);
        }
        for (const auto& value : column.text) {
            hasher.add(value);
        }
    }
    return hasher.digest();
}

namespace {

struct Stage {
    double at;
    const char* what;
    void (*run)(Engine&);
};

constexpr Stage stages[] = {
    {0.00, "bodies", run_bodies},
    {0.05, "loads", run_loads},
    {0.25, "pictures", run_pictures},
    {0.40, "mesh uncertainty", run_meshes},
    {0.42, "verification", run_verifications},
    {0.44, "loads of shapes", run_shape_loads},
    {0.45, "force tables", run_tables},
    {0.55, "comparison", run_comparisons},
    {0.60, "stability maps", run_regions},
    {0.75, "measurements", run_measurements},
    {0.90, "thesis", run_thesis},
};

}  // namespace

StudyResults run_study(const Study& study, const RunOptions& options, core::Progress& progress) {
    Engine engine(study, options, Engine::Mode::compute, progress);
    for (const auto& stage : stages) {
        progress.report(stage.at, stage.what);
        stage.run(engine);
    }
    engine.remember_files();
    if (options.write_report) {
        progress.report(0.97, "report");
        write_report(engine);
    }
    progress.report(1, "done");
    engine.results.report = engine.report_file();
    engine.results.store = engine.store();
    return std::move(engine.results);
}

void look_at_all(Engine& engine) {
    for (const auto& stage : stages) {
        stage.run(engine);
    }
}

StudyResults stored_results(const Study& study, const RunOptions& options) {
    Engine engine(study, options, Engine::Mode::look, core::Progress::none());
    look_at_all(engine);
    engine.results.store = engine.store();
    return std::move(engine.results);
}

StudyResults stored_loads(const Study& study, const RunOptions& options) {
    Engine engine(study, options, Engine::Mode::look, core::Progress::none());
    run_loads(engine);
    engine.results.store = engine.store();
    return std::move(engine.results);
}

std::pair<Study, StudyResults> listed(const fs::path& path, const RunOptions& options) {
    auto store = std::async(std::launch::async, [&] { return opened_store(folder_of(path), options, true); });
    Study study = Study::open(path);
    Engine engine(study, options, Engine::Mode::look, core::Progress::none(), store.get());
    find_loads(engine, true);
    engine.results.store = engine.store();
    return {std::move(study), std::move(engine.results)};
}

}  // namespace underbody::cases
