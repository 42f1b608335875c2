// Runs the steps of a study: what did not change comes out of the store.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "cases/store.h"
#include "cases/study.h"

namespace underbody::cases {

/// What a step depends on; its digest is the key of its result.
class Key {
public:
    /// `rooms`: whose code makes the result ("postproc", "surrogates/tables", ...); core is always in.
    Key(const std::string& kind, const std::vector<std::string>& rooms);
    Key& add(const std::string& part);
    Key& add(double part);
    Key& add(const Conditions& conditions);
    [[nodiscard]] std::string digest() const;

private:
    std::string parts_;
};

class Engine {
public:
    Engine(const Study& study, const RunOptions& options, core::Progress& progress);

    const Study& study;
    const RunOptions& options;
    core::Progress& progress;
    StudyResults results;

    /// The value for the key: from the store, or made and put there. A failure (not a cancel) is recorded as a step
    /// and gives nothing: the other steps go on.
    std::optional<std::string> make(const std::string& kind, const std::string& name, const Key& key,
                                    const std::function<std::string()>& work);
    /// A plot of the step, drawn when there is a renderer; kept under `figure/NAME`.
    void figure(const std::string& name, const Key& key, const std::function<core::Figure()>& work);
    /// A 3D picture: `work` gives one line of JSON ({"caption"}) and the PNG behind it. Nothing without RunOptions::pictures.
    void picture(const std::string& kind, const std::string& name, const Key& key, const std::function<std::string()>& work);
    /// Hash of a file's content, read once a run.
    std::string hash_of(const std::filesystem::path& file);
    /// Hash over all regular files below a folder.
    std::string hash_of_folder(const std::filesystem::path& folder);

    void add_document(const std::string& key, const std::string& json);
    void add_picture(const std::string& key, const std::string& png);
    /// Records a failure that no `make` covers.
    void fail(const std::string& kind, const std::string& name, const std::string& what);

    /// Folder of the report: exports and models are written beside it.
    [[nodiscard]] std::filesystem::path report_folder() const;
    [[nodiscard]] std::filesystem::path report_file() const;
    /// Writes the file unless it holds these bytes already.
    static void write_if_changed(const std::filesystem::path& file, const std::string& bytes);

private:
    void unpack(const std::string& name, const std::string& value);
    Store store_;
    std::mutex mutex_;
    std::map<std::filesystem::path, std::string> hashes_;
};

/// One row a case: its conditions, then what the loads give. Cases without loads are left out.
core::Table loads_table(const Study& study, const std::vector<std::pair<const Case*, nlohmann::json>>& done);

// The steps, in order. Each fills `engine.results`.
void run_bodies(Engine& engine);        // step_bodies.cpp
void run_loads(Engine& engine);         // step_loads.cpp
void run_pictures(Engine& engine);      // step_pictures.cpp
void run_meshes(Engine& engine);        // step_meshes.cpp
void run_verifications(Engine& engine); // step_verify.cpp
void run_tables(Engine& engine);        // step_tables.cpp
void run_comparisons(Engine& engine);   // step_tables.cpp
void run_regions(Engine& engine);       // step_regions.cpp
void run_measurements(Engine& engine);  // step_measurements.cpp
void run_thesis(Engine& engine);        // step_thesis.cpp
void write_report(Engine& engine);      // report.cpp

}  // namespace underbody::cases
