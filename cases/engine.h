// Runs the steps of a study: what rests on nothing that changed comes out of the store.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cases/file_states.h"
#include "cases/store.h"
#include "cases/stored_index.h"
#include "cases/study.h"
#include "core/file.h"
#include "core/inputs.h"

namespace underbody::cases {

/// A result that a step has got, new or out of the store.
struct Made {
    std::string kind;
    std::string name;
    std::int64_t id = 0;   ///< in the store
    std::string identity;  ///< StoredResult::identity
    std::string summary;

    /// Enough of the identity to find the result again.
    [[nodiscard]] std::string id_for_files() const { return identity.substr(0, 16); }
    /// What exported files of it say in their heads, by which they are known.
    [[nodiscard]] std::string origin_line() const {
        return "Result: " + kind + "/" + name + " " + id_for_files() +
               " (underbody study why STUDY FILE says what it is made of)";
    }
};

/// What a result is made with besides files: options, conditions, code, other results. Files are noted when they are
/// read (core/inputs.h).
class Key {
public:
    /// `rooms`: whose code makes the result ("postproc", "surrogates/tables", ...); core and cases are always in.
    Key(const std::string& kind, const std::vector<std::string>& rooms);
    Key& add(const std::string& label, const std::string& value);
    Key& add(const std::string& label, double value);
    Key& add(const std::string& label, const Conditions& conditions);
    /// It is made out of that result: another one, another key.
    Key& from(const Made& made);
    /// It is made out of that result, whose numbers stand among the options: where they are the same, the key is.
    Key& through(const std::string& kind, const std::string& name);
    [[nodiscard]] std::string digest() const;
    /// Finds the digest once, for a key that many results share. Nothing is added to it any more.
    void close() { digest_ = digest(); }
    /// The same for people, as JSON: `code`, `options`, `from` (kind, name and the id that `id_of` knows).
    using IdOf = std::function<std::string(const std::string& kind, const std::string& name)>;
    [[nodiscard]] std::string about(const IdOf& id_of) const;

private:
    std::vector<std::pair<std::string, std::string>> code_;
    std::vector<std::pair<std::string, std::string>> options_;
    std::vector<std::pair<std::string, std::string>> from_;
    std::string digest_;  ///< of a closed key
};

/// The units that the study says for a case's file; of one without any the key stays what it was.
void add_units(Key& key, const Case& entry);

/// What a piece of work gives.
struct Value {
    std::string bytes;
    std::string summary;
    Value(std::string all) : bytes(std::move(all)) {}  // NOLINT: a value without summary is a string
    Value(std::string all, std::string brief) : bytes(std::move(all)), summary(std::move(brief)) {}
};

/// What an engine takes out of a store at its beginning.
struct OpenedStore {
    std::shared_ptr<Store> store;  ///< nullptr: there is none
    std::unique_ptr<StoredIndex> index;
    Store::FileHashes hashes;
};
/// That of the study in the folder, or where the options say. `look`: nothing is made.
OpenedStore opened_store(const std::filesystem::path& folder, const RunOptions& options, bool look);

class Engine {
public:
    enum class Mode {
        compute,  ///< what is missing or no longer true is made
        look,     ///< it is left out, and told to be
    };
    Engine(const Study& study, const RunOptions& options, Mode mode, core::Progress& progress);
    Engine(const Study& study, const RunOptions& options, Mode mode, core::Progress& progress, OpenedStore opened);

    const Study& study;
    const RunOptions& options;
    const Mode mode;
    core::Progress& progress;
    StudyResults results;

    /// The result for the key whose inputs are as they were: from the store, or made and put there. A failure (not a
    /// cancel) is recorded as a step (under the name `shown`, or its own) and gives nothing: the other steps go on. Two
    /// runs at once do not make one result twice. `step`: also told here.
    std::optional<Made> make(const std::string& kind, const std::string& name, const Key& key,
                             const std::function<Value()>& work, const std::string& shown = {},
                             StepResult* step = nullptr);
    /// Its bytes, out of the store.
    std::string value(const Made& made);
    /// A plot of the step, drawn when there is a renderer; kept under `figure/NAME`.
    void figure(const std::string& name, const Key& key, const std::function<core::Figure()>& work);
    /// A 3D picture: `work` gives one line of JSON ({"caption"}) and the PNG behind it. Nothing without
    /// RunOptions::pictures.
    void picture(const std::string& kind, const std::string& name, const Key& key,
                 const std::function<std::string()>& work);

