// What the commands of `underbody study` share.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cases/study.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

struct StudyArguments {
    std::string folder;
    std::string store;
    std::string report;
    bool no_pictures = false;
    std::string files;
    std::vector<std::string> conditions;
    std::string symmetry;
    std::string length_unit;
    std::vector<std::string> units;
    std::vector<std::string> data, channels;  ///< of a measurement
    std::string model, name, clock;
    std::string design_points;
    std::vector<std::string> parameters;
    std::string table, where, net_weight, virtual_mass;  ///< of a table of forces
    std::vector<std::string> axes, exports;
    std::string what;
    std::vector<std::string> zones;
    std::string other;        ///< folder of the second study
    std::string other_store;  ///< its store
    std::string where_a, where_b;
    bool as_stored = false;
    int most = 20;
};

cases::RunOptions run_options(const StudyArguments& arguments);

/// Text columns, padded so that they stand under each other.
std::string aligned(const std::vector<std::vector<std::string>>& rows);

/// Warnings that change what the numbers mean stand beside them, on stdout.
void print_warnings(Shell& shell, const cases::StudyResults& results);
/// What was left out on opening the study stands where its numbers are read.
void show_notes(Shell& shell, const cases::Study& study);
/// The same, and what there is to say about the run.
nlohmann::json json_of_notes(const cases::Study& study, const std::vector<std::string>& notes);

/// The library knows no options; where a store cannot be used, one of them is the way out.
template <class Work>
auto with_store_hint(const Work& work) {
    try {
        return work();
    } catch (const core::SystemError& error) {
        if (error.kind() != "store") {
            throw;
        }
        throw core::SystemError(
            error.kind(), error.message(), error.place(),
            error.hint() + (error.hint().empty() ? "" : "; ") + "--store FILE puts the store elsewhere");
    }
}

cases::StudyResults results_of_run(Shell& shell, const cases::Study& study, const cases::RunOptions& options);

void add_common(CLI::App* command, StudyArguments& arguments);

// The commands that have a file of their own.
void add_study_add(CLI::App* study, std::shared_ptr<StudyArguments> arguments, Shell& shell);
void add_study_compare(CLI::App* study, std::shared_ptr<StudyArguments> arguments, Shell& shell);
void add_study_why(CLI::App* study, std::shared_ptr<StudyArguments> arguments, Shell& shell);

}  // namespace underbody::studio
