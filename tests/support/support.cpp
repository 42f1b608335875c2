#include "tests/support/support.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>

#include "core/file.h"

namespace underbody::test {

namespace fs = std::filesystem;

fs::path source_folder() { return UNDERBODY_SOURCE_FOLDER; }
fs::path data_folder() { return source_folder() / "tests" / "data"; }
fs::path program_folder() {
    const char* set = std::getenv("UNDERBODY_TESTED_PROGRAMS");
    return set != nullptr ? set : UNDERBODY_PROGRAM_FOLDER;
}

fs::path shared_folder() {
    if (const char* set = std::getenv("UNDERBODY_SHARED")) {
        return set;
    }
    return source_folder().parent_path() / "shared";
}

double processor_seconds() {
    timespec used{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

ProgramRun run_underbody(const std::vector<std::string>& arguments, const fs::path& folder,
                         const std::map<std::string, std::string>& environment) {
    return run_program((program_folder() / "underbody").string(), arguments, folder, environment);
}

ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments, const fs::path& folder,
                       const std::map<std::string, std::string>& environment) {
    const core::TemporaryFolder scratch("underbody-test");
    const fs::path output = scratch.path() / "stdout";
    const fs::path errors = scratch.path() / "stderr";
    const pid_t child = ::fork();
    if (child == 0) {
        if (!folder.empty() && ::chdir(folder.c_str()) != 0) {
            ::_exit(126);
        }
        for (const auto& [name, value] : environment) {
            ::setenv(name.c_str(), value.c_str(), 1);
        }
        ::dup2(::open("/dev/null", O_RDONLY), 0);
        ::dup2(::open(output.c_str(), O_WRONLY | O_CREAT, 0600), 1);
        ::dup2(::open(errors.c_str(), O_WRONLY | O_CREAT, 0600), 2);
        std::vector<char*> argv = {const_cast<char*>(program.c_str())};
        for (const auto& argument : arguments) {
            argv.push_back(const_cast<char*>(argument.c_str()));
        }
        argv.push_back(nullptr);
        ::execvp(program.c_str(), argv.data());
        ::_exit(127);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ProgramRun run;
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    run.output = core::read_file(output);
    run.errors = core::read_file(errors);
    return run;
}

}  // namespace underbody::test