    void add_document(const std::string& key, const std::string& json);
    void add_picture(const std::string& key, const std::string& png);
    /// Records a failure that no `make` covers.
    void fail(const std::string& kind, const std::string& name, const std::string& what);

    /// Path of a file as results name it: relative to the study.
    [[nodiscard]] std::string path_in_study(const std::filesystem::path& file) const {
        return states_.stored_path(file);
    }
    /// Path of a file that results name so.
    [[nodiscard]] std::filesystem::path path_of(const std::string& named) const { return states_.path_of(named); }

    /// Folder of the report: exports and models are written beside it.
    [[nodiscard]] std::filesystem::path report_folder() const;
    [[nodiscard]] std::filesystem::path report_file() const;
    /// Writes the file unless it holds these bytes already.
    static void write_if_changed(const std::filesystem::path& file, const std::string& bytes);

    /// For what several results share (Shared).
    [[nodiscard]] FileStates& states() { return states_; }
    /// What the next run need not find out again.
    void remember_files();
    [[nodiscard]] std::shared_ptr<Store> store() const { return store_; }

    /// Told of every result that a step gets, with the name that people know it by.
    using Watcher = std::function<void(const std::string& shown, const StoredResult& result)>;
    void watch(Watcher watcher) { watcher_ = std::move(watcher); }

private:
    bool is_true(std::string_view packed_inputs);
    /// A result of the index that is true now.
    std::optional<StoredResult> known(const std::string& kind, const std::string& name, const std::string& digest);
    /// What the store has last, whether true or not; nullptr: nothing.
    [[nodiscard]] const StoredIndex::Row* newest(const std::string& kind, const std::string& name) const;
    StoredResult make_now(const std::string& kind, const std::string& name, const std::string& digest, const Key& key,
                          const std::function<Value()>& work);
    [[nodiscard]] std::string id_of(const std::string& kind, const std::string& name);
    void record(StepResult step);
    void unpack(const std::string& name, const std::string& value);
    void tell_version();

    std::shared_ptr<Store> store_;
    FileStates states_;
    std::unique_ptr<StoredIndex> index_;
    Watcher watcher_;
    std::mutex mutex_;
    std::unordered_map<std::string, std::string> ids_;  ///< of this run's results, by kind and name
};

/// A thing that several results are made of, made when the first of them needs it: what it read, they all read.
template <class T>
class Shared {
public:
    /// `engine` gives the states of what is read.
    Shared(FileStates& states, std::function<T()> make) : states_(states), make_(std::move(make)) {}
    const T& get() {
        if (!value_) {
            core::InputRecord record([this](const core::Input& input) { return states_.state_of(input); });
            {
                const core::RecordInputs scope(record);
                value_ = make_();
            }
            read_ = record.entries();
        } else {
            core::note(read_);
        }
        return *value_;
    }

private:
    FileStates& states_;
    std::function<T()> make_;
    std::optional<T> value_;
    std::vector<core::InputRecord::Entry> read_;
};

/// A folder for what a step writes and reads again: no input of the result.
class Scratch {
public:
    Scratch() : own_(folder_.path()) {}
    [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }

private:
    core::TemporaryFolder folder_;
    core::RecordInputs own_;
};

/// Digest of all values of a table.
std::string digest_of(const core::Table& table);

/// One row a case: its conditions, then what the loads give. Cases without loads are left out.
core::Table loads_table(const Study& study, const std::vector<CaseLoads>& loads);

/// All steps of an engine that only looks.
void look_at_all(Engine& engine);

// The steps, in order. Each fills `engine.results`.
void run_bodies(Engine& engine);  // step_bodies.cpp
/// step_loads.cpp: of each case; `list`: of its values, lift, drag, side force and their errors alone.
void find_loads(Engine& engine, bool list);
void run_loads(Engine& engine);          // step_loads.cpp: and the table of them
void run_pictures(Engine& engine);       // step_pictures.cpp
void run_meshes(Engine& engine);         // step_meshes.cpp
void run_verifications(Engine& engine);  // step_verify.cpp
void run_shape_loads(Engine& engine);    // step_shape_loads.cpp
void run_tables(Engine& engine);         // step_tables.cpp
void run_comparisons(Engine& engine);    // step_tables.cpp
void run_regions(Engine& engine);        // step_regions.cpp
void run_measurements(Engine& engine);   // step_measurements.cpp
void run_thesis(Engine& engine);         // step_thesis.cpp
void write_report(Engine& engine);       // report.cpp

}  // namespace underbody::cases
