// What tests share: where things are, and a way to run the program as a user would.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace underbody::test {

/// The source tree.
std::filesystem::path source_folder();
/// tests/data
std::filesystem::path data_folder();
/// Third-party files that are read in place: $UNDERBODY_SHARED, or `shared` beside the source tree; empty when missing.
std::filesystem::path shared_folder();
/// Where the tested programs are: $UNDERBODY_TESTED_PROGRAMS, or build/.../bin.
std::filesystem::path program_folder();

/// Skips the test, saying so, when a file below the shared folder is missing.
#define UNDERBODY_NEEDS_SHARED(path)                                                                              \
    if (!std::filesystem::exists(::underbody::test::shared_folder() / (path))) {                                  \
        GTEST_SKIP() << "skipped: " << (path) << " is not here (set UNDERBODY_SHARED to the folder that has it)"; \
    }

struct ProgramRun {
    int exit_code = 0;
    std::string output;  ///< stdout
    std::string errors;  ///< stderr
};

/// Runs `underbody` with the arguments in a folder; no shell between.
ProgramRun run_underbody(const std::vector<std::string>& arguments, const std::filesystem::path& folder = {},
                         const std::map<std::string, std::string>& environment = {});
ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder = {},
                       const std::map<std::string, std::string>& environment = {});

/// Processor time of this process so far, all threads, in seconds: what a machine that does other work does not change.
double processor_seconds();

}  // namespace underbody::test
